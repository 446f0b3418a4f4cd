//! Lines, offsets and canned cycles against another interpreter: every end point of `tests/cases/moves-rs274`, as LinuxCNC
//! reads it.

use arcfeed_tests::root;
use moves::{Move, moving, off_mm, ours};

#[path = "rs274/moves.rs"]
mod moves;

const CASE: &str = "tests/cases/moves-rs274";
/// Half of the last decimal that rs274 prints, in inches where the program is.
const PRINTED_MM: f64 = 0.000_05 * 25.4;
/// And half of the last decimal of the table, with what a sum of three printed numbers adds.
const ROUNDING_MM: f64 = 3.0 * PRINTED_MM + 0.000_05;

fn case(file: &str) -> String {
    let path = root().join(CASE).join(file);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn expected() -> Vec<Move> {
    let row = |row: &str| {
        let numbers: Vec<f64> = row.split(' ').map(|number| number.parse().expect("a number")).collect();
        let [kind, x, y, z, u, v] = numbers[..] else { panic!("{row}") };
        Move { kind: kind as i8, end_mm: [x, y, z], center_mm: [u, v] }
    };
    case("expected.txt").lines().map(row).collect()
}

#[test]
fn every_move_is_the_one_that_linuxcnc_makes() {
    let program = case("program.nc").replace(' ', "");
    let (ours, expected) = (moving(&ours(program.as_bytes()).expect("it is read")), expected());
    let mut worst_mm = 0.0_f64;
    for (index, (found, wanted)) in ours.iter().zip(&expected).enumerate() {
        let off = off_mm(found, wanted);
        assert!(found.kind == wanted.kind && off <= ROUNDING_MM, "move {index}: {found:?}, not {wanted:?}");
        worst_mm = worst_mm.max(off);
    }
    assert_eq!(ours.len(), expected.len());
    println!("{} moves, worst difference {worst_mm:.6} mm of {ROUNDING_MM:.6} that printing explains", ours.len());
}
