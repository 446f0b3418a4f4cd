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
use arcfeed_shared::units::{Nm, Span, US_PER_S};

use crate::law::Place;

/// Millimetres in a nanometre, for positions on the tick.
const MM_PER_NM: f32 = 1e-6;
/// Below it an angle is its sine, to 2e-7 of it.
const ANGLE_IS_SINE: f32 = 1e-3;

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
    pub fn new(alpha_ratio: f32, delay: Span) -> Option<Self> {
        let in_range = alpha_ratio > 0.0 && alpha_ratio < 1.0;
        let beta_ratio = 2.0 * (2.0 - alpha_ratio) - 4.0 * fmath::sqrt(1.0 - alpha_ratio);
        let gains = AlphaBeta { alpha_ratio, beta_ratio, delay_s: seconds(delay) };
        in_range.then_some(PositionFilter::AlphaBeta(gains))
    }
}

/// A segment as progress sees it; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Track {
    /// A circle in one plane.
    Arc(ArcTrack),
    /// Straight.
    Line(LineTrack),
}

/// An arc about its rotation centre; what a helix does across the plane is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArcTrack {
    plane: Plane,
    center: [Nm; 2],
    /// +1 counter-clockwise, -1 clockwise.
    turn: f32,
    radius_mm: f32,
    start: [f32; 2],
    length_mm: f32,
}

/// A line from its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineTrack {
    start: [Nm; 3],
    /// Of unit length.
    direction: [f32; 3],
    length_mm: f32,
}

/// How far the segment is done; state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Unit vector from the rotation centre; of no meaning on a line.
    direction: [f32; 2],
    travelled_mm: f32,
    speed_mm_per_s: f32,
}

impl Progress {
    /// Path from the segment's start, of a helix in the plane of its arc; samples behind its end add to it.
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
        let length_mm = segment.feed_length_mm() as f32;
        match &segment.path {
            Path::Rapid => None,
            Path::Line => Some(Track::Line(LineTrack::new(segment, length_mm))),
            Path::Arc(arc) => Some(Track::Arc(ArcTrack {
                plane: arc.plane,
                center: arc.center,
                turn: f32::from(arc.turn.sign()),
                radius_mm: arc.radius_mm() as f32,
                start: direction_of(arc.from),
                length_mm,
            })),
        }
    }

    /// Length of the path, of a helix that of its arc in the plane, mm.
    pub fn length_mm(&self) -> f32 {
        match self {
            Track::Arc(ArcTrack { length_mm, .. }) | Track::Line(LineTrack { length_mm, .. }) => *length_mm,
        }
    }

    /// Progress before the first sample: at the start, moving at `speed_mm_per_s`.
    pub fn begin(&self, speed_mm_per_s: f32) -> Progress {
        match self {
            Track::Arc(arc) => arc.begin(speed_mm_per_s),
            Track::Line(_) => Progress { speed_mm_per_s, ..Progress::default() },
        }
    }

    /// The place reached.
    pub fn place(&self, progress: &Progress) -> Place {
        let travelled_mm = progress.travelled_mm.min(self.length_mm());
        match self {
            Track::Arc(arc) => Place::on_arc(progress.direction, arc.turn, arc.radius_mm, travelled_mm),
            Track::Line(line) => {
                let [dx, dy, _] = line.direction;
                Place::on_line([dx, dy], travelled_mm)
            }
        }
    }

    /// One tick: takes the sample, if there is one.
    pub fn advance(&self, filter: &PositionFilter, progress: &mut Progress, sample: Option<&Pose>, dt: Span) {
        if let (PositionFilter::Exact, Track::Arc(arc), Some(position)) = (filter, self, sample) {
            arc.follow(progress, arc.in_plane(position));
            return;
        }
        let behind_mm = sample.and_then(|position| self.path_to(progress, position));
        match filter {
            PositionFilter::Exact => self.move_on(progress, behind_mm.unwrap_or(0.0)),
            PositionFilter::AlphaBeta(gains) => {
                let ds_mm = gains.step(&mut progress.speed_mm_per_s, behind_mm, dt);
                self.move_on(progress, ds_mm);
            }
        }
    }

    /// Path from the progress made to the projection of a position; `None` where it has none.
    fn path_to(&self, progress: &Progress, position: &Pose) -> Option<f32> {
        match self {
            Track::Arc(arc) => arc.path_to(progress.direction, position),
            Track::Line(line) => Some(line.along_mm(position) - progress.travelled_mm),
        }
    }

    /// Moves on along the path, not beyond its end; of an arc by less than a radian.
    pub(crate) fn move_on(&self, progress: &mut Progress, ds_mm: f32) {
        // max and min drop a NaN.
        let ds_mm = ds_mm.max(0.0).min((self.length_mm() - progress.travelled_mm).max(0.0));
        progress.travelled_mm += ds_mm;
        if let Track::Arc(arc) = self {
            progress.direction = rotate(progress.direction, arc.turn * ds_mm / arc.radius_mm);
        }
    }
}

