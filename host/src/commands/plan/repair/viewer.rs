//! Data of the viewer on the page of a repair: the path of the mill about the blade, and the maps of allowance as colours on its side.

use arcfeed_plan::repair::field::FieldNode;

use super::super::finish::viewer::{UNIT, data as path_data, surroundings};
use super::super::planned_path::{solid, solid_of};
use super::result::RepairResult;
use crate::report::page::viewer::column::{Column, ColumnHead};
use crate::report::page::viewer::{Solid, SurfaceValue, ViewerData};

/// Map of the material above the nominal surface, as measured.
pub const BEFORE: &str = "Allowance before";
/// Map of the material above the nominal surface that finishing is to leave.
pub const PLANNED: &str = "Allowance planned";
/// Map of the difference of both.
pub const TAKEN: &str = "Depth to be taken";
/// Map of the cusps that the planned path leaves.
pub const PREDICTED: &str = "Predicted result above the planned allowance";

/// Data of the viewer.
pub fn data(result: &RepairResult) -> ViewerData {
    let index = result.file.blade.cast_signed() - 1;
    let blades = solid(UNIT, "blades and hub", &surroundings(&result.file.part.blisk, index));
    path_data(format!("Repair: {}", result.file.name), &result.path, vec![blades, side(result)])
}

/// The measured side as it stands, with the values of the maps at the places of the lattice.
fn side(result: &RepairResult) -> Solid {
    let plan = &result.plan;
    let rows = &plan.field.rows;
    let wide = rows.first().map_or(0, Vec::len);
    let place = |node: &FieldNode| (node.point + node.normal * node.along_mm.unwrap_or(0.0)).into();
    let vertices: Vec<[f64; 3]> = rows.iter().flatten().map(place).collect();
    let cells = (1..rows.len()).flat_map(|row| (1..wide).map(move |column| row * wide + column));
    let corners = cells.flat_map(|at| [at - wide - 1, at - wide, at - 1, at - wide, at, at - 1]);
    let value = |label, value: &dyn Fn(usize, usize) -> Option<f64>| {
        let head = ColumnHead { name: "value", unit: UNIT.label(), quantum: 1e-4 };
        let places = (0..rows.len()).flat_map(|row| (0..wide).map(move |column| (row, column)));
        SurfaceValue { label, column: Column::new(head, places.map(|(row, column)| value(row, column))) }
    };
    let values = vec![
        value(BEFORE, &|i, j| rows[i][j].along_mm),
        value(PLANNED, &|i, j| plan.planned_mm[i][j].or(rows[i][j].along_mm)),
        value(TAKEN, &|i, j| Some((rows[i][j].along_mm? - plan.planned_mm[i][j]?).max(0.0))),
        value(PREDICTED, &|i, j| Some(result.predicted_mm[i][j]? - plan.planned_mm[i][j]?)),
    ];
    Solid { values, ..solid_of(UNIT, "measured side", &vertices, corners) }
}
