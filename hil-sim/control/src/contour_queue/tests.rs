//! Contours under G41 and G42 as the axes move along them.

use crate::tests::{STEP, until};
use crate::*;
use arcfeed_nc::alarm::{Alarm, Cause, NotModelled};
use arcfeed_nc::settings::StartUp;
use arcfeed_units::{LengthUnit, Nm};

const SQUARE: &str = "N1G0X-10.Y10.\nN2G42D1G1X0F6000\nN3Y0\nN4X20.\nN5Y20.\nN6X0\nN7Y10.\nN8G40X-10.\nM30\n";

fn settings(switches: Switches) -> ControlSettings {
    let mut settings = ControlSettings::fanuc_16i(LengthUnit::Mm);
    settings.tables.radii[0] = [Nm::from_mm(2.5), Nm::from_mm(-0.5)];
    settings.tables.radii[1] = [Nm::from_mm(8.0), Nm(0)];
    settings.switches = switches;
    settings
}

fn control(program: &str, switches: Switches) -> Control {
    Control::from_memory(settings(switches), program.as_bytes())
}

/// Moves of the axes: count of the block, N, end in X and Y, mm.
fn moves(control: &mut Control) -> Vec<(u32, Option<i64>, [f64; 2])> {
    let (mut found, mut last, mut now) = (Vec::new(), None, Micros(0));
    while !control.is_over() {
        now = now.after(STEP);
        control.step(now, STEP, 100);
        let active = control.active().map(|(count, segment)| (count, *segment));
        if let Some((count, segment)) = active.filter(|_| active != last) {
            let [x, y, _] = segment.end.linear.map(Nm::to_mm);
            found.push((count, segment.sequence, [x, y]));
        }
        last = active;
        assert!(now < Micros::from_ms(100_000));
    }
    found
}

fn ends(program: &str) -> Vec<[f64; 2]> {
    let mut control = control(program, Switches::default());
    let ends = moves(&mut control).into_iter().map(|(.., end)| end).collect();
    assert_eq!(control.alarm(), None);
    ends
}

#[test]
fn the_axes_follow_the_offset_contour_and_every_block_is_executed_once() {
    let mut control = control(SQUARE, Switches::default());
    let found = moves(&mut control);
    let wanted = [
        [-10.0, 10.0],
        [-2.0, 10.0],
        [-2.0, -2.0],
        [22.0, -2.0],
        [22.0, 22.0],
        [-2.0, 22.0],
        [-2.0, 10.0],
        [-10.0, 10.0],
    ];
    assert_eq!(found.iter().map(|(.., end)| *end).collect::<Vec<_>>(), wanted);
    assert!(found.iter().all(|(count, sequence, _)| *sequence == Some(i64::from(*count))), "{found:?}");
    let text: Vec<&[u8]> = SQUARE.lines().map(str::as_bytes).collect();
    assert_eq!(control.executed(), text);
}

#[test]
fn a_radius_of_zero_is_the_path_as_written() {
    assert_eq!(ends(&SQUARE.replace("D1", "D9")), ends(&SQUARE.replace("G42D1", "")));
}

#[test]
fn a_program_over_the_line_and_one_with_macros_make_the_same_moves() {
    let with_macro = SQUARE.replace("N4X20.", "#1=20.\nN4X#1");
    assert_eq!(ends(&with_macro), ends(SQUARE));
    assert_eq!(ends(&SQUARE.replace("N2G42D1", "N2G10L12P3R2.\nG42D3")), ends(SQUARE));
}

#[test]
fn the_move_around_a_corner_has_the_number_and_the_count_of_the_block_behind_it() {
    let program = "N1G0X-20.\nN2G42D1G1X0F6000\nN3X10.\nN4X0Y10.\nN5G40Y20.\nM30\n";
    let found = moves(&mut control(program, Switches::default()));
    let numbers: Vec<u32> = found.iter().map(|(count, ..)| *count).collect();
    assert_eq!(numbers, [1, 2, 3, 4, 4, 5]);
    assert_eq!(found[2].2, [12.0, -2.0]);
    assert!(found.iter().all(|(count, sequence, _)| *sequence == Some(i64::from(*count))));
}

