//! There and back again, over every machine, at random places, in poles and at the ends of the ranges.

use arcfeed_kinematics::forward::{Axes, ToolPose};
use arcfeed_kinematics::inverse::Solutions;
use arcfeed_kinematics::machine::{Machine, RotaryAxis};
use arcfeed_kinematics::vector::{difference, length};

use crate::kinematics::bench::{FILES, SETUP, machine};
use crate::kinematics::oracle;

/// Poses for each machine.
const POSES: u64 = 1_000_000;

/// Positions somewhere: one in eight at an end of a range, one in eight in a pole or next to it.
fn place(machine: &Machine, random: &mut fastrand::Rng) -> Axes {
    let mut position = |axis: &RotaryAxis| {
        let [least, greatest] = axis.range_deg.unwrap_or([-720.0, 720.0]);
        match random.u8(..8) {
            0 => least,
            1 => greatest,
            _ => least + random.f64() * (greatest - least),
        }
    };
    let mut rotary_deg = machine.rotary().each_ref().map(&mut position);
    if random.u8(..8) == 0 {
        // The poles of the three machines: A or B at 0, the tilt of the pallet at -90.
        let pole = if machine.rotary()[0].direction[1].abs() > 0.5 { -90.0 } else { 0.0 };
        let beside = [0.0, 1e-12, 1e-9, 1e-6, 1e-3, -1e-9, -1e-4];
        rotary_deg[1] = pole + beside[random.usize(..beside.len())];
    }
    Axes { linear_mm: [0; 3].map(|_| random.f64() * 800.0 - 400.0), rotary_deg }
}

/// Distance of two poses: tip in mm, direction as a chord.
fn apart(one: &ToolPose, other: &ToolPose) -> [f64; 2] {
    [length(difference(one.tip_mm, other.tip_mm)), length(difference(one.axis, other.axis))]
}

#[test]
fn forward_after_inverse_is_the_identity() {
    for file in FILES {
        let machine = machine(file);
        let mut random = fastrand::Rng::with_seed(42);
        let (mut worst, mut back, mut counts) = ([0.0_f64; 2], 0.0_f64, [0_u64; 4]);
        for _ in 0..POSES {
            let asked = place(&machine, &mut random);
            let pose = machine.forward(&asked, &SETUP);
            let mut take = |axes: &Axes| {
                let [tip, axis] = apart(&machine.forward(axes, &SETUP), &pose);
                worst = [worst[0].max(tip), worst[1].max(axis)];
                assert!(machine.rotary().iter().zip(axes.rotary_deg).all(|(axis, at)| axis.allows(at)), "{axes:?}");
            };
            let nearest = match machine.inverse(&pose, &SETUP, asked.rotary_deg) {
                Solutions::None(why) => panic!("{asked:?}: {why}"),
                Solutions::One(one) => {
                    take(&one);
                    counts[1] += 1;
                    vec![one]
                }
                Solutions::Two(both) => {
                    both.iter().for_each(&mut take);
                    counts[2] += 1;
                    both.to_vec()
                }
                Solutions::Any(any) => {
                    take(&any);
                    counts[3] += 1;
                    vec![any]
                }
            };
            // The place it came from is among the solutions; beside a pole both angles are as sharp as the direction is.
            let off =
                |axes: &Axes| (0..2).map(|at| (axes.rotary_deg[at] - asked.rotary_deg[at]).abs()).fold(0.0, f64::max);
            if machine.from_pole_deg(pose.axis) > 1e-2 {
                back = back.max(nearest.iter().map(off).fold(f64::INFINITY, f64::min));
            }
        }
        println!(
            "{file}: {POSES} poses ({} with one solution, {} with two, {} with infinitely many): tip {:.1e} mm, direction {:.1e}, \
             angles 0.01 deg or more from the pole {back:.1e} deg",
            counts[1], counts[2], counts[3], worst[0], worst[1]
        );
        assert!(worst[0] < 1e-11 && worst[1] < 1e-14 && back < 1e-9, "{worst:?} {back}");
        assert!(counts[2] > 0 && counts[3] > 0);
    }
}

#[test]
fn homogeneous_matrices_say_the_same() {
    for file in FILES {
        let machine = machine(file);
        let mut random = fastrand::Rng::with_seed(43);
        let mut worst = [0.0_f64; 2];
        for _ in 0..POSES / 10 {
            let axes = place(&machine, &mut random);
            let [tip, axis] = apart(&machine.forward(&axes, &SETUP), &oracle::forward(&machine, &axes, &SETUP));
            worst = [worst[0].max(tip), worst[1].max(axis)];
        }
        println!("{file}: homogeneous matrices differ by {:.1e} mm, direction {:.1e}", worst[0], worst[1]);
        assert!(worst[0] < 1e-11 && worst[1] < 1e-14);
    }
}

#[test]
fn how_many_solutions_there_are_follows_from_the_range_of_the_tilt() {
    let mikron = machine("mikron-ucp710");
    let count = |tilt: f64| {
        let pose = ToolPose { tip_mm: [0.0; 3], axis: crate::kinematics::bench::direction(tilt, 77.0) };
        match mikron.inverse(&pose, &SETUP, [0.0; 2]) {
            Solutions::None(_) => 0,
            Solutions::One(_) => 1,
            Solutions::Two(_) => 2,
            Solutions::Any(_) => 3,
        }
    };
    // A -120 to 30: Tournier, table 2, with cos where it prints ArcCos.
    assert_eq!([0.0, 1.0, 29.999, 30.001, 119.999, 120.001, 179.0].map(count), [3, 2, 2, 1, 1, 0, 0]);
}
