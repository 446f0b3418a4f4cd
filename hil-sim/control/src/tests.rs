//! The control against closed forms: what an acceleration-limited machine must do.

use super::dynamics::Dynamics;
use super::*;
use arcfeed_model::machine::ArcClamp;
use arcfeed_nc::macro_alarm::MacroAlarm;
use arcfeed_units::{LengthUnit, Mm, S_PER_MIN, US_PER_MS};

pub(super) const STEP: Micros = Micros::from_ms(1);

/// Runs a program from memory; returns the control and the time its axes moved, in seconds.
pub(super) fn run(program: &str, override_percent: u8) -> (Control, f64) {
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

/// Time of a move from rest to rest: `L/v + v/a`.
pub(super) fn time_s(length_mm: f64, speed_mm_per_s: f64) -> f64 {
    length_mm / speed_mm_per_s + speed_mm_per_s / Dynamics::default().acceleration_mm_per_s2
}

pub(super) fn close(got: f64, wanted: f64) {
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
fn an_alarm_stops_the_program_before_its_block_and_keeps_the_executed_blocks() {
    let (control, _) = run("G1X1.F25.\nG14\nX2.", 100);
    let alarm = control.alarm().expect("G14 is no G code");
    assert_eq!((alarm.line, alarm.fault.column), (2, 1));
    assert_eq!(control.executed(), [b"G1X1.F25."]);
    assert_eq!(control.position().linear[0].0, LengthUnit::Inch.nm());
}

/// A control in millimetres without an operator who presses cycle start.
pub(super) fn alone(program: &str, switches: Switches) -> Control {
    let settings = ControlSettings::fanuc_16i(LengthUnit::Mm);
    Control::from_memory(ControlSettings { operator_restart: None, switches, ..settings }, program.as_bytes())
}

/// Steps until `is_done`; returns the time it took in milliseconds.
pub(super) fn until(control: &mut Control, now: &mut Micros, is_done: impl Fn(&Control) -> bool) -> u64 {
    let from = *now;
    while !is_done(control) {
        *now = now.after(STEP);
        control.step(*now, STEP, 100);
        assert!(now.since(from) < Micros::from_ms(100_000));
    }
    now.since(from).0 / US_PER_MS
}

pub(super) fn x_mm(control: &Control) -> f64 {
    control.position().linear[0].to_mm()
}

#[test]
fn an_arc_is_clamped_to_the_root_of_its_radius() {
    // V = 3000 mm/min at R = 5 mm: at 1.25 mm half of it, at 5 mm all of it, and never more than F.
    let clamp = ArcClamp { feed: MmPerMin(3_000.0), radius: Mm(5.0), floor: MmPerMin(100.0) };
    for (radius, override_percent, feed) in [(1.25, 100, 1_500.0), (5.0, 200, 3_000.0), (20.0, 100, 2_000.0)] {
        let settings = ControlSettings { arc_clamp: Some(clamp), ..ControlSettings::fanuc_16i(LengthUnit::Mm) };
        let program = format!("G1X0F2000\nG2X0Y0I{radius:?}\nM30\n");
        let mut control = Control::from_memory(settings, program.as_bytes());
        let mut fastest = 0.0_f32;
        for ms in 1..20_000 {
            control.step(Micros::from_ms(ms), STEP, override_percent);
            fastest = fastest.max(control.commanded().0);
        }
        assert!(control.has_ended() && (fastest - feed).abs() < 0.01, "{radius}: {fastest}");
    }
}

#[test]
fn blocks_shorter_than_their_processing_set_the_feed() {
    // 0.05 mm in 2 ms: 25 mm/s, where F asks for 50.
    let program: String = (1..=400).map(|block| format!("G1X{:.2}F3000\n", 0.05 * f64::from(block))).collect();
    let mut control = alone(&(program + "M30\n"), Switches::default());
    let mut now = Micros(0);
    until(&mut control, &mut now, |control| x_mm(control) >= 5.0);
    let from_mm = x_mm(&control);
    let took_ms = until(&mut control, &mut now, |control| x_mm(control) >= 15.0);
    let speed = (x_mm(&control) - from_mm) / (took_ms as f64 / 1e3);
    assert!(speed <= 25.5 && speed > 20.0, "{speed} mm/s");
}

#[test]
fn a_jump_in_a_program_over_the_line_is_alarm_123() {
    let mut control = Control::on_line(ControlSettings::fanuc_16i(LengthUnit::Mm));
    control.port().on_bytes(b"%\nG90\nN5 GOTO 5\nM30\n%");
    until(&mut control, &mut Micros(0), Control::is_over);
    let alarm = control.alarm().expect("it cannot jump");
    assert_eq!((alarm.line, alarm.fault), (3, Fault::in_macro(MacroAlarm::NotInDnc, 4)));
}

/// A random number generator of 64 bits (xorshift), seeded.
fn random(state: &mut u64) -> u64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    *state
}

#[test]
fn random_bytes_over_the_line_stop_the_control_or_are_executed() {
    const PIECES: [&[u8]; 24] = [
        b"%",
        b"\n",
        b"G1X1.F9.\n",
        b"G2X0Y0I1.\n",
        b"N9",
        b"/",
        b"(",
        b"M0\n",
        b"G4P9\n",
        b"GOTO9\n",
        b"G83X1.Z-9.R1.Q2.F99\n",
        b"G91G84X1.Z-3.R-1.K3\n",
        b"G80\n",
        b"G28Z0\n",
        b"G55G43H1\n",
        b"G68X0Y0R30.\n",
        b"G63\n",
        b"G51.1X3.\n",
        b"G51X1.Y0P700\n",
        b"G10L2P1X5.\n",
        b"\x80",
        b"\x00",
        b"\x13",
        b"M30\n",
    ];
    for seed in 1..=300_u64 {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let preset = [Preset::Fanuc16i, Preset::Fanuc0i, Preset::Fanuc31i][seed as usize % 3];
        let mut control = Control::on_line(preset.settings(LengthUnit::Mm));
        for ms in 1..2_000 {
            match random(&mut state) % 400 {
                0 => control.reset(),
                1 => control.hold(),
                2..8 => control.cycle_start(),
                8 => control.search(Search::Restart(9)),
                9 => control.port().on_framing_error(),
                10 => control.switches_mut().single_block ^= true,
                11..40 => control.port().on_bytes(&[random(&mut state) as u8]),
                40..120 => control.port().on_bytes(PIECES[random(&mut state) as usize % PIECES.len()]),
                _ => {}
            }
            control.step(Micros::from_ms(ms), STEP, random(&mut state) as u8);
            assert!(control.speed_mm_per_s().is_finite() && control.speed_mm_per_s() >= 0.0, "seed {seed}");
            assert!(control.override_percent() <= 254, "seed {seed}");
        }
    }
}
