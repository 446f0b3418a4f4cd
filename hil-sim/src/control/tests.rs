//! The control against closed forms: what an acceleration-limited machine must do.

use super::*;
use arcfeed_shared::units::S_PER_MIN;

const STEP: Micros = Micros::from_ms(1);

/// Runs a program from memory; answers the control and the time its axes moved, in seconds.
fn run(program: &str, override_percent: u8) -> (Control, f64) {
    let mut control =
        Control::from_memory(ControlSettings::fanuc_16i(LengthUnit::Inch), format!("{program}\nM30\n").as_bytes());
    let (mut now, mut moved) = (Micros(0), 0);
    while !control.is_over() {
        now = now.after(STEP);
        control.step(now, STEP, override_percent);
        moved += u64::from(control.active().is_some());
        assert!(now < Micros::from_ms(100_000), "{program}");
    }
    (control, moved as f64 * STEP.to_s())
}

/// The time of a move from rest to rest: `L/v + v/a`.
fn time_s(length_mm: f64, speed_mm_per_s: f64) -> f64 {
    length_mm / speed_mm_per_s + speed_mm_per_s / Dynamics::default().acceleration_mm_per_s2
}

fn close(got: f64, wanted: f64) {
    assert!((got - wanted).abs() <= 2.0 * STEP.to_s(), "{got} s, not {wanted} s");
}

#[test]
fn f25_is_25_inches_per_minute() {
    let inch_mm = LengthUnit::Inch.mm();
    close(run("G1X1.F25.", 100).1, time_s(inch_mm, 25.0 * inch_mm / S_PER_MIN));
    close(run("G1X1.F25", 100).1, time_s(inch_mm, 25.0 * inch_mm / S_PER_MIN));
}

#[test]
fn the_override_scales_the_feed_and_not_the_rapid() {
    let inch_mm = LengthUnit::Inch.mm();
    close(run("G1X1.F25.", 50).1, time_s(inch_mm, 12.5 * inch_mm / S_PER_MIN));
    let rapid = time_s(10.0 * inch_mm, Dynamics::default().rapid_mm_per_s);
    close(run("G0X10.", 50).1, rapid);
}

#[test]
fn inverse_time_takes_its_time() {
    // 1/50 min, and the time to speed up and slow down again.
    let speed = 5.0 * LengthUnit::Inch.mm() * 50.0 / S_PER_MIN;
    close(run("G1G93X3.Y4.B90.F50.", 100).1, time_s(5.0 * LengthUnit::Inch.mm(), speed));
}

#[test]
fn moves_in_one_line_flow_and_a_reversal_stops() {
    let inch_mm = LengthUnit::Inch.mm();
    let speed = 25.0 * inch_mm / S_PER_MIN;
    close(run("G1X1.F25.\nX2.\n(NOTE)\nX3.", 100).1, time_s(3.0 * inch_mm, speed));
    // At the reversal each side keeps half the permitted jump.
    let kept = Dynamics::default().corner_jump_mm_per_s / 2.0;
    let lost = (speed - kept) * (speed - kept) / (speed * Dynamics::default().acceleration_mm_per_s2);
    close(run("G1X1.F25.\nX0.", 100).1, time_s(2.0 * inch_mm, speed) + lost);
}

#[test]
fn a_program_that_comes_to_an_alarm_stops_before_the_block_and_keeps_what_it_did() {
    let (control, _) = run("G1X1.F25.\nG14\nX2.", 100);
    let alarm = control.alarm().expect("G14 is no G code");
    assert_eq!((alarm.line, alarm.fault.column), (2, 1));
    assert_eq!(control.executed(), [b"G1X1.F25."]);
    assert_eq!(control.position().linear[0].0, LengthUnit::Inch.nm());
}

#[test]
fn feed_hold_brings_the_axes_to_rest_within_the_braking_distance() {
    let mut control = Control::from_memory(ControlSettings::fanuc_16i(LengthUnit::Inch), b"G1X10.F100.\n");
    let mut steps = (1..).map(Micros::from_ms);
    let mut step = |control: &mut Control| control.step(steps.next().unwrap_or_default(), STEP, 100);
    (0..500).for_each(|_| step(&mut control));
    let before_mm = control.position().linear[0].to_mm();
    control.hold();
    (0..500).for_each(|_| step(&mut control));
    let speed = 100.0 * LengthUnit::Inch.mm() / S_PER_MIN;
    let braking_mm = speed * speed / (2.0 * Dynamics::default().acceleration_mm_per_s2);
    let braked_mm = control.position().linear[0].to_mm() - before_mm;
    assert!(control.is_at_rest() && (braked_mm - braking_mm).abs() < 0.1, "{braked_mm}");
}

#[test]
fn m0_waits_for_the_operator_and_goes_on() {
    let (control, _) = run("G1X1.F25.\nM0\nX2.", 100);
    assert_eq!(control.executed().len(), 4);
    assert_eq!(control.position().linear[0].0, 2 * LengthUnit::Inch.nm());
}

#[test]
fn the_override_takes_effect_one_ladder_scan_late() {
    let settings = ControlSettings::fanuc_16i(LengthUnit::Inch);
    let mut control = Control::from_memory(settings, b"G1X10.F100.\n");
    let seen: Vec<u8> = (1..=20)
        .map(|ms| {
            control.step(Micros::from_ms(ms), STEP, if ms > 5 { 150 } else { 100 });
            control.override_percent()
        })
        .collect();
    let first = seen.iter().position(|percent| *percent == 150);
    assert_eq!(first, Some(5 + settings.ladder_delay_steps));
}
