//! The kinematic error between points against its closed form, and paths made straight looked at with matrices.

use arcfeed_kinematics::deviation::{Mode, PathPoint};
use arcfeed_kinematics::forward::{Axes, Setup, ToolPose};
use arcfeed_kinematics::linearise::Tolerance;
use arcfeed_kinematics::machine::Machine;
use arcfeed_kinematics::vector::{Vector, cross, difference, length, sum};

use crate::kinematics::bench::{FILES, SETUP, direction, machine};
use crate::kinematics::oracle;

fn stops(machine: &Machine, poses: &[ToolPose], setup: &Setup) -> Vec<PathPoint> {
    let course = machine.select_branches(poses, None).expect("within reach");
    let stop = |(pose, at): (&ToolPose, &[f64; 2])| PathPoint {
        pose: *pose,
        axes: Axes { linear_mm: machine.linear_for(pose.tip_mm, *at, setup), rotary_deg: *at },
    };
    poses.iter().zip(&course).map(stop).collect()
}

#[test]
fn a_turn_about_one_axis_bulges_by_the_height_of_its_arc() {
    // A tip that stays where it is on the part, 70 mm from C, while C turns: in the machine it runs the chord of a circle.
    let mikron = machine("mikron-ucp710");
    let setup = Setup::default();
    for by_deg in [0.5_f64, 5.0, 30.0, 90.0] {
        let poses = [0.0, by_deg].map(|azimuth| ToolPose { tip_mm: [70.0, 0.0, 12.0], axis: direction(35.0, azimuth) });
        let stops = stops(&mikron, &poses, &setup);
        let closed = 70.0 * (1.0 - libm::cos((by_deg / 2.0).to_radians()));
        let found = mikron.deviation(Mode::Machine, &setup, &stops[0], &stops[1]);
        println!("C turns {by_deg} deg 70 mm off: tip {:.9} mm off, closed form {closed:.9}", found.tip_mm);
        assert!((found.tip_mm / closed - 1.0).abs() < 1e-9);
        // On its small circle the axis stands off the great one most in the middle.
        let [tilt, half] = [35.0_f64, by_deg / 2.0].map(f64::to_radians);
        let off = (tilt - libm::atan(libm::tan(tilt) * libm::cos(half))).to_degrees();
        assert!((found.axis_deg / off - 1.0).abs() < 1e-9, "{} {off}", found.axis_deg);
        let rotary = mikron.deviation(Mode::PartRotary, &setup, &stops[0], &stops[1]);
        assert_eq!((rotary.tip_mm, rotary.axis_deg), (0.0, found.axis_deg));
        let tcp = mikron.deviation(Mode::Tcp, &setup, &stops[0], &stops[1]);
        assert_eq!((tcp.tip_mm, tcp.axis_deg), (0.0, 0.0));
    }
}

/// The distance of a point from the line through two others.
fn off_line(point: Vector, from: Vector, to: Vector) -> f64 {
    let way = difference(to, from);
    length(cross(difference(point, from), way)) / length(way)
}

/// The largest distance of the tip from the line, every two-hundredth of each move, by matrices.
fn worst_tip(machine: &Machine, stops: &[PathPoint]) -> f64 {
    let mut worst = 0.0_f64;
    for pair in stops.windows(2) {
        for part in 0..=200 {
            let mix = |from: f64, to: f64| from + (to - from) * f64::from(part) / 200.0;
            let [from, to] = [&pair[0], &pair[1]];
            let axes = Axes {
                linear_mm: [0, 1, 2].map(|at| mix(from.axes.linear_mm[at], to.axes.linear_mm[at])),
                rotary_deg: [0, 1].map(|at| mix(from.axes.rotary_deg[at], to.axes.rotary_deg[at])),
            };
            let tip = oracle::forward(machine, &axes, &SETUP).tip_mm;
            worst = worst.max(off_line(tip, from.pose.tip_mm, to.pose.tip_mm));
        }
    }
    worst
}

#[test]
fn added_points_bring_every_move_within_the_tolerance() {
    for file in FILES {
        let machine = machine(file);
        let up = machine.rotary()[0].direction.map(f64::abs);
        // Leaning 35 degrees from the first axis, which for the horizontal machine is Y.
        let lean = |azimuth: f64| {
            let [x, y, z] = direction(35.0, azimuth);
            if up[1] > 0.5 { [x, z, y] } else { [x, y, z] }
        };
        let poses: Vec<ToolPose> = (0..12)
            .map(|at| f64::from(at) * 8.0)
            .map(|way| ToolPose { tip_mm: sum([way, 20.0, 10.0], [0.0, way / 3.0, 0.0]), axis: lean(way) })
            .collect();
        let stops = stops(&machine, &poses, &SETUP);
        let before = worst_tip(&machine, &stops);
        for tip_mm in [0.1, 0.01, 0.001] {
            let tolerance = Tolerance { tip_mm, axis_deg: 0.05 };
            let path = machine.linearise(Mode::Machine, &SETUP, &stops, &tolerance).expect("no pole is near");
            let after = worst_tip(&machine, &path);
            println!(
                "{file}: {before:.4} mm off with {} points, {after:.6} with {} for {tip_mm}",
                stops.len(),
                path.len()
            );
            assert!(after <= tip_mm * (1.0 + 1e-9) && before > tip_mm);
            assert!(stops.iter().all(|stop| path.contains(stop)), "the path's own points stay");
            for stop in &path {
                let pose = oracle::forward(&machine, &stop.axes, &SETUP);
                assert!(length(difference(pose.tip_mm, stop.pose.tip_mm)) < 1e-10);
                assert!(length(difference(pose.axis, stop.pose.axis)) < 1e-13);
            }
        }
    }
}

#[test]
fn a_swing_cannot_be_made_straight() {
    let mikron = machine("mikron-ucp710");
    let tip_mm = [10.0, 20.0, 30.0];
    let at = |rotary_deg: [f64; 2]| PathPoint {
        pose: ToolPose { tip_mm, axis: direction(20.0, 50.0) },
        axes: Axes { linear_mm: mikron.linear_for(tip_mm, rotary_deg, &SETUP), rotary_deg },
    };
    let jump = [at([140.0, 20.0]), at([320.0, -20.0])];
    let refused = mikron.linearise(Mode::PartRotary, &SETUP, &jump, &Tolerance { tip_mm: 0.01, axis_deg: 0.5 });
    let why = refused.expect_err("a change of branch");
    println!("{why}");
    assert!(why.point == 1 && why.left.axis_deg > 1.0);
}
