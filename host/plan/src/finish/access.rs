//! Access of a finishing mill to a blade: admissible tool axes, approaches, links, and the way out along the mill's axis.

use thiserror::Error;

use crate::geometry::face::Face;
use crate::vector::{Point, Vector};

use super::axis::{AxisProgram, along_arc};
use super::contact::Contact;
use super::course::CourseSearch;
use super::mill::{CutterLocation, FinishMill};
use super::needs::FinishNeeds;
use super::obstacles::FinishBody;
use super::passes::PassPoint;
use super::reach::AxisReach;

/// Longest way out along the tool axis, mm.
const OUT_MAX_MM: f64 = 1_000.0;
/// Largest turn of the axis between two places of a link.
const LINK_RAD: f64 = 0.035;

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

/// Blade with its surroundings, as a mill meets them.
pub struct BladeAccess<'a> {
    /// Mill.
    pub mill: &'a FinishMill,
    /// Requirements.
    pub needs: &'a FinishNeeds,
    /// Obstacles.
    pub bodies: &'a [FinishBody],
    /// Unit vector out of the rotor at the blade.
    pub outward: Vector,
    /// Radius of the blank.
    pub blank_radius_mm: f64,
}

/// Direction out of the rotor at a side of a blade.
pub fn outward(side: &Face) -> Vector {
    let middle = side.point(0.5, 0.5);
    Vector::new(middle.x, middle.y, 0.0).try_normalize(0.0).unwrap_or_else(Vector::x)
}

impl BladeAccess<'_> {
    /// The required tool axes, or else the smoothest course that is admissible on all of these passes.
    ///
    /// # Errors
    /// No axis is admissible at one place.
    pub fn axes(&self, passes: &[Vec<Contact>], is_closed: bool) -> Result<AxisProgram, FinishInfeasible> {
        if let Some(program) = &self.needs.axes {
            return Ok(program.clone());
        }
        let pieces = self.mill.pieces();
        let FinishNeeds { margins, sampling, tilt_rad, .. } = self.needs;
        let turn_rad = sampling.angle_rad / 2.0;
        let reach = AxisReach { mill: self.mill, pieces: &pieces, bodies: self.bodies, margins: *margins, turn_rad };
        let search = CourseSearch { reach: &reach, passes, outward: self.outward, tilt_rad: *tilt_rad, is_closed };
        search.course().map_err(|share| FinishInfeasible::NoAxis { percent: 100.0 * share })
    }

    /// Passes with approaches, links and the way out; of joined passes each begins where the one before ends.
    ///
    /// # Errors
    /// The mill does not leave the part along its axis.
    pub fn path(&self, passes: &[Vec<PassPoint>], are_joined: bool) -> Result<Vec<FinishMove>, FinishInfeasible> {
        let above = |kind, location| FinishMove { kind, location, point: None };
        let cut = |kind, point: &PassPoint| FinishMove { kind, location: point.location, point: Some(*point) };
        let mut path: Vec<FinishMove> = Vec::new();
        for (number, pass) in passes.iter().enumerate() {
            let (Some(first), Some(last)) = (pass.first(), pass.last()) else { continue };
            let follows = are_joined && number > 0;
            if !follows {
                let start = self.out(&first.location)?;
                let kind = if path.is_empty() { MoveKind::Rapid } else { MoveKind::Link };
                let links = path.last().map(|from| between(&from.location, &start)).unwrap_or_default();
                path.extend(links.into_iter().map(|location| above(kind, location)));
                path.extend([above(kind, start), cut(MoveKind::Link, first)]);
            }
            path.extend(pass[1..].iter().map(|point| cut(MoveKind::Cut, point)));
            if !are_joined || number + 1 == passes.len() {
                path.push(above(MoveKind::Link, self.out(&last.location)?));
            }
        }
        Ok(path)
    }

    /// Place above the part on the mill's axis.
    fn out(&self, location: &CutterLocation) -> Result<CutterLocation, FinishInfeasible> {
        let needed_mm = self.blank_radius_mm + self.needs.clearance_mm + self.mill.radius_mm;
        let CutterLocation { tip, axis } = *location;
        let (along, across) = (axis.xy().norm_squared(), tip.coords.xy().dot(&axis.xy()));
        let missing = needed_mm * needed_mm - tip.coords.xy().norm_squared();
        let way_mm =
            if missing <= 0.0 { 0.0 } else { (libm::sqrt(across * across + along * missing) - across) / along };
        if way_mm.is_finite() && way_mm <= OUT_MAX_MM && axis.xy().dot(&self.outward.xy()) > 0.0 {
            Ok(CutterLocation { tip: tip + axis * way_mm, axis })
        } else {
            Err(FinishInfeasible::NoWayOut)
        }
    }

    /// Place on the mill's axis from which it comes down to `location` in rapid, with all of it beyond every obstacle.
    pub fn above_all(&self, location: &CutterLocation) -> CutterLocation {
        // Copies of a body turn about the origin, which leaves this distance.
        let corners = self.bodies.iter().flat_map(|body| body.tree.triangles()).flatten();
        let farthest_mm = corners.map(|corner| corner.coords.norm()).fold(0.0, f64::max);
        let way_mm = location.tip.coords.norm() + farthest_mm + self.mill.radius_mm + self.needs.margins.safety_mm;
        CutterLocation { tip: location.tip + location.axis * way_mm, axis: location.axis }
    }

    /// Places of a path for its proof: it begins and ends far above, as the spindle comes down to the first place and leaves the last one along its axis.
    pub fn whole(&self, path: &[FinishMove]) -> Vec<CutterLocation> {
        let above = |step: Option<&FinishMove>| step.map(|step| self.above_all(&step.location));
        let places = path.iter().map(|step| step.location);
        above(path.first()).into_iter().chain(places).chain(above(path.last())).collect()
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
