//! Material that earlier passes have removed from a slot, each with its own tool axis.

use nalgebra::Matrix3;

use crate::cutter::CupMill;
use crate::path::Pass;
use crate::vector::Point;

use super::floor::Floor;

/// Floor that an earlier pass has left in the slot.
pub struct EarlierFloor {
    floor: Floor,
    /// From the part frame to the slot frame of that pass.
    to_slot: Matrix3<f64>,
}

/// All earlier passes, seen from another slot frame.
pub struct Earlier<'e> {
    floors: &'e [EarlierFloor],
    /// From that slot frame to the part frame.
    to_part: Matrix3<f64>,
}

impl EarlierFloor {
    /// Floor that a ring has left on this pass.
    pub fn new(tool: &CupMill, pass: &Pass) -> Self {
        EarlierFloor { floor: Floor::new(tool, &pass.path.steps()), to_slot: *pass.to_slot.matrix() }
    }
}

impl<'e> Earlier<'e> {
    /// Earlier passes, seen from a slot frame; `to_part` leads from there to the part frame. It may mirror, as the
    /// [normal form](crate::cup_mill::normal_form) does.
    pub fn new(floors: &'e [EarlierFloor], to_part: Matrix3<f64>) -> Self {
        Earlier { floors, to_part }
    }

    /// No earlier pass.
    pub fn none() -> Self {
        Earlier { floors: &[], to_part: Matrix3::identity() }
    }

    /// Whether there is no earlier pass.
    pub fn is_empty(&self) -> bool {
        self.floors.is_empty()
    }

    /// Whether an earlier pass has removed a point of the slot frame.
    pub fn has_removed(&self, point: &Point) -> bool {
        let in_part = self.to_part * point;
        self.floors.iter().any(|earlier| earlier.floor.first_level(&(earlier.to_slot * in_part)).is_some())
    }
}
