//! No axis beyond its limits, whatever the program and whatever the override does.

use arcfeed_tests::of_full_set;
use std::fmt::Write as _;

use arcfeed_control::drives::limits::{AxisLimits, DriveLimits};
use arcfeed_control::{ControlSettings, Preset};
use arcfeed_units::LengthUnit;

use crate::drives::motion::{Motion, drives, settings};

/// Programs of each kind: some, or with `ARCFEED_SOAK_SECONDS` many.
fn seeds(short: u64, long: u64) -> std::ops::Range<u64> {
    0..of_full_set(long, short)
}

/// A program of 60 blocks over five axes: lines, arcs in all planes, helices, turns of the rotary axes alone, reversals, from
/// a micrometre to 50 mm, some tangent and most not.
pub fn any_program(random: &mut fastrand::Rng) -> String {
    let mut text = String::from("G90G1F3000\n");
    let (mut at, mut b, mut c) = ([0.0_f64; 3], 0.0_f64, 0.0_f64);
    for _ in 0..60 {
        let size = libm::pow(10.0, random.f64() * 4.7 - 3.0);
        let feed = libm::pow(10.0, 1.5 + 2.5 * random.f64());
        let mut signed = || size * (2.0 * random.f64() - 1.0);
        match [signed(), signed(), signed(), signed(), signed()] {
            steps if random.u8(..3) > 0 => {
                (0..3).for_each(|axis| at[axis] += steps[axis]);
                let kind = if random.u8(..8) == 0 { "G0" } else { "G1" };
                (b, c) = if random.bool() { (b + steps[3], c + steps[4]) } else { (b, c) };
                let [x, y, z] = at;
                writeln!(text, "{kind}X{x:.4}Y{y:.4}Z{z:.4}B{b:.4}C{c:.4}F{feed:.1}").unwrap();
            }
            [i, j, rise, ..] => {
                let radius = libm::hypot(i, j).max(0.005);
                let angle = 0.1 + 6.0 * random.f64();
                let from = libm::atan2(-j, -i);
                let way = if random.bool() { 1.0 } else { -1.0 };
                let [i, j] = [-radius * libm::cos(from), -radius * libm::sin(from)];
                let end = from + way * angle;
                at = [at[0] + i + radius * libm::cos(end), at[1] + j + radius * libm::sin(end), at[2] + rise];
                let code = if way > 0.0 { "G3" } else { "G2" };
                let [x, y, z] = at;
                writeln!(text, "{code}X{x:.4}Y{y:.4}Z{z:.4}I{i:.4}J{j:.4}F{feed:.1}").unwrap();
            }
        }
    }
    text
}

/// The machine of [`drives`], with every limit of every axis another.
fn any_drives(random: &mut fastrand::Rng) -> DriveLimits {
    let mut drives = drives();
    for AxisLimits { speed_mm_per_s: speed, acceleration_mm_per_s2: acceleration, jerk_mm_per_s3: jerk } in
        &mut drives.axes
    {
        for limit in [speed, acceleration, jerk] {
            *limit *= libm::pow(10.0, random.f64() - 0.5);
        }
    }
    drives
}

/// Program, control, drives, and which override it gets.
fn case(seed: u64) -> (String, ControlSettings, DriveLimits, u64) {
    let mut random = fastrand::Rng::with_seed(seed);
    let (program, drives) = (any_program(&mut random), any_drives(&mut random));
    let preset = [Preset::Fanuc16i, Preset::Fanuc0i, Preset::Fanuc31i][random.usize(..3)];
    let control = ControlSettings { drives: Some(drives), ..preset.settings(LengthUnit::Mm) };
    (program, control, drives, random.u64(..))
}

/// The override at a millisecond: as programmed, another every 40 ms, or another every millisecond.
fn percent(of: u64, ms: u64) -> u8 {
    match of % 3 {
        0 => 100,
        1 => fastrand::Rng::with_seed(of ^ (ms / 40)).u8(..=254),
        _ => fastrand::Rng::with_seed(of ^ ms).u8(..=254),
    }
}

#[test]
fn any_five_axis_program_stays_within_all_limits() {
    for seed in seeds(60, 5_000) {
        let (program, control, drives, of) = case(seed);
        Motion::of(&program, control, |ms| percent(of, ms)).keeps(&drives, &format!("seed {seed}"));
    }
}

#[test]
fn a_zigzag_stays_within_all_limits() {
    let drives = drives();
    for step in [0.0002, 0.02, 0.1, 0.5, 2.0, 10.0] {
        let corner = |i: i32| format!("G1X{:.4}Y{:.4}F6000\n", step * f64::from(i), step * f64::from(i % 2));
        let motion = Motion::of(&(1..40).map(corner).collect::<String>(), settings(drives), |_| 100);
        println!("40 corners {step} mm apart: {:.3} s, {:?}", motion.seconds(), motion.greatest());
        motion.keeps(&drives, "zigzag");
    }
}
