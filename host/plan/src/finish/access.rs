//! Access of a finishing mill to a blade: admissible tool axes, approaches, links, and the way out along the mill's axis.

use arcfeed_kinematics::machine::Machine;
use thiserror::Error;

use crate::geometry::face::Face;
use crate::vector::{Point, Vector};

use super::axis::{AxisProgram, along_arc};
use super::contact::Contact;
use super::course::{CourseGap, CourseSearch};
use super::mill::{CutterLocation, FinishMill};
use super::needs::FinishNeeds;
use super::obstacles::FinishBody;
use super::passes::PassPoint;
use super::reach::AxisReach;
use super::rotary::RangeExcess;

/// Longest way out along the tool axis, mm.
const OUT_MAX_MM: f64 = 1_000.0;
/// Largest turn of the axis between two places of a link.
const LINK_RAD: f64 = 0.035;

/// Kind of a move in a finishing path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoveKind {
    /// Rapid move to the first position, above the part.
    Rapid,
    /// Approach, retract, or link between two passes.
    Link,
    /// Cutting move along a pass.
    Cut,
}

/// Position of the mill in a finishing path, with the kind of the move that leads to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FinishMove {
    /// Kind of the move that leads to this position.
    pub kind: MoveKind,
    /// Position of the mill's tip, and its axis.
    pub location: CutterLocation,
    /// Point of the pass; `None` for positions above the part.
    pub point: Option<PassPoint>,
}

/// Reason why there is no plan for finishing a blade.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FinishInfeasible {
    /// No row of the blade keeps clear of the hub.
    #[error("the mill's end clears the hub on no row of the blade: take a smaller radius, or a smaller `safety`")]
    NoSpan,
    /// No stepover gives the required scallop height.
    #[error("no stepover: `scallop` must be below the corner's radius, and hollows of the blade wider than it")]
    NoStepover,
    /// At one position along the passes no tool axis is admissible.
    #[error(
        "no tool axis is admissible at {percent:.0} % of the way round the blade: take a thinner or longer neck, a smaller `safety`, a wider range \
         `tilt_deg`, or a shorter span"
    )]
    NoAxis {
        /// That position, in per cent of the way round the blade.
        percent: f64,
    },
    /// At one position along the passes the machine's rotary axes do not reach the tool axes that are admissible.
    #[error(
        "the rotary axes reach no admissible tool axis at {percent:.0} % of the way round the blade: {excess}. Take a wider range `tilt_deg`, a thinner or longer \
         neck, a smaller `safety`, a shorter span, or a machine with a wider range of this axis"
    )]
    OutOfRange {
        /// That position, in per cent of the way round the blade.
        percent: f64,
        /// Least excess over the range of a rotary axis.
        excess: RangeExcess,
    },
    /// The mill cannot leave the part along its axis.
    #[error("the mill does not leave the part along its axis: its axis does not lead out of the rotor")]
    NoWayOut,
}

/// Blade with everything about it, as obstacles for a finishing mill.
pub struct BladeAccess<'a> {
    /// Mill with neck and holder.
    pub mill: &'a FinishMill,
    /// Machine whose rotary axes must reach the tool axes.
    pub machine: &'a Machine,
    /// Requirements on the passes.
    pub needs: &'a FinishNeeds,
    /// Obstacles: this blade, its neighbours, hub and fixtures.
    pub bodies: &'a [FinishBody],
    /// Unit vector away from the rotor at the blade.
    pub outward: Vector,
    /// Radius of the rotor's blank.
    pub blank_radius_mm: f64,
}

/// Unit vector away from the rotor's axis at a side of a blade.
pub fn outward(side: &Face) -> Vector {
    let middle = side.point(0.5, 0.5);
    Vector::new(middle.x, middle.y, 0.0).try_normalize(0.0).unwrap_or_else(Vector::x)
}

impl BladeAccess<'_> {
    /// Tool axes along the passes: the required ones or, without such, the smoothest course that is admissible on all of these passes.
    ///
    /// # Errors
    /// At one position no tool axis is admissible.
    pub fn axes(&self, passes: &[Vec<Contact>], is_closed: bool) -> Result<AxisProgram, FinishInfeasible> {
        if let Some(program) = &self.needs.axes {
            return Ok(program.clone());
        }
        let pieces = self.mill.pieces();
        let FinishNeeds { margins, sampling, tilt_rad, .. } = self.needs;
        let turn_rad = sampling.angle_rad / 2.0;
        let reach = AxisReach { mill: self.mill, pieces: &pieces, bodies: self.bodies, margins: *margins, turn_rad };
        let (outward, machine, tilt_rad) = (self.outward, self.machine, *tilt_rad);
        let search = CourseSearch { reach: &reach, machine, passes, outward, tilt_rad, is_closed };
        search.course().map_err(|CourseGap { share, excess }| {
            let percent = 100.0 * share;
            excess
                .map_or(FinishInfeasible::NoAxis { percent }, |excess| FinishInfeasible::OutOfRange { percent, excess })
        })
    }

    /// Whole path: passes with approaches, links and the way out along the mill's axis. Of joined passes, each begins where the last ends.
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

    /// Position on the mill's axis, from which it can come down to `location` in rapid: all of the mill is beyond every obstacle.
    pub fn above_all(&self, location: &CutterLocation) -> CutterLocation {
        // Copies of a body turn about the origin, which leaves this distance.
        let corners = self.bodies.iter().flat_map(|body| body.tree.triangles()).flatten();
        let farthest_mm = corners.map(|corner| corner.coords.norm()).fold(0.0, f64::max);
        let way_mm = location.tip.coords.norm() + farthest_mm + self.mill.radius_mm + self.needs.margins.safety_mm;
        CutterLocation { tip: location.tip + location.axis * way_mm, axis: location.axis }
    }

    /// Positions of a path for its collision proof. It begins and ends far above, because the spindle comes down to the first place and
    /// leaves the last one along the mill's axis.
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
