//! What of the job's workpiece gives way: its modes from finite elements.

use std::sync::Arc;

use arcfeed_hil_sim::dynamics::modal::Mode;
use arcfeed_hil_sim::fe::body::Body;
use arcfeed_hil_sim::fe::field::Field;
use arcfeed_hil_sim::fe::material::{MATERIALS, Material};
use arcfeed_hil_sim::fe::slab::{Face, Slab};
use arcfeed_hil_sim::removal::giving::Giving;
use arcfeed_hil_sim::stock::solid::Solid;

use crate::job::flexible::{Elastic, Flexible};

/// What is wrong, and the byte offset in the job file if it is not the table's.
pub type Trouble = (Option<usize>, String);

/// Whether it reaches into a blank's box.
pub fn is_part_of(flexible: &Flexible, blank: &dyn Solid) -> bool {
    let [lowest_mm, highest_mm] = blank.bounds_mm();
    (0..3).all(|axis| flexible.lowest_mm[axis] < highest_mm[axis] && lowest_mm[axis] < flexible.highest_mm[axis])
}

/// The body for a tool with edges so far up from its tip, and its modes.
///
/// # Errors
/// The material is not known, or the body has no such mesh or modes.
pub fn giving(flexible: &Flexible, edges_mm: f64) -> Result<(Giving, Vec<Mode>), Trouble> {
    let told = |error: &dyn std::fmt::Display| (Some(flexible.offset), error.to_string());
    let Flexible { lowest_mm, highest_mm, clamped: (axis, is_upper), cells, .. } = *flexible;
    let slab = Slab { lowest_mm, highest_mm, held: Face { axis, is_upper } };
    let mesh = slab.mesh(cells).map_err(|error| told(&error))?;
    let body = Body::new(mesh, &material(&flexible.material)?);
    let modes = body.modes(&slab.clamped(body.mesh()), flexible.modes).map_err(|error| told(&error))?;
    let field = Field::new(body.mesh().clone(), &modes, body.mesh().thickness_mm());
    let mut giving = Giving::new(Arc::new(field), edges_mm);
    let modes = giving.modes(flexible.damping_ratio).map_err(|error| told(&error))?;
    Ok((giving, modes))
}

fn material(told: &Elastic) -> Result<Material, Trouble> {
    match told {
        Elastic::Told { young_mpa, poisson_ratio, density_kg_per_m3 } => {
            let (young_mpa, poisson_ratio, density_kg_per_m3) = (*young_mpa, *poisson_ratio, *density_kg_per_m3);
            Ok(Material { young_mpa, poisson_ratio, density_kg_per_m3 })
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
