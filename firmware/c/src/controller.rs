//! The controller without pointers: parameters, moves, tick.

use arcfeed_board_app::application::buffers::Buffers;
use arcfeed_board_app::application::report::{refusal_code, state_code};
use arcfeed_firmware::controller::Measurement;
use arcfeed_firmware::output::telemetry::reason::Cause;
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::input::{Freshness, Input};
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::report::Alarm;
use arcfeed_firmware::supervisor::settings::{Settings, SettingsError};
use arcfeed_firmware::supervisor::signals::{BoardFault, Request, Signals};
use arcfeed_firmware::supervisor::{Output, Supervisor};
use arcfeed_link::message::codes::{FeedCode, PathCode, RefusalCode};
use arcfeed_link::message::fixed::Q40;
use arcfeed_link::message::prepared::PreparedReader;
use arcfeed_link::message::{Message, moves as encoding, table};
use arcfeed_model::job::OverrideLimits;
use arcfeed_nc::modal::Pose;
use arcfeed_units::{PERCENT, RevPerMin, Span};

use crate::adaptive::AdaptiveFeed;
use crate::moves::{ExecutingLine, LineMove, Slots, push};
use crate::status::ArcfeedStatus;
use crate::values::{
    ARCFEED_NO_RULE, ARCFEED_SIGNAL_ARM, ARCFEED_STATE_FAULTED, ArcfeedAdaptiveInput, ArcfeedAdaptiveOutput,
    ArcfeedInput, ArcfeedMove, ArcfeedOutput,
};

/// Signals of [`BoardFault`]; all others are those of a machine line.
const FAULTS: [BoardFault; 3] = [BoardFault::Watchdog, BoardFault::Parameters, BoardFault::Hardware];

/// Controller with its parameters and state, as the C functions use it; the moves are in the caller's memory after it.
pub struct Controller {
    supervisor: Supervisor,
    memory: Memory,
    buffers: Buffers,
    reader: PreparedReader,
    /// Whether the moves are those of a prepared program, and count only when it is complete.
    is_prepared: bool,
    used: usize,
    executing: ExecutingLine,
    adaptive: AdaptiveFeed,
    override_ratio: f32,
    fault: Signals,
    invalid_in_row: u8,
}

/// Inputs of a tick, checked.
struct Checked {
    input: Input,
    line: Option<u32>,
    is_valid: bool,
}

impl Controller {
    /// A controller in the idle state at 100 %, without parameters.
    ///
    /// # Errors
    /// Never: the default settings are valid.
    pub fn new() -> Result<Self, SettingsError> {
        Ok(Controller {
            supervisor: Supervisor::within(&OverrideLimits::default(), Settings::default())?,
            memory: Memory::with_override(FeedOverride::PROGRAMMED),
            buffers: Buffers::new(),
            reader: PreparedReader::new(),
            is_prepared: false,
            used: 0,
            executing: ExecutingLine::Nothing,
            adaptive: AdaptiveFeed::default(),
            override_ratio: 1.0,
            fault: Signals::NONE,
            invalid_in_row: 0,
        })
    }

    /// Whether the parameters are in force, and, if they belong to a prepared program, all of its moves.
    pub fn is_ready(&self) -> bool {
        self.buffers.job().is_some() && (!self.is_prepared || self.reader.result() == Ok(true))
    }

    /// Number of stored moves.
    pub fn moves(&self) -> usize {
        self.used
    }

    /// Puts the parameters of a flash page in force and deletes all moves.
    ///
    /// # Errors
    /// The laws have the override, or the page is invalid; then there are no parameters.
    pub fn load_page(&mut self, page: &[u8]) -> Result<(), ArcfeedStatus> {
        self.clear(false)?;
        self.buffers.read_page(page, |job| Supervisor::within(&job.limits, Settings::default()).is_ok())?;
        self.take_limits()?;
        Ok(())
    }

    /// Stores a move of a line after those of all earlier lines.
    ///
    /// # Errors
    /// The move is invalid, its line is not after that of the last one, no slot is free, or there are no parameters.
    pub fn add_move(&mut self, slots: &mut Slots, line: u32, added: &ArcfeedMove) -> Result<(), ArcfeedStatus> {
        let message = message(added).ok_or(ArcfeedStatus::Value)?;
        Ok(self.add_segment(slots, line, &message)?)
    }

    /// Begins to load a prepared program: deletes parameters and moves.
    ///
    /// # Errors
    /// The controller is armed: a feed law may be setting the override.
    pub fn begin_program(&mut self) -> Result<(), ArcfeedStatus> {
        self.clear(true)
    }

