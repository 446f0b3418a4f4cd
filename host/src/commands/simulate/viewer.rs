//! Data for the report's viewer: both runs with the values along them, list of findings, tools, remaining heights and
//! NC text.

use arcfeed_dexel::tool::Tool;
use arcfeed_hil_sim::path_trace::{PathTrace, TracePoint};
use arcfeed_hil_sim::removal::cutter::StockCutter;
use arcfeed_hil_sim::removal::placement::UP;
use arcfeed_hil_sim::removal::rate::windows;
use arcfeed_milling::cutting::meter::MoveChips;
use arcfeed_model::job::Job;
use arcfeed_model::tool::Tool as JobTool;
use arcfeed_units::{LengthUnit, Micros, Nm};

use super::chip_quantity::ChipQuantity;
use super::listing::ProgramListing;
use super::observer::RunObserver;
use super::run_findings::findings;
use super::stock_frames::StockFrames;
use crate::report::figures::RunReport;
use crate::report::material::VolumeUnit;
use crate::report::page::viewer::column::{Column, ColumnHead};
use crate::report::page::viewer::{HeightGrid, RunPath, ViewerData};

/// Step of the components of a tool's axis.
const AXIS_QUANTUM: f64 = 1e-6;

/// W per kW.
const W_PER_KW: f64 = 1e3;

/// Height of a tool without a workpiece in the job, over its radius.
const HEIGHT_RATIO: f64 = 2.0;

/// Value over time: beginning, end, value.
type Window = (Micros, Micros, f64);

