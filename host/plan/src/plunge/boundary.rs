//! Boundary axes of a passage in a plane across the rotor's axis, and the largest tool.
//!
//! ```text
//! T1, T3 = left line with the circles of roof and floor;  T2, T4 = right line                     (1)
//! w_roof = x(T2) - x(T1) >= 0,  w_floor = x(T4) - x(T3) >= 0                                       (2)
//! ```
//!
//! In the plane y runs from the rotor's axis to the middle between both walls at half the height, x towards growing angles. A line is on one side of its
//! wall from the floor up to where the rounded offset of the tip ends; its gap counts up to the tip. Roof: the blank; floor: the hub with its allowance.
//! The largest tool is the greatest radius for which (2) holds: the room falls with the radius.
//!
//! Source: An Luling et al.: axes on both sides, planes across the rotor's axis, "the largest tool diameter allowed", without formulas. E1: it links T1,
//! T3 and T4; two lines are meant.

use crate::vector::{Flat, Point};

use super::field::{Field, WallPlace, WallSide};
use super::line::{CurveSample, Fit, SupportLine, tangent_line};

/// Precision of the largest radius, mm.
const RADIUS_PRECISION_MM: f64 = 0.005;
/// Radii nearer to each other than this are the same, mm.
const SAME_MM: f64 = 1e-6;
/// A sample nearer to the line than this touches it, mm.
const TOUCHING_MM: f64 = 0.01;

/// Radii about the rotor's axis, in a plane across it, between which a passage is plunged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circles {
    /// Radius of the blank, mm.
    pub roof_mm: f64,
    /// Radius up to which the blades reach, mm.
    pub tip_mm: f64,
    /// Radius of the hub with its allowance, mm.
    pub floor_mm: f64,
}

/// Boundary axes in a plane: the axes of the plunges nearest to the left and to the right blade, with their ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    /// Angle of the plane's y axis about the rotor's axis.
    pub middle_rad: f64,
    /// Left and right axis as lines in the plane, x as a function of y; the right one is mirrored (-x).
    pub lines: [SupportLine; 2],
    /// Points T1 and T2 of the axes on the roof (surface of the blank): x, y in the plane.
    pub roof: [Flat; 2],
    /// Points T3 and T4 of the axes on the floor (hub with its allowance): x, y in the plane.
    pub floor: [Flat; 2],
    /// Points of the walls that the axes touch, nearest to the floor.
    pub touching: [Flat; 2],
}

/// Samples of both walls of a passage, in the coordinates of one plane. A wall has the required distance from its blade.
#[derive(Clone, Debug)]
pub struct WallSamples {
    /// Angle of the y axis about the rotor's axis.
    pub middle_rad: f64,
    /// Samples of the left wall, x over y, and of the right wall, -x over y.
    pub walls: [Vec<CurveSample>; 2],
}

impl WallSamples {
    /// Samples of the walls at `distance_mm` from the blades, in the plane at `z_mm`. `None` if the plane does not meet a blade.
    pub fn new(field: &Field, z_mm: f64, distance_mm: f64, circles: &Circles) -> Option<Self> {
        let walls = field.walls(z_mm, distance_mm, circles.floor_mm);
        let half_mm = (circles.floor_mm + circles.tip_mm) / 2.0;
        let [left, right] = [&walls[0], &walls[1]].map(|wall| angle_at(wall, half_mm));
        let middle_rad = (left? + right?) / 2.0;
        let samples = [(&walls[0], 1.0), (&walls[1], -1.0)].map(|(wall, sign)| {
            let mut samples: Vec<CurveSample> =
                wall.iter().map(|place| sample(place, middle_rad, sign, circles.tip_mm)).collect();
            samples.sort_by(|a, b| a.along_mm.total_cmp(&b.along_mm));
            samples
        });
        Some(WallSamples { middle_rad, walls: samples })
    }

