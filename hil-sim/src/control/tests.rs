//! The control against closed forms: what an acceleration-limited machine must do.

use super::dynamics::Dynamics;
use super::*;
use arcfeed_shared::machine::ArcClamp;
use arcfeed_shared::nc::macro_alarm::MacroAlarm;
use arcfeed_shared::units::{LengthUnit, Mm, Nm, S_PER_MIN};

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

/// A control in millimetres with nobody to press cycle start.
fn alone(program: &str, switches: Switches) -> Control {
    let settings = ControlSettings::fanuc_16i(LengthUnit::Mm);
    Control::from_memory(ControlSettings { operator_restart: None, switches, ..settings }, program.as_bytes())
}

/// Steps until `is_done`; answers the time it took in milliseconds.
fn until(control: &mut Control, now: &mut Micros, is_done: impl Fn(&Control) -> bool) -> u64 {
    let from = *now;
    while !is_done(control) {
        *now = now.after(STEP);
        control.step(*now, STEP, 100);
        assert!(now.since(from) < Micros::from_ms(100_000));
    }
    now.since(from).0 / US_PER_MS
}

fn x_mm(control: &Control) -> f64 {
    control.position().linear[0].to_mm()
}

#[test]
fn feed_hold_brakes_with_the_axes_acceleration_and_cycle_start_goes_on() {
    let mut control = alone("G1X100.F6000\nM30\n", Switches::default());
    let mut now = Micros(0);
    until(&mut control, &mut now, |control| x_mm(control) > 30.0);
    let from_mm = x_mm(&control);
    control.hold();
    let braking_ms = until(&mut control, &mut now, Control::is_at_rest);
    // v^2 / 2a = 100^2 / 1000 = 10 mm in v / a = 200 ms.
    assert!((x_mm(&control) - from_mm - 10.0).abs() < 1e-6, "{}", x_mm(&control) - from_mm);
    assert_eq!(braking_ms, 200);
    assert_eq!(control.executed().len(), 1);
    control.cycle_start();
    until(&mut control, &mut now, Control::is_over);
    assert_eq!(x_mm(&control), 100.0);
}

#[test]
fn feed_hold_stops_a_dwell() {
    let mut control = alone("G4P500\nM30\n", Switches::default());
    let mut now = Micros(0);
    let mut step = |control: &mut Control| {
        now = now.after(STEP);
        control.step(now, STEP, 100);
    };
    (0..200).for_each(|_| step(&mut control));
    control.hold();
    (0..1_000).for_each(|_| step(&mut control));
    assert!(!control.is_over());
    control.cycle_start();
    let left = (0..).find(|_| {
        step(&mut control);
        control.is_over()
    });
    // 500 ms, of which the first step begins the dwell and 199 passed before feed hold.
    assert_eq!(left, Some(300));
}

#[test]
fn single_block_waits_after_each_block_and_comments_are_none() {
    let switches = Switches { single_block: true, ..Switches::default() };
    let mut control = alone("(NOTE)\nG90\nG1X10.F6000\nX20.\nM30\n", switches);
    let mut now = Micros(0);
    for (blocks, x) in [(2, 0.0), (3, 10.0), (4, 20.0)] {
        until(&mut control, &mut now, Control::is_stopped);
        assert_eq!((control.executed().len(), x_mm(&control), control.is_at_rest()), (blocks, x, true));
        control.cycle_start();
    }
    until(&mut control, &mut now, Control::is_over);
}

#[test]
fn m01_stops_where_its_switch_is_on() {
    for optional_stop in [false, true] {
        let switches = Switches { optional_stop, ..Switches::default() };
        let mut control = alone("G1X1.F600\nM1\nX2.\nM30\n", switches);
        until(&mut control, &mut Micros(0), |control| control.is_stopped() || control.is_over());
        assert_eq!((control.is_stopped(), x_mm(&control)), if optional_stop { (true, 1.0) } else { (false, 2.0) });
    }
}

#[test]
fn block_delete_counts_when_a_block_is_read_and_m0_stops_reading() {
    let program = "G1X1.F600\n/X5.\nM0\n/X7.\nM30\n";
    let mut control = alone(program, Switches::default());
    let mut now = Micros(0);
    until(&mut control, &mut now, |control| control.queued() > 0);
    // Too late for the first, which is read; the second is not read before M0 is done.
    control.switches_mut().block_delete = 1;
    until(&mut control, &mut now, Control::is_stopped);
    assert_eq!(x_mm(&control), 5.0);
    control.cycle_start();
    until(&mut control, &mut now, Control::is_over);
    assert_eq!((x_mm(&control), control.has_ended()), (5.0, true));
}