impl ArcTrack {
    /// The plane it lies in.
    pub fn plane(&self) -> Plane {
        self.plane
    }

    /// [`Track::begin`].
    #[inline(always)]
    pub fn begin(&self, speed_mm_per_s: f32) -> Progress {
        Progress { direction: self.start, travelled_mm: 0.0, speed_mm_per_s }
    }

    /// Takes an exact sample, given by its coordinates in the plane: its direction from the rotation centre, if that lies
    /// ahead. Answers the direction reached.
    #[inline(always)]
    pub fn follow(&self, progress: &mut Progress, in_plane: [Nm; 2]) -> [f32; 2] {
        let direction = self.direction_to(in_plane);
        let ahead = self.turn * cross(progress.direction, direction);
        // The bits of positive numbers are in their order, those of all others above. A sample at the rotation centre is
        // NaN, and ahead of nothing.
        if ahead.to_bits() < ANGLE_IS_SINE.to_bits() {
            progress.direction = direction;
            progress.travelled_mm += self.radius_mm * ahead;
            return direction;
        }
        self.leap(progress, direction, ahead)
    }

    /// A sample far ahead, or not ahead at all.
    #[cold]
    #[inline(never)]
    fn leap(&self, progress: &mut Progress, direction: [f32; 2], ahead: f32) -> [f32; 2] {
        if ahead > 0.0 {
            progress.direction = direction;
            progress.travelled_mm += self.radius_mm * small_angle(ahead);
        }
        progress.direction
    }

    /// The two coordinates of a position that lie in the plane.
    fn in_plane(&self, position: &Pose) -> [Nm; 2] {
        let [x, y, z] = position.linear;
        match self.plane {
            Plane::Xy => [x, y],
            Plane::Zx => [z, x],
            Plane::Yz => [y, z],
        }
    }

    /// The unit vector from the rotation centre to a point of the plane.
    #[inline(always)]
    fn direction_to(&self, [first, second]: [Nm; 2]) -> [f32; 2] {
        let [center_first, center_second] = self.center;
        // Wrapping: coordinates stay far below the 9 million kilometres at which it would.
        direction_of([Nm(first.0.wrapping_sub(center_first.0)), Nm(second.0.wrapping_sub(center_second.0))])
    }

    /// Path from the direction reached to the projection of a position; `None` at the rotation centre.
    fn path_to(&self, [ex, ey]: [f32; 2], position: &Pose) -> Option<f32> {
        let [x, y] = self.direction_to(self.in_plane(position));
        let (sine, cosine) = (self.turn * cross([ex, ey], [x, y]), ex * x + ey * y);
        let right_angle = if sine < 0.0 { -FRAC_PI_2 } else { FRAC_PI_2 };
        let angle_rad = if cosine <= 0.0 { right_angle } else { small_angle(sine) };
        angle_rad.is_finite().then_some(self.radius_mm * angle_rad)
    }
}

impl LineTrack {
    fn new(segment: &Segment, length_mm: f32) -> Self {
        let [x, y, z] = segment.start.linear;
        let [to_x, to_y, to_z] = segment.end.linear;
        let part = |from, to| if length_mm > 0.0 { millimetres(to, from) / length_mm } else { 0.0 };
        let direction = [part(x, to_x), part(y, to_y), part(z, to_z)];
        LineTrack { start: segment.start.linear, direction, length_mm }
    }

    /// Path from the start to the projection of a position.
    fn along_mm(&self, position: &Pose) -> f32 {
        let [x, y, z] = position.linear;
        let [sx, sy, sz] = self.start;
        let [dx, dy, dz] = self.direction;
        millimetres(x, sx) * dx + millimetres(y, sy) * dy + millimetres(z, sz) * dz
    }
}

impl AlphaBeta {
    /// The path to move on by in a tick, and the speed corrected.
    fn step(&self, speed_mm_per_s: &mut f32, behind_mm: Option<f32>, dt: Span) -> f32 {
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

fn seconds(span: Span) -> f32 {
    span.us() / US_PER_S as f32
}

#[cfg(test)]
mod tests;
