//! Bladed rotor in one piece.

use crate::vector::{Point, Vector};

use super::face::Face;

/// Surface of revolution about the rotor's axis: its generatrix as a polyline, `[z, radius]`, with increasing z, mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Revolution {
    /// Generatrix.
    pub profile_mm: Vec<[f64; 2]>,
}

/// Blank: a ring about the rotor's axis with plane faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blank {
    /// Outer radius, mm.
    pub radius_mm: f64,
    /// Places of the faces along the rotor's axis, lower first, mm.
    pub faces_mm: [f64; 2],
}

/// Blisk: one blade and the number of blades. Part frame.
#[derive(Clone, Debug)]
pub struct Blisk {
    /// Number of blades, evenly about the axis.
    pub blades: u32,
    /// Pressure side of the first blade.
    pub pressure: Face,
    /// Suction side of the first blade.
    pub suction: Face,
    /// Gas path between the blades.
    pub hub: Revolution,
    /// Blank.
    pub blank: Blank,
}

/// Both sides of a slot: the pressure side of one blade and the suction side of the next. Any frame.
#[derive(Clone, Debug)]
pub struct Slot {
    /// Pressure side, u from the leading edge, v from the hub.
    pub pressure: Face,
    /// Suction side of the blade across the slot.
    pub suction: Face,
}

impl Revolution {
    /// Radius at a place along the axis, mm; beyond the ends that of the end.
    pub fn radius_mm(&self, z_mm: f64) -> f64 {
        let pieces = self.profile_mm.windows(2);
        let at = pieces.clone().find(|pair| z_mm <= pair[1][0]).or_else(|| pieces.last());
        at.map_or(0.0, |pair| {
            let [[from, low], [to, high]] = [pair[0], pair[1]];
            let share = if to > from { ((z_mm - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
            low + (high - low) * share
        })
    }

    /// Unit normal at the point of the surface nearest to `point`, away from the axis.
    pub fn normal(&self, point: &Point) -> Vector {
        let radius_mm = libm::hypot(point.x, point.y);
        let place = [point.z, radius_mm];
        let pieces = self.profile_mm.windows(2);
        let nearest = pieces.min_by(|a, b| {
            let off = |pair: &[[f64; 2]]| beside(place, pair[0], pair[1]).abs();
            off(a).total_cmp(&off(b))
        });
        let [from, to] = nearest.map_or([[0.0, 0.0], [1.0, 0.0]], |pair| [pair[0], pair[1]]);
        let (along, up) = (to[0] - from[0], to[1] - from[1]);
        Vector::new(point.x / radius_mm * along, point.y / radius_mm * along, -up).normalize()
    }

    /// Height of `point` above the surface, along the surface's normal, mm; negative below it.
    pub fn height_mm(&self, point: &Point) -> f64 {
        let place = [point.z, libm::hypot(point.x, point.y)];
        let nearest = self.profile_mm.windows(2).map(|pair| beside(place, pair[0], pair[1]));
        nearest.min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(f64::INFINITY)
    }

    /// Generatrix between two places along the axis, extended beyond its ends with their radii.
    pub fn between(&self, faces_mm: [f64; 2]) -> Vec<[f64; 2]> {
        let [from, to] = faces_mm.map(|z| [z, self.radius_mm(z)]);
        let inner = self.profile_mm.iter().filter(|place| place[0] > from[0] && place[0] < to[0]);
        std::iter::once(from).chain(inner.copied()).chain([to]).collect()
    }
}

/// Signed distance of a place from a piece of the profile, positive on its outer side.
fn beside(place: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let along = [to[0] - from[0], to[1] - from[1]];
    let way = [place[0] - from[0], place[1] - from[1]];
    let length = libm::hypot(along[0], along[1]);
    let share = ((way[0] * along[0] + way[1] * along[1]) / (length * length)).clamp(0.0, 1.0);
    let distance = libm::hypot(way[0] - share * along[0], way[1] - share * along[1]);
    let is_outside = along[0] * way[1] - along[1] * way[0] >= 0.0;
    if is_outside { distance } else { -distance }
}
