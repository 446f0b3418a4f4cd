//! A Fanuc-like control in DNC operation: bytes in, axis positions out.
//!
//! Modelled: the serial line with XON/XOFF and its buffer, reading ahead, execution of blocks at override-scaled feed
//! under acceleration limits, alarms. Not modelled here: drives (positions are as commanded), parity and code checks.

pub mod dnc_port;

pub mod reader;

pub mod executive;

pub mod path;

pub mod interpolator;

use std::collections::VecDeque;

use arcfeed_shared::nc::alarm::{Alarm, Fault};
use arcfeed_shared::nc::macros::program::Library;
use arcfeed_shared::nc::modal::{Pose, Stop};
use arcfeed_shared::segment::Segment;
use arcfeed_shared::units::{LengthUnit, Micros, MmPerMin, US_PER_MS};

use dnc_port::{DncPort, LineCounters, LineSettings};
use executive::{Executive, Next, has_macros};
use interpolator::{Dynamics, Interpolator};
use reader::Action;

/// Settings of the control; values marked assumed are published nowhere for the machine of the source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlSettings {
    /// Unit at power-on.
    pub unit: LengthUnit,
    /// The serial line.
    pub line: LineSettings,
    /// Blocks read ahead of the one being executed.
    pub look_ahead: usize,
    /// What the axes can do.
    pub dynamics: Dynamics,
    /// Steps from the override input to its effect: the scan of the machine's ladder (8 ms, assumed).
    pub ladder_delay_steps: usize,
    /// How long after M0 the simulated operator presses cycle start.
    pub operator_restart: Micros,
}

impl ControlSettings {
    /// A 16i-like control on a mid-size five-axis machine.
    pub fn fanuc_16i(unit: LengthUnit) -> Self {
        ControlSettings {
            unit,
            line: LineSettings::default(),
            look_ahead: 15,
            dynamics: Dynamics::default(),
            ladder_delay_steps: 8,
            operator_restart: Micros::from_ms(1_000),
        }
    }
}

/// Why the control stopped before the end of its program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlarmRecord {
    /// Line of the program as received, counted from 1.
    pub line: u32,
    /// What the control found.
    pub fault: Fault,
}

/// The control's state.
#[derive(Debug)]
pub struct Control {
    settings: ControlSettings,
    port: DncPort,
    reader: Executive,
    interpolator: Interpolator,
    waits_until: Option<Micros>,
    after_move: Option<Stop>,
    alarm: Option<AlarmRecord>,
    ended: bool,
    held: bool,
    executed: Vec<Vec<u8>>,
    starved_ms: u64,
    has_moved: bool,
    /// The program is busy with macro statements, and gives no block this step.
    is_computing: bool,
    ladder: VecDeque<u8>,
    override_percent: u8,
}

impl Control {
    /// A control that reads its program from the DNC line.
    pub fn on_line(settings: ControlSettings) -> Self {
        Control::with_library(settings, Box::new(()))
    }

    /// A control that reads its program from the DNC line and calls subprograms of a library.
    pub fn with_library(settings: ControlSettings, library: Box<dyn Library>) -> Self {
        Control::new(settings, DncPort::on_line(settings.line), Executive::on_line(settings.unit, library))
    }

    /// A control that has the whole program in its memory.
    pub fn from_memory(settings: ControlSettings, program: &[u8]) -> Self {
        Control::from_memory_with(settings, program, Box::new(()))
    }

    /// A control that has the whole program and a library of subprograms in its memory.
    pub fn from_memory_with(settings: ControlSettings, program: &[u8], library: Box<dyn Library>) -> Self {
        if has_macros(program) {
            let executive = Executive::in_memory(program, settings.unit, library);
            return Control::new(settings, DncPort::from_memory(b""), executive);
        }
        Control::new(settings, DncPort::from_memory(program), Executive::on_line(settings.unit, library))
    }

    fn new(settings: ControlSettings, port: DncPort, reader: Executive) -> Self {
        Control {
            settings,
            port,
            reader,
            is_computing: false,
            interpolator: Interpolator::new(settings.dynamics),
            waits_until: None,
            after_move: None,
            alarm: None,
            ended: false,
            held: false,
            executed: Vec::new(),
            starved_ms: 0,
            has_moved: false,
            ladder: VecDeque::new(),
            override_percent: 100,
        }
    }

    /// The byte port.
    pub fn port(&mut self) -> &mut DncPort {
        &mut self.port
    }

    /// What went over the line.
    pub fn line_counters(&self) -> LineCounters {
        self.port.counters()
    }

    /// Whether the control has sent something that nobody has fetched yet.
    pub fn has_to_say(&self) -> bool {
        self.port.has_to_say()
    }

    /// Feed hold: the axes come to rest and stay there.
    pub fn hold(&mut self) {
        self.held = true;
    }

    /// Whether feed hold is on.
    pub fn is_held(&self) -> bool {
        self.held
    }

