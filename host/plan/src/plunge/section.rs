//! Section of a passage by a plane of any direction, and the boundary axes in it.
//!
//! ```text
//! point of the plane = c + x e + y n                                                               (1)
//! left axis:  x = A + B y >= x_L(y),  right axis:  x = A + B y <= x_R(y)                           (2)
//! ```
//!
//! n: against the direction of plunging; e: across it, towards growing angles about the rotor's axis. x_L and x_R are the places at a distance from the
//! blades, measured in space, so a line on the open side of both is the axis of a capsule that cuts nothing, in a plane of any direction (field.rs). The walls
//! are followed from places between both blades: the middle surface of a blade, turned by half a pitch. Our own.

use core::cell::Cell;

use nalgebra::Rotation3;

use crate::geometry::blisk::Blisk;
use crate::parallel;
use crate::vector::{Flat, Point, Vector};

use super::boundary::{Boundary, clear_of_curve, touching};
use super::field::{WallSide, wall_mm};
use super::infeasibility::PlungeInfeasible;
use super::line::{CurveSample, tangent_line};
use super::passage::Passage;

/// Distance of neighbouring samples of a wall, mm.
const SPACING_MM: f64 = 0.3;
/// Pieces of the middle surface in both directions.
const PIECES: u32 = 40;

/// Plane in which plunges lie, with its axes (1), in the rotor's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionPlane {
    /// Origin c.
    pub origin: Point,
    /// Unit vector e across the direction of plunging, towards growing angles about the rotor's axis.
    pub across: Vector,
    /// Unit vector n against the direction of plunging.
    pub up: Vector,
}

/// Plane of plunges with the boundary axes in it: the axes nearest to the two blades.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlungeSection {
    /// Plane.
    pub plane: SectionPlane,
    /// Boundary axes, in the plane's coordinates.
    pub boundary: Boundary,
}

/// Family of planes of plunges, each given by a coordinate along the passage.
pub trait SectionFamily: Sync {
    /// Plane with its boundary axes at this coordinate, mm.
    ///
    /// # Errors
    /// The plane has no boundary axes.
    fn at(&self, at_mm: f64) -> Result<PlungeSection, PlungeInfeasible>;

    /// Error for a plane in which the mill does not pass between the blades.
    fn too_narrow(&self, section: &PlungeSection) -> PlungeInfeasible;
}

/// Heights in a plane of plunges along its vector n, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionHeights {
    /// Height of the boundary axes' lower ends T3 and T4.
    pub floor_mm: f64,
    /// Height up to which the gap between an axis and its wall counts.
    pub edge_mm: f64,
    /// Height of the boundary axes' upper ends T1 and T2.
    pub roof_mm: f64,
}

/// Centre line of a passage: points half way between its two blades.
pub struct Midway {
    points: Vec<Point>,
    /// Radius about a place within which points determine the passage's angle there, mm.
    spread_mm: f64,
}

impl SectionPlane {
    /// Plane across the rotor's axis, with n at an angle about it.
    pub fn radial(z_mm: f64, angle_rad: f64) -> Self {
        let (sin, cos) = libm::sincos(angle_rad);
        SectionPlane {
            origin: Point::new(0.0, 0.0, z_mm),
            across: Vector::new(-sin, cos, 0.0),
            up: Vector::new(cos, sin, 0.0),
        }
    }

    /// Point of the plane (1).
    pub fn point(&self, place: &Flat) -> Point {
        self.origin + self.across * place.x + self.up * place.y
    }

    /// Distances of a point along n, along e and from the plane, mm.
    pub fn coordinates_mm(&self, point: &Point) -> [f64; 3] {
        let way = point - self.origin;
        [way.dot(&self.up), way.dot(&self.across), way.dot(&self.across.cross(&self.up))]
    }
}

