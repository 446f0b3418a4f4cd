//! Where on its segment the tool's centre is, from the axes' positions: noisy, late, now and then missing.
//!
//! One state for arcs and lines: the place reached. Each tick it moves on along the segment by
//!
//! ```text
//! residual = path from the place to the sample's projection + v delay      (1)
//! ds       = v dt + alpha residual,    v += beta residual / dt             (2)
//! ```
//!
//! never backwards and never beyond the segment's end. Without a sample the residual is zero and the place moves on by
//! dead reckoning. Exact samples are followed as they come, without the filter. Because only the path from the place
//! counts, a segment that runs back over the one before cannot catch it.
//!
//! Source: the alpha-beta filter of tracking radars; docs/laws.md#progress.

use core::f32::consts::FRAC_PI_2;

use arcfeed_shared::fmath;
use arcfeed_shared::nc::modal::{Plane, Pose};
use arcfeed_shared::segment::{Path, Segment};
use arcfeed_shared::units::{Micros, Nm, US_PER_S};

use crate::law::Place;

/// Millimetres in a nanometre, for positions on the tick.
const MM_PER_NM: f32 = 1e-6;

/// How samples of the position are trusted; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PositionFilter {
    /// As they are: no noise, no delay, none missing.
    Exact,
    /// With an alpha-beta filter.
    AlphaBeta(AlphaBeta),
}

/// The gains of the filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlphaBeta {
    /// Part of the residual taken up at once, 0 to 1.
    alpha_ratio: f32,
    /// Part of the residual that corrects the speed, 0 to 1.
    beta_ratio: f32,
    /// Age of a sample when it arrives, s.
    delay_s: f32,
}

impl PositionFilter {
    /// A filter with the given gain (0 to 1 exclusive; small: smooth and slow) for samples that are `delay` old.
    /// The speed's gain follows for critical damping: beta = 2 (2 - alpha) - 4 sqrt(1 - alpha).
    ///
    /// `None` if the gain is out of range.
    pub fn new(alpha_ratio: f32, delay: Micros) -> Option<Self> {
        let in_range = alpha_ratio > 0.0 && alpha_ratio < 1.0;
        let beta_ratio = 2.0 * (2.0 - alpha_ratio) - 4.0 * fmath::sqrt(1.0 - alpha_ratio);
        let gains = AlphaBeta { alpha_ratio, beta_ratio, delay_s: seconds(delay) };
        in_range.then_some(PositionFilter::AlphaBeta(gains))
    }
}

/// A segment as progress sees it; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    plane: Plane,
    origin: [Nm; 2],
    course: Course,
    length_mm: f32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Course {
    /// About the origin; what a helix does across the plane is left out.
    Arc { turn: f32, radius_mm: f32, start: [f32; 2] },
    /// From the origin; the direction is of unit length in space, its part in the plane may be shorter.
    Line { start: [Nm; 3], direction: [f32; 3], in_plane: [f32; 2] },
}

/// How far the segment is done; state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Unit vector from the rotation centre; of no meaning on a line.
    direction: [f32; 2],
    travelled_mm: f32,
    speed_mm_per_s: f32,
}

impl Progress {
    /// Path from the segment's start, of a helix in the plane of its arc.
    pub fn travelled_mm(&self) -> f32 {
        self.travelled_mm
    }

    /// Speed along the path as estimated.
    pub fn speed_mm_per_s(&self) -> f32 {
        self.speed_mm_per_s
    }
}

impl Track {
    /// The track of a cutting move; `None` for rapids, whose way is the machine's.
    pub fn new(segment: &Segment) -> Option<Self> {
        let (plane, origin, course) = match &segment.path {
            Path::Rapid => return None,
            Path::Line => {
                let [x, y, _] = segment.start.linear;
                (Plane::Xy, [x, y], line(segment))
            }
            Path::Arc(arc) => {
                let start = direction_of(arc.from);
                let turn = f32::from(arc.turn.sign());
                (arc.plane, arc.center, Course::Arc { turn, radius_mm: arc.radius_mm() as f32, start })
            }
        };
        Some(Track { plane, origin, course, length_mm: segment.feed_length_mm() as f32 })
    }

