//! The repaired blade as closed solids: as it stands before, and as it will be.
//!
//! The repaired side is displaced along its normals by the measured heights, or by what finishing leaves. The other side is the nominal one; of a repair over
//! an edge both sides are displaced.

use super::blade::sides;
use super::plan::RepairPlan;
use crate::geometry::blisk::Blade;
use crate::geometry::blisk::Blisk;
use crate::geometry::edge_strip::{BladeEdge, EdgeStrip};
use crate::geometry::flaws::BladeSide;
use crate::geometry::mesh::{Triangle, displaced_blade};
use crate::geometry::surface::{Surface, Unfolded};
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

/// Angle between two places on an edge about which the normal turns.
const FAN_RAD: f64 = 0.05;

/// Triangles of the blade with this number before the repair is milled, with its measured surface on the side to be repaired.
pub fn standing_blade(blisk: &Blisk, number: u32, side: BladeSide, plan: &RepairPlan) -> Vec<Triangle> {
    solid(blisk, number, side, |at, point| plan.standing_mm(at, point))
}

/// Triangles of the blade with this number after finishing, with what finishing leaves on the repaired side.
pub fn left_blade(blisk: &Blisk, number: u32, side: BladeSide, plan: &RepairPlan) -> Vec<Triangle> {
    solid(blisk, number, side, |at, point| plan.left_mm(at, point))
}

/// [`standing_blade`] of a repair over an edge, with the measured surface on both sides.
pub fn standing_edge(blisk: &Blisk, number: u32, strip: &EdgeStrip<'_>, plan: &RepairPlan) -> Vec<Triangle> {
    over_edge(blisk, number, strip, |at, place| plan.standing_mm(at, place))
}

/// [`left_blade`] of a repair over an edge.
pub fn left_edge(blisk: &Blisk, number: u32, strip: &EdgeStrip<'_>, plan: &RepairPlan) -> Vec<Triangle> {
    over_edge(blisk, number, strip, |at, place| plan.left_mm(at, place))
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
    displaced_blade(&blade, ROOT_MM, GRID_MM, &[], place)
}

/// Each side reaches over its half of the edge.
fn over_edge(
    blisk: &Blisk,
    number: u32,
    strip: &EdgeStrip<'_>,
    height_mm: impl Fn([f64; 2], Unfolded) -> f64,
) -> Vec<Triangle> {
    let [pressure, suction] = sides(blisk, number);
    let parts = libm::ceil(strip.edge_angle_rad() / FAN_RAD).max(1.0) as usize;
    let share = |k: usize| k as f64 / parts as f64;
    let beyond: Vec<f64> = match strip.edge() {
        BladeEdge::Leading => (0..parts).map(|k| share(k) - 1.0).collect(),
        BladeEdge::Trailing => (1..=parts).map(|k| 1.0 + share(k)).collect(),
    };
    let place = |of: BladeSide, u: f64, span: f64| {
        let at = [span, strip.v_on_side(usize::from(of == BladeSide::Suction), u)];
        let (point, normal) = strip.point_and_normal(at);
        point + normal * height_mm(at, strip.unfolded(at, &point))
    };
    displaced_blade(&Blade { pressure, suction }, ROOT_MM, GRID_MM, &beyond, place)
}
