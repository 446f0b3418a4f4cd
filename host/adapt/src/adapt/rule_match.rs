//! Search for the cut rule that governs a line's move, or for the reason why none does.

use arcfeed_kinematics::machine::Machine;
use arcfeed_model::cut::CutRule;
use arcfeed_model::governed::{AXIAL_SINE_MAX, Exclusion, Match};
use arcfeed_model::job::{Job, LawKind};
use arcfeed_nc::segment::Segment;
use arcfeed_units::RevPerMin;

use super::PlanReason;
use super::limit::tip_axial_sine;
use crate::program::ProgramLine;

/// Index of the cut rule that governs the move of a line, and the spindle speed there. Only rules whose index `admits`
/// accepts are considered.
///
/// # Errors
/// The reason why the move keeps its programmed feed.
pub fn match_move(
    job: &Job,
    machine: Option<&Machine>,
    line: &ProgramLine,
    segment: &Segment,
    admits: impl Fn(usize) -> bool,
) -> Result<(usize, RevPerMin), PlanReason> {
    if let Some(axial_sine) = machine.and_then(|machine| tip_axial_sine(line, machine)) {
        let found = job.rule_among(segment, line.machining.tool, admits);
        return match_tip_move(job, line, found, axial_sine);
    }
    match job.match_among(segment, &line.machining, admits) {
        Match::NoRule => Err(PlanReason::NoRule),
        Match::Governed(governing) => Ok((governing.index, governing.spindle)),
        Match::Excluded { why: Exclusion::Axial, .. } => Err(PlanReason::Axial),
        Match::Excluded { why: Exclusion::Rotary, .. } => Err(PlanReason::Rotary),
        Match::Excluded { why: Exclusion::Tool, .. } => Err(PlanReason::OtherTool),
        Match::Excluded { why: Exclusion::Spindle, .. } => Err(PlanReason::Spindle),
    }
}

/// The same under G43.4, where the tool's axis is the machine's to say.
fn match_tip_move(
    job: &Job,
    line: &ProgramLine,
    found: Option<(usize, &CutRule)>,
    axial_sine: f64,
) -> Result<(usize, RevPerMin), PlanReason> {
    let (index, rule) = found.ok_or(PlanReason::NoRule)?;
    let setup = job.tool_of(rule);
    if axial_sine > AXIAL_SINE_MAX && setup.law != LawKind::Table {
        return Err(PlanReason::Axial);
    }
    if job.tool_in(line.machining.tool).is_none() {
        return Err(PlanReason::OtherTool);
    }
    setup.speed(line.machining.spindle).map(|spindle| (index, spindle)).ok_or(PlanReason::Spindle)
}
