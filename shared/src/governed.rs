//! Whether a feed law may govern a move that a cut rule matches.
//!
//! A law of the tool's side describes motion across the tool's axis, at a known spindle speed, with the job's tool. Any other
//! move keeps its programmed feed:
//!
//! ```text
//! plunge, ramp, helix:  |path along the axis| > sin(1 degree) * path       (1)
//! roll-in:              an arc whose plane contains the tool's axis
//! other tool:           T and M6 have loaded another one than the job's, or an unknown one
//! spindle:              off, at S0, or at a speed that neither the program nor the job states
//! ```
//!
//! The table law has its feed from elsewhere and may follow any path. Source: docs/safety-case.md.

use crate::cut::{self, CutRule};
use crate::job::{Job, LawKind, SpeedSource, ToolAxis};
use crate::machine::{FeedLimit, LimitedBy};
use crate::nc::machining::{Machining, SpindleCommand, ToolInSpindle};
use crate::segment::{Path, Segment};
use crate::units::{MmPerMin, Nm, RevPerMin};

/// Largest sine of the angle between a governed path and the plane across the tool's axis: 1 degree. (1)
pub const AXIAL_SINE_MAX: f64 = 0.017_452_406_437_283_51;

/// What a job says of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Match<'r> {
    /// No cut rule matches it.
    NoRule,
    /// A cut rule matches it, but it keeps its programmed feed.
    Excluded {
        /// Index of the rule.
        index: usize,
        /// Why.
        why: Exclusion,
    },
    /// The law governs it.
    Governed(Governing<'r>),
}

/// What governs a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Governing<'r> {
    /// Index of the cut rule among the job's.
    pub index: usize,
    /// That rule.
    pub rule: &'r CutRule,
    /// Commanded spindle speed.
    pub spindle: RevPerMin,
}

/// Why a move that a cut rule matches keeps its programmed feed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Exclusion {
    /// It runs along the tool's axis, or turns about a line across it.
    Axial,
    /// The program has loaded another tool than the job's.
    Tool,
    /// The spindle is off, or its speed is stated nowhere.
    Spindle,
}

impl<'r> Match<'r> {
    /// What governs the move, if anything does.
    pub fn governing(self) -> Option<Governing<'r>> {
        match self {
            Match::Governed(governing) => Some(governing),
            Match::NoRule | Match::Excluded { .. } => None,
        }
    }
}

impl Job {
    /// What this job says of a move, with tool and spindle as the program has commanded them.
    pub fn match_move(&self, segment: &Segment, machining: &Machining) -> Match<'_> {
        let Some((index, rule)) = cut::find(&self.rules, segment, &self.tool) else { return Match::NoRule };
        let is_described = self.law == LawKind::Table || is_across(segment, self.setup.axis);
        match self.speed(machining.spindle) {
            _ if !is_described => Match::Excluded { index, why: Exclusion::Axial },
            _ if !self.is_own_tool(machining.tool) => Match::Excluded { index, why: Exclusion::Tool },
            None => Match::Excluded { index, why: Exclusion::Spindle },
            Some(spindle) => Match::Governed(Governing { index, rule, spindle }),
        }
    }

    /// The fastest feed on a move that a law governs; `programmed` is its F in the program.
    pub fn feed_limit(&self, segment: &Segment, programmed: Option<Nm>) -> Option<FeedLimit> {
        let feed = MmPerMin(self.ceiling.feed_mm_per_min(programmed) as f32);
        let ceiling = Some(FeedLimit { feed, by: LimitedBy::Ceiling }).filter(|_| feed.0.is_finite());
        match (self.machine.feed_limit(segment), ceiling) {
            (Some(machine), Some(ceiling)) => Some(machine.lower(ceiling)),
            (one, other) => one.or(other),
        }
    }

    /// The spindle speed of a governed move: the program's, or the job's where the operator sets it.
    pub fn speed(&self, command: SpindleCommand) -> Option<RevPerMin> {
        match (command, self.setup.speed_source) {
            (SpindleCommand::RevPerMin(speed), _) => Some(RevPerMin(speed as f32)),
            (SpindleCommand::Unstated, SpeedSource::Operator) => Some(self.spindle),
            (SpindleCommand::Unstated, SpeedSource::Program) | (SpindleCommand::Stopped, _) => None,
        }
    }

    /// Whether a tool is the job's. Without a number of its own, the job is for the tool that the operator has loaded.
    pub fn is_own_tool(&self, tool: ToolInSpindle) -> bool {
        match tool {
            ToolInSpindle::Unstated => true,
            ToolInSpindle::Number(number) => self.setup.tool_number == Some(number),
            ToolInSpindle::Unknown => false,
        }
    }
}

