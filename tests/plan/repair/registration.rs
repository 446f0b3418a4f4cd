//! Registration of measured points.

use arcfeed_plan::geometry::surface::Surface;
use arcfeed_plan::repair::registration::{
    NominalFoot, RegistrationError, RegistrationSettings, RigidMotion, fit, register,
};
use arcfeed_plan::vector::{Point, Vector};

use super::surfaces::Sheet;
use crate::plunge::table::{Worst, rows};

pub fn settings(free: [bool; 6]) -> RegistrationSettings {
    RegistrationSettings { centre: Point::origin(), free, is_robust: false, uncertainty_mm: 0.0 }
}

pub fn sheet_foot(point: &Point) -> NominalFoot {
    let seeds = [[0.2, 0.25], [0.2, 0.75], [0.7, 0.25], [0.7, 0.75]];
    let off = |seed: &[f64; 2]| (Sheet.jet(*seed).point - point).norm();
    let seed = seeds.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
    let foot = Sheet.foot(point, seed);
    NominalFoot { point: foot.point, normal: Sheet.point_and_normal(foot.at).1 }
}

#[test]
fn point_1_motions_deviations_and_conditions_are_those_of_least_squares() {
    let all = rows(include_str!("data/feng_registration_points.csv"));
    let mut worst = Worst::default();
    for row in rows(include_str!("data/feng_registration.csv")) {
        let of_case = all.iter().filter(|point| point.word("case") == row.word("case"));
        let points: Vec<Point> = of_case.map(|point| Point::from(point.numbers(["x_mm", "y_mm", "z_mm"]))).collect();
        assert_eq!(points.len(), 300);
        let found = fit(&points, &settings([true; 6]), sheet_foot).unwrap();
        let omega = Vector::from(row.numbers(["wx", "wy", "wz"]));
        let shift = Vector::from(row.numbers(["tx", "ty", "tz"]));
        worst.absolute("omega, rad", (found.motion.omega_rad - omega).norm(), 0.0);
        worst.absolute("shift, mm", (found.motion.shift_mm - shift).norm(), 0.0);
        worst.absolute("rms, mm", found.rms_mm, row.number("rms_mm"));
        let deviations = found.deviations();
        let expected = row.numbers(["sd_wx", "sd_wy", "sd_wz", "sd_tx", "sd_ty", "sd_tz"]);
        for k in 0..6 {
            worst.absolute("deviation, ratio", deviations[k] / expected[k], 1.0);
        }
        worst.absolute("condition, ratio", found.condition / row.number("condition"), 1.0);
        // Without a surplus the truth lies within four standard deviations.
        if row.number("surplus_mm") == 0.0 && row.number("noise_mm") > 0.0 {
            let truth = row.numbers(["true_wx", "true_wy", "true_wz", "true_tx", "true_ty", "true_tz"]);
            let moved = found.motion.omega_rad.iter().chain(found.motion.shift_mm.iter());
            for ((value, truth), deviation) in moved.zip(truth).zip(deviations) {
                assert!((value - truth).abs() < 4.0 * deviation, "{value} {truth} {deviation}");
            }
        }
    }
    let limits = [
        ("omega, rad", 1e-6),
        ("shift, mm", 1e-6),
        ("rms, mm", 1e-9),
        ("deviation, ratio", 1e-3),
        ("condition, ratio", 1e-5),
    ];
    worst.within("feng_registration", &limits);
}

#[test]
fn an_undetermined_shift_is_refused_although_its_residuals_look_perfect() {
    let all = rows(include_str!("data/feng_registration_points.csv"));
    let points = |case: &str| -> Vec<Point> {
        let of_case = all.iter().filter(|point| point.word("case") == case);
        of_case.map(|point| Point::from(point.numbers(["x_mm", "y_mm", "z_mm"]))).collect()
    };
    // g2: an even surplus of 0.06 mm, no noise, residuals of 0.00005 mm.
    let judged = RegistrationSettings { uncertainty_mm: 0.005, ..settings([true; 6]) };
    let refused = register(&points("g2"), &judged, sheet_foot).unwrap_err();
    let message = refused.to_string();
    println!("{message}");
    assert!(matches!(refused, RegistrationError::Undetermined { deviation_mm, .. } if deviation_mm > 0.05));
    assert!(message.contains("hold"), "{message}");
    // Held at the datum, the surplus stays a surplus.
    let held =
        register(&points("g4"), &RegistrationSettings { uncertainty_mm: 0.005, ..settings([false; 6]) }, sheet_foot);
    assert_eq!(held.unwrap().motion, RigidMotion::identity(Point::origin()));
}

/// Both sides of a box with ends: points determine all directions.
fn brick_foot(point: &Point) -> NominalFoot {
    let half = Vector::new(15.0, 10.0, 25.0);
    let off: Vec<f64> = (0..3).map(|k| point[k].abs() - half[k]).collect();
    let k = (0..3).max_by(|a, b| off[*a].total_cmp(&off[*b])).unwrap();
    let (mut nearest, mut normal) = (*point, Vector::zeros());
    nearest[k] = half[k].copysign(point[k]);
    normal[k] = 1_f64.copysign(point[k]);
    NominalFoot { point: nearest, normal }
}

fn brick_points(random: &mut fastrand::Rng, count: usize, noise_mm: f64) -> Vec<Point> {
    let mut point = |_| {
        let mut place = Point::new(random.f64() * 28.0 - 14.0, random.f64() * 18.0 - 9.0, random.f64() * 48.0 - 24.0);
        let k = random.usize(0..3);
        let half = [15.0, 10.0, 25.0][k];
        let noise = (0..12).map(|_| random.f64()).sum::<f64>() - 6.0;
        place[k] = half_of(half, random.bool()) + noise * noise_mm;
        place
    };
    (0..count).map(&mut point).collect()
}

fn half_of(half: f64, is_positive: bool) -> f64 {
    if is_positive { half } else { -half }
}

#[test]
fn a_fifth_of_outliers_does_not_move_the_registration() {
    let mut random = fastrand::Rng::with_seed(5);
    let truth = RigidMotion {
        centre: Point::origin(),
        omega_rad: Vector::new(0.004, -0.006, 0.003),
        shift_mm: Vector::new(0.2, -0.1, 0.3),
    };
    let (mut points, noise_mm) = (brick_points(&mut random, 500, 0.005), 0.005);
    for point in &mut points[..100] {
        // Dust and weld spatter stand above the surface.
        let normal = brick_foot(point).normal;
        *point += normal * (0.3 + random.f64());
    }
    let back = |point: &Point| {
        let turned = nalgebra::Rotation3::new(-truth.omega_rad) * (point - truth.shift_mm);
        Point::from(turned.coords)
    };
    let measured: Vec<Point> = points.iter().map(back).collect();
    let robust = RegistrationSettings { is_robust: true, uncertainty_mm: noise_mm, ..settings([true; 6]) };
    let found = register(&measured, &robust, brick_foot).unwrap();
    let plain = fit(&measured, &settings([true; 6]), brick_foot).unwrap();
    let off = |found: &RigidMotion| {
        let corner = Point::new(15.0, 10.0, 25.0);
        (found.moved(&back(&corner)) - corner).norm()
    };
    println!(
        "20 % outliers: corner off by {:.4} mm, {} of 100 left out, rms {:.4} mm; least squares off by {:.4} mm",
        off(&found.motion),
        found.outliers,
        found.rms_mm,
        off(&plain.motion)
    );
    assert!(off(&found.motion) < 0.005 && found.outliers >= 100 && found.rms_mm < 0.0055);
    assert!(off(&plain.motion) > 0.01);
}
