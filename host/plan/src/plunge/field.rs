//! Section of the blades about a passage, offset in space, by a plane across the rotor's axis.
//!
//! ```text
//! wall of a passage in the plane z:  distance((r cos psi, r sin psi, z), blade) = D                (1)
//! ```
//!
//! Every point of the plane beyond that curve keeps the distance D from the blade. So a line beyond it is the axis of a capsule of radius D that cuts
//! nothing: exact, for any twist. (A flat end lies within the capsule's round end but on the hub's side.)
//!
//! The curve is followed from radius to radius, from its last place: looking on both sides of one fixed angle loses bowed passages. Our own.

use core::cell::Cell;

use nalgebra::Rotation3;

use crate::geometry::blisk::Blisk;
use crate::geometry::face::Face;
use crate::parallel;
use crate::proof::bodies;
use crate::search::{Minimum, Sample, Steps, crossing, descend_to};
use crate::vector::{Point, Vector};

use super::distance::BoxTree;

/// Largest distance of the triangles from the blade, mm.
const CHORD_MM: f64 = 0.002;
/// Distance of neighbouring samples of a wall, mm.
const SPACING_MM: f64 = 0.3;
/// Least step in search of the wall, mm: thinner material would be missed.
const STRIDE_MM: f64 = 0.02;
/// Precision of the wall, mm.
const PRECISION_MM: f64 = 1e-10;
/// First step in search of the angle nearest to a blade, mm.
const FIRST_STEP_MM: f64 = 0.5;
/// Distance from that angle within which the search ends, mm: more than its precision.
const FLAT_MM: f64 = 1e-3;
/// Rounding of a turned point, mm.
const SAME_POINT_MM: f64 = 1e-9;
/// Pieces of a side, in both directions, whose corners are the blade's points from which a search starts.
const SHEET: u32 = 40;

/// Blades of a rotor, prepared for measuring distances from them and for following the walls of a passage.
pub struct Field {
    tree: BoxTree,
    /// Points of the first blade: radius, place along the rotor's axis, angle about it.
    sheet: Vec<[f64; 3]>,
    /// Lines of the blade's tip on both sides, from edge to edge: place along the rotor's axis, radius.
    tips_mm: [Vec<[f64; 2]>; 2],
    /// Angle from one blade to the next about the rotor's axis.
    pub pitch_rad: f64,
    /// Greatest and least distance of the blade from the rotor's axis, mm.
    pub radii_mm: [f64; 2],
    /// Places along the rotor's axis between which the blade lies, mm.
    pub ends_mm: [f64; 2],
}

/// One of the two walls of a passage, by its blade.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WallSide {
    /// Wall of blade 0; the passage lies at larger angles.
    Left,
    /// Wall of blade 1; the passage lies at smaller angles.
    Right,
}

/// Point of a wall in a plane across the rotor's axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallPlace {
    /// Distance from the rotor's axis, mm.
    pub radius_mm: f64,
    /// Angle about it.
    pub angle_rad: f64,
}

/// Wall with a given distance from its blade.
struct Wall<'f> {
    field: &'f Field,
    side: WallSide,
    z_mm: f64,
    distance_mm: f64,
    turn_rad: f64,
    /// Nearest point of the last look: the next one is not farther from it than that.
    last: Cell<Point>,
}

impl Field {
    /// Field of a rotor's blades.
    pub fn new(blisk: &Blisk) -> Self {
        let tree = BoxTree::new(bodies::blades(blisk, CHORD_MM));
        let corners = || tree.triangles().iter().flatten();
        let range = |value: fn(&Point) -> f64| {
            corners().map(value).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
        };
        let (radii_mm, ends_mm) = (range(|point| libm::hypot(point.x, point.y)), range(|point| point.z));
        let tips_mm = [&blisk.pressure, &blisk.suction].map(tip_line_mm);
        Field { sheet: sheet(blisk), tips_mm, tree, pitch_rad: blisk.pitch_rad(), radii_mm, ends_mm }
    }

    /// Radius of the blade's tip in the plane at `z_mm`, mm; beyond the tip's edges that of the nearer one.
    pub fn tip_mm(&self, z_mm: f64) -> f64 {
        let on = |line: &Vec<[f64; 2]>| {
            let pieces = line.windows(2).filter(|piece| (piece[0][0] - z_mm) * (piece[1][0] - z_mm) <= 0.0);
            let at = |piece: &[[f64; 2]]| {
                let share = (z_mm - piece[0][0]) / (piece[1][0] - piece[0][0]);
                piece[0][1] + (piece[1][1] - piece[0][1]) * if share.is_nan() { 0.0 } else { share }
            };
            let off = |place: &&[f64; 2]| (place[0] - z_mm).abs();
            let nearest = || line.iter().min_by(|a, b| off(a).total_cmp(&off(b))).map(|place| place[1]);
            pieces.map(at).reduce(f64::max).or_else(nearest)
        };
        self.tips_mm.iter().filter_map(on).fold(0.0, f64::max)
    }

