//! `arcfeed simulate`: the program before and after, on the simulated machine, as fast as possible, and the material it
//! removes from the job's workpiece.

pub mod control;

pub mod run_figures;

mod conditions;

mod surface;

mod assumed_stock;

mod body;

pub(super) mod edges;

mod chip_quantity;

mod mark_figures;

pub(super) mod setup;

pub(super) mod move_log;

mod block_pairs;

pub(super) mod material_figures;

mod load_figures;

mod block_lines;

mod block_table;

pub(super) mod run_tables;

mod progress_line;

mod stock_frames;

pub(super) mod observer;

mod both_runs;

mod spindle_load;

mod path_plot;

pub(super) mod listing;

mod feed_changes;

mod run_findings;

pub(super) mod viewer;

pub(super) mod page;

pub(super) mod assertions;

pub(super) mod junit;

use std::path::{Path, PathBuf};

use arcfeed_control::ControlSettings;
use arcfeed_dexel::deviation::HeightMap;
use arcfeed_dexel::workpiece::Stock;
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::planned_conditions::PlannedConditions;
use arcfeed_hil_sim::removal::marks::WallMark;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_units::LengthUnit;

use super::executed_blocks::for_memory;
use super::job_input::{JobInput, adapted};
use super::outcome::{Failure, json_text, refuse_inputs};
use crate::clock::Instant;
use crate::console::{note, print, without_notes};
use crate::job::{JobFile, SpindleLimits};
use crate::program::{Folder, Program, in_capitals};
use crate::report::figures::RunReport;
use crate::report::material::DeviationFigures;
use crate::report::summary::RunSummary;
use assertions::{Assertion, AssertionOutcome, Evidence, Verdict};
use assumed_stock::StockArgs;
use block_pairs::BlockPairs;
use both_runs::{BothRuns, ObservedEnd};
pub use conditions::{foreseen, foreseen_before, has_scopes};
use control::control_settings;
use junit::TestSuite;
use listing::{ProgramListing, locators};
use observer::{RunObserver, write_tables};
use page::{PageContent, SurfaceFormat};
use run_figures::{compare, measure};
use run_tables::TraceFiles;
use setup::Setup;
use spindle_load::SpindleLoad;

/// Run a job on the simulated machine, once as programmed and once adapted, as fast as possible
#[derive(Debug, clap::Args)]
pub struct Simulate {
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    json: bool,
    /// Write the report with its plots and maps here, as one HTML file (docs/simulate.md)
    #[arg(long, value_name = "OUT.html")]
    report: Option<PathBuf>,
    /// Write the remaining surface of the job's workpiece here, in millimetres: .stl or .ply, binary
    #[arg(long, value_name = "OUT.stl|OUT.ply")]
    surface: Option<PathBuf>,
    /// Write the tables of both runs here, .parquet or .csv: OUT, OUT-teeth and OUT-blocks, and with -original those of
    /// the original program (docs/traces.md)
    #[arg(long, value_name = "OUT.parquet|OUT.csv")]
    trace: Option<PathBuf>,
    /// Require a limit of the adapted run, for example chip<=1.05, power<=11kW, torque<=40Nm, force<=800N,
    /// feed<=5000mm/min or time<=120s; may be given several times (docs/simulate.md)
    #[arg(long = "assert", value_name = "FIGURE<=LIMIT")]
    assertions: Vec<Assertion>,
    /// Write the outcomes of the assertions here, as JUnit XML
    #[arg(long, value_name = "OUT.xml", requires = "assertions")]
    junit: Option<PathBuf>,
    /// Leave the summary out, and the warnings of loading and adapting: `adapt` has printed these.
    #[arg(skip)]
    is_silent: bool,
    #[command(flatten)]
    stock: StockArgs,
    #[command(flatten)]
    input: JobInput,
}

impl Simulate {
    /// Simulation of this input that only writes its report page.
    pub fn report_of(input: JobInput, report: PathBuf) -> Self {
        let (surface, assertions, junit) = (None, Vec::new(), None);
        Simulate {
            json: false,
            report: Some(report),
            surface,
            trace: None,
            assertions,
            junit,
            is_silent: true,
            stock: StockArgs::default(),
            input,
        }
    }

