//! `--trace FILE`: tables of a run, written while it goes on (docs/traces.md).

use std::path::{Path, PathBuf};

use arcfeed_control::drives::limits::AXES;
use arcfeed_firmware::supervisor::report::{Limit, Reason};
use arcfeed_hil_sim::removal::cutter::StockCutter;
use arcfeed_hil_sim::removal::loads::LoadMeter;
use arcfeed_hil_sim::removal::tooth_passes::ToothPass;
use arcfeed_hil_sim::simulated_machine::SimulatedMachine;
use arcfeed_model::tool::Edge;
use arcfeed_units::{Nm, S_PER_MIN};

use super::super::outcome::{Failure, file_failure};
use super::block_lines::BlockLocator;
use super::block_table::{BlockLog, BlockRecord, BlockSources};
use crate::board::words;
use crate::console;
use crate::trace::table::{Cell, Table};
use crate::trace::tables::{BLOCKS, SAMPLE_COLUMNS, SAMPLES, TEETH, TOOTH_COLUMNS};
use crate::trace::{MemoryTable, TableFile, TraceFormat};

/// Addition to the names of the files of the original program.
const ORIGINAL: &str = "-original";

/// Name of a run's tables in memory.
const IN_MEMORY: &str = "run";

/// Files that `--trace` writes for one run, or the corresponding tables in memory for the caller of a function.
#[derive(Clone, Debug)]
pub struct TraceFiles {
    path: PathBuf,
    /// None in memory.
    format: Option<TraceFormat>,
}

/// Tables of a run, written while it goes on. After a first failure nothing more is written.
#[derive(Debug)]
pub struct RunTables {
    samples: OpenTable,
    teeth: Option<OpenTable>,
    blocks: OpenTable,
    records: BlockLog,
    locator: Option<BlockLocator>,
    /// Line of each executed block.
    lines: Vec<Option<usize>>,
    failure: Option<Failure>,
}

/// Table to which rows are added, in a file or in memory.
#[derive(Debug)]
pub enum OpenTable {
    /// Table in a file, with the file's name for messages.
    File(PathBuf, TableFile),
    /// Table for the caller of a command that runs as a function.
    Memory(MemoryTable),
}

impl TraceFiles {
    /// Names of the files for a path given with `--trace`; its suffix decides the format.
    ///
    /// # Errors
    /// The suffix names no format of this build.
    pub fn of(path: &Path) -> Result<Self, Failure> {
        let format = TraceFormat::of(path).map_err(|message| Failure::Usage(format!("--trace: {message}")))?;
        Ok(TraceFiles { path: path.to_owned(), format: Some(format) })
    }

    /// Tables of the run and of the original program: files if a path is given, in memory if the caller of a function wants them,
    /// otherwise none.
    ///
    /// # Errors
    /// See [`TraceFiles::of`].
    pub fn of_both(path: Option<&Path>) -> Result<Vec<Self>, Failure> {
        let files = path.map(TraceFiles::of).transpose()?;
        let wants_tables = || console::capture().is_some_and(|capture| capture.wants_tables());
        let in_memory = || TraceFiles { path: IN_MEMORY.into(), format: None };
        let files = files.or_else(|| wants_tables().then(in_memory));
        let with_original = |files: Self| {
            let original = TraceFiles { path: files.with(ORIGINAL), format: files.format };
            [files, original]
        };
        Ok(files.into_iter().flat_map(with_original).collect())
    }

    /// Paths of all files of a run; empty for tables in memory.
    pub fn paths(&self) -> Vec<PathBuf> {
        if self.format.is_none() {
            return Vec::new();
        }
        [&SAMPLES, &TEETH, &BLOCKS].map(|table| self.with(table.suffix)).into()
    }

