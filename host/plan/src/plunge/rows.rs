//! Planes of plunges along a passage, so far apart that the cusps on the blades keep their height.
//!
//! ```text
//! distance of neighbouring boundary axes, square to them <= stepover(R, h, curvature of the blade there)      (1)
//! ```
//!
//! for both sides, at roof and floor; then as many equal steps as that takes. The distance follows from boundary axes in planes of a grid; those in between
//! are interpolated, and the result is measured: a step above (1) is halved. E10: the source looks at the hub only, where the step is the smaller one.

use crate::geometry::face::Face;
use crate::search::{Minimum, descend};
use crate::vector::{Point, Vector};

use super::boundary::Boundary;
use super::field::WallSide;
use super::infeasibility::PlungeInfeasible;
use super::passage::Passage;
use super::section::{PlungeSection, SectionFamily};
use super::step::{curvature_across_per_mm, stepover};

/// Distance of the grid's planes, mm.
const GRID_MM: f64 = 2.0;
/// Samples of a face for the nearest place.
const SAMPLES: [usize; 2] = [24, 8];
/// Share of the allowed step that is used: the steps are interpolated.
const USED_RATIO: f64 = 0.98;

/// Least distance of two planes along their coordinate, mm: across it the boundary axes jump.
const FINEST_MM: f64 = 1e-3;

/// Planes of one family between two of its coordinates, as far apart as the cusps allow.
pub struct Rows<'r> {
    /// Passage.
    pub passage: &'r Passage<'r>,
    /// Family.
    pub family: &'r dyn SectionFamily,
    /// Coordinates of the first and the last plane, mm.
    pub range_mm: [f64; 2],
}

/// One plane of plunges with its distance from the plane before.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Plane and its boundary axes.
    pub section: PlungeSection,
    /// Largest distance from the plane before, square to the axes, mm.
    pub distance_mm: f64,
    /// That distance divided by the one that the cusp height allows, the largest value.
    pub step_ratio: f64,
}

/// Grid plane: coordinate, boundary axes, allowed steps at T1 to T4.
struct GridPlane {
    at_mm: f64,
    section: PlungeSection,
    steps_mm: [f64; 4],
}

impl Rows<'_> {
    /// Planes in order.
    ///
    /// # Errors
    /// A plane has no boundary axes, the cusp does not fit, or the axes jump by more than it allows.
    pub fn places(&self) -> Result<Vec<Row>, PlungeInfeasible> {
        let [from_mm, to_mm] = self.range_mm;
        let count = libm::ceil((to_mm - from_mm).abs() / GRID_MM).max(1.0) as usize;
        let place = |index: usize| from_mm + (to_mm - from_mm) * index as f64 / count as f64;
        let grid = (0..=count).map(|index| self.grid_plane(place(index))).collect::<Result<Vec<_>, _>>()?;
        let mut planes = self.divided(&grid)?;
        let mut index = 1;
        while let [from, to] = &planes[index - 1..(index + 1).min(planes.len())] {
            if ratio(from, to) <= 1.0 {
                index += 1;
                continue;
            }
            if (to.at_mm - from.at_mm).abs() < FINEST_MM {
                let (z_mm, moved_mm) = (to.section.plane.origin.z, largest_mm(from, to));
                return Err(PlungeInfeasible::Jump { z_mm, moved_mm, cusp_mm: self.passage.needs.cusp_mm });
            }
            let middle = self.grid_plane(f64::midpoint(from.at_mm, to.at_mm))?;
            planes.insert(index, middle);
        }
        Ok(rows(&planes))
    }

    /// Planes in equal steps of the allowed ones, by interpolation in a grid.
    fn divided(&self, grid: &[GridPlane]) -> Result<Vec<GridPlane>, PlungeInfeasible> {
        // Number of allowed steps up to each grid plane.
        let mut steps = vec![0.0];
        for pair in grid.windows(2) {
            steps.push(steps[steps.len() - 1] + ratio(&pair[0], &pair[1]));
        }
        let last = grid.len() - 1;
        let pieces = libm::ceil(steps[last] / USED_RATIO).max(1.0) as usize;
        let place = |index: usize| {
            let share = steps[last] * index as f64 / pieces as f64;
            let piece = steps.partition_point(|known| *known < share).clamp(1, last);
            let within = ((share - steps[piece - 1]) / (steps[piece] - steps[piece - 1])).clamp(0.0, 1.0);
            grid[piece - 1].at_mm + (grid[piece].at_mm - grid[piece - 1].at_mm) * within
        };
        (0..=pieces).map(|index| self.grid_plane(place(index))).collect()
    }

    fn grid_plane(&self, at_mm: f64) -> Result<GridPlane, PlungeInfeasible> {
        let section = self.family.at(at_mm)?;
        let mut steps_mm = [0.0; 4];
        for (corner, step_mm) in steps_mm.iter_mut().enumerate() {
            *step_mm = self.step_mm(&section, corner)?;
        }
        Ok(GridPlane { at_mm, section, steps_mm })
    }

    /// Allowed step at T1 to T4.
    fn step_mm(&self, section: &PlungeSection, corner: usize) -> Result<f64, PlungeInfeasible> {
        let Passage { blisk, field, mill, needs, .. } = self.passage;
        let (side, index) = if corner.is_multiple_of(2) { (WallSide::Left, 0) } else { (WallSide::Right, 1) };
        let (_, on_blade) = field.distance(side, &place(section, corner));
        let turn = nalgebra::Rotation3::from_axis_angle(&Vector::z_axis(), -field.pitch_rad * f64::from(index));
        let (on_first, axis) = (turn * on_blade, turn * axis(section, usize::from(index == 1)));
        let faces = [&blisk.pressure, &blisk.suction].map(|face| (face, nearest_place(face, &on_first)));
        let (face, at) = if faces[0].1.value < faces[1].1.value { faces[0] } else { faces[1] };
        let [u, v] = at.at;
        let curvature = curvature_across_per_mm(&face.jet(u, v), &face.normal(u, v), &axis);
        // The mill cuts the wall of the allowance, which is offset from the blade.
        let offset = curvature / (1.0 + curvature * needs.allowance_mm);
        let found = stepover(mill.radius_mm, needs.cusp_mm, offset);
        // Beside one plunge the core lies in its hole, and no cut is wider than the mill's edges allow.
        let most_mm = mill.width_max_mm.min(mill.radius_mm - mill.core_radius_mm);
        let z_mm = section.plane.origin.z;
        found.map(|step| step.axes_mm.min(most_mm)).ok_or(PlungeInfeasible::Cusp { z_mm, cusp_mm: needs.cusp_mm })
    }
}