    /// Distance, mm, of a point from the blade of this wall, and the blade's nearest point.
    pub fn distance(&self, side: WallSide, point: &Point) -> (f64, Point) {
        self.distance_after(side, point, None)
    }

    /// As [`Field::distance`], but faster if `last`, the blade's nearest point of a neighbouring point, is known.
    pub fn distance_after(&self, side: WallSide, point: &Point, last: Option<Point>) -> (f64, Point) {
        let turn = Rotation3::from_axis_angle(&Vector::z_axis(), self.turn_rad(side));
        // The nearest point is not farther than a known one; rounding must not exclude that.
        let within_mm = last.map_or(f64::INFINITY, |on| (point - on).norm() + SAME_POINT_MM);
        let (found_mm, on) = self.tree.nearest(&(turn.inverse() * point), within_mm).unwrap_or((f64::INFINITY, *point));
        (found_mm - CHORD_MM, turn * on)
    }

    /// Angle of a wall's blade.
    fn turn_rad(&self, side: WallSide) -> f64 {
        match side {
            WallSide::Left => 0.0,
            WallSide::Right => self.pitch_rad,
        }
    }

    /// Places of both walls at a distance from the blades, by growing radius from `from_mm` up to where the blades end, in the plane at `z_mm`.
    pub fn walls(&self, z_mm: f64, distance_mm: f64, from_mm: f64) -> [Vec<WallPlace>; 2] {
        let (tip_mm, end_mm) = (self.tip_mm(z_mm), self.radii_mm[1] + distance_mm);
        let radii_mm = spaced([from_mm, tip_mm]).chain(spaced([tip_mm, end_mm]).skip(1)).collect::<Vec<f64>>();
        let places = |side: WallSide| {
            let (turn_rad, last) = (self.turn_rad(side), Cell::new(self.tree.triangles()[0][0]));
            Wall { field: self, side, z_mm, distance_mm, turn_rad, last }.places(&radii_mm)
        };
        parallel::join(|| places(WallSide::Left), || places(WallSide::Right)).into()
    }
}

/// Points of both sides of the first blade, as radius, place and angle.
fn sheet(blisk: &Blisk) -> Vec<[f64; 3]> {
    let places = || (0..=SHEET).flat_map(|i| (0..=SHEET).map(move |j| [i, j].map(|k| f64::from(k) / f64::from(SHEET))));
    let faces = [&blisk.pressure, &blisk.suction].into_iter();
    let points = faces.flat_map(|face| places().map(|[u, v]| face.point(u, v)));
    points.map(|point| [libm::hypot(point.x, point.y), point.z, libm::atan2(point.y, point.x)]).collect()
}

/// Tip of a side: place along the rotor's axis, radius.
fn tip_line_mm(face: &Face) -> Vec<[f64; 2]> {
    let points = (0..=2 * SHEET).map(|k| face.point(f64::from(k) / f64::from(2 * SHEET), 1.0));
    points.map(|point| [point.z, libm::hypot(point.x, point.y)]).collect()
}

/// Radii from one to another, evenly.
fn spaced([from_mm, to_mm]: [f64; 2]) -> impl Iterator<Item = f64> {
    let count = libm::ceil((to_mm - from_mm) / SPACING_MM).max(1.0) as usize;
    (0..=count).map(
        move |index| if index == count { to_mm } else { from_mm + (to_mm - from_mm) * index as f64 / count as f64 },
    )
}