#[test]
fn dry_run_takes_its_own_feed_and_no_override() {
    let mut control = alone("G1X100.F100\nM30\n", Switches { dry_run: true, ..Switches::default() });
    let took_s = until(&mut control, &mut Micros(0), Control::is_over) as f64 / 1e3;
    close(took_s, time_s(100.0, 2_000.0 / S_PER_MIN));
}

#[test]
fn a_cancelled_override_is_100_percent() {
    let mut control = alone("G1X100.F6000\nM30\n", Switches { override_cancel: true, ..Switches::default() });
    control.step(STEP, STEP, 10);
    (2..300).for_each(|ms| control.step(Micros::from_ms(ms), STEP, 10));
    assert_eq!((control.override_percent(), control.commanded()), (100, MmPerMin(6_000.0)));
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
fn reset_stops_the_axes_and_cycle_start_reads_from_the_label() {
    let mut control = Control::on_line(ControlSettings::fanuc_16i(LengthUnit::Mm));
    let mut now = Micros(0);
    control.port().on_bytes(b"%\nG1X100.F6000\nX200.\n");
    until(&mut control, &mut now, |control| x_mm(control) > 30.0);
    let from_mm = x_mm(&control);
    control.reset();
    until(&mut control, &mut now, Control::is_ready);
    let stands_mm = x_mm(&control);
    assert!((stands_mm - from_mm - 10.0).abs() < 1e-6);
    control.cycle_start();
    control.port().on_bytes(b"%\nG91G1X5.F6000\nM30\n%");
    until(&mut control, &mut now, Control::is_over);
    assert!(control.has_ended() && (x_mm(&control) - stands_mm - 5.0).abs() < 1e-9, "{:?}", control.alarm());
}

#[test]
fn a_restart_meets_the_modal_state_and_the_place_it_would_have_met() {
    let program = "N1G90G1X10.Y20.F600\nN2G91X5.\nN3Y5.\nN4X1.\nM30\n";
    let end = |search: Option<Search>| {
        let mut control = alone(program, Switches::default());
        let mut now = Micros(0);
        if let Some(search) = search {
            control.search(search);
            if let Search::Restart(_) = search {
                until(&mut control, &mut now, |control| control.is_stopped() || control.is_over());
                assert_eq!(control.position(), Pose::ORIGIN, "nothing moves before cycle start");
                control.cycle_start();
            }
        }
        until(&mut control, &mut now, Control::is_over);
        let [x, y, _] = control.position().linear.map(Nm::to_mm);
        (x, y, control.executed().len(), control.alarm().map(|alarm| alarm.fault))
    };
    assert_eq!(end(None), (16.0, 25.0, 5, None));
    assert_eq!(end(Some(Search::Restart(3))), (16.0, 25.0, 3, None));
    // A search knows neither G91 nor F: N3 has no feed, and G0 from power-on needs none.
    assert_eq!(end(Some(Search::Sequence(3))), (1.0, 5.0, 3, None));
    for search in [Search::Restart(9), Search::Sequence(9)] {
        assert_eq!(end(Some(search)).3, Some(Fault::alarm(Alarm::SequenceNotFound, 0)));
    }
}

#[test]
fn a_restart_moves_one_axis_after_the_other_at_the_dry_run_feed() {
    let mut control = alone("N1G1X100.Y50.F60\nN2X101.\nM30\n", Switches::default());
    control.search(Search::Restart(2));
    let mut now = Micros(0);
    until(&mut control, &mut now, Control::is_stopped);
    control.cycle_start();
    let took_ms = until(&mut control, &mut now, |control| control.position().linear[1].to_mm() >= 50.0);
    let speed = 2_000.0 / S_PER_MIN;
    // The step in which Y arrives is also the first of N2.
    assert!((x_mm(&control) - 100.0).abs() < 1e-3);
    // Two moves, each from rest to nearly rest: the corner may keep its jump.
    let longest = time_s(100.0, speed) + time_s(50.0, speed);
    assert!((longest - 0.1..=longest + 0.02).contains(&(took_ms as f64 / 1e3)), "{took_ms}");
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
fn whatever_comes_over_the_line_the_control_stops_or_goes_on() {
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

/// The time from rest to rest, also of moves too short to reach the speed.
fn rest_to_rest_s(length_mm: f64, speed_mm_per_s: f64) -> f64 {
    let acceleration = Dynamics::default().acceleration_mm_per_s2;
    if length_mm * acceleration < speed_mm_per_s * speed_mm_per_s {
        return 2.0 * libm::sqrt(length_mm / acceleration);
    }
    time_s(length_mm, speed_mm_per_s)
}

/// Moves as the axes made them: `r` or `f` and the end, mm; with the time that all of it took, s.
fn trace(control: &mut Control, override_percent: u8) -> (Vec<(char, [f64; 3])>, f64) {
    let (mut moves, mut last, mut moved) = (Vec::new(), None, 0);
    for ms in 1.. {
        control.step(Micros::from_ms(ms), STEP, override_percent);
        let active = control.active().map(|(count, segment)| (count, *segment));
        moved += u64::from(active.is_some());
        if let Some((_, segment)) = active.filter(|_| active != last) {
            let kind = if segment.path == arcfeed_shared::segment::Path::Rapid { 'r' } else { 'f' };
            moves.push((kind, segment.end.linear.map(Nm::to_mm)));
        }
        last = active;
        if control.is_over() {
            assert_eq!(control.alarm(), None);
            break;
        }
    }
    (moves, moved as f64 * STEP.to_s())
}

#[test]
fn deep_hole_drilling_takes_its_pecks_and_their_time() {
    // 10 mm below R in cuts of 4 mm: 4, 4 and 2. Each but the first begins 1 mm above the last bottom.
    let mut control = alone("F300\nG83X30.Z-8.R2.Q4.\nM30\n", Switches::default());
    let (moves, took_s) = trace(&mut control, 100);
    let z = |moves: &[(char, [f64; 3])]| moves.iter().map(|(kind, [.., z])| (*kind, *z)).collect::<Vec<_>>();
    let mut wanted = vec![('r', 0.0), ('r', 2.0)];
    wanted.extend([
        ('f', -2.0),
        ('r', 2.0),
        ('r', -1.0),
        ('f', -6.0),
        ('r', 2.0),
        ('r', -5.0),
        ('f', -8.0),
        ('r', 0.0),
    ]);
    assert_eq!(z(&moves), wanted);
    let rapid = Dynamics::default().rapid_mm_per_s;
    let cuts: f64 = [4.0, 5.0, 3.0].map(|mm| rest_to_rest_s(mm, 5.0)).iter().sum();
    let rapids: f64 = [30.0, 2.0, 4.0, 3.0, 8.0, 7.0, 8.0].map(|mm| rest_to_rest_s(mm, rapid)).iter().sum();
    let per_move_s = 1.5 * STEP.to_s();
    assert!((took_s - cuts - rapids).abs() < per_move_s * moves.len() as f64, "{took_s} s, not {} s", cuts + rapids);
    assert_eq!(control.executed().len(), 3);
}

#[test]
fn a_turned_bolt_circle_is_drilled_where_the_drawing_has_it_in_machine_coordinates() {
    let mut settings = ControlSettings::fanuc_16i(LengthUnit::Mm);
    settings.tables.systems[1].linear = [-300.0, -200.0, -400.0].map(Nm::from_mm);
    settings.tables.lengths[6] = [Nm::from_mm(120.5), Nm(0)];
    let program = "G55G43H7G0Z50.\nG68X0Y0R30.\nG99G82Z-8.R2.P100F300X40.Y0\nX0Y40.\nX-40.Y0\nX0Y-40.\nG80\nM30\n";
    let mut control = Control::from_memory(settings, program.as_bytes());
    let (moves, _) = trace(&mut control, 100);
    let holes: Vec<[f64; 3]> = moves.iter().filter(|(kind, _)| *kind == 'f').map(|(_, end)| *end).collect();
    assert_eq!(holes.len(), 4);
    for (quarter, hole) in holes.iter().enumerate() {
        let (sin, cos) = libm::sincos((30.0 + 90.0 * quarter as f64).to_radians());
        let wanted = [-300.0 + 40.0 * cos, -200.0 + 40.0 * sin, -400.0 + 120.5 - 8.0];
        assert!(hole.iter().zip(wanted).all(|(got, wanted)| (got - wanted).abs() < 2e-6), "{hole:?}, not {wanted:?}");
    }
    assert_eq!(moves[0], ('r', [0.0, 0.0, -400.0 + 120.5 + 50.0]), "the tool's length is part of the first move");
}

#[test]
fn offsets_local_shifts_and_reference_points_are_machine_coordinates() {
    let mut settings = ControlSettings::fanuc_16i(LengthUnit::Mm);
    settings.tables.systems[0].linear[0] = Nm::from_mm(100.0);
    settings.nc.reference[0].linear = [0.0, 0.0, 7.0].map(Nm::from_mm);
    let program = "G0X1.\nG52X10.\nX1.\nG52X0\nG92X0\nX5.\nG53X3.\nG10L2P1X200.\nG92.1X0\nX1.\nG28X20.Z0\nM30\n";
    let mut control = Control::from_memory(settings, program.as_bytes());
    let (moves, _) = trace(&mut control, 100);
    let ends: Vec<[f64; 2]> = moves.iter().map(|(_, [x, _, z])| [*x, *z]).collect();
    // 100 + 1; 100 + 10 + 1; 111 is called 0: 111 + 5; 3; 200 + 1; by way of 220 to the reference point.
    assert_eq!(ends, [[101.0, 0.0], [111.0, 0.0], [116.0, 0.0], [3.0, 0.0], [201.0, 0.0], [220.0, 0.0], [0.0, 7.0]]);
}

#[test]
fn single_block_stops_in_a_cycle_at_the_hole_above_it_and_behind_it() {
    let switches = Switches { single_block: true, ..Switches::default() };
    let mut control = alone("G91G81X10.Z-8.R-3.K2F600\nG80G28Z2.\nM30\n", switches);
    let mut now = Micros(0);
    let stops =
        [(10.0, 0.0), (10.0, -3.0), (10.0, 0.0), (20.0, 0.0), (20.0, -3.0), (20.0, 0.0), (20.0, 2.0), (20.0, 0.0)];
    for (x, z) in stops {
        until(&mut control, &mut now, Control::is_stopped);
        let [at_x, _, at_z] = control.position().linear.map(Nm::to_mm);
        assert_eq!((at_x, at_z, control.is_at_rest()), (x, z, true));
        control.cycle_start();
    }
    until(&mut control, &mut now, Control::is_over);
    assert_eq!(control.executed().len(), 3);
}

#[test]
fn a_tap_in_its_hole_knows_neither_override_nor_feed_hold() {
    let program = "G84X1.Z-10.R2.F600P200\nM30\n";
    let mut control = alone(program, Switches::default());
    let (_, at_full_s) = trace(&mut alone(program, Switches::default()), 100);
    let (_, at_half_s) = trace(&mut alone(program, Switches::default()), 50);
    assert_eq!(at_half_s, at_full_s);
    let mut now = Micros(0);
    until(&mut control, &mut now, |control| control.position().linear[2].to_mm() < -4.0);
    control.hold();
    (0..20_000).for_each(|_| {
        now = now.after(STEP);
        control.step(now, STEP, 100);
    });
    // It went down, turned, came up to R and stands there.
    assert_eq!((control.position().linear[2].to_mm(), control.is_at_rest()), (2.0, true));
    control.cycle_start();
    until(&mut control, &mut now, Control::is_over);
    assert_eq!(control.position().linear[2].to_mm(), 0.0);
}

#[test]
fn under_g63_the_override_is_100_percent_until_another_mode() {
    let speed = 10.0;
    for (program, cut_s) in
        [("G63\nG1X10.F600\nM30\n", time_s(10.0, speed)), ("G63\nG64\nG1X10.F600\nM30\n", time_s(10.0, speed / 2.0))]
    {
        close(trace(&mut alone(program, Switches::default()), 50).1, cut_s);
    }
}

#[test]
fn a_restart_shows_what_it_does_not_send_and_waits() {
    let program = "T7M6\nS1200M3\nG54G90G0X10.\nG43H2Z5.M8\nN5G1X20.F250M9\nX30.\nM30\n";
    let mut control = alone(program, Switches::default());
    control.search(Search::Restart(5));
    let mut now = Micros(0);
    until(&mut control, &mut now, Control::is_stopped);
    let list = control.restart_list().expect("it was found");
    assert_eq!((list.t, list.s, Vec::from(list.m.clone()), list.feed()), (Some(7), Some(1200), vec![6, 3, 8], None));
    assert_eq!(list.codes().join(" "), "G0 G17 G90 G94 G21 G40 G98 G43 H2 G54");
    control.cycle_start();
    until(&mut control, &mut now, Control::is_over);
    assert_eq!((x_mm(&control), control.executed()[0].as_slice()), (30.0, b"N5G1X20.F250M9".as_slice()));
}

#[test]
fn a_restart_in_the_middle_of_a_cycle_meets_the_cycle() {
    let program = "F600\nG99G81X10.Z-8.R2.\nX20.\nN5X30.\nM30\n";
    let mut control = alone(program, Switches::default());
    control.search(Search::Restart(5));
    let mut now = Micros(0);
    until(&mut control, &mut now, Control::is_stopped);
    assert_eq!(control.restart_list().map(|list| list.codes().contains(&"G81".to_owned())), Some(true));
    control.cycle_start();
    let (moves, _) = trace(&mut control, 100);
    // To where the second hole left the tool, X then Z; then the third hole.
    let wanted = [('f', 20.0, 0.0), ('f', 20.0, 2.0), ('r', 30.0, 2.0), ('f', 30.0, -8.0), ('r', 30.0, 2.0)];
    assert_eq!(moves.iter().map(|(kind, [x, _, z])| (*kind, *x, *z)).collect::<Vec<_>>(), wanted);
}
