//! Splitter blade: its place in the pitch of the main blades.
//!
//! A point of the splitter is compared with the place of a main blade's side that has the same distance from the rotor's axis and the same
//! position along it. At all points the splitter must be ahead of the main blade and behind the main blade's next copy. This also finds a
//! splitter that lies inside the main blade, where no surfaces cross.

use core::f64::consts::TAU;

use nalgebra::Rotation3;
use thiserror::Error;

use crate::search::{Minimum, descend};
use crate::vector::{Point, Vector};

use super::blisk::Blade;
use super::blisk::Blisk;
use super::face::Face;
use super::flaws::{BladeSide, shown};

/// Samples of the splitter's sides along u and v.
const SAMPLES: [i32; 2] = [12, 6];
/// Samples of the main blade's sides, from which the nearest place is searched.
const STARTS: [i32; 2] = [24, 8];

/// Crossing of a splitter with a main blade.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "the splitter crosses a main blade by {by_mm:.3} mm at {} of the splitter's {side}; it must stand between two main blades: `blades` is the number \
     of main blades, and a second copy of the main blade is to be left out", shown(*at)
)]
pub struct Crossing {
    /// Side of the splitter.
    pub side: BladeSide,
    /// Position on that side: u from the leading edge, v from the hub.
    pub at: [f64; 2],
    /// Distance about the axis by which the splitter is on the wrong side of the main blade, mm.
    pub by_mm: f64,
}

/// Sample of the splitter's surface.
struct Sample {
    side: BladeSide,
    at: [f64; 2],
    radius_mm: f64,
    /// Angles by which it is ahead of the main blade, and of the main blade's back.
    ahead_rad: [f64; 2],
}

impl Blisk {
    /// The rotor, whose blades are all alike, with a splitter in each pitch. It may be given in any pitch.
    ///
    /// # Errors
    /// The splitter crosses a main blade.
    pub fn with_splitter(self, splitter: &Blade) -> Result<Self, Crossing> {
        let pitch_rad = self.pitch_rad();
        let samples = self.samples(splitter);
        let mean_rad = samples.iter().map(|sample| sample.ahead_rad[0]).sum::<f64>() / samples.len() as f64;
        let turn_rad = -libm::floor(mean_rad / pitch_rad) * pitch_rad;
        let beyond_mm = |sample: &Sample| {
            let [ahead_rad, back_rad] = sample.ahead_rad.map(|rad| rad + turn_rad);
            (-ahead_rad).max(back_rad - pitch_rad) * sample.radius_mm
        };
        let worst = samples.iter().map(|sample| (sample, beyond_mm(sample))).max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((Sample { side, at, .. }, by_mm)) = worst.filter(|(_, by_mm)| *by_mm >= 0.0) {
            return Err(Crossing { side: *side, at: *at, by_mm });
        }
        let further_blades = vec![splitter.turned(&Rotation3::from_axis_angle(&Vector::z_axis(), turn_rad))];
        Ok(Blisk { further_blades, ..self })
    }

    fn samples(&self, splitter: &Blade) -> Vec<Sample> {
        let mut around = [&self.pressure, &self.suction].map(Around::new);
        if self.facing() < 0 {
            around.swap(0, 1);
        }
        let share = |k: i32, count: i32| f64::from(k) / f64::from(count);
        let places = (0..=SAMPLES[0]).flat_map(|i| (0..=SAMPLES[1]).map(move |j| [i, j]));
        let places = places.map(|[i, j]| [share(i, SAMPLES[0]), share(j, SAMPLES[1])]);
        let sides = [(BladeSide::Pressure, &splitter.pressure), (BladeSide::Suction, &splitter.suction)];
        let mut samples: Vec<Sample> = Vec::new();
        for (at, (side, face)) in places.flat_map(|at| sides.map(|side| (at, side))) {
            let point = face.point(at[0], at[1]);
            // A turn of the whole circle apart, angles are the same; those of one blade are not far from each other.
            let near = samples.first().map_or([0.0; 2], |first| first.ahead_rad);
            let ahead_rad =
                [0, 1].map(|k: usize| near[k] + libm::remainder(around[k].ahead_rad(&point) - near[k], TAU));
            samples.push(Sample { side, at, radius_mm: libm::hypot(point.x, point.y), ahead_rad });
        }
        samples
    }
}

/// Side of a blade, with samples of it.
struct Around<'f> {
    face: &'f Face,
    starts: Vec<([f64; 2], [f64; 2])>,
}

impl<'f> Around<'f> {
    fn new(face: &'f Face) -> Self {
        let share = |k: i32, count: i32| f64::from(k) / f64::from(count);
        let places = (0..=STARTS[0]).flat_map(|i| (0..=STARTS[1]).map(move |j| [i, j]));
        let places = places.map(|[i, j]| [share(i, STARTS[0]), share(j, STARTS[1])]);
        Around { face, starts: places.map(|at| (at, meridional(&face.point(at[0], at[1])))).collect() }
    }

    /// Angle about the axis by which a point is ahead of the side at the same distance from the axis and position along it, or as near to that as the
    /// side extends.
    fn ahead_rad(&self, point: &Point) -> f64 {
        let [z, radius] = meridional(point);
        let square = |place: [f64; 2]| (place[0] - z) * (place[0] - z) + (place[1] - radius) * (place[1] - radius);
        let starts = self.starts.iter().map(|(at, place)| Minimum { at: *at, value: square(*place) });
        let start = starts.min_by(|a, b| a.value.total_cmp(&b.value)).unwrap_or(Minimum { at: [0.5; 2], value: 0.0 });
        let spacing = STARTS.map(|count| 1.0 / f64::from(count));
        let found = descend([[0.0, 1.0]; 2], start, spacing, |[u, v]| square(meridional(&self.face.point(u, v))));
        let beside = self.face.point(found.at[0], found.at[1]);
        libm::atan2(point.y, point.x) - libm::atan2(beside.y, beside.x)
    }
}

/// Position along the axis, and distance from it.
fn meridional(point: &Point) -> [f64; 2] {
    [point.z, libm::hypot(point.x, point.y)]
}
