//! The fastest feed that machine and control can follow on a block.
//!
//! Under G43.4 X, Y and Z are the tip's in the part, and the machine's own axes follow from its kinematics; without them, and on
//! all other moves, every axis covers what the program says.

use arcfeed_shared::job::Job;
use arcfeed_shared::kinematics::follow::TipMove;
use arcfeed_shared::kinematics::forward::Setup;
use arcfeed_shared::kinematics::machine::Machine;
use arcfeed_shared::machine::{FeedLimit, LimitedBy};
use arcfeed_shared::segment::{Path, Segment};
use arcfeed_shared::units::{MmPerMin, Nm};

use crate::post::walk::rotary_deg;
use crate::program::ProgramLine;

/// The fastest feed on a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoveLimit {
    /// Along the path, as its F counts.
    pub feed_mm_per_min: f64,
    /// What sets it.
    pub by: LimitedBy,
    /// Which axis, where one does: `X` to `Z`, `A` to `C`.
    pub axis: Option<char>,
}

impl MoveLimit {
    /// That of a line's move, `segment` being it; `None` where nothing limits it.
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

impl From<MoveLimit> for FeedLimit {
    fn from(limit: MoveLimit) -> Self {
        FeedLimit { feed: MmPerMin(limit.feed_mm_per_min as f32), by: limit.by }
    }
}

/// Whether a line is a straight cutting move under G43.4.
pub fn is_tip_line(line: &ProgramLine) -> bool {
    let segment = line.meaning.as_ref().and_then(|meaning| meaning.segment);
    line.follows_tip && segment.is_some_and(|segment| segment.path == Path::Line)
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
