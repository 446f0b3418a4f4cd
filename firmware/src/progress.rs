//! Progress of the tool's centre on its segment, from axis positions that may be noisy, late or missing.
//!
//! The state is the path travelled, for arcs and lines alike. Each tick it advances along the segment by
//!
//! ```text
//! residual = path from the place to the sample's projection + v delay      (1)
//! ds       = v dt + alpha residual,    v += beta residual / dt             (2)
//! ```
//!
//! never backwards and never beyond the segment's end. Without a sample the residual is zero and the place advances by
//! dead reckoning. Exact samples are used directly, without the filter. The path to a sample on an arc is the sum of
//! the paths from sample to sample, so that a segment which runs back over the previous one is not confused with it.
//!
//! Source: the alpha-beta filter of tracking radars; docs/laws.md#progress.

use arcfeed_nc::modal::{Plane, Pose};
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::fmath;
use arcfeed_units::{Nm, Span, US_PER_S};

use arcfeed_law::Place;

/// Millimetres in a nanometre, for positions on the tick.
const MM_PER_NM: f32 = 1e-6;

/// Filter by which measured positions correct the computed position of the tool on its path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PositionFilter {
    /// No filter: positions are exact, not delayed, and never missing.
    Exact,
    /// Alpha-beta filter, for positions that are noisy, delayed or missing.
    AlphaBeta(AlphaBeta),
}

/// Gains of the alpha-beta filter: which fraction of the difference to a measured position corrects the computed
/// position and speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlphaBeta {
    /// Fraction of the residual that corrects the position, 0 to 1.
    alpha_ratio: f32,
    /// Fraction of the residual that corrects the speed, 0 to 1.
    beta_ratio: f32,
    /// Age of a sample when it arrives.
    delay_us: f32,
}

impl PositionFilter {
    /// Alpha-beta filter with this gain for position, 0 to 1 exclusive (small: smooth and slow), for samples that are
    /// `delay` old on arrival. The gain for speed follows from critical damping: beta = 2 (2 - alpha) - 4 sqrt(1 -
    /// alpha).
    ///
    /// `None` if the gain is not in this range.
    pub fn new(alpha_ratio: f32, delay: Span) -> Option<Self> {
        let in_range = alpha_ratio > 0.0 && alpha_ratio < 1.0;
        let beta_ratio = 2.0 * (2.0 - alpha_ratio) - 4.0 * fmath::sqrt(1.0 - alpha_ratio);
        let gains = AlphaBeta { alpha_ratio, beta_ratio, delay_us: delay.us() };
        in_range.then_some(PositionFilter::AlphaBeta(gains))
    }
}

/// Path of a segment, prepared so that the tool's progress on it can be computed at each tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    length_mm: f32,
    shape: Shape,
}

/// The tag is a byte; by default it would be as wide as the widest field and cost the tick a longer comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(u8)]
enum Shape {
    /// A circle in one plane.
    Arc(ArcTrack),
    /// Straight.
    Line(LineTrack),
}

/// An arc about its rotation centre, without the rise of a helix.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ArcTrack {
    plane: Plane,
    center: [Nm; 2],
    /// +1 counter-clockwise, -1 clockwise.
    turn: f32,
    radius_mm: f32,
    start: [f32; 2],
}

/// A line from its start.
#[derive(Clone, Copy, Debug, PartialEq)]
struct LineTrack {
    start: [Nm; 3],
    /// Unit vector of the direction.
    direction: [f32; 3],
}

/// Progress of the tool on its segment: the path travelled, and the speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// On an arc: unit vector from the rotation centre to the last sample.
    direction: [f32; 2],
    /// Path from the segment's start to the last sample's projection.
    sampled_mm: f32,
    travelled_mm: f32,
    speed_mm_per_us: f32,
}

impl Progress {
    /// Path travelled from the segment's start, mm; on a helix, in the plane of its arc.
    pub fn travelled_mm(&self) -> f32 {
        self.travelled_mm
    }

    /// Estimated speed along the path, mm/s.
    pub fn speed_mm_per_s(&self) -> f32 {
        self.speed_mm_per_us * US_PER_S as f32
    }
}

