//! Chamfers and rounded corners (`,C` and `,R`): the move inserted between two moves of a plane, and what it leaves of them.
//!
//! The rounding of radius r lies on the side to which the path turns. Its centre is the intersection of both paths offset
//! by r to that side, the one next to the corner; it ends at the points of the paths nearest to the centre. A chamfer
//! ends at the points of both paths whose straight distance from the corner is C; on a circle of radius R these are
//!
//! ```text
//! 2 asin(C / 2R)     (1)
//! ```
//!
//! from the corner. Between directions less than one degree apart nothing is inserted. The distance of a chamfer on an
//! arc, and the one degree, are assumptions.

use arcfeed_nc::alarm::Alarm;
use arcfeed_nc::motion::{Corner, Plane, Turn};
use arcfeed_nc::segment::{Arc, Path, Segment};

use crate::corner::corner;
use crate::element::{ArcElement, Element};
use crate::offset_path::{ROUNDING_MM, straight};
use crate::vector::{Point, Vector, at, between, cross, dot, length, minus, plus, scaled, subtract, to_left, unit};

/// Angle between the moves below which nothing is inserted.
const TANGENT_RAD: f64 = core::f64::consts::PI / 180.0;

/// Two consecutive moves between which the control inserts a chamfer or a rounded corner (`,C`, `,R`): the shortened
/// moves and the inserted one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InsertedCorner {
    /// First move, shortened at its end.
    pub first: Segment,
    /// The inserted line or arc, with the feed of the first move; `None` between moves that continue in one direction.
    pub between: Option<Segment>,
    /// Second move, shortened at its start.
    pub second: Segment,
}

impl InsertedCorner {
    /// Inserts a chamfer or a rounded corner between two consecutive moves.
    ///
    /// # Errors
    /// PS0055 if the first move is too short for the corner or no such corner exists, PS0051 if the second is too short.
    pub fn new(first: &Segment, second: &Segment, plane: Plane, kind: Corner) -> Result<Self, Alarm> {
        let none = InsertedCorner { first: *first, between: None, second: *second };
        let (Some(before), Some(behind)) = (Element::of(first, plane), Element::of(second, plane)) else {
            return Err(Alarm::NoMoveBehindCorner);
        };
        let tangents = [before.end(0.0).tangent, behind.start(0.0).tangent];
        let [t1, t2] = tangents;
        let turned_rad = libm::atan2(cross(t1, t2), dot(t1, t2));
        if libm::fabs(turned_rad) < TANGENT_RAD {
            return Ok(none);
        }
        if core::f64::consts::PI - libm::fabs(turned_rad) < TANGENT_RAD {
            return Err(Alarm::ShortCorner);
        }
        let side = if turned_rad > 0.0 { 1.0 } else { -1.0 };
        let ends = match kind {
            Corner::Chamfer(size) => chamfer_ends(&before, &behind, size.to_mm()),
            Corner::Rounding(radius) => rounding_ends(&before, &behind, side * radius.to_mm()),
        };
        let Ends { from, to, center } = ends.ok_or(Alarm::ShortCorner)?;
        let [from, to] = [from, to].map(|vector| at(before.to, vector));
        if from == to {
            return Ok(none);
        }
        let first = shortened(first, plane, &before, [before.from, from]).ok_or(Alarm::ShortCorner)?;
        let second = shortened(second, plane, &behind, [to, behind.to]).ok_or(Alarm::NoMoveBehindCorner)?;
        let line = Segment { start: first.end, end: first.end, path: Path::Line, ..first };
        let mut inserted = straight(&line, plane, from, to);
        if let Some(center) = center {
            let center = at(before.to, center);
            let turn = if side > 0.0 { Turn::Ccw } else { Turn::Cw };
            let arc = Arc { plane, turn, center, from: subtract(from, center), to: subtract(to, center) };
            // Rounding must not turn a short arc into a whole turn.
            if arc.sweep_rad() < core::f64::consts::PI {
                inserted.path = Path::Arc(arc);
            }
        }
        Ok(InsertedCorner { first, between: Some(inserted), second })
    }
}