impl Midway {
    /// Middle surface of the first blade, turned into the middle of the passage behind it.
    pub fn new(blisk: &Blisk) -> Self {
        let turn = Rotation3::from_axis_angle(&Vector::z_axis(), blisk.pitch_rad() / 2.0);
        let share = |k: u32| f64::from(k) / f64::from(PIECES);
        let places = (0..=PIECES).flat_map(|i| (0..=PIECES).map(move |j| [share(i), share(j)]));
        let middle =
            |[u, v]: [f64; 2]| turn * nalgebra::center(&blisk.pressure.point(u, v), &blisk.suction.point(u, v));
        let points: Vec<Point> = places.map(middle).collect();
        let size_mm = |of: fn(&Point) -> f64| {
            let [low, high] = points
                .iter()
                .map(of)
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)]);
            high - low
        };
        let spread_mm = libm::hypot(size_mm(|point| point.z), size_mm(radius_mm)) * 2.0 / f64::from(PIECES);
        Midway { points, spread_mm }
    }

    /// Angle about the rotor's axis at a place of the meridian: mean of the points, by their nearness.
    pub fn angle_rad(&self, [z_mm, at_mm]: [f64; 2]) -> f64 {
        let off_mm = |point: &Point| libm::hypot(point.z - z_mm, radius_mm(point) - at_mm);
        let angle = |point: &Point| libm::atan2(point.y, point.x);
        let nearest = self.points.iter().min_by(|a, b| off_mm(a).total_cmp(&off_mm(b)));
        let Some((least_mm, near_rad)) = nearest.map(|point| (off_mm(point), angle(point))) else { return 0.0 };
        let weight = |point: &Point| {
            let [off, least] = [off_mm(point), least_mm].map(|mm| mm / self.spread_mm);
            libm::exp((least * least - off * off) / 2.0)
        };
        let [sum, turned] = self.points.iter().fold([0.0, 0.0], |[sum, turned], point| {
            let weight = weight(point);
            [sum + weight, turned + weight * libm::remainder(angle(point) - near_rad, core::f64::consts::TAU)]
        });
        near_rad + turned / sum
    }

    /// Place between both blades at a height over a plane's origin, of the point nearest to it, mm along e.
    fn across_mm(&self, plane: &SectionPlane, height_mm: f64) -> f64 {
        let places = self.points.iter().map(|point| plane.coordinates_mm(point));
        let off = |[up, _, beside]: &[f64; 3]| libm::hypot(up - height_mm, *beside);
        places.min_by(|a, b| off(a).total_cmp(&off(b))).map_or(0.0, |[_, across_mm, _]| across_mm)
    }
}

fn radius_mm(point: &Point) -> f64 {
    libm::hypot(point.x, point.y)
}

/// Boundary axes of a passage's mill in a plane, whose middle is at an angle about the rotor's axis. `None` if a wall has no
/// line.
pub fn boundary(
    Passage { field, mill, needs, .. }: &Passage<'_>,
    midway: &Midway,
    plane: &SectionPlane,
    heights: &SectionHeights,
    middle_rad: f64,
) -> Option<Boundary> {
    let distance_mm = mill.radius_mm + needs.allowance_mm;
    let SectionHeights { floor_mm, edge_mm, roof_mm } = *heights;
    let end_mm = edge_mm + distance_mm;
    let count = libm::ceil((end_mm - floor_mm) / SPACING_MM).max(2.0) as usize;
    let along_mm: Vec<f64> =
        (0..=count).map(|index| floor_mm + (end_mm - floor_mm) * index as f64 / count as f64).collect();
    let reach_mm = field.radii_mm[1] * field.pitch_rad;
    let walls = [(WallSide::Left, 1.0), (WallSide::Right, -1.0)].map(|(side, sign)| {
        let sample = |&along_mm: &f64| {
            let near_mm = midway.across_mm(plane, along_mm);
            let last = Cell::new(None);
            let beyond_mm = |x: f64| {
                let (found_mm, on) = field.distance_after(side, &plane.point(&Flat::new(x, along_mm)), last.get());
                last.set(Some(on));
                found_mm - distance_mm
            };
            let height_mm = sign * wall_mm(beyond_mm, near_mm, sign, reach_mm)?;
            Some(CurveSample { along_mm, height_mm, is_counted: along_mm <= edge_mm })
        };
        parallel::filter_map(&along_mm, &sample)
    });
    let line = |wall: &[CurveSample]| tangent_line(wall, needs.fit).map(|line| clear_of_curve(line, wall));
    let lines = [line(&walls[0])?, line(&walls[1])?];
    let at =
        |along_mm: f64| [Flat::new(lines[0].at_mm(along_mm), along_mm), Flat::new(-lines[1].at_mm(along_mm), along_mm)];
    let touching = touching(&lines, &walls);
    Some(Boundary { middle_rad, lines, roof: at(roof_mm), floor: at(floor_mm), touching })
}
