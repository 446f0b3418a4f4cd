//! Volume that the plunges of one passage take from the blank, counted on a grid.

use core::f64::consts::PI;

use crate::geometry::blisk::Blank;
use crate::vector::Point;

use super::passage_plan::Plunge;

/// Distance of the grid's points, mm.
const STEP_MM: f64 = 0.75;

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
    let is_in = |point: &Point| {
        plunges.iter().any(|plunge| {
            let way = point - plunge.tip;
            let up_mm = way.dot(&plunge.axis);
            up_mm >= 0.0 && way.norm_squared() - up_mm * up_mm <= radius_mm * radius_mm
        })
    };
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
                is_in(&Point::new(at_mm * cos, at_mm * sin, from_mm + (*plane as f64 + 0.5) * height_mm))
            };
            sum_mm3 += cell_mm3 * (0..planes).filter(is_in).count() as f64;
        }
    }
    sum_mm3
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
}