    /// Reads the next bytes of a prepared program. Returns whether it is complete and now in force.
    ///
    /// # Errors
    /// It is invalid: there are no parameters and no moves.
    pub fn load_program(&mut self, slots: &mut Slots, bytes: &[u8]) -> Result<bool, ArcfeedStatus> {
        if !self.is_prepared {
            return Err(ArcfeedStatus::Order);
        }
        let mut reader = self.reader.clone();
        let read = reader.on_bytes(bytes, &mut |line, kind, payload| self.on_entry(slots, line, kind, payload));
        self.reader = reader;
        let is_counted = self.reader.header().is_none_or(|header| header.moves as usize == self.used);
        match read {
            Ok(true) if !is_counted || self.buffers.job().is_none() => {
                self.forget();
                Err(ArcfeedStatus::Form)
            }
            Ok(is_complete) => Ok(is_complete),
            Err(error) => {
                self.forget();
                Err(error.into())
            }
        }
    }

    /// Runs one tick. Returns the outputs, and whether all inputs were valid; an invalid one is ignored.
    pub fn tick(&mut self, slots: &Slots, input: &ArcfeedInput) -> (ArcfeedOutput, bool) {
        let Checked { mut input, line, is_valid } = check(input);
        self.invalid_in_row =
            if input.position.invalid_in_row == 0 { 0 } else { self.invalid_in_row.saturating_add(1) };
        input.position.invalid_in_row = self.invalid_in_row;
        let is_ready = self.is_ready();
        let asks_to_arm = input.signals.asks(Request::Arm);
        if !is_ready {
            input.signals = without_arm(input.signals);
        }
        input.signals = input.signals.with(core::mem::take(&mut self.fault));
        let moves = slots.get(..self.used).unwrap_or_default();
        self.executing = self.executing.update(line.filter(|_| is_ready), input.measured.position.as_ref(), moves);
        let begun = self.executing.begun(moves);
        let work = begun.and_then(LineMove::work);
        let output = self.supervisor.tick(&mut self.memory, work, &input);
        let mut values = values(&output, begun, input.measured.spindle);
        self.override_ratio = values.override_ratio;
        if asks_to_arm && !is_ready {
            values.refusal = RefusalCode::NoParameters as u8;
        }
        (values, is_valid)
    }

    /// Combines the override of the last tick with the control's own, for a control whose input can only reduce the
    /// feed.
    pub fn adaptive_feed(&mut self, input: &ArcfeedAdaptiveInput) -> ArcfeedAdaptiveOutput {
        let (output, has_failed) = self.adaptive.update(&self.memory.state(), self.override_ratio, input);
        if has_failed {
            self.fault = Signals::of_fault(BoardFault::Hardware);
        }
        output
    }

    fn clear(&mut self, is_prepared: bool) -> Result<(), ArcfeedStatus> {
        if self.memory.state().is_engaged() {
            return Err(ArcfeedStatus::Busy);
        }
        self.is_prepared = is_prepared;
        self.reader = PreparedReader::new();
        self.forget();
        Ok(())
    }

    fn forget(&mut self) {
        self.buffers.clear();
        self.used = 0;
        self.executing = ExecutingLine::Nothing;
    }

    fn take_limits(&mut self) -> Result<(), RefusalCode> {
        let limits = self.buffers.job().map(|job| job.limits).ok_or(RefusalCode::NoParameters)?;
        self.supervisor = Supervisor::within(&limits, Settings::default()).map_err(|_| RefusalCode::Value)?;
        Ok(())
    }

    fn on_entry(&mut self, slots: &mut Slots, line: u32, kind: u8, payload: &[u8]) -> Result<(), RefusalCode> {
        let message = Message::decode(kind, payload).map_err(|_| RefusalCode::Message)?;
        match &message {
            Message::Begin(begin) if self.buffers.job().is_none() => self.buffers.staging.begin(begin.set),
            Message::Begin(_) => Err(RefusalCode::Order),
            Message::Commit(commit) => {
                self.buffers.staging.commit(commit)?;
                self.buffers.put_in_force();
                self.take_limits()
            }
            Message::SegmentArcs(arcs) => self.buffers.table.add_arcs(arcs),
            Message::SegmentFeed(feed) => self.buffers.table.add_feed(feed),
            Message::Segment(segment) => self.add_segment(slots, line, segment),
            part => self.buffers.staging.add(part),
        }
    }

    fn add_segment(&mut self, slots: &mut Slots, line: u32, message: &table::Segment) -> Result<(), RefusalCode> {
        self.buffers.check(message)?;
        let job = self.buffers.job().ok_or(RefusalCode::NoParameters)?;
        let rule = message.rule.and_then(|rule| job.rules.get(usize::from(rule)));
        let own = rule.map_or(job.tools.first(), |rule| job.tool_of(rule)).spindle;
        let spindle = message.spindle.map_or(own, |speed| RevPerMin(speed.value()));
        let start = encoding::pose(message.start, message.start_rotary).map_err(|_| RefusalCode::Value)?;
        let segment = self.buffers.prepare(message).ok_or(RefusalCode::Value)?;
        push(slots, self.used, LineMove { line, start, spindle, segment })?;
        self.used += 1;
        Ok(())
    }
}

