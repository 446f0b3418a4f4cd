//! Cut rules of a job (`[[cut]]`): the moves to which a feed law applies, and the stock there.
//!
//! A rule matches a ring's arc by its radius (the ring's inner or outer radius within 0.1 %) and its sense, and an end
//! mill's move by its shape (line or arc) and the arc's sense. A range of sequence numbers or of levels may restrict
//! it further. The rules of the tool in the spindle are tried in order; the first match applies.

use crate::knots::KnotRange;
use crate::stock::Stock;
use crate::tool::{CupMill, Edge, Tool};
use arcfeed_nc::modal::Turn;
use arcfeed_nc::segment::{Arc, Path, Segment};
use arcfeed_units::{MmPerTooth, Nm};

/// Most rules in a job.
pub const RULES_MAX: usize = 16;
/// Largest relative difference of an arc's radius from the ring's.
pub const RADIUS_MATCH_RATIO: f64 = 1e-3;

/// Cut rule, one `[[cut]]` of a job: the moves to which a law applies, and the stock that they cut.
#[derive(Clone, Debug, PartialEq)]
pub struct CutRule {
    /// Index of its tool in the job.
    pub tool: u8,
    /// Moves to which it applies.
    pub moves: Moves,
    /// Material that they cut, and the cutting edge.
    pub work: Work,
    /// Target feed per tooth; `None` means the tool's.
    pub feed_per_tooth: Option<MmPerTooth>,
    /// Knots of the rule in the job's store, for the table law.
    pub table: Option<KnotRange>,
    /// First and last sequence number, if restricted.
    pub sequence: Option<(i64, i64)>,
    /// Lowest and highest Z at the start of the move, if restricted.
    pub level: Option<(Nm, Nm)>,
}

/// Moves to which a rule applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moves {
    /// Arcs of a ring about a point on one of its circles.
    Rotations(RotationCircle, Turn),
    /// Arcs in one sense.
    Arcs(Turn),
    /// Straight cutting moves.
    Lines,
}

/// Material that a move cuts, and the cutting edge.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to box into, and a job has few rules")]
pub enum Work {
    /// A ring cuts this stock with one of its circles. An end mill counts as a ring without a bore: it cuts with the
    /// outer circle.
    Ring(Edge, Stock),
    /// An end mill cuts along a contour.
    Mill {
        /// Side of the contour on which the tool runs.
        side: ContourSide,
        /// Radial depth of cut, ae.
        radial_depth: Nm,
    },
}

/// Side of a contour on which a tool runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContourSide {
    /// Inside a concave arc: the contour is longer than the path of the tool's centre.
    Inside,
    /// Outside a convex arc: the contour is shorter than the path of the tool's centre.
    Outside,
    /// Both walls at once. Their demands oppose each other; the inside wall has the thicker chip and decides.
    Slot,
}

/// Circle of the ring on which the rotation centre lies (Petean table 5.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RotationCircle {
    /// A point on the inner circle: the arc has the inner radius.
    Interior,
    /// A point on the outer circle: the arc has the outer radius.
    Exterior,
}

impl CutRule {
    /// Whether this rule applies to `segment`.
    pub fn fits(&self, segment: &Segment, tool: &Tool) -> bool {
        let [_, _, z] = segment.start.linear;
        let in_sequence =
            self.sequence.is_none_or(|(first, last)| segment.sequence.is_some_and(|n| (first..=last).contains(&n)));
        let in_level = self.level.is_none_or(|(low, high)| (low..=high).contains(&z));
        in_sequence && in_level && self.moves.include(segment, tool)
    }

    /// The rule with this side of the contour, for a move that runs there; an end mill in a slot keeps the side
    /// `slot`.
    #[must_use]
    pub fn on_side(&self, side: ContourSide) -> Self {
        let mut rule = self.clone();
        if let Work::Mill { side: own, .. } = &mut rule.work
            && *own != ContourSide::Slot
        {
            *own = side;
        }
        rule
    }

    /// Whether the rule expects the engagement with each move, in place of a fixed stock.
    pub const fn expects_engagement_per_move(&self) -> bool {
        matches!(self.work, Work::Ring(_, Stock::PerMove))
    }
}

