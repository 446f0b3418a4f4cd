//! Points measured on a blade of a rotor: registration on both sides and the hub, and points that are not those of the blade.

use arcfeed_plan::geometry::blisk::{Blank, Blisk, Revolution};
use arcfeed_plan::geometry::flaws::BladeSide;
use arcfeed_plan::repair::blade::{CloudFault, NominalBlade, sides};
use arcfeed_plan::repair::registration::{RegistrationError, RegistrationSettings, register};
use arcfeed_plan::vector::{Point, Vector};

use super::scan::normal;
use crate::published_rotor::ROTOR;

/// Rotor of examples/blisk-19.
pub fn blisk() -> Blisk {
    let [pressure, suction] = ROTOR.sections(9, 81).unwrap().faces().unwrap();
    let hub = Revolution { profile_mm: vec![[-14.0, 70.0], [14.0, 70.0]] };
    Blisk {
        blades: 19,
        pressure,
        suction,
        further_blades: Vec::new(),
        hub,
        blank: Blank { radius_mm: 98.6, faces_mm: [-14.0, 14.0] },
    }
}

/// Points with noise on the given sides of the first blade, and on the hub beside it if `hub` is set.
fn measured(blisk: &Blisk, on: &[BladeSide], hub: bool) -> Vec<Point> {
    let mut random = fastrand::Rng::with_seed(12);
    let mut points = Vec::new();
    for k in 0..3000 {
        let face = if on[k % on.len()] == BladeSide::Pressure { &blisk.pressure } else { &blisk.suction };
        let [u, v] = [random.f64(), 0.05 + 0.9 * random.f64()];
        points.push(face.offset(u, v, 0.005 * normal(&mut random)));
    }
    for _ in 0..if hub { 300 } else { 0 } {
        let (angle, z) = (0.5 * random.f64() - 0.25, 24.0 * random.f64() - 12.0);
        let radius = 70.0 + 0.005 * normal(&mut random);
        let middle = blisk.pressure.point(0.5, 0.0);
        let turned = libm::atan2(middle.y, middle.x) + angle.signum() * (0.08 + angle.abs() / 2.0);
        points.push(Point::new(radius * libm::cos(turned), radius * libm::sin(turned), z));
    }
    points
}

const BOTH: [BladeSide; 2] = [BladeSide::Pressure, BladeSide::Suction];

#[test]
fn a_blade_with_its_hub_is_registered_in_all_directions_and_one_side_is_not() {
    let blisk = blisk();
    let faces = sides(&blisk, 1);
    let blade = NominalBlade::new([&faces[0], &faces[1]], &blisk);
    let centre = faces[0].point(0.5, 0.5);
    let settings = RegistrationSettings { centre, free: [true; 6], is_robust: true, uncertainty_mm: 0.005 };
    let (omega, shift) = (Vector::new(0.002, -0.001, 0.0015), Vector::new(0.05, -0.08, 0.06));
    let moved = |points: Vec<Point>| -> Vec<Point> {
        let turn = nalgebra::Rotation3::new(-omega);
        points.into_iter().map(|point| centre + turn * (point - shift - centre)).collect()
    };
    let all = moved(measured(&blisk, &BOTH, true));
    let found = register(&all, &settings, |point| blade.foot(point)).unwrap();
    let deviations = found.deviations();
    println!(
        "rms {:.4} mm, deviations {deviations:.5?}, condition {:.3}, {} outliers",
        found.rms_mm, found.condition, found.outliers
    );
    let truth = omega.iter().chain(shift.iter());
    for ((value, truth), deviation) in
        found.motion.omega_rad.iter().chain(found.motion.shift_mm.iter()).zip(truth).zip(deviations)
    {
        // The registration turns about the same centre, so that its unknowns are those of the motion.
        assert!((value - truth).abs() < 4.0 * deviation + 1e-4, "{value} {truth} {deviation}");
    }
    let one_side = moved(measured(&blisk, &[BladeSide::Pressure], false));
    let refused = register(&one_side, &settings, |point| blade.foot(point)).unwrap_err();
    println!("one side: {refused}");
    assert!(matches!(refused, RegistrationError::Undetermined { .. } | RegistrationError::Restless { .. }));
}

#[test]
fn points_in_other_units_mirrored_or_of_another_blade_are_refused_with_what_fits() {
    let blisk = blisk();
    let faces = sides(&blisk, 1);
    let blade = NominalBlade::new([&faces[0], &faces[1]], &blisk);
    let points = measured(&blisk, &BOTH, true);
    let fault = |points: Vec<Point>| {
        let fault = blade.check(&points, 1, 0.0).unwrap_err();
        println!("{fault}");
        fault
    };
    let read = |by: &dyn Fn(&Point) -> Point| points.iter().map(by).collect::<Vec<Point>>();
    assert_eq!(blade.check(&points, 1, 0.0), Ok(()));
    let inches = fault(read(&|point| point / 25.4));
    assert!(matches!(inches, CloudFault::Unit { unit, .. } if unit.starts_with("inches read as millimetres")));
    let metres = fault(read(&|point| point / 1000.0));
    assert!(matches!(metres, CloudFault::Unit { unit, .. } if unit.starts_with("metres")));
    let mirrored = fault(read(&|point| Point::new(point.x, point.y, -point.z)));
    assert!(matches!(mirrored, CloudFault::Mirrored { axis: "z", .. }));
    let third = nalgebra::Rotation3::from_axis_angle(&Vector::z_axis(), 2.0 * blisk.pitch_rad());
    let other = fault(read(&|point| third * point));
    assert!(matches!(other, CloudFault::OtherBlade { blade: 3, .. }));
    let far = fault(read(&|point| point + Vector::new(11.0, -17.0, 23.0)));
    assert!(matches!(far, CloudFault::Far { .. }));
    // The same points are those of blade 3.
    let faces = sides(&blisk, 3);
    let third_blade = NominalBlade::new([&faces[0], &faces[1]], &blisk);
    assert_eq!(third_blade.check(&read(&|point| third * point), 3, 0.0), Ok(()));
    // Ball centres lie off the surface by the stylus.
    let centres: Vec<Point> = points
        .iter()
        .map(|point| {
            let foot = blade.foot(point);
            point + foot.normal * 1.5
        })
        .collect();
    assert_eq!(blade.check(&centres, 1, 1.5), Ok(()));
}

#[test]
fn points_of_the_other_side_give_no_heights() {
    let blisk = blisk();
    let faces = sides(&blisk, 1);
    let blade = NominalBlade::new([&faces[0], &faces[1]], &blisk);
    let pressure = measured(&blisk, &[BladeSide::Pressure], false);
    let heights = blade.heights(&pressure, BladeSide::Pressure, 0.0).unwrap();
    let off = heights.iter().map(|sample| sample.height_mm.abs()).fold(0.0, f64::max);
    println!("{} heights, {off:.4} mm at most", heights.len());
    assert!(heights.len() > 2700 && off < 0.03);
    let refused = blade.heights(&pressure, BladeSide::Suction, 0.0).unwrap_err();
    println!("{refused}");
    assert!(matches!(refused, CloudFault::OtherSide { .. }));
}
