//! End points for the pieces of a divided move, which NC words can give exactly. A line is divided only if it runs along one axis: then
//! each point of the control's grid on that axis lies on the line.
//!
//! A control knows positions in its least increment (0.001 mm, 0.0001 in): rounded to it, a point may lie 1.8 um off the
//! arc. But the place of a division matters little, so it is moved on along the arc, into the faster of the two pieces (the
//! slower one gets longer: no chip gets thicker), to a point of the control's grid that lies on the arc. On a circle of
//! radius r with increments g the rounding error of one coordinate runs through all its values at the latest within
//!
//! ```text
//! w = sqrt(2 r g)     (1)
//! ```
//!
//! where the arc runs along an axis, and much sooner elsewhere. An arc whose start and end radius differ has its radius in
//! proportion to the angle, as controls execute it: the points lie on that curve.

use arcfeed_nc::modal::{Pose, Turn};
use arcfeed_nc::segment::{Arc, Path, Segment};
use arcfeed_units::Nm;

use super::pieces::{Piece, join, start};

/// Off the arc by no more than this, a point is taken at once, nm.
const GOOD_NM: f64 = 100.0;
/// Off the arc by more than this, no point is taken, nm.
const OFF_MAX_NM: f64 = 400.0;
/// Points looked at.
const TRIES: usize = 512;
/// Widest piece of an arc given by R, radians: near half a turn R says little about where the centre is.
const BY_RADIUS_MAX_RAD: f64 = 2.0;

/// Grid of the positions that NC words can express in the program's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Distance of neighbouring grid points: the control's least increment, nm.
    pub step_nm: i64,
    /// Point from which increments are counted: zero, or under G91 the start of the move.
    pub origin: [Nm; 3],
}

/// Piece of a divided move, with its end point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Feed of the piece, and its end as a fraction of the move.
    pub piece: Piece,
    /// End point, on the control's grid.
    pub end: Pose,
}

/// Index (0 X, 1 Y, 2 Z) of the axis along which a line runs; `None` for an arc or if it runs along several axes.
pub fn axis_of(segment: &Segment) -> Option<usize> {
    let moves = |axis: &usize| segment.start.linear[*axis] != segment.end.linear[*axis];
    let mut axes = (0..3).filter(moves);
    axes.next().filter(|_| axes.next().is_none() && segment.path == Path::Line)
}

/// Finds end points for the pieces of a line along an axis, exactly on the line and on the grid. Each end is moved
/// into the faster one of its two pieces. A piece without a grid point is joined with the next one.
pub fn divide_line(segment: &Segment, axis: usize, grid: Grid, mut pieces: Vec<Piece>) -> Option<Vec<Part>> {
    let (from, to) = (segment.start.linear[axis].0, segment.end.linear[axis].0);
    let (mut parts, mut index, mut last) = (Vec::new(), 0, from);
    while index + 1 < pieces.len() {
        let (piece, next) = (pieces[index], pieces[index + 1]);
        let at = from as f64 + (to - from) as f64 * piece.until_ratio - grid.origin[axis].0 as f64;
        let steps = at / grid.step_nm as f64;
        let is_up = (piece.path_mm_per_tooth < next.path_mm_per_tooth) == (to > from);
        let steps = if is_up { libm::ceil(steps) } else { libm::floor(steps) };
        let at = steps as i64 * grid.step_nm + grid.origin[axis].0;
        let is_between = if to > from { last < at && at < to } else { to < at && at < last };
        if !is_between {
            join(&mut pieces, index);
            continue;
        }
        let mut end = segment.end;
        end.linear[axis] = Nm(at);
        pieces[index].until_ratio = (at - from) as f64 / (to - from) as f64;
        parts.push(Part { piece: pieces[index], end });
        (last, index) = (at, index + 1);
    }
    parts.push(Part { piece: *pieces.last()?, end: segment.end });
    Some(parts)
}

/// A point of the grid beside the arc.
struct Found {
    ratio: f64,
    pose: Pose,
    off_nm: f64,
}

/// Finder of end points on an arc that NC words can express.
#[derive(Clone, Copy, Debug)]
pub struct Divider<'a> {
    segment: &'a Segment,
    arc: &'a Arc,
    grid: Grid,
    least_mm: f64,
}

impl<'a> Divider<'a> {
    /// Finder for this arc; each piece will be at least `least_mm` long.
    pub fn new(segment: &'a Segment, arc: &'a Arc, grid: Grid, least_mm: f64) -> Self {
        Divider { segment, arc, grid, least_mm }
    }

    /// Length, mm, by which a piece must exceed the shortest length so that both of its ends can be moved to the grid.
    pub fn allowance_mm(&self) -> f64 {
        0.5 * self.window_mm()
    }

