//! Contour law: constant feed along the finished contour, like Siemens' CFC and CFIN, Heidenhain's M109 and M110, and
//! Fanuc's internal circular feed.
//!
//! The contour's radius Rc is the path radius q of the tool's centre plus (inside) or minus (outside) the tool's
//! radius r. For a feed F at the contour, the centre moves at
//!
//! ```text
//! inside:   F q/(q + r) = F (Rc - r)/Rc        (1)
//! outside:  F q/(q - r) = F (Rc + r)/Rc        (2)
//! ```
//!
//! The law ignores engagement and differs strongly from the engagement law. Special cases: a tool as large as the arc
//! would stop (floor), an outside arc would be accelerated (inside-only mode), and the walls of a slot have opposite
//! demands (the inside wall decides).
//!
//! Source: docs/laws.md#contour (808D advanced manual p. 79; calculator pages quoted there).

use arcfeed_model::cut::ContourSide;
use arcfeed_units::{Mm, MmPerTooth};

use super::{FeedDemand, FeedLaw, NoDemand, Place};

/// Limits of the contour law, which keeps the feed along the finished contour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContourLimits {
    /// Whether outside arcs have the target feed per tooth at the centre instead of a raised one (CFIN, M110).
    pub inside_only: bool,
    /// Smallest feed of the tool's centre, as a fraction of the feed at the contour; it acts on tight inside arcs.
    pub floor_ratio: f32,
}

/// Contour law prepared for one segment: the tool's centre moves so that the feed along the finished contour is the
/// target. Its demand is the same everywhere on the segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contour {
    demand: Result<FeedDemand, NoDemand>,
}

impl Contour {
    /// Prepares the law for a path of the tool's centre with this radius (infinite for a line); a is the target feed
    /// per tooth at the contour.
    pub fn new(path_radius: Mm, tool_radius: Mm, side: ContourSide, a: MmPerTooth, limits: ContourLimits) -> Self {
        Contour { demand: demand(path_radius.0, tool_radius.0, side, a.0, limits) }
    }
}

impl FeedLaw for Contour {
    fn demand(&self, _: &Place) -> Result<FeedDemand, NoDemand> {
        self.demand
    }

    fn is_uniform(&self) -> bool {
        true
    }
}

fn demand(q_mm: f32, r_mm: f32, side: ContourSide, a: f32, limits: ContourLimits) -> Result<FeedDemand, NoDemand> {
    if !(q_mm >= 0.0 && r_mm > 0.0 && a > 0.0 && a.is_finite() && r_mm.is_finite() && limits.floor_ratio >= 0.0) {
        return Err(NoDemand::BadInput);
    }
    let factor = match side {
        _ if q_mm.is_infinite() => 1.0,
        ContourSide::Inside | ContourSide::Slot => q_mm / (q_mm + r_mm), // (1)
        ContourSide::Outside if limits.inside_only => 1.0,
        // A tool's centre on a smaller circle than the tool itself cannot be outside a contour.
        ContourSide::Outside if q_mm <= r_mm => return Err(NoDemand::OutsideValidity),
        ContourSide::Outside => q_mm / (q_mm - r_mm), // (2)
    };
    let path_mm_per_tooth = a * factor.max(limits.floor_ratio);
    if path_mm_per_tooth > 0.0 && path_mm_per_tooth.is_finite() {
        Ok(FeedDemand { path_mm_per_tooth, contact: [0.0, if side == ContourSide::Outside { 1.0 } else { -1.0 }] })
    } else {
        Err(NoDemand::OutsideValidity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FREE: ContourLimits = ContourLimits { inside_only: false, floor_ratio: 0.0 };

    fn feed(q: f32, side: ContourSide, limits: ContourLimits) -> Result<f32, NoDemand> {
        Contour::new(Mm(q), Mm(2.0), side, MmPerTooth(0.1), limits).demand.map(|demand| demand.path_mm_per_tooth)
    }

    #[test]
    fn inside_only_never_raises_a_feed() {
        let inside_only = ContourLimits { inside_only: true, ..FREE };
        assert_eq!(feed(10.0, ContourSide::Outside, inside_only), Ok(0.1));
        assert!(feed(10.0, ContourSide::Outside, FREE).unwrap() > 0.1);
        assert!(feed(10.0, ContourSide::Inside, inside_only).unwrap() < 0.1);
    }

    #[test]
    fn a_tool_that_fills_its_arc_keeps_moving_at_the_floor() {
        let floor = ContourLimits { floor_ratio: 0.25, ..FREE };
        assert_eq!(feed(0.0, ContourSide::Inside, floor), Ok(0.025));
        assert_eq!(feed(0.0, ContourSide::Inside, FREE), Err(NoDemand::OutsideValidity));
    }

    #[test]
    fn a_line_keeps_its_feed() {
        assert_eq!(feed(f32::INFINITY, ContourSide::Inside, FREE), Ok(0.1));
        assert_eq!(feed(f32::INFINITY, ContourSide::Outside, FREE), Ok(0.1));
    }
}
