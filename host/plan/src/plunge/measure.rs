//! Twist and bend of a curve on a blade.
//!
//! ```text
//! c1 = P_m - P_0,  c2 = P_1 - P_m
//! twist = max(phi, phi'),  phi = acos(|c1.z| / |c1|),  phi' = acos(|c2.z| / |c2|)          (1)
//! bend  = angle(c1, c2),   sag = greatest distance of the curve from the line P_0 P_1      (2)
//! ```
//!
//! P_m is the point of greatest curvature, smoothed over 5 % of the length, if that curvature is clearly greater than the mean and lies inside of the curve;
//! otherwise the point farthest from the chord. The smoothed curvature is greatest where the curvatures half a window before and behind are equal.
//!
//! Source: An Luling et al., *Five-axis plunge milling tool path generation of integral impellers*: its "twist" and "bending". It splits at the point of
//! greatest curvature, which an arc does not have, and calls both the sag and the angle of the chords bending: we report both, for both splits.

use crate::vector::{Point, Vector};

/// Pieces in which a curve is searched.
const PIECES: usize = 512;
/// Halvings that exhaust the precision of a parameter.
const HALVINGS: i32 = 60;
/// Width of the smoothing window over the curve's length.
const WINDOW_RATIO: f64 = 0.05;
/// Least ratio of the greatest to the mean curvature at which the curve is split there.
const PEAK_RATIO: f64 = 1.2;
/// Least distance of that place from both ends, over the curve's length.
const INSIDE_RATIO: f64 = 0.1;

/// Point of a curve with the first and second derivatives by its parameter.
#[derive(Clone, Copy, Debug)]
pub struct CurveJet {
    /// Point.
    pub point: Point,
    /// First derivative.
    pub first: Vector,
    /// Second derivative.
    pub second: Vector,
}

/// Point at which a curve is divided into two chords.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// Parameter of the curve.
    pub at: f64,
    /// Position P_m of the point.
    pub point: Point,
}

/// Angles of the two chords of a divided curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChordAngles {
    /// Angles phi and phi' of the two chords with the rotor's axis, 0 to a quarter turn.
    pub to_axis_rad: [f64; 2],
    /// Angle psi between the two chords.
    pub bend_rad: f64,
}

/// Shape of a curve on a blade, as far as plunging depends on it.
#[derive(Clone, Copy, Debug)]
pub struct CurveShape {
    /// Both ends of the curve.
    pub ends: [Point; 2],
    /// Division at the greatest curvature; `None` if it is not clearly greater than the mean, or lies at an end.
    pub by_curvature: Option<Split>,
    /// Division at the point farthest from the chord.
    pub by_chord: Split,
    /// Greatest distance of the curve from the chord's line, mm.
    pub sag_mm: f64,
}

impl ChordAngles {
    /// Angles of the chords between three points.
    pub fn new(first: &Point, middle: &Point, last: &Point) -> Self {
        let chords = [middle - first, last - middle];
        let to_axis_rad = chords.map(|chord| libm::atan2(libm::hypot(chord.x, chord.y), chord.z.abs())); // (1)
        let bend_rad = libm::atan2(chords[0].cross(&chords[1]).norm(), chords[0].dot(&chords[1])); // (2)
        ChordAngles { to_axis_rad, bend_rad }
    }

    /// Twist: the larger angle of a chord with the rotor's axis, rad. (1)
    pub fn twist_rad(&self) -> f64 {
        self.to_axis_rad[0].max(self.to_axis_rad[1])
    }
}

impl CurveShape {
    /// Shape of a curve over a range of its parameter.
    pub fn new(range: [f64; 2], curve: impl Fn(f64) -> CurveJet) -> Self {
        let place = |share: f64| range[0] + (range[1] - range[0]) * share;
        let ends = range.map(|t| curve(t).point);
        let along = (ends[1] - ends[0]).try_normalize(0.0).unwrap_or_else(Vector::zeros);
        let off = |point: &Point| {
            let way = point - ends[0];
            way - along * way.dot(&along)
        };
        let samples: Vec<f64> = (0..=PIECES).map(|k| place(k as f64 / PIECES as f64)).collect();
        let farthest = greatest(samples.iter().map(|t| off(&curve(*t).point).norm_squared()));
        let grows = |t: f64| {
            let jet = curve(t);
            off(&jet.point).dot(&jet.first)
        };
        let at = turning(grows, neighbours(&samples, farthest)).unwrap_or(samples[farthest]);
        let by_chord = Split { at, point: curve(at).point };
        let by_curvature = peak(&samples, &curve).map(|at| Split { at, point: curve(at).point });
        CurveShape { ends, by_curvature, by_chord, sag_mm: off(&by_chord.point).norm() }
    }

    /// Angles of the two chords into which this point divides the curve.
    pub fn angles(&self, split: &Split) -> ChordAngles {
        ChordAngles::new(&self.ends[0], &split.point, &self.ends[1])
    }