/// The message of a move; `None` if a code or a number is invalid.
fn message(added: &ArcfeedMove) -> Option<table::Segment> {
    let path = [
        PathCode::Rapid,
        PathCode::Line,
        PathCode::CwXy,
        PathCode::CcwXy,
        PathCode::CwZx,
        PathCode::CcwZx,
        PathCode::CwYz,
        PathCode::CcwYz,
    ];
    let path = *path.get(usize::from(added.path))?;
    let has_feed = added.feed_nm_per_min > 0;
    let rotary = |at: [i64; 3]| (at != [0; 3]).then_some(at);
    let speed = added.spindle_rev_per_min;
    let spindle = if speed == 0.0 { None } else { Some(Q40::of(speed).filter(|_| speed > 0.0)?) };
    Some(table::Segment {
        count: 0,
        sequence: None,
        start: added.start_nm,
        end: added.end_nm,
        start_rotary: rotary(added.start_microdeg),
        end_rotary: rotary(added.end_microdeg),
        feed_code: if has_feed { FeedCode::PerMinute } else { FeedCode::Missing },
        feed: if has_feed { added.feed_nm_per_min } else { 0 },
        path,
        center: (!matches!(path, PathCode::Rapid | PathCode::Line)).then_some(added.center_nm),
        rule: (added.rule != ARCFEED_NO_RULE).then_some(added.rule),
        spindle,
        max_feed: (added.max_feed_nm_per_min > 0).then_some(added.max_feed_nm_per_min),
        end_percent: (added.end_percent != FeedOverride::PROGRAMMED.percent).then_some(added.end_percent),
    })
}

fn check(input: &ArcfeedInput) -> Checked {
    let position = encoding::pose(input.position_nm, Some(input.position_microdeg));
    let is_speed = input.spindle_rev_per_min.is_finite() && input.spindle_rev_per_min >= 0.0;
    let faults = FAULTS.map(Signals::of_fault).into_iter().filter(|fault| input.signals & fault.bits() != 0);
    let faults = faults.fold(Signals::NONE, Signals::with);
    let signals = Signals::of_machine(input.signals & !faults.bits());
    let is_valid = position.is_ok() && is_speed && signals.is_some();
    let age = Span(input.position_age_us);
    let measured = Measurement {
        position: position.ok().filter(|_: &Pose| age == Span(0)),
        // A stopped spindle: 100 %.
        spindle: RevPerMin(if is_speed { input.spindle_rev_per_min } else { 0.0 }),
        dt: Span(input.dt_us),
    };
    let input_of = |input: &ArcfeedInput| Input {
        position: Freshness { age, invalid_in_row: u8::from(position.is_err()) },
        link: Freshness { age: Span(input.link_age_us), invalid_in_row: 0 },
        operator_percent: input.operator_percent,
        signals: signals.unwrap_or_default().with(faults),
        ..Input::of(measured)
    };
    Checked { input: input_of(input), line: u32::try_from(input.line).ok(), is_valid }
}

fn without_arm(signals: Signals) -> Signals {
    Signals::of_machine(signals.bits() & !ARCFEED_SIGNAL_ARM).unwrap_or_default().with(faults_of(signals))
}

fn faults_of(signals: Signals) -> Signals {
    signals.fault().map_or(Signals::NONE, Signals::of_fault)
}

fn values(output: &Output, begun: Option<&LineMove>, spindle: RevPerMin) -> ArcfeedOutput {
    let override_ratio = f32::from(output.feed_override.percent) / PERCENT;
    let wanted_ratio = begun.zip(output.ipt_center).and_then(|(begun, ipt)| begun.segment.ratio_of(ipt));
    let chip_ratio =
        wanted_ratio.zip(begun).map(|(wanted, begun)| override_ratio / wanted * begun.spindle.0 / spindle.0);
    ArcfeedOutput {
        override_ratio,
        wanted_ratio: wanted_ratio.unwrap_or(0.0),
        chip_ratio: chip_ratio.filter(|ratio| ratio.is_finite()).unwrap_or(0.0),
        override_percent: output.feed_override.percent,
        state: state_code(&output.state) as u8,
        reason: Cause::from(output.reason) as u8,
        alarm: match output.alarm {
            Alarm::None => 0,
            Alarm::Passing => 1,
            Alarm::Latched => 2,
        },
        refusal: output.refusal.map_or(0, |refusal| refusal_code(refusal) as u8),
        is_followed: u8::from(begun.is_some()),
    }
}

/// Outputs where there is no controller: 0 %.
pub fn no_controller() -> ArcfeedOutput {
    ArcfeedOutput { state: ARCFEED_STATE_FAULTED, reason: Cause::Hardware as u8, alarm: 2, ..Default::default() }
}
