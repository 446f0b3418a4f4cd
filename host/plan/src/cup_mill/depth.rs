//! Depths of the tool: the lowest level of a path, and the levels above it (Petean, section 3.3.3).
//!
//! ```text
//! lowest = max over the hub's offset of  z - underside(|q - C|)              (1)
//! ADC_EFF = depth / n,  n = ceil(depth / ADC_MAX)                            (2)
//! ```
//!
//! The depth is that of the cutting plane, an insert's radius above the bottom: from the highest material that the ring
//! meets at the base position down to its lowest level. So there are n + 1 levels, and the first one cuts with the
//! rounding of the inserts alone.
//!
//! The ring meets the blank where it is highest under the ring. Seen along the tool a blank's height is concave, because a blank without
//! its bore is convex. So its highest place under the ring is the highest one of all, or lies under one of the ring's two circles.

use core::f64::consts::TAU;

use nalgebra::{Rotation3, Vector2};

use crate::cutter::CupMill;
use crate::geometry::blisk::Blank;
use crate::vector::{Flat, Point, Vector};

use super::patch::Patch;

/// Number of places on each circle of the ring at which the blank's height is taken: 0.22 mm apart on the published ring.
const PLACES: u32 = 3_600;

/// Lowest height of the tool's bottom, mm, at which a ring with its axis at `centre` stays above `hub` (with allowance). `None` if the
/// ring is nowhere above the hub.
pub fn lowest_mm(cutter: &CupMill, centre: Flat, hub: &Patch) -> Option<f64> {
    let deepest = |q: &Point| {
        let radius_mm = (q.xy() - centre).norm();
        cutter.underside_mm(radius_mm).map_or(f64::INFINITY, |underside_mm| underside_mm - q.z)
    };
    hub.least(deepest).map(|least| -least.value) // (1)
}

/// Highest point, mm, of the blank's surface `roof` under a ring with its axis at `centre`. `None` if the ring is nowhere above it.
pub fn top_mm(cutter: &CupMill, centre: Flat, roof: &Patch) -> Option<f64> {
    let under = |p: &Point| {
        let radius_mm = (p.xy() - centre).norm();
        let is_under = (cutter.inner_radius_mm..=cutter.outer_radius_mm).contains(&radius_mm);
        if is_under { -p.z } else { f64::INFINITY }
    };
    roof.least(under).map(|least| -least.value)
}

/// Height of the bottom, mm, at which a ring with its axis at `centre` meets the blank on its way down; a bore counts as material. `None` if it never does.
pub fn contact_mm(cutter: &CupMill, centre: Flat, blank: &Blank, to_slot: &Rotation3<f64>) -> Option<f64> {
    let to_part = to_slot.inverse();
    let up = to_part * Vector::z();
    let circles = [cutter.inner_radius_mm, cutter.outer_radius_mm].into_iter().flat_map(|radius_mm| {
        (0..PLACES).map(move |place| {
            let (sin, cos) = libm::sincos(TAU * f64::from(place) / f64::from(PLACES));
            centre + Vector2::new(cos, sin) * radius_mm
        })
    });
    let under_circles = circles.filter_map(|at| height_mm(blank, &(to_part * Point::new(at.x, at.y, 0.0)), &up));
    let across = up.xy().try_normalize(0.0).unwrap_or_default() * blank.radius_mm;
    let rims = blank.faces_mm.map(|face_mm| to_slot * Point::new(across.x, across.y, face_mm));
    let is_under =
        |rim: &Point| (cutter.inner_radius_mm..=cutter.outer_radius_mm).contains(&(rim.xy() - centre).norm());
    under_circles.chain(rims.into_iter().filter(is_under).map(|rim| rim.z)).reduce(f64::max)
}

