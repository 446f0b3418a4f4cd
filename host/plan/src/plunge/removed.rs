//! Material that the plunges of one passage take from the blank: their volume, counted on a grid, and whether a place is cut.

use core::f64::consts::PI;

use crate::geometry::blisk::Blank;
use crate::vector::Point;

use super::passage_plan::Plunge;

/// Distance of the grid's points, mm.
const STEP_MM: f64 = 0.75;
/// Points of a mill's circle at which the material beside it is looked for.
const POINTS: u32 = 64;
/// Distance of the heights at which the material beside a mill is looked for, mm.
const HEIGHT_MM: f64 = 0.5;
/// Distance from a mill's circle within which material does not count, mm.
const SKIN_MM: f64 = 0.005;

/// Volume of the blank within any of these plunges of a flat mill, mm3, within the turn about the rotor's axis up to `reach_rad` from an
/// angle.
pub fn removed_mm3(plunges: &[Plunge], blank: &Blank, radius_mm: f64, [middle_rad, reach_rad]: [f64; 2]) -> f64 {
    let [from_mm, to_mm] = blank.faces_mm;
    let lowest_mm =
        plunges.iter().map(|plunge| libm::hypot(plunge.tip.x, plunge.tip.y)).fold(blank.radius_mm, f64::min);
    let inner_mm = (lowest_mm - radius_mm).max(0.0);
    let count = |length_mm: f64| libm::ceil(length_mm / STEP_MM).max(1.0) as usize;
    let [planes, rings] = [count(to_mm - from_mm), count(blank.radius_mm - inner_mm)];
    let (height_mm, width_mm) = ((to_mm - from_mm) / planes as f64, (blank.radius_mm - inner_mm) / rings as f64);
    let reach_rad = reach_rad.min(PI);
    let mut sum_mm3 = 0.0;
    for ring in 0..rings {
        let at_mm = inner_mm + (ring as f64 + 0.5) * width_mm;
        let places = count(2.0 * reach_rad * at_mm);
        let cell_mm3 = height_mm * width_mm * 2.0 * reach_rad * at_mm / places as f64;
        for place in 0..places {
            let angle_rad = middle_rad + reach_rad * ((2.0 * place as f64 + 1.0) / places as f64 - 1.0);
            let (sin, cos) = libm::sincos(angle_rad);
            let is_in = |plane: &usize| {
                let at = Point::new(at_mm * cos, at_mm * sin, from_mm + (*plane as f64 + 0.5) * height_mm);
                is_cut(plunges, radius_mm, &at)
            };
            sum_mm3 += cell_mm3 * (0..planes).filter(is_in).count() as f64;
        }
    }
    sum_mm3
}

/// Whether a mill that steps aside by `relief_mm` at its lowest place, and is withdrawn there, meets nothing but what it and the plunges before it have cut.
pub fn is_open(blank: &Blank, plunge: &Plunge, before: &[Plunge], radius_mm: f64) -> bool {
    let to_part = plunge.to_tool.inverse();
    let [_, low, off, _] = plunge.places();
    let heights = libm::ceil((plunge.roof_mm[0] - off.z).max(0.0) / HEIGHT_MM) as u32;
    let is_free = |place: [u32; 2]| {
        let [height, point] = place;
        let (sin, cos) = libm::sincos(f64::from(point) / f64::from(POINTS) * core::f64::consts::TAU);
        let (x, y) = (off.x + radius_mm * cos, off.y + radius_mm * sin);
        let at = to_part * Point::new(x, y, off.z + HEIGHT_MM * f64::from(height));
        let is_in_blank =
            libm::hypot(at.x, at.y) <= blank.radius_mm && (blank.faces_mm[0]..=blank.faces_mm[1]).contains(&at.z);
        !is_in_blank || libm::hypot(x - low.x, y - low.y) <= radius_mm + SKIN_MM || is_cut(before, radius_mm, &at)
    };
    (0..=heights).all(|height| (0..POINTS).all(|point| is_free([height, point])))
}

/// Whether a point lies within one of these plunges of a flat mill.
fn is_cut(plunges: &[Plunge], radius_mm: f64, point: &Point) -> bool {
    plunges.iter().any(|plunge| {
        let way = point - plunge.tip;
        let up_mm = way.dot(&plunge.axis);
        up_mm >= 0.0 && way.norm_squared() - up_mm * up_mm <= radius_mm * radius_mm
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::Vector;
    use nalgebra::Rotation3;

    #[test]
    fn one_plunge_along_the_rotors_axis_takes_a_cylinder() {
        let plunge = Plunge {
            plane: 0,
            axis: Vector::z(),
            to_tool: Rotation3::identity(),
            tip: Point::new(40.0, 0.0, -3.0),
            clear_mm: 90.0,
            roof_mm: [20.0, 20.0],
            relief_mm: 0.0,
            lift_mm: 0.0,
            lean_rad: 0.0,
        };
        let blank = Blank { radius_mm: 60.0, faces_mm: [-20.0, 20.0] };
        let expected_mm3 = PI * 64.0 * 23.0;
        let found_mm3 = removed_mm3(&[plunge], &blank, 8.0, [0.0, 0.4]);
        assert!((found_mm3 / expected_mm3 - 1.0).abs() < 0.02, "{found_mm3} {expected_mm3}");
    }

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
}