    /// Length of the path, of a helix that of its arc in the plane, mm.
    pub fn length_mm(&self) -> f32 {
        self.length_mm
    }

    /// Progress before the first sample: at the start, moving at `speed_mm_per_s`.
    pub fn begin(&self, speed_mm_per_s: f32) -> Progress {
        let direction = match self.course {
            Course::Arc { start, .. } => start,
            Course::Line { .. } => [0.0; 2],
        };
        Progress { direction, travelled_mm: 0.0, speed_mm_per_s }
    }

    /// The place reached.
    #[inline(always)]
    pub fn place(&self, progress: &Progress) -> Place {
        match self.course {
            Course::Arc { turn, radius_mm, .. } => {
                Place::on_arc(progress.direction, turn, radius_mm, progress.travelled_mm)
            }
            Course::Line { in_plane, .. } => Place::on_line(in_plane, progress.travelled_mm),
        }
    }

    /// One tick: takes the sample, if there is one.
    #[inline(always)]
    pub fn advance(&self, filter: &PositionFilter, progress: &mut Progress, sample: Option<&Pose>, dt: Micros) {
        if let (PositionFilter::Exact, Course::Arc { turn, radius_mm, .. }, Some(position)) =
            (filter, &self.course, sample)
        {
            self.follow_arc(progress, *turn, *radius_mm, position);
        } else {
            self.advance_otherwise(filter, progress, sample, dt);
        }
    }

    /// Takes an exact sample on an arc: its direction, if that lies ahead.
    #[inline(always)]
    fn follow_arc(&self, progress: &mut Progress, turn: f32, radius_mm: f32, position: &Pose) {
        let direction = direction_of(self.relative(position));
        // A sample at the rotation centre is NaN, and ahead of nothing.
        let ahead = turn * cross(progress.direction, direction);
        if ahead > 0.0 {
            progress.direction = direction;
            let travelled_mm = progress.travelled_mm + radius_mm * small_angle(ahead);
            progress.travelled_mm = fmath::min(travelled_mm, self.length_mm);
        }
    }

    #[cold]
    #[inline(never)]
    fn advance_otherwise(&self, filter: &PositionFilter, progress: &mut Progress, sample: Option<&Pose>, dt: Micros) {
        let behind_mm = sample.and_then(|position| self.path_to(progress, position));
        match filter {
            PositionFilter::Exact => self.move_on(progress, behind_mm.unwrap_or(0.0)),
            PositionFilter::AlphaBeta(gains) => {
                let ds_mm = gains.step(&mut progress.speed_mm_per_s, behind_mm, dt);
                self.move_on(progress, ds_mm);
            }
        }
    }

    /// A position in the segment's plane, relative to its origin.
    #[inline(always)]
    fn relative(&self, position: &Pose) -> [Nm; 2] {
        let [x, y, z] = position.linear;
        let (first, second) = match self.plane {
            Plane::Xy => (x, y),
            Plane::Zx => (z, x),
            Plane::Yz => (y, z),
        };
        let [origin_x, origin_y] = self.origin;
        // Wrapping: coordinates stay far below the 9 million kilometres at which it would.
        [Nm(first.0.wrapping_sub(origin_x.0)), Nm(second.0.wrapping_sub(origin_y.0))]
    }

    /// Path from the progress made to the projection of a position; `None` where it has none.
    fn path_to(&self, progress: &Progress, position: &Pose) -> Option<f32> {
        match self.course {
            Course::Arc { turn, radius_mm, .. } => {
                let ([ex, ey], [x, y]) = (progress.direction, direction_of(self.relative(position)));
                let (sine, cosine) = (turn * cross([ex, ey], [x, y]), ex * x + ey * y);
                let right_angle = if sine < 0.0 { -FRAC_PI_2 } else { FRAC_PI_2 };
                let angle_rad = if cosine <= 0.0 { right_angle } else { small_angle(sine) };
                angle_rad.is_finite().then_some(radius_mm * angle_rad)
            }
            Course::Line { start, direction, .. } => {
                let [x, y, z] = position.linear;
                let [sx, sy, sz] = start;
                let [dx, dy, dz] = direction;
                let along = millimetres(x, sx) * dx + millimetres(y, sy) * dy + millimetres(z, sz) * dz;
                Some(along - progress.travelled_mm)
            }
        }
    }

