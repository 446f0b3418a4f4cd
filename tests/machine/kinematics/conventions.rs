//! Directions and signs of eight published structures, and every solution against a search.

use arcfeed_kinematics::inverse::Angles;
use arcfeed_kinematics::machine::{Carries, Letter, LinearAxis, Machine, RotaryAxis};
use arcfeed_tests::shared_or_skip;

use crate::kinematics::bench::{FILES, direction, machine};
use crate::kinematics::oracle::{solutions, turned};

const LINEAR: LinearAxis = LinearAxis { range_mm: None, resolution_mm: 0.001, speed_mm_per_min: None };

fn structure(axes: [(Letter, [f64; 3]); 2], head: bool) -> Machine {
    let axis = |(letter, direction): (Letter, [f64; 3]), carries| RotaryAxis {
        letter,
        carries,
        direction,
        point_mm: [0.0; 3],
        range_deg: None,
        resolution_deg: 0.001,
        speed_deg_per_min: None,
    };
    let second = axis(axes[1], if head { Carries::Tool } else { Carries::Part });
    Machine::new([axis(axes[0], Carries::Part), second], [LINEAR; 3], [0.0, 0.0, 1.0]).expect("a structure")
}

/// Names of the shared table: which axis stands first on the way from the part to the tool, whether the table names it first,
/// and the sense of each.
fn named(kind: &str) -> (Machine, bool) {
    use Letter::{A, B, C};
    match kind {
        "AC_tournier" => (structure([(C, [0.0, 0.0, 1.0]), (A, [1.0, 0.0, 0.0])], false), false),
        "AC_lcnc" => (structure([(C, [0.0, 0.0, -1.0]), (A, [-1.0, 0.0, 0.0])], false), false),
        "BC_table" => (structure([(C, [0.0, 0.0, -1.0]), (B, [0.0, -1.0, 0.0])], false), false),
        "BC_head" => (structure([(C, [0.0, 0.0, -1.0]), (B, [0.0, 1.0, 0.0])], true), false),
        "BA_hu80" => (structure([(B, [0.0, -1.0, 0.0]), (A, [-1.0, 0.0, 0.0])], false), false),
        "AB_lcnc" => (structure([(A, [1.0, 0.0, 0.0]), (B, [0.0, 1.0, 0.0])], false), true),
        _ => panic!("no structure {kind}"),
    }
}

#[test]
fn the_directions_of_other_peoples_structures_come_out() {
    let Some(path) = shared_or_skip("data/physics/kinematics_checks.csv", "kinematics: published structures") else {
        return;
    };
    let text = std::fs::read_to_string(path).expect("the table can be read");
    let (mut rows, mut worst) = (0, 0.0_f64);
    for line in text.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let values: Vec<f64> = cells[1..6].iter().map(|cell| cell.parse().expect("a number")).collect();
        let (machine, first_named_first) = named(cells[0]);
        let rotary = if first_named_first { [values[0], values[1]] } else { [values[1], values[0]] };
        let axis = machine.axis_at(rotary);
        worst = (0..3).fold(worst, |worst, at| worst.max((axis[at] - values[2 + at]).abs()));
        rows += 1;
    }
    println!("{rows} rows of published structures: directions agree to {worst:.1e}");
    assert!(rows == 30 && worst < 1e-12);
}

#[test]
fn a_search_finds_the_same_solutions_and_no_others() {
    let mut machines: Vec<Machine> = FILES.iter().map(|file| machine(file)).collect();
    // A nutating table at 45 degrees, whose directions end at 90 degrees from its first axis.
    machines.push(structure([(Letter::C, [0.0, 0.0, 1.0]), (Letter::B, [0.0, 1.0, 1.0])], false));
    let mut random = fastrand::Rng::with_seed(7);
    let mut counts = [0; 3];
    for machine in &machines {
        for _ in 0..15 {
            let wanted = direction(random.f64() * 179.0 + 0.5, random.f64() * 360.0);
            let ours = match machine.angles(wanted) {
                Angles::None => vec![],
                Angles::One(only) => vec![only],
                Angles::Two(both) => both.to_vec(),
                Angles::Any { .. } => panic!("{wanted:?} is no pole"),
            };
            let found = solutions(machine, wanted);
            assert_eq!(ours.len(), found.len(), "{wanted:?}: {ours:?}, searched {found:?}");
            for place in &ours {
                let is_it = |other: &&[f64; 2]| (0..2).all(|axis| turned(place[axis], other[axis]) < 1e-5);
                assert!(found.iter().any(|other| is_it(&other)), "{wanted:?}: {place:?} not in {found:?}");
            }
            counts[ours.len()] += 1;
        }
    }
    println!("directions with 0, 1, 2 solutions, the same as by search: {counts:?}");
    assert!(counts[0] > 0 && counts[2] > 0);
}