impl Moves {
    fn include(self, segment: &Segment, tool: &Tool) -> bool {
        match (self, &segment.path, tool) {
            (Moves::Rotations(rotation, turn), Path::Arc(arc), Tool::CupMill(ring)) => {
                arc.turn == turn && rotation.is_of(arc, ring)
            }
            (Moves::Arcs(turn), Path::Arc(arc), _) => arc.turn == turn,
            (Moves::Lines, Path::Line, _) => true,
            (Moves::Rotations(..) | Moves::Arcs(_) | Moves::Lines, ..) => false,
        }
    }
}

impl RotationCircle {
    fn is_of(self, arc: &Arc, tool: &CupMill) -> bool {
        let radius_mm = match self {
            RotationCircle::Interior => tool.inner_radius,
            RotationCircle::Exterior => tool.outer_radius,
        }
        .to_mm();
        libm::fabs(arc.radius_mm() - radius_mm) <= RADIUS_MATCH_RATIO * radius_mm
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stock::StockLine;
    use arcfeed_nc::modal::{Feed, Plane, Pose};

    const TOOL: Tool =
        Tool::CupMill(CupMill { outer_radius: Nm(128_000_000), inner_radius: Nm(112_000_000), active_teeth: 10 });

    fn rule(turn: Turn) -> CutRule {
        CutRule {
            tool: 0,
            moves: Moves::Rotations(RotationCircle::Interior, turn),
            work: Work::Ring(Edge::Outer, Stock::half_plane(StockLine::from_angle(0.0, 0.0))),
            feed_per_tooth: None,
            table: None,
            sequence: None,
            level: None,
        }
    }

    fn segment(radius_nm: i64, sequence: Option<i64>, z: Nm) -> Segment {
        let pose = Pose { linear: [Nm(0), Nm(0), z], ..Pose::default() };
        Segment {
            sequence,
            start: pose,
            end: pose,
            feed: Feed::Missing,
            path: Path::Arc(Arc {
                plane: Plane::Xy,
                turn: Turn::Ccw,
                center: [Nm(0); 2],
                from: [Nm(radius_nm), Nm(0)],
                to: [Nm(0), Nm(radius_nm)],
            }),
        }
    }

    fn fits(rule: &CutRule, segment: &Segment) -> bool {
        rule.fits(segment, &TOOL)
    }

    #[test]
    fn an_arc_is_recognised_by_its_radius_within_a_thousandth() {
        let rule = rule(Turn::Ccw);
        assert!(fits(&rule, &segment(112_111_000, None, Nm(0))));
        assert!(!fits(&rule, &segment(112_113_000, None, Nm(0))));
        assert!(!fits(&rule, &segment(128_000_000, None, Nm(0))));
    }

    #[test]
    fn sense_sequence_and_level_narrow_a_rule() {
        let arc = segment(112_000_000, Some(144), Nm(-5));
        assert!(!fits(&rule(Turn::Cw), &arc));
        let numbered = |range| CutRule { sequence: Some(range), ..rule(Turn::Ccw) };
        assert!(fits(&numbered((144, 152)), &arc));
        assert!(!fits(&numbered((145, 152)), &arc));
        assert!(!fits(&numbered((144, 152)), &segment(112_000_000, None, Nm(-5))));
        let level = |low, high| CutRule { level: Some((Nm(low), Nm(high))), ..rule(Turn::Ccw) };
        assert!(fits(&level(-5, 0), &arc));
        assert!(!fits(&level(-4, 0), &arc));
    }

    #[test]
    fn an_end_mills_arcs_have_any_radius_and_its_lines_are_no_arcs() {
        let moves = |moves| CutRule { moves, ..rule(Turn::Ccw) };
        let arc = segment(3_000_000, None, Nm(0));
        let line = Segment { path: Path::Line, ..arc };
        assert!(fits(&moves(Moves::Arcs(Turn::Ccw)), &arc) && !fits(&moves(Moves::Arcs(Turn::Cw)), &arc));
        assert!(fits(&moves(Moves::Lines), &line) && !fits(&moves(Moves::Lines), &arc));
    }
}