    fn move_on(&self, progress: &mut Progress, ds_mm: f32) {
        // max and min drop a NaN.
        let ds_mm = ds_mm.max(0.0).min(self.length_mm - progress.travelled_mm);
        progress.travelled_mm += ds_mm;
        if let Course::Arc { turn, radius_mm, .. } = self.course {
            progress.direction = rotate(progress.direction, turn * ds_mm / radius_mm);
        }
    }
}

impl AlphaBeta {
    /// The path to move on by in a tick, and the speed corrected.
    fn step(&self, speed_mm_per_s: &mut f32, behind_mm: Option<f32>, dt: Micros) -> f32 {
        let dt_s = seconds(dt);
        let dead_reckoned_mm = *speed_mm_per_s * dt_s;
        let Some(behind_mm) = behind_mm else { return dead_reckoned_mm };
        // What will have been reached at this tick, against where the sample says it was by now.
        let residual_mm = behind_mm + *speed_mm_per_s * self.delay_s - dead_reckoned_mm; // (1)
        if dt_s > 0.0 {
            let speed = *speed_mm_per_s + self.beta_ratio * residual_mm / dt_s; // (2)
            // Late samples from the segment before lie behind the start: they must not wind the speed up.
            *speed_mm_per_s = speed.max(0.0);
        }
        dead_reckoned_mm + self.alpha_ratio * residual_mm // (2)
    }
}

/// The sine of the angle from one unit vector to another.
#[inline(always)]
fn cross([x, y]: [f32; 2], [to_x, to_y]: [f32; 2]) -> f32 {
    x * to_y - y * to_x
}

fn line(segment: &Segment) -> Course {
    let [x, y, z] = segment.start.linear;
    let [to_x, to_y, to_z] = segment.end.linear;
    let length_mm = segment.feed_length_mm() as f32;
    let part = |from, to| if length_mm > 0.0 { millimetres(to, from) / length_mm } else { 0.0 };
    let (dx, dy, dz) = (part(x, to_x), part(y, to_y), part(z, to_z));
    Course::Line { start: segment.start.linear, direction: [dx, dy, dz], in_plane: [dx, dy] }
}

/// Turns a unit vector by a small angle (up to about a radian) and keeps its length: Taylor to the fifth order, one
/// Newton step towards length one.
fn rotate([x, y]: [f32; 2], angle_rad: f32) -> [f32; 2] {
    let square = angle_rad * angle_rad;
    let sin = angle_rad * (1.0 - square * (1.0 / 6.0 - square / 120.0));
    let cos = 1.0 - square * (0.5 - square / 24.0);
    let (turned_x, turned_y) = (x * cos - y * sin, x * sin + y * cos);
    let scale = 1.5 - 0.5 * (turned_x * turned_x + turned_y * turned_y);
    [turned_x * scale, turned_y * scale]
}

/// The angle with this sine, for small ones (1e-6 rad off at 0.3).
#[inline(always)]
fn small_angle(sine: f32) -> f32 {
    let square = sine * sine;
    sine + sine * square * (1.0 / 6.0 + square * (3.0 / 40.0))
}

/// The direction of a vector, NaN if it has no length; the scale cancels, so nanometres go into f32 as they are.
#[inline(always)]
fn direction_of([x, y]: [Nm; 2]) -> [f32; 2] {
    let [x_nm, y_nm] = fmath::from_pair([x.0, y.0]);
    let length_nm = fmath::length(x_nm, y_nm);
    [x_nm / length_nm, y_nm / length_nm]
}

fn millimetres(a: Nm, b: Nm) -> f32 {
    a.0.saturating_sub(b.0) as f32 * MM_PER_NM
}

fn seconds(span: Micros) -> f32 {
    fmath::from_u64(span.0) / US_PER_S as f32
}

#[cfg(test)]
mod tests;
