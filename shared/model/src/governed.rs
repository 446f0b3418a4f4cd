//! Decides whether a feed law may govern a move that a cut rule matches.
//!
//! A law for peripheral cutting describes motion across the tool's axis, at a known spindle speed, with a tool of the
//! job. The rules of that tool are tried. Any other move keeps its programmed feed:
//!
//! ```text
//! plunge, ramp, helix:  |path along the axis| > sin(1 degree) * path       (1)
//!                       of these a plunge: path across the axis <= 0.001 * path along it, straight   (2)
//! roll-in:              an arc whose plane contains the tool's axis
//! rotary:               A, B or C turns with it, and F counts degrees
//! other tool:           T and M6 have loaded one that the job doesn't have, or an unknown one
//! spindle:              off, at S0, or at a speed that neither the program nor the job states
//! ```
//!
//! The table law takes its feed from the job and may follow any path. Source: docs/safety-case.md.

use crate::cut::CutRule;
use crate::job::{Job, LawKind, SpeedSource, ToolAxis, ToolSetup};
use crate::machine::{FeedLimit, LimitedBy};
use arcfeed_nc::machining::{Machining, SpindleCommand, ToolInSpindle};
use arcfeed_nc::modal::Pose;
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::{MmPerMin, Nm, RevPerMin};

/// Sine of the largest angle (1 degree) between a move and the plane across the tool's axis at which a law for
/// peripheral cutting may govern the move. (1)
pub const AXIAL_SINE_MAX: f64 = 0.017_452_406_437_283_51;

/// Largest displacement across the tool's axis on a plunge, divided by the displacement along it. (2)
pub const PLUNGE_OFF_MAX: f64 = 1e-3;

/// Result of matching a move with the cut rules of a job.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Match<'r> {
    /// No cut rule matches the move.
    NoRule,
    /// A cut rule matches the move, but the move keeps its programmed feed.
    Excluded {
        /// Index of the rule in the job, from 0.
        index: usize,
        /// Reason why no law governs the move.
        why: Exclusion,
    },
    /// The law of the rule's tool governs the move.
    Governed(Governing<'r>),
}

/// Cut rule that governs a move, and the spindle speed for which its law computes the feed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Governing<'r> {
    /// Index of the cut rule in the job, from 0.
    pub index: usize,
    /// The cut rule.
    pub rule: &'r CutRule,
    /// Spindle speed: the program's, or the job's if the operator sets it.
    pub spindle: RevPerMin,
}

/// Reason why a move that a cut rule matches keeps its programmed feed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Exclusion {
    /// The move climbs or descends by more than 1 degree from the plane across the tool's axis, or is an arc whose
    /// plane contains that axis.
    Axial,
    /// A rotary axis turns during the move, so F is not a feed along the path.
    Rotary,
    /// The program has loaded a tool that the job does not have.
    Tool,
    /// The spindle is stopped, or neither the program nor the job states its speed.
    Spindle,
}

impl<'r> Match<'r> {
    /// The rule that governs the move, with the spindle speed for its law; `None` if no rule matches, or if the matching rule does not govern the move.
    pub fn governing(self) -> Option<Governing<'r>> {
        match self {
            Match::Governed(governing) => Some(governing),
            Match::NoRule | Match::Excluded { .. } => None,
        }
    }
}

