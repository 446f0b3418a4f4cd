//! Report page of a run, and files with the remaining surface of the stock.

use std::io::Cursor;
use std::path::Path;

use arcfeed_dexel::deviation::HeightMap;
use arcfeed_dexel::files::{write_ply, write_stl};
use arcfeed_dexel::lattice::Lattice;
use arcfeed_dexel::surface::surface;
use arcfeed_dexel::workpiece::Stock;
use arcfeed_hil_sim::removal::cutter::StockCutter;
use arcfeed_hil_sim::removal::marks::WallMark;
use arcfeed_hil_sim::removal::rate::windows;
use arcfeed_milling::cutting::meter::MoveChips;
use arcfeed_model::job::Job;

use super::super::outcome::{Failure, write_whole};
use super::chip_quantity::ChipQuantity;
use super::edges::UPRIGHT;
use super::feed_changes::FeedChanges;
use super::listing::ProgramListing;
use super::move_log::{Curve, DRAWN_MAX, MoveLog};
use super::observer::RunObserver;
use super::viewer::{ViewerInput, viewer_data};
use super::{load_figures, mark_figures, path_plot};
use crate::report::figures::RunReport;
use crate::report::material::{DeviationFigures, VolumeUnit};
use crate::report::page::loads::section as loads_section;
use crate::report::page::map::Map;
use crate::report::page::marks::section as marks_section;
use crate::report::page::plot::{Lane, Series, svg};
use crate::report::page::{Page, Section, tables};

/// Format of a surface file: STL or PLY.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceFormat {
    /// Binary STL.
    Stl,
    /// Binary PLY.
    Ply,
}