#[test]
fn single_block_stops_once_for_each_block_before_the_move_around_its_corner() {
    let program = "N1G0X-20.\nN2G42D1G1X0F6000\nN3X10.\nN4X0Y10.\nN5G40Y20.\nM30\n";
    let mut control = control(program, Switches { single_block: true, ..Switches::default() });
    control.settings.operator_restart = None;
    let (mut now, mut stops) = (Micros(0), Vec::new());
    loop {
        until(&mut control, &mut now, |control| control.is_stopped() || control.is_over());
        if control.is_over() {
            break;
        }
        let [x, y, _] = control.position().linear.map(Nm::to_mm);
        stops.push([x, y].map(|mm| (mm * 1e3).round() / 1e3));
        control.cycle_start();
    }
    let half = (2.0 * core::f64::consts::FRAC_1_SQRT_2 * 1e3).round() / 1e3;
    assert_eq!(stops, [[-20.0, 0.0], [0.0, -2.0], [12.0, -2.0], [half, 10.0 + half], [0.0, 20.0]]);
}

#[test]
fn a_contour_that_the_tool_cannot_follow_stops_before_its_move() {
    let mut control = control("G0X-10.\nG41D2G1X0F6000\nX20.\nG3X25.Y5.J5.\nM30\n", Switches::default());
    moves(&mut control);
    let alarm = control.alarm().expect("the arc is too small");
    assert_eq!((alarm.line, alarm.fault), (4, Fault::alarm(Alarm::Interference, 0)));
    assert_eq!(control.position().linear[..2], [Nm::from_mm(20.0), Nm::from_mm(8.0)]);
    let mut step = self::control("G0X-10.\nG41D1G1X0F6000\nX20.\nY1.\nX0\nM30\n", Switches::default());
    moves(&mut step);
    let alarm = step.alarm().expect("the step is too low");
    assert_eq!((alarm.line, alarm.fault), (4, Fault::alarm(Alarm::Interference, 0)));
    assert_eq!(step.executed().len(), 3);
}

#[test]
fn a_stop_ends_the_contour_at_a_right_angle_and_a_corner_behind_it_is_refused() {
    assert_eq!(
        ends("G0X-10.\nG41D1G1X0F6000\nX20.\nM0\nX30.\nG40Y9.\nM30\n")[2..],
        [[20.0, 2.0], [30.0, 2.0], [30.0, 9.0]]
    );
    let mut control = control("G0X-10.\nG41D1G1X0F6000\nX20.\nM0\nY20.\nM30\n", Switches::default());
    moves(&mut control);
    let fault = Fault::not_modelled(NotModelled::UnreadCorner, 0);
    assert_eq!(control.alarm().map(|alarm| (alarm.line, alarm.fault)), Some((5, fault)));
}

#[test]
fn functions_and_other_axes_keep_their_place_between_the_moves() {
    let program = "G0X-10.\nG41D1G1X0F6000\nX20.\nM8\nY20.\nZ5.\nG40X0\nM30\n";
    let mut control = control(program, Switches::default());
    moves(&mut control);
    assert_eq!(control.alarm(), None);
    let text: Vec<&[u8]> = program.lines().map(str::as_bytes).collect();
    assert_eq!(control.executed(), text);
    assert_eq!(control.position().linear, [0.0, 20.0, 5.0].map(Nm::from_mm));
}

#[test]
fn after_g40_the_tool_goes_up_beside_the_contour_and_back_with_the_next_move_in_the_plane() {
    for up in ["G91G28Z0\nG90", "G53Z0", "G0Z0"] {
        let found = ends(&format!("G0X-10.\nG41D1G1X0F6000\nX20.Z-5.\nG40\n{up}\nG0X30.\nM30\n"));
        assert_eq!(found[2..], [[20.0, 2.0], [20.0, 2.0], [30.0, 0.0]], "{up}");
    }
}

