//! Material of the blank above a mill's end, along its axis.

use crate::geometry::blisk::Blank;
use crate::vector::{Point, Vector};

/// Circles of a mill's end at which the material is looked for, and points of each.
const CIRCLES: u32 = 8;
const POINTS: u32 = 64;

/// Way along a direction up to which a point sees the blank; `None` if the ray passes the blank by.
pub fn exit_mm(blank: &Blank, from: &Point, along: &Vector) -> Option<f64> {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    let [low, high] = blank.faces_mm.map(|face_mm| face_mm - from.z);
    if along.z == 0.0 {
        if low > 0.0 || high < 0.0 {
            return None;
        }
    } else {
        let [one, other] = [low / along.z, high / along.z];
        (enter, leave) = (one.min(other), one.max(other));
    }
    let square = along.x * along.x + along.y * along.y;
    let excess = from.x * from.x + from.y * from.y - blank.radius_mm * blank.radius_mm;
    if square > 0.0 {
        let middle = -(from.x * along.x + from.y * along.y) / square;
        let half = libm::sqrt(middle * middle - excess / square);
        if half.is_nan() {
            return None;
        }
        (enter, leave) = (enter.max(middle - half), leave.min(middle + half));
    } else if excess > 0.0 {
        return None;
    }
    (enter < leave).then_some(leave)
}

/// Highest and lowest end of the blank's material over a mill's end, along its axis from the rotor's origin, mm; twice the end's own place if there is none.
/// The hub's bore is not looked at: the mill does not reach it.
pub fn roof_mm(blank: &Blank, tip: &Point, axis: &Vector, radius_mm: f64) -> [f64; 2] {
    let across = axis.cross(&Vector::z()).try_normalize(1e-9).unwrap_or(Vector::x());
    let beside = axis.cross(&across);
    let places = (0..=CIRCLES).flat_map(|circle| (0..POINTS).map(move |point| [circle, point]));
    let ends = places.filter_map(|[circle, point]| {
        let (sin, cos) = libm::sincos(f64::from(point) / f64::from(POINTS) * core::f64::consts::TAU);
        let from_mm = radius_mm * f64::from(circle) / f64::from(CIRCLES);
        exit_mm(blank, &(tip + (across * cos + beside * sin) * from_mm), axis).map(|way_mm| way_mm.max(0.0))
    });
    let [low, high] = ends.fold([f64::INFINITY, 0.0], |[low, high], end| [end.min(low), end.max(high)]);
    let tip_mm = axis.dot(&tip.coords);
    [tip_mm + high, tip_mm + low.min(high)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn material_ends_at_faces_and_rim() {
        let blank = Blank { radius_mm: 5.0, faces_mm: [-2.0, 3.0] };
        let exit = |from: [f64; 3], along: [f64; 3]| exit_mm(&blank, &Point::from(from), &Vector::from(along));
        assert_eq!(exit([1.0, 0.0, 0.0], [1.0, 0.0, 0.0]), Some(4.0));
        assert_eq!(exit([1.0, 0.0, 0.0], [0.0, 0.0, -1.0]), Some(2.0));
        assert_eq!(exit([6.0, 0.0, 0.0], [0.0, 0.0, 1.0]), None);
        assert_eq!(exit([0.0, 0.0, 4.0], [1.0, 0.0, 0.0]), None);
        // From inside obliquely: the face comes first.
        assert!((exit([0.0, 0.0, 0.0], [0.6, 0.0, 0.8]).unwrap() - 3.75).abs() < 1e-12);
        // A disc of radius 1 tilted by 45 degrees sees the face 1 mm higher and lower than its middle does.
        let axis = Vector::new(libm::sqrt(0.5), 0.0, libm::sqrt(0.5));
        let [high, low] = roof_mm(&blank, &Point::origin(), &axis, 1.0);
        let middle_mm = 3.0 * libm::sqrt(2.0);
        assert!((high - middle_mm - 1.0).abs() < 1e-9 && (middle_mm - low - 1.0).abs() < 1e-9, "{high} {low}");
    }
}
