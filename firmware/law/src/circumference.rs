//! Circumference law: constant feed per tooth on the cutting circle. The chip at the contact B with the stock line is
//! the target a.
//!
//! B is the intersection of cutting circle and stock line with u.(A - O) >= 0 and an advancing edge; if there are two,
//! the one with the thicker chip (smaller step). With n the line's unit normal and q the line's distance from O along
//! it:
//!
//! ```text
//! r0 u = q n +- sqrt((r0 - q)(r0 + q)) t,    t square to n        (1)
//! ```
//!
//! [`super::step`] gives the step for B.
//!
//! Source: Petean 2004, ch. 5, eqs 11-16; docs/laws.md#circumference for the errata and the validity.

use arcfeed_model::stock::StockLine;
use arcfeed_model::tool::Edge;
use arcfeed_nc::segment::Arc;
use arcfeed_units::fmath;
use arcfeed_units::{Mm, MmPerTooth, Nm};

use super::step::{Cut, PreparedCut};
use super::{FeedDemand, FeedLaw, NoDemand, Place};

/// Circumference law prepared for one arc of a cup mill: it keeps the feed per tooth on the cutting circle, at its
/// contact with the stock line, at the target. All lengths are relative to the rotation centre A.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circumference {
    cut: PreparedCut,
    edge_radius_mm: f32,
    path_radius_mm: f32,
    /// k on a counter-clockwise arc, -k on a clockwise one.
    advance_ratio: f32,
    /// Unit normal of the stock line.
    normal: [f32; 2],
    /// Distance of the stock line from A along the normal.
    offset_mm: f32,
}

/// Geometry from which the circumference law computes its demand along an arc, for analyses of the whole arc.
/// Positions are relative to the rotation centre A.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactGeometry {
    /// rho: radius of the path of the tool's centre about A, mm.
    pub path_radius_mm: f32,
    /// r0: radius of the circle that cuts, mm.
    pub edge_radius_mm: f32,
    /// k: 1 for the outer cutting circle, whose edges advance outward, -1 for the inner one.
    pub edge_sign: i8,
    /// a: target feed per tooth on the cutting circle.
    pub feed_per_tooth: MmPerTooth,
    /// k on a counter-clockwise arc, -k on a clockwise one.
    pub advance_sign: i8,
    /// Unit normal of the stock line, pointing out of the material.
    pub normal: [f32; 2],
    /// Distance of the stock line from A along the normal, mm.
    pub offset_mm: f32,
}

/// The intersections of cutting circle and stock line, r0 u in the moving frame: `foot` +- `half_chord`, mm.
/// Components along the edge's advance and towards A; the one with + is further in the direction of advance. NaN if
/// they do not intersect.
#[derive(Clone, Copy, Debug)]
struct Intersections {
    foot: [f32; 2],
    half_chord: [f32; 2],
}

/// An admissible intersection.
#[derive(Clone, Copy, Debug)]
struct Contact {
    denominator_mm: f32,
    direction: [f32; 2],
}

impl Circumference {
    /// Prepares the law for an arc that one cutting circle cuts; `stock` is the stock line at the arc's height.
    /// Computes in f64, because it runs once for each block.
    pub fn for_arc(arc: &Arc, edge_radius: Mm, edge: Edge, stock: &StockLine, feed_per_tooth: MmPerTooth) -> Self {
        let [nx, ny] = stock.normal;
        let path_radius = Mm(arc.radius_mm() as f32);
        let cut = Cut { path_radius, edge_radius, edge, feed_per_tooth };
        Circumference {
            cut: PreparedCut::new(&cut),
            // NaN is rejected at the end of every step.
            edge_radius_mm: if edge_radius.0 > 0.0 { edge_radius.0 } else { f32::NAN },
            path_radius_mm: if path_radius.0 > 0.0 { path_radius.0 } else { f32::NAN },
            advance_ratio: f32::from(edge.advance() * arc.turn.sign()),
            normal: [nx as f32, ny as f32],
            offset_mm: stock.distance_mm(arc.center.map(Nm::to_mm)) as f32,
        }
    }

    /// Geometry from which the demand along the arc is computed.
    pub fn geometry(&self) -> ContactGeometry {
        ContactGeometry {
            path_radius_mm: self.path_radius_mm,
            edge_radius_mm: self.edge_radius_mm,
            edge_sign: self.cut.edge_sign(),
            feed_per_tooth: self.cut.feed_per_tooth(Mm(self.edge_radius_mm)),
            advance_sign: if self.advance_ratio < 0.0 { -1 } else { 1 },
            normal: self.normal,
            offset_mm: self.offset_mm,
        }
    }

    fn intersections(&self, [x, y]: [f32; 2]) -> Intersections {
        let [nx, ny] = self.normal;
        // The line's normal in the moving frame; both intersections follow from it by signs.
        let normal_advance = self.advance_ratio * (ny * x - nx * y);
        let normal_towards = -(nx * x + ny * y);
        let distance_mm = self.offset_mm + self.path_radius_mm * normal_towards;
        let r0_mm = self.edge_radius_mm;
        let half_chord_mm = fmath::sqrt((r0_mm - distance_mm) * (r0_mm + distance_mm));
        // The sign that makes the intersection further in the direction of advance the first.
        let half_chord_mm = fmath::with_sign_of(half_chord_mm, normal_towards);
        Intersections {
            foot: [distance_mm * normal_advance, distance_mm * normal_towards],
            half_chord: [half_chord_mm * normal_towards, -half_chord_mm * normal_advance],
        } // (1)
    }

    fn contact(&self, direction: [f32; 2]) -> Result<Contact, NoDemand> {
        let [advance, towards] = direction;
        if towards < 0.0 {
            return Err(NoDemand::OutsideValidity);
        }
        Ok(Contact { denominator_mm: self.cut.denominator_mm(advance, towards)?, direction })
    }
}

impl Intersections {
    fn more_advanced(&self) -> [f32; 2] {
        let ([advance, towards], [more_advance, more_towards]) = (self.foot, self.half_chord);
        [advance + more_advance, towards + more_towards]
    }

    fn less_advanced(&self) -> [f32; 2] {
        let ([advance, towards], [more_advance, more_towards]) = (self.foot, self.half_chord);
        [advance - more_advance, towards - more_towards]
    }
}

impl FeedLaw for Circumference {
    /// Demand of the intersection with the thicker chip, or of the only admissible one.
    fn demand(&self, place: &Place) -> Result<FeedDemand, NoDemand> {
        let both = self.intersections(place.towards.map(|component| -component));
        let (first, second) = (both.more_advanced(), both.less_advanced());
        let [advance, towards] = both.foot;
        // All inputs are numbers, so only the root is NaN: there is no intersection.
        if first.iter().any(|mm| mm.is_nan()) && !(advance + towards + self.edge_radius_mm).is_nan() {
            return Err(NoDemand::NoContact);
        }
        let Contact { denominator_mm, direction } = match (self.contact(first), self.contact(second)) {
            (Ok(a), Ok(b)) => {
                if b.denominator_mm > a.denominator_mm {
                    b
                } else {
                    a
                }
            }
            (Ok(contact), Err(_)) | (Err(_), Ok(contact)) => contact,
            (Err(a), Err(b)) => return Err(if a == NoDemand::OutsideValidity { b } else { a }),
        };
        Ok(FeedDemand { path_mm_per_tooth: self.cut.path_per_tooth(denominator_mm)?.0, contact: direction })
    }
}