impl Job {
    /// Finds the first cut rule for a move and decides whether its law may govern the move. `machining` is the tool in
    /// the spindle and the spindle command that the program has in force there.
    pub fn match_move(&self, segment: &Segment, machining: &Machining) -> Match<'_> {
        self.match_among(segment, machining, |_| true)
    }

    /// As [`Job::match_move`], but considers only rules for whose index (from 0) `admits` returns true.
    pub fn match_among(&self, segment: &Segment, machining: &Machining, admits: impl Fn(usize) -> bool) -> Match<'_> {
        let Some((index, rule)) = self.rule_among(segment, machining.tool, admits) else { return Match::NoRule };
        let setup = self.tool_of(rule);
        let is_described = setup.law == LawKind::Table || is_across(segment, setup.axis);
        match setup.speed(machining.spindle) {
            _ if segment.start.rotary != segment.end.rotary => Match::Excluded { index, why: Exclusion::Rotary },
            _ if !is_described => Match::Excluded { index, why: Exclusion::Axial },
            _ if self.tool_in(machining.tool).is_none() => Match::Excluded { index, why: Exclusion::Tool },
            None => Match::Excluded { index, why: Exclusion::Spindle },
            Some(spindle) => Match::Governed(Governing { index, rule, spindle }),
        }
    }

    /// First rule that matches the move and belongs to the tool in the spindle, with its index from 0. If the job does
    /// not have this tool, the first rule of any tool that matches the move.
    pub fn rule_for(&self, segment: &Segment, tool: ToolInSpindle) -> Option<(usize, &CutRule)> {
        self.rule_among(segment, tool, |_| true)
    }

    /// As [`Job::rule_for`], but considers only rules for whose index (from 0) `admits` returns true.
    pub fn rule_among(
        &self,
        segment: &Segment,
        tool: ToolInSpindle,
        admits: impl Fn(usize) -> bool,
    ) -> Option<(usize, &CutRule)> {
        let loaded = self.tool_in(tool);
        let is_tried = |rule: &CutRule| loaded.is_none_or(|index| usize::from(rule.tool) == index);
        let fits = |rule: &CutRule| is_tried(rule) && rule.fits(segment, &self.tool_of(rule).tool);
        self.rules.iter().enumerate().find(|(index, rule)| fits(rule) && admits(*index))
    }

    /// Settings of the tool in the spindle; those of the job's first tool if the job does not have it.
    pub fn setup_in(&self, tool: ToolInSpindle) -> &ToolSetup {
        self.tool_in(tool).and_then(|index| self.tools.get(index)).unwrap_or(self.tools.first())
    }

    /// Index of the spindle's tool in the job, from 0; `None` if the job does not have it. If the program loads no
    /// tool and the job has only one, that one is assumed to be loaded.
    pub fn tool_in(&self, tool: ToolInSpindle) -> Option<usize> {
        match tool {
            ToolInSpindle::Unstated => (self.tools.len() == 1).then_some(0),
            ToolInSpindle::Number(number) => self.tools.iter().position(|setup| setup.number == Some(number)),
            ToolInSpindle::Unknown => None,
        }
    }

    /// Upper limit of the feed on a move that a law governs: the lowest of the axis limits, the control's arc clamp,
    /// and the job's ceiling. Returns `None` if none of them is known.
    /// `programmed` is F in the program, nm/min, of which a ceiling in per cent is computed; `None` if the program has none there.
    pub fn feed_limit(&self, segment: &Segment, programmed: Option<Nm>) -> Option<FeedLimit> {
        let feed = MmPerMin(self.ceiling.feed_mm_per_min(programmed) as f32);
        let ceiling = Some(FeedLimit { feed, by: LimitedBy::Ceiling }).filter(|_| feed.0.is_finite());
        match (self.machine.feed_limit(segment), ceiling) {
            (Some(machine), Some(ceiling)) => Some(machine.lower(ceiling)),
            (one, other) => one.or(other),
        }
    }
}

impl ToolSetup {
    /// Spindle speed for which the law computes: the program's, or the job's if the program states none and the
    /// operator sets it. `None` if the spindle is stopped or its speed is unknown.
    pub fn speed(&self, command: SpindleCommand) -> Option<RevPerMin> {
        match (command, self.speed_source) {
            (SpindleCommand::RevPerMin(speed), _) => Some(RevPerMin(speed as f32)),
            (SpindleCommand::Unstated, SpeedSource::Operator) => Some(self.spindle),
            (SpindleCommand::Unstated, SpeedSource::Program) | (SpindleCommand::Stopped, _) => None,
        }
    }
}

/// A straight move that goes down along the tool's axis (towards its tip) at more than 1 degree: a plunge or a ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Descent {
    /// Sine of the angle between the move and the plane across the axis: 1 for a move exactly along the axis.
    pub sine_ratio: f64,
}

impl Descent {
    /// The descent of a move; `None` for arcs, for moves that climb or stay within 1 degree of the plane across the
    /// axis, and where a rotary axis turns.
    pub fn of(segment: &Segment, axis: ToolAxis) -> Option<Self> {
        let along = |pose: &Pose| pose.linear.get(axis.index()).copied().unwrap_or_default().to_mm();
        let down_mm = along(&segment.start) - along(&segment.end);
        let is_straight = segment.path == Path::Line && segment.start.rotary == segment.end.rotary;
        let sine = down_mm / segment.length_mm();
        (is_straight && down_mm > 0.0 && sine > AXIAL_SINE_MAX).then_some(Descent { sine_ratio: sine })
    }

    /// Whether the move runs along the tool's axis, within 0.001 of its depth; otherwise it is a ramp. (2)
    pub fn is_plunge(&self) -> bool {
        libm::sqrt((1.0 - self.sine_ratio * self.sine_ratio).max(0.0)) <= PLUNGE_OFF_MAX * self.sine_ratio
    }
}