    /// Begins the tables of a run. With `loads` there is a table of tooth passes; with `locator` the tables have the lines of the program.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn begin(&self, loads: Option<&mut LoadMeter>, locator: Option<BlockLocator>) -> Result<RunTables, Failure> {
        let teeth = loads.is_some().then(|| self.open(&TEETH)).transpose()?;
        loads.into_iter().for_each(LoadMeter::record_passes);
        let (samples, blocks) = (self.open(&SAMPLES)?, self.open(&BLOCKS)?);
        let (records, lines, failure) = (BlockLog::default(), Vec::new(), None);
        Ok(RunTables { samples, teeth, blocks, records, locator, lines, failure })
    }

    /// Begins a table of a run.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn open(&self, table: &Table<'_>) -> Result<OpenTable, Failure> {
        let path = self.with(table.suffix);
        let Some(format) = self.format else {
            return Ok(OpenTable::Memory(MemoryTable::new(path.display().to_string(), table)));
        };
        let file = TableFile::begin(format, &path, table).map_err(|error| file_failure(&path, &error))?;
        Ok(OpenTable::File(path, file))
    }

    fn with(&self, suffix: &str) -> PathBuf {
        let mut name = self.path.file_stem().unwrap_or_default().to_owned();
        name.push(suffix);
        let suffix = self.path.extension().unwrap_or_default();
        self.path.with_file_name(name).with_added_extension(suffix)
    }
}

impl RunTables {
    /// Adds the rows of one simulated millisecond: the sample, and the tooth passes that `loads` has measured.
    pub fn observe(&mut self, simulation: &SimulatedMachine, loads: Option<&mut LoadMeter>) {
        if self.failure.is_some() {
            return;
        }
        self.locate(simulation.control().executed());
        let record = BlockRecord::of(simulation, |block| self.line(block));
        let row = sample_row(simulation, record.as_ref());
        let mut written = self.samples.add(&row);
        if let Some(record) = record {
            self.records.add(record, simulation.now());
        }
        let passes = loads.map_or(Vec::new(), LoadMeter::take_passes);
        if let Some(teeth) = &mut self.teeth {
            for pass in &passes {
                let line = line_of(&self.lines, pass.block.count);
                written = written.and_then(|()| teeth.add(&tooth_row(pass, line)));
            }
        }
        self.failure = written.err();
    }

    /// Returns the first failure so far, once.
    pub fn take_failure(&mut self) -> Option<Failure> {
        self.failure.take()
    }

    /// Writes the table of blocks, and moves the complete files to their final names.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn finish(
        mut self,
        simulation: &SimulatedMachine,
        cutter: Option<&StockCutter>,
        loads: Option<&LoadMeter>,
    ) -> Result<(), Failure> {
        if let Some(failure) = self.failure {
            return Err(failure);
        }
        let sources = BlockSources { meter: simulation.meter(), cutter, loads };
        for row in self.records.rows(&sources) {
            self.blocks.add(&row)?;
        }
        let tables = [Some(self.samples), self.teeth, Some(self.blocks)];
        tables.into_iter().flatten().try_for_each(OpenTable::finish)
    }

    /// Finds the lines of blocks that were executed since.
    fn locate(&mut self, executed: &[Vec<u8>]) {
        let Some(locator) = &mut self.locator else { return };
        for block in executed.get(self.lines.len()..).unwrap_or_default() {
            self.lines.push(locator.line_of(block));
        }
    }

    fn line(&self, block: u32) -> Option<usize> {
        line_of(&self.lines, block)
    }
}

fn line_of(lines: &[Option<usize>], block: u32) -> Option<usize> {
    lines.get((block as usize).checked_sub(1)?).copied().flatten()
}

impl OpenTable {
    /// Adds a row.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(&mut self, row: &[Cell<'_>]) -> Result<(), Failure> {
        match self {
            OpenTable::File(path, file) => file.add(row).map_err(|error| file_failure(path, &error)),
            OpenTable::Memory(table) => {
                table.add(row);
                Ok(())
            }
        }
    }

    /// Completes the table: moves the file to its final name, or passes the table to the caller of the function.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn finish(self) -> Result<(), Failure> {
        match self {
            OpenTable::File(path, file) => file.finish().map_err(|error| file_failure(&path, &error)),
            OpenTable::Memory(table) => {
                if let Some(capture) = console::capture() {
                    capture.add_table(table);
                }
                Ok(())
            }
        }
    }
}