/// Planes with their distances.
fn rows(planes: &[GridPlane]) -> Vec<Row> {
    let row = |(index, plane): (usize, &GridPlane)| {
        let before = index.checked_sub(1).map(|before| &planes[before]);
        let (distance_mm, step_ratio) = before.map_or((0.0, 0.0), |last| (largest_mm(last, plane), ratio(last, plane)));
        Row { section: plane.section, distance_mm, step_ratio }
    };
    planes.iter().enumerate().map(row).collect()
}

fn nearest_place(face: &Face, point: &Point) -> Minimum {
    let distance = |[u, v]: [f64; 2]| (face.point(u, v) - point).norm();
    let share = |k: usize, count: usize| k as f64 / count as f64;
    let places =
        (0..=SAMPLES[0]).flat_map(|i| (0..=SAMPLES[1]).map(move |j| [share(i, SAMPLES[0]), share(j, SAMPLES[1])]));
    let starts = places.map(|at| Minimum { at, value: distance(at) });
    let start =
        starts.min_by(|a, b| a.value.total_cmp(&b.value)).unwrap_or(Minimum { at: [0.5; 2], value: f64::INFINITY });
    descend([[0.0, 1.0]; 2], start, SAMPLES.map(|count| 0.5 / count as f64), distance)
}

/// T1 to T4.
fn place(section: &PlungeSection, corner: usize) -> Point {
    let Boundary { roof, floor, .. } = &section.boundary;
    section.plane.point(if corner < 2 { &roof[corner] } else { &floor[corner - 2] })
}

/// Direction of the left (0) or right (1) boundary axis.
fn axis(section: &PlungeSection, side: usize) -> Vector {
    (place(section, side) - place(section, side + 2)).normalize()
}

/// Distances at T1 to T4 of two planes, square to their axes.
fn distances_mm(from: &GridPlane, to: &GridPlane) -> [f64; 4] {
    [0, 1, 2, 3].map(|corner| {
        let way = place(&to.section, corner) - place(&from.section, corner);
        let along = axis(&from.section, corner % 2);
        (way - along * way.dot(&along)).norm()
    })
}

fn largest_mm(from: &GridPlane, to: &GridPlane) -> f64 {
    distances_mm(from, to).into_iter().fold(0.0, f64::max)
}

/// Step between two planes over the allowed one, at most (1).
fn ratio(from: &GridPlane, to: &GridPlane) -> f64 {
    let distances_mm = distances_mm(from, to);
    (0..4).map(|corner| distances_mm[corner] / from.steps_mm[corner].min(to.steps_mm[corner])).fold(0.0, f64::max)
}
