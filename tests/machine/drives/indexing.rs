//! The moves between the slots of the published listing (Petean 2004, appendix): the pallet B turns while the tool goes down,
//! in inverse time.

use arcfeed::machine_file::MachineFile;
use arcfeed_control::drives::limits::{AxisLimits, DriveLimits};
use arcfeed_control::{Control, ControlSettings};
use arcfeed_units::{LengthUnit, Micros};

use crate::drives::motion::{STEP, drives};

const B: usize = 4;

/// The HU80A-5X as its file has it; B about to be given another speed.
pub fn hu80a(b_deg_per_min: Option<f64>) -> DriveLimits {
    let file = MachineFile::preset("mitsui-seiki-hu80a-5x").expect("it is there").expect("it is a machine");
    let of = file.drives.expect("its drives are given");
    let limits = |drive: &arcfeed::machine_file::drives::Drive| AxisLimits {
        speed_mm_per_s: drive.speed_mm_per_s,
        acceleration_mm_per_s2: drive.acceleration_mm_per_s2,
        jerk_mm_per_s3: drive.jerk_mm_per_s3,
    };
    let [x, y, z] = of.linear.each_ref().map(limits);
    let [mut b, a] = of.rotary.each_ref().map(limits);
    b.speed_mm_per_s = b_deg_per_min.map_or(b.speed_mm_per_s, |speed| speed / 60.0);
    DriveLimits { axes: [x, y, z, a, b, b], ..drives() }
}

/// Runs a block of a program in inches, at rest before and behind it: its time, and what an axis kept from its feed.
fn run(before: &str, block: &str, drives: DriveLimits) -> (f64, Control) {
    let program = format!("G20G90G94G1F50.\n{before}\nM9\n{block}\nM9\nM30\n");
    let settings = ControlSettings { drives: Some(drives), ..ControlSettings::fanuc_16i(LengthUnit::Inch) };
    let mut control = Control::from_memory(settings, program.as_bytes());
    let (mut now, mut moved, mut last) = (Micros(0), 0, *control.axes());
    while !control.is_over() {
        now = now.after(STEP);
        control.step(now, STEP, 100);
        let is_block = control.active().is_some_and(|(count, _)| count >= 4);
        moved += u64::from(is_block && *control.axes() != last);
        last = *control.axes();
    }
    assert_eq!(control.alarm(), None);
    (moved as f64 * STEP.to_s(), control)
}

/// Time that both ramps add to a move at a speed: half of each ramp's time twice, `v/A + A/J`, or `2 sqrt(v/J)`.
fn ramps_s(speed: f64, acceleration: f64, jerk: f64) -> f64 {
    if speed >= acceleration * acceleration / jerk {
        speed / acceleration + acceleration / jerk
    } else {
        2.0 * libm::sqrt(speed / jerk)
    }
}

/// Before, the block, its F (times a minute), and what B covers.
const MOVES: [(&str, &str, f64, f64); 3] = [
    ("X-3.6044Y10.5358Z-26.7876B103.946", "N206G93X-3.6044Y10.5358Z-27.2876B122.894F50.", 50.0, 18.948),
    ("X-3.6044Y10.5358Z-26.7876B122.894", "N286G93X-3.6044Y10.5358Z-27.2876B141.841F50.", 50.0, 18.947),
    ("X2.3495Y9.6819Z-15.2084B444.999", "N1584G93X20.0908Y10.426Z-9.9636A.0B317.957F10.802", 10.802, 127.042),
];

#[test]
fn indexing_takes_its_programmed_time_and_the_ramps() {
    for (before, block, per_min, turned_deg) in MOVES {
        let drives = hu80a(None);
        let (seconds, control) = run(before, block, drives);
        let programmed = 60.0 / per_min;
        // B accelerates worst for its part: what it gives to the path, in degrees.
        let b = drives.axes[B];
        let ramps = ramps_s(turned_deg / programmed, b.acceleration_mm_per_s2, b.jerk_mm_per_s3);
        println!("{block}: {seconds:.3} s = {programmed:.3} s programmed + {ramps:.3} s of ramps");
        assert!((seconds - programmed - ramps).abs() < 2e-3, "{block}: {seconds} s");
        assert_eq!(control.limited(), [], "{block}");
    }
}

#[test]
fn a_pallet_that_is_too_slow_takes_its_own_time_and_is_named() {
    for (before, block, per_min, turned_deg) in MOVES {
        let drives = hu80a(Some(600.0));
        let (seconds, control) = run(before, block, drives);
        let b = drives.axes[B];
        let least =
            turned_deg / b.speed_mm_per_s + ramps_s(b.speed_mm_per_s, b.acceleration_mm_per_s2, b.jerk_mm_per_s3);
        println!("{block} with B at 600 deg/min: {seconds:.3} s, {least:.3} s at the least");
        assert!((seconds - least).abs() < 2e-3, "{block}: {seconds} s");
        let limited = control.limited().iter().find(|limited| limited.sequence.is_some()).expect("it is named");
        let ratio = limited.allowed_mm_per_s / limited.wanted_mm_per_s;
        assert_eq!(limited.axis, B);
        assert!((ratio - 600.0 / (turned_deg * per_min)).abs() < 1e-9, "{ratio}");
    }
}