impl Track {
    /// Path of a cutting move; `None` for rapids, because the machine decides on their path.
    pub fn new(segment: &Segment) -> Option<Self> {
        let length_mm = segment.feed_length_mm() as f32;
        let shape = match &segment.path {
            Path::Rapid => return None,
            Path::Line => Shape::Line(LineTrack::new(segment, length_mm)),
            Path::Arc(arc) => Shape::Arc(ArcTrack {
                plane: arc.plane,
                center: arc.center,
                turn: f32::from(arc.turn.sign()),
                radius_mm: arc.radius_mm() as f32,
                start: direction_of(arc.from),
            }),
        };
        Some(Track { length_mm, shape })
    }

    /// Length of the path, mm; for a helix, of its arc in the plane.
    pub fn length_mm(&self) -> f32 {
        self.length_mm
    }

    /// Progress before the first sample: at the segment's start, with the speed on the previous segment.
    pub fn begin(&self, before: &Progress) -> Progress {
        let direction = self.start_direction();
        Progress { direction, speed_mm_per_us: before.speed_mm_per_us, ..Progress::default() }
    }

    /// Unit vector from an arc's rotation centre to its start; zero for a line.
    fn start_direction(&self) -> [f32; 2] {
        match &self.shape {
            Shape::Arc(arc) => arc.start,
            Shape::Line(_) => [0.0; 2],
        }
    }

    /// Places at the ends of `parts` equal parts of the path, for the evaluation of a law.
    pub fn places(&self, parts: usize) -> impl Iterator<Item = Place> {
        let part_mm = self.length_mm() / parts as f32;
        let mut direction = self.start_direction();
        (0..=parts).map(move |border| {
            let place = self.place(direction, border as f32 * part_mm);
            if let Shape::Arc(arc) = &self.shape {
                direction = rotate(direction, arc.turn * part_mm / arc.radius_mm);
            }
            place
        })
    }

    /// A place at this path from the start, for laws that use only the path: the direction is that of the start.
    pub(crate) fn place_after(&self, travelled_mm: f32) -> Place {
        self.place(self.start_direction(), travelled_mm)
    }

    fn place(&self, direction: [f32; 2], travelled_mm: f32) -> Place {
        match &self.shape {
            Shape::Arc(arc) => Place::on_arc(direction, arc.turn, arc.radius_mm, travelled_mm),
            Shape::Line(line) => {
                let [dx, dy, _] = line.direction;
                Place::on_line([dx, dy], travelled_mm)
            }
        }
    }

    /// Advances the progress by one tick of duration `dt`; `sample` is the measured position, `None` if there is no
    /// new one.
    #[inline(always)]
    pub fn advance(&self, filter: &PositionFilter, progress: &mut Progress, sample: Option<&Pose>, dt: Span) {
        if let Some(position) = sample {
            match &self.shape {
                Shape::Arc(arc) => arc.sample(progress, position),
                Shape::Line(line) => progress.sampled_mm = line.along_mm(position),
            }
        }
        let behind_mm = progress.sampled_mm - progress.travelled_mm;
        let ds_mm = match filter {
            PositionFilter::Exact => behind_mm,
            PositionFilter::AlphaBeta(gains) => {
                gains.step(&mut progress.speed_mm_per_us, sample.map(|_| behind_mm), dt)
            }
        };
        // Neither backwards nor beyond the end.
        let ahead_mm = progress.travelled_mm + fmath::max(ds_mm, 0.0);
        progress.travelled_mm = fmath::min(ahead_mm, self.length_mm);
    }
}

impl ArcTrack {
    /// Adds the path from the previous sample to this one. A sample at the rotation centre has no direction and is
    /// ignored.
    #[inline(always)]
    fn sample(&self, progress: &mut Progress, position: &Pose) {
        let direction = self.direction_to(self.in_plane(position));
        let angle_rad = small_angle(self.turn * cross(progress.direction, direction));
        if !angle_rad.is_nan() {
            progress.direction = direction;
            progress.sampled_mm += self.radius_mm * angle_rad;
        }
    }

    /// The two coordinates of a position in the plane.
    fn in_plane(&self, position: &Pose) -> [Nm; 2] {
        let [x, y, z] = position.linear;
        match self.plane {
            Plane::Xy => [x, y],
            Plane::Zx => [z, x],
            Plane::Yz => [y, z],
        }
    }