/// Whether a move stays across the tool's axis. (1)
pub fn is_across(segment: &Segment, axis: ToolAxis) -> bool {
    let ends = [&segment.start, &segment.end].map(|pose| pose.linear.get(axis.index()).copied().unwrap_or_default());
    let [from, to] = ends.map(Nm::to_mm);
    let is_in_plane = match &segment.path {
        Path::Rapid | Path::Line => true,
        Path::Arc(arc) => arc.plane.axes().2 == axis.index(),
    };
    is_in_plane && libm::fabs(to - from) <= AXIAL_SINE_MAX * segment.length_mm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cut::{Moves, Side, Work};
    use crate::job::{FeedPolicy, OverrideLimits, Setup};
    use crate::knots::Knots;
    use crate::machine::MachineLimits;
    use crate::nc::modal::{Feed, Plane, Pose, Turn};
    use crate::segment::Arc;
    use crate::tool::{EndMill, Tool};
    use crate::units::{LengthUnit, MmPerTooth};

    const ON: Machining = Machining { tool: ToolInSpindle::Unstated, spindle: SpindleCommand::RevPerMin(900) };

    fn job(law: LawKind) -> Job {
        let work = Work::Mill { side: Side::Inside, radial_depth: Nm(1_000_000) };
        let rule = |moves| CutRule {
            moves,
            work: work.clone(),
            feed_per_tooth: None,
            table: None,
            sequence: None,
            level: None,
        };
        Job {
            unit: LengthUnit::Mm,
            tool: Tool::EndMill(EndMill { radius: Nm(5_000_000), teeth: 2 }),
            setup: Setup { tool_number: Some(3), ..Setup::default() },
            spindle: RevPerMin(1_000.0),
            law,
            feed_per_tooth: MmPerTooth(0.1),
            policy: FeedPolicy::SafeBase,
            limits: OverrideLimits::default(),
            ceiling: Default::default(),
            machine: MachineLimits::default(),
            rules: [Moves::Lines, Moves::Arcs(Turn::Ccw)].map(rule).into_iter().collect(),
            knots: Knots::default(),
        }
    }

    fn line(to_mm: [f64; 3]) -> Segment {
        let end = Pose { linear: to_mm.map(Nm::from_mm), ..Pose::default() };
        Segment { sequence: None, start: Pose::default(), end, feed: Feed::Missing, path: Path::Line }
    }

    /// A quarter about a point 10 mm away, with the plane's normal moving this far.
    fn arc(plane: Plane, rise_mm: f64) -> Segment {
        let (first, second, normal) = plane.axes();
        let mut end = Pose::default();
        end.linear[first] = Nm(-10_000_000);
        end.linear[second] = Nm(10_000_000);
        end.linear[normal] = Nm::from_mm(rise_mm);
        let (from, to) = ([Nm(10_000_000), Nm(0)], [Nm(0), Nm(10_000_000)]);
        let path = Path::Arc(Arc { plane, turn: Turn::Ccw, center: [Nm(-10_000_000), Nm(0)], from, to });
        Segment { path, end, ..line([0.0; 3]) }
    }

    fn why(job: &Job, segment: &Segment, machining: &Machining) -> Option<Exclusion> {
        match job.match_move(segment, machining) {
            Match::Excluded { why, .. } => Some(why),
            Match::Governed(_) => None,
            Match::NoRule => panic!("a rule matches every move of these tests"),
        }
    }

    #[test]
    fn plunges_ramps_helices_and_roll_ins_keep_their_feed() {
        let axial = Some(Exclusion::Axial);
        for (segment, expected) in [
            (line([10.0, 0.0, 0.0]), None),
            (line([0.0, 0.0, -5.0]), axial),
            (line([0.0, 0.0, 5.0]), axial),
            (line([10.0, 0.0, -0.174]), None),
            (line([10.0, 0.0, -0.175]), axial),
            (line([10.0, 0.0, 1.0]), axial),
            (arc(Plane::Xy, 0.0), None),
            (arc(Plane::Xy, -0.27), None),
            (arc(Plane::Xy, -0.28), axial),
            (arc(Plane::Zx, 0.0), axial),
            (arc(Plane::Yz, 0.0), axial),
        ] {
            for law in [LawKind::Engagement, LawKind::Contour { inside_only: false, floor_ratio: 0.0 }] {
                assert_eq!(why(&job(law), &segment, &ON), expected, "{segment:?}");
            }
            assert_eq!(why(&job(LawKind::Table), &segment, &ON), None, "a table follows any path: {segment:?}");
        }
    }

    #[test]
    fn with_the_axis_along_y_the_plane_is_g18() {
        let mut job = job(LawKind::Engagement);
        job.setup.axis = ToolAxis::Y;
        assert_eq!(why(&job, &arc(Plane::Zx, 0.0), &ON), None);
        assert_eq!(why(&job, &arc(Plane::Xy, 0.0), &ON), Some(Exclusion::Axial));
        assert_eq!(why(&job, &line([0.0, 5.0, 0.0]), &ON), Some(Exclusion::Axial));
    }

    #[test]
    fn only_the_jobs_own_tool_is_governed() {
        let (own, cut) = (job(LawKind::Engagement), line([1.0, 0.0, 0.0]));
        let unnumbered = Job { setup: Setup::default(), ..own.clone() };
        for (tool, of_own, of_unnumbered) in [
            (ToolInSpindle::Unstated, None, None),
            (ToolInSpindle::Number(3), None, Some(Exclusion::Tool)),
            (ToolInSpindle::Number(4), Some(Exclusion::Tool), Some(Exclusion::Tool)),
            (ToolInSpindle::Unknown, Some(Exclusion::Tool), Some(Exclusion::Tool)),
        ] {
            let machining = Machining { tool, ..ON };
            assert_eq!(why(&own, &cut, &machining), of_own, "{tool:?}");
            assert_eq!(why(&unnumbered, &cut, &machining), of_unnumbered, "{tool:?}");
        }
    }

    #[test]
    fn a_move_is_governed_at_the_speed_that_is_commanded_or_not_at_all() {
        let (by_program, cut) = (job(LawKind::Engagement), line([1.0, 0.0, 0.0]));
        let mut by_operator = by_program.clone();
        by_operator.setup.speed_source = SpeedSource::Operator;
        for (spindle, of_program, of_operator) in [
            (SpindleCommand::RevPerMin(900), Some(900.0), Some(900.0)),
            (SpindleCommand::Unstated, None, Some(1_000.0)),
            (SpindleCommand::Stopped, None, None),
        ] {
            let machining = Machining { spindle, ..ON };
            let speed = |job: &Job| job.match_move(&cut, &machining).governing().map(|governing| governing.spindle.0);
            assert_eq!((speed(&by_program), speed(&by_operator)), (of_program, of_operator), "{spindle:?}");
        }
    }
}