    /// One interpolation period; `override_percent` is what stands at the override input.
    pub fn step(&mut self, now: Micros, dt: Micros, override_percent: u8) {
        if let Some(fault) = self.port.step(dt) {
            self.stop_with(AlarmRecord { line: self.reader.line(), fault });
        }
        self.override_percent = self.through_ladder(override_percent);
        self.read_ahead(now);
        let mut left_s = dt.to_s();
        while left_s > 0.0 {
            self.start_next(now);
            left_s = self.interpolator.advance(left_s, self.override_percent, self.held || self.is_over());
        }
        let waits = self.waits_until.is_some() || self.is_over() || self.is_computing;
        if self.interpolator.is_idle() && self.interpolator.queued() == 0 && !waits && self.port.is_exhausted() {
            self.stop_with(AlarmRecord { line: self.reader.line(), fault: Fault::alarm(Alarm::EndOfRecord, 0) });
        }
        let has_nothing = self.interpolator.is_idle() && self.interpolator.queued() == 0;
        if has_nothing && !waits && self.has_moved {
            self.starved_ms += dt.0 / US_PER_MS;
        }
        if self.is_over() {
            self.port.close();
        }
    }

    /// The override takes effect one scan of the machine's ladder after it stood at the input.
    fn through_ladder(&mut self, override_percent: u8) -> u8 {
        self.ladder.push_back(override_percent);
        if self.ladder.len() > self.settings.ladder_delay_steps {
            return self.ladder.pop_front().unwrap_or(override_percent);
        }
        self.override_percent
    }

    /// Where the axes are commanded to.
    pub fn position(&self) -> Pose {
        self.interpolator.position()
    }

    /// The move being executed and the count of blocks executed so far.
    pub fn active(&self) -> Option<(u32, &Segment)> {
        self.interpolator.active()
    }

    /// Programmed feed times override of the active move; zero at rapid and at rest.
    pub fn commanded(&self) -> MmPerMin {
        self.interpolator.commanded()
    }

    /// The override in effect, %.
    pub fn override_percent(&self) -> u8 {
        self.override_percent
    }

    /// Blocks executed, byte for byte as received, without their line ends.
    pub fn executed(&self) -> &[Vec<u8>] {
        &self.executed
    }

    /// What the program has sent to the punch: DPRNT and the like, as far as it is read.
    pub fn output(&self) -> &[u8] {
        self.reader.output()
    }

    /// Messages of the program (#3006, #3000), and where in a called program an alarm came up.
    pub fn messages(&self) -> impl Iterator<Item = &str> {
        self.reader.messages()
    }

    /// The alarm that stopped it.
    pub fn alarm(&self) -> Option<&AlarmRecord> {
        self.alarm.as_ref()
    }

    /// Whether the program came to its end (M02, M30).
    pub fn has_ended(&self) -> bool {
        self.ended
    }

    /// Whether nothing will move any more: program end or alarm.
    pub fn is_over(&self) -> bool {
        self.ended || self.alarm.is_some()
    }

    /// Whether the axes rest.
    pub fn is_at_rest(&self) -> bool {
        self.interpolator.is_at_rest()
    }

    /// Time without a block to execute, after the first move.
    pub fn starved_ms(&self) -> u64 {
        self.starved_ms
    }

    fn stop_with(&mut self, alarm: AlarmRecord) {
        self.alarm.get_or_insert(alarm);
    }

    /// Fills the look-ahead. A block with a fault stops the control when its turn comes, not when it is read.
    fn read_ahead(&mut self, now: Micros) {
        self.is_computing = false;
        while self.interpolator.queued() < self.settings.look_ahead {
            match self.reader.next(now) {
                Next::Block(block) => self.interpolator.queue(*block),
                Next::Starved => match self.port.take_line() {
                    Some(text) => self.reader.take(&text),
                    None => return,
                },
                Next::Busy => {
                    self.is_computing = true;
                    return;
                }
                Next::Over => return,
            }
        }
    }

    /// Takes up what is next: blocks that take no time, up to a move or a wait.
    fn start_next(&mut self, now: Micros) {
        if !self.interpolator.is_idle() || self.waits_until.is_some_and(|until| now < until) {
            return;
        }
        self.waits_until = None;
        if let Some(stop) = self.after_move.take() {
            self.go_on(stop, now);
        }
        while self.waits_until.is_none() && !self.is_over() {
            let Some(block) = self.interpolator.take_next(self.executed.len()) else { return };
            if let Action::Fault(fault) = block.action {
                self.stop_with(AlarmRecord { line: block.line, fault });
                return;
            }
            self.executed.push(block.text);
            match block.action {
                Action::Move(_, stop) => {
                    self.after_move = stop;
                    self.has_moved = true;
                    return;
                }
                Action::Dwell(span) => self.waits_until = Some(now.after(span)),
                Action::Stop(stop) => self.go_on(stop, now),
                Action::Nothing | Action::Auxiliary | Action::Fault(_) => {}
            }
        }
    }

    fn go_on(&mut self, stop: Stop, now: Micros) {
        match stop {
            Stop::Program => self.waits_until = Some(now.after(self.settings.operator_restart)),
            Stop::End => self.ended = true,
            // The optional-stop switch is off.
            Stop::Optional => {}
        }
    }
}

#[cfg(test)]
mod tests;
