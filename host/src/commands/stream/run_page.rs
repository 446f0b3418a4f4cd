//! Report page of a run over the simulated line, beside the original program.

use std::path::Path;

use arcfeed_hil_sim::simulated_machine::SimulatedMachine;

use super::super::outcome::Failure;
use super::super::simulate::listing::ProgramListing;
use super::super::simulate::observer::RunObserver;
use super::super::simulate::page::PageContent;
use super::preparation::PreparedProgram;
use crate::adapt::write_back::WrittenProgram;
use crate::adapt::{Known, adapt_with};
use crate::report::figures::RunReport;

/// Writes the page of a run and of the original program.
///
/// # Errors
/// The file cannot be written.
pub fn write(
    path: &Path,
    ready: &PreparedProgram,
    report: &RunReport,
    (after, simulation): (&RunObserver, &SimulatedMachine),
    (before, baseline): (&RunObserver, &SimulatedMachine),
) -> Result<(), Failure> {
    let PreparedProgram { file, program, .. } = ready;
    let adapted = adapt_with(program, &file.job, Known::of(file));
    let executed = [simulation.control().executed(), baseline.control().executed()];
    let listing = ProgramListing::new(program, &adapted, &WrittenProgram::from(&adapted), executed);
    let content = PageContent {
        title: &format!("{}: sent to the simulated control", file.program.display()),
        listing: &listing,
        report,
        job: &file.job,
        runs: [after, before],
        chips: [simulation.meter().moves(), baseline.meter().moves()],
        deviation: None,
        marks: Vec::new(),
    };
    content.write(path)
}
