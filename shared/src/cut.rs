//! Which arcs of a program cut what: the job's `[[cut]]` rules.
//!
//! An arc is recognised by what it turns about (its radius is the ring's inner or outer radius within 0.1 %) and its
//! sense, and may be narrowed by sequence number or level. Rules are tried in order; the first that fits counts.

use crate::nc::modal::Turn;
use crate::segment::{Arc, Segment};
use crate::stock::StockLine;
use crate::tool::{CupMill, Edge};
use crate::units::Nm;

/// Most rules in a job.
pub const RULES_MAX: usize = 16;
/// How far an arc's radius may lie from the ring's, relative.
pub const RADIUS_MATCH_RATIO: f64 = 1e-3;

/// One `[[cut]]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutRule {
    /// What the tool centre turns about.
    pub rotation: Rotation,
    /// In which sense.
    pub turn: Turn,
    /// The circle that cuts.
    pub edge: Edge,
    /// The stock limit in the arc's plane.
    pub stock: StockLine,
    /// First and last sequence number, if restricted.
    pub sequence: Option<(i64, i64)>,
    /// Lowest and highest Z, if restricted.
    pub level: Option<(Nm, Nm)>,
}

/// What the tool centre turns about (Petean table 5.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rotation {
    /// A point on the inner circle: the arc has the inner radius.
    Interior,
    /// A point on the outer circle: the arc has the outer radius.
    Exterior,
}

impl CutRule {
    /// Whether this rule speaks of `arc` in `segment`.
    pub fn fits(&self, segment: &Segment, arc: &Arc, tool: &CupMill) -> bool {
        let [_, _, z] = segment.start.linear;
        let in_sequence =
            self.sequence.is_none_or(|(first, last)| segment.sequence.is_some_and(|n| (first..=last).contains(&n)));
        let in_level = self.level.is_none_or(|(low, high)| (low..=high).contains(&z));
        self.turn == arc.turn && in_sequence && in_level && self.rotation.is_of(arc, tool)
    }
}

impl Rotation {
    fn is_of(self, arc: &Arc, tool: &CupMill) -> bool {
        let radius_mm = match self {
            Rotation::Interior => tool.inner_radius,
            Rotation::Exterior => tool.outer_radius,
        }
        .to_mm();
        libm::fabs(arc.radius_mm() - radius_mm) <= RADIUS_MATCH_RATIO * radius_mm
    }
}

/// The first rule that fits the segment.
pub fn find<'r>(rules: &'r [CutRule], segment: &Segment, tool: &CupMill) -> Option<&'r CutRule> {
    let arc = segment.arc()?;
    rules.iter().find(|rule| rule.fits(segment, arc, tool))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nc::modal::{Feed, Plane, Pose};
    use crate::segment::Path;

    const TOOL: CupMill = CupMill { outer_radius: Nm(128_000_000), inner_radius: Nm(112_000_000), active_teeth: 10 };

    const RULE: CutRule = CutRule {
        rotation: Rotation::Interior,
        turn: Turn::Ccw,
        edge: Edge::Outer,
        stock: StockLine { normal: [1.0, 0.0], offset_mm: 0.0 },
        sequence: None,
        level: None,
    };

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

    fn fits(rule: CutRule, segment: &Segment) -> bool {
        find(&[rule], segment, &TOOL).is_some()
    }

    #[test]
    fn an_arc_is_recognised_by_its_radius_within_a_thousandth() {
        assert!(fits(RULE, &segment(112_111_000, None, Nm(0))));
        assert!(!fits(RULE, &segment(112_113_000, None, Nm(0))));
        assert!(!fits(RULE, &segment(128_000_000, None, Nm(0))));
    }

    #[test]
    fn sense_sequence_and_level_narrow_a_rule() {
        let arc = segment(112_000_000, Some(144), Nm(-5));
        assert!(!fits(CutRule { turn: Turn::Cw, ..RULE }, &arc));
        let numbered = |range| CutRule { sequence: Some(range), ..RULE };
        assert!(fits(numbered((144, 152)), &arc));
        assert!(!fits(numbered((145, 152)), &arc));
        assert!(!fits(numbered((144, 152)), &segment(112_000_000, None, Nm(-5))));
        let level = |low, high| CutRule { level: Some((Nm(low), Nm(high))), ..RULE };
        assert!(fits(level(-5, 0), &arc));
        assert!(!fits(level(-4, 0), &arc));
    }

    #[test]
    fn the_first_rule_that_fits_counts() {
        let inner = CutRule { edge: Edge::Inner, ..RULE };
        let rules = [inner, RULE];
        let found = find(&rules, &segment(112_000_000, None, Nm(0)), &TOOL);
        assert_eq!(found.map(|rule| rule.edge), Some(Edge::Inner));
    }
}