#[test]
fn a_program_without_an_end_executes_its_last_move() {
    let mut control = control("G0X-10.\nG41D1G1X0F6000\nX20.\n", Switches::default());
    moves(&mut control);
    assert_eq!(control.alarm().map(|alarm| alarm.fault), Some(Fault::alarm(Alarm::EndOfRecord, 0)));
    assert_eq!(control.position().linear[..2], [Nm::from_mm(20.0), Nm::from_mm(2.0)]);
}

#[test]
fn a_restart_within_a_contour_is_refused_and_one_at_its_beginning_is_not() {
    for (number, refused) in [(2, false), (5, true), (8, false)] {
        let mut control = control(SQUARE, Switches::default());
        control.search(Search::Restart(number));
        moves(&mut control);
        let fault = Fault::not_modelled(NotModelled::RestartInContour, 0);
        assert_eq!(control.alarm().map(|alarm| alarm.fault), refused.then_some(fault), "N{number}");
    }
}

#[test]
fn a_reset_within_a_contour_forgets_the_offset() {
    let mut control = control(SQUARE, Switches::default());
    let mut now = Micros(0);
    until(&mut control, &mut now, |control| control.executed().len() == 4);
    control.reset();
    until(&mut control, &mut now, Control::is_ready);
    assert!(control.contour_queue.end().is_empty());
}

#[test]
fn start_up_b_goes_around_the_first_corner() {
    let mut settings = settings(Switches::default());
    settings.nc.compensation.start_up = StartUp::B;
    let mut control = Control::from_memory(settings, b"G0X-10.\nG42D1G1X0F6000\nY10.\nG40X-10.\nM30\n");
    let ends: Vec<[f64; 2]> = moves(&mut control).into_iter().map(|(.., end)| end).collect();
    assert_eq!(ends, [[-10.0, 0.0], [2.0, -2.0], [2.0, 12.0], [-10.0, 10.0]]);
}

#[test]
fn chamfers_and_rounded_corners_are_moves_of_their_own() {
    let program = "G0X0Y0\nG1X20.F6000,R5.\nY20.,C4.\n(NOTE)\nX0\nY10.\nM30\n";
    assert_eq!(ends(program), [[15.0, 0.0], [20.0, 5.0], [20.0, 16.0], [16.0, 20.0], [0.0, 20.0], [0.0, 10.0]]);
}

#[test]
fn the_tool_is_offset_beside_a_rounded_corner() {
    // The contour of a square with corners of 5 mm, and a tool of 2 mm outside it.
    let program = "G0X-10.Y10.\nG42D1G1X0F6000\nY0,R5.\nX20.,R5.\nY20.,C5.\nX0\nY10.\nG40X-10.\nM30\n";
    let found = ends(program);
    for wanted in [[-2.0, 5.0], [5.0, -2.0], [15.0, -2.0], [22.0, 5.0]] {
        assert!(found.contains(&wanted), "{wanted:?} in {found:?}");
    }
    // Beside the chamfer of 45 degrees the offset corners are 2 tan(22.5 degrees) beyond its ends.
    let beyond = 15.0 + 2.0 * libm::tan(std::f64::consts::PI / 8.0);
    assert!(found.iter().any(|[x, y]| (x - 22.0).abs() < 1e-5 && (y - beyond).abs() < 1e-5), "{found:?}");
}

#[test]
fn a_corner_that_does_not_fit_stops_the_control_before_its_move() {
    for (program, alarm, line) in [
        ("G1X3.F6000,R5.\nY20.\nM30\n", Alarm::ShortCorner, 1),
        ("G1X30.F6000,R5.\nY2.\nM30\n", Alarm::NoMoveBehindCorner, 2),
        ("G1X30.F6000,R5.\nM30\n", Alarm::NoMoveBehindCorner, 2),
        ("G1X30.F6000,R5.\nG0Y20.\nM30\n", Alarm::NoCutBehindCorner, 2),
        ("G1X30.F6000,R5.\n", Alarm::NoMoveBehindCorner, 1),
    ] {
        let mut control = control(program, Switches::default());
        let found = moves(&mut control);
        let record = control.alarm().map(|alarm| (alarm.line, alarm.fault.cause));
        assert_eq!((record, found.len()), (Some((line, Cause::Alarm(alarm))), 0), "{program}");
    }
}
