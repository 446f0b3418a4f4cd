//! The band that a disc sweeps on a straight way in a plane, and the parts of lines in it.
//!
//! A line at the coordinate y across itself, in the plane of x along it and y, leaves the band at the disc of an end or at the border
//! between the discs. With the ends a and b, a.y <= b.y, and the direction (ux, uy) from a to b:
//!
//! ```text
//! c = R ux
//! highest x:  y < a.y - c: disc at a;  y >= b.y - c: disc at b;  else a.x + R uy + (y - a.y + c) ux / uy        (1)
//! lowest x:   y <= a.y + c: disc at a; y > b.y + c: disc at b;   else a.x - R uy + (y - a.y - c) ux / uy        (2)
//! ```
//!
//! Source: own derivation.

use super::dexel::{Interval, NOWHERE};
use super::monotone::Radii;

/// The at most two intervals that a ray loses in a cut; an unused one ends before it begins.
pub type Losses = [Interval; 2];

/// The way in the plane of a line along x and of y across it.
#[derive(Clone, Copy, Debug)]
pub struct Band {
    /// Ends of the way, the one with the lower y first.
    ends_mm: [[f64; 2]; 2],
    direction: [f64; 2],
    /// ux / uy; 0 along the line, where it is not used.
    per_y: f64,
}

impl Band {
    /// From one end of the way to the other, in either order.
    pub fn new([from_mm, to_mm]: [[f64; 2]; 2]) -> Self {
        let is_in_order = (from_mm[1], from_mm[0]) <= (to_mm[1], to_mm[0]);
        let ends_mm = if is_in_order { [from_mm, to_mm] } else { [to_mm, from_mm] };
        let way_mm = [ends_mm[1][0] - ends_mm[0][0], ends_mm[1][1] - ends_mm[0][1]];
        let length_mm = libm::sqrt(way_mm[0] * way_mm[0] + way_mm[1] * way_mm[1]);
        let direction = if length_mm > 0.0 { way_mm.map(|part| part / length_mm) } else { [1.0, 0.0] };
        let per_y = if way_mm[1] > 0.0 { way_mm[0] / way_mm[1] } else { 0.0 };
        Band { ends_mm, direction, per_y }
    }

    /// Ends of the way, the one with the lower y first.
    pub fn ends_mm(&self) -> [[f64; 2]; 2] {
        self.ends_mm
    }

    /// From the first to the last place of a line that a disc reaches; `None` if it reaches none. (1), (2)
    #[inline]
    pub fn chord(&self, off_mm: f64, radius_mm: f64) -> Option<Interval> {
        let [[ax, ay], [bx, by]] = self.ends_mm;
        let [c, wide_mm] = self.direction.map(|part| part * radius_mm);
        let [off_a, off_b] = [off_mm - ay, off_mm - by];
        let half_mm = |off_mm: f64| libm::sqrt(radius_mm * radius_mm - off_mm * off_mm);
        let high_mm = if off_a < -c {
            ax + half_mm(off_a)
        } else if off_b >= -c {
            bx + half_mm(off_b)
        } else {
            ax + wide_mm + (off_a + c) * self.per_y
        };
        let low_mm = if off_a <= c {
            ax - half_mm(off_a)
        } else if off_b > c {
            bx - half_mm(off_b)
        } else {
            ax - wide_mm + (off_a - c) * self.per_y
        };
        // NaN where the line passes the band.
        (low_mm <= high_mm).then_some(Interval::new(low_mm, high_mm))
    }

    /// Part of a line that is in a hole over the whole way.
    pub fn hollow(&self, off_mm: f64, radius_mm: f64) -> Option<Interval> {
        let [at_a, at_b] = self.ends_mm.map(|[x, y]| {
            let half_mm = libm::sqrt(radius_mm * radius_mm - (off_mm - y) * (off_mm - y));
            Interval::new(x - half_mm, x + half_mm)
        });
        let is_real = at_a.from_mm <= at_a.to_mm && at_b.from_mm <= at_b.to_mm;
        Some(at_a.common(&at_b)).filter(|common| is_real && common.length_mm() > 0.0)
    }

    /// Parts of a line that a disc with a hole reaches, without what stays in the hole over the whole way.
    #[inline]
    pub fn losses(&self, off_mm: f64, radii: &Radii) -> Losses {
        let Some(chord) = self.chord(off_mm, radii.outer_mm) else { return [NOWHERE; 2] };
        match radii.inner_mm.and_then(|inner_mm| self.hollow(off_mm, inner_mm)) {
            None => [chord, NOWHERE],
            Some(hollow) => [Interval { to_mm: hollow.from_mm, ..chord }, Interval { from_mm: hollow.to_mm, ..chord }],
        }
    }
}