/// Row of [`SAMPLES`].
fn sample_row(simulation: &SimulatedMachine, record: Option<&BlockRecord>) -> [Cell<'static>; SAMPLE_COLUMNS] {
    let (control, meter) = (simulation.control(), simulation.meter());
    let origin = simulation.context().origin;
    let [x, y, z] = origin.linear.map(Nm::to_mm);
    let [a, b, c] = origin.rotary.map(|angle| angle.to_deg());
    let from_origin = |axes: [f64; AXES]| {
        let [ax, ay, az, aa, ab, ac] = axes;
        [ax - x, ay - y, az - z, aa - a, ab - b, ac - c].map(Cell::from)
    };
    let [xw, yw, zw, aw, bw, cw] = from_origin(*control.axes());
    let [xa, ya, za, aa, ba, ca] = from_origin(control.actual_axes());
    let decision = simulation.decision();
    let target = meter.target_mm_per_tooth().filter(|_| record.is_some_and(|record| record.rule.is_some()));
    let chip = meter.latest().zip(target);
    [
        simulation.now().to_s().into(),
        record.map(|record| record.block).into(),
        record.and_then(|record| record.n).into(),
        record.and_then(|record| record.line).into(),
        record.and_then(|record| record.rule).into(),
        record.map(|record| record.is_rapid).into(),
        xw,
        yw,
        zw,
        aw,
        bw,
        cw,
        xa,
        ya,
        za,
        aa,
        ba,
        ca,
        (control.speed_mm_per_s() * S_PER_MIN).into(),
        f64::from(control.commanded().0).into(),
        u32::from(control.override_percent()).into(),
        decision.map(|decision| words::state(decision.state)).into(),
        decision.and_then(|decision| decision.reason).map(reason_word).into(),
        f64::from(simulation.spindle().0).into(),
        target.into(),
        chip.map(|(chip, target)| chip.chip_ratio * target).into(),
        chip.map(|(chip, _)| chip.is_steady).into(),
    ]
}

/// Row of [`TEETH`].
fn tooth_row(pass: &ToothPass, line: Option<usize>) -> [Cell<'static>; TOOTH_COLUMNS] {
    let [x, y, z] = pass.tip_mm;
    [
        pass.at_s.into(),
        pass.block.count.into(),
        pass.block.sequence.into(),
        line.map(|line| line as i64).into(),
        pass.block.rule.map(|rule| rule as i64 + 1).into(),
        (pass.tooth as i64 + 1).into(),
        match pass.side {
            Edge::Outer => "outer",
            Edge::Inner => "inner",
        }
        .into(),
        pass.chip_mm.into(),
        pass.bending_n.into(),
        pass.torque_n_m.into(),
        x.into(),
        y.into(),
        z.into(),
    ]
}

/// Reason of an override, in a word.
const fn reason_word(reason: Reason) -> &'static str {
    match reason {
        Reason::Law => "law",
        Reason::NoDemand(_) => "no-demand",
        Reason::NoLaw => "no-law",
        Reason::NoSpindle => "no-spindle",
        Reason::Floor { .. } => "floor",
        Reason::Limited(Limit::Max) => "max",
        Reason::Limited(Limit::Axis) => "axis",
        Reason::Limited(Limit::ArcClamp) => "arc-clamp",
        Reason::Limited(Limit::Ceiling) => "feed-ceiling",
        Reason::Stale => "stale",
        Reason::Waiting => "waiting",
        Reason::NotArmed => "not-armed",
        Reason::Held(_) => "held",
        Reason::Lost(_) => "lost",
        Reason::Fault(_) => "fault",
        Reason::Inhibited(_) => "inhibited",
        Reason::Disarmed(_) => "disarmed",
    }
}
