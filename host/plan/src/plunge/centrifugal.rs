//! Plunging along the normals of a hub that turns from the rotor's axis, as those of centrifugal wheels do.
//!
//! ```text
//! plane at a place s of the hub's generatrix: through its normal and the circumference there           (1)
//! ```
//!
//! Planes across the rotor's axis do not cut such a passage usefully where the hub's normal is nearly axial (E7): this family is taken if the normal leans by
//! more than 45 degrees from them anywhere along the blades. The generatrix is a polyline: its normal is that of a chord of some length, so that the
//! planes turn evenly. Our own.

use crate::geometry::blisk::Blisk;
use crate::vector::{Point, Vector};

use super::faces::{has_room, largest_radius_mm, touched};
use super::infeasibility::PlungeInfeasible;
use super::material::exit_mm;
use super::mill::PlungeMill;
use super::passage::Passage;
use super::section::{Midway, PlungeSection, SectionFamily, SectionHeights, SectionPlane, boundary};

/// Half of the chord whose normal is that of the hub, mm.
const CHORD_MM: f64 = 1.0;
/// Points of a tip curve.
const TIP_POINTS: u32 = 80;
/// Share of radius and allowance by which planes go beyond the blades.
const REACH_RATIO: f64 = 0.9;
/// Precision of the first and the last plane, mm.
const BORDER_MM: f64 = 0.05;
/// Planes in which the largest mill is sought.
const LOOKS: u32 = 9;

/// Planes through the hub's normals, by the length of its generatrix.
pub struct HubFamily<'p> {
    /// Passage.
    pub passage: &'p Passage<'p>,
    /// Places between its blades.
    pub midway: &'p Midway,
    /// Generatrix within the blank, and its length up to each of its points, mm.
    path_mm: Vec<([f64; 2], f64)>,
}

/// Whether the hub leans by more than 45 degrees from planes across the rotor's axis somewhere along the blades.
pub fn is_centrifugal(blisk: &Blisk, [from_mm, to_mm]: [f64; 2]) -> bool {
    let profile = blisk.hub.between([from_mm, to_mm]);
    profile.windows(2).any(|ends| (ends[1][1] - ends[0][1]).abs() > ends[1][0] - ends[0][0])
}

impl<'p> HubFamily<'p> {
    /// Family of a passage.
    pub fn new(passage: &'p Passage<'p>, midway: &'p Midway) -> Self {
        let blank = &passage.blisk.blank;
        let mut path_mm: Vec<([f64; 2], f64)> = Vec::new();
        for place in passage.blisk.hub.between(blank.faces_mm) {
            let way_mm = path_mm.last().map_or(0.0, |(last, way_mm)| way_mm + apart_mm(*last, place));
            path_mm.push((place, way_mm));
        }
        HubFamily { passage, midway, path_mm }
    }

    /// Lengths of the generatrix at the first and the last plane, mm: beyond both edges of the blades by as much as walls reach, within the blank.
    pub fn range_mm(&self) -> [f64; 2] {
        let Passage { blisk, mill, needs, .. } = self.passage;
        let reach_mm = REACH_RATIO * (mill.radius_mm + needs.allowance_mm);
        let root = |u: f64| {
            let point = blisk.pressure.point(u, 0.0);
            self.length_at_mm([point.z, libm::hypot(point.x, point.y)])
        };
        let (one, other) = (root(0.0), root(1.0));
        let end_mm = self.path_mm.last().map_or(0.0, |(_, way_mm)| *way_mm);
        let ends_mm = [one.min(other), one.max(other)];
        let beyond_mm = [(ends_mm[0] - reach_mm).max(0.0), (ends_mm[1] + reach_mm).min(end_mm)];
        [0, 1].map(|end| self.last_walled_mm(ends_mm[end], beyond_mm[end]))
    }

    /// Farthest place from one towards another whose plane has both walls: beside few blades, their edges lie far below it.
    fn last_walled_mm(&self, from_mm: f64, to_mm: f64) -> f64 {
        if self.at(to_mm).is_ok() {
            return to_mm;
        }
        let (mut inside, mut outside) = (from_mm, to_mm);
        while (inside - outside).abs() > BORDER_MM {
            let middle = f64::midpoint(inside, outside);
            if self.at(middle).is_ok() { inside = middle } else { outside = middle }
        }
        inside
    }

