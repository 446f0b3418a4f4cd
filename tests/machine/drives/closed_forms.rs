//! Moves whose least time is known.

use arcfeed_control::drives::limits::AxisLimits;

use crate::drives::motion::{Motion, drives, settings};

/// The least time from rest to rest over a way: seven phases, fewer where speed or acceleration is not reached.
fn least_s(way: f64, limits: &AxisLimits) -> f64 {
    let AxisLimits { speed_mm_per_s: v, acceleration_mm_per_s2: a, jerk_mm_per_s3: j } = *limits;
    // Up to `peak` and down again, and the way that takes.
    let ramp_s = |peak: f64| if peak >= a * a / j { peak / a + a / j } else { 2.0 * libm::sqrt(peak / j) };
    let (mut low, mut high) = (0.0, v);
    if v * ramp_s(v) > way {
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if middle * ramp_s(middle) > way { high = middle } else { low = middle }
        }
    }
    let peak = high;
    2.0 * ramp_s(peak) + (way - peak * ramp_s(peak)) / peak
}

#[test]
fn from_rest_to_rest_it_takes_the_least_time() {
    let drives = drives();
    for (axis, letter) in ["X", "Y", "Z", "A", "B", "C"].into_iter().enumerate() {
        for way in [0.0001, 0.001, 0.01, 0.1, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0] {
            let motion = Motion::of(&format!("G0{letter}{way:.4}"), settings(drives), |_| 100);
            motion.keeps(&drives, letter);
            let least = least_s(way, &drives.axes[axis]);
            println!("{letter}{way}: {:.4} s, least {least:.4} s", motion.seconds());
            assert!(
                motion.seconds() > least - 1e-3 && motion.seconds() < least + 2e-3,
                "{letter}{way}: {} s, least {least} s",
                motion.seconds()
            );
        }
    }
}

/// A stop is made by a function that has to wait for the axes.
#[test]
fn a_corner_is_never_slower_than_a_stop() {
    for (step, across) in [0.02, 0.1, 0.5, 2.0, 10.0].into_iter().flat_map(|step| [(step, step), (step, 0.1 * step)]) {
        let corner = |i: i32| format!("G1X{:.4}Y{:.4}F6000", step * f64::from(i), across * f64::from(i % 2));
        let program = |between: &str| (1..40).map(|i| corner(i) + between).collect::<String>();
        let [flowing, stopping] =
            ["\n", "\nM9\n"].map(|between| Motion::of(&program(between), settings(drives()), |_| 100));
        let [flowing, stopping] = [flowing, stopping].map(|motion| motion.seconds());
        println!("40 corners {step} by {across:.3} mm: {flowing:.3} s, {stopping:.3} s with stops");
        assert!(flowing <= stopping, "{step} by {across} mm: {flowing} s, {stopping} s with stops");
    }
}
