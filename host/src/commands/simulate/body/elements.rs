//! Finite elements of the flexible part, and their modes.

use std::sync::Arc;

use arcfeed_dexel::solid::Solid;
use arcfeed_fe::body::Body;
use arcfeed_fe::clamped_block::{ClampedBlock, Face};
use arcfeed_fe::field::Field;
use arcfeed_fe::material::{ElasticMaterial, MATERIALS};
use arcfeed_fe::mesh::TetMesh;
use arcfeed_fe::sheet::Sheet;
use arcfeed_hil_sim::removal::flexible_workpiece::FlexibleWorkpiece;
use arcfeed_modal::dynamics::modal::Mode;

use super::super::surface;
use super::SetupFault;
use crate::job::flexible::{Elastic, Flexible, Shape};

/// Flexible workpiece for a tool whose edges reach up to `edges_mm` above its tip, and the modes of the workpiece,
/// scaled by their largest amplitude.
///
/// # Errors
/// The material is unknown, the body has no such mesh or modes, or lies outside the blank.
pub fn flexible(
    flexible: &Flexible,
    blank: &dyn Solid,
    edges_mm: f64,
) -> Result<(FlexibleWorkpiece, Vec<Mode>), SetupFault> {
    let input_failure = |error: &dyn std::fmt::Display| (Some(flexible.offset), error.to_string());
    let (axis, is_upper) = flexible.clamped;
    let held = Face { axis, is_upper };
    let mesh = mesh(flexible, held)?;
    let box_mm = mesh.bounds_mm();
    let of_blank_mm = blank.bounds_mm();
    if !(0..3).all(|axis| box_mm[0][axis] < of_blank_mm[1][axis] && of_blank_mm[0][axis] < box_mm[1][axis]) {
        return Err(input_failure(&"the flexible part has nothing in common with the workpiece"));
    }
    let body = Body::new(mesh, &material(&flexible.material)?);
    let modes = body.modes(&held.nodes(body.mesh()), flexible.modes).map_err(|error| input_failure(&error))?;
    let field = Field::new(body.mesh().clone(), &modes, body.mesh().thickness_mm());
    let modes = field.largest_modes(flexible.damping_ratio).map_err(|error| input_failure(&error))?;
    Ok((FlexibleWorkpiece::new(Arc::new(field), box_mm, edges_mm), modes))
}

fn mesh(flexible: &Flexible, held: Face) -> Result<TetMesh, SetupFault> {
    match &flexible.shape {
        Shape::Block { lowest_mm, highest_mm } => {
            let slab = ClampedBlock { lowest_mm: *lowest_mm, highest_mm: *highest_mm, held };
            slab.mesh(flexible.cells).map_err(|error| (Some(flexible.offset), error.to_string()))
        }
        Shape::Sheet { file, thickness, offset } => {
            let surface = surface::mesh(file).map_err(|error| (Some(*offset), error))?;
            let sheet = Sheet { surface: &surface, thickness: *thickness, held };
            sheet.mesh(flexible.cells).map_err(|error| (Some(*offset), format!("{}: {error}", file.path.display())))
        }
    }
}

fn material(elastic: &Elastic) -> Result<ElasticMaterial, SetupFault> {
    match elastic {
        Elastic::Constants { young_mpa, poisson_ratio, density_kg_per_m3 } => {
            let (young_mpa, poisson_ratio, density_kg_per_m3) = (*young_mpa, *poisson_ratio, *density_kg_per_m3);
            Ok(ElasticMaterial { young_mpa, poisson_ratio, density_kg_per_m3 })
        }
        Elastic::Material { name, offset } => {
            let found = MATERIALS.iter().find(|(known, _)| known == name);
            found.map(|(_, material)| *material).ok_or_else(|| {
                let names = MATERIALS.map(|(name, _)| format!("\"{name}\"")).join(", ");
                let message =
                    format!("how stiff `{name}` is is not known; write one of {names}, or young, poisson, density");
                (Some(*offset), message)
            })
        }
    }
}
