//! A second forward kinematics, by homogeneous matrices link after link, and all solutions by search.

use arcfeed_kinematics::forward::{Axes, Setup, ToolPose};
use arcfeed_kinematics::machine::{Carries, Machine, RotaryAxis};
use nalgebra::{Matrix4, Point3, Unit, Vector3, Vector4};

/// The part's and the tool's frame in that of the machine, and the one seen from the other.
pub fn forward(machine: &Machine, axes: &Axes, setup: &Setup) -> ToolPose {
    let [first, second] = machine.rotary();
    let slide = Matrix4::new_translation(&Vector3::from(axes.linear_mm));
    let (mut part, mut tool): (Matrix4<f64>, Matrix4<f64>) = (Matrix4::identity(), slide);
    // The part hangs on the outer axis of the table first, the tool on the outer axis of the head first.
    for (axis, position) in [(second, axes.rotary_deg[1]), (first, axes.rotary_deg[0])] {
        if axis.carries == Carries::Part {
            part *= link(axis, -position);
        }
    }
    for (axis, position) in [(first, axes.rotary_deg[0]), (second, axes.rotary_deg[1])] {
        if axis.carries == Carries::Tool {
            tool *= link(axis, position);
        }
    }
    part *= Matrix4::new_translation(&Vector3::from(setup.part_zero_mm));
    let seen: Matrix4<f64> = part.try_inverse().expect("a rigid motion") * tool;
    let up = Vector3::from(machine.tool());
    let tip = seen.transform_point(&Point3::from(up * -setup.tool_length_mm));
    let axis = seen * Vector4::new(up.x, up.y, up.z, 0.0);
    ToolPose { tip_mm: [tip.x, tip.y, tip.z], axis: [axis.x, axis.y, axis.z] }
}

fn link(axis: &RotaryAxis, by_deg: f64) -> Matrix4<f64> {
    let point = Vector3::from(axis.point_mm);
    let about = Unit::new_normalize(Vector3::from(axis.direction));
    Matrix4::new_translation(&point)
        * Matrix4::from_axis_angle(&about, by_deg.to_radians())
        * Matrix4::new_translation(&-point)
}

/// Distance of the tool axis from a direction, as a chord, at given positions of the rotary axes.
fn off(machine: &Machine, rotary_deg: [f64; 2], wanted: [f64; 3]) -> f64 {
    let axes = Axes { linear_mm: [0.0; 3], rotary_deg };
    (Vector3::from(forward(machine, &axes, &Setup::default()).axis) - Vector3::from(wanted)).norm()
}

/// All solutions for a direction without whole turns: every place of a grid from which a shrinking pattern search arrives.
pub fn solutions(machine: &Machine, wanted: [f64; 3]) -> Vec<[f64; 2]> {
    let mut found: Vec<[f64; 2]> = Vec::new();
    for first in 0..12 {
        for second in 0..12 {
            let start = [f64::from(first) * 30.0 - 180.0, f64::from(second) * 30.0 - 180.0];
            let (at, left) = descend(machine, start, wanted);
            let is_new = |known: &[f64; 2]| (0..2).any(|axis| turned(known[axis], at[axis]) > 1e-3);
            if left < 1e-9 && found.iter().all(is_new) {
                found.push(at);
            }
        }
    }
    found
}

/// The angle between two positions, whole turns apart.
pub fn turned(one_deg: f64, other_deg: f64) -> f64 {
    let apart = (one_deg - other_deg).rem_euclid(360.0);
    apart.min(360.0 - apart)
}

fn descend(machine: &Machine, start: [f64; 2], wanted: [f64; 3]) -> ([f64; 2], f64) {
    let (mut at, mut step) = (start, 16.0);
    let mut left = off(machine, at, wanted);
    while step > 1e-9 {
        let tries = (-1..=1).flat_map(|x| (-1..=1).map(move |y| (x, y)));
        let tries = tries.map(|(x, y)| [at[0] + f64::from(x) * step, at[1] + f64::from(y) * step]);
        let best = tries.map(|place| (place, off(machine, place, wanted))).min_by(|a, b| a.1.total_cmp(&b.1));
        match best {
            Some((place, better)) if better < left => (at, left) = (place, better),
            _ => step /= 2.0,
        }
    }
    (at, left)
}
