//! Moves of the tool centre between the points of the corners under cutter compensation, and the check that they run
//! with the contour.
//!
//! Interference, as the manuals define it (B-63944EN-1, page 216; B-63664EN, 12.3.6): the offset path of a line runs
//! against the line; that of an arc has lost more at its ends than the arc turns. A control may then leave out vectors
//! of a corner; this model stops with PS0041.

use arcfeed_nc::alarm::Alarm;
use arcfeed_nc::motion::{Plane, Pose};
use arcfeed_nc::segment::{Arc, Path, Segment};

use crate::element::{ArcElement, Element};
use crate::vector::{Point, Vector, add, between, cross, dot, in_plane, length, subtract, unit, with_point};

/// Largest distance, mm, that rounding of two points to whole nanometres can cause.
pub const ROUNDING_MM: f64 = 2e-6;

/// The move of the tool centre from one point to another that belongs to a programmed move: a line, or an arc about
/// the same centre. A rest of an arc that is lost in rounding is a line.
///
/// # Errors
/// PS0041 (interference) if it runs against the programmed move.
pub fn offset_segment(segment: &Segment, plane: Plane, from: Point, to: Point) -> Result<Segment, Alarm> {
    let Some(element) = Element::of(segment, plane) else { return Ok(straight(segment, plane, from, to)) };
    let Some(arc) = &element.arc else {
        let tangent = unit(between(element.from, element.to));
        let is_reversed = dot(between(from, to), tangent) < -ROUNDING_MM;
        return if is_reversed { Err(Alarm::Interference) } else { Ok(straight(segment, plane, from, to)) };
    };
    let [start, end] = [from, to].map(|point| between(arc.center, point));
    let lost_at_start = arc.turned_rad(between(arc.center, element.from), start);
    let lost_at_end = arc.turned_rad(end, between(arc.center, element.to));
    let left_rad = arc.sweep_rad - lost_at_start - lost_at_end;
    let radius_mm = libm::fmin(length(start), length(end));
    if radius_mm <= ROUNDING_MM {
        return Ok(straight(segment, plane, from, to));
    }
    if left_rad * radius_mm < -ROUNDING_MM {
        return Err(Alarm::Interference);
    }
    Ok(along_arc(segment, plane, arc, [from, to], left_rad))
}

/// Straight move from one point of the plane to another; the other axes, feed and block are those of the programmed
/// move.
pub fn straight(segment: &Segment, plane: Plane, from: Point, to: Point) -> Segment {
    let path = if segment.path == Path::Rapid { Path::Rapid } else { Path::Line };
    let (start, end) = (with_point(segment.start, plane, from), with_point(segment.end, plane, to));
    Segment { start, end, path, ..*segment }
}

/// Straight move in the plane around a corner, before a programmed move: the other axes stay at that move's start.
pub fn around_corner(segment: &Segment, plane: Plane, from: Point, to: Point) -> Segment {
    straight(&Segment { end: segment.start, ..*segment }, plane, from, to)
}

/// The programmed move, shifted by an offset vector in the plane.
pub fn beside(segment: &Segment, plane: Plane, by: Point) -> Segment {
    let shifted = |pose: Pose| with_point(pose, plane, add(in_plane(&pose, plane), by));
    Segment { start: shifted(segment.start), end: shifted(segment.end), ..*segment }
}

fn along_arc(segment: &Segment, plane: Plane, arc: &ArcElement, [from, to]: [Point; 2], left_rad: f64) -> Segment {
    let Path::Arc(programmed) = segment.path else { return straight(segment, plane, from, to) };
    let offset = Arc { from: subtract(from, arc.center), to: subtract(to, arc.center), ..programmed };
    // Rounding must not turn the rest of an arc into a whole turn.
    if offset.sweep_rad() - left_rad > core::f64::consts::PI {
        return straight(segment, plane, from, to);
    }
    Segment { path: Path::Arc(offset), ..straight(segment, plane, from, to) }
}

impl ArcElement {
    /// Angle between two directions from the centre, in the sense of the arc, in (-pi, pi].
    fn turned_rad(&self, from: Vector, to: Vector) -> f64 {
        f64::from(self.sign) * libm::atan2(cross(from, to), dot(from, to))
    }
}
