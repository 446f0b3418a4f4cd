//! Lines, offsets, canned cycles and macro expressions against another interpreter: every end point of
//! `tests/cases/moves-rs274` and `tests/cases/macros-rs274`, as LinuxCNC reads it.

use arcfeed_control::{Control, Preset, Switches};
use arcfeed_nc::segment::Path;
use arcfeed_nc::settings::Decimals;
use arcfeed_tests::root;
use arcfeed_units::{LengthUnit, Micros, MmPerMin, Nm};
use moves::{CLEARANCE, Move, moving, off_mm, ours};

#[path = "../rs274/moves.rs"]
pub mod moves;

/// Half of the last decimal that rs274 prints, in inches where the program is.
const PRINTED_MM: f64 = 0.000_05 * 25.4;
/// And half of the last decimal of the table, with what a sum of three printed numbers adds.
const ROUNDING_MM: f64 = 3.0 * PRINTED_MM + 0.000_05;
/// Half of the least increment, to which the value of a word is rounded, and of the last decimals of rs274 in mm and of the
/// table.
const OF_WORDS_MM: f64 = 0.000_5 + 2.0 * 0.000_05 + 1e-9;

fn text(case: &str, file: &str) -> String {
    let path = root().join("tests/cases").join(case).join(file);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn expected(case: &str) -> Vec<Move> {
    let row = |row: &str| {
        let numbers: Vec<f64> = row.split(' ').map(|number| number.parse().expect("a number")).collect();
        let [kind, x, y, z, u, v] = numbers[..] else { panic!("{row}") };
        Move { kind: kind as i8, end_mm: [x, y, z], center_mm: [u, v] }
    };
    text(case, "expected.txt").lines().map(row).collect()
}

fn program(case: &str) -> String {
    text(case, "program.nc").replace(' ', "")
}

fn assert_all_as_expected(case: &str, ours: &[Move], limit_mm: f64) {
    let expected = expected(case);
    let mut worst_mm = 0.0_f64;
    for (index, (found, wanted)) in ours.iter().zip(&expected).enumerate() {
        let off = off_mm(found, wanted);
        assert!(found.kind == wanted.kind && off <= limit_mm, "{case}, move {index}: {found:?}, not {wanted:?}");
        worst_mm = worst_mm.max(off);
    }
    assert_eq!(ours.len(), expected.len(), "{case}");
    println!("{case}: {} moves, worst difference {worst_mm:.6} mm of {limit_mm:.6} that is explained", ours.len());
}

fn read(case: &str) -> Vec<Move> {
    moving(&ours(program(case).as_bytes(), Decimals::Calculator, LengthUnit::Mm).expect("it is read"))
}

/// The moves that the simulated control's axes make.
fn executed(program: &str) -> Vec<Move> {
    let mut settings = Preset::Fanuc31i.settings(LengthUnit::Mm);
    settings.nc.decimals = Decimals::Calculator;
    (settings.nc.peck_clearance, settings.nc.peck_return) = (CLEARANCE, CLEARANCE);
    settings.switches = Switches { dry_run: true, ..settings.switches };
    settings.dry_run_feed = MmPerMin(6_000.0);
    let mut control = Control::from_memory(settings, program.as_bytes());
    let (mut moves, mut last) = (Vec::new(), None);
    for ms in 1.. {
        control.step(Micros::from_ms(ms), Micros::from_ms(1), 100);
        let active = control.active().map(|(count, segment)| (count, *segment));
        if let Some((_, segment)) = active.filter(|_| active != last) {
            let kind = if segment.path == Path::Rapid { 0 } else { 1 };
            moves.push(Move { kind, end_mm: segment.end.linear.map(Nm::to_mm), center_mm: [0.0; 2] });
        }
        last = active;
        if control.is_over() {
            break;
        }
    }
    assert_eq!(control.alarm(), None);
    moves
}

#[test]
fn the_simulated_control_makes_the_moves_that_linuxcnc_makes() {
    let case = "moves-rs274";
    assert_all_as_expected(case, &moving(&executed(&program(case))), ROUNDING_MM);
}

#[test]
fn every_move_is_the_one_that_linuxcnc_makes() {
    assert_all_as_expected("moves-rs274", &read("moves-rs274"), ROUNDING_MM);
}

#[test]
fn expressions_have_the_values_of_linuxcnc() {
    assert_all_as_expected("macros-rs274", &read("macros-rs274"), OF_WORDS_MM);
}
