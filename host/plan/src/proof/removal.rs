//! Volume that the ring removes from the blank, and the removed fraction of the slot.
//!
//! Columns along the tool axis stand on a square grid, each from the blank's top to the floor that the ring leaves.
//! They are at the cells' midpoints, so the error decreases at least with the cell's size, and the difference to a grid
//! of twice the size shows how large it is. The slot is the volume between the offset faces, from leading edge to
//! leading edge, from the hub's offset to the blank's outside: cells with straight edges, each removed or not by one
//! point of it. The points are shifted from one bar of cells across the slot to the next by the golden ratio: the ring
//! leaves layers along the walls, thinner than a cell, which points in rows would either all hit or all miss.
//!
//! Material that earlier passes have removed counts for none of the levels.

use nalgebra::Rotation3;

use crate::geometry::blisk::Blank;
use crate::vector::{Flat, Point, Vector};

use super::earlier::Earlier;
use super::floor::Floor;
use super::remaining::SlotWalls;

/// Golden ratio; its multiples fill the unit interval evenly.
const GOLDEN_RATIO: f64 = 1.618_033_988_749_895;

/// Volume of a slot up to which the cells of a comparison have the size asked for.
const COMPARED_MM3: f64 = 100_000.0;

/// Volumes that a path of a cup mill removes, level by level, mm3.
#[derive(Clone, Debug, PartialEq)]
pub struct RemovedVolumes {
    /// Volume removed by each level, from the top.
    pub by_level_mm3: Vec<f64>,
    /// Estimated error of their sum: the difference to a grid of cells of twice the size.
    pub error_mm3: f64,
    /// Volume of the slot, between its surfaces with their allowance.
    pub slot_mm3: f64,
    /// Volume removed from the slot by each level, from the top.
    pub slot_by_level_mm3: Vec<f64>,
}

/// Blank as seen by the tool, for columns of material along the tool's axis.
pub struct Stock<'s> {
    /// Blank.
    pub blank: &'s Blank,
    /// Rotation from the part frame to the slot frame.
    pub to_slot: Rotation3<f64>,
    /// Passes whose material is gone already.
    pub earlier: Earlier<'s>,
}

impl RemovedVolumes {
    /// Volume that all levels remove together, mm3.
    pub fn total_mm3(&self) -> f64 {
        self.by_level_mm3.iter().sum()
    }

    /// Fraction of the slot's volume that all levels remove, 0 to 1.
    pub fn share_ratio(&self) -> f64 {
        self.slot_removed_mm3() / self.slot_mm3
    }

    /// Volume that all levels remove from the slot, mm3.
    pub fn slot_removed_mm3(&self) -> f64 {
        self.slot_by_level_mm3.iter().sum()
    }

    /// Adds the volume between the offset surfaces, and the removed part of it.
    fn add_slot(&mut self, floor: &Floor, stock: &Stock<'_>, walls: &SlotWalls<'_>, cell_mm: f64) {
        let feet = |u: f64, v: f64| [0, 1].map(|side| walls.side(side, u, v));
        let [columns, rows, layers] =
            extents_mm(walls).map(|extent_mm| (libm::ceil(extent_mm / cell_mm) as usize).max(1));
        let share = |k: usize, count: usize| k as f64 / count as f64;
        let row = |row: usize| (0..=columns).map(|column| feet(share(column, columns), share(row, rows))).collect();
        let lattice: Vec<Vec<[Point; 2]>> = (0..=rows).map(row).collect();
        let bars = lattice.windows(2).flat_map(|pair| pair[0].windows(2).zip(pair[1].windows(2)));
        for (bar, (low, high)) in bars.enumerate() {
            let edges = [low[0], low[1], high[1], high[0]];
            let shift = (bar as f64 * GOLDEN_RATIO).fract();
            for layer in 0..layers {
                let cut = |share: f64| edges.map(|[from, to]| from + (to - from) * share);
                let volume_mm3 = volume_mm3(&[share(layer, layers), share(layer + 1, layers)].map(cut));
                let point = middle(cut((layer as f64 + shift) / layers as f64));
                let [bottom_mm, top_mm] = stock.column_mm(&point.xy());
                if !walls.is_hub(&point) && (bottom_mm..=top_mm).contains(&point.z) {
                    self.slot_mm3 += volume_mm3;
                    let level = floor.first_level(&point);
                    if let Some(level) = level.filter(|_| !stock.earlier.has_removed(&point)) {
                        self.slot_by_level_mm3[level] += volume_mm3;
                    }
                }
            }
        }
    }
}

/// Volumes that a path of `levels` levels removes, computed with cells of `cell_mm`; `floor` is what the path leaves.
pub fn removed(floor: &Floor, levels: usize, stock: &Stock<'_>, walls: &SlotWalls<'_>, cell_mm: f64) -> RemovedVolumes {
    let by_level_mm3 = stock.cut_mm3(floor, levels, cell_mm);
    let coarse_mm3: f64 = stock.cut_mm3(floor, levels, 2.0 * cell_mm).iter().sum();
    let error_mm3 = (by_level_mm3.iter().sum::<f64>() - coarse_mm3).abs();
    let mut removed = RemovedVolumes { by_level_mm3, error_mm3, slot_mm3: 0.0, slot_by_level_mm3: vec![0.0; levels] };
    removed.add_slot(floor, stock, walls, cell_mm);
    removed
}

