//! Operator actions against closed forms: holds, stops, switches, reset, restarts.

use crate::dynamics::Dynamics;
use crate::tests::{STEP, alone, close, run, time_s, until, x_mm};
use crate::*;
use arcfeed_nc::alarm::Alarm;
use arcfeed_units::{LengthUnit, Nm, S_PER_MIN};

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
fn a_restart_has_the_modal_state_and_the_position_of_a_run_from_the_beginning() {
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
fn a_restart_lists_the_functions_that_it_does_not_send_and_waits() {
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
