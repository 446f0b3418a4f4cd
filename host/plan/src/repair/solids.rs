//! The repaired blade as closed solids: as it stands before, and as it will be.
//!
//! The repaired side is displaced along its normals by the measured heights, or by what finishing leaves. The other side is the nominal one.

use super::blade::sides;
use super::plan::RepairPlan;
use crate::geometry::blisk::Blisk;
use crate::geometry::flaws::BladeSide;
use crate::geometry::mesh::{Triangle, displaced_blade};
use crate::geometry::slot::Blade;
use crate::vector::Point;

/// Depth of the solids below the lowest section.
const ROOT_MM: f64 = 2.0;
/// Chord error of the nominal surface, and greatest distance of places.
const GRID_MM: [f64; 2] = [0.002, 0.25];
/// Largest distance of the finished solid's triangles from its surface: that of the grid, and 0.001 mm for the blend. On a slope of 1 in 20 at most, a kink
/// of the linear blend is off by 0.25 / 4 / 20 = 0.003 mm between two places.
pub const LEFT_CHORD_MM: f64 = 0.002 + 0.003;
/// The same of the blade as it stands: its measured surface is not known better.
pub const STOCK_CHORD_MM: f64 = 0.02;

/// Triangles of the blade with this number before the repair is milled, with its measured surface on the side to be repaired.
pub fn standing_blade(blisk: &Blisk, number: u32, side: BladeSide, plan: &RepairPlan) -> Vec<Triangle> {
    solid(blisk, number, side, |at, _| plan.standing_mm(at))
}

/// Triangles of the blade with this number after finishing, with what finishing leaves on the repaired side.
pub fn left_blade(blisk: &Blisk, number: u32, side: BladeSide, plan: &RepairPlan) -> Vec<Triangle> {
    solid(blisk, number, side, |at, point| plan.left_mm(at, point))
}

fn solid(blisk: &Blisk, number: u32, side: BladeSide, height_mm: impl Fn([f64; 2], &Point) -> f64) -> Vec<Triangle> {
    let [pressure, suction] = sides(blisk, number);
    let blade = Blade { pressure, suction };
    let place = |of: BladeSide, u: f64, v: f64| {
        let face = match of {
            BladeSide::Pressure => &blade.pressure,
            BladeSide::Suction => &blade.suction,
        };
        let point = face.point(u, v);
        // A repair has its first parameter along the span.
        if of == side { point + face.normal(u, v) * height_mm([v, u], &point) } else { point }
    };
    displaced_blade(&blade, ROOT_MM, GRID_MM, place)
}