/// Whether a move stays within 1 degree of the plane across the tool's axis; an arc must also lie in that plane. (1)
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
    use crate::cut::{ContourSide, Moves, Work};
    use crate::job::{FeedPolicy, OverrideLimits, Tools};
    use crate::knots::Knots;
    use crate::machine::MachineLimits;
    use crate::tool::{EndMill, Tool};
    use arcfeed_nc::modal::{Feed, Plane, Turn};
    use arcfeed_nc::segment::Arc;
    use arcfeed_units::{LengthUnit, MmPerTooth};

    const ON: Machining = Machining { tool: ToolInSpindle::Unstated, spindle: SpindleCommand::RevPerMin(900) };

    fn mill(number: i64, law: LawKind) -> ToolSetup {
        let tool = Tool::EndMill(EndMill { radius: Nm(5_000_000), teeth: 2 });
        ToolSetup { number: Some(number), ..ToolSetup::new(tool, RevPerMin(1_000.0), law, MmPerTooth(0.1)) }
    }

    fn job(law: LawKind) -> Job {
        let work = Work::Mill { side: ContourSide::Inside, radial_depth: Nm(1_000_000) };
        let rule = |moves| CutRule {
            tool: 0,
            moves,
            work: work.clone(),
            feed_per_tooth: None,
            table: None,
            sequence: None,
            level: None,
        };
        Job {
            unit: LengthUnit::Mm,
            tools: Tools::one(mill(3, law)),
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

    /// A quarter turn of radius 10 mm that rises by this much along the plane's normal.
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
    fn a_descent_is_straight_and_downwards_and_a_plunge_is_one_along_the_axis() {
        let descent = |segment: &Segment| Descent::of(segment, ToolAxis::Z).map(|descent| descent.is_plunge());
        for (to_mm, expected) in [
            ([0.0, 0.0, -5.0], Some(true)),
            ([0.004, 0.0, -5.0], Some(true)),
            ([0.006, 0.0, -5.0], Some(false)),
            ([0.0, 0.0, 5.0], None),
            ([10.0, 0.0, -0.174], None),
            ([10.0, 0.0, -0.175], Some(false)),
            ([0.0; 3], None),
        ] {
            assert_eq!(descent(&line(to_mm)), expected, "{to_mm:?}");
        }
        assert_eq!(descent(&arc(Plane::Xy, -5.0)), None);
        assert_eq!(descent(&Segment { path: Path::Rapid, ..line([0.0, 0.0, -5.0]) }), None);
        let mut turns = line([0.0, 0.0, -5.0]);
        turns.end.rotary[0].0 = 1;
        assert_eq!(descent(&turns), None);
    }

    #[test]
    fn with_the_axis_along_y_the_plane_is_g18() {
        let mut job = job(LawKind::Engagement);
        job.tools.first_mut().axis = ToolAxis::Y;
        assert_eq!(why(&job, &arc(Plane::Zx, 0.0), &ON), None);
        assert_eq!(why(&job, &arc(Plane::Xy, 0.0), &ON), Some(Exclusion::Axial));
        assert_eq!(why(&job, &line([0.0, 5.0, 0.0]), &ON), Some(Exclusion::Axial));
    }

    #[test]
    fn only_the_jobs_own_tool_is_governed() {
        let (own, cut) = (job(LawKind::Engagement), line([1.0, 0.0, 0.0]));
        let unnumbered = Job { tools: Tools::one(ToolSetup { number: None, ..*own.tools.first() }), ..own.clone() };
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
        by_operator.tools.first_mut().speed_source = SpeedSource::Operator;
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

    #[test]
    fn each_tool_has_rules_law_and_speed_of_its_own() {
        let mut job = job(LawKind::Engagement);
        job.tools.push(ToolSetup { speed_source: SpeedSource::Operator, ..mill(8, LawKind::Table) }).expect("room");
        let lines = job.rules[0].clone();
        job.rules.push(CutRule { tool: 1, ..lines }).expect("room");
        let unstated = SpindleCommand::Unstated;
        let plunge = line([0.0, 0.0, -5.0]);
        for (tool, segment, spindle, expected) in [
            (ToolInSpindle::Number(3), line([1.0, 0.0, 0.0]), ON.spindle, Some((0, 900.0))),
            (ToolInSpindle::Number(8), line([1.0, 0.0, 0.0]), ON.spindle, Some((2, 900.0))),
            (ToolInSpindle::Number(3), line([1.0, 0.0, 0.0]), unstated, None),
            (ToolInSpindle::Number(8), line([1.0, 0.0, 0.0]), unstated, Some((2, 1_000.0))),
            (ToolInSpindle::Number(3), plunge, ON.spindle, None),
            (ToolInSpindle::Number(8), plunge, ON.spindle, Some((2, 900.0))),
            (ToolInSpindle::Number(3), arc(Plane::Xy, 0.0), ON.spindle, Some((1, 900.0))),
            (ToolInSpindle::Number(8), arc(Plane::Xy, 0.0), ON.spindle, None),
            (ToolInSpindle::Number(5), line([1.0, 0.0, 0.0]), ON.spindle, None),
            (ToolInSpindle::Unstated, line([1.0, 0.0, 0.0]), ON.spindle, None),
        ] {
            let governing = job.match_move(&segment, &Machining { tool, spindle }).governing();
            assert_eq!(
                governing.map(|governing| (governing.index, governing.spindle.0)),
                expected,
                "{tool:?} {segment:?}"
            );
        }
        let other = Machining { tool: ToolInSpindle::Number(5), ..ON };
        assert_eq!(why(&job, &line([1.0, 0.0, 0.0]), &other), Some(Exclusion::Tool));
    }
}
