#![doc = include_str!("../README.md")]
//!
//! A Fanuc-like control in DNC or memory operation: bytes in, axis positions out.
//!
//! Modelled: the reader/punch interface with its codes, checks and flow control, reading ahead and its processing time,
//! the operator's panel, execution of blocks at override-scaled feed under limits of the path or of every axis, alarms.
//! [`drives`] computes the actual axis positions. All settings: docs/control.md.

pub mod drives;

pub mod tape;

pub mod line;

pub mod punch;

pub mod dnc_port;

pub mod store;

pub mod signals;

pub mod action;

pub mod path;

pub mod feeds;

pub mod dynamics;

pub mod settings;

pub mod restart;

mod unplaced;

pub mod plain;

pub mod reader;

pub mod search;

pub mod executive;

mod corner_queue;

mod contour_queue;

mod junction;

mod prepared_move;

mod path_spans;

mod trapezoid;

mod horizon;

mod look_ahead;

pub mod interpolator;

pub mod machine;

mod panel;

mod drive_state;

mod canned_cycle_run;

mod read_ahead;

mod conditions;

use std::collections::VecDeque;

use arcfeed_nc::alarm::Fault;
use arcfeed_nc::modal::{Modal, Pose, ProgramStop};
use arcfeed_nc::segment::Segment;
use arcfeed_nc_macro::program::{Library, first_macro};
use arcfeed_nc_macro::variables::Ignored;
use arcfeed_units::{Micros, MmPerMin};

use crate::drives::limits::AXES;

use action::{Action, MoveContext, ReadBlock};
use canned_cycle_run::CannedCycleRun;
use contour_queue::ContourQueue;
use dnc_port::DncPort;
use drive_state::DriveState;
use executive::Executive;
use interpolator::Interpolator;
use line::LineCounters;
use panel::Phase;
use reader::BlockReader;
use restart::RestartList;
use search::Search;
use signals::FeedOverrideLines;

pub use arcfeed_nc::tape_code as code;
pub use settings::{ControlSettings, Preset, Switches};

/// Alarm that has stopped the control before the end of its program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlarmRecord {
    /// Line of the program as received, counted from 1.
    pub line: u32,
    /// Cause of the alarm, with its number.
    pub fault: Fault,
}

/// A simulated Fanuc-like control with its axes. Keeps its state between calls.
#[derive(Debug)]
pub struct Control {
    settings: ControlSettings,
    is_in_dnc: bool,
    switches: Switches,
    port: DncPort,
    reader: BlockReader,
    /// Executive of a program that comes over the line, or of one in memory that has macro statements.
    executive: Option<Executive>,
    /// Unused time for reading ahead.
    reading_time: Micros,
    reads_no_further: bool,
    /// Blocks that wait for the corners of a contour.
    contour_queue: ContourQueue,
    search: Option<Search>,
    restart_list: Option<RestartList>,
    /// Block with several moves, in execution.
    cycle_run: Option<CannedCycleRun>,
    interpolator: Interpolator,
    drive_state: DriveState,
    phase: Phase,
    dwell_left: Micros,
    after_move: Option<ProgramStop>,
    halts_after: bool,
    alarm: Option<AlarmRecord>,
    ended: bool,
    held: bool,
    /// Functions that #3003 and #3004 switch off.
    ignored: Ignored,
    output: Vec<u8>,
    executed: Vec<Vec<u8>>,
    blocks_begun: usize,
    starved_ms: u64,
    has_moved: bool,
    ladder: VecDeque<u8>,
    ladder_percent: u8,
}

impl Control {
    /// A control that reads its program from the DNC line.
    pub fn on_line(settings: ControlSettings) -> Self {
        let executive = Some(Executive::on_line(&settings));
        Control { executive, ..Control::new(settings, DncPort::on_line(settings.line), true) }
    }

    /// A control that has the whole program in its memory.
    pub fn from_memory(settings: ControlSettings, program: &[u8]) -> Self {
        if first_macro(program).is_none() {
            return Control::new(settings, DncPort::from_memory(program), false);
        }
        let executive = Executive::new(program, &settings, Box::new(()));
        Control { executive: Some(executive), ..Control::new(settings, DncPort::from_memory(b""), false) }
    }