impl Wall<'_> {
    fn sign(&self) -> f64 {
        match self.side {
            WallSide::Left => 1.0,
            WallSide::Right => -1.0,
        }
    }

    /// Distance beyond the wall, mm; negative behind it.
    fn beyond_mm(&self, radius_mm: f64, angle_rad: f64) -> f64 {
        let (sin, cos) = libm::sincos(angle_rad - self.turn_rad);
        let point = Point::new(radius_mm * cos, radius_mm * sin, self.z_mm);
        let within_mm = (point - self.last.get()).norm() * (1.0 + 1e-12) + 1e-12;
        let (found_mm, on) = self.field.tree.nearest(&point, within_mm).unwrap_or((within_mm, self.last.get()));
        self.last.set(on);
        found_mm - CHORD_MM - self.distance_mm
    }

    /// Places at these radii, those at which there is material.
    fn places(&self, radii_mm: &[f64]) -> Vec<WallPlace> {
        // From the middle of the blade outwards, or else from where it comes near to the plane.
        let half_mm = (radii_mm[0] + self.field.radii_mm[1]) / 2.0;
        // On a wheel whose blades reach far beyond this plane all radii are below it.
        let half = radii_mm.partition_point(|radius_mm| *radius_mm < half_mm).min(radii_mm.len() - 1);
        let mut starts = (0..=half).rev().chain(half + 1..radii_mm.len());
        let Some((start, first_rad)) = starts.find_map(|index| Some((index, self.start(radii_mm[index])?))) else {
            return Vec::new();
        };
        let follow = |indices: &mut dyn Iterator<Item = usize>| {
            let (mut last_rad, tip_mm) = (first_rad, self.field.tip_mm(self.z_mm));
            let mut found = Vec::new();
            for radius_mm in indices.map(|index| radii_mm[index]) {
                // Where the blade ends before the plane the axis may come as far as its edge stands.
                let edge_rad = || (radius_mm <= tip_mm).then(|| self.nearest(radius_mm, last_rad));
                let found_rad = self.edge(radius_mm, last_rad).or_else(edge_rad);
                if let Some(angle_rad) = found_rad {
                    last_rad = angle_rad;
                    found.push(WallPlace { radius_mm, angle_rad });
                }
            }
            found
        };
        let mut places = follow(&mut (0..start).rev());
        places.reverse();
        places.extend(follow(&mut (start..radii_mm.len())));
        places
    }

    /// Angle of the blade's point nearest to the plane at a radius.
    fn sheet(&self, radius_mm: f64) -> Option<f64> {
        let off = |[known_mm, z_mm, _]: &[f64; 3]| libm::hypot(known_mm - radius_mm, z_mm - self.z_mm);
        let nearest = self.field.sheet.iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
        Some(nearest[2] + self.turn_rad)
    }

    /// Angle at which the plane's point at a radius is nearest to the blade, from an angle near it. Where the material of a radius ends,
    /// both sides of the wall meet there.
    fn nearest(&self, radius_mm: f64, near_rad: f64) -> f64 {
        let value = |[angle_rad, _]: [f64; 2]| self.beyond_mm(radius_mm, angle_rad);
        let start = Minimum { at: [near_rad, 0.0], value: value([near_rad, 0.0]) };
        let ranges = [[near_rad - self.field.pitch_rad, near_rad + self.field.pitch_rad], [0.0; 2]];
        let steps = Steps { first: [FIRST_STEP_MM / radius_mm, 0.0], finest: FLAT_MM / FIRST_STEP_MM / 4.0 };
        let found = descend_to(ranges, start, steps, value).at[0];
        // The least distance is flat; the way to the blade's nearest point is square to the circle at one angle.
        let behind_mm = |along_mm: f64| {
            let angle_rad = found + along_mm / radius_mm;
            self.beyond_mm(radius_mm, angle_rad);
            let ((sin, cos), on) = (libm::sincos(angle_rad - self.turn_rad), self.last.get());
            on.x * sin - on.y * cos
        };
        let [before, after] = [-FLAT_MM, FLAT_MM].map(|at| Sample { at, value: behind_mm(at) });
        found + crossing(before, after, PRECISION_MM, behind_mm) / radius_mm
    }

    /// Wall at a radius, from the blade's point nearest to the plane there; `None` if the blade does not come near.
    fn start(&self, radius_mm: f64) -> Option<f64> {
        let angle_rad = self.nearest(radius_mm, self.sheet(radius_mm)?);
        if self.beyond_mm(radius_mm, angle_rad) < 0.0 { self.edge(radius_mm, angle_rad) } else { None }
    }

    /// Angle of the wall at a radius, from a place near it. `None` if there is no material at this radius.
    fn edge(&self, radius_mm: f64, near_rad: f64) -> Option<f64> {
        let beyond_mm = |along_mm: f64| self.beyond_mm(radius_mm, near_rad + along_mm / radius_mm);
        let edge_mm = wall_mm(beyond_mm, 0.0, self.sign(), self.field.pitch_rad * radius_mm)?;
        Some(near_rad + edge_mm / radius_mm)
    }
}

/// Place of a wall on a line or an arc, from a place `near_mm` on it: on the wall, or beyond it within the precision. The function gives the distance beyond
/// the wall, and `ahead` is 1 where places beyond it are greater ones, -1 where they are less. `None` if there is no wall within reach.
pub fn wall_mm(beyond_mm: impl Fn(f64) -> f64, near_mm: f64, ahead: f64, reach_mm: f64) -> Option<f64> {
    let sample = |at: f64| Sample { at, value: beyond_mm(at) };
    let mut here = sample(near_mm);
    let (mut last, is_behind) = (here, here.value < 0.0);
    let towards = if is_behind { ahead } else { -ahead };
    while (here.value < 0.0) == is_behind {
        last = here;
        // The distance changes by no more than the way.
        let next_mm = here.at + towards * (here.value.abs() + STRIDE_MM);
        let is_within = (next_mm - near_mm).abs() <= reach_mm;
        if !is_within {
            return None;
        }
        here = sample(next_mm);
    }
    let [behind, beyond] = if is_behind { [last, here] } else { [here, last] };
    Some(crossing(behind, beyond, PRECISION_MM, beyond_mm))
}
