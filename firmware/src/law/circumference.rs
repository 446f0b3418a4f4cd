//! Constant feed per tooth on the cutting circumference: the chip at the contact B with the stock line is a.
//!
//! B is the intersection of cutting circle and stock line with u.(A - O) >= 0 and an advancing edge, of two the one with
//! the thicker chip (smaller step). With n the line's unit normal and q the line's distance from O along it:
//!
//! ```text
//! r0 u = q n +- sqrt((r0 - q)(r0 + q)) t,    t square to n        (1)
//! ```
//!
//! The step for it is [`super::step`]'s.
//!
//! Source: Petean 2004, ch. 5, eqs 11-16; docs/laws.md#circumference for the errata and the validity.

use arcfeed_shared::fmath;
use arcfeed_shared::segment::Arc;
use arcfeed_shared::stock::StockLine;
use arcfeed_shared::tool::Edge;
use arcfeed_shared::units::{Mm, MmPerTooth, Nm};

use super::step::{Cut, PreparedCut};
use super::{FeedLaw, NoWish, Place, Wish};

/// The law for one arc. All lengths relative to the rotation centre A.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circumference {
    cut: PreparedCut,
    edge_radius_mm: f32,
    /// k.
    advance_ratio: f32,
    /// Unit normal of the stock line.
    normal: [f32; 2],
    /// Distance of the stock line from A along the normal.
    offset_mm: f32,
}

/// An admissible intersection of cutting circle and stock line.
#[derive(Clone, Copy, Debug)]
struct Contact {
    bite_mm: f32,
    /// u: along the edge's advance, towards A.
    direction: [f32; 2],
}

impl Circumference {
    /// Prepares the law for an arc; the one place with f64, once per block.
    pub fn for_arc(arc: &Arc, edge_radius: Mm, edge: Edge, stock: &StockLine, feed_per_tooth: MmPerTooth) -> Self {
        let [nx, ny] = stock.normal;
        let cut = Cut { path_radius: Mm(arc.radius_mm() as f32), edge_radius, edge, feed_per_tooth };
        Circumference {
            cut: PreparedCut::new(&cut),
            // NaN is refused at the end of every tick, by name.
            edge_radius_mm: if edge_radius.0 > 0.0 { edge_radius.0 } else { f32::NAN },
            advance_ratio: f32::from(edge.advance()),
            normal: [nx as f32, ny as f32],
            offset_mm: stock.distance_mm(arc.center.map(Nm::to_mm)) as f32,
        }
    }

    /// Of the two intersections, at `(advance, towards) +- (line_advance, -line_towards)` mm in the moving frame, the one
    /// that takes the thicker chip; where only one is admissible, that one.
    #[cold]
    #[inline(never)]
    fn thicker_chip(
        &self,
        advance: f32,
        towards: f32,
        line_advance: f32,
        line_towards: f32,
    ) -> Result<Contact, NoWish> {
        let first = self.contact([advance + line_advance, towards - line_towards]);
        let second = self.contact([advance - line_advance, towards + line_towards]);
        match (first, second) {
            (Ok(a), Ok(b)) => Ok(if b.bite_mm > a.bite_mm { b } else { a }),
            (Ok(contact), Err(_)) | (Err(_), Ok(contact)) => Ok(contact),
            (Err(a), Err(b)) => Err(if a == NoWish::OutsideValidity { b } else { a }),
        }
    }

    fn contact(&self, direction: [f32; 2]) -> Result<Contact, NoWish> {
        let [advance, towards] = direction;
        if towards < 0.0 {
            return Err(NoWish::OutsideValidity);
        }
        Ok(Contact { bite_mm: self.cut.bite_mm(advance, towards)?, direction })
    }
}

impl FeedLaw for Circumference {
    #[inline(always)]
    fn wish(&self, place: &Place) -> Result<Wish, NoWish> {
        let ([vx, vy], [yx, yy], [nx, ny]) = (place.motion, place.towards, self.normal);
        let [x, y] = place.center_mm;
        // The line's normal in the moving frame: once, and both intersections follow by signs.
        let normal_advance = self.advance_ratio * (nx * vx + ny * vy);
        let normal_towards = nx * yx + ny * yy;
        let distance_mm = self.offset_mm - (nx * x + ny * y);
        let r0_mm = self.edge_radius_mm;
        let half_chord_squared = (r0_mm - distance_mm) * (r0_mm + distance_mm);
        // Not "not positive": NaN goes on to be refused by name.
        if half_chord_squared < 0.0 {
            return Err(NoWish::NoContact);
        }
        let half_chord_mm = fmath::sqrt(half_chord_squared);
        // The sign that puts the intersection that advances more first.
        let half_chord_mm = if normal_towards < 0.0 { -half_chord_mm } else { half_chord_mm };
        // (1)
        let (advance, towards) = (distance_mm * normal_advance, distance_mm * normal_towards);
        let (line_advance, line_towards) = (half_chord_mm * normal_towards, half_chord_mm * normal_advance);
        let first = [advance + line_advance, towards - line_towards];
        let Contact { bite_mm, direction } = if self.cut.is_thickest_before(first) {
            Contact { bite_mm: self.cut.advancing_bite_mm(first)?, direction: first }
        } else {
            self.thicker_chip(advance, towards, line_advance, line_towards)?
        };
        Ok(Wish { path_mm_per_tooth: self.cut.path_per_tooth(bite_mm)?.0, contact: direction })
    }
}
