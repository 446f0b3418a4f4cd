//! The machine of a simulation: control, axes, chip meter and what they have executed, on one time base.

use std::collections::VecDeque;

use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::signals::Signals;
use arcfeed_law::move_table::MoveTable;
use arcfeed_model::job::{FeedPolicy, Job, ToolSetup};
use arcfeed_model::telemetry::Sample;
use arcfeed_nc::machining::SpindleCommand;
use arcfeed_nc::modal::{Feed, Pose};
use arcfeed_nc::segment::Segment;
use arcfeed_units::{Micros, MmPerTooth, PERCENT, RevPerMin, US_PER_S};

use crate::move_override::{DescentOverrides, MoveOverride};
use crate::override_source::{Decision, MachineSignals, MoveStart, OverrideSource};
use crate::planned_conditions::{PlannedConditions, continues, take_planned};
use arcfeed_control::Control;
use arcfeed_control::action::MoveContext;
use arcfeed_control::machine;
use arcfeed_milling::cutting::measured_move::GoverningRule;
use arcfeed_milling::cutting::meter::{ChipMeter, STEADY_RATIO};

/// Period of interpolation, of the machine's reports and of the controller's tick.
pub const STEP: Micros = Micros::from_ms(1);

/// Control and machine, whose override a source sets once a period.
#[derive(Debug)]
pub struct SimulatedMachine {
    now: Micros,
    control: Control,
    output: FeedOverride,
    decision: Option<Decision>,
    job: Job,
    meter: ChipMeter,
    overrides: Vec<MoveOverride>,
    descents: DescentOverrides,
    first_move: Option<Micros>,
    /// Time until which the axes still lag from the move before.
    settles_until: Micros,
    /// Context of the last move begun. Positions and moves are in the workpiece's coordinates.
    context: MoveContext,
    /// Last move begun, and its rule.
    last: Option<(Segment, Option<usize>)>,
    /// Planned conditions of moves to come.
    planned: VecDeque<PlannedConditions>,
}

impl SimulatedMachine {
    /// Machine with this control, whose moves are measured by the rules and tools of a job.
    pub(crate) fn new(control: Control, job: &Job) -> Self {
        SimulatedMachine {
            now: Micros(0),
            control,
            output: FeedOverride::PROGRAMMED,
            decision: None,
            meter: ChipMeter::new(job.tools.first()),
            job: job.clone(),
            overrides: Vec::new(),
            descents: DescentOverrides::default(),
            first_move: None,
            settles_until: Micros(0),
            context: MoveContext::default(),
            last: None,
            planned: VecDeque::new(),
        }
    }

    /// Sets the planned conditions of special moves and of moves whose engaged arcs are known, in program order. If a move of the list is
    /// never executed, the later ones still apply.
    pub fn set_planned_conditions(&mut self, moves: impl IntoIterator<Item = PlannedConditions>) {
        self.planned = moves.into_iter().collect();
    }

    /// Simulates one period: the control moves the axes, the machine reports, the meter measures, the override source
    /// decides.
    pub(crate) fn step(&mut self, source: &mut dyn OverrideSource) {
        self.now = self.now.after(STEP);
        let before = self.control.moves_begun();
        self.control.step(self.now, STEP, self.output.percent);
        if let Some(context) = self.control.context() {
            self.context = *context;
        }
        match self.control.active() {
            Some((count, segment)) if self.control.moves_begun() != before => {
                let segment = segment.shifted(Pose::ORIGIN.minus(self.context.origin));
                self.begin(count, &segment, source);
            }
            Some(_) => {}
            None => source.begin(None),
        }
        let mut sample = machine::sample(&self.control, self.now);
        sample.position = sample.position.minus(self.context.origin);
        self.measure(&sample);
        self.record_override(sample.block, sample.override_percent);
        self.output = source.decide(&self.shown(&sample.position, self.control.active().is_some()));
        self.decision = source.decision();
    }

    /// Time since power-on.
    pub fn now(&self) -> Micros {
        self.now
    }

    /// Whether the program is over, the axes rest and are in position.
    pub fn is_done(&self) -> bool {
        let rests = self.control.is_at_rest() && self.control.is_in_position();
        self.control.is_over() && rests && !self.control.is_punching()
    }

    /// The control.
    pub fn control(&self) -> &Control {
        &self.control
    }

    /// The control, mutable.
    pub fn control_mut(&mut self) -> &mut Control {
        &mut self.control
    }

    /// Override that the source gave last.
    pub fn override_output(&self) -> FeedOverride {
        self.output
    }

    /// Decision behind that override; `None` before the first one, and of a source that reports none.
    pub fn decision(&self) -> Option<Decision> {
        self.decision
    }

    /// The chip meter.
    pub fn meter(&self) -> &ChipMeter {
        &self.meter
    }

    /// The override on each move of [`ChipMeter::moves`], in the same order.
    pub fn overrides(&self) -> &[MoveOverride] {
        &self.overrides
    }

    /// The override on each descent (plunge or ramp) with a table of feeds, in order of execution.
    pub fn descent_overrides(&self) -> &[MoveOverride] {
        self.descents.moves()
    }

    /// Index of the cut rule for the last move begun; `None` without one.
    pub fn rule(&self) -> Option<usize> {
        self.last.and_then(|(_, rule)| rule)
    }

    /// Last move begun, in the workpiece's coordinates; `None` before the first.
    pub fn segment(&self) -> Option<&Segment> {
        self.last.as_ref().map(|(segment, _)| segment)
    }

    /// Context of the last move begun: work offset, tool, spindle, functions in force.
    pub fn context(&self) -> &MoveContext {
        &self.context
    }

