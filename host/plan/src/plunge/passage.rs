//! Passage between two blades, with the mill that is to plunge it.

use crate::geometry::blisk::Blisk;

use super::boundary::{Boundary, Circles, LargestTool, boundary, largest_tool};
use super::field::Field;
use super::line::Fit;
use super::mill::PlungeMill;

/// Planes in which the largest tool is sought.
const LOOKS: u32 = 9;
/// Halvings of their distance about the plane with the smallest tool.
const HALVINGS: u32 = 2;
/// Share of the blade's length that is left out of them at each end: there the passage is wider.
const MARGIN_RATIO: f64 = 0.02;

/// Requirements on the plunges of a passage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlungeRequirements {
    /// Allowance on blades and hub, mm.
    pub allowance_mm: f64,
    /// Largest height of the cusps that neighbouring plunges leave on the blades, mm.
    pub cusp_mm: f64,
    /// Quantity by which the boundary axes are chosen.
    pub fit: Fit,
    /// Distance of the mill above everything that turns with the rotor, when it moves from plunge to plunge, mm.
    pub clearance_mm: f64,
    /// Distance by which the mill steps off the wall before it is withdrawn, mm.
    pub relief_mm: f64,
}

/// Passage between two blades of a rotor, with the mill that plunges it and the requirements.
pub struct Passage<'p> {
    /// Rotor.
    pub blisk: &'p Blisk,
    /// Distances from the rotor's blades.
    pub field: &'p Field,
    /// Mill.
    pub mill: &'p PlungeMill,
    /// Requirements.
    pub needs: &'p PlungeRequirements,
    /// Radius about the rotor's axis within which everything lies that turns with the part, mm.
    pub turning_mm: f64,
    /// Radius about the point where the rotary axes cross within which everything lies that turns, mm.
    pub turning_ball_mm: f64,
}

impl Passage<'_> {
    /// Radii of blank, blades and floor in the plane at `z_mm`.
    pub fn circles(&self, z_mm: f64) -> Circles {
        Circles {
            roof_mm: self.blisk.blank.radius_mm,
            tip_mm: self.field.tip_mm(z_mm),
            floor_mm: self.blisk.hub.radius_mm(z_mm) + self.needs.allowance_mm,
        }
    }

    /// Boundary axes in the plane at `z_mm`; `None` if there are none.
    pub fn boundary(&self, z_mm: f64) -> Option<Boundary> {
        let distance_mm = self.mill.radius_mm + self.needs.allowance_mm;
        boundary(self.field, z_mm, distance_mm, &self.circles(z_mm), self.needs.fit)
    }

    /// Largest tools in planes along the blade.
    pub fn largest(&self) -> Vec<LargestTool> {
        let [from_mm, to_mm] = self.field.ends_mm;
        let margin_mm = (to_mm - from_mm) * MARGIN_RATIO;
        let (first_mm, last_mm) = (from_mm + margin_mm, to_mm - margin_mm);
        let look =
            |z_mm: f64| largest_tool(self.field, z_mm, self.needs.allowance_mm, &self.circles(z_mm), self.needs.fit);
        let place = |k: u32| first_mm + (last_mm - first_mm) * f64::from(k) / f64::from(LOOKS - 1);
        let mut found: Vec<LargestTool> = (0..LOOKS).filter_map(|k| look(place(k))).collect();
        let mut beside_mm = (last_mm - first_mm) / f64::from(LOOKS - 1);
        for _ in 0..HALVINGS {
            beside_mm /= 2.0;
            let least = found.iter().min_by(|a, b| a.radius_mm.total_cmp(&b.radius_mm)).map(|least| least.z_mm);
            let beside = least.into_iter().flat_map(|z_mm| [z_mm - beside_mm, z_mm + beside_mm]);
            let inside = beside.filter(|z_mm| (first_mm..=last_mm).contains(z_mm));
            found.extend(inside.filter_map(look).collect::<Vec<_>>());
        }
        found.sort_by(|a, b| a.z_mm.total_cmp(&b.z_mm));
        found
    }
}
