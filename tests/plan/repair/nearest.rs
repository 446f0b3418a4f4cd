//! Nearest points of surfaces.

use arcfeed_plan::geometry::surface::Surface;
use arcfeed_plan::vector::Point;

use super::surfaces::{Plain, Sheet};
use crate::plunge::table::{Worst, rows};

/// Largest normal curvature, of either sign.
pub fn curvature_per_mm(surface: &impl Surface, at: [f64; 2]) -> f64 {
    let jet = surface.jet(at);
    let normal = jet.u.cross(&jet.v).normalize();
    let (e, f, g) = (jet.u.norm_squared(), jet.u.dot(&jet.v), jet.v.norm_squared());
    let (l, m, n) = (jet.uu.dot(&normal), jet.uv.dot(&normal), jet.vv.dot(&normal));
    let square = e * g - f * f;
    let (mean, gauss) = ((e * n - 2.0 * f * m + g * l) / (2.0 * square), (l * n - m * m) / square);
    mean.abs() + libm::sqrt((mean * mean - gauss).max(0.0))
}

#[test]
fn point_1_feet_are_those_constructed_also_where_gauss_newton_fails() {
    let mut worst = Worst::default();
    let mut failing = 0;
    for row in rows(include_str!("data/feng_projection.csv")) {
        let a = row.number("a_mm");
        let surface = match row.word("surface") {
            "plane" => Plain::Plane,
            "cylinder" => Plain::Cylinder(a),
            "sphere" => Plain::Sphere(a),
            "torus" => Plain::Torus(a),
            other => panic!("{other}"),
        };
        let [x, y, z] = row.numbers(["qx", "qy", "qz"]);
        let mut expected = row.numbers(["u", "v"]);
        let mut seed = row.numbers(["start_u", "start_v"]);
        // The file's v of a cylinder is in units of its height here.
        if let Plain::Cylinder(_) = surface {
            expected[1] = z;
            seed[1] += z - row.number("v");
        }
        let foot = surface.foot(&Point::new(x, y, z), seed);
        worst.absolute("place, mm", (foot.point - surface.jet(expected).point).norm(), 0.0);
        worst.absolute("distance, mm", foot.distance_mm, row.number("distance_mm"));
        let factor = foot.distance_mm * curvature_per_mm(&surface, foot.at);
        worst.absolute("factor", factor, row.number("gauss_newton_factor"));
        assert_eq!(row.word("gauss_newton_steps") == "no", factor > 1.0);
        failing += usize::from(factor > 1.0);
    }
    println!("Gauss-Newton finds nothing in {failing} of the cases");
    worst.within("feng_projection", &[("place, mm", 1e-7), ("distance, mm", 1e-7), ("factor", 1e-6)]);
}

#[test]
fn point_1_the_sheet_s_nearest_point_is_found_from_any_seed_and_beyond_its_borders() {
    let mut random = fastrand::Rng::with_seed(17);
    let (mut off_mm, mut on_border): (f64, usize) = (0.0, 0);
    for _ in 0..300 {
        let at = [random.f64(), random.f64()];
        let (point, normal) = Sheet.point_and_normal(at);
        let height_mm = random.f64() * 4.0 - 2.0;
        let above = point + normal * height_mm;
        for _ in 0..5 {
            let foot = Sheet.foot(&above, [random.f64(), random.f64()]);
            off_mm = off_mm.max((foot.point - point).norm());
        }
        // Beyond a border: no sample of the sheet is nearer.
        let beyond = above + (Sheet.jet([at[0], 0.0]).v * -0.3) + Sheet.jet([1.0, 0.5]).u * (random.f64() - 0.5);
        let foot = Sheet.foot(&beyond, at);
        on_border += usize::from(foot.is_on_border);
        for k in 0..=200 {
            let s = f64::from(k) / 200.0;
            for place in [[s, 0.0], [s, 1.0], [0.0, s], [1.0, s], [s, 0.5], [0.5, s]] {
                let distance_mm = (Sheet.jet(place).point - beyond).norm();
                assert!(distance_mm > foot.distance_mm - 1e-9, "{distance_mm} {}", foot.distance_mm);
            }
        }
    }
    println!("1500 searches: off by {off_mm:.1e} mm; {on_border} of 300 feet on the border");
    assert!(off_mm < 1e-7);
    assert!(on_border > 100);
}
