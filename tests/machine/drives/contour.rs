//! Corners are rounded, within the tolerance and no more.

use std::fmt::Write as _;

use crate::drives::motion::{Motion, drives, settings};

/// A path of straight moves of all five axes, and its corners.
fn any_path(random: &mut fastrand::Rng) -> (String, Vec<[f64; 5]>) {
    let (mut text, mut corners) = (String::from("G90G1F4000\n"), vec![[0.0; 5]]);
    for _ in 0..50 {
        let size = libm::pow(10.0, random.f64() * 3.5 - 2.0);
        let before = corners[corners.len() - 1];
        let [x, y, z, b, c] = before.map(|at| libm::round((at + size * (random.f64() - 0.5)) * 1e3) / 1e3);
        writeln!(text, "X{x:.3}Y{y:.3}Z{z:.3}B{b:.3}C{c:.3}").unwrap();
        corners.push([x, y, z, b, c]);
    }
    (text, corners)
}

/// The distance of a point from the nearest of some straight stretches.
fn distance<const N: usize>(point: [f64; N], corners: &[[f64; N]]) -> f64 {
    let to_stretch = |ends: &[[f64; N]]| {
        let along: [f64; N] = std::array::from_fn(|axis| ends[1][axis] - ends[0][axis]);
        let off: [f64; N] = std::array::from_fn(|axis| point[axis] - ends[0][axis]);
        let dot = |one: &[f64; N], other: &[f64; N]| one.iter().zip(other).map(|(a, b)| a * b).sum::<f64>();
        let length = dot(&along, &along);
        let ratio = if length > 0.0 { (dot(&off, &along) / length).clamp(0.0, 1.0) } else { 0.0 };
        let left: [f64; N] = std::array::from_fn(|axis| off[axis] - ratio * along[axis]);
        libm::sqrt(dot(&left, &left))
    };
    corners.windows(2).map(to_stretch).fold(f64::INFINITY, f64::min)
}

#[test]
fn the_path_leaves_the_programmed_one_by_no_more_than_the_tolerance() {
    let (mut worst, drives) = ([0.0_f64; 2], drives());
    for seed in 0..30 {
        let (program, corners) = any_path(&mut fastrand::Rng::with_seed(seed));
        let linear: Vec<[f64; 3]> = corners.iter().map(|[x, y, z, ..]| [*x, *y, *z]).collect();
        let rotary: Vec<[f64; 2]> = corners.iter().map(|[.., b, c]| [*b, *c]).collect();
        let motion = Motion::of(&program, settings(drives), |_| 100);
        for [x, y, z, _, b, c] in &motion.axes {
            worst[0] = worst[0].max(distance([*x, *y, *z], &linear));
            worst[1] = worst[1].max(distance([*b, *c], &rotary));
        }
    }
    println!("greatest distance from the programmed path: {:.5} mm, {:.5} degrees", worst[0], worst[1]);
    let tolerances = [drives.tolerance_mm, drives.tolerance_deg];
    assert!(worst.iter().zip(tolerances).all(|(worst, tolerance)| *worst <= tolerance), "{worst:?}");
    assert!(worst.iter().zip(tolerances).all(|(worst, tolerance)| *worst > 0.5 * tolerance), "not rounded: {worst:?}");
}

/// A right angle in a plane, so slow that no axis stops for it: the corner is missed by the share of the tolerance that corners
/// have.
#[test]
fn a_right_angle_is_missed_by_three_quarters_of_the_tolerance() {
    let drives = drives();
    let motion = Motion::of("G1X1.F60\nY1.", settings(drives), |_| 100);
    let miss = motion.axes.iter().map(|[x, y, ..]| libm::hypot(x - 1.0, *y)).fold(f64::INFINITY, f64::min);
    assert!((miss - 0.75 * drives.tolerance_mm).abs() < 0.02 * drives.tolerance_mm, "{miss} mm");
}