    /// Runs the command.
    ///
    /// # Errors
    /// The job or the program is at fault, or the simulated control raised an alarm.
    pub fn run(&self) -> Result<(), Failure> {
        let (mut file, program) = self.once(|| self.input.load())?;
        let job = &self.input.job;
        self.stock.apply(self.input.is_job(), &mut file, &program)?;
        let traces = self.check_outputs(&file)?;
        let setup = Setup::of(job, &file)?;
        let surface = self.surface(setup.as_ref())?;
        let target = setup.as_ref().map_or(Ok(None), Setup::target)?;
        let started = Instant::now();
        let mut adapted = self.once(|| adapted(&program, &file));
        let sent = for_memory(&program, &adapted, &file)?;
        // Tables of a trace are written for each run.
        let mut runs = BothRuns::new((&file, setup.as_ref()), &program, (&adapted, &sent), !traces.is_empty())?;
        if self.report.is_some() {
            runs.record_for_page(&file);
        }
        // The runs need the text alone.
        adapted.blocks = Vec::new();
        write_tables(runs.observers_mut(), &traces, || locators(&program, &adapted, &sent.text, &sent.line_ends))?;
        // Results are written and printed even if a later step fails.
        let ObservedEnd { result: mut ended, at } = runs.simulate();
        let pair = runs.pair();
        let (simulations, observers) = (pair.map(|run| &run.simulation), pair.map(|run| &run.observer));
        let [simulation, before] = simulations;
        let mut report = measure(simulation, &file.job);
        report.real_time_factor = Some(simulation.now().to_s() / at.duration_since(started).as_secs_f64());
        let title = format!("{}: simulated", file.program.display());
        let executed = simulations.map(|run| run.control().executed());
        let listing = ProgramListing::new(&program, &adapted, &sent, executed);
        let (mut deviation, mut marks, mut spindle) = (None, Vec::new(), None);
        if ended.is_ok() {
            compare(&mut report, measure(before, &file.job));
            if let Some(setup) = &setup {
                let pairs = listing.pairs();
                (deviation, marks) = add_cuts(&mut report, (file.job.unit, &pairs), setup, observers, target.as_ref());
            }
            spindle = add_spindle(&mut report, &file, setup.as_ref(), observers);
        }
        if let (Some((path, format)), Some(after)) = (surface, &observers[0].cutter) {
            ended = ended.and(format.write(after.stock(), path));
        }
        if let Some(path) = &self.report {
            let chips = simulations.map(|run| run.meter().moves());
            let (title, listing, report, job) = (&title, &listing, &report, &file.job);
            let shown = PageContent { title, listing, report, job, runs: observers, chips, deviation, marks };
            ended = ended.and(shown.write(path));
        }
        let evidence = Evidence {
            report: &report,
            log: &observers[0].log,
            chips: simulation.meter().moves(),
            spindle: spindle.as_ref(),
            line_of: &|block| listing.block_lines[0].get((block as usize).checked_sub(1)?).copied().flatten(),
            program: file.program.display().to_string(),
        };
        let finished = if self.is_silent { stopped(&report) } else { finish(&report, self.json, title) };
        let asserted = self.judge(&evidence, ended.is_ok(), started);
        ended.and(finished).and(asserted)
    }

    /// Does a part whose warnings are already printed if this simulation only writes its report.
    fn once<T>(&self, part: impl FnOnce() -> T) -> T {
        if self.is_silent { without_notes(part) } else { part() }
    }

    /// Checks that the command may write its outputs; returns the files of `--trace`, of both runs or of none.
    fn check_outputs(&self, file: &JobFile) -> Result<Vec<TraceFiles>, Failure> {
        let traces = TraceFiles::of_both(self.trace.as_deref())?;
        let tables: Vec<PathBuf> = traces.iter().flat_map(TraceFiles::paths).collect();
        let mut outputs: Vec<Option<&Path>> = [&self.report, &self.surface, &self.junit].map(Option::as_deref).into();
        outputs.extend(tables.iter().map(|path| Some(path.as_path())));
        refuse_inputs(&outputs, &file.inputs(&self.input.job))?;
        Ok(traces)
    }

    /// Judges the assertions, prints those that hold, and writes the outcomes.
    fn judge(&self, evidence: &Evidence<'_>, has_ended: bool, started: Instant) -> Result<(), Failure> {
        let outcomes: Vec<AssertionOutcome> =
            self.assertions.iter().map(|assertion| assertion.after(evidence, has_ended)).collect();
        let (job, time_s) = (self.input.job.display().to_string(), started.elapsed().as_secs_f64());
        let suite = TestSuite { command: "simulate", job, outcomes: &outcomes, time_s };
        suite.conclude(self.junit.as_deref(), self.json, |verdict| *verdict != Verdict::Passed)
    }

    /// Path and format of the surface file; checked before the run.
    fn surface(&self, setup: Option<&Setup<'_>>) -> Result<Option<(&Path, SurfaceFormat)>, Failure> {
        let Some(path) = self.surface.as_deref() else { return Ok(None) };
        let format = SurfaceFormat::of(path)?;
        match setup {
            Some(_) => Ok(Some((path, format))),
            None => {
                Err(Failure::Usage(format!("--surface: {} has no [workpiece] to be cut", self.input.job.display())))
            }
        }
    }
}

/// Writes the surface of a stock, in millimetres, in the format that the suffix names.
///
/// # Errors
/// No such format, nothing is left of the stock, or the file cannot be written.
pub fn write_surface(stock: &Stock, path: &Path) -> Result<(), Failure> {
    SurfaceFormat::of(path)?.write(stock, path)
}

