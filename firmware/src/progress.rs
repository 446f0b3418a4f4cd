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
    /// About the origin.
    Arc { turn: f32, radius_mm: f32, start: [f32; 2] },
    /// From the origin; the direction is of unit length in space, its part in the plane may be shorter.
    Line { start: [Nm; 3], direction: [f32; 3], in_plane: [f32; 2] },
}

/// The place reached; state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    place: Place,
    speed_mm_per_s: f32,
}

impl Progress {
    /// The place reached.
    pub fn place(&self) -> &Place {
        &self.place
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
        Some(Track { plane, origin, course, length_mm: segment.length_mm() as f32 })
    }

    /// Length of the path, mm.
    pub fn length_mm(&self) -> f32 {
        self.length_mm
    }

    /// Progress before the first sample: at the start, moving at `speed_mm_per_s`.
    pub fn begin(&self, speed_mm_per_s: f32) -> Progress {
        let place = match self.course {
            Course::Arc { turn, radius_mm, start } => Place::on_arc(start, turn, radius_mm, 0.0),
            Course::Line { in_plane, .. } => Place::on_line(in_plane, 0.0),
        };
        Progress { place, speed_mm_per_s }
    }

    /// One tick: takes the sample, if there is one, and answers the place to use.
    #[inline(always)]
    pub fn advance<'p>(
        &self,
        filter: &PositionFilter,
        progress: &'p mut Progress,
        sample: Option<&Pose>,
        dt: Micros,
    ) -> &'p Place {
        match (filter, &self.course, sample) {
            (PositionFilter::Exact, Course::Arc { turn, radius_mm, .. }, Some(position)) => {
                self.follow_arc(&mut progress.place, *turn, *radius_mm, position);
            }
            (PositionFilter::Exact, Course::Line { .. }, Some(position)) => self.follow_line(progress, position),
            (PositionFilter::Exact, _, None) => {}
            (PositionFilter::AlphaBeta(gains), ..) => self.filter(gains, progress, sample, dt),
        }
        &progress.place
    }

    /// Takes an exact sample on an arc: the place is its direction, if that lies ahead.
    #[inline(always)]
    fn follow_arc(&self, place: &mut Place, turn: f32, radius_mm: f32, position: &Pose) {
        let [x, y] = direction_of(self.relative(position));
        let [ex, ey] = place.towards;
        // The place's direction from A is minus its direction towards A. A sample at A is NaN, and ahead of nothing.
        let ahead = turn * (ey * x - ex * y);
        if ahead > 0.0 {
            let travelled_mm = place.travelled_mm + radius_mm * small_angle(ahead);
            *place = Place::on_arc([x, y], turn, radius_mm, fmath::min(travelled_mm, self.length_mm));
        }
    }

    #[inline(never)]
    fn follow_line(&self, progress: &mut Progress, position: &Pose) {
        if let Some(ahead_mm) = self.path_to(&progress.place, position) {
            self.move_on(&mut progress.place, ahead_mm);
        }
    }

    #[inline(never)]
    fn filter(&self, gains: &AlphaBeta, progress: &mut Progress, sample: Option<&Pose>, dt: Micros) {
        let dt_s = seconds(dt);
        let mut ds_mm = progress.speed_mm_per_s * dt_s;
        let behind_mm = sample.and_then(|position| self.path_to(&progress.place, position));
        if let Some(behind_mm) = behind_mm {
            // What the place will have reached at this tick, against where the sample says it was by now.
            let residual_mm = behind_mm + progress.speed_mm_per_s * gains.delay_s - ds_mm; // (1)
            ds_mm += gains.alpha_ratio * residual_mm; // (2)
            if dt_s > 0.0 {
                let speed = progress.speed_mm_per_s + gains.beta_ratio * residual_mm / dt_s; // (2)
                // Late samples from the segment before lie behind the start: they must not wind the speed up.
                progress.speed_mm_per_s = speed.max(0.0);
            }
        }
        self.move_on(&mut progress.place, ds_mm);
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

    /// Path from a place to the projection of a position; `None` where it has none.
    fn path_to(&self, place: &Place, position: &Pose) -> Option<f32> {
        match self.course {
            Course::Arc { turn, radius_mm, .. } => {
                let [x, y] = direction_of(self.relative(position));
                let [ex, ey] = place.towards;
                let (cross, dot) = (turn * (ey * x - ex * y), -(ex * x + ey * y));
                let right_angle = if cross < 0.0 { -FRAC_PI_2 } else { FRAC_PI_2 };
                let angle_rad = if dot <= 0.0 { right_angle } else { small_angle(cross) };
                angle_rad.is_finite().then_some(radius_mm * angle_rad)
            }
            Course::Line { start, direction, .. } => {
                let [x, y, z] = position.linear;
                let [sx, sy, sz] = start;
                let [dx, dy, dz] = direction;
                let along = millimetres(x, sx) * dx + millimetres(y, sy) * dy + millimetres(z, sz) * dz;
                Some(along - place.travelled_mm)
            }
        }
    }

    fn move_on(&self, place: &mut Place, ds_mm: f32) {
        // max and min drop a NaN.
        let ds_mm = ds_mm.max(0.0).min(self.length_mm - place.travelled_mm);
        let travelled_mm = place.travelled_mm + ds_mm;
        *place = match self.course {
            Course::Arc { turn, radius_mm, .. } => {
                let [x, y] = place.towards.map(|component| -component);
                Place::on_arc(rotate([x, y], turn * ds_mm / radius_mm), turn, radius_mm, travelled_mm)
            }
            Course::Line { in_plane, .. } => Place::on_line(in_plane, travelled_mm),
        };
    }
}

fn line(segment: &Segment) -> Course {
    let [x, y, z] = segment.start.linear;
    let [to_x, to_y, to_z] = segment.end.linear;
    let length_mm = segment.length_mm() as f32;
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
