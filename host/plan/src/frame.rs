//! Slot frame: orientation of the part under the tool.
//!
//! ```text
//! z = tool axis,  y = (k - (k.z) z) / |..|,  x = y x z                       (1)
//! ```
//!
//! with k the rotor's axis.

use nalgebra::{Matrix3, Rotation3};

use crate::vector::Vector;

/// Rotation from the part frame into the slot frame.
///
/// `None` if the tool lies along the rotor's axis: the cutter would stand on the rotor's face.
pub fn slot_frame(tool_axis: &Vector) -> Option<Rotation3<f64>> {
    let z = tool_axis.try_normalize(0.0)?;
    let rotor = Vector::z();
    let y = (rotor - z * rotor.dot(&z)).try_normalize(1e-6)?; // (1)
    let x = y.cross(&z);
    Some(Rotation3::from_matrix_unchecked(Matrix3::from_rows(&[x.transpose(), y.transpose(), z.transpose()])))
}
