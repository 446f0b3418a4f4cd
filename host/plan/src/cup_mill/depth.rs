//! Depths of the tool: the lowest level of a path, and the levels above it (Petean, section 3.3.3).
//!
//! ```text
//! lowest = max over the hub's offset of  z - underside(|q - C|)              (1)
//! ADC_EFF = depth / n,  n = ceil(depth / ADC_MAX)                            (2)
//! ```
//!
//! The depth is that of the cutting plane, an insert's radius above the bottom: from the highest material that the ring
//! meets at the base position down to its lowest level. So there are n + 1 levels, and the first one cuts with the
//! rounding of the inserts alone.

use crate::cutter::CupMill;
use crate::vector::{Flat, Point};

use super::patch::Patch;

/// Lowest height of the tool's bottom, mm, at which a ring with its axis at `centre` stays above `hub` (with allowance). `None` if the
/// ring is nowhere above the hub.
pub fn lowest_mm(cutter: &CupMill, centre: Flat, hub: &Patch) -> Option<f64> {
    let deepest = |q: &Point| {
        let radius_mm = (q.xy() - centre).norm();
        cutter.underside_mm(radius_mm).map_or(f64::INFINITY, |underside_mm| underside_mm - q.z)
    };
    hub.least(deepest).map(|least| -least.value) // (1)
}

/// Highest point, mm, of the blank's surface `roof` under a ring with its axis at `centre`. `None` if the ring is nowhere above it.
pub fn top_mm(cutter: &CupMill, centre: Flat, roof: &Patch) -> Option<f64> {
    let under = |p: &Point| {
        let radius_mm = (p.xy() - centre).norm();
        let is_under = (cutter.inner_radius_mm..=cutter.outer_radius_mm).contains(&radius_mm);
        if is_under { -p.z } else { f64::INFINITY }
    };
    roof.least(under).map(|least| -least.value)
}

/// Heights of the tool's bottom for all levels, from the top down. The cutting plane goes from `top_mm` to the lowest level in equal
/// steps of at most `depth_max_mm`.
pub fn levels_mm(cutter: &CupMill, top_mm: f64, lowest_mm: f64, depth_max_mm: f64) -> Vec<f64> {
    let first_mm = top_mm - cutter.insert_radius_mm;
    let depth_mm = (first_mm - lowest_mm).max(0.0);
    // A depth that is a whole number of steps except for rounding is that number.
    let steps = libm::ceil(depth_mm / depth_max_mm - 1e-9).max(0.0);
    let step_mm = if steps > 0.0 { depth_mm / steps } else { 0.0 }; // (2)
    (0..=steps as u32).map(|index| lowest_mm + step_mm * (steps - f64::from(index))).collect()
}
