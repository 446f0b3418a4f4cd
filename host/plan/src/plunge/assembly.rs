//! Plunges of planes of one family after the other: rows, columns, order.

use nalgebra::{Matrix3, Rotation3};

use crate::frame::slot_frame;
use crate::geometry::blisk::Blank;
use crate::vector::{Point, Vector};

use super::boundary::LargestTool;
use super::column::{Column, columns, spacing_max_mm};
use super::infeasibility::PlungeInfeasible;
use super::material::roof_mm;
use super::passage::Passage;
use super::passage_plan::{PassagePlan, Plunge, PlungeFamily, PlungePlane};
use super::removed::is_open;
use super::rows::Rows;
use super::section::{PlungeSection, SectionFamily, SectionPlane};

/// Plan of a passage in the making, to which families of plunge planes are added. Keeps its state between calls.
pub struct Assembly<'a> {
    passage: &'a Passage<'a>,
    planes: Vec<PlungePlane>,
    plunges: Vec<Plunge>,
    from_left: bool,
}

impl<'a> Assembly<'a> {
    /// Empty plan of a passage.
    pub fn new(passage: &'a Passage<'a>) -> Self {
        Assembly { passage, planes: Vec::new(), plunges: Vec::new(), from_left: true }
    }

    /// Adds the planes of a family between two of its coordinates, with their plunges.
    ///
    /// # Errors
    /// The mill does not pass, or neighbouring plunges would leave material between them.
    pub fn add(
        &mut self,
        sections: &dyn SectionFamily,
        range_mm: [f64; 2],
        family: PlungeFamily,
    ) -> Result<(), PlungeInfeasible> {
        let Passage { mill, .. } = self.passage;
        for row in (Rows { passage: self.passage, family: sections, range_mm }).places()? {
            let PlungeSection { plane, boundary } = row.section;
            if boundary.room_mm() < 0.0 {
                return Err(sections.too_narrow(&row.section));
            }
            let spacing_mm = spacing_max_mm(mill, row.distance_mm)
                .ok_or(PlungeInfeasible::Rows { row_mm: row.distance_mm, core_mm: mill.core_radius_mm })?;
            let mut found = columns(&row.section, spacing_mm);
            let count = found.len();
            if !self.from_left {
                found.reverse(); // plan.rs (1)
            }
            self.from_left = !self.from_left;
            let number = self.planes.len();
            for column in &found {
                let mut plunge = match family {
                    PlungeFamily::Radial => self.passage.plunge(number, column, &boundary, plane.origin.z)?,
                    PlungeFamily::LowerFace | PlungeFamily::UpperFace => self.face_plunge(number, column, &plane),
                };
                // The mill is withdrawn at rapid, so it may step only into what is cut already.
                if !is_open(&self.passage.blisk.blank, &plunge, &self.plunges, mill.radius_mm) {
                    plunge.relief_mm = 0.0;
                }
                self.plunges.push(plunge);
            }
            self.planes.push(PlungePlane {
                family,
                z_mm: plane.origin.z,
                radius_mm: libm::hypot(plane.origin.x, plane.origin.y),
                boundary,
                columns: count,
                spacing_mm: boundary.widths_mm()[0] / (count.max(2) - 1) as f64,
                step_ratio: row.step_ratio,
            });
        }
        Ok(())
    }

    /// Plan with these planes. Where the tool's axis leaves the planes across the rotor's, it turns and moves only above all that may turn below it:
    /// the ball about the point where the rotary axes cross.
    pub fn plan(self, largest: Vec<LargestTool>) -> PassagePlan {
        let Assembly { passage, planes, mut plunges, .. } = self;
        if planes.iter().any(|plane| plane.family != PlungeFamily::Radial) {
            let clear_mm = passage.turning_ball_mm.max(passage.turning_mm) + passage.needs.clearance_mm;
            plunges.iter_mut().for_each(|plunge| plunge.clear_mm = clear_mm);
        }
        PassagePlan { planes, plunges, largest }
    }

    /// Plunge from a face: the mill's end stands on the plane of the ends.
    fn face_plunge(&self, number: usize, column: &Column, plane: &SectionPlane) -> Plunge {
        let Passage { blisk, mill, needs, turning_mm, .. } = self.passage;
        let lean = blisk.hub.normal(&column.floor).dot(&column.axis).clamp(-1.0, 1.0);
        Plunge {
            plane: number,
            axis: column.axis,
            to_tool: tool_frame(&column.axis, plane),
            tip: column.floor,
            clear_mm: turning_mm + needs.clearance_mm,
            roof_mm: roof_mm(&blisk.blank, &column.floor, &column.axis, mill.radius_mm),
            relief_mm: 0.0,
            lift_mm: 0.0,
            lean_rad: libm::acos(lean),
        }
    }
}

/// Frame of a tool: the slot frame (frame.rs), which along the rotor's axis has x along the circumference of a plane.
fn tool_frame(axis: &Vector, plane: &SectionPlane) -> Rotation3<f64> {
    slot_frame(axis).unwrap_or_else(|| {
        let (z, x) = (*axis, plane.across);
        let y = z.cross(&x);
        Rotation3::from_matrix_unchecked(Matrix3::from_rows(&[x.transpose(), y.transpose(), z.transpose()]))
    })
}

/// Distance from the rotor's origin within which a blank lies, mm.
pub fn ball_mm(blank: &Blank) -> f64 {
    let [low_mm, high_mm] = blank.faces_mm.map(f64::abs);
    libm::hypot(blank.radius_mm, low_mm.max(high_mm))
}

/// Distance from the rotor's origin of a box's farthest corner, mm.
pub fn corner_mm([low, high]: &[Point; 2]) -> f64 {
    Vector::from_fn(|axis, _| low[axis].abs().max(high[axis].abs())).norm()
}