    /// Boundary axes of these walls. `None` if no line keeps to one side of a wall, or a line does not meet a circle.
    pub fn boundary(&self, circles: &Circles, fit: Fit) -> Option<Boundary> {
        let line = |wall: &[CurveSample]| tangent_line(wall, fit).map(|line| clear_of_curve(line, wall));
        let lines = [line(&self.walls[0])?, line(&self.walls[1])?];
        let on = |radius_mm: f64| Some([crossing(&lines[0], 1.0, radius_mm)?, crossing(&lines[1], -1.0, radius_mm)?]);
        let touching = touching(&lines, &self.walls);
        let (roof, floor) = (on(circles.roof_mm)?, on(circles.floor_mm)?);
        Some(Boundary { middle_rad: self.middle_rad, lines, roof, floor, touching })
    }
}

/// Places of both walls nearest to their lines.
pub(super) fn touching(lines: &[SupportLine; 2], walls: &[Vec<CurveSample>; 2]) -> [Flat; 2] {
    [(0, 1.0), (1, -1.0)].map(|(side, sign): (usize, f64)| {
        let gap = |sample: &CurveSample| lines[side].at_mm(sample.along_mm) - sample.height_mm;
        let nearest = walls[side].iter().min_by(|a, b| gap(a).total_cmp(&gap(b)));
        nearest.map_or(Flat::origin(), |sample| Flat::new(sign * sample.height_mm, sample.along_mm))
    })
}

/// Angle of a wall at the radius nearest to a given one.
fn angle_at(wall: &[WallPlace], radius_mm: f64) -> Option<f64> {
    let above = wall.iter().position(|place| place.radius_mm >= radius_mm);
    match above {
        Some(at) if at > 0 => {
            let (low, high) = (&wall[at - 1], &wall[at]);
            let share = (radius_mm - low.radius_mm) / (high.radius_mm - low.radius_mm);
            Some(low.angle_rad + (high.angle_rad - low.angle_rad) * share)
        }
        _ => wall
            .iter()
            .min_by(|a, b| (a.radius_mm - radius_mm).abs().total_cmp(&(b.radius_mm - radius_mm).abs()))
            .map(|place| place.angle_rad),
    }
}

fn sample(place: &WallPlace, middle_rad: f64, sign: f64, tip_mm: f64) -> CurveSample {
    let (sin, cos) = libm::sincos(place.angle_rad - middle_rad);
    CurveSample {
        along_mm: place.radius_mm * cos,
        height_mm: sign * place.radius_mm * sin,
        is_counted: place.radius_mm <= tip_mm + SAME_MM,
    }
}

/// The line moved off the wall by as much as the wall stands above its samples: between three of them it is a parabola.
pub(super) fn clear_of_curve(line: SupportLine, samples: &[CurveSample]) -> SupportLine {
    let above = |sample: &CurveSample| sample.height_mm - line.at_mm(sample.along_mm);
    let peak = |three: &[CurveSample]| {
        let [a, b, c] = [0, 1, 2].map(|k| above(&three[k]));
        let (before, after) = (three[1].along_mm - three[0].along_mm, three[2].along_mm - three[1].along_mm);
        let (rise, fall) = ((b - a) / before, (c - b) / after);
        let bend = (fall - rise) / (before + after);
        let slope = (rise * after + fall * before) / (before + after);
        let is_near = a.max(b).max(c) > -TOUCHING_MM;
        let is_between = (-before..=after).contains(&(-slope / (2.0 * bend)));
        if is_near && is_between && bend < 0.0 { b - slope * slope / (4.0 * bend) } else { 0.0 }
    };
    let excess_mm = samples.windows(3).map(peak).filter(|excess| excess.is_finite()).fold(0.0, f64::max);
    SupportLine { offset_mm: line.offset_mm + excess_mm, gap_max_mm: line.gap_max_mm + excess_mm, ..line }
}