/// Adds the material that both runs removed; returns the deviations from the job's target, and the marks on walls.
fn add_cuts(
    report: &mut RunReport,
    (unit, pairs): (LengthUnit, &BlockPairs),
    setup: &Setup<'_>,
    observers: [&RunObserver; 2],
    target: Option<&Stock>,
) -> (Option<(HeightMap, DeviationFigures)>, Vec<WallMark>) {
    let [Some(after), Some(before)] = observers.map(|observer| &observer.cutter) else {
        return (None, Vec::new());
    };
    let mut material = material_figures::figures((unit, pairs), setup, after, before);
    material.warnings(unit).iter().for_each(|warning| note(format_args!("warning: {warning}")));
    let deviation = target.and_then(|target| material_figures::deviation(unit, after.stock(), target));
    material.deviation = deviation.as_ref().map(|(_, figures)| *figures);
    report.material = Some(material);
    let mut marks = Vec::new();
    if let [Some(after), Some(before)] = observers.map(|observer| observer.loads.as_ref()) {
        let mut loads = load_figures::figures((unit, pairs), after, before);
        if let Some(truth) = &setup.truth {
            marks = truth.marks(after);
            loads.marks = mark_figures::figures(unit, after, &marks);
            loads.baseline_marks = mark_figures::figures(unit, before, &truth.marks(before));
        }
        loads.warnings().iter().for_each(|warning| note(format_args!("warning: {warning}")));
        report.loads = Some(loads);
    }
    (deviation, marks)
}

/// Adds the spindle's load in both runs, and returns that of the first.
fn add_spindle(
    report: &mut RunReport,
    file: &JobFile,
    setup: Option<&Setup<'_>>,
    observers: [&RunObserver; 2],
) -> Option<SpindleLoad> {
    let load = |observer: &RunObserver| SpindleLoad::of(&file.job, setup?, observer);
    if let (Some(setup), [Some(after), Some(before)]) = (setup, observers.map(load)) {
        let figures = spindle_load::figures(file, setup, [&after, &before]);
        figures.warnings().iter().for_each(|warning| note(format_args!("warning: {warning}")));
        report.spindle = Some(figures);
        return Some(after);
    }
    if file.spindle != SpindleLimits::default() {
        note(format_args!(
            "warning: the limits in [spindle] are not checked: the job has no [cutting], and no [workpiece] with `material`"
        ));
    }
    None
}

/// Prints the report of a run; fails if the run ended with an alarm.
///
/// # Errors
/// The control raised an alarm, or stdout accepts nothing.
pub fn finish(report: &RunReport, json: bool, title: String) -> Result<(), Failure> {
    let printed = if json {
        print(format_args!("{}", json_text(report)))
    } else {
        print(format_args!("{}", RunSummary { title, report }.to_string().trim_end()))
    };
    stopped(report)?;
    printed.map_err(Failure::Unprinted)
}

/// The control's alarm as a failure.
fn stopped(report: &RunReport) -> Result<(), Failure> {
    match report.alarms.first() {
        None => Ok(()),
        Some(alarm) => Err(Failure::Machine(format!("the control stopped at {alarm}"))),
    }
}

fn in_memory(file: &JobFile, program: &[u8], fault: ControllerFault) -> Result<Simulation, Failure> {
    in_memory_of(control_settings(file), file, program, fault)
}

/// Simulation of a program in the memory of a control with these settings, not begun.
///
/// # Errors
/// The override limits of the job are invalid.
pub(super) fn in_memory_of(
    settings: ControlSettings,
    file: &JobFile,
    program: &[u8],
    fault: ControllerFault,
) -> Result<Simulation, Failure> {
    // A last line without its end would never be a block.
    let program = [&in_capitals(program), b"\n".as_slice()].concat();
    let mut simulation = Simulation::from_memory(settings, &program, &file.job, fault)
        .map_err(|error| Failure::Input(format!("override limits: {error:?}")))?;
    if let Some(folder) = &file.library {
        simulation.control_mut().set_library(Box::new(Folder(folder.clone())));
    }
    Ok(simulation)
}

/// Simulation of the original program, without arcfeed, not begun; `foreseen` is that of [`foreseen_before`].
fn unadapted(file: &JobFile, program: &Program, foreseen: Vec<PlannedConditions>) -> Result<Simulation, Failure> {
    let mut simulation = in_memory(file, program.file(), ControllerFault::LawOff)?;
    simulation.set_planned_conditions(foreseen);
    Ok(simulation)
}

/// Runs the original program, without arcfeed, under this observer, and adds its results to `report` for comparison; `foreseen` is
/// the result of [`foreseen_before`].
///
/// # Errors
/// The run does not end.
pub fn add_baseline(
    report: &mut RunReport,
    file: &JobFile,
    program: &Program,
    foreseen: &[PlannedConditions],
    observer: &mut RunObserver,
) -> Result<Simulation, Failure> {
    let mut simulation = unadapted(file, program, foreseen.to_vec())?;
    observer.run(&mut simulation)?;
    compare(report, measure(&simulation, &file.job));
    Ok(simulation)
}

/// Runs a program from the control's memory to its end, with this fault injected into the controller.
///
/// # Errors
/// The run does not end.
pub fn run_in_memory(file: &JobFile, program: &[u8], fault: ControllerFault) -> Result<Simulation, Failure> {
    let mut simulation = in_memory(file, program, fault)?;
    RunObserver::default().run(&mut simulation).map(|()| simulation)
}
