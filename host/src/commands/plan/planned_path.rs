//! Parts of the viewer's data that the pages of all plans share: the path with its purposes, outline of the tool, and solids.

use std::collections::HashMap;

use arcfeed_plan::geometry::mesh::Triangle;
use arcfeed_plan::vector::Point;
use arcfeed_units::{LengthUnit, S_PER_MIN};

use crate::report::page::viewer::column::{Column, ColumnHead};
use crate::report::page::viewer::{RunPath, Solid};

/// Name of the run.
pub const RUN: &str = "planned";
/// Largest distance of drawn blades and hub from their surfaces.
pub const CHORD_MM: f64 = 0.1;
/// Step of the components of a tool's axis.
const AXIS_QUANTUM: f64 = 1e-6;

/// Point of a planned path, with the values on the way to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint {
    /// Time at the point; [`timed`] sets it.
    pub time_s: f64,
    /// Position of the tool's tip.
    pub place_mm: [f64; 3],
    /// Unit vector from the tip towards the holder; `None` for a tool that stands along Z on the whole path.
    pub axis: Option<[f64; 3]>,
    /// Line of the list of moves, counted from 1.
    pub line: usize,
    /// Feed; `None` for rapids.
    pub feed_mm_per_min: Option<f64>,
    /// Index of the move's purpose; `None` for rapids.
    pub purpose: Option<usize>,
}

/// Seconds of a move. Rapids of a plan have no feed: they are shown as fast as its largest one.
pub fn seconds(length_mm: f64, feed_mm_per_min: Option<f64>, largest_mm_per_min: f64) -> f64 {
    length_mm / feed_mm_per_min.unwrap_or(largest_mm_per_min).max(f64::MIN_POSITIVE) * S_PER_MIN
}

/// The path as a run of the viewer.
pub fn run(unit: LengthUnit, points: &[PathPoint]) -> RunPath {
    let column = |name, unit, quantum, value: &dyn Fn(&PathPoint) -> Option<f64>| {
        Column::new(ColumnHead { name, unit, quantum }, points.iter().map(value))
    };
    let (is_inch, mm) = (unit == LengthUnit::Inch, unit.mm());
    let quantum = if is_inch { 1e-5 } else { 1e-4 };
    let feed_unit = if is_inch { "in/min" } else { "mm/min" };
    let number = |point: &PathPoint| Some(point.line as f64);
    let is_rapid = |point: &PathPoint| Some(f64::from(u8::from(point.feed_mm_per_min.is_none())));
    let mut columns = vec![column("time", "s", 1e-3, &|point| Some(point.time_s))];
    let axes = [("x", 0), ("y", 1), ("z", 2)];
    columns.extend(
        axes.map(|(name, axis)| column(name, unit.label(), quantum, &move |point| Some(point.place_mm[axis] / mm))),
    );
    columns.extend([
        column("block", "", 1.0, &number),
        column("line", "", 1.0, &number),
        column("rapid", "", 1.0, &is_rapid),
        column("feed", feed_unit, 1e-2, &|point| point.feed_mm_per_min.map(|feed| feed / mm)),
        column("purpose", "", 1.0, &|point| point.purpose.map(|purpose| purpose as f64)),
    ]);
    let directions = [("i", 0), ("j", 1), ("k", 2)];
    columns
        .extend(directions.map(|(name, axis)| column(name, "", AXIS_QUANTUM, &move |point| Some(point.axis?[axis]))));
    columns.retain(|column| !column.has_no_value());
    RunPath { name: RUN, columns }
}

/// The path with the times that its moves take.
pub fn timed(mut points: Vec<PathPoint>) -> Vec<PathPoint> {
    let largest = points.iter().filter_map(|point| point.feed_mm_per_min).fold(0.0, f64::max);
    for at in 1..points.len() {
        let [from, to] = [at - 1, at].map(|at| Point::from(points[at].place_mm));
        let time_s = seconds((to - from).norm(), points[at].feed_mm_per_min, largest);
        points[at].time_s = points[at - 1].time_s + time_s;
    }
    points
}

/// Closed outline of an end mill in the part's unit: `end_mm` are radius, corner radius and length of the cutting part; the cylinders
/// of neck and holder above it have a radius and a length each.
pub fn mill_outline<'a>(
    unit: LengthUnit,
    [radius_mm, corner_mm, length_mm]: [f64; 3],
    cylinders: impl IntoIterator<Item = &'a [f64; 2]>,
) -> Vec<[f64; 2]> {
    let end = rounded_end(radius_mm, corner_mm);
    end.chain(outside(radius_mm, length_mm, cylinders)).map(|point| point.map(|mm| mm / unit.mm())).collect()
}

/// Points of the outside of a tool, from the top of its cutting part up along the cylinders, each a radius and a length, to the axis.
pub fn outside<'a>(radius_mm: f64, length_mm: f64, cylinders: impl IntoIterator<Item = &'a [f64; 2]>) -> Vec<[f64; 2]> {
    let (mut points, mut top_mm) = (vec![[radius_mm, length_mm]], length_mm);
    for [radius_mm, length_mm] in cylinders {
        points.extend([[*radius_mm, top_mm], [*radius_mm, top_mm + length_mm]]);
        top_mm += length_mm;
    }
    points.push([0.0, top_mm]);
    points
}

/// Points of the end of a mill with a corner radius, from its axis outwards and upwards.
fn rounded_end(radius_mm: f64, corner_mm: f64) -> impl Iterator<Item = [f64; 2]> {
    const STEPS: u32 = 8;
    let corner = (0..=STEPS).map(move |k| {
        let (sin, cos) = libm::sincos(core::f64::consts::FRAC_PI_2 * f64::from(k) / f64::from(STEPS));
        [radius_mm - corner_mm * (1.0 - sin), corner_mm * (1.0 - cos)]
    });
    std::iter::once([0.0, 0.0]).chain(corner)
}

/// Triangles with each corner once.
pub fn solid(unit: LengthUnit, name: &'static str, triangles: &[Triangle]) -> Solid {
    let (mut vertices, mut corners, mut known) = (Vec::new(), Vec::new(), HashMap::new());
    for corner in triangles.iter().flatten() {
        let place = [corner.x, corner.y, corner.z];
        let index = *known.entry(place.map(f64::to_bits)).or_insert_with(|| {
            vertices.push(place);
            vertices.len() - 1
        });
        corners.push(index);
    }
    solid_of(unit, name, &vertices, corners)
}

/// Solid of vertices and of the corners of its triangles.
pub fn solid_of(
    unit: LengthUnit,
    name: &'static str,
    vertices: &[[f64; 3]],
    corners: impl IntoIterator<Item = usize>,
) -> Solid {
    let along = |name, axis: usize| {
        let head = ColumnHead { name, unit: unit.label(), quantum: 1e-4 };
        Column::new(head, vertices.iter().map(|vertex| Some(vertex[axis] / unit.mm())))
    };
    let corner = ColumnHead { name: "corner", unit: "", quantum: 1.0 };
    Solid {
        name,
        vertices: [along("x", 0), along("y", 1), along("z", 2)],
        corners: Column::new(corner, corners.into_iter().map(|index| Some(index as f64))),
        values: Vec::new(),
    }
}
