//! Blocks of several motions, against the drawing and sums by hand: cycles, taps, offsets, reference points.

use crate::dynamics::Dynamics;
use crate::tests::{STEP, alone, close, time_s, until};
use crate::*;
use arcfeed_units::{LengthUnit, Nm};

/// The time from rest to rest, also of moves too short to reach the speed.
fn rest_to_rest_s(length_mm: f64, speed_mm_per_s: f64) -> f64 {
    let acceleration = Dynamics::default().acceleration_mm_per_s2;
    if length_mm * acceleration < speed_mm_per_s * speed_mm_per_s {
        return 2.0 * libm::sqrt(length_mm / acceleration);
    }
    time_s(length_mm, speed_mm_per_s)
}

/// Moves of the axes, each `r` or `f` with its end in mm, and the time of all of them in s.
fn trace(control: &mut Control, override_percent: u8) -> (Vec<(char, [f64; 3])>, f64) {
    let (mut moves, mut last, mut moved) = (Vec::new(), None, 0);
    for ms in 1.. {
        control.step(Micros::from_ms(ms), STEP, override_percent);
        let active = control.active().map(|(count, segment)| (count, *segment));
        moved += u64::from(active.is_some());
        if let Some((_, segment)) = active.filter(|_| active != last) {
            let kind = if segment.path == arcfeed_nc::segment::Path::Rapid { 'r' } else { 'f' };
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
    // 100 + 1; 100 + 10 + 1; 111 becomes 0: 111 + 5; 3; 200 + 1; through 220 to the reference point.
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
fn a_tap_in_its_hole_ignores_override_and_feed_hold() {
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
    // The tap went down, reversed, came up to R and stopped there.
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
fn a_restart_in_the_middle_of_a_cycle_is_in_the_cycle() {
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
