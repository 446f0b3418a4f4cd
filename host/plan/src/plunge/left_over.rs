//! Side-milling allowance that the plunges of a plan leave on the blades, as a map.
//!
//! ```text
//! left over = distance of an axis from the blade - R - a, the least of a plane's plunges at a height         (1)
//! ```
//!
//! It holds in the planes of the plan; between them stand cusps as well, no higher than the allowed ones.
//!
//! Source: ours.

use super::field::{Field, WallSide};
use super::passage_plan::{PassagePlan, Plunge, PlungeFamily, PlungePlane};

/// Number of heights in each row of the map.
pub const HEIGHTS: usize = 12;

/// Material that the plunges of one plane leave on the blades above the allowance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOverRow {
    /// Family of the plane.
    pub family: PlungeFamily,
    /// Place of the plane along the rotor's axis, or its distance from that axis for planes along it, mm.
    pub place_mm: f64,
    /// (1) on the left and on the right blade, from the tips of the plunges outwards, mm; `None` beyond the blades.
    pub sides_mm: [[Option<f64>; HEIGHTS]; 2],
}

/// Map of the material that a plan leaves, one row for each plane; `distance_mm` is the radius of the mill plus the allowance.
pub fn left_over(plan: &PassagePlan, field: &Field, distance_mm: f64) -> Vec<LeftOverRow> {
    let row = |(number, plane): (usize, &PlungePlane)| {
        let plunges: Vec<&Plunge> = plan.plunges.iter().filter(|plunge| plunge.plane == number).collect();
        let side_mm = |side| {
            core::array::from_fn(|height| {
                let share = (height as f64 + 0.5) / HEIGHTS as f64;
                let beside = plunges.iter().filter_map(|plunge| at_mm(plunge, field, side, share));
                beside.reduce(f64::min).map(|nearest_mm| nearest_mm - distance_mm)
            })
        };
        LeftOverRow {
            family: plane.family,
            place_mm: if plane.family == PlungeFamily::Radial { plane.z_mm } else { plane.radius_mm },
            sides_mm: [WallSide::Left, WallSide::Right].map(side_mm),
        }
    };
    plan.planes.iter().enumerate().map(row).collect()
}

/// Distance of a plunge's axis from a blade at a share of its depth; `None` beyond the blade's tip and edges.
fn at_mm(plunge: &Plunge, field: &Field, side: WallSide, share: f64) -> Option<f64> {
    let depth_mm = plunge.roof_mm[0] - (plunge.to_tool * plunge.tip).z;
    let place = plunge.tip + plunge.axis * (depth_mm * share);
    let ([from_mm, to_mm], tip_mm) = (field.ends_mm, field.tip_mm(place.z));
    let is_beside = libm::hypot(place.x, place.y) <= tip_mm && (from_mm..=to_mm).contains(&place.z);
    is_beside.then(|| field.distance(side, &place).0)
}
