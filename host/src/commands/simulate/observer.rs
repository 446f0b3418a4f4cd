//! Observation of a simulated run: cuts the stock along the axes' path, records override, feed and chip load, and shows
//! the progress.

use std::ops::ControlFlow;
use std::sync::atomic::Ordering;

use arcfeed_hil_sim::path_trace::PathTrace;
use arcfeed_hil_sim::removal::cutter::StockCutter;
use arcfeed_hil_sim::removal::loads::LoadMeter;
use arcfeed_hil_sim::simulated_machine::SimulatedMachine;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_units::Micros;

use super::super::outcome::{Failure, on_interrupt};
use super::block_lines::BlockLocator;
use super::move_log::MoveLog;
use super::progress_line::ProgressLine;
use super::run_tables::{RunTables, TraceFiles};
use super::setup::Setup;
use super::stock_frames::StockFrames;
use crate::console::{self, Progress};
use crate::job::JobFile;

/// Longest simulated run: a program that takes longer does not end.
const RUN_MAX: Micros = Micros::from_ms(24 * 3_600 * 1_000);

/// Periods between two progress messages.
const SIGN_EVERY: u64 = 200;

/// Observer of a simulated run: cuts the stock, records figures, shows the progress.
#[derive(Debug, Default)]
pub struct RunObserver {
    /// Stock that the tool cuts; `None` without a workpiece.
    pub cutter: Option<StockCutter>,
    /// Chips and forces of the edges in the stock; `None` without `[cutting]`.
    pub loads: Option<LoadMeter>,
    /// Moves of the run, with feed and chip load over time.
    pub log: MoveLog,
    /// Path of the tool with feed, chip load and override along it; `None` unless [`RunObserver::record_for_page`] was called.
    pub path: Option<PathTrace>,
    /// Stock at many times of the run; `None` unless [`RunObserver::record_stock`] was called.
    pub stock: Option<StockFrames>,
    /// Tables of `--trace`.
    tables: Option<RunTables>,
    place: String,
    /// Progress is shown, if there is something to cut.
    shows: bool,
}

impl RunObserver {
    /// Observer of a run on the workpiece of `setup` (`None`: without one); `shows` says whether it shows the progress.
    pub fn on(setup: Option<&Setup<'_>>, shows: bool) -> Self {
        let place = setup.map_or(String::new(), |setup| setup.place.clone());
        let loads = setup.and_then(Setup::load_meter);
        RunObserver { cutter: setup.map(Setup::cutter), loads, place, shows, ..RunObserver::default() }
    }

    /// Lets the observer record what a report or the live page shows: curves, and the tool's path, on the part if the job names its machine.
    pub fn record_for_page(&mut self, file: &JobFile) {
        self.log.is_shown = true;
        self.path.get_or_insert_default().follow(file.machine.as_ref().map(|named| named.machine));
    }

    /// Lets the observer record the stock at many times of the run, for the viewer.
    pub fn record_stock(&mut self) {
        self.stock = self.cutter.as_ref().map(|cutter| StockFrames::new(cutter.stock()));
    }

