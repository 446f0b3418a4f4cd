//! Cup mill and its holder, as solids of revolution.
//!
//! ```text
//!          |  holder   |
//!       +--+-----------+--+   height
//!       |      body       |
//!       |  +-----------+  |   cavity_depth
//!       |  |           |  |
//!       (__)           (__)   corners of insert_radius; 0 at the bottom
//!      R   r           r   R
//! ```
//!
//! Distances from ring, body or holder are exact from outside, in the half plane through the axis:
//!
//! ```text
//! d(box) = |max(|p - m| - h, 0)| - rounding                                   (1)
//! ```

/// Dimensions of a cup mill and its holder, mm; heights are measured from its bottom. The inner radius must be below the outer one, the
/// inserts not wider than the ring, and the cavity less deep than the cup is high.
#[derive(Clone, Debug, PartialEq)]
pub struct CupMill {
    /// Outer radius of the ring, R.
    pub outer_radius_mm: f64,
    /// Inner radius of the ring, r.
    pub inner_radius_mm: f64,
    /// Corner radius of the inserts.
    pub insert_radius_mm: f64,
    /// Depth of the cup's cavity.
    pub cavity_depth_mm: f64,
    /// Height of the cup from its bottom to its back.
    pub height_mm: f64,
    /// Cylinders of the holder on the cup's back, from below, each as radius and length.
    pub holder_mm: Vec<[f64; 2]>,
    /// Number of teeth that cut at once, on one of the two circles.
    pub active_teeth: u16,
}

/// Part of a cup mill whose clearance is computed on its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ToolPart {
    /// Ring: the wall of the cup with its inserts.
    Ring,
    /// Body: the closed back of the cup.
    Body,
    /// Holder.
    Holder,
}

impl CupMill {
    /// Distance, mm, of a point from one part of the tool. The point is given by its distance from the axis and its height above the
    /// bottom. Negative inside, where only the sign is valid.
    pub fn distance_of_mm(&self, part: ToolPart, radius_mm: f64, height_mm: f64) -> f64 {
        match part {
            ToolPart::Ring => self.ring_distance_mm(radius_mm, height_mm),
            ToolPart::Body => self.body_mm(radius_mm, height_mm),
            ToolPart::Holder => self.holder_distance_mm(radius_mm, height_mm),
        }
    }

    /// Inner and outer radius, mm, of the ring at a height above its bottom; `None` below it. Above the cavity the inner radius is 0.
    pub fn radii_mm(&self, height_mm: f64) -> Option<[f64; 2]> {
        if height_mm < 0.0 {
            return None;
        }
        let rounding = self.insert_radius_mm;
        let below_mm = (rounding - height_mm).max(0.0);
        let drawn_in_mm = rounding - libm::sqrt(rounding * rounding - below_mm * below_mm);
        let inner_mm = if height_mm > self.cavity_depth_mm { 0.0 } else { self.inner_radius_mm + drawn_in_mm };
        Some([inner_mm, self.outer_radius_mm - drawn_in_mm])
    }

    /// Height of the ring's underside above its bottom at a distance from the axis, mm; `None` beside the ring.
    pub fn underside_mm(&self, radius_mm: f64) -> Option<f64> {
        let rounding = self.insert_radius_mm;
        let inner_mm = self.inner_radius_mm + rounding - radius_mm;
        let outer_mm = radius_mm - (self.outer_radius_mm - rounding);
        let beyond_mm = inner_mm.max(outer_mm).max(0.0);
        (beyond_mm <= rounding).then(|| rounding - libm::sqrt(rounding * rounding - beyond_mm * beyond_mm))
    }

    /// Distance, mm, of a point from the wall of the ring, without body and holder; negative inside the wall. The point is `radius_mm` from
    /// the axis and `height_mm` above the lowest point of the ring. The wall is rounded at the bottom and goes up to the top of the body.
    pub fn ring_distance_mm(&self, radius_mm: f64, height_mm: f64) -> f64 {
        let rounding = self.insert_radius_mm;
        let low = [self.inner_radius_mm + rounding, rounding];
        let high = [self.outer_radius_mm - rounding, self.height_mm - rounding];
        outside([radius_mm, height_mm], low, high) - rounding // (1)
    }

    fn body_mm(&self, radius_mm: f64, height_mm: f64) -> f64 {
        outside([radius_mm, height_mm], [0.0, self.cavity_depth_mm], [self.outer_radius_mm, self.height_mm])
    }

    fn holder_distance_mm(&self, radius_mm: f64, height_mm: f64) -> f64 {
        let mut from_mm = self.height_mm;
        let mut least = f64::INFINITY;
        for [holder_radius_mm, length_mm] in &self.holder_mm {
            let to_mm = from_mm + length_mm;
            least = least.min(outside([radius_mm, height_mm], [0.0, from_mm], [*holder_radius_mm, to_mm]));
            from_mm = to_mm;
        }
        least
    }
}

/// Distance of a place outside of a box; negative inside.
fn outside(place: [f64; 2], low: [f64; 2], high: [f64; 2]) -> f64 {
    let beyond = |axis: usize| (low[axis] - place[axis]).max(place[axis] - high[axis]);
    let (across, up) = (beyond(0), beyond(1));
    if across > 0.0 && up > 0.0 { libm::hypot(across, up) } else { across.max(up) }
}
