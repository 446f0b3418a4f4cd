//! Data of the report's viewer: both runs with their values, findings, tool, remaining heights and NC text.

use arcfeed_dexel::deviation::HeightMap;
use arcfeed_dexel::lattice::Lattice;
use arcfeed_dexel::tool::Tool;
use arcfeed_hil_sim::removal::cutter::StockCutter;
use arcfeed_hil_sim::removal::rate::windows;
use arcfeed_milling::cutting::meter::MoveChips;
use arcfeed_model::job::Job;
use arcfeed_model::tool::Tool as JobTool;
use arcfeed_units::{LengthUnit, Micros, Nm};

use super::edges::UPRIGHT;
use super::listing::ProgramListing;
use super::observer::RunObserver;
use super::path_trace::TracePoint;
use super::run_findings::findings;
use crate::report::figures::RunReport;
use crate::report::material::VolumeUnit;
use crate::report::page::viewer::column::{Column, ColumnHead};
use crate::report::page::viewer::{HeightGrid, RunPath, ViewerData};

/// Most cells of the remaining heights along an edge; more share a cell.
const CELLS_MAX: usize = 256;

/// W per kW.
const W_PER_KW: f64 = 1e3;

/// Height of a tool without a workpiece in the job, over its radius.
const HEIGHT_RATIO: f64 = 2.0;

/// Value over time: beginning, end, value.
type Window = (Micros, Micros, f64);

