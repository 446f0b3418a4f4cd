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

use crate::path::SlotPath;
use crate::vector::{Point, Vector};

/// Positions of the machine's rotary axes at which the spindle looks into a slot along the planned tool axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Position of the tilting axis A, the same for all slots.
    pub tilt_deg: f64,
    /// Position of the rotary table B for the first slot.
    pub index_deg: f64,
}

/// Reason why a machine cannot machine a slot as planned.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PlacementError {
    /// The machine has not the rotary axes A (tilting, about X) and B (table, about Y).
    #[error(
        "slots are indexed by a table B about Y that stands on a tilting A about X: this machine has no such table"
    )]
    Axes,
    /// The rotary axes do not cross each other.
    #[error(
        "the machine's A and B pass each other at {apart_mm:.4} mm; the program's zero is where they cross: correct `point` in the machine file"
    )]
    NoCrossing {
        /// Distance between the axes, mm.
        apart_mm: f64,
    },
    /// A linear axis cannot reach a position of the path.
    #[error(
        "{axis} would move to {to_mm:.1} mm for {place}, outside its range of {} to {} mm on the machine ({beyond_mm:.1} mm too far; the spindle's \
         gauge line {tool_mm:.1} mm above the tool's bottom): choose another axis in [roughing], a lower `clearance` or another machine",
        .range_mm[0], .range_mm[1]
    )]
    Travel {
        /// Name of the linear axis: X, Y or Z.
        axis: char,
        /// Position outside the range.
        to_mm: f64,
        /// Distance from the range.
        beyond_mm: f64,
        /// Travel of the axis: its lowest and highest position.
        range_mm: [f64; 2],
        /// Length of the tool with its holder, from its bottom to the spindle's gauge line.
        tool_mm: f64,
        /// Description of the part of the path to which the position belongs.
        place: String,
    },
    /// The tilting axis A does not reach the required angle.
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
/// Places of an arc that are compared with the travel of the axes.
const TRAVEL_SAMPLES: u32 = 33;

/// Positions of the rotary axes with which `machine` turns the part by `turn` (part to slot frame).
///
/// # Errors
/// The machine has other axes, they do not cross, or A does not reach the angle.
pub fn placement(machine: &Machine, turn: &Rotation3<f64>) -> Result<Placement, PlacementError> {
    let [index, tilt] = machine.rotary();
    let is_so = (index.letter, tilt.letter) == (Letter::B, Letter::A);
    let is_table = index.carries == Carries::Part && tilt.carries == Carries::Part;
    if !(is_so && is_table && index.direction == [0.0, 1.0, 0.0]) {
        return Err(PlacementError::Axes);
    }
    let crossing_mm = crossing(machine)?;
    let tool = turn.inverse() * Vector::z();
    let found = match machine.angles(on_table(&tool)) {
        Angles::None => return Err(PlacementError::Axes),
        Angles::One(angles) => vec![angles],
        Angles::Two(two) => two.to_vec(),
        Angles::Any { second_deg } => vec![[0.0, second_deg]],
    };
    let presented = found.into_iter().find(|angles| presents(machine, *angles, turn, crossing_mm));
    let [index_deg, tilt_deg] = presented.ok_or(PlacementError::Axes)?;
    let ranged = machine.in_range([index_deg, tilt_deg], [0.0, 0.0]);
    ranged
        .map(|[index_deg, tilt_deg]| Placement { tilt_deg, index_deg })
        .map_err(|_| PlacementError::Range { tilt_deg })
}

/// Checks that X, Y and Z reach all of a path, for a tool of this length from its bottom to the spindle's gauge line.
///
/// # Errors
/// The first place that they do not reach.
pub fn check_travel(machine: &Machine, path: &SlotPath, tool_mm: f64) -> Result<(), PlacementError> {
    let places = path.steps().into_iter().flat_map(|step| {
        let level = step.level;
        step.places(TRAVEL_SAMPLES).into_iter().map(move |place| (place, level))
    });
    check_places(machine, places, tool_mm, |level| format!("level {} of the slot", level + 1))
}

/// Checks that X, Y and Z reach places of a program, as [`check_travel`] does; `name` says which part of it a place belongs to.
///
/// # Errors
/// The first place that they do not reach.
pub fn check_places<N>(
    machine: &Machine,
    places: impl Iterator<Item = ([f64; 3], N)>,
    tool_mm: f64,
    name: impl Fn(N) -> String,
) -> Result<(), PlacementError> {
    let crossing_mm = crossing(machine)?;
    for (place, part) in places {
        let lift_mm = [0.0, 0.0, tool_mm];
        for (index, axis) in machine.linear().iter().enumerate() {
            let Some(range_mm @ [low_mm, high_mm]) = axis.range_mm else { continue };
            let to_mm = place[index] + lift_mm[index] + crossing_mm[index];
            let beyond_mm = (to_mm - high_mm).max(low_mm - to_mm);
            if beyond_mm > SAME_MM {
                let axis = ['X', 'Y', 'Z'][index];
                return Err(PlacementError::Travel { axis, to_mm, beyond_mm, range_mm, tool_mm, place: name(part) });
            }
        }
    }
    Ok(())
}

/// Point where both rotary axes cross, machine frame.
fn crossing(machine: &Machine) -> Result<[f64; 3], PlacementError> {
    let [one, other] =
        machine.rotary().each_ref().map(|axis| (Vector::from(axis.point_mm), Vector::from(axis.direction)));
    let across = one.1.cross(&other.1);
    let between = other.0 - one.0;
    let along = between.cross(&other.1).dot(&across) / across.norm_squared();
    let apart_mm = between.dot(&across.normalize()).abs();
    if apart_mm > SAME_MM { Err(PlacementError::NoCrossing { apart_mm }) } else { Ok((one.0 + one.1 * along).into()) }
}

/// Machine with two rotary tables and unlimited axes, for parts that name no machine; the rotary axes are those of
/// the published test.
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
fn presents(machine: &Machine, angles_deg: [f64; 2], turn: &Rotation3<f64>, crossing_mm: [f64; 3]) -> bool {
    let setup = Setup { part_zero_mm: crossing_mm, tool_length_mm: 0.0 };
    [Vector::x(), Vector::y(), Vector::z()].iter().all(|point| {
        let seen = turn * Point::from(*point);
        let at = machine.linear_for(on_table(point), angles_deg, &setup);
        (0..3).all(|axis| (at[axis] - crossing_mm[axis] - seen[axis]).abs() < SAME_MM)
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