    /// Lets the observer write the tables of the run (`--trace`); with a `locator` they contain the lines of the
    /// program.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write_tables(&mut self, files: &TraceFiles, locator: Option<BlockLocator>) -> Result<(), Failure> {
        // A process that a signal ends would leave its unfinished files behind.
        if console::capture().is_none() {
            let _watched = on_interrupt();
        }
        self.tables = Some(files.begin(self.loads.as_mut(), locator)?);
        Ok(())
    }

    /// Completes the tables of the run at its end.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn finish_tables(&mut self, simulation: &SimulatedMachine) -> Result<(), Failure> {
        let Some(tables) = self.tables.take() else { return Ok(()) };
        tables.finish(simulation, self.cutter.as_ref(), self.loads.as_ref())
    }

    /// Simulates the run to its end.
    ///
    /// # Errors
    /// The run does not end, the stock needs more memory than permitted, or the tables cannot be written.
    pub fn run(&mut self, simulation: &mut Simulation) -> Result<(), Failure> {
        let takes_long = self.cutter.as_ref().filter(|_| self.shows).map(|_| "cutting");
        run_observed(simulation, takes_long, |simulation| self.observe(simulation).map(ControlFlow::Continue))?;
        if let Some(cutter) = &mut self.cutter {
            cutter.end().map_err(|error| Failure::Input(format!("{}: {error}", self.place)))?;
            self.stock.iter_mut().for_each(|stock| stock.end(simulation.now(), cutter));
        }
        self.loads.iter_mut().for_each(LoadMeter::end);
        self.path.iter_mut().for_each(PathTrace::end);
        self.finish_tables(simulation)
    }

    fn observe(&mut self, simulation: &SimulatedMachine) -> Result<(), Failure> {
        self.report_to_caller(simulation)?;
        if let Some(cutter) = &mut self.cutter {
            cutter.observe(simulation).map_err(|error| Failure::Input(format!("{}: {error}", self.place)))?;
            self.stock.iter_mut().for_each(|stock| stock.observe(simulation.now(), cutter));
        }
        self.loads.iter_mut().for_each(|loads| loads.observe(simulation));
        self.record(simulation);
        let Some(tables) = &mut self.tables else { return Ok(()) };
        if console::capture().is_none() && on_interrupt().load(Ordering::Relaxed) {
            return Err(Failure::Stopped("stopped by the operator: no table of the trace is written".into()));
        }
        tables.take_failure().map_or(Ok(()), Err)
    }

    /// Progress for the caller of a command that runs as a function, who may also stop it.
    fn report_to_caller(&self, simulation: &SimulatedMachine) -> Result<(), Failure> {
        let Some(capture) = console::capture() else { return Ok(()) };
        if capture.is_stopped() {
            return Err(Failure::Stopped("stopped by the caller".into()));
        }
        if self.shows {
            capture.set_progress(Progress::Run {
                blocks: simulation.control().executed().len(),
                time_s: simulation.now().to_s(),
            });
        }
        Ok(())
    }

    /// Records the millisecond that the simulation has just executed, without cutting the stock.
    pub fn record(&mut self, simulation: &SimulatedMachine) {
        self.log.observe(simulation);
        self.path.iter_mut().for_each(|path| path.observe(simulation));
        if let Some(tables) = &mut self.tables {
            tables.observe(simulation, self.loads.as_mut());
        }
    }
}

/// Lets the observers write the tables of their runs, if there are files for them.
///
/// # Errors
/// A file cannot be written.
pub fn write_tables<'o>(
    observers: impl Iterator<Item = &'o mut RunObserver>,
    files: &[TraceFiles],
    locators: impl FnOnce() -> [BlockLocator; 2],
) -> Result<(), Failure> {
    if files.is_empty() {
        return Ok(());
    }
    let mut runs = observers.zip(files).zip(locators());
    runs.try_for_each(|((observer, files), locator)| observer.write_tables(files, Some(locator)))
}

/// Simulates a run to its end and calls `observe` after each millisecond, which may end the run earlier. `takes_long` is the name under
/// which a run that takes long shows its progress; `None`: no progress.
///
/// # Errors
/// The run does not end, or `observe` fails.
pub fn run_observed(
    simulation: &mut Simulation,
    takes_long: Option<&str>,
    mut observe: impl FnMut(&SimulatedMachine) -> Result<ControlFlow<()>, Failure>,
) -> Result<(), Failure> {
    let shown = takes_long.filter(|_| console::capture().is_none());
    let line = shown.map(ProgressLine::begin);
    for period in 0_u64.. {
        if simulation.is_done() {
            break;
        }
        simulation.step();
        if observe(simulation)?.is_break() {
            break;
        }
        if simulation.now() > RUN_MAX {
            return Err(Failure::Machine("the program still runs after 24 hours of machine time".into()));
        }
        if let Some(line) = line.as_ref().filter(|_| period % SIGN_EVERY == 0) {
            line.show(simulation.control().executed().len(), simulation.now().to_s());
        }
    }
    line.inspect(ProgressLine::clear);
    Ok(())
}
