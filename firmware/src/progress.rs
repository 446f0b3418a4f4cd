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
//! dead reckoning. alpha = 1, beta = 0, delay = 0 follows the samples as they come. Because only the path from the place
//! counts, a segment that runs back over the one before cannot catch it.
//!
//! Source: the alpha-beta filter of tracking radars; docs/laws.md#progress.

use arcfeed_shared::fmath;
use arcfeed_shared::nc::modal::{Plane, Pose};
use arcfeed_shared::segment::{Path, Segment};
use arcfeed_shared::units::{Micros, Nm, US_PER_S};

use crate::law::Place;

/// Millimetres in a nanometre, for positions on the tick.
const MM_PER_NM: f32 = 1e-6;

/// How samples of the position are trusted; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionFilter {
    /// Part of the residual taken up at once, 0 to 1.
    alpha_ratio: f32,
    /// Part of the residual that corrects the speed, 0 to 1.
    beta_ratio: f32,
    /// Age of a sample when it arrives, s.
    delay_s: f32,
}

impl PositionFilter {
    /// Samples as they are: no noise, no delay.
    pub const EXACT: PositionFilter = PositionFilter { alpha_ratio: 1.0, beta_ratio: 0.0, delay_s: 0.0 };

    /// A filter with the given gain (0 to 1 exclusive; small: smooth and slow) for samples that are `delay` old.
    /// The speed's gain follows for critical damping: beta = 2 (2 - alpha) - 4 sqrt(1 - alpha).
    ///
    /// `None` if the gain is out of range.
    pub fn new(alpha_ratio: f32, delay: Micros) -> Option<Self> {
        let in_range = alpha_ratio > 0.0 && alpha_ratio < 1.0;
        let beta_ratio = 2.0 * (2.0 - alpha_ratio) - 4.0 * fmath::sqrt(1.0 - alpha_ratio);
        in_range.then_some(PositionFilter { alpha_ratio, beta_ratio, delay_s: seconds(delay) })
    }
}

/// A segment as progress sees it; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    axes: [usize; 2],
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
                let start = unit(arc.from).unwrap_or([1.0, 0.0]);
                let turn = f32::from(arc.turn.sign());
                (arc.plane, arc.center, Course::Arc { turn, radius_mm: arc.radius_mm() as f32, start })
            }
        };
        let (first, second, _) = plane.axes();
        Some(Track { axes: [first, second], origin, course, length_mm: segment.length_mm() as f32 })
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
    pub fn advance<'p>(
        &self,
        filter: &PositionFilter,
        progress: &'p mut Progress,
        sample: Option<&Pose>,
        dt: Micros,
    ) -> &'p Place {
        let dt_s = seconds(dt);
        let mut ds_mm = progress.speed_mm_per_s * dt_s;
        let behind_mm = sample.and_then(|position| self.path_to(&progress.place, position));
        if let Some(behind_mm) = behind_mm {
            // What the place will have reached at this tick, against where the sample says it was by now.
            let residual_mm = behind_mm + progress.speed_mm_per_s * filter.delay_s - ds_mm; // (1)
            ds_mm += filter.alpha_ratio * residual_mm; // (2)
            if dt_s > 0.0 {
                let speed = progress.speed_mm_per_s + filter.beta_ratio * residual_mm / dt_s; // (2)
                // Late samples from the segment before lie behind the start: they must not wind the speed up.
                progress.speed_mm_per_s = speed.max(0.0);
            }
        }
        self.move_on(&mut progress.place, ds_mm);
        &progress.place
    }

    /// Path from a place to the projection of a position; `None` where it has none.
    fn path_to(&self, place: &Place, position: &Pose) -> Option<f32> {
        match self.course {
            Course::Arc { turn, radius_mm, .. } => {
                let [first, second] = self.axes;
                let axis = |index: usize| position.linear.get(index).copied().unwrap_or_default();
                let relative = subtract([axis(first), axis(second)], self.origin);
                let [x, y] = unit(relative)?;
                let [ex, ey] = place.towards;
                // The place's direction from A is minus its direction towards A.
                let (cross, dot) = (turn * (ey * x - ex * y), -(ex * x + ey * y));
                Some(radius_mm * small_angle(cross, dot))
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

/// The angle with this sine and the sign of this cosine, for small ones; beyond a right angle, a right angle.
fn small_angle(sine: f32, cosine: f32) -> f32 {
    if cosine <= 0.0 {
        return if sine < 0.0 { -core::f32::consts::FRAC_PI_2 } else { core::f32::consts::FRAC_PI_2 };
    }
    let square = sine * sine;
    sine * (1.0 + square * (1.0 / 6.0 + square * (3.0 / 40.0)))
}

/// The direction of a vector; the scale cancels, so nanometres go into f32 as they are.
fn unit([x, y]: [Nm; 2]) -> Option<[f32; 2]> {
    let (x_nm, y_nm) = (x.0 as f32, y.0 as f32);
    let length_nm = fmath::length(x_nm, y_nm);
    let scale = 1.0 / length_nm;
    (length_nm > 0.0).then_some([x_nm * scale, y_nm * scale])
}

fn subtract([ax, ay]: [Nm; 2], [bx, by]: [Nm; 2]) -> [Nm; 2] {
    [Nm(ax.0.saturating_sub(bx.0)), Nm(ay.0.saturating_sub(by.0))]
}

fn millimetres(a: Nm, b: Nm) -> f32 {
    a.0.saturating_sub(b.0) as f32 * MM_PER_NM
}

fn seconds(span: Micros) -> f32 {
    // 32 bits hold an hour, and convert in one instruction.
    u32::try_from(span.0).unwrap_or(u32::MAX) as f32 * (1.0 / US_PER_S as f32)
}

#[cfg(test)]
mod tests;
