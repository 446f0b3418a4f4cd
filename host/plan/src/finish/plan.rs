//! Plan of finishing passes of one blade: span, passes, tool axes, approaches and links.

use thiserror::Error;

use crate::geometry::blisk::Blisk;
use crate::geometry::face::Face;
use crate::geometry::flaws::BladeSide;
use crate::vector::{Point, Vector};

use super::axis::{AxisProgram, along_arc};
use super::course::CourseSearch;
use super::mill::{CutterLocation, FinishMill};
use super::obstacles::FinishBody;
use super::passes::{Course, Layout, PassPoint, Sampling, is_climb};
use super::reach::{AxisReach, Margins};
use super::rows::{PassRows, Spacing};

/// Steps of the search for the lowest row.
const SPAN_STEPS: usize = 200;
/// Longest way out along the tool axis, mm.
const OUT_MAX_MM: f64 = 1_000.0;
/// Largest turn of the axis between two places of a link.
const LINK_RAD: f64 = 0.035;
/// Passes on which the axes of a course are examined.
const SAMPLED: usize = 4;

/// Requirements on a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct FinishNeeds {
    /// Distances to keep.
    pub margins: Margins,
    /// Distances between points.
    pub sampling: Sampling,
    /// Height of the scallops between passes, mm.
    pub scallop_mm: f64,
    /// Lowest and highest row, as places between hub (0) and tip (1); the lowest row that clears the hub unless given.
    pub span: [Option<f64>; 2],
    /// Spacing of the passes.
    pub spacing: Spacing,
    /// Course of the passes.
    pub course: Course,
    /// Climb milling; otherwise conventional.
    pub is_climb: bool,
    /// Height above the blank at which the mill enters and leaves, mm.
    pub clearance_mm: f64,
    /// Tool axes; `None`: the smoothest admissible course.
    pub axes: Option<AxisProgram>,
    /// Least and greatest angle of that course from the normals.
    pub tilt_rad: [f64; 2],
}

/// Kind of a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoveKind {
    /// To the first place, above the part.
    Rapid,
    /// Approach, retract, and between passes.
    Link,
    /// Cut.
    Cut,
}

/// Place of the path, with the move that leads to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FinishMove {
    /// Kind of the move to this place.
    pub kind: MoveKind,
    /// Place of the mill.
    pub location: CutterLocation,
    /// Point of a pass; `None` above the part.
    pub point: Option<PassPoint>,
}

/// Plan of one blade.
#[derive(Clone, Debug)]
pub struct FinishPlan {
    /// Passes in order; those of a spiral follow one another without a gap.
    pub passes: Vec<Vec<PassPoint>>,
    /// Whole path.
    pub path: Vec<FinishMove>,
    /// Lowest and highest row.
    pub span: [f64; 2],
}

/// Reason for which there is no plan.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FinishInfeasible {
    /// No row clears the hub.
    #[error("the mill's end clears the hub on no row of the blade: take a smaller radius, or a smaller `safety`")]
    NoSpan,
    /// The scallop does not fit.
    #[error("no stepover: `scallop` must be below the corner's radius, and hollows of the blade wider than it")]
    NoStepover,
    /// A course has no admissible axis.
    #[error(
        "no tool axis is admissible at {percent:.0} % of the way round the blade: take a thinner or longer neck, a smaller `safety`, a wider range \
         `tilt_deg`, or a shorter span"
    )]
    NoAxis {
        /// Place along the passes.
        percent: f64,
    },
    /// The mill does not get out.
    #[error("the mill does not leave the part along its axis: its axis does not lead out of the rotor")]
    NoWayOut,
}

/// Planner of one blade.
pub struct Planner<'a> {
    /// Rotor.
    pub blisk: &'a Blisk,
    /// Mill.
    pub mill: &'a FinishMill,
    /// Requirements.
    pub needs: &'a FinishNeeds,
    /// Obstacles.
    pub bodies: &'a [FinishBody],
}