    /// Adds a library of subprograms that the program may call; returns the control.
    #[must_use]
    pub fn with_library(mut self, library: Box<dyn Library>) -> Self {
        self.set_library(library);
        self
    }

    /// Sets the library of subprograms that the program may call.
    pub fn set_library(&mut self, library: Box<dyn Library>) {
        if let Some(executive) = &mut self.executive {
            executive.set_library(library);
        }
    }

    fn new(settings: ControlSettings, port: DncPort, is_in_dnc: bool) -> Self {
        Control {
            settings,
            is_in_dnc,
            switches: settings.switches,
            port,
            reader: BlockReader::new(&settings),
            executive: None,
            reading_time: read_before_start(&settings),
            reads_no_further: false,
            contour_queue: ContourQueue::new(&settings),
            search: None,
            restart_list: None,
            cycle_run: None,
            interpolator: Interpolator::new(&settings),
            drive_state: DriveState::new(&settings),
            phase: Phase::Running,
            dwell_left: Micros(0),
            after_move: None,
            halts_after: false,
            alarm: None,
            ended: false,
            held: false,
            ignored: Ignored::default(),
            output: Vec::new(),
            executed: Vec::new(),
            blocks_begun: 0,
            starved_ms: 0,
            has_moved: false,
            ladder: VecDeque::new(),
            ladder_percent: 100,
        }
    }

    /// The control's serial port, to put bytes on its line and take bytes from it.
    pub fn port(&mut self) -> &mut DncPort {
        &mut self.port
    }

    /// Counters of the line's traffic.
    pub fn line_counters(&self) -> LineCounters {
        self.port.counters()
    }

    /// Whether bytes that the control has sent wait in its output queue.
    pub fn has_output(&self) -> bool {
        self.port.has_output()
    }

    /// Simulates one interpolation period of length `dt`; `override_percent` is the value at the control's override input.
    pub fn step(&mut self, now: Micros, dt: Micros, override_percent: u8) {
        if let Some(fault) = self.port.step(dt) {
            self.stop_with(AlarmRecord { line: self.reader.line(), fault });
        }
        let lines = FeedOverrideLines::of_percent(override_percent);
        self.ladder_percent = self.through_ladder(lines.effective_percent(self.switches.override_cancel));
        self.operate(now);
        self.read_ahead(now, dt);
        self.dwell(dt);
        let mut left_s = dt.to_s();
        while left_s > 0.0 || self.interpolator.is_between() {
            self.start_next(now);
            if let Some((_, segment)) = self.interpolator.active() {
                self.drive_state.begin(segment);
            }
            left_s = self.interpolator.advance(left_s, &self.conditions());
        }
        self.drive_state.step(self.interpolator.axes(), self.interpolator.commanded(), dt);
        self.check_end(dt);
        if self.is_over() {
            self.port.close();
        }
    }

    /// Commanded position of the axes.
    pub fn position(&self) -> Pose {
        self.interpolator.position()
    }

    /// Commanded position, unrounded: X, Y, Z in mm, A, B, C in degrees.
    pub fn axes(&self) -> &[f64; AXES] {
        self.interpolator.axes()
    }

    /// The move in execution, after the count of executed blocks up to and including its own; `None` between moves.
    pub fn active(&self) -> Option<(u32, &Segment)> {
        self.interpolator.active()
    }

    /// Number of moves begun since power-on; a change means that another move is in execution.
    pub fn moves_begun(&self) -> u64 {
        self.interpolator.moves_begun()
    }

    /// Context of the move in execution: coordinates, and what the program has commanded for it.
    pub fn context(&self) -> Option<&MoveContext> {
        self.interpolator.context()
    }

    /// Commanded feed of the move in execution, after override; zero at rapid and at rest.
    pub fn commanded(&self) -> MmPerMin {
        self.interpolator.commanded()
    }

    /// Commanded speed along the path, mm/s.
    pub fn speed_mm_per_s(&self) -> f64 {
        self.interpolator.speed_mm_per_s()
    }

    /// Blocks executed, byte for byte as received, without their line ends.
    pub fn executed(&self) -> &[Vec<u8>] {
        &self.executed
    }

    /// Number of blocks that wait, read ahead but not begun.
    pub fn queued(&self) -> usize {
        self.interpolator.queued()
    }

