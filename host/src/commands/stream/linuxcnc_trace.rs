//! `stream --port linuxcnc: --trace FILE`: the table of samples, with a row for each servo period (docs/traces.md).

use std::path::Path;

use arcfeed_nc::segment::Path as MovePath;
use arcfeed_units::{Nm, PERCENT, S_PER_MIN};

use super::super::measure::measured_run::MeasuredRun;
use super::super::outcome::Failure;
use super::super::simulate::run_tables::{OpenTable, TraceFiles};
use crate::linuxcnc::session::{MachineSample, Ready};
use crate::program::Source;
use crate::trace::table::Cell;
use crate::trace::tables::{SAMPLE_COLUMNS, SAMPLES};

/// Table of a run on LinuxCNC.
pub struct LinuxCncTrace<'a> {
    table: OpenTable,
    source: &'a Source,
    /// States of the component are written.
    has_component: bool,
}

impl<'a> LinuxCncTrace<'a> {
    /// Begins the table.
    ///
    /// # Errors
    /// The suffix names no format of this build, or the file cannot be written.
    pub fn begin(path: &Path, source: &'a Source, has_component: bool) -> Result<Self, Failure> {
        Ok(LinuxCncTrace { table: TraceFiles::of(path)?.open(&SAMPLES)?, source, has_component })
    }

    /// Adds the row of one servo period, with the chip load that `run` has measured.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(&mut self, sample: &MachineSample, ready: &Ready, run: &MeasuredRun<'_>) -> Result<(), Failure> {
        let (block, mm) = (run.block(), ready.mm_per_unit);
        let [x, y, z] = sample.position.map(|value| Cell::from(value * mm));
        let is_rapid = block.map(|block| block.segment.path == MovePath::Rapid);
        let sent = block.filter(|_| is_rapid == Some(false)).and_then(|block| block.sent);
        let rule = block.filter(|block| block.demand.is_some()).and_then(|block| block.rule);
        let target = run.meter().target_mm_per_tooth();
        let chip = run.meter().latest().zip(target);
        let none = || Cell::from(None::<f64>);
        let row: [Cell<'_>; SAMPLE_COLUMNS] = [
            (sample.number as f64 * ready.period_s).into(),
            block.map(|_| run.count()).into(),
            block.and_then(|block| block.segment.sequence).into(),
            block.map(|block| self.source.line_in_file(block.line) as i64).into(),
            rule.map(|rule| rule as i64 + 1).into(),
            is_rapid.into(),
            x,
            y,
            z,
            none(),
            none(),
            none(),
            none(),
            none(),
            none(),
            none(),
            none(),
            none(),
            (sample.speed * S_PER_MIN * mm).into(),
            (sent.map_or(0.0, Nm::to_mm) * sample.ratio).into(),
            ((sample.ratio * f64::from(PERCENT)).round() as u32).into(),
            sample.state.filter(|_| self.has_component).into(),
            None::<&str>.into(),
            sample.spindle.into(),
            target.into(),
            chip.map(|(chip, target)| chip.chip_ratio * target).into(),
            chip.map(|(chip, _)| chip.is_steady).into(),
        ];
        self.table.add(&row)
    }

    /// Moves the complete file to its final name.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn finish(self) -> Result<(), Failure> {
        self.table.finish()
    }
}