/// Point of a line on a circle about the origin, on the outer side.
fn crossing(line: &SupportLine, sign: f64, radius_mm: f64) -> Option<Flat> {
    let SupportLine { offset_mm, slope, .. } = *line;
    let square = 1.0 + slope * slope;
    let root = radius_mm * radius_mm * square - offset_mm * offset_mm;
    (root >= 0.0).then(|| {
        let along_mm = (libm::sqrt(root) - offset_mm * slope) / square;
        Flat::new(sign * line.at_mm(along_mm), along_mm)
    })
}

impl Boundary {
    /// Distances of both axes at the roof and at the floor, w_roof and w_floor (2), mm.
    pub fn widths_mm(&self) -> [f64; 2] {
        [self.roof[1].x - self.roof[0].x, self.floor[1].x - self.floor[0].x]
    }

    /// Smaller distance of both axes, at roof or floor, mm; negative if the tool does not pass between the blades.
    pub fn room_mm(&self) -> f64 {
        self.widths_mm()[0].min(self.widths_mm()[1])
    }

    /// Largest gap between each axis and its wall, mm: material that the plunges leave above the allowance.
    pub fn gaps_mm(&self) -> [f64; 2] {
        self.lines.map(|line| line.gap_max_mm)
    }

    /// Tilts of both axes in the plane, from y towards x.
    pub fn tilts_rad(&self) -> [f64; 2] {
        [libm::atan(self.lines[0].slope), -libm::atan(self.lines[1].slope)]
    }

    /// Point of the plane at `z_mm`, in the rotor's own frame.
    pub fn to_part(&self, place: &Flat, z_mm: f64) -> Point {
        let (sin, cos) = libm::sincos(self.middle_rad);
        Point::new(place.y * cos - place.x * sin, place.y * sin + place.x * cos, z_mm)
    }
}

/// Boundary axes at `distance_mm` (radius of the tool plus allowance) from the blades, in the plane at `z_mm`.
pub fn boundary(field: &Field, z_mm: f64, distance_mm: f64, circles: &Circles, fit: Fit) -> Option<Boundary> {
    WallSamples::new(field, z_mm, distance_mm, circles)?.boundary(circles, fit)
}

/// Largest tool that passes in one plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LargestTool {
    /// Position of the plane along the rotor's axis, mm.
    pub z_mm: f64,
    /// Radius of that tool, mm.
    pub radius_mm: f64,
    /// Points of both blades that it touches.
    pub touching: [Point; 2],
}

/// Largest tool that passes in the plane at `z_mm`. `None` if the plane meets no blade or no tool passes.
pub fn largest_tool(field: &Field, z_mm: f64, allowance_mm: f64, circles: &Circles, fit: Fit) -> Option<LargestTool> {
    let at = |radius_mm: f64| boundary(field, z_mm, radius_mm + allowance_mm, circles, fit);
    let room = |radius_mm: f64| at(radius_mm).map_or(f64::NEG_INFINITY, |found| found.room_mm());
    let widest_mm = circles.floor_mm * libm::sin((field.pitch_rad / 2.0).min(core::f64::consts::FRAC_PI_2));
    let (mut low, mut high) = ((0.0, at(0.0)?.room_mm()), (widest_mm, room(widest_mm)));
    // Regula falsi: the room is nearly linear in the radius.
    while high.0 - low.0 > RADIUS_PRECISION_MM && low.1 > RADIUS_PRECISION_MM / 2.0 {
        let share = (low.1 / (low.1 - high.1)).clamp(0.02, 0.98);
        let share = if share.is_finite() { share } else { 0.5 };
        let middle_mm = low.0 + (high.0 - low.0) * share;
        let found = (middle_mm, room(middle_mm));
        if found.1 >= 0.0 { low = found } else { high = found }
    }
    let (found, radius_mm) = (at(low.0)?, low.0);
    let touching = [(WallSide::Left, 0), (WallSide::Right, 1)]
        .map(|(side, index)| field.distance(side, &found.to_part(&found.touching[index], z_mm)).1);
    Some(LargestTool { z_mm, radius_mm, touching })
}
