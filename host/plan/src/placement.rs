//! Positions of the machine's rotary axes for a slot: the part's zero is where they cross, the rotor's axis along the
//! one that indexes.
//!
//! ```text
//! (x, y, z) of the part -> (y, z, x) of the machine                          (1)
//! ```
//!
//! with all axes at zero, for a rotor on a table that turns about Y. The machine's coordinates are then those of the
//! slot frame: that is checked, not assumed.

use arcfeed_kinematics::forward::Setup;
use arcfeed_kinematics::inverse::Angles;
use arcfeed_kinematics::machine::{Carries, Letter, LinearAxis, Machine, MachineError, RotaryAxis};
use nalgebra::Rotation3;
use thiserror::Error;

use crate::vector::{Point, Vector};

/// Positions of the rotary axes for a slot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// A, the same for all slots.
    pub tilt_deg: f64,
    /// B of the first slot.
    pub index_deg: f64,
}

/// Reason why a machine cannot present a slot.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PlacementError {
    /// The machine has other axes.
    #[error(
        "slots are indexed by a table B about Y that stands on a tilting A about X: this machine has no such table"
    )]
    Axes,
    /// The range of the axes is too small.
    #[error(
        "the tool leans by {tilt_deg:.3} degrees against the rotor's axis, beyond the machine's A: choose another axis in [roughing]"
    )]
    Range {
        /// Required angle of A.
        tilt_deg: f64,
    },
}

/// Tolerance for equal coordinates, mm.
const SAME_MM: f64 = 1e-6;

/// Positions of the rotary axes with which `machine` turns the part by `turn` (part to slot frame).
///
/// # Errors
/// The machine cannot.
pub fn placement(machine: &Machine, turn: &Rotation3<f64>) -> Result<Placement, PlacementError> {
    let [index, tilt] = machine.rotary();
    let is_so = (index.letter, tilt.letter) == (Letter::B, Letter::A);
    let is_table = index.carries == Carries::Part && tilt.carries == Carries::Part;
    if !(is_so && is_table && index.direction == [0.0, 1.0, 0.0]) {
        return Err(PlacementError::Axes);
    }
    let tool = turn.inverse() * Vector::z();
    let found = match machine.angles(on_table(&tool)) {
        Angles::None => return Err(PlacementError::Axes),
        Angles::One(angles) => vec![angles],
        Angles::Two(two) => two.to_vec(),
        Angles::Any { second_deg } => vec![[0.0, second_deg]],
    };
    let presented = found.into_iter().find(|angles| presents(machine, *angles, turn));
    let [index_deg, tilt_deg] = presented.ok_or(PlacementError::Axes)?;
    let ranged = machine.in_range([index_deg, tilt_deg], [0.0, 0.0]);
    ranged
        .map(|[index_deg, tilt_deg]| Placement { tilt_deg, index_deg })
        .map_err(|_| PlacementError::Range { tilt_deg })
}

/// Machine of the published test as far as it is needed here, with unlimited axes: for parts that name none.
///
/// # Errors
/// Never for these numbers.
pub fn any_table() -> Result<Machine, MachineError> {
    let axis = |letter, direction| RotaryAxis {
        letter,
        carries: Carries::Part,
        direction,
        point_mm: [0.0; 3],
        range_deg: None,
        resolution_deg: 0.001,
        speed_deg_per_min: None,
    };
    let linear = LinearAxis { range_mm: None, resolution_mm: 0.001, speed_mm_per_min: None };
    Machine::new([axis(Letter::B, [0.0, 1.0, 0.0]), axis(Letter::A, [1.0, 0.0, 0.0])], [linear; 3], [0.0, 0.0, 1.0])
}

/// (1)
fn on_table(part: &Vector) -> [f64; 3] {
    [part.y, part.z, part.x]
}

/// The machine's coordinates of the part's points are their coordinates in the slot frame.
fn presents(machine: &Machine, angles_deg: [f64; 2], turn: &Rotation3<f64>) -> bool {
    let setup = Setup { part_zero_mm: [0.0; 3], tool_length_mm: 0.0 };
    [Vector::x(), Vector::y(), Vector::z()].iter().all(|point| {
        let seen = turn * Point::from(*point);
        let at = machine.linear_for(on_table(point), angles_deg, &setup);
        (0..3).all(|axis| (at[axis] - seen[axis]).abs() < SAME_MM)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::slot_frame;

    #[test]
    fn a_slot_is_presented_by_the_angles_of_its_axis() {
        let machine = any_table().unwrap();
        for (lean, tilt) in [(0.0, 0.0), (0.3, 0.1), (-2.0, -0.4), (3.0, 0.05)] {
            let (sin, cos) = libm::sincos(lean);
            let tool = Vector::new(cos, sin, libm::tan(tilt)).normalize();
            let found = placement(&machine, &slot_frame(&tool).unwrap()).unwrap();
            // B turns the table until the tool's lean about Y is gone, A tilts it by the rest.
            assert!((libm::fabs(found.tilt_deg) - libm::fabs(tilt.to_degrees())).abs() < 1e-9, "{found:?}");
            let turned = libm::remainder(libm::fabs(found.index_deg) - libm::fabs(lean.to_degrees()), 360.0);
            assert!(libm::fabs(turned) < 1e-9, "{found:?}");
        }
    }
}