/// Ends of an inserted move, and the centre of a rounding, relative to the corner.
struct Ends {
    from: Vector,
    to: Vector,
    center: Option<Vector>,
}

fn chamfer_ends(before: &Element, behind: &Element, size_mm: f64) -> Option<Ends> {
    let from = point_at_distance(before, before.to, size_mm, -1.0)?;
    let to = point_at_distance(behind, behind.from, size_mm, 1.0)?;
    Some(Ends { from, to, center: None })
}

/// Point of a path at a straight distance from its end `corner`, against or with its direction.
fn point_at_distance(element: &Element, corner: Point, size_mm: f64, sign: f64) -> Option<Vector> {
    let Some(arc) = &element.arc else {
        return Some(scaled(unit(between(element.from, element.to)), sign * size_mm));
    };
    let center = between(corner, arc.center);
    let half = size_mm / (2.0 * length(center));
    let angle_rad = (half <= 1.0).then(|| sign * f64::from(arc.sign) * 2.0 * libm::asin(half))?; // (1)
    let (sin, cos) = libm::sincos(angle_rad);
    let [x, y] = scaled(center, -1.0);
    Some(plus(center, [cos * x - sin * y, sin * x + cos * y]))
}

fn rounding_ends(before: &Element, behind: &Element, offset_mm: f64) -> Option<Ends> {
    let center = *corner(&before.end(offset_mm), &behind.start(offset_mm), offset_mm)?.first()?;
    let from = nearest(before, before.to, center, offset_mm);
    let to = nearest(behind, behind.from, center, offset_mm);
    Some(Ends { from, to, center: Some(center) })
}

/// Point of a path at which a circle about `center` touches it; all relative to the corner.
fn nearest(element: &Element, corner: Point, center: Vector, offset_mm: f64) -> Vector {
    match &element.arc {
        None => {
            let normal = to_left(unit(between(element.from, element.to)));
            minus(center, scaled(normal, offset_mm))
        }
        Some(arc) => {
            let middle = between(corner, arc.center);
            let radius_mm = length(middle);
            let is_around = radius_mm < f64::from(arc.sign) * offset_mm;
            let reach = if is_around { -radius_mm } else { radius_mm };
            plus(middle, scaled(unit(minus(center, middle)), reach))
        }
    }
}

/// The part of a move from one of its points to another; `None` if they lie the other way round.
fn shortened(segment: &Segment, plane: Plane, element: &Element, [from, to]: [Point; 2]) -> Option<Segment> {
    let line = straight(&Segment { path: Path::Line, ..*segment }, plane, from, to);
    let Some(arc) = &element.arc else {
        let along = dot(between(from, to), unit(between(element.from, element.to)));
        return (along >= -ROUNDING_MM).then_some(line);
    };
    let lost_rad = turn_to(arc, element.from, from) + turn_to(arc, to, element.to);
    let left_mm = (arc.sweep_rad - lost_rad) * length(between(arc.center, to));
    if left_mm < -ROUNDING_MM {
        return None;
    }
    let Path::Arc(whole) = segment.path else { return None };
    let rest = Arc { from: subtract(from, arc.center), to: subtract(to, arc.center), ..whole };
    // Rounding must not turn the rest of an arc into a whole turn.
    let is_whole = rest.sweep_rad() - arc.sweep_rad > core::f64::consts::PI || left_mm <= ROUNDING_MM;
    Some(if is_whole { line } else { Segment { path: Path::Arc(rest), ..line } })
}

/// Angle of an arc from one of its points to a later one, in [0, 2 pi).
fn turn_to(arc: &ArcElement, from: Point, to: Point) -> f64 {
    if from == to {
        return 0.0;
    }
    let [a, b] = [from, to].map(|point| between(arc.center, point));
    let turned = f64::from(arc.sign) * libm::atan2(cross(a, b), dot(a, b));
    if turned < 0.0 { turned + 2.0 * core::f64::consts::PI } else { turned }
}

#[cfg(test)]
mod tests;
