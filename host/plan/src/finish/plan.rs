//! Plan of finishing passes of one blade: span, passes, tool axes.

use arcfeed_kinematics::machine::Machine;

use crate::geometry::blisk::Blisk;
use crate::geometry::face::Face;
use crate::geometry::flaws::BladeSide;

use super::access::{BladeAccess, FinishInfeasible, FinishMove, outward};
use super::axis::AxisProgram;
use super::mill::FinishMill;
use super::needs::FinishNeeds;
use super::obstacles::FinishBody;
use super::passes::{Course, Layout, PassPoint, is_climb};
use super::rows::PassRows;

/// Steps of the search for the lowest row.
const SPAN_STEPS: usize = 200;
/// Passes on which the axes of a course are examined.
const SAMPLED: usize = 4;

/// Plan for finishing one blade.
#[derive(Clone, Debug)]
pub struct FinishPlan {
    /// Passes in order; those of a spiral follow one another without a gap.
    pub passes: Vec<Vec<PassPoint>>,
    /// Whole path: passes with approaches, links and the way out.
    pub path: Vec<FinishMove>,
    /// Lowest and highest row of the passes, as positions between hub (0) and tip (1).
    pub span: [f64; 2],
}

/// Planner of the finishing passes of one blade.
pub struct Planner<'a> {
    /// Rotor.
    pub blisk: &'a Blisk,
    /// Mill.
    pub mill: &'a FinishMill,
    /// Machine.
    pub machine: &'a Machine,
    /// Requirements.
    pub needs: &'a FinishNeeds,
    /// Obstacles.
    pub bodies: &'a [FinishBody],
}

impl Planner<'_> {
    /// Plan for the rotor's first blade.
    ///
    /// # Errors
    /// No tool axis, span or stepover fulfils the requirements.
    pub fn plan(&self) -> Result<FinishPlan, FinishInfeasible> {
        let span = self.span()?;
        let surface = |side: BladeSide, u: f64, v: f64| {
            let face = self.face(side);
            (face.point(u, v), face.normal(u, v))
        };
        let rows = |side: BladeSide| {
            let FinishNeeds { spacing, scallop_mm, .. } = self.needs;
            let rows = PassRows::new(self.face(side), span, *spacing, self.mill.corner_radius_mm, *scallop_mm);
            rows.ok_or(FinishInfeasible::NoStepover)
        };
        let rows = [rows(BladeSide::Pressure)?, rows(BladeSide::Suction)?];
        let mut layout = Layout { surface: &surface, rows, course: self.needs.course, is_forward: true };
        layout.is_forward = self.runs_forward(&layout);
        let access = self.access();
        let axes = self.axes(&layout, &access)?;
        let mut passes: Vec<Vec<PassPoint>> = Vec::new();
        for number in layout.passes() {
            let contacts = layout.contacts(number, self.mill.corner_radius_mm);
            passes.push(axes.points(&contacts, self.mill, &self.needs.sampling));
        }
        let path = access.path(&passes, self.needs.course == Course::Spiral)?;
        Ok(FinishPlan { passes, path, span })
    }

    fn face(&self, side: BladeSide) -> &Face {
        match side {
            BladeSide::Pressure => &self.blisk.pressure,
            BladeSide::Suction => &self.blisk.suction,
        }
    }

    /// Rows between which the mill's end clears the hub.
    fn span(&self) -> Result<[f64; 2], FinishInfeasible> {
        let FinishMill { radius_mm, corner_radius_mm, .. } = *self.mill;
        let needed_mm = radius_mm + self.needs.margins.safety_mm;
        let at = |step: usize| step as f64 / SPAN_STEPS as f64;
        let clears = |v: f64| {
            [&self.blisk.pressure, &self.blisk.suction].iter().all(|face| {
                (0..=SPAN_STEPS / 2).all(|i| {
                    let u = 2.0 * at(i);
                    self.blisk.hub.height_mm(&face.offset(u, v, corner_radius_mm)) >= needed_mm
                })
            })
        };
        let high = self.needs.span[1].unwrap_or(1.0);
        let low = match self.needs.span[0] {
            Some(low) => low,
            None => (0..SPAN_STEPS).map(at).find(|v| clears(*v)).ok_or(FinishInfeasible::NoSpan)?,
        };
        if low < high { Ok([low, high]) } else { Err(FinishInfeasible::NoSpan) }
    }

    /// Passes run forward for the wanted side of the material.
    fn runs_forward(&self, layout: &Layout<'_>) -> bool {
        let contacts = layout.contacts(layout.passes().end / 2, self.mill.corner_radius_mm);
        let Some(contact) = contacts.get(contacts.len() / 4) else { return true };
        // Rows follow one another towards the hub.
        let outward = outward(&self.blisk.pressure);
        is_climb(contact, &outward, &-outward) == self.needs.is_climb
    }

    /// The blade with everything about it, as obstacles for the mill.
    pub fn access(&self) -> BladeAccess<'_> {
        let Planner { blisk, mill, machine, needs, bodies } = *self;
        let blank_radius_mm = blisk.blank.radius_mm;
        BladeAccess { mill, machine, needs, bodies, outward: outward(&blisk.pressure), blank_radius_mm }
    }

    fn axes(&self, layout: &Layout<'_>, access: &BladeAccess<'_>) -> Result<AxisProgram, FinishInfeasible> {
        let last = layout.passes().end - 1;
        let numbers = (0..SAMPLED).map(|k| k * last / (SAMPLED - 1));
        let passes: Vec<_> = numbers.map(|number| layout.contacts(number, self.mill.corner_radius_mm)).collect();
        access.axes(&passes, self.needs.course == Course::Spiral)
    }
}
