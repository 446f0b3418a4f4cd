//! Engaged-arc law: the thickest chip anywhere on the engaged arc is the target a.
//!
//! For each edge of the ring (its own r0 and k) the thickest chip is at the engaged direction nearest to k v:
//!
//! ```text
//! k v engaged:      the step is a itself (its chord)                                    (1)
//! otherwise:        the least step over the ends of the engaged arc with k ux > 0       (2)
//! ```
//!
//! [`super::step`] gives the step for a contact. An end where no step reaches the chip does not limit the step; an
//! edge without a limiting end does not either. The smaller step of both edges decides (the thicker chip), or that of
//! the named edge. [`super::region`] gives the engaged arc, from a shape or from a table along the path. The law
//! equals the circumference law if the engaged arc lies on A's side of B.
//!
//! Source: docs/laws.md#engaged-arc (ours; the source knows one stock line and one edge).

use arcfeed_model::tool::Edge;
use arcfeed_units::{Mm, MmPerTooth};

use super::region::{CircleAt, Region};
use super::step::Cut;
use super::{FeedDemand, FeedLaw, NoDemand, Place};

/// Cutting circles of a cup mill on which the chip must not exceed the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgePolicy {
    /// Both: the one with the thicker chip decides.
    Both,
    /// Only this one; the other is ignored.
    Only(Edge),
}

/// Radii of a cup mill and of its path, and the target feed per tooth, for the engaged-arc law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// R: radius of the outer cutting circle.
    pub outer_radius: Mm,
    /// r: radius of the inner cutting circle; zero for a tool without a bore.
    pub inner_radius: Mm,
    /// rho: radius of the path of the tool's centre; infinite for a straight path.
    pub path_radius: Mm,
    /// a: target for the thickest chip.
    pub feed_per_tooth: MmPerTooth,
}

/// Engaged-arc law prepared for one segment: keeps the thickest chip anywhere on the engaged arc of a cup mill at the
/// target.
#[derive(Clone, Debug, PartialEq)]
pub struct EngagedArc {
    cuts: [Option<Cut>; 2],
    region: Region,
    /// Whether all numbers of ring and region are finite; otherwise a comparison with NaN would mean "no contact".
    is_sound: bool,
}

impl EngagedArc {
    /// Prepares the law for a segment; positions in `region`, the stock, are relative to the arc's rotation centre or
    /// the line's start.
    pub fn new(ring: Ring, policy: EdgePolicy, region: Region) -> Self {
        let cut = |edge, edge_radius: Mm| {
            let Ring { path_radius, feed_per_tooth, .. } = ring;
            let protected = policy == EdgePolicy::Both || policy == EdgePolicy::Only(edge);
            let exists = edge_radius.0 != 0.0;
            (protected && exists).then_some(Cut { path_radius, edge_radius, edge, feed_per_tooth })
        };
        let radii = [ring.outer_radius, ring.inner_radius];
        let is_sound = radii.iter().all(|radius| radius.0.is_finite()) && region.is_sound();
        let cuts = [cut(Edge::Outer, ring.outer_radius), cut(Edge::Inner, ring.inner_radius)];
        EngagedArc { cuts, region, is_sound }
    }

    /// Calls `take` with the position of each knot of the engagement table: path from the segment's start, mm. Never,
    /// if the stock is a shape.
    pub fn knots_mm(&self, take: &mut dyn FnMut(f32)) {
        if let Region::Engaged(table) = &self.region {
            table.knots().iter().for_each(|knot| take(knot.travelled.0));
        }
    }

    /// Demand of one edge.
    fn demand_of(&self, cut: &Cut, place: &Place) -> Result<FeedDemand, NoDemand> {
        let circle = CircleAt { edge: cut.edge, radius_mm: cut.edge_radius.0, place };
        if self.region.is_engaged_ahead(&circle) {
            let path_mm_per_tooth = cut.path_straight_ahead()?.0; // (1)
            return Ok(FeedDemand { path_mm_per_tooth, contact: [1.0, 0.0] });
        }
        let k = f32::from(cut.edge.advance());
        let mut least = Err(NoDemand::NoContact);
        self.region.ends(&circle, |contact| {
            let [advance, towards] = contact;
            let demand = cut.path_per_tooth(k * advance, towards); // (2)
            least = smaller(least, demand.map(|path| FeedDemand { path_mm_per_tooth: path.0, contact }));
        });
        least
    }
}

impl FeedLaw for EngagedArc {
    fn demand(&self, place: &Place) -> Result<FeedDemand, NoDemand> {
        let [x, y] = place.center_mm;
        if !(self.is_sound && [x, y, place.travelled_mm].iter().all(|number| number.is_finite())) {
            return Err(NoDemand::BadInput);
        }
        let demands = self.cuts.iter().flatten().map(|cut| self.demand_of(cut, place));
        demands.fold(Err(NoDemand::NoContact), smaller)
    }
}

/// The smaller step. A refusal does not limit the step, but bad input is never ignored.
fn smaller(one: Result<FeedDemand, NoDemand>, other: Result<FeedDemand, NoDemand>) -> Result<FeedDemand, NoDemand> {
    match (one, other) {
        (Err(NoDemand::BadInput), _) | (_, Err(NoDemand::BadInput)) => Err(NoDemand::BadInput),
        (Ok(a), Ok(b)) => Ok(if b.path_mm_per_tooth < a.path_mm_per_tooth { b } else { a }),
        (Ok(demand), Err(_)) | (Err(_), Ok(demand)) => Ok(demand),
        // An unreachable chip has priority, in any order of ends and edges.
        (Err(NoDemand::ChipUnreachable), Err(_)) | (_, Err(NoDemand::ChipUnreachable)) => {
            Err(NoDemand::ChipUnreachable)
        }
        (Err(NoDemand::NoContact), Err(other)) => Err(other),
        (Err(one), Err(_)) => Err(one),
    }
}