/// Distance from a point, along `up`, to the last place in the blank; `None` if the line misses the blank.
fn height_mm(blank: &Blank, from: &Point, up: &Vector) -> Option<f64> {
    let (across, along) = (up.xy().norm_squared(), from.xy().coords.dot(&up.xy()));
    let inside = blank.radius_mm * blank.radius_mm - from.xy().coords.norm_squared();
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    if across > 0.0 {
        let root = libm::sqrt(Some(along * along + across * inside).filter(|square| *square >= 0.0)?);
        (low, high) = ((-along - root) / across, (-along + root) / across);
    } else if inside < 0.0 {
        return None;
    }
    let faces = blank.faces_mm.map(|face_mm| face_mm - from.z);
    if up.z == 0.0 {
        return (faces[0] <= 0.0 && faces[1] >= 0.0).then_some(high);
    }
    let [one, other] = faces.map(|way_mm| way_mm / up.z);
    let (low, high) = (low.max(one.min(other)), high.min(one.max(other)));
    (low <= high).then_some(high)
}

/// Heights of the tool's bottom for all levels, from the top down. The cutting plane goes from `top_mm` to the lowest level in equal
/// steps of at most `depth_max_mm`.
pub fn levels_mm(cutter: &CupMill, top_mm: f64, lowest_mm: f64, depth_max_mm: f64) -> Vec<f64> {
    let first_mm = top_mm - cutter.insert_radius_mm;
    let depth_mm = (first_mm - lowest_mm).max(0.0);
    // A depth that is a whole number of steps except for rounding is that number.
    let steps = libm::ceil(depth_mm / depth_max_mm - 1e-9).max(0.0);
    let step_mm = if steps > 0.0 { depth_mm / steps } else { 0.0 }; // (2)
    (0..=steps as u32).map(|index| lowest_mm + step_mm * (steps - f64::from(index))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::slot_frame;

    /// Ring of 40 and 30 mm.
    const RING: CupMill = CupMill {
        outer_radius_mm: 40.0,
        inner_radius_mm: 30.0,
        insert_radius_mm: 0.8,
        active_teeth: 10,
        cavity_depth_mm: 30.0,
        height_mm: 40.0,
        holder_mm: Vec::new(),
    };

    #[test]
    fn the_contact_is_the_highest_point_of_the_blank_under_the_ring() {
        let blank = Blank { radius_mm: 50.0, faces_mm: [-14.0, 20.0] };
        // Both faces and the rim, 0.2 mm apart.
        let at = |z: f64, radius_mm: f64, angle: u32| {
            let (sin, cos) = libm::sincos(TAU * f64::from(angle) / 1_800.0);
            Point::new(radius_mm * cos, radius_mm * sin, z)
        };
        let rim = (0..=170).flat_map(|row| (0..1_800).map(move |angle| at(-14.0 + 0.2 * f64::from(row), 50.0, angle)));
        let faces = (0..=250).flat_map(|ring| {
            (0..1_800).flat_map(move |angle| [-14.0, 20.0].map(|z| at(z, 0.2 * f64::from(ring), angle)))
        });
        let surface: Vec<Point> = rim.chain(faces).collect();
        let axes = [[1.0, 0.0, 0.0], [0.9, 0.1, 0.4], [0.5, -0.8, -0.3], [0.1, 0.0, 0.95]];
        let centres = [[0.0, 0.0], [35.0, 2.0], [-20.0, 31.0], [60.0, -25.0], [4.0, 95.0], [0.0, 150.0]];
        for (axis, [x, y]) in axes.iter().flat_map(|axis| centres.iter().map(move |centre| (axis, *centre))) {
            let to_slot = slot_frame(&Vector::from(*axis)).expect("a direction");
            let under = surface
                .iter()
                .map(|point| to_slot * point)
                .filter(|point| (30.0..=40.0).contains(&libm::hypot(point.x - x, point.y - y)));
            let seen_mm = under.map(|point| point.z).reduce(f64::max);
            let found_mm = contact_mm(&RING, Flat::new(x, y), &blank, &to_slot);
            let off_mm = found_mm.zip(seen_mm).map_or(0.0, |(found_mm, seen_mm)| found_mm - seen_mm);
            assert_eq!(found_mm.is_some(), seen_mm.is_some(), "{axis:?} {x} {y}");
            assert!((-0.1..0.5).contains(&off_mm), "{axis:?} {x} {y}: {found_mm:?} {seen_mm:?}");
        }
    }
}
