//! Most even allowance.

use arcfeed_plan::repair::evenness::{AllowancePlace, DatumTolerance, most_even};
use arcfeed_plan::vector::{Point, Vector};

use crate::plunge::table::{Worst, rows};

fn places(case: &str) -> Vec<AllowancePlace> {
    let of_case = rows(include_str!("data/feng_localise_points.csv")).into_iter();
    of_case
        .filter(|row| row.word("case") == case)
        .map(|row| {
            let [qx, qy, qz] = row.numbers(["qx", "qy", "qz"]);
            let [nx, ny, nz] = row.numbers(["nx", "ny", "nz"]);
            let allowance_mm = row.number("d_mm");
            AllowancePlace { point: Point::new(qx, qy, qz), normal: Vector::new(nx, ny, nz), allowance_mm }
        })
        .collect()
}

#[test]
fn point_1_the_greatest_least_allowance_is_that_of_another_linear_program() {
    let mut worst = Worst::default();
    for row in rows(include_str!("data/feng_localise.csv")) {
        let places = places(row.word("case"));
        assert_eq!(places.len() as f64, row.number("points"));
        let least_mm = places.iter().map(|place| place.allowance_mm).fold(f64::INFINITY, f64::min);
        worst.absolute("before, mm", least_mm, row.number("least_before_mm"));
        let [cx, cy, cz] = row.numbers(["cx", "cy", "cz"]);
        let centre = Point::new(cx, cy, cz);
        let [shift_mm, turn_rad] = row.numbers(["t_max_mm", "w_max_rad"]);
        let motion = most_even(&places, &centre, &DatumTolerance { shift_mm, turn_rad }).unwrap();
        worst.absolute("best, mm", motion.least_mm, row.number("least_best_mm"));
        // The motion keeps the tolerances and has what it states.
        let kept = places.iter().map(|place| motion.allowance_mm(place, &centre)).fold(f64::INFINITY, f64::min);
        worst.absolute("kept, mm", kept, motion.least_mm);
        assert!(motion.shift_mm.amax() <= shift_mm + 1e-9 && motion.omega_rad.amax() <= turn_rad + 1e-9);
    }
    worst.within("feng_localise", &[("before, mm", 1e-11), ("best, mm", 1e-8), ("kept, mm", 1e-8)]);
}

#[test]
fn datums_without_tolerance_leave_the_allowance_as_it_is() {
    let places = places("m2");
    let held = most_even(&places, &Point::origin(), &DatumTolerance { shift_mm: 0.0, turn_rad: 0.0 }).unwrap();
    let least_mm = places.iter().map(|place| place.allowance_mm).fold(f64::INFINITY, f64::min);
    assert!((held.least_mm - least_mm).abs() < 1e-9);
    assert_eq!(most_even(&[], &Point::origin(), &DatumTolerance { shift_mm: 1.0, turn_rad: 0.1 }), None);
}