/// Input of the viewer: the run and the original program.
pub struct ViewerInput<'a> {
    /// Title of the report.
    pub title: &'a str,
    /// Figures of the run.
    pub report: &'a RunReport,
    /// Job.
    pub job: &'a Job,
    /// Observers of the runs.
    pub runs: [&'a RunObserver; 2],
    /// Measured chips, move by move.
    pub chips: [&'a [MoveChips]; 2],
    /// Program's lines, and those of the executed blocks.
    pub listing: &'a ProgramListing,
}

/// Data of the viewer for both runs.
pub fn viewer_data(input: &ViewerInput<'_>) -> ViewerData {
    let ViewerInput { title, report, job, runs: [after, before], chips, listing } = *input;
    let sides = [("before", before, &listing.block_lines[1]), ("after", after, &listing.block_lines[0])];
    ViewerData {
        title: title.to_owned(),
        unit: job.unit.label(),
        runs: sides.map(|(name, observer, lines)| run(job.unit, name, observer, lines)).into(),
        tool: outline(&job.tools.first().tool, after.cutter.as_ref(), job.unit),
        heights: after.cutter.as_ref().map(|cutter| heights(cutter, job.unit)),
        findings: findings(report, job.unit, chips),
        lines: listing.lines.clone(),
        is_live: false,
    }
}

/// Columns of a path; `lines` has the line of the program for each block.
pub fn path_columns(unit: LengthUnit, points: &[TracePoint], lines: &[Option<usize>]) -> Vec<Column> {
    let is_inch = unit == LengthUnit::Inch;
    let (position, feed) = if is_inch { (1e-5, 1e-2) } else { (1e-4, 1e-1) };
    let feed_unit = if is_inch { "in/min" } else { "mm/min" };
    let column = |name, unit, quantum, value: &dyn Fn(&TracePoint) -> Option<f64>| {
        Column::new(ColumnHead { name, unit, quantum }, points.iter().map(value))
    };
    let in_unit = |mm: f64| mm / unit.mm();
    let line = |point: &TracePoint| lines.get((point.block as usize).checked_sub(1)?).copied().flatten();
    vec![
        column("time", "s", 1e-3, &|point| Some(point.at.to_s())),
        column("x", unit.label(), position, &|point| Some(in_unit(point.position_mm[0]))),
        column("y", unit.label(), position, &|point| Some(in_unit(point.position_mm[1]))),
        column("z", unit.label(), position, &|point| Some(in_unit(point.position_mm[2]))),
        column("block", "", 1.0, &|point| Some(f64::from(point.block))),
        column("line", "", 1.0, &|point| line(point).map(|line| line as f64)),
        column("rapid", "", 1.0, &|point| Some(f64::from(u8::from(point.is_rapid)))),
        column("feed", feed_unit, feed, &|point| Some(in_unit(point.feed_mm_per_min)).filter(|_| !point.is_rapid)),
        column("chip", "", 1e-3, &|point| point.chip_ratio),
        column("override", "%", 1.0, &|point| Some(f64::from(point.percent))),
    ]
}

fn run(unit: LengthUnit, name: &'static str, observer: &RunObserver, lines: &[Option<usize>]) -> RunPath {
    let points = observer.trace.points();
    let mut columns = path_columns(unit, points, lines);
    let mut add = |name, unit, quantum, windows: Vec<Window>| {
        columns.push(Column::new(ColumnHead { name, unit, quantum }, largest(points, &windows)));
    };
    if let Some(cutter) = &observer.cutter {
        let volumes = VolumeUnit::of(unit);
        let found = windows(cutter.pieces().iter(), cutter.stock().lattice().step_mm());
        let found = found.iter().map(|window| (window.from, window.to, volumes.of_mm3(window.rate_per_min())));
        add("removal", volumes.rate_label, 1e-3, found.collect());
    }
    if let Some(loads) = &observer.loads {
        let windows = loads.windows();
        add("force", "N", 0.1, windows.iter().map(|w| (w.from, w.to, w.statistics.bending.max())).collect());
        let power = windows.iter().map(|w| (w.from, w.to, w.statistics.mean(&w.statistics.power) / W_PER_KW));
        add("power", "kW", 1e-3, power.collect());
    }
    columns.retain(|column| !column.has_no_value());
    RunPath { name, columns }
}

/// Largest value of the windows in each interval between two points.
fn largest(points: &[TracePoint], windows: &[Window]) -> Vec<Option<f64>> {
    let mut first = 0;
    let begins = std::iter::once(Micros(0)).chain(points.iter().map(|point| point.at));
    let value = |(begin, point): (Micros, &TracePoint)| {
        while windows.get(first).is_some_and(|(_, to, _)| *to <= begin) {
            first += 1;
        }
        let within = windows.iter().skip(first).take_while(|(from, ..)| *from < point.at);
        within.map(|(.., value)| *value).reduce(f64::max)
    };
    begins.zip(points).map(value).collect()
}

/// Closed outline: of the cutting solid if there is one, otherwise a cylinder or a ring of an assumed height.
pub fn outline(tool: &JobTool, cutter: Option<&StockCutter>, unit: LengthUnit) -> Vec<[f64; 2]> {
    let own =
        |radii: [f64; 2], height: f64| vec![[radii[1], 0.0], [radii[0], 0.0], [radii[0], height], [radii[1], height]];
    let outline_mm = match (cutter, tool) {
        (Some(cutter), _) => solid(cutter.tool()),
        (None, JobTool::CupMill(cup)) => {
            let radii = [cup.outer_radius, cup.inner_radius].map(Nm::to_mm);
            own(radii, HEIGHT_RATIO * (radii[0] - radii[1]))
        }
        (None, JobTool::EndMill(mill)) => own([mill.radius.to_mm(), 0.0], HEIGHT_RATIO * mill.radius.to_mm()),
    };
    outline_mm.into_iter().map(|point| point.map(|mm| mm / unit.mm())).collect()
}

/// Up along the outside, down along the inside.
fn solid(tool: &Tool) -> Vec<[f64; 2]> {
    let slabs = tool.slabs();
    let outside = slabs.iter().flat_map(|slab| [0, 1].map(|end| [slab.outer_mm[end], slab.heights_mm[end]]));
    let inside = slabs.iter().rev().flat_map(|slab| {
        let inner_mm = slab.inner_mm.unwrap_or([0.0; 2]);
        [1, 0].map(|end| [inner_mm[end], slab.heights_mm[end]])
    });
    let mut points: Vec<[f64; 2]> = outside.chain(inside).collect();
    points.dedup();
    points
}

/// Highest material over each cell, seen along Z.
fn heights(cutter: &StockCutter, unit: LengthUnit) -> HeightGrid {
    let (stock, in_unit) = (cutter.stock(), |mm: f64| mm / unit.mm());
    let (lattice, map) = (stock.lattice(), HeightMap::new(stock, UPRIGHT));
    let [columns, _] = lattice.size(UPRIGHT);
    let rows: Vec<&[Option<f64>]> = map.heights_mm().chunks(columns.max(1)).collect();
    let shared = columns.max(rows.len()).div_ceil(CELLS_MAX).max(1);
    let width = columns.div_ceil(shared);
    let mut highest = Vec::with_capacity(width * rows.len().div_ceil(shared));
    for rows in rows.chunks(shared) {
        for column in 0..width {
            let cells = rows.iter().flat_map(|row| row.iter().skip(column * shared).take(shared)).flatten();
            highest.push(cells.copied().reduce(f64::max).map(in_unit));
        }
    }
    let quantum = if unit == LengthUnit::Inch { 1e-4 } else { 1e-3 };
    HeightGrid {
        columns: width,
        lowest: Lattice::across(UPRIGHT).map(|axis| in_unit(lattice.lowest_mm()[axis])),
        step: in_unit(lattice.step_mm()) * shared as f64,
        heights: Column::new(ColumnHead { name: "height", unit: unit.label(), quantum }, highest),
    }
}