    /// Finds an end point for each piece; two pieces without a suitable point between them are joined. `None` if a piece of an arc given
    /// by R would be too long: near half a turn, R does not determine the centre well enough.
    pub fn divide(&self, mut pieces: Vec<Piece>, by_radius: bool) -> Option<Vec<Part>> {
        if by_radius {
            pieces = self.narrowed(&pieces);
        }
        let mut parts = Vec::new();
        let mut index = 0;
        while index + 1 < pieces.len() {
            match self.end_of(&pieces, index) {
                Some(found) => {
                    pieces[index].until_ratio = found.ratio;
                    parts.push(Part { piece: pieces[index], end: found.pose });
                    index += 1;
                }
                None if by_radius => return None,
                None => join(&mut pieces, index),
            }
        }
        parts.push(Part { piece: *pieces.last()?, end: self.segment.end });
        Some(parts)
    }

    fn window_mm(&self) -> f64 {
        libm::sqrt(2.0 * self.arc.radius_mm() * Nm(self.grid.step_nm).to_mm()) // (1)
    }

    /// Pieces of a sweep that R can tell.
    fn narrowed(&self, pieces: &[Piece]) -> Vec<Piece> {
        let mut narrow = Vec::new();
        for (index, piece) in pieces.iter().enumerate() {
            let from = start(pieces, index);
            let width = piece.until_ratio - from;
            let count = libm::ceil(width * self.arc.sweep_rad() / BY_RADIUS_MAX_RAD).max(1.0);
            let ends = (1..=count as usize).map(|part| from + width * part as f64 / count);
            narrow.extend(ends.map(|until_ratio| Piece { until_ratio, ..*piece }));
            if let Some(last) = narrow.last_mut() {
                last.until_ratio = piece.until_ratio;
            }
        }
        narrow
    }

    /// A point for the end of a piece, in the faster one of it and the next.
    fn end_of(&self, pieces: &[Piece], index: usize) -> Option<Found> {
        let (piece, next) = (pieces[index], pieces[index + 1]);
        let is_forward = next.path_mm_per_tooth >= piece.path_mm_per_tooth;
        let room =
            if is_forward { next.until_ratio - piece.until_ratio } else { piece.until_ratio - start(pieces, index) };
        let length_mm = self.arc.length_mm();
        let spare = (0.5 * (room - self.least_mm / length_mm)).max(0.25 * self.window_mm() / length_mm);
        let window = spare.min(self.window_mm() / length_mm).min(0.25 * room);
        let signed = if is_forward { window } else { -window };
        let mut best: Option<Found> = None;
        for at in 0..TRIES {
            let found = self.nearest(piece.until_ratio + signed * at as f64 / TRIES as f64);
            let into = (found.ratio - piece.until_ratio) * signed;
            if into < 0.0 || found.off_nm >= best.as_ref().map_or(f64::INFINITY, |best| best.off_nm) {
                continue;
            }
            let is_good = found.off_nm <= GOOD_NM;
            best = Some(found);
            if is_good {
                break;
            }
        }
        best.filter(|found| found.off_nm <= OFF_MAX_NM)
    }

    /// The grid's point next to the arc's at `ratio`. How far it is off counts in the plane; across it, half an increment
    /// is the best there is on a flat helix.
    fn nearest(&self, ratio: f64) -> Found {
        let (first, second, normal) = self.arc.plane.axes();
        let [x, y] = self.arc.direction_at(ratio);
        let radius_mm = self.radius_mm(ratio);
        let mut pose = self.segment.start;
        for (axis, center, direction) in [(first, 0, x), (second, 1, y)] {
            let wanted = Nm::from_mm(radius_mm * direction);
            pose.linear[axis] = self.on_grid(axis, self.arc.center[center].0.saturating_add(wanted.0));
        }
        let from_center = |axis: usize, center: usize| Nm(pose.linear[axis].0 - self.arc.center[center].0).to_mm();
        let (x, y) = (from_center(first, 0), from_center(second, 1));
        let ratio = self.ratio_of(x, y);
        let off_mm = libm::fabs(libm::hypot(x, y) - self.radius_mm(ratio));
        let rise = libm::round(self.segment.rise().0 as f64 * ratio) as i64;
        pose.linear[normal] = self.on_grid(normal, self.segment.start.linear[normal].0.saturating_add(rise));
        Found { ratio, pose, off_nm: Nm::from_mm(1.0).0 as f64 * off_mm }
    }

    fn radius_mm(&self, ratio: f64) -> f64 {
        let [x, y] = self.arc.to.map(Nm::to_mm);
        let from_mm = self.arc.radius_mm();
        from_mm + (libm::hypot(x, y) - from_mm) * ratio
    }

    /// Which part of the sweep lies between the start and the direction of a point.
    fn ratio_of(&self, to_x: f64, to_y: f64) -> f64 {
        let [x, y] = self.arc.from.map(Nm::to_mm);
        let ccw = libm::atan2(x * to_y - y * to_x, x * to_x + y * to_y);
        let turned = if self.arc.turn == Turn::Cw { -ccw } else { ccw };
        let turned = if turned < 0.0 { turned + core::f64::consts::TAU } else { turned };
        turned / self.arc.sweep_rad()
    }

    fn on_grid(&self, axis: usize, nm: i64) -> Nm {
        let (step, origin) = (self.grid.step_nm, self.grid.origin[axis].0);
        Nm(origin + (nm - origin + step / 2).div_euclid(step) * step)
    }
}
