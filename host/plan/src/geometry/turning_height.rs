//! Greatest height of a part along the tool axis while it turns about its own axis.
//!
//! ```text
//! h = z k.z + q sqrt(1 - (k.z)^2)                                             (1)
//! ```
//!
//! for a point at z along the rotor's axis k and q from it, at the highest place of its circle. The largest value at
//! the corners of a box is the maximum, since (1) is convex in z, x and y.

use nalgebra::Rotation3;

use crate::vector::{Point, Vector};

use super::blisk::Blank;

/// Greatest height that any point of the blank or of the boxes reaches during a full turn of the part, along the
/// slot's z, mm. Boxes are given by opposite corners, part frame.
pub fn highest_mm(blank: &Blank, boxes: &[[Point; 2]], to_slot: &Rotation3<f64>) -> f64 {
    let along = (to_slot * Vector::z()).z;
    let across = libm::sqrt((1.0 - along) * (1.0 + along));
    let height_mm = |z: f64, radius_mm: f64| z * along + radius_mm * across; // (1)
    let rims = blank.faces_mm.map(|face_mm| height_mm(face_mm, blank.radius_mm));
    let corners = boxes.iter().flat_map(|[low, high]| {
        let farthest_mm = libm::hypot(low.x.abs().max(high.x.abs()), low.y.abs().max(high.y.abs()));
        [height_mm(low.z, farthest_mm), height_mm(high.z, farthest_mm)]
    });
    rims.into_iter().chain(corners).fold(f64::NEG_INFINITY, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::slot_frame;

    #[test]
    fn no_turn_lifts_a_corner_higher() {
        let blank = Blank { radius_mm: 10.0, faces_mm: [-2.0, 3.0] };
        let boxes = [[Point::new(-9.0, -4.0, -20.0), Point::new(5.0, 11.0, -6.0)]];
        let to_slot = slot_frame(&Vector::new(0.2, 0.9, 0.4)).unwrap();
        let corners = (0..8).map(|k: usize| Point::new(boxes[0][k & 1].x, boxes[0][k >> 1 & 1].y, boxes[0][k >> 2].z));
        let rim = (0..720).map(|k| f64::from(k) / 720.0 * core::f64::consts::TAU);
        let rims = rim.flat_map(|a| blank.faces_mm.map(|z| Point::new(10.0 * libm::cos(a), 10.0 * libm::sin(a), z)));
        let all: Vec<Point> = corners.chain(rims).collect();
        let turns = (0..7200).map(|k| Rotation3::from_axis_angle(&Vector::z_axis(), f64::from(k) * 8.727e-4));
        let highest = |turn: Rotation3<f64>| all.iter().map(|p| (to_slot * (turn * p)).z).fold(f64::MIN, f64::max);
        let seen_mm = turns.map(highest).fold(f64::MIN, f64::max);
        let computed_mm = highest_mm(&blank, &boxes, &to_slot);
        assert!((0.0..1e-4).contains(&(computed_mm - seen_mm)), "{computed_mm} {seen_mm}");
    }
}
