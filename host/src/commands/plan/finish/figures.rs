//! Output of a plan of finishing passes: text and JSON.

use std::fmt::Write as _;

use arcfeed_plan::finish::access::MoveKind;
use arcfeed_plan::finish::passes::PassPoint;
use arcfeed_plan::finish::proof::FinishClearance;
use serde::Serialize;

use super::result::{FinishResult, obstacle_word, part_word};
use crate::post::finding::Entry;

/// Results of a finishing plan as `arcfeed plan finish --json` prints them (docs/json.md). Lengths are in mm, angles in
/// degrees, feeds in mm/min.
#[derive(Debug, Serialize)]
pub struct FinishFigures {
    /// Name of the part.
    pub name: String,
    /// The mill keeps all distances, and the machine can follow the path.
    pub safe: bool,
    /// Number of blades of the rotor; the program finishes one of them.
    pub blades: u32,
    /// Lowest and highest row of the path, as places between hub (0) and tip (1).
    pub span: [f64; 2],
    /// Number of passes, or of turns of a spiral.
    pub passes: usize,
    /// Number of points of all passes.
    pub points: usize,
    /// Smallest and largest angle between the tool's axis and the normal of the surface.
    pub tilt_deg: [f64; 2],
    /// Target feed at the contact with the surface.
    pub target_feed: f64,
    /// Smallest and largest F of the cutting moves.
    pub feed: Option<[f64; 2]>,
    /// Number of moves whose feed the machine's axes limit.
    pub limited_moves: usize,
    /// Total rotation of each rotary axis, first the axis nearer to the part.
    pub rotary_travel_deg: [f64; 2],
    /// Time of the feed moves, min.
    pub minutes: f64,
    /// Clearances between the parts of the mill and the obstacles.
    pub clearances: Vec<FinishClearanceFigures>,
    /// Errors and warnings of the post-processor; their lines are the numbers of moves.
    pub findings: Vec<Entry>,
}

/// Smallest clearance between a part of the mill and an obstacle over the path.
#[derive(Debug, Serialize)]
pub struct FinishClearanceFigures {
    /// Part of the mill: `end`, `flutes`, `neck` or `holder`.
    pub part: &'static str,
    /// Obstacle: `blade`, `stock`, `neighbours`, `hub` or `fixture`.
    pub obstacle: &'static str,
    /// Proven lower bound of the distance.
    pub certified_mm: f64,
    /// Distance that must be kept; a negative one is the depth of a gouge that the tolerance permits.
    pub needed_mm: f64,
    /// Number of the move with the smallest bound, counted from 1.
    pub move_number: usize,
}

impl FinishFigures {
    /// Results of a plan.
    pub fn of(result: &FinishResult) -> Self {
        let FinishResult { part, plan, .. } = result;
        FinishFigures {
            name: part.name.clone(),
            safe: result.refusal().is_none(),
            blades: part.blisk.blades,
            span: plan.span,
            passes: plan.passes.len(),
            points: plan.passes.iter().map(Vec::len).sum(),
            tilt_deg: tilts_deg(result),
            target_feed: result.target_mm_per_min,
            feed: feeds(result),
            limited_moves: result.limited,
            rotary_travel_deg: result.axes.travel_deg[1],
            minutes: result.minutes,
            clearances: clearances(result),
            findings: result.axes.findings.iter().map(|finding| finding.entry()).collect(),
        }
    }
}

/// Clearances of a plan.
pub fn clearances(result: &FinishResult) -> Vec<FinishClearanceFigures> {
    let figures = |found: &FinishClearance| FinishClearanceFigures {
        part: part_word(found.part),
        obstacle: obstacle_word(found.obstacle),
        certified_mm: found.certified_mm,
        needed_mm: found.needed_mm,
        move_number: found.at + 1,
    };
    result.clearances.iter().map(figures).collect()
}

/// Smallest and largest F of the cutting moves; `None` if there is none.
pub fn feeds(result: &FinishResult) -> Option<[f64; 2]> {
    let cuts = result.plan.path.iter().zip(&result.cl.points).filter(|(step, _)| step.kind == MoveKind::Cut);
    range(&cuts.filter_map(|(_, point)| point.feed_mm_per_min).collect::<Vec<f64>>())
}

/// Smallest and largest angle between the tool's axis and the normal of the surface, degrees.
pub fn tilts_deg(result: &FinishResult) -> [f64; 2] {
    let tilt = |point: &PassPoint| point.contact.normal.angle(&point.location.axis).to_degrees();
    range(&result.plan.passes.iter().flatten().map(tilt).collect::<Vec<f64>>()).unwrap_or([0.0; 2])
}

/// Smallest and largest of the values; `None` if there are none.
pub fn range(values: &[f64]) -> Option<[f64; 2]> {
    let first = *values.first()?;
    Some(values.iter().fold([first; 2], |[low, high], value| [low.min(*value), high.max(*value)]))
}

/// Text of the plan for people.
pub fn text(figures: &FinishFigures) -> String {
    let FinishFigures { name, passes, points, span, tilt_deg, target_feed, limited_moves, .. } = figures;
    let mut text = format!(
        "{name}: {passes} passes, {points} points, from {:.1} to {:.1} % of the blade's height; one of {} blades\n  \
         angle between tool axis and normal {:.1} to {:.1} degrees; rotary axes turn {:.0} and {:.0} degrees\n",
        100.0 * span[0],
        100.0 * span[1],
        figures.blades,
        tilt_deg[0],
        tilt_deg[1],
        figures.rotary_travel_deg[0],
        figures.rotary_travel_deg[1]
    );
    if let Some([low, high]) = figures.feed {
        let _ = writeln!(
            text,
            "  feed {target_feed:.1} mm/min wanted, F {low:.1} to {high:.1}; on {limited_moves} moves the machine's axes allow no more"
        );
    }
    write_clearances(&mut text, &figures.clearances);
    let _ = write!(text, "  time of the feed moves: {:.1} min", figures.minutes);
    text
}

/// Appends to `text` one line for each clearance.
pub fn write_clearances(text: &mut String, clearances: &[FinishClearanceFigures]) {
    let _ = writeln!(text, "  clearances of the whole mill, mm, at least (needed):");
    for found in clearances {
        let FinishClearanceFigures { part, obstacle, certified_mm, needed_mm, .. } = found;
        let _ = writeln!(text, "    {part:<6} from {obstacle:<10} {certified_mm:>9.3} ({needed_mm:.3})");
    }
}
