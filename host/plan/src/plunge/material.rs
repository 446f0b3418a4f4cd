//! Material of the blank above a mill's end, along its axis.

use crate::geometry::blisk::Blank;
use crate::vector::{Point, Vector};

use super::passage_plan::Plunge;

/// Circles of a mill's end at which the material is looked for, and points of each.
const CIRCLES: u32 = 8;
const POINTS: u32 = 64;
/// Distance of the heights at which the material beside a mill is looked for, mm.
const HEIGHT_MM: f64 = 0.5;
/// Distance from a mill's circle within which material does not count, mm.
const SKIN_MM: f64 = 0.005;

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

/// Whether a mill that steps aside by `relief_mm` at its lowest place, and is withdrawn there, meets nothing but what it and the plunges before it have cut.
pub fn is_open(blank: &Blank, plunge: &Plunge, before: &[Plunge], radius_mm: f64) -> bool {
    let to_part = plunge.to_tool.inverse();
    let [_, low, off, _] = plunge.places();
    let heights = libm::ceil((plunge.roof_mm[0] - off.z).max(0.0) / HEIGHT_MM) as u32;
    let is_cut = |point: &Point| {
        before.iter().any(|other| {
            let way = point - other.tip;
            let up_mm = way.dot(&other.axis);
            up_mm >= 0.0 && way.norm_squared() - up_mm * up_mm <= radius_mm * radius_mm
        })
    };
    let is_free = |place: [u32; 2]| {
        let [height, point] = place;
        let (sin, cos) = libm::sincos(f64::from(point) / f64::from(POINTS) * core::f64::consts::TAU);
        let (x, y) = (off.x + radius_mm * cos, off.y + radius_mm * sin);
        let at = to_part * Point::new(x, y, off.z + HEIGHT_MM * f64::from(height));
        let is_in_blank =
            libm::hypot(at.x, at.y) <= blank.radius_mm && (blank.faces_mm[0]..=blank.faces_mm[1]).contains(&at.z);
        !is_in_blank || libm::hypot(x - low.x, y - low.y) <= radius_mm + SKIN_MM || is_cut(&at)
    };
    (0..=heights).all(|height| (0..POINTS).all(|point| is_free([height, point])))
}

#[cfg(test)]
mod tests {
    use nalgebra::Rotation3;

    use super::*;

    #[test]
    fn a_mill_steps_aside_only_into_what_is_cut() {
        // Plunges along z into the upper face of a block, x across.
        let blank = Blank { radius_mm: 100.0, faces_mm: [-20.0, 20.0] };
        let plunge = |x: f64, y: f64, relief_mm: f64| Plunge {
            plane: 0,
            axis: Vector::z(),
            to_tool: Rotation3::identity(),
            tip: Point::new(x, y, 0.0),
            clear_mm: 30.0,
            roof_mm: [20.0, 20.0],
            relief_mm,
            lift_mm: 0.0,
            lean_rad: 0.0,
        };
        let is_open = |plunge: &Plunge, before: &[Plunge]| super::is_open(&blank, plunge, before, 5.0);
        assert!(!is_open(&plunge(0.0, 0.0, 0.2), &[]) && is_open(&plunge(0.0, 0.0, 0.0), &[]));
        let beside = [-3.0, -1.0, 0.0, 1.0, 3.0].map(|y| plunge(3.0, y, 0.0));
        assert!(is_open(&plunge(0.0, 0.0, 0.2), &beside) && !is_open(&plunge(0.0, 0.0, -0.2), &beside));
        assert!(!is_open(&plunge(0.0, 0.0, 0.2), &beside[2..3]), "cusps beside one plunge");
        // A plunge that ends higher leaves material below its end.
        let higher = beside.map(|other| Plunge { tip: other.tip + Vector::z(), ..other });
        assert!(!is_open(&plunge(0.0, 0.0, 0.2), &higher));
        // Half of the disc is outside of the blank.
        assert!(is_open(&plunge(100.0, 0.0, 0.2), &[]));
    }

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
