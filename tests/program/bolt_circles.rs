//! Holes on a circle: polar coordinates (G16) and rotation (G68), against closed forms.

use arcfeed_nc::alarm::{Cause, NotModelled};

use crate::cycles::{ROUNDING_NM, START, holes, reader, run};

#[test]
fn a_bolt_circle_in_polar_coordinates_and_one_turned_by_g68_are_on_the_circle() {
    let angles = [30.0, 102.0, 174.0, 246.0, 318.0_f64];
    let polar: String = angles.iter().map(|angle| format!("X40.Y{angle:.1}\n")).collect();
    let polar = holes(&format!("{START}G16G81R2.Z-5.K0\n{polar}G15G80"));
    let turned: String =
        angles.iter().map(|angle| format!("G68X0Y0R{angle:.1}\nG81X40.Y0R2.Z-5.\nG80G69\nG0X0Y0\n")).collect();
    let turned = holes(&format!("{START}{turned}"));
    // The radius stays absolute where only angles follow.
    let stepped = holes(&format!("{START}G16G81X40.Y30.R2.Z-5.\nG91Y72.\nY72.\nY72.\nY72.\nG90G15G80"));
    // K repeats the step of the angle; a step behind it begins at the last hole.
    let repeated = holes(&format!("{START}G16G81X40.Y30.R2.Z-5.\nG91Y72.K3\nY72.\nG90G15G80"));
    assert_eq!((polar.len(), turned.len(), stepped.len(), repeated.len()), (5, 5, 5, 5));
    assert_eq!(stepped, repeated);
    for (((polar, turned), stepped), angle) in polar.iter().zip(&turned).zip(&stepped).zip(angles) {
        let (sin, cos) = libm::sincos(angle.to_radians());
        for found in [polar, turned, stepped] {
            let off = libm::hypot(found[0] - 40.0 * cos, found[1] - 40.0 * sin) * 1e6;
            assert!(off < ROUNDING_NM, "{angle}: {found:?} off by {off} nm");
        }
    }
}

#[test]
fn repeated_angles_of_random_bolt_circles_are_on_the_circle() {
    let (mut seed, mut worst) = (7_u64, 0.0_f64);
    let mut random = |below: u64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) % below
    };
    for _ in 0..200 {
        let [radius, first, step] =
            [1.0 + random(900) as f64 / 10.0, random(3_600) as f64 / 10.0, random(900) as f64 / 10.0 - 45.0];
        let count = 2 + random(11) as u32;
        let program = format!("{START}G16G81X{radius:.1}Y{first:.1}R2.Z-5.\nG91Y{step:.1}K{count}\nY0.\nG90G15G80");
        let found = holes(&program);
        assert_eq!(found.len(), count as usize + 2, "{program}");
        for (index, hole) in found.iter().enumerate() {
            let angle: f64 = first + step * f64::from((index as u32).min(count));
            let (sin, cos) = libm::sincos(angle.to_radians());
            worst = worst.max(libm::hypot(hole[0] - radius * cos, hole[1] - radius * sin) * 1e6);
        }
    }
    println!("200 bolt circles with repeats: worst {worst} nm");
    assert!(worst < ROUNDING_NM, "{worst}");
}

#[test]
fn repeats_of_a_radius_and_no_repeats_of_an_angle() {
    let mut reader = reader(|_, _| ());
    run(&mut reader, &format!("{START}G16G81X40.Y30.R2.Z-5.\nG91Y72.K0"));
    let radius = reader.read(b"X5.Y10.K3").expect_err("each hole would be the pole of the next").cause;
    assert_eq!(radius, Cause::NotModelled(NotModelled::MoveUnder(160)));
    // K0 drills nothing and turns nothing.
    assert_eq!(holes(&format!("{START}G16G81X40.Y30.R2.Z-5.\nG91Y72.K0\nY60.\nG90G15G80"))[1], [0.0, 40.0]);
}
