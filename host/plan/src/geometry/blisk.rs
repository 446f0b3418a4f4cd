//! Bladed rotor in one piece.

use crate::vector::{Point, Vector};

use super::face::Face;

/// Surface of revolution about the rotor's axis, given by its generatrix.
#[derive(Clone, Debug, PartialEq)]
pub struct Revolution {
    /// Generatrix as a polyline of points `[z, radius]`, mm, with increasing z.
    pub profile_mm: Vec<[f64; 2]>,
}

/// Blank: a ring about the rotor's axis with plane faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blank {
    /// Outer radius, mm.
    pub radius_mm: f64,
    /// Positions of the two faces along the rotor's axis, the lower first, mm.
    pub faces_mm: [f64; 2],
}

/// Pressure and suction side of one blade of a rotor.
#[derive(Clone, Debug)]
pub struct Blade {
    /// Concave side.
    pub pressure: Face,
    /// Convex side.
    pub suction: Face,
}

/// Blisk (bladed disk in one piece): the blades of one pitch, the number of pitches, hub and blank, in the rotor's own frame.
#[derive(Clone, Debug)]
pub struct Blisk {
    /// Number of copies of the first blade, evenly about the axis: the number of pitches.
    pub blades: u32,
    /// Pressure side of the first blade.
    pub pressure: Face,
    /// Suction side of the first blade.
    pub suction: Face,
    /// Blades of other kinds between the first blade and its next copy, by growing angle; empty if all blades are alike.
    pub further_blades: Vec<Blade>,
    /// Surface between the blades, on which the gas flows.
    pub hub: Revolution,
    /// Blank from which the blisk is milled.
    pub blank: Blank,
}

/// Slot between two blades: the pressure side of one blade and the suction side of the next, both in one frame.
#[derive(Clone, Debug)]
pub struct Slot {
    /// Pressure side of one blade; u from the leading edge, v from the hub.
    pub pressure: Face,
    /// Suction side of the next blade, across the slot.
    pub suction: Face,
}

impl Revolution {
    /// Radius at a position along the axis, mm; beyond the ends, the radius of the end.
    pub fn radius_mm(&self, z_mm: f64) -> f64 {
        self.piece(z_mm).map_or(0.0, |at| {
            let [[from, low], [to, high]] = [self.profile_mm[at], self.profile_mm[at + 1]];
            let share = if to > from { ((z_mm - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
            low + (high - low) * share
        })
    }

    /// Unit normal at the point of the surface nearest to `point`, away from the axis.
    pub fn normal(&self, point: &Point) -> Vector {
        let radius_mm = libm::hypot(point.x, point.y);
        let nearest = self.nearest([point.z, radius_mm]);
        let [from, to] = nearest.map_or([[0.0, 0.0], [1.0, 0.0]], |at| [self.profile_mm[at], self.profile_mm[at + 1]]);
        let (along, up) = (to[0] - from[0], to[1] - from[1]);
        Vector::new(point.x / radius_mm * along, point.y / radius_mm * along, -up).normalize()
    }

    /// Height of `point` above the surface, along the surface's normal, mm; negative below it.
    pub fn height_mm(&self, point: &Point) -> f64 {
        let place = [point.z, libm::hypot(point.x, point.y)];
        let nearest = self.nearest(place);
        nearest.map_or(f64::INFINITY, |at| beside(place, self.profile_mm[at], self.profile_mm[at + 1]))
    }

    /// First piece of the profile that does not end before a place along the axis; the last one beyond its end.
    fn piece(&self, z_mm: f64) -> Option<usize> {
        let last = self.profile_mm.len().checked_sub(2)?;
        Some(self.profile_mm[1..].partition_point(|end| end[0] < z_mm).min(last))
    }

    /// Piece of the profile nearest to a place; of equally near ones the first.
    fn nearest(&self, place: [f64; 2]) -> Option<usize> {
        let start = self.piece(place[0])?;
        let mut best = (f64::INFINITY, start);
        // The pieces lie side by side along the axis: outwards from the place, until they are farther off than the nearest one.
        let mut is_nearer = |at: usize| {
            let [from, to] = [self.profile_mm[at], self.profile_mm[at + 1]];
            let off_mm = (from[0] - place[0]).max(place[0] - to[0]).max(0.0);
            let square = square_mm2(place, from, to);
            if square < best.0 || (square <= best.0 && at < best.1) {
                best = (square, at);
            }
            off_mm * off_mm <= best.0
        };
        let _ = (0..=start).rev().all(&mut is_nearer);
        let _ = (start + 1..self.profile_mm.len() - 1).all(&mut is_nearer);
        Some(best.1)
    }

    /// Generatrix between two positions along the axis; beyond its ends the radius stays that of the end.
    pub fn between(&self, faces_mm: [f64; 2]) -> Vec<[f64; 2]> {
        let [from, to] = faces_mm.map(|z| [z, self.radius_mm(z)]);
        let inner = self.profile_mm.iter().filter(|place| place[0] > from[0] && place[0] < to[0]);
        std::iter::once(from).chain(inner.copied()).chain([to]).collect()
    }
}

/// Vector to a place from the point of a piece of the profile that is nearest to it.
fn away(place: [f64; 2], from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    let along = [to[0] - from[0], to[1] - from[1]];
    let way = [place[0] - from[0], place[1] - from[1]];
    let share = (way[0] * along[0] + way[1] * along[1]) / (along[0] * along[0] + along[1] * along[1]);
    let share = share.clamp(0.0, 1.0);
    [way[0] - share * along[0], way[1] - share * along[1]]
}

/// Squared distance of a place from a piece of the profile.
fn square_mm2(place: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let [z, radius] = away(place, from, to);
    z * z + radius * radius
}

/// Signed distance of a place from a piece of the profile, positive on its outer side.
fn beside(place: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let [z, radius] = away(place, from, to);
    let is_outside = (to[0] - from[0]) * (place[1] - from[1]) - (to[1] - from[1]) * (place[0] - from[0]) >= 0.0;
    let distance = libm::hypot(z, radius);
    if is_outside { distance } else { -distance }
}
