//! Machinability of a passage by plunging: twist, bend and depth of its two sides, and its width.
//!
//! ```text
//! depth  = max_u |S(u, 1) - S(u, 0)|                                               (1)
//! width  = |PS(u, v) - SS'(u, v)|, least and greatest; free width = least distance of both faces      (2)
//! camber line: middle of PS(u, v) and SS(u, v), at the mean of their radii          (3)
//! ```
//!
//! A v-line runs from inlet to outlet at one share of the height, a u-line from hub to tip. The source's width compares corresponding points; a tool
//! meets the least distance, so both are reported.

use crate::geometry::face::Face;
use crate::geometry::flaws::nearest;
use crate::search::{Minimum, descend};
use crate::vector::Point;

use super::measure::{ChordAngles, CurveJet, CurveShape};

/// Lines of each kind on a side.
const LINES: [usize; 2] = [36, 16];

/// Measures of one side of a passage that say how difficult it is to plunge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SideMeasures {
    /// Greatest twist of a line from inlet to outlet: divided at the greatest curvature, and at the point farthest from its chord.
    pub twist_rad: [f64; 2],
    /// Greatest bend of a line from hub to tip, divided in the same two ways.
    pub bend_rad: [f64; 2],
    /// Greatest sag of a line from hub to tip: distance from its chord, mm.
    pub sag_mm: f64,
    /// Depth: greatest distance from hub to tip, mm. (1)
    pub depth_mm: f64,
    /// Number of lines that have a point of greatest curvature, and number of all lines.
    pub peaked: [usize; 2],
}

/// Widths of a passage between its two blades, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Widths {
    /// Smallest and largest distance of corresponding points of both sides.
    pub corresponding_mm: [f64; 2],
    /// Smallest distance of both sides.
    pub free_mm: f64,
    /// Point of the pressure side at which that distance is smallest.
    pub narrowest: Point,
}

/// Places of a side: `range` of u.
fn places(range: [f64; 2], counts: [usize; 2]) -> impl Iterator<Item = [f64; 2]> {
    let along = move |i: usize| range[0] + (range[1] - range[0]) * i as f64 / counts[0] as f64;
    (0..=counts[1]).flat_map(move |j| (0..=counts[0]).map(move |i| [along(i), j as f64 / counts[1] as f64]))
}

impl SideMeasures {
    /// Measures of a face over a range of u.
    pub fn new(face: &Face, range: [f64; 2]) -> Self {
        let mut measures = SideMeasures::default();
        for j in 0..=LINES[1] {
            let v = j as f64 / LINES[1] as f64;
            let shape = CurveShape::new(range, |u| {
                let jet = face.jet(u, v);
                CurveJet { point: jet.point, first: jet.u, second: jet.uu }
            });
            measures.take(&shape, true);
        }
        for i in 0..=LINES[0] {
            let u = range[0] + (range[1] - range[0]) * i as f64 / LINES[0] as f64;
            let shape = CurveShape::new([0.0, 1.0], |v| {
                let jet = face.jet(u, v);
                CurveJet { point: jet.point, first: jet.v, second: jet.vv }
            });
            measures.take(&shape, false);
            measures.sag_mm = measures.sag_mm.max(shape.sag_mm);
            measures.depth_mm = measures.depth_mm.max((shape.ends[1] - shape.ends[0]).norm()); // (1)
        }
        measures
    }

    fn take(&mut self, shape: &CurveShape, is_v_line: bool) {
        self.peaked[0] += usize::from(shape.by_curvature.is_some());
        self.peaked[1] += 1;
        for (rule, split) in [shape.split(), shape.by_chord].iter().enumerate() {
            let angles = shape.angles(split);
            if is_v_line {
                self.twist_rad[rule] = self.twist_rad[rule].max(angles.twist_rad());
            } else {
                self.bend_rad[rule] = self.bend_rad[rule].max(angles.bend_rad);
            }
        }
    }
}

/// Greatest twist of a blade's camber lines, split at the middle of u, rad.
pub fn camber_twist_rad(pressure: &Face, suction: &Face, range: [f64; 2]) -> f64 {
    let twist = |v: f64| {
        let at = |u: f64| camber_point(&pressure.point(u, v), &suction.point(u, v));
        let [first, last] = range.map(at);
        ChordAngles::new(&first, &at((range[0] + range[1]) / 2.0), &last).twist_rad()
    };
    (0..=LINES[1]).map(|j| twist(j as f64 / LINES[1] as f64)).fold(0.0, f64::max)
}

/// Point of a camber line (3).
pub fn camber_point(pressure: &Point, suction: &Point) -> Point {
    let middle = nalgebra::center(pressure, suction);
    let radius = |point: &Point| libm::hypot(point.x, point.y);
    let share = (radius(pressure) + radius(suction)) / (2.0 * radius(&middle));
    Point::new(middle.x * share, middle.y * share, middle.z)
}

/// Widths between a pressure side and the suction side that it faces, over a range of u.
pub fn widths(pressure: &Face, suction: &Face, range: [f64; 2]) -> Widths {
    let ranges = [range, [0.0, 1.0]];
    let spacing = [(range[1] - range[0]) / LINES[0] as f64, 1.0 / LINES[1] as f64];
    let extreme = |sign: f64| {
        let width = |[u, v]: [f64; 2]| sign * (pressure.point(u, v) - suction.point(u, v)).norm();
        let starts = places(range, LINES).map(|at| Minimum { at, value: width(at) });
        let start = starts.min_by(|a, b| a.value.total_cmp(&b.value));
        start.map_or(f64::NAN, |start| sign * descend(ranges, start, spacing, width).value)
    };
    let ([u, v], free_mm) = nearest(pressure, suction);
    Widths { corresponding_mm: [extreme(1.0), extreme(-1.0)], free_mm, narrowest: pressure.point(u, v) }
}
