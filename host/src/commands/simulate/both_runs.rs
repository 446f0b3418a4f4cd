//! Runs of the adapted and of the original program. Where nothing can differ between them, one run stands for both.

use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_model::job::LawKind;

use super::conditions::{foreseen, foreseen_before};
use super::observer::RunObserver;
use super::setup::Setup;
use super::{in_memory, unadapted};
use crate::adapt::Adapted;
use crate::adapt::write_back::WrittenProgram;
use crate::clock::Instant;
use crate::commands::outcome::Failure;
use crate::console;
use crate::job::JobFile;
use crate::program::Program;

/// A run with its observer.
pub struct ObservedRun {
    /// The run.
    pub simulation: Simulation,
    /// Figures and records of the run.
    pub observer: RunObserver,
}

/// End of a run: whether it was reached, and when.
pub struct ObservedEnd {
    /// Whether the run reached its end, or why not.
    pub result: Result<(), Failure>,
    /// Wall time of the end.
    pub at: Instant,
}

/// Runs of the adapted and of the original program.
pub struct BothRuns {
    after: ObservedRun,
    /// `None` if the run of the adapted program is that of the original one too.
    before: Option<ObservedRun>,
}

impl ObservedRun {
    fn simulate(&mut self) -> ObservedEnd {
        ObservedEnd { result: self.observer.run(&mut self.simulation), at: Instant::now() }
    }
}

impl ObservedEnd {
    /// The same end, with the failure of another run if this one has none.
    fn and(self, other: Result<(), Failure>) -> Self {
        ObservedEnd { result: self.result.and(other), ..self }
    }
}

impl BothRuns {
    /// Runs that are not begun. Without a law, with the same text and the same planned conditions both are the same: where a limit lowers the
    /// override, the conditions of the move before say so. Tables (`has_tables`) are written for each run.
    ///
    /// # Errors
    /// The override limits of the job are invalid.
    pub fn new(
        (file, setup): (&JobFile, Option<&Setup<'_>>),
        program: &Program,
        (adapted, sent): (&Adapted, &WrittenProgram),
        has_tables: bool,
    ) -> Result<Self, Failure> {
        let [of_after, of_before] = [foreseen, foreseen_before].map(|of| of(program, adapted, file));
        let is_governed = file.job.tools.iter().any(|tool| tool.law != LawKind::Programmed);
        let may_differ = has_tables || is_governed || sent.text != program.file() || of_after != of_before;
        let observed =
            |simulation: Simulation, shows: bool| ObservedRun { simulation, observer: RunObserver::on(setup, shows) };
        let mut after = in_memory(file, &sent.text, ControllerFault::None)?;
        after.set_planned_conditions(of_after);
        let before = may_differ.then(|| unadapted(file, program, of_before)).transpose()?;
        Ok(BothRuns { after: observed(after, true), before: before.map(|before| observed(before, false)) })
    }

    /// Lets the runs record what a report shows; that of the adapted program with its stock.
    pub fn record_for_page(&mut self, file: &JobFile) {
        self.observers_mut().for_each(|observer| observer.record_for_page(file));
        self.after.observer.record_stock();
    }

    /// Observers of the runs, or of the one run.
    pub fn observers_mut(&mut self) -> impl Iterator<Item = &mut RunObserver> {
        std::iter::once(&mut self.after).chain(&mut self.before).map(|run| &mut run.observer)
    }

    /// Simulates to the end what is needed; returns the end of the run of the adapted program.
    pub fn simulate(&mut self) -> ObservedEnd {
        match &mut self.before {
            Some(before) => side_by_side(&mut self.after, before),
            None => self.after.simulate(),
        }
    }

    /// Runs after and before; twice the same if one stands for both.
    pub fn pair(&self) -> [&ObservedRun; 2] {
        [&self.after, self.before.as_ref().unwrap_or(&self.after)]
    }
}

/// Simulates two runs to their ends, at the same time if the system has threads. Only the first shows its progress.
fn side_by_side(first: &mut ObservedRun, second: &mut ObservedRun) -> ObservedEnd {
    if cfg!(target_family = "wasm") {
        return first.simulate().and(second.simulate().result);
    }
    let capture = console::capture();
    std::thread::scope(|scope| {
        let other = scope.spawn(|| console::captured(capture, || second.simulate()));
        let one = first.simulate();
        one.and(other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)).result)
    })
}
