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

/// Largest number of cut rules in a job.
pub const RULES_MAX: usize = 16;
/// Largest relative difference between an arc's radius and the cup mill's cutting radius at which a rule for rotations
/// still matches the arc.
pub const RADIUS_MATCH_RATIO: f64 = 1e-3;

/// Cut rule, one `[[cut]]` of a job: the moves to which a law applies, and the stock that they cut.
#[derive(Clone, Debug, PartialEq)]
pub struct CutRule {
    /// Index of the tool in the job's list of tools, from 0; the rule applies to moves with this tool only.
    pub tool: u8,
    /// Moves to which the rule applies.
    pub moves: Moves,
    /// Material beside these moves, and the cutting circle or side of the contour that is in it.
    pub work: Work,
    /// Target feed per tooth; `None`: that of the tool.
    pub feed_per_tooth: Option<MmPerTooth>,
    /// Under the table law: the rule's own knots, as a range of the list of knots that all rules of the job share.
    pub table: Option<KnotRange>,
    /// First and last sequence number (N word) to which the rule applies; `None`: every block.
    pub sequence: Option<(i64, i64)>,
    /// Lowest and highest Z at the start of a move to which the rule applies, in the program's coordinates; `None`:
    /// any.
    pub level: Option<(Nm, Nm)>,
}

/// Moves to which a rule applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moves {
    /// Arcs of a cup mill (a ring-shaped cutter) about a point on its inner or outer cutting circle, in one sense.
    Rotations(RotationCircle, Turn),
    /// Arcs in one sense (G02 or G03), whatever the radius.
    Arcs(Turn),
    /// Straight cutting moves.
    Lines,
}

/// Material that a move cuts, and the cutting edge.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to box into, and a job has few rules")]
pub enum Work {
    /// A cup mill cuts this stock with its outer or inner circle. An end mill counts as a cup mill without a bore: it
    /// cuts with the outer circle.
    Ring(Edge, Stock),
    /// An end mill cuts along a contour.
    Mill {
        /// Side of the contour on which the tool runs.
        side: ContourSide,
        /// Radial depth of cut, ae: measured across the path, in the tool's plane.
        radial_depth: Nm,
    },
}

/// Side of a contour on which a tool runs, seen from the arc of the contour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContourSide {
    /// Inside a concave arc: the contour is longer than the path of the tool's centre.
    Inside,
    /// Outside a convex arc: the contour is shorter than the path of the tool's centre.
    Outside,
    /// Both walls at once. Their demands oppose each other; the inside wall has the thicker chip and decides.
    Slot,
}

/// Cutting circle of a cup mill that passes through the rotation centre of an arc (Petean table 5.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RotationCircle {
    /// The rotation centre lies on the inner circle: the path of the tool's centre has the inner radius.
    Interior,
    /// The rotation centre lies on the outer circle: the path of the tool's centre has the outer radius.
    Exterior,
}

impl CutRule {
    /// Whether shape, sense, radius, sequence number and start level of `segment` match the rule. The caller has
    /// already checked that `tool` is the rule's.
    pub fn fits(&self, segment: &Segment, tool: &Tool) -> bool {
        let [_, _, z] = segment.start.linear;
        let in_sequence =
            self.sequence.is_none_or(|(first, last)| segment.sequence.is_some_and(|n| (first..=last).contains(&n)));
        let in_level = self.level.is_none_or(|(low, high)| (low..=high).contains(&z));
        in_sequence && in_level && self.moves.include(segment, tool)
    }

    /// Copy of the rule with this side of the contour. Returned unchanged for a cup mill, and for an end mill in a
    /// slot, which cuts both sides.
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

    /// Whether the engaged directions come separately with each move, because the rule has no fixed stock.
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
