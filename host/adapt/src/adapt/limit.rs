//! The fastest feed that machine and control can follow on a block.
//!
//! Under G43.4, X, Y and Z are the coordinates of the tool's tip in the part, and the machine's own axes follow from its kinematics;
//! without them, and on all other moves, every axis covers what the program says.

use arcfeed_kinematics::forward::Setup;
use arcfeed_kinematics::machine::Machine;
use arcfeed_kinematics::tip_feed::TipMove;
use arcfeed_model::job::Job;
use arcfeed_model::machine::{FeedLimit, LimitedBy};
use arcfeed_nc::modal::Pose;
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::{MmPerMin, Nm};

use crate::post::walk::rotary_deg;
use crate::program::ProgramLine;

/// Fastest feed that the machine's axes, the control or the job allow on a move, and which of these limits it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoveLimit {
    /// Fastest feed along the path, as F counts it, mm/min.
    pub feed_mm_per_min: f64,
    /// Cause of the limit: an axis, the control's clamp on arcs, or the job's ceiling.
    pub by: LimitedBy,
    /// Letter of the axis that limits the feed (X to Z, A to C); `None` for other causes.
    pub axis: Option<char>,
}

impl MoveLimit {
    /// Limit of a line's move `segment`; `None` if nothing limits the move.
    pub fn of(line: &ProgramLine, segment: &Segment, job: &Job, machine: Option<&Machine>) -> Option<Self> {
        match machine.and_then(|machine| of_tip(line, machine)) {
            Some(limit) => Some(limit),
            None => {
                let limit = job.machine.feed_limit(segment)?;
                let axis = if limit.by == LimitedBy::Axis { job.machine.limiting_axis(segment) } else { None };
                Some(MoveLimit { feed_mm_per_min: f64::from(limit.feed.0), by: limit.by, axis })
            }
        }
    }
}

impl MoveLimit {
    /// The lower one of `limit` (`None`: no limit) and the job's ceiling; `None` if the ceiling is infinite and there is no other limit.
    pub fn under(limit: Option<Self>, ceiling_mm_per_min: f64) -> Option<Self> {
        let ceiling = MoveLimit { feed_mm_per_min: ceiling_mm_per_min, by: LimitedBy::Ceiling, axis: None };
        let is_lower = ceiling_mm_per_min < limit.map_or(f64::INFINITY, |limit| limit.feed_mm_per_min);
        if is_lower { Some(ceiling) } else { limit }
    }
}

impl From<MoveLimit> for FeedLimit {
    fn from(limit: MoveLimit) -> Self {
        FeedLimit { feed: MmPerMin(limit.feed_mm_per_min as f32), by: limit.by }
    }
}

/// Whether a line is a straight move under G43.4 (tool centre point control).
pub fn is_tip_line(line: &ProgramLine) -> bool {
    let segment = line.meaning.as_ref().and_then(|meaning| meaning.segment);
    line.follows_tip && segment.is_some_and(|segment| segment.path == Path::Line)
}

/// Larger one of the sines, at the start and at the end of a straight move under G43.4, of the angle between its path and the plane square
/// to the tool's axis. `None` for other moves.
pub fn tip_axial_sine(line: &ProgramLine, machine: &Machine) -> Option<f64> {
    let segment = line.meaning.as_ref()?.segment.filter(|_| is_tip_line(line))?;
    let ends = [segment.start, segment.end];
    let [from, to] = ends.map(|pose| pose.linear.map(Nm::to_mm));
    let path: [f64; 3] = std::array::from_fn(|axis| to[axis] - from[axis]);
    let length_mm = libm::sqrt(path.iter().map(|part| part * part).sum());
    let sine = |pose: &Pose| {
        let axis = machine.axis_at(rotary_deg(pose, machine));
        let along: f64 = path.iter().zip(axis.iter()).map(|(part, axis)| part * axis).sum();
        if length_mm > 0.0 { libm::fabs(along) / length_mm } else { 0.0 }
    };
    Some(sine(&ends[0]).max(sine(&ends[1])))
}

/// A move under G43.4 by the machine's kinematics.
fn of_tip(line: &ProgramLine, machine: &Machine) -> Option<MoveLimit> {
    let segment = line.meaning.as_ref()?.segment.filter(|_| is_tip_line(line))?;
    let setup = Setup { part_zero_mm: [0.0; 3], tool_length_mm: line.tool_length.to_mm() };
    let ends = [segment.start, segment.end];
    let tip_mm = ends.map(|pose| pose.linear.map(Nm::to_mm));
    let found =
        machine.tip_feed(&TipMove { tip_mm, rotary_deg: ends.map(|pose| rotary_deg(&pose, machine)) }, &setup)?;
    let axis = found.axis.to_string().chars().next();
    Some(MoveLimit { feed_mm_per_min: found.feed_mm_per_min, by: LimitedBy::Axis, axis })
}
