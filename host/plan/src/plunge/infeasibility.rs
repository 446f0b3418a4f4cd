//! Reasons why a passage cannot be plunged.

use thiserror::Error;

use crate::vector::Point;

/// Reason why there is no plan for plunging a passage.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PlungeInfeasible {
    /// The mill does not pass between the blades in a plane across the rotor's axis.
    #[error("at z {z_mm:.2} mm the mill does not pass: {missing_mm:.3} mm are missing between ({}) and ({}); {}",
        place(&.touching[0]), place(&.touching[1]), remedy(*.largest_mm))]
    TooNarrow {
        /// Position of the plane along the rotor's axis, mm.
        z_mm: f64,
        /// Width by which the passage is too narrow, mm.
        missing_mm: f64,
        /// Points of both blades that the mill would touch.
        touching: [Point; 2],
        /// Largest diameter that passes in all planes; `None` if none does.
        largest_mm: Option<f64>,
    },
    /// The mill does not pass from a face of the blank, where it does not pass radially.
    #[error("at z {z_mm:.2} mm the mill does not pass radially, nor from the face of the blank in the plane at radius {radius_mm:.2} mm: \
        {missing_mm:.3} mm are missing between ({}) and ({}); {}", place(&.touching[0]), place(&.touching[1]), face_remedy(*.largest_mm))]
    FaceTooNarrow {
        /// Place along the rotor's axis up to which it is to reach.
        z_mm: f64,
        /// Distance of the plane from the rotor's axis.
        radius_mm: f64,
        /// Missing width.
        missing_mm: f64,
        /// Points of both blades.
        touching: [Point; 2],
        /// Largest diameter that passes from there; `None` if none does.
        largest_mm: Option<f64>,
    },
    /// Plunges from a face with a core.
    #[error(
        "plunging from the blank's faces is planned for mills that cut up to their axis: take one with `core_radius` 0 (it is {core_mm:.3} mm)"
    )]
    CoreLeft {
        /// Radius of the core.
        core_mm: f64,
    },
    /// A plane has no boundary axes.
    #[error("at z {z_mm:.2} mm no boundary axes were found: the blades do not bound the passage there")]
    NoBoundary {
        /// Plane.
        z_mm: f64,
    },
    /// The cusp does not fit the tool.
    #[error(
        "a cusp of {cusp_mm:.3} mm cannot be kept at z {z_mm:.2} mm: the blade's hollow is as narrow as the mill, or the cusp is as high as its radius"
    )]
    Cusp {
        /// Plane.
        z_mm: f64,
        /// Cusp.
        cusp_mm: f64,
    },
    /// The boundary axes jump between planes that are as near to each other as possible.
    #[error(
        "at z {z_mm:.2} mm the boundary axes jump by {moved_mm:.3} mm, more than a cusp of {cusp_mm:.3} mm allows: raise `cusp`, or take another mill"
    )]
    Jump {
        /// Plane.
        z_mm: f64,
        /// Distance by which an axis moves.
        moved_mm: f64,
        /// Cusp.
        cusp_mm: f64,
    },
    /// Neighbouring plunges would leave pillars or the core's material.
    #[error(
        "rows {row_mm:.3} mm apart leave pillars, or the core of radius {core_mm:.3} mm would stand on material: reduce `cusp`, or take a mill that cuts up to its axis"
    )]
    Rows {
        /// Distance of rows.
        row_mm: f64,
        /// Radius of the core.
        core_mm: f64,
    },
    /// The first plunge would stand on its core.
    #[error(
        "the first plunge, at z {z_mm:.2} mm, stands on material with its core of radius {core_mm:.3} mm: the blank ends at {face_mm:.2} mm; take a mill that cuts up to its axis"
    )]
    Core {
        /// Plane.
        z_mm: f64,
        /// Face of the blank.
        face_mm: f64,
        /// Radius of the core.
        core_mm: f64,
    },
    /// The hub is too steep for the tool.
    #[error(
        "at z {z_mm:.2} mm the tool's axis leans by {angle_deg:.1} degrees from the hub's normal; at most 60 are planned"
    )]
    Steep {
        /// Plane.
        z_mm: f64,
        /// Angle.
        angle_deg: f64,
    },
}

fn place(point: &Point) -> String {
    format!("{:.2}, {:.2}, {:.2}", point.x, point.y, point.z)
}

fn face_remedy(largest_mm: Option<f64>) -> String {
    match largest_mm {
        Some(diameter_mm) => format!("the largest mill that passes from there has a diameter of {diameter_mm:.2} mm"),
        None => "no mill passes from there".into(),
    }
}

fn remedy(largest_mm: Option<f64>) -> String {
    match largest_mm {
        Some(diameter_mm) => format!("the largest mill that passes everywhere has a diameter of {diameter_mm:.2} mm"),
        None => "no mill passes everywhere".into(),
    }
}