    /// Time from the beginning of the first move to now; 0 before it.
    pub fn cycle_time(&self) -> Micros {
        self.first_move.map_or(Micros(0), |first| self.now.since(first))
    }

    fn begin(&mut self, count: u32, segment: &Segment, source: &mut dyn OverrideSource) {
        self.first_move.get_or_insert(self.now);
        let (rules, is_in_pieces) = (&self.job.rules, self.is_in_pieces());
        let continued = self.last.filter(|(last, _)| is_in_pieces && continues(last, segment));
        let is_special = self.context.is_special;
        let matched = self.job.match_move(segment, &self.context.machining);
        let plain = matched.governing().filter(|_| !is_special).map(|governing| (governing.index, governing.rule));
        let is_next = self.planned.front().is_some_and(|known| known.is_at(segment, is_in_pieces));
        let known = if is_next || continued.is_none() && (is_special || plain.is_some()) {
            take_planned(&mut self.planned, segment, is_in_pieces)
        } else {
            None
        };
        // An arc that is planned for itself is no piece of the one before it.
        let continued = continued.filter(|_| known.is_none());
        let by_index = |index: usize| Some((index, rules.get(index)?));
        let found = match continued {
            Some((_, rule)) => rule.and_then(by_index),
            None if is_special => known.as_ref().and_then(|known| known.rule).and_then(by_index),
            None => plain.and_then(|plain| known.as_ref().map_or(Some(plain), |known| known.rule.and_then(by_index))),
        };
        let along = known.as_ref().and_then(|known| known.along.as_deref());
        let planned_target = known.as_ref().and_then(|known| known.target);
        let side = known.as_ref().and_then(|known| known.side);
        let on_side = found.zip(side).map(|((index, rule), side)| (index, rule.on_side(side)));
        let found = on_side.as_ref().map_or(found, |(index, rule)| Some((*index, rule)));
        let governing = found.map(|(index, rule)| {
            let setup = self.job.tool_of(rule);
            let target = planned_target.or_else(|| programmed_target(segment, setup, self.context.machining.spindle));
            GoverningRule { index, rule, setup, along: along.and_then(MoveTable::engaged), target }
        });
        match continued {
            Some(_) => self.meter.continue_move(count, segment, governing.as_ref()),
            None => {
                let settling_us = self.control.settling_s(STEADY_RATIO) * US_PER_S as f64;
                self.settles_until = self.now.after(Micros(settling_us as u64));
                self.meter.begin(count, segment, governing.as_ref());
            }
        }
        if found.is_some() && continued.is_none() {
            self.overrides.push(MoveOverride::NONE);
        }
        let is_descent = found.is_none() && matches!(along, Some(MoveTable::Feeds(_)));
        self.descents.begin(is_descent.then_some(count));
        self.last = Some((*segment, found.map(|(index, _)| index)));
        let limit = known.as_ref().and_then(|known| known.limit);
        let end_percent = known.as_ref().map_or(FeedOverride::PROGRAMMED.percent, |known| known.end_percent);
        let rule = found.map(|(_, rule)| rule);
        let machining = self.context.machining;
        let setup = rule.map_or(self.job.setup_in(machining.tool), |rule| self.job.tool_of(rule));
        let spindle = setup.speed(machining.spindle).unwrap_or(setup.spindle);
        source.begin(Some(MoveStart { count, segment, rule, along, spindle, limit, end_percent }));
    }

    fn shown(&self, position: &Pose, is_moving: bool) -> MachineSignals {
        let held = if self.control.is_held() { Signals::FEED_HOLD } else { Signals::NONE };
        let forced = if is_moving && self.context.is_tapping { Signals::TAPPING } else { Signals::NONE };
        MachineSignals {
            at: self.now,
            position: machine::feedback(position),
            spindle: self.spindle(),
            operator_percent: PERCENT as u8,
            signals: held.with(forced),
        }
    }

    /// Measures chips with the spindle's speed, once the axes are on the move in execution. The feed for comparison has
    /// the same lag as the axes.
    fn measure(&mut self, sample: &Sample) {
        self.meter.set_spindle(self.spindle());
        if self.now < self.settles_until {
            self.meter.leave_out(sample);
        } else {
            self.meter.add_sample(&Sample { commanded: self.control.followed_feed(), ..*sample });
        }
    }

    /// Spindle speed: the drive's or, without a drive, the commanded speed, or the job's if the program commands none.
    pub fn spindle(&self) -> RevPerMin {
        match (self.control.spindle(), self.context.machining.spindle) {
            (Some(drive), _) => RevPerMin(libm::fabs(drive.rev_per_min()) as f32),
            (None, SpindleCommand::RevPerMin(speed)) => RevPerMin(speed as f32),
            (None, SpindleCommand::Stopped) => RevPerMin(0.0),
            (None, SpindleCommand::Unstated) => self.job.setup_in(self.context.machining.tool).spindle,
        }
    }

    fn is_in_pieces(&self) -> bool {
        matches!(self.job.policy, FeedPolicy::RewriteOnly(_))
    }

    fn record_override(&mut self, block: u32, percent: u8) {
        let of_rule = self.overrides.last_mut().filter(|_| self.meter.is_on(block));
        if let Some(figures) = self.descents.on(block).or(of_rule) {
            figures.record(percent);
        }
    }
}

/// Target chip load on a move of the original program, for a tool whose target is the programmed feed.
fn programmed_target(segment: &Segment, setup: &ToolSetup, command: SpindleCommand) -> Option<MmPerTooth> {
    let Feed::PerMinute(feed) = segment.feed else { return None };
    let spindle = setup.speed(command).filter(|_| setup.follows_program)?;
    setup.target_of(feed, spindle)
}