    /// Output (DPRNT, BPRNT) of the macro statements read so far; in DNC operation the control also sends it over the line.
    pub fn output(&self) -> &[u8] {
        &self.output
    }

    /// Whether output waits to be sent and the sender has not stopped it.
    pub fn is_punching(&self) -> bool {
        self.port.is_punching()
    }

    /// Messages that the program has issued (#3006, #3000). If an alarm came up in a called program, one more names its place.
    pub fn messages(&self) -> impl Iterator<Item = &str> {
        self.executive.iter().flat_map(Executive::messages)
    }

    /// Modal state after the last block that was read from the line, or from a program without macro statements.
    pub fn modal(&self) -> &Modal {
        self.reader.modal()
    }

    /// Alarm that stopped the control.
    pub fn alarm(&self) -> Option<&AlarmRecord> {
        self.alarm.as_ref()
    }

    /// Whether the program has ended (M02, M30).
    pub fn has_ended(&self) -> bool {
        self.ended
    }

    /// Whether nothing will move any more: program end or alarm.
    pub fn is_over(&self) -> bool {
        self.ended || self.alarm.is_some()
    }

    /// Whether the commanded speed is zero.
    pub fn is_at_rest(&self) -> bool {
        self.interpolator.is_at_rest()
    }

    /// Whether the control waits for the program: it is running, has no move or dwell in execution, and no block to execute.
    pub fn is_starved(&self) -> bool {
        let has_nothing = self.interpolator.is_idle() && self.interpolator.queued() == 0 && self.cycle_run.is_none();
        has_nothing && self.phase == Phase::Running && self.dwell_left == Micros(0) && !self.is_over()
    }

    /// Total time, ms, during which no block was available to execute, counted from the first move on.
    pub fn starved_ms(&self) -> u64 {
        self.starved_ms
    }

    fn stop_with(&mut self, alarm: AlarmRecord) {
        self.alarm.get_or_insert(alarm);
    }

    /// Starts the next blocks: those that take no time, up to a move or a wait.
    fn start_next(&mut self, now: Micros) {
        while self.interpolator.is_idle() && self.may_begin() {
            if self.cycle_run.is_some() {
                self.continue_cycle_run(now);
                continue;
            }
            if let Some(stop) = self.after_move.take() {
                self.apply_stop(stop, now);
                continue;
            }
            let is_halt = self.is_in_single_block() && self.interpolator.may_stop();
            if std::mem::take(&mut self.halts_after) && is_halt {
                self.phase = Phase::Stopped { since: now };
                return;
            }
            let Some(block) = self.interpolator.take_next(self.blocks_begun) else { return };
            if self.execute(block, now) {
                return;
            }
        }
    }

    /// Starts a block; returns whether it is a single move.
    fn execute(&mut self, block: ReadBlock, now: Micros) -> bool {
        if let Action::Fault(fault) = block.action {
            self.stop_with(AlarmRecord { line: block.line, fault });
            return false;
        }
        if matches!(block.action, Action::Corner(_)) {
            return true;
        }
        self.blocks_begun += 1;
        self.halts_after = block.stops_single_block();
        let sequence = reader::sequence_of(&block.text).map(i64::from);
        self.drive_state.apply_block(&block, &self.switches);
        if !block.text.is_empty() {
            self.executed.push(block.text);
        }
        match block.action {
            Action::Move(_, stop) => {
                self.after_move = stop;
                self.has_moved = true;
                return true;
            }
            Action::Series(series, stop) => {
                self.cycle_run = Some(CannedCycleRun::new(series, block.context, sequence));
                self.after_move = stop;
                self.has_moved = true;
            }
            Action::Dwell(span) => self.dwell_left = span,
            Action::Stop(stop) => self.apply_stop(stop, now),
            Action::Ignore(ignored) => self.ignored = ignored,
            Action::Nothing | Action::Auxiliary | Action::Corner(_) | Action::Fault(_) => {}
        }
        false
    }
}

/// Time for reading all blocks that are read ahead before the axes start.
fn read_before_start(settings: &ControlSettings) -> Micros {
    Micros(settings.block_processing.0.saturating_mul(settings.look_ahead as u64))
}

#[cfg(test)]
mod tests;
