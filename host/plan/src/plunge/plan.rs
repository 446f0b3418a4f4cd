//! Plan of one passage: planes, columns, tips, order.
//!
//! ```text
//! floor: the tip moves along t onto the hub with its allowance, and is lifted for its flat end (mill.rs), further where the hub is hollow
//! order: planes from one face of the blank to the other; in a plane from the side that was cut last         (1)
//! ```
//!
//! The first plane stands where the mill's core is beside the blank, and at most on its face.
//!
//! Source: An Luling et al. for planes and axes; the rest is ours.

use nalgebra::Rotation3;

use crate::frame::slot_frame;
use crate::vector::{Point, Vector};

use super::assembly::Assembly;
use super::boundary::{Boundary, LargestTool};
use super::column::Column;
use super::faces::{EntryFace, FaceFamily, radial_stretch};
use super::field::WallSide;
use super::infeasibility::PlungeInfeasible;
use super::mill::PlungeMill;
use super::passage::{Passage, PlungeRequirements};
use super::passage_plan::{PassagePlan, Plunge, PlungeFamily};
use super::section::{Midway, PlungeSection, SectionFamily, SectionPlane};

/// Largest angle between the tool's axis and the hub's normal, degrees.
const ANGLE_MAX_DEG: f64 = 60.0;
/// Precision of the lift of a mill's end, mm.
const LIFT_PRECISION_MM: f64 = 1e-3;
/// Points of the end's rim at which it is measured.
const END_POINTS: u32 = 64;

/// Planes across the rotor's axis, by their place along it.
struct Radial<'p> {
    passage: &'p Passage<'p>,
    largest: &'p [LargestTool],
}

impl SectionFamily for Radial<'_> {
    fn at(&self, at_mm: f64) -> Result<PlungeSection, PlungeInfeasible> {
        let boundary = self.passage.boundary(at_mm).ok_or(PlungeInfeasible::NoBoundary { z_mm: at_mm })?;
        Ok(PlungeSection { plane: SectionPlane::radial(at_mm, boundary.middle_rad), boundary })
    }

    fn too_narrow(&self, PlungeSection { plane, boundary }: &PlungeSection) -> PlungeInfeasible {
        self.passage.too_narrow(plane.origin.z, boundary, self.largest)
    }
}