/// Content of the report page of a run.
pub struct PageContent<'a> {
    /// Headline of the page.
    pub title: &'a str,
    /// Text of the program, with the line of each executed block.
    pub listing: &'a ProgramListing,
    /// Results of the run.
    pub report: &'a RunReport,
    /// Job, of which the page needs the unit of lengths and the target chip load.
    pub job: &'a Job,
    /// The run and the original program.
    pub runs: [&'a RunObserver; 2],
    /// Measured chips of each move; first of the run, then of the original program.
    pub chips: [&'a [MoveChips]; 2],
    /// Deviation of the stock from the finished part, if the job describes one.
    pub deviation: Option<(HeightMap, DeviationFigures)>,
    /// Marks that the teeth left on walls.
    pub marks: Vec<WallMark>,
}

impl SurfaceFormat {
    /// Format that the ending of the file's name stands for.
    ///
    /// # Errors
    /// The name ends neither in `.stl` nor in `.ply`.
    pub fn of(path: &Path) -> Result<Self, Failure> {
        let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
        match extension.as_deref() {
            Some("stl") => Ok(SurfaceFormat::Stl),
            Some("ply") => Ok(SurfaceFormat::Ply),
            _ => Err(Failure::Usage(format!("--surface {}: write a name that ends in .stl or .ply", path.display()))),
        }
    }

    /// Writes the surface of the remaining stock; coordinates in mm.
    ///
    /// # Errors
    /// Nothing is left of the stock, or the file cannot be written.
    pub fn write(self, stock: &Stock, path: &Path) -> Result<(), Failure> {
        let input_failure = |error: &dyn std::fmt::Display| Failure::Input(format!("{}: {error}", path.display()));
        let mesh = surface(stock).map_err(|error| input_failure(&error))?;
        let mut bytes = Cursor::new(Vec::new());
        let written = match self {
            SurfaceFormat::Stl => write_stl(&mesh, &mut bytes),
            SurfaceFormat::Ply => write_ply(&mesh, &mut bytes),
        };
        written.map_err(|error| input_failure(&error))?;
        write_whole(path, bytes.get_ref())
    }
}

impl PageContent<'_> {
    /// Builds the report page.
    pub fn page(&self) -> Page {
        let [observer, _] = self.runs;
        let mut sections = vec![tables::summary(self.title, self.report)];
        sections.extend(self.report.material.as_ref().map(|material| tables::material(material, self.job.unit)));
        sections.extend(self.report.loads.as_ref().map(loads_section));
        sections.extend(self.report.spindle.as_ref().and_then(tables::spindle));
        sections.push(Section { heading: "Along time".into(), body: svg(&self.lanes(), "s") });
        sections.extend(self.chip_plots());
        if let Some(cutter) = &observer.cutter {
            let heights = self.map(&HeightMap::new(cutter.stock(), UPRIGHT), cutter.stock(), None);
            sections.push(Section { heading: "Heights, seen along Z".into(), body: heights.svg() });
            if let Some((off, figures)) = &self.deviation {
                let largest = Some((figures.largest, [figures.x, figures.y]));
                let map = self.map(off, cutter.stock(), largest);
                sections.push(Section {
                    heading: "Above (red) and below (blue) the target, along Z".into(),
                    body: map.svg(),
                });
            }
        }
        sections.extend(self.marks());
        let &PageContent { title, report, job, runs, chips, listing, .. } = self;
        let viewer = viewer_data(&ViewerInput { title, report, job, runs, chips, listing });
        let lead = FeedChanges::new(runs.map(|observer| &observer.log), listing).words(report);
        Page { title: title.to_owned(), lead: Some(lead), viewer: Some(viewer), sections }
    }

    /// The path before and after, with the measured chip load; empty if nothing was measured.
    fn chip_plots(&self) -> Vec<Section> {
        let [after, before] = self.runs;
        let plots = [("before", before, self.chips[1]), ("after", after, self.chips[0])];
        let plots = plots.into_iter().filter(|(_, observer, _)| !observer.log.chips.is_empty());
        let section = |(name, observer, chips): (&str, &RunObserver, &[MoveChips])| Section {
            heading: format!(
                "{} over its target along the path, {name}",
                capitalized(ChipQuantity::of(self.job).words())
            ),
            body: match observer.log.moves.len() {
                0..=DRAWN_MAX => path_plot::plot(self.job, &observer.log, chips).svg(),
                moves => format!("<p>The path has {moves} moves: the viewer above shows it.</p>"),
            },
        };
        plots.map(section).collect()
    }

    /// Sections with the marks of the edges; empty without edges.
    fn marks(&self) -> Vec<Section> {
        let [observer, _] = self.runs;
        let (Some(meter), Some(loads)) = (&observer.loads, &self.report.loads) else { return Vec::new() };
        let map = mark_figures::map(self.job.unit, meter, &self.marks).map(|map| map.svg());
        let marks = loads.marks.as_ref().zip(map).map(|(marks, map)| marks_section(loads, marks, &map));
        let course = mark_figures::course(self.job.unit, self.job, meter, loads).svg();
        let course =
            Section { heading: "Chip thickness and vibration along the path, seen along Z".into(), body: course };
        marks.into_iter().chain((!course.body.is_empty()).then_some(course)).collect()
    }

    /// Writes the page.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Failure> {
        write_whole(path, self.page().to_string().as_bytes())
    }

    fn lanes(&self) -> Vec<Lane> {
        let [after, before] = self.runs;
        let mut lanes = log_lanes(self.job, [&before.log, &after.log]);
        if let (Some(after), Some(before)) = (&after.cutter, &before.cutter) {
            let volumes = VolumeUnit::of(self.job.unit);
            let series = [("before", "#999", before), ("after", "#c03020", after)]
                .map(|(name, color, cutter)| Series { name, color, steps: rates(cutter, volumes) });
            let title = format!("removal rate, {}", volumes.rate_label);
            lanes.push(Lane { title, series: series.into(), mark: None, has_gaps: false });
        }
        if let (Some(after), Some(before)) = (&after.loads, &before.loads) {
            lanes.extend(load_figures::lanes(after, before));
        }
        let series = vec![Series { name: "after", color: "#2050a0", steps: after.log.overrides.steps(1.0) }];
        lanes.push(Lane { title: "override, %".into(), series, mark: None, has_gaps: false });
        lanes
    }

    fn map(&self, heights: &HeightMap, stock: &Stock, largest: Option<(f64, [f64; 2])>) -> Map {
        let lattice = stock.lattice();
        let in_unit = |mm: f64| mm / self.job.unit.mm();
        let [columns, _] = lattice.size(UPRIGHT);
        let lowest = Lattice::across(UPRIGHT).map(|axis| in_unit(lattice.lowest_mm()[axis]));
        let values = heights.heights_mm().iter().map(|height| height.map(in_unit)).collect();
        Map { columns, values, lowest, step: in_unit(lattice.step_mm()), unit: self.job.unit.label(), largest }
    }
}

/// Chip load over its target, and feed; before, then after.
fn log_lanes(job: &Job, logs: [&MoveLog; 2]) -> Vec<Lane> {
    let unit = job.unit;
    let lane = |title: String, curves: [&Curve; 2], per_unit: f64, mark: Option<f64>| {
        let series = [("before", "#999", curves[0]), ("after", "#c03020", curves[1])];
        let series = series.map(|(name, color, curve)| Series { name, color, steps: curve.steps(per_unit) });
        Lane { title, series: series.into(), mark, has_gaps: mark.is_some() }
    };
    let mut lanes = Vec::new();
    let chips = logs.map(|log| &log.chips);
    if !chips.iter().all(|curve| curve.is_empty()) {
        lanes.push(lane(format!("{} over its target", ChipQuantity::of(job).words()), chips, 1.0, Some(1.0)));
    }
    let title = format!("feed, {}/min", unit.label());
    lanes.push(lane(title, logs.map(|log| &log.feeds), unit.mm(), None));
    lanes
}

fn capitalized(words: &str) -> String {
    let (first, rest) = words.split_at(1);
    first.to_uppercase() + rest
}

fn rates(cutter: &StockCutter, volumes: VolumeUnit) -> Vec<([f64; 2], f64)> {
    let windows = windows(cutter.pieces().iter(), cutter.stock().lattice().step_mm());
    let step = |window: &arcfeed_hil_sim::removal::rate::RateWindow| {
        ([window.from.to_s(), window.to.to_s()], volumes.of_mm3(window.rate_per_min()))
    };
    windows.iter().map(step).collect()
}
