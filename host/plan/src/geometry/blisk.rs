//! A rotor with its blades in one piece.

use crate::vector::Point;

use super::face::Face;

/// A surface of revolution about the rotor's axis: its generatrix as a polyline, `[z, radius]`, z growing, mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Revolution {
    /// The generatrix.
    pub profile_mm: Vec<[f64; 2]>,
}

/// The blank, as it comes to the machine: a ring about the rotor's axis with plane faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blank {
    /// Its outer radius, mm.
    pub radius_mm: f64,
    /// Where its faces lie along the rotor's axis, lower first, mm.
    pub faces_mm: [f64; 2],
}

/// A blisk: one blade, and how often it is there. Part frame.
#[derive(Clone, Debug)]
pub struct Blisk {
    /// Blades, evenly about the axis.
    pub blades: u32,
    /// Pressure side of the first blade.
    pub pressure: Face,
    /// Suction side of the first blade.
    pub suction: Face,
    /// The gas path between the blades.
    pub hub: Revolution,
    /// What it is cut from.
    pub blank: Blank,
}

/// What a cutter finds on both sides of a slot: the pressure side of one blade and the suction side of the next. Any frame.
#[derive(Clone, Debug)]
pub struct Slot {
    /// Pressure side, u from the leading edge, v from the hub.
    pub pressure: Face,
    /// Suction side of the blade across the slot.
    pub suction: Face,
}

impl Revolution {
    /// The generatrix between two places along the axis; beyond its ends it goes on at their radii.
    pub fn between(&self, [from_mm, to_mm]: [f64; 2]) -> Vec<[f64; 2]> {
        let inner = self.profile_mm.iter().filter(|place| place[0] > from_mm && place[0] < to_mm);
        let ends = [from_mm, to_mm].map(|z| [z, self.radius_mm(z)]);
        std::iter::once(ends[0]).chain(inner.copied()).chain([ends[1]]).collect()
    }

    /// Its radius at a place along the axis, mm; beyond its ends theirs.
    pub fn radius_mm(&self, z_mm: f64) -> f64 {
        let after = self.profile_mm.iter().position(|place| place[0] >= z_mm).unwrap_or(self.profile_mm.len());
        match (after.checked_sub(1).and_then(|at| self.profile_mm.get(at)), self.profile_mm.get(after)) {
            (Some(a), Some(b)) => a[1] + (b[1] - a[1]) * (z_mm - a[0]) / (b[0] - a[0]),
            (Some(end), None) | (None, Some(end)) => end[1],
            (None, None) => 0.0,
        }
    }

    /// How far `point` lies outside of the surface, along the surface's normal, mm; negative below it.
    pub fn height_mm(&self, point: &Point) -> f64 {
        let place = [point.z, libm::hypot(point.x, point.y)];
        let nearest = self.profile_mm.windows(2).map(|pair| beside(place, pair[0], pair[1]));
        nearest.min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(f64::INFINITY)
    }
}

/// Signed distance of a place from a piece of profile, positive on its outer side.
fn beside(place: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let along = [to[0] - from[0], to[1] - from[1]];
    let way = [place[0] - from[0], place[1] - from[1]];
    let length = libm::hypot(along[0], along[1]);
    let share = ((way[0] * along[0] + way[1] * along[1]) / (length * length)).clamp(0.0, 1.0);
    let distance = libm::hypot(way[0] - share * along[0], way[1] - share * along[1]);
    let is_outside = along[0] * way[1] - along[1] * way[0] >= 0.0;
    if is_outside { distance } else { -distance }
}