/// Only the fraction of the slot's volume that the path removes, 0 to 1, as in [`removed`]. A slot of more than 100 cm3 has larger cells,
/// as many as one of 100 cm3.
pub fn slot_share_ratio(floor: &Floor, levels: usize, stock: &Stock<'_>, walls: &SlotWalls<'_>, cell_mm: f64) -> f64 {
    let (by_level_mm3, slot_by_level_mm3) = (Vec::new(), vec![0.0; levels]);
    let mut removed = RemovedVolumes { by_level_mm3, error_mm3: 0.0, slot_mm3: 0.0, slot_by_level_mm3 };
    let size_mm3: f64 = extents_mm(walls).iter().product();
    removed.add_slot(floor, stock, walls, cell_mm * libm::cbrt(size_mm3 / COMPARED_MM3).max(1.0));
    removed.share_ratio()
}

/// Lengths of the slot between its walls, half way along the other two: along a wall, up a wall, and from wall to wall.
fn extents_mm(walls: &SlotWalls<'_>) -> [f64; 3] {
    let at = |side: usize, u: f64, v: f64| walls.side(side, u, v);
    let ends =
        [[at(0, 0.0, 0.5), at(0, 1.0, 0.5)], [at(0, 0.5, 0.0), at(0, 0.5, 1.0)], [at(0, 0.5, 0.5), at(1, 0.5, 0.5)]];
    ends.map(|[from, to]| (to - from).norm())
}

impl Stock<'_> {
    /// Lower and upper end of the blank's material along the tool's axis over a point; empty if the first is not below the second.
    pub fn column_mm(&self, place: &Flat) -> [f64; 2] {
        let back = self.to_slot.inverse();
        let (origin, up) = (back * Point::new(place.x, place.y, 0.0), back * Vector::z());
        let (square, half) = (up.xy().norm_squared(), origin.coords.xy().dot(&up.xy()));
        let rest = origin.coords.xy().norm_squared() - self.blank.radius_mm * self.blank.radius_mm;
        let root = libm::sqrt(half * half - square * rest);
        if root.is_nan() {
            return [0.0; 2];
        }
        let around = [(-half - root) / square, (-half + root) / square];
        let between = self.blank.faces_mm.map(|face_mm| face_mm - origin.z);
        let between = match up.z {
            z if z.abs() > 1e-9 => between.map(|way_mm| way_mm / z),
            _ if between[0] <= 0.0 && between[1] >= 0.0 => [f64::NEG_INFINITY, f64::INFINITY],
            _ => return [0.0; 2],
        };
        [around[0].max(between[0].min(between[1])), around[1].min(between[0].max(between[1]))]
    }

    /// Length of material between two heights over a point. Earlier passes are looked up at heights up to `step_mm` apart.
    fn solid_mm(&self, place: &Flat, [low_mm, high_mm]: [f64; 2], step_mm: f64) -> f64 {
        let way_mm = high_mm - low_mm;
        if self.earlier.is_empty() || way_mm <= 0.0 {
            return way_mm;
        }
        let count = libm::ceil(way_mm / step_mm);
        let at = |k: u32| Point::new(place.x, place.y, low_mm + way_mm * (f64::from(k) + 0.5) / count);
        let solid = (0..count as u32).filter(|k| !self.earlier.has_removed(&at(*k))).count();
        way_mm * solid as f64 / count
    }

    /// Extent of the blank along x and y: low and high.
    fn reach_mm(&self) -> [[f64; 2]; 2] {
        let axis = self.to_slot * Vector::z();
        [axis.x, axis.y].map(|along| {
            let wide_mm = self.blank.radius_mm * libm::sqrt((1.0 - along) * (1.0 + along));
            let [a, b] = self.blank.faces_mm.map(|face_mm| face_mm * along);
            [a.min(b) - wide_mm, a.max(b) + wide_mm]
        })
    }

    /// Volume removed by each level.
    fn cut_mm3(&self, floor: &Floor, levels: usize, cell_mm: f64) -> Vec<f64> {
        let [xs, ys] = self.reach_mm().map(|reach_mm| middles(reach_mm, cell_mm));
        let mut taken_mm3 = vec![0.0; levels];
        for place in ys.iter().flat_map(|y| xs.iter().map(|x| Flat::new(*x, *y))) {
            let [low_mm, high_mm] = self.column_mm(&place);
            if low_mm >= high_mm || !floor.may_reach(&place) {
                continue;
            }
            let mut top_mm = high_mm;
            for (taken, floor_mm) in taken_mm3.iter_mut().zip(floor.by_level_mm(&place, levels)) {
                let down_mm = floor_mm.clamp(low_mm, top_mm);
                *taken += self.solid_mm(&place, [down_mm, top_mm], cell_mm) * cell_mm * cell_mm;
                top_mm = down_mm;
            }
        }
        taken_mm3
    }
}

/// Middles of the cells that cover an interval; they are at the same places for every interval.
fn middles([low_mm, high_mm]: [f64; 2], cell_mm: f64) -> Vec<f64> {
    let (first, last) = (libm::floor(low_mm / cell_mm) as i64, libm::ceil(high_mm / cell_mm) as i64);
    (first..last).map(|k| (k as f64 + 0.5) * cell_mm).collect()
}

fn middle(points: [Point; 4]) -> Point {
    Point::from(points.iter().map(|point| point.coords).sum::<Vector>() / 4.0)
}

/// Volume between two quadrilaterals, by the vectors between the middles of opposite sides.
fn volume_mm3([near, far]: &[[Point; 4]; 2]) -> f64 {
    let side = |a: usize, b: usize| middle([near[a], near[b], far[a], far[b]]);
    let across = middle(*far) - middle(*near);
    across.dot(&(side(1, 2) - side(0, 3)).cross(&(side(2, 3) - side(0, 1)))).abs()
}