/// Data from which those of the viewer are made. Of two runs, the first is the run itself, the second that of the
/// original program.
pub struct ViewerInput<'a> {
    /// Title of the report.
    pub title: &'a str,
    /// Results of the run.
    pub report: &'a RunReport,
    /// Job.
    pub job: &'a Job,
    /// Observers of both runs.
    pub runs: [&'a RunObserver; 2],
    /// Measured chips of each move, for both runs.
    pub chips: [&'a [MoveChips]; 2],
    /// Text of the program, with the line of each executed block.
    pub listing: &'a ProgramListing,
}

/// Data of the viewer for both runs.
pub fn viewer_data(input: &ViewerInput<'_>) -> ViewerData {
    let ViewerInput { title, report, job, runs: [after, before], chips, listing } = *input;
    let sides = [("before", before, &listing.block_lines[1]), ("after", after, &listing.block_lines[0])];
    ViewerData {
        title: title.to_owned(),
        unit: job.unit.label(),
        runs: sides.map(|(name, observer, lines)| run(job, name, observer, lines)).into(),
        tools: outlines(job, after.cutter.as_ref()),
        heights: after
            .cutter
            .as_ref()
            .zip(after.stock.as_ref())
            .map(|(cutter, stock)| heights(cutter, stock, job.unit)),
        solids: Vec::new(),
        findings: findings(report, job, chips),
        lines: listing.lines.clone(),
        purposes: &[],
        is_live: false,
    }
}

/// Values along a path, as columns of the viewer; `lines` has the line of the program for each block.
pub fn path_columns(job: &Job, points: &[TracePoint], lines: &[Option<usize>]) -> Vec<Column> {
    let unit = job.unit;
    let is_inch = unit == LengthUnit::Inch;
    let (position, feed) = if is_inch { (1e-5, 1e-2) } else { (1e-4, 1e-1) };
    let feed_unit = if is_inch { "in/min" } else { "mm/min" };
    let column = |name, unit, quantum, value: &dyn Fn(&TracePoint) -> Option<f64>| {
        Column::new(ColumnHead { name, unit, quantum }, points.iter().map(value))
    };
    let in_unit = |mm: f64| mm / unit.mm();
    let line = |point: &TracePoint| lines.get((point.block as usize).checked_sub(1)?).copied().flatten();
    let mut columns = vec![
        column("time", "s", 1e-3, &|point| Some(point.at.to_s())),
        column("x", unit.label(), position, &|point| Some(in_unit(point.position_mm[0]))),
        column("y", unit.label(), position, &|point| Some(in_unit(point.position_mm[1]))),
        column("z", unit.label(), position, &|point| Some(in_unit(point.position_mm[2]))),
        column("block", "", 1.0, &|point| Some(f64::from(point.block))),
        column("line", "", 1.0, &|point| line(point).map(|line| line as f64)),
        column("rapid", "", 1.0, &|point| Some(f64::from(u8::from(point.is_rapid)))),
        column("feed", feed_unit, feed, &|point| Some(in_unit(point.feed_mm_per_min)).filter(|_| !point.is_rapid)),
        column(ChipQuantity::of(job).column(), "", 1e-3, &|point| point.chip_ratio),
        column("override", "%", 1.0, &|point| Some(f64::from(point.percent))),
    ];
    if points.iter().any(|point| point.axis != UP) {
        let axes = [("i", 0), ("j", 1), ("k", 2)];
        columns.extend(axes.map(|(name, axis)| column(name, "", AXIS_QUANTUM, &move |point| Some(point.axis[axis]))));
    }
    if job.tools.len() > 1 {
        columns.push(column("tool", "", 1.0, &|point| job.tool_in(point.tool).map(|tool| tool as f64)));
    }
    columns
}

fn run(job: &Job, name: &'static str, observer: &RunObserver, lines: &[Option<usize>]) -> RunPath {
    let points = observer.path.as_ref().map_or(&[][..], PathTrace::points);
    let (unit, mut columns) = (job.unit, path_columns(job, points, lines));
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

/// Closed outline of each tool of a job, as points (radius, height above the tip) in the job's unit.
pub fn outlines(job: &Job, cutter: Option<&StockCutter>) -> Vec<Vec<[f64; 2]>> {
    let mut solids = cutter.into_iter().flat_map(StockCutter::tools);
    job.tools.iter().map(|setup| outline(&setup.tool, solids.next(), job.unit)).collect()
}

/// Closed outline of the cutting solid if there is one, otherwise of a cylinder or a ring of an assumed height.
fn outline(tool: &JobTool, cutting: Option<&Tool>, unit: LengthUnit) -> Vec<[f64; 2]> {
    let own =
        |radii: [f64; 2], height: f64| vec![[radii[1], 0.0], [radii[0], 0.0], [radii[0], height], [radii[1], height]];
    let outline_mm = match (cutting, tool) {
        (Some(cutting), _) => solid(cutting),
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

/// Heights of the stock over the run.
fn heights(cutter: &StockCutter, stock: &StockFrames, unit: LengthUnit) -> HeightGrid {
    let (lattice, in_unit) = (cutter.stock().lattice(), |mm: f64| mm / unit.mm());
    let quantum = if unit == LengthUnit::Inch { 1e-4 } else { 1e-3 };
    let height = ColumnHead { name: "height", unit: unit.label(), quantum };
    let count = |name| ColumnHead { name, unit: "", quantum: 1.0 };
    let frames = stock.frames();
    let ends = frames.iter().scan(0, |end, frame| {
        *end += frame.changes.len();
        Some(Some(*end as f64))
    });
    let changes = || frames.iter().flat_map(|frame| &frame.changes);
    HeightGrid {
        columns: stock.columns,
        lowest: StockFrames::lowest_mm(lattice).map(in_unit),
        step: in_unit(stock.step_mm(lattice)),
        heights: Column::new(height, stock.first.iter().map(|height| height.map(in_unit))),
        frames: [
            Column::new(
                ColumnHead { name: "at", unit: "s", quantum: 1e-3 },
                frames.iter().map(|frame| Some(frame.at.to_s())),
            ),
            Column::new(count("end"), ends),
        ],
        changes: [
            Column::new(count("cell"), changes().map(|(cell, _)| Some(*cell as f64))),
            Column::new(height, changes().map(|(_, height)| height.map(in_unit))),
        ],
    }
}
