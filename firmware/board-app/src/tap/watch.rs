//! Comparison of the axis positions with the emitted moves.
//!
//! A law must not act on a move that the control does not execute. Therefore each position is compared with the path
//! in execution: with p relative to the start of a line of length L along the unit vector u, or to the centre of an
//! arc of radius r that rises by h over its sweep w, at the angle phi after its start,
//!
//! ```text
//! line  s = p . u clamped to 0..L,           distance = |p - s u|                                (1)
//! arc   in the plane d = |p| - r,  across it e = z - h phi / w,      distance = |(d, e)|,  s = r phi  (2)
//!       behind its end: the distance to the nearer of start and end, which is s too             (3)
//! ```
//! The same path in the opposite direction is another move: s must not fall far below its maximum so far. On a full
//! circle s changes by less than half of it between samples. Rapids have no path. Source: plane geometry.

use core::f32::consts::TAU;

use arcfeed_nc::modal::Pose;
use arcfeed_nc::segment::{Arc, Path, Segment};
use arcfeed_units::Nm;
use arcfeed_units::fmath;

/// Millimetres in a nanometre.
const MM_PER_NM: f32 = 1e-6;
/// Tolerance of every axis at a place.
const AT: Nm = Nm(20_000);
/// Distance of an axis at which it has left a place.
const AWAY: Nm = Nm(100_000);

/// Gate: a part of the program that cannot be followed, and the progress of the axes through it. Keeps its state between calls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gate {
    from: Option<Pose>,
    has_left: bool,
    via: Option<Pose>,
    to: Pose,
}

impl Gate {
    /// Gate that opens when the axes reach `to`, after they have passed `via`.
    pub fn new(via: Option<Pose>, to: Pose) -> Self {
        Gate { from: None, has_left: false, via, to }
    }

    /// Processes a position; returns whether the end is reached. If start and end coincide, the axes must have left
    /// the start.
    pub fn passes(&mut self, position: &Pose) -> bool {
        let from = *self.from.get_or_insert(*position);
        self.has_left |= farthest(position, &from) > AWAY.0.unsigned_abs();
        if self.via.is_some_and(|via| is_at(position, &via)) {
            (self.via, self.has_left) = (None, true);
        }
        self.has_left && self.via.is_none() && is_at(position, &self.to)
    }
}

/// Whether the linear axes are at a place.
pub(super) fn is_at(position: &Pose, place: &Pose) -> bool {
    farthest(position, place) <= AT.0.unsigned_abs()
}

fn farthest(position: &Pose, place: &Pose) -> u64 {
    let axes = position.linear.iter().zip(&place.linear);
    axes.map(|(at, to)| at.0.abs_diff(to.0)).max().unwrap_or(0)
}

/// Progress of the axes along the path of a move. Keeps its state between calls.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct PathProgress {
    along_mm: f32,
    back_mm: f32,
}

/// Location of a position relative to a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PathLocation {
    /// Distance from the path, mm.
    pub distance_mm: f32,
    /// Distance along the path, mm.
    pub along_mm: f32,
    /// Length of the path, if it is a full circle.
    around_mm: Option<f32>,
}

impl PathProgress {
    /// Processes the next place on the same path; returns the distance of the axes from their expected place, mm.
    pub fn off_mm(&mut self, place: &PathLocation) -> f32 {
        let step = place.along_mm - self.along_mm;
        let step = match place.around_mm {
            Some(around) if step > around / 2.0 => step - around,
            Some(around) if step < -around / 2.0 => step + around,
            _ => step,
        };
        self.along_mm = place.along_mm;
        self.back_mm = fmath::max(self.back_mm - step, 0.0);
        fmath::max(place.distance_mm, self.back_mm)
    }
}

/// Location of a position relative to the path of a move; `None` for rapids.
pub(super) fn place(segment: &Segment, position: &Pose) -> Option<PathLocation> {
    match &segment.path {
        Path::Rapid => None,
        Path::Line => Some(on_line(segment, position)),
        Path::Arc(arc) => Some(on_arc(segment, arc, position)),
    }
}

fn on_line(segment: &Segment, position: &Pose) -> PathLocation {
    let along = between(&segment.start, &segment.end);
    let point = between(&segment.start, position);
    let square = dot(along, along);
    let ratio = if square > 0.0 { dot(point, along) / square } else { 0.0 };
    let ratio = fmath::max(fmath::min(ratio, 1.0), 0.0);
    let distance_mm = norm([0, 1, 2].map(|axis| part(point, axis) - ratio * part(along, axis))); // (1)
    PathLocation { distance_mm, along_mm: ratio * fmath::sqrt(square), around_mm: None }
}

fn on_arc(segment: &Segment, arc: &Arc, position: &Pose) -> PathLocation {
    let (first, second, normal) = arc.plane.axes();
    let axis = |pose: &Pose, index: usize| pose.linear.get(index).copied().unwrap_or_default();
    let [center_first, center_second] = arc.center;
    let point = [mm(center_first, axis(position, first)), mm(center_second, axis(position, second))];
    let [from, to] = [arc.from, arc.to].map(|vector| vector.map(|axis| mm(Nm(0), axis)));
    let turn = f32::from(arc.turn.sign());
    let (phi, to_end) = (angle(turn, from, point), angle(turn, from, to));
    let is_around = arc.from == arc.to;
    let sweep = if is_around || to_end == 0.0 { TAU } else { to_end };
    let [from_x, from_y] = from;
    let radius = fmath::length(from_x, from_y);
    if phi > sweep {
        let [start, end] = [&segment.start, &segment.end].map(|place| norm(between(place, position)));
        let along_mm = if start <= end { 0.0 } else { radius * sweep };
        return PathLocation { distance_mm: fmath::min(start, end), along_mm, around_mm: None }; // (3)
    }
    let [start, end] = [&segment.start, &segment.end].map(|place| mm(axis(place, normal), axis(position, normal)));
    let across = start + phi / sweep * (end - start);
    let [x, y] = point;
    let distance_mm = fmath::length(fmath::length(x, y) - radius, across); // (2)
    PathLocation { distance_mm, along_mm: radius * phi, around_mm: is_around.then_some(radius * sweep) }
}

/// Angle from one vector to another in the given sense, from 0 to a full turn.
fn angle(turn: f32, [x, y]: [f32; 2], [to_x, to_y]: [f32; 2]) -> f32 {
    let angle = fmath::atan2(turn * (x * to_y - y * to_x), x * to_x + y * to_y);
    if angle < 0.0 { angle + TAU } else { angle }
}

fn between(from: &Pose, to: &Pose) -> [f32; 3] {
    let [x, y, z] = from.linear;
    let [to_x, to_y, to_z] = to.linear;
    [mm(x, to_x), mm(y, to_y), mm(z, to_z)]
}

fn mm(from: Nm, to: Nm) -> f32 {
    to.0.saturating_sub(from.0) as f32 * MM_PER_NM
}

fn part(vector: [f32; 3], axis: usize) -> f32 {
    vector.get(axis).copied().unwrap_or_default()
}

fn dot([ax, ay, az]: [f32; 3], [bx, by, bz]: [f32; 3]) -> f32 {
    ax * bx + ay * by + az * bz
}

fn norm([x, y, z]: [f32; 3]) -> f32 {
    fmath::length(fmath::length(x, y), z)
}

#[cfg(test)]
mod tests;