    /// Distance of a split's point from the chord's line, mm.
    pub fn off_chord_mm(&self, split: &Split) -> f64 {
        let along = (self.ends[1] - self.ends[0]).try_normalize(0.0).unwrap_or_else(Vector::zeros);
        (split.point - self.ends[0]).cross(&along).norm()
    }

    /// Division at the greatest curvature if there is one, otherwise at the point farthest from the chord.
    pub fn split(&self) -> Split {
        self.by_curvature.unwrap_or(self.by_chord)
    }
}

/// Index of the greatest value.
fn greatest(values: impl Iterator<Item = f64>) -> usize {
    values.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(at, _)| at)
}

fn neighbours(samples: &[f64], at: usize) -> [f64; 2] {
    [samples[at.saturating_sub(1)], samples[(at + 1).min(samples.len() - 1)]]
}

/// Place in a range where a function falls from positive to negative; `None` if it does not.
fn turning(grows: impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> Option<f64> {
    if !(grows(low) > 0.0 && grows(high) < 0.0) {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = (low + high) / 2.0;
        if grows(middle) > 0.0 { low = middle } else { high = middle }
    }
    Some((low + high) / 2.0)
}

fn curvature_per_mm(jet: &CurveJet) -> f64 {
    let speed = jet.first.norm();
    jet.first.cross(&jet.second).norm() / (speed * speed * speed)
}

/// Place of the greatest smoothed curvature, if it is a peak inside of the curve.
fn peak(samples: &[f64], curve: &impl Fn(f64) -> CurveJet) -> Option<f64> {
    let lengths_mm = lengths(samples, curve);
    let whole_mm = *lengths_mm.last()?;
    let half_mm = whole_mm * WINDOW_RATIO / 2.0;
    // Parameter after a length of the curve.
    let at_length = |length_mm: f64| {
        let index = lengths_mm.partition_point(|known_mm| *known_mm <= length_mm).clamp(1, samples.len() - 1) - 1;
        let mut t = samples[index];
        for _ in 0..4 {
            let jet = curve(t);
            t += (length_mm - lengths_mm[index] - piece_mm(samples[index], t, curve)) / jet.first.norm();
        }
        t
    };
    let at = |length_mm: f64| curvature_per_mm(&curve(at_length(length_mm)));
    let turned: Vec<f64> = turned_rad(samples, &lengths_mm, curve);
    let smooth = |length_mm: f64| {
        let angle_at = |length_mm: f64| interpolated(&lengths_mm, &turned, length_mm);
        (angle_at(length_mm + half_mm) - angle_at(length_mm - half_mm)) / (2.0 * half_mm)
    };
    let inner: Vec<f64> = lengths_mm.iter().copied().filter(|at| *at >= half_mm && *at <= whole_mm - half_mm).collect();
    let best = greatest(inner.iter().map(|length_mm| smooth(*length_mm)));
    let mean = *turned.last()? / whole_mm;
    let place_mm = *inner.get(best)?;
    let margin_mm = INSIDE_RATIO * whole_mm;
    if smooth(place_mm) <= PEAK_RATIO * mean || place_mm < margin_mm || place_mm > whole_mm - margin_mm {
        return None;
    }
    let exact_mm = turning(|place_mm| at(place_mm + half_mm) - at(place_mm - half_mm), neighbours(&inner, best));
    Some(at_length(exact_mm.unwrap_or(place_mm)))
}

/// Length of the curve between two parameters, by Simpson's rule.
fn piece_mm(from: f64, to: f64, curve: &impl Fn(f64) -> CurveJet) -> f64 {
    let speed = |t: f64| curve(t).first.norm();
    (to - from) / 6.0 * (speed(from) + 4.0 * speed((from + to) / 2.0) + speed(to))
}

fn lengths(samples: &[f64], curve: &impl Fn(f64) -> CurveJet) -> Vec<f64> {
    let pieces = samples.windows(2).scan(0.0, |sum_mm, pair| {
        *sum_mm += piece_mm(pair[0], pair[1], curve);
        Some(*sum_mm)
    });
    std::iter::once(0.0).chain(pieces).collect()
}

/// Integral of the curvature over the length, up to each sample.
fn turned_rad(samples: &[f64], lengths_mm: &[f64], curve: &impl Fn(f64) -> CurveJet) -> Vec<f64> {
    let curvatures: Vec<f64> = samples.iter().map(|t| curvature_per_mm(&curve(*t))).collect();
    let pieces = curvatures.windows(2).zip(lengths_mm.windows(2)).scan(0.0, |sum, (curvature, length)| {
        *sum += (curvature[0] + curvature[1]) / 2.0 * (length[1] - length[0]);
        Some(*sum)
    });
    std::iter::once(0.0).chain(pieces).collect()
}

fn interpolated(places: &[f64], values: &[f64], place: f64) -> f64 {
    let index = places.partition_point(|known| *known <= place).clamp(1, places.len() - 1);
    let share = (place - places[index - 1]) / (places[index] - places[index - 1]);
    values[index - 1] + (values[index] - values[index - 1]) * share
}
