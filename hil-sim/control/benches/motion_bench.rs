//! Ratio of simulated time to processor time, at a period of a millisecond on one core, and its dependence on the
//! length of a program: the control under limits of all axes, and with controller and chip meter.
//!
//! `cargo bench --profile dist -p arcfeed-control --bench motion_bench`. Figures of one run are in docs/drives.md. The time is the
//! processor's, so that other work on the machine shows less.

use std::fmt::Write as _;

use arcfeed_control::drives::limits::{AxisLimits, DriveLimits};
use arcfeed_control::{Control, ControlSettings, Preset};
use arcfeed_units::{LengthUnit, Micros};

const STEP: Micros = Micros::from_ms(1);

/// X, Y, Z, A, B, C of a mid-size machine.
fn drives() -> DriveLimits {
    let linear = AxisLimits { speed_mm_per_s: 400.0, acceleration_mm_per_s2: 2_000.0, jerk_mm_per_s3: 20_000.0 };
    let rotary = AxisLimits { speed_mm_per_s: 60.0, acceleration_mm_per_s2: 300.0, jerk_mm_per_s3: 3_000.0 };
    let axes = [linear, linear, linear, rotary, rotary, rotary];
    DriveLimits { axes, tolerance_mm: 0.01, tolerance_deg: 0.01 }
}

/// Slots of a cup mill: arcs of 128.58 and 112.70 mm, and lines between them, at 635 mm/min.
fn slots(count: usize) -> String {
    let mut text = String::from("G90G94G17F635.\n");
    for slot in 0..count {
        let turned = 18.947 * slot as f64;
        writeln!(text, "G1G93Z-5.B{turned:.3}F50.\nG94F635.").unwrap_or_default();
        for _ in 0..13 {
            text.push_str("G2X20.922Y26.477I97.889J-55.852\nG1X19.64Y25.257Z-7.381\nG3X0.Y0.I78.25J-81.11\nG1Z-5.\n");
        }
    }
    text + "M30\n"
}

/// A surface in short moves: 0.2 mm each, five axes.
fn short_moves(count: usize) -> String {
    let mut text = String::from("G90G94G1F3000.\n");
    for at in 0..count {
        let along = 0.2 * at as f64;
        let (sin, cos) = libm::sincos(along / 20.0);
        writeln!(text, "X{along:.3}Y{:.4}Z{:.4}A{:.4}C{:.4}", 5.0 * sin, 2.0 * cos, 10.0 * cos, 20.0 * sin)
            .unwrap_or_default();
    }
    text + "M30\n"
}

/// Processor time of this process, in hundredths of a second as Linux counts.
fn processor_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    let ticks = after_name.split_whitespace().skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok());
    ticks.sum::<f64>() / 100.0
}

/// Runs a program: simulated seconds, and those of the processor.
fn run(program: &str, drives: Option<DriveLimits>) -> (f64, f64) {
    let settings = ControlSettings { drives, operator_restart: None, ..Preset::Fanuc31i.settings(LengthUnit::Mm) };
    let mut control = Control::from_memory(settings, program.as_bytes());
    let (began, mut now) = (processor_s(), Micros(0));
    while !control.is_over() {
        now = now.after(STEP);
        control.step(now, STEP, 100);
    }
    if let Some(alarm) = control.alarm() {
        println!("alarm: {alarm:?}");
    }
    (now.to_s(), processor_s() - began)
}

fn table(name: &str, programs: impl Iterator<Item = String>) {
    println!("{name}:");
    println!(
        "  {:>8}  {:>12}  {:>12}  {:>14}  {:>16}",
        "blocks", "simulated s", "processor s", "times as fast", "us a simulated s"
    );
    for program in programs {
        let (simulated, took) = run(&program, Some(drives()));
        let blocks = program.lines().count();
        let per_second = 1e6 * took / simulated;
        println!("  {blocks:>8}  {simulated:>12.1}  {took:>12.2}  {:>14.0}  {per_second:>16.1}", simulated / took);
    }
}

fn main() {
    table("slots of a cup mill", [4, 8, 16, 32, 64].into_iter().map(slots));
    table("short moves of five axes", [2_000, 4_000, 8_000, 16_000, 32_000].into_iter().map(short_moves));
    let program = slots(32);
    let [drives, trapezoid] = [Some(drives()), None].map(|limits| run(&program, limits)).map(|(s, took)| s / took);
    println!("32 slots, limits of all axes: {:.1} times as fast as with those of the path alone", drives / trapezoid);
}