    /// Unit vector from the rotation centre to a point of the plane.
    #[inline(always)]
    fn direction_to(&self, [first, second]: [Nm; 2]) -> [f32; 2] {
        let [center_first, center_second] = self.center;
        // Wrapping: coordinates are far below 9 million kilometres, at which the difference would overflow.
        direction_of([Nm(first.0.wrapping_sub(center_first.0)), Nm(second.0.wrapping_sub(center_second.0))])
    }
}

impl LineTrack {
    fn new(segment: &Segment, length_mm: f32) -> Self {
        let [x, y, z] = segment.start.linear;
        let [to_x, to_y, to_z] = segment.end.linear;
        let part = |from, to| if length_mm > 0.0 { millimetres(to, from) / length_mm } else { 0.0 };
        let direction = [part(x, to_x), part(y, to_y), part(z, to_z)];
        LineTrack { start: segment.start.linear, direction }
    }

    /// Path from the start to the projection of a position.
    fn along_mm(&self, position: &Pose) -> f32 {
        let [x, y, z] = position.linear;
        let [sx, sy, sz] = self.start;
        let [dx, dy, dz] = self.direction;
        // Wrapping: see `ArcTrack::direction_to`.
        let [x_nm, y_nm] = fmath::from_pair([x.0.wrapping_sub(sx.0), y.0.wrapping_sub(sy.0)]);
        let [z_nm, _] = fmath::from_pair([z.0.wrapping_sub(sz.0), 0]);
        (x_nm * dx + y_nm * dy + z_nm * dz) * MM_PER_NM
    }
}

impl AlphaBeta {
    /// Returns the path to advance by in a tick, and corrects the speed.
    fn step(&self, speed_mm_per_us: &mut f32, behind_mm: Option<f32>, dt: Span) -> f32 {
        let dead_reckoned_mm = *speed_mm_per_us * dt.us();
        let Some(behind_mm) = behind_mm else { return dead_reckoned_mm };
        // Difference between the position according to the sample and the predicted position at this tick.
        let residual_mm = behind_mm + *speed_mm_per_us * self.delay_us - dead_reckoned_mm; // (1)
        if dt > Span(0) {
            let speed = *speed_mm_per_us + self.beta_ratio * residual_mm / dt.us(); // (2)
            // Late samples of the previous segment lie before the start: they must not change the speed below zero.
            *speed_mm_per_us = fmath::max(speed, 0.0);
        }
        dead_reckoned_mm + self.alpha_ratio * residual_mm // (2)
    }
}

/// Sine of the angle from one unit vector to another.
#[inline(always)]
fn cross([x, y]: [f32; 2], [to_x, to_y]: [f32; 2]) -> f32 {
    x * to_y - y * to_x
}

/// Rotates a unit vector by a small angle (up to about a radian) and keeps its length: Taylor series to the fifth
/// order, one Newton step towards length one.
fn rotate([x, y]: [f32; 2], angle_rad: f32) -> [f32; 2] {
    let square = angle_rad * angle_rad;
    let sin = angle_rad * (1.0 - square * (1.0 / 6.0 - square / 120.0));
    let cos = 1.0 - square * (0.5 - square / 24.0);
    let (turned_x, turned_y) = (x * cos - y * sin, x * sin + y * cos);
    let scale = 1.5 - 0.5 * (turned_x * turned_x + turned_y * turned_y);
    [turned_x * scale, turned_y * scale]
}

/// Angle with this sine, for small angles (error 1e-6 rad at 0.3).
fn small_angle(sine: f32) -> f32 {
    let square = sine * sine;
    sine + sine * square * (1.0 / 6.0 + square * (3.0 / 40.0))
}

/// Direction of a vector; NaN if it has no length. The scale cancels, so nanometres are converted to f32 directly.
#[inline(always)]
fn direction_of([x, y]: [Nm; 2]) -> [f32; 2] {
    let [x_nm, y_nm] = fmath::from_pair([x.0, y.0]);
    let length_nm = fmath::length(x_nm, y_nm);
    [x_nm / length_nm, y_nm / length_nm]
}

fn millimetres(a: Nm, b: Nm) -> f32 {
    a.0.saturating_sub(b.0) as f32 * MM_PER_NM
}

#[cfg(test)]
mod tests;