impl Passage<'_> {
    /// Plans the plunges that clear the passage.
    ///
    /// # Errors
    /// The mill is too wide for the passage, or its centre, which has no edges, would run into material.
    pub fn plan(&self) -> Result<PassagePlan, PlungeInfeasible> {
        let largest = self.largest();
        let range_mm = self.range_mm()?;
        let radial = Radial { passage: self, largest: &largest };
        let mut assembly = Assembly::new(self);
        match assembly.add(&radial, range_mm, PlungeFamily::Radial) {
            Ok(()) => Ok(assembly.plan(largest)),
            Err(why @ (PlungeInfeasible::TooNarrow { .. } | PlungeInfeasible::NoBoundary { .. })) => {
                let found = radial_stretch(self, range_mm).map_err(|_| why)?;
                self.with_faces(&radial, range_mm, found)
            }
            Err(why) => Err(why),
        }
    }

    /// Plan from the faces beyond the stretch in which the mill passes radially, and in that stretch.
    fn with_faces(
        &self,
        radial: &Radial<'_>,
        [from_mm, to_mm]: [f64; 2],
        stretch_mm: Option<[f64; 2]>,
    ) -> Result<PassagePlan, PlungeInfeasible> {
        self.whole_end()?;
        let midway = Midway::new(self.blisk);
        let middle_mm = f64::midpoint(from_mm, to_mm);
        let [low_mm, high_mm] = stretch_mm.unwrap_or([middle_mm; 2]);
        // The ends of the mills from a face lie within what the others cut.
        let overlap_mm = self.mill.radius_mm;
        let from = |face, inner_mm| FaceFamily { passage: self, midway: &midway, face, inner_mm };
        let lower = from(EntryFace::Lower, (low_mm + overlap_mm).min(to_mm));
        let upper = from(EntryFace::Upper, (high_mm - overlap_mm).max(from_mm));
        let mut assembly = Assembly::new(self);
        if low_mm > from_mm {
            assembly.add(&lower, lower.range_mm(), PlungeFamily::LowerFace)?;
        }
        if let Some(stretch_mm) = stretch_mm {
            assembly.add(radial, stretch_mm, PlungeFamily::Radial)?;
        }
        if high_mm < to_mm {
            assembly.add(&upper, upper.range_mm(), PlungeFamily::UpperFace)?;
        }
        Ok(assembly.plan(radial.largest.to_vec()))
    }

    /// The mill cuts with its whole end.
    fn whole_end(&self) -> Result<(), PlungeInfeasible> {
        let core_mm = self.mill.core_radius_mm;
        if core_mm > 0.0 { Err(PlungeInfeasible::CoreLeft { core_mm }) } else { Ok(()) }
    }

    /// First and last plane: on the faces of the blank, with the core beside it, or where the blades come near.
    fn range_mm(&self) -> Result<[f64; 2], PlungeInfeasible> {
        let (core_mm, faces_mm) = (self.mill.core_radius_mm, self.blisk.blank.faces_mm);
        // Beyond this distance from the blade's edge no wall bounds the passage.
        let reach_mm = 0.9 * (self.mill.radius_mm + self.needs.allowance_mm);
        let [from_mm, to_mm] = self.field.ends_mm;
        let first_mm = (faces_mm[0] - core_mm).max(from_mm - reach_mm);
        if core_mm > 0.0 && first_mm > faces_mm[0] - core_mm {
            return Err(PlungeInfeasible::Core { z_mm: first_mm, face_mm: faces_mm[0], core_mm });
        }
        Ok([first_mm, faces_mm[1].min(to_mm + reach_mm)])
    }

    /// Refusal of a plane.
    fn too_narrow(&self, z_mm: f64, axes: &Boundary, largest: &[LargestTool]) -> PlungeInfeasible {
        let touching = [(WallSide::Left, 0), (WallSide::Right, 1)]
            .map(|(side, index)| self.field.distance(side, &axes.to_part(&axes.touching[index], z_mm)).1);
        let least_mm = largest.iter().map(|found| found.radius_mm).fold(f64::INFINITY, f64::min);
        let largest_mm = (least_mm.is_finite() && least_mm > 0.0).then_some(2.0 * least_mm);
        PlungeInfeasible::TooNarrow { z_mm, missing_mm: -axes.room_mm(), touching, largest_mm }
    }

    /// Plunge down to the hub with its allowance.
    pub(super) fn plunge(
        &self,
        plane: usize,
        column: &Column,
        axes: &Boundary,
        z_mm: f64,
    ) -> Result<Plunge, PlungeInfeasible> {
        let PlungeRequirements { allowance_mm, clearance_mm, relief_mm, .. } = *self.needs;
        let hub = &self.blisk.hub;
        // Along the axis from below the floor to the roof: the last place on the hub with its allowance.
        let above_mm = |way_mm: f64| hub.height_mm(&(column.floor + column.axis * way_mm)) - allowance_mm;
        let (mut low, mut high) = (-self.mill.radius_mm, (column.roof - column.floor).norm());
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            if above_mm(middle) < 0.0 { low = middle } else { high = middle }
        }
        let on_floor = column.floor + column.axis * high;
        let lean_rad = libm::acos(hub.normal(&on_floor).dot(&column.axis).clamp(-1.0, 1.0));
        if lean_rad.to_degrees() > ANGLE_MAX_DEG {
            return Err(PlungeInfeasible::Steep { z_mm, angle_deg: lean_rad.to_degrees() });
        }
        // The axis lies across the rotor's axis: its frame exists.
        let to_tool = slot_frame(&column.axis).ok_or(PlungeInfeasible::NoBoundary { z_mm })?;
        let lift_mm = self.lift_mm(&on_floor, &to_tool, self.mill.lift_mm(lean_rad));
        let tip = on_floor + column.axis * lift_mm;
        let beside_mm = (to_tool * tip).x.abs();
        let room_mm = axes.room_mm() * column.share.max(1.0 - column.share);
        let is_clear = self.mill.is_relieved_by(relief_mm) && room_mm >= relief_mm;
        // In the tool's frame x points to growing angles about the rotor's axis.
        let away = if column.share < 0.5 { 1.0 } else { -1.0 };
        Ok(Plunge {
            plane,
            axis: column.axis,
            to_tool,
            tip,
            clear_mm: self.turning_mm + clearance_mm,
            roof_mm: roof_mm(self.blisk.blank.radius_mm, beside_mm, self.mill.radius_mm),
            relief_mm: if is_clear { away * relief_mm } else { 0.0 },
            lift_mm,
            lean_rad,
        })
    }

    /// Lift of the mill's end from a place on the floor, at least that of a plane: where the hub is hollow along the rotor's axis, it rises beside the
    /// plane. Middles of the corner, and the end within them, keep the allowance.
    fn lift_mm(&self, on_floor: &Point, to_tool: &Rotation3<f64>, plane_mm: f64) -> f64 {
        let PlungeMill { radius_mm, corner_radius_mm, .. } = *self.mill;
        let needed_mm = self.needs.allowance_mm + corner_radius_mm - LIFT_PRECISION_MM;
        let angles = (0..END_POINTS).map(|k| core::f64::consts::TAU * f64::from(k) / f64::from(END_POINTS));
        let rings_mm = [0.5, 1.0].map(|share| (radius_mm - corner_radius_mm) * share);
        let points =
            angles.flat_map(|angle| rings_mm.map(|ring| Vector::new(libm::cos(angle), libm::sin(angle), 0.0) * ring));
        let points: Vec<Vector> = points.collect();
        let is_clear = |lift_mm: f64| {
            let up = Vector::z() * (lift_mm + corner_radius_mm);
            let at = |point: &Vector| on_floor + to_tool.inverse() * (point + up);
            points.iter().all(|point| self.blisk.hub.height_mm(&at(point)) >= needed_mm)
        };
        let (mut low, mut high) = (plane_mm, plane_mm + 4.0 * radius_mm);
        if is_clear(low) {
            return low;
        }
        while high - low > LIFT_PRECISION_MM {
            let middle = f64::midpoint(low, high);
            if is_clear(middle) { high = middle } else { low = middle }
        }
        high
    }
}

/// Highest and lowest place of a cylinder under a disc, along the disc's axis; 0 beyond the cylinder.
fn roof_mm(cylinder_mm: f64, beside_mm: f64, radius_mm: f64) -> [f64; 2] {
    let at = |beside_mm: f64| libm::sqrt((cylinder_mm * cylinder_mm - beside_mm * beside_mm).max(0.0));
    [at((beside_mm - radius_mm).max(0.0)), at(beside_mm + radius_mm)]
}