impl Planner<'_> {
    /// Plan of the first blade.
    ///
    /// # Errors
    /// There is no plan.
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
        let axes = self.axes(&layout)?;
        let mut passes: Vec<Vec<PassPoint>> = Vec::new();
        for number in layout.passes() {
            let contacts = layout.contacts(number, self.mill.corner_radius_mm);
            passes.push(axes.points(&contacts, self.mill, &self.needs.sampling));
        }
        let path = self.path(&passes)?;
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
        is_climb(contact, &self.outward(), &-self.outward()) == self.needs.is_climb
    }

    /// Direction out of the rotor at the blade.
    fn outward(&self) -> Vector {
        let middle = self.blisk.pressure.point(0.5, 0.5);
        Vector::new(middle.x, middle.y, 0.0).try_normalize(0.0).unwrap_or_else(Vector::x)
    }

    fn axes(&self, layout: &Layout<'_>) -> Result<AxisProgram, FinishInfeasible> {
        if let Some(program) = &self.needs.axes {
            return Ok(program.clone());
        }
        let pieces = self.mill.pieces();
        let FinishNeeds { margins, sampling, .. } = self.needs;
        let turn_rad = sampling.angle_rad / 2.0;
        let reach = AxisReach { mill: self.mill, pieces: &pieces, bodies: self.bodies, margins: *margins, turn_rad };
        let last = layout.passes().end - 1;
        let numbers = (0..SAMPLED).map(|k| k * last / (SAMPLED - 1));
        let passes: Vec<_> = numbers.map(|number| layout.contacts(number, self.mill.corner_radius_mm)).collect();
        let search = CourseSearch {
            reach: &reach,
            passes: &passes,
            outward: self.outward(),
            tilt_rad: self.needs.tilt_rad,
            is_closed: self.needs.course == Course::Spiral,
        };
        search.course().map_err(|share| FinishInfeasible::NoAxis { percent: 100.0 * share })
    }

    /// Passes with approaches, links and the way out.
    fn path(&self, passes: &[Vec<PassPoint>]) -> Result<Vec<FinishMove>, FinishInfeasible> {
        let above = |kind, location| FinishMove { kind, location, point: None };
        let cut = |kind, point: &PassPoint| FinishMove { kind, location: point.location, point: Some(*point) };
        let mut path: Vec<FinishMove> = Vec::new();
        for (number, pass) in passes.iter().enumerate() {
            let (Some(first), Some(last)) = (pass.first(), pass.last()) else { continue };
            let follows = self.needs.course == Course::Spiral && number > 0;
            if !follows {
                let start = self.out(&first.location)?;
                let kind = if path.is_empty() { MoveKind::Rapid } else { MoveKind::Link };
                let links = path.last().map(|from| between(&from.location, &start)).unwrap_or_default();
                path.extend(links.into_iter().map(|location| above(kind, location)));
                path.extend([above(kind, start), cut(MoveKind::Link, first)]);
            }
            path.extend(pass[1..].iter().map(|point| cut(MoveKind::Cut, point)));
            if self.needs.course != Course::Spiral || number + 1 == passes.len() {
                path.push(above(MoveKind::Link, self.out(&last.location)?));
            }
        }
        Ok(path)
    }

    /// Place above the part on the mill's axis.
    fn out(&self, location: &CutterLocation) -> Result<CutterLocation, FinishInfeasible> {
        let needed_mm = self.blisk.blank.radius_mm + self.needs.clearance_mm + self.mill.radius_mm;
        let CutterLocation { tip, axis } = *location;
        let (along, across) = (axis.xy().norm_squared(), tip.coords.xy().dot(&axis.xy()));
        let missing = needed_mm * needed_mm - tip.coords.xy().norm_squared();
        let way_mm =
            if missing <= 0.0 { 0.0 } else { (libm::sqrt(across * across + along * missing) - across) / along };
        if way_mm.is_finite() && way_mm <= OUT_MAX_MM && axis.xy().dot(&self.outward().xy()) > 0.0 {
            Ok(CutterLocation { tip: tip + axis * way_mm, axis })
        } else {
            Err(FinishInfeasible::NoWayOut)
        }
    }
}

/// Places between two others, so that the axis turns little from one to the next.
fn between(from: &CutterLocation, to: &CutterLocation) -> Vec<CutterLocation> {
    let steps = libm::ceil(from.axis.angle(&to.axis) / LINK_RAD).max(1.0);
    let at = |k: usize| {
        let part = k as f64 / steps;
        let tip = Point::from(from.tip.coords.lerp(&to.tip.coords, part));
        CutterLocation { tip, axis: along_arc(&from.axis, &to.axis, part) }
    };
    (1..steps as usize).map(at).collect()
}
