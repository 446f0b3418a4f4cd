//! Slot frame: coordinates whose z is the tool's axis, while the machine presents a slot to the tool.
//!
//! ```text
//! z = tool axis,  y = (k - (k.z) z) / |..|,  x = y x z                       (1)
//! ```
//!
//! with k the rotor's axis.

use nalgebra::{Matrix3, Rotation3};

use crate::vector::Vector;

/// Rotation from the part frame (the rotor's own coordinates) into the slot frame of this tool axis.
///
/// `None` if the tool's axis lies along the rotor's axis, so that y of the slot frame is not determined.
pub fn slot_frame(tool_axis: &Vector) -> Option<Rotation3<f64>> {
    let z = tool_axis.try_normalize(0.0)?;
    let rotor = Vector::z();
    let y = (rotor - z * rotor.dot(&z)).try_normalize(1e-6)?; // (1)
    let x = y.cross(&z);
    Some(Rotation3::from_matrix_unchecked(Matrix3::from_rows(&[x.transpose(), y.transpose(), z.transpose()])))
}