    /// Length up to the point of the generatrix nearest to a place.
    fn length_at_mm(&self, place: [f64; 2]) -> f64 {
        let on_piece = |ends: &[([f64; 2], f64)]| {
            let ((from, way_mm), (to, _)) = (ends[0], ends[1]);
            let along = [to[0] - from[0], to[1] - from[1]];
            let square = along[0] * along[0] + along[1] * along[1];
            let share = (((place[0] - from[0]) * along[0] + (place[1] - from[1]) * along[1]) / square).clamp(0.0, 1.0);
            let off_mm = apart_mm(place, [from[0] + along[0] * share, from[1] + along[1] * share]);
            (off_mm, way_mm + share * libm::sqrt(square))
        };
        let pieces = self.path_mm.windows(2).map(on_piece);
        pieces.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, way_mm)| way_mm)
    }

    /// Place of the generatrix at a length of it, extended straight beyond its ends.
    fn place_mm(&self, at_mm: f64) -> [f64; 2] {
        let next = self.path_mm.partition_point(|(_, way_mm)| *way_mm < at_mm).clamp(1, self.path_mm.len() - 1);
        let ((from, start_mm), (to, end_mm)) = (self.path_mm[next - 1], self.path_mm[next]);
        let share = (at_mm - start_mm) / (end_mm - start_mm);
        [from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share]
    }

    /// Plane (1), and the angle of its middle about the rotor's axis.
    fn plane(&self, at_mm: f64) -> (SectionPlane, f64) {
        let [z_mm, radius_mm] = self.place_mm(at_mm);
        let ends = [at_mm - CHORD_MM, at_mm + CHORD_MM].map(|at_mm| self.place_mm(at_mm));
        let (along, out) = (ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]);
        let middle_rad = self.midway.angle_rad([z_mm, radius_mm]);
        let (sin, cos) = libm::sincos(middle_rad);
        let plane = SectionPlane {
            origin: Point::new(radius_mm * cos, radius_mm * sin, z_mm),
            across: Vector::new(-sin, cos, 0.0),
            up: Vector::new(cos * along, sin * along, -out).normalize(),
        };
        (plane, middle_rad)
    }

    /// Height of the blades' tips in a plane, mm: where it meets their tip curves, or else of the nearest point of these.
    fn tip_mm(&self, plane: &SectionPlane) -> f64 {
        let blades = [0, 1].map(|index| self.passage.blisk.blade(index));
        let places = |face: &crate::geometry::face::Face| -> Vec<[f64; 3]> {
            let share = |k: u32| f64::from(k) / f64::from(TIP_POINTS);
            (0..=TIP_POINTS).map(|k| plane.coordinates_mm(&face.point(share(k), 1.0))).collect()
        };
        let curves: Vec<Vec<[f64; 3]>> =
            blades.iter().flat_map(|blade| [&blade.pressure, &blade.suction]).map(places).collect();
        let crossings = curves.iter().flat_map(|curve| curve.windows(2)).filter_map(|ends| {
            let [[low, _, from], [high, _, to]] = [ends[0], ends[1]];
            (from * to <= 0.0 && from != to).then(|| low + (high - low) * from / (from - to))
        });
        let highest = crossings.fold(f64::NEG_INFINITY, f64::max);
        let nearest =
            || curves.iter().flatten().min_by(|a, b| a[2].abs().total_cmp(&b[2].abs())).map_or(0.0, |at| at[0]);
        if highest.is_finite() { highest } else { nearest() }
    }

    /// Largest diameter that passes in planes along the blades, mm.
    fn largest_mm(&self) -> Option<f64> {
        let passes = |radius_mm: f64| {
            let mill = PlungeMill { radius_mm, ..self.passage.mill.clone() };
            let passage = Passage { mill: &mill, ..*self.passage };
            let family = HubFamily { passage: &passage, midway: self.midway, path_mm: self.path_mm.clone() };
            let [from_mm, to_mm] = family.range_mm();
            let mut places =
                (0..LOOKS).map(|look| from_mm + (to_mm - from_mm) * f64::from(look) / f64::from(LOOKS - 1));
            places.all(|at_mm| has_room(&family, at_mm))
        };
        largest_radius_mm(self.passage.mill.radius_mm, passes).map(|radius_mm| 2.0 * radius_mm)
    }
}

fn apart_mm(from: [f64; 2], to: [f64; 2]) -> f64 {
    libm::hypot(to[0] - from[0], to[1] - from[1])
}

impl SectionFamily for HubFamily<'_> {
    fn at(&self, at_mm: f64) -> Result<PlungeSection, PlungeInfeasible> {
        let Passage { blisk, mill, needs, .. } = self.passage;
        let (plane, middle_rad) = self.plane(at_mm);
        let tip_mm = self.tip_mm(&plane).max(needs.allowance_mm + mill.radius_mm);
        let exit_mm = exit_mm(&blisk.blank, &plane.origin, &plane.up).unwrap_or(tip_mm);
        let heights = SectionHeights { floor_mm: needs.allowance_mm, edge_mm: tip_mm, roof_mm: tip_mm.max(exit_mm) };
        let found = boundary(self.passage, self.midway, &plane, &heights, middle_rad);
        let boundary = found.ok_or(PlungeInfeasible::NoBoundary { z_mm: plane.origin.z })?;
        Ok(PlungeSection { plane, boundary })
    }

    fn too_narrow(&self, PlungeSection { plane, boundary }: &PlungeSection) -> PlungeInfeasible {
        PlungeInfeasible::HubTooNarrow {
            z_mm: plane.origin.z,
            radius_mm: libm::hypot(plane.origin.x, plane.origin.y),
            missing_mm: -boundary.room_mm(),
            touching: touched(self.passage, plane, boundary),
            largest_mm: self.largest_mm(),
        }
    }
}
