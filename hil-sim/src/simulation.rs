//! Simulation of a run: control, machine, override source and chip meter on one time base.

use std::collections::VecDeque;

use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::settings::SettingsError;
use arcfeed_firmware::supervisor::signals::Signals;
use arcfeed_law::move_table::MoveTable;
use arcfeed_model::cut::ContourSide;
use arcfeed_model::job::{FeedPolicy, Job, ToolSetup};
use arcfeed_model::machine::FeedLimit;
use arcfeed_model::telemetry::Sample;
use arcfeed_nc::machining::SpindleCommand;
use arcfeed_nc::modal::{Feed, Pose};
use arcfeed_nc::segment::{Arc, Path, RADIUS_TOLERANCE, Segment};
use arcfeed_units::{Micros, MmPerTooth, Nm, PERCENT, RevPerMin, US_PER_S};

use crate::faults::ControllerFault;
use crate::move_override::{DescentOverrides, MoveOverride};
use crate::override_source::controller::InProcessController;
use crate::override_source::{MachineSignals, MoveStart, OverrideSource};
use arcfeed_control::action::MoveContext;
use arcfeed_control::machine;
use arcfeed_control::{Control, ControlSettings};
use arcfeed_milling::cutting::measured_move::GoverningRule;
use arcfeed_milling::cutting::meter::{ChipMeter, STEADY_RATIO};

/// Period of interpolation, of the machine's reports and of the controller's tick.
pub const STEP: Micros = Micros::from_ms(1);

/// Largest difference between the ends of a planned move and the executed one: a corner behind a divided line is computed
/// again from the rest of the line. Far below the least increments of controls.
const SAME_POINT_MAX: Nm = Nm(5);

/// Deterministic simulation of control, machine, override source and chip meter on one time base.
#[derive(Debug)]
pub struct Simulation<D = InProcessController> {
    now: Micros,
    control: Control,
    source: D,
    output: FeedOverride,
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

/// Conditions of a move that only its plan knows, such as its engaged arcs or its largest feed.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedConditions {
    /// The move, in the workpiece's coordinates; it is recognised by its path, whatever its feed.
    pub segment: Segment,
    /// Index of the cut rule for the move in the job's list; `None` without a rule.
    pub rule: Option<usize>,
    /// Table along the move: engaged arcs for a rule that expects them with each move, or feeds for a move without a rule.
    pub along: Option<Box<MoveTable>>,
    /// Largest feed on the move; `None` if the limits of the job's axes and its ceiling apply.
    pub limit: Option<FeedLimit>,
    /// Largest override at the end of the move, %: the next move begins with it.
    pub end_percent: u8,
    /// Side of the contour on which the tool runs; only for a move under G41 or G42.
    pub side: Option<ContourSide>,
    /// Target chip load of this move; only for a tool whose target is the programmed feed.
    pub target: Option<MmPerTooth>,
}

impl PlannedConditions {
    fn is_of(&self, segment: &Segment) -> bool {
        let own = &self.segment;
        is_same_point(&own.start, &segment.start)
            && is_same_point(&own.end, &segment.end)
            && is_same_path(&own.path, &segment.path)
    }

    /// Whether a move is this one, or the first piece of it.
    fn is_at(&self, segment: &Segment, is_in_pieces: bool) -> bool {
        self.is_of(segment) || is_in_pieces && self.begins_with(segment)
    }

    fn begins_with(&self, segment: &Segment) -> bool {
        let (Some(own), Some(arc)) = (self.segment.arc(), segment.arc()) else { return false };
        is_same_point(&self.segment.start, &segment.start) && is_same_circle(own, arc)
    }

    /// Conditions of the first piece of its arc: those that do not depend on where the move ends.
    fn of_piece(self) -> Self {
        let end_percent = FeedOverride::PROGRAMMED.percent;
        PlannedConditions { along: None, limit: None, end_percent, side: None, target: None, ..self }
    }
}

impl Simulation {
    /// Simulation of a control that reads from its DNC line, with the controller of the job.
    ///
    /// # Errors
    /// The bounds of the override are invalid.
    pub fn on_line(settings: ControlSettings, job: &Job, fault: ControllerFault) -> Result<Self, SettingsError> {
        Ok(Simulation::new(Control::on_line(settings), job, InProcessController::new(job, fault, STEP.into())?))
    }

    /// Simulation of a control with the program in its memory, with the controller of the job.
    ///
    /// # Errors
    /// The bounds of the override are invalid.
    pub fn from_memory(
        settings: ControlSettings,
        program: &[u8],
        job: &Job,
        fault: ControllerFault,
    ) -> Result<Self, SettingsError> {
        Ok(Simulation::new(
            Control::from_memory(settings, program),
            job,
            InProcessController::new(job, fault, STEP.into())?,
        ))
    }
}

impl<D: OverrideSource> Simulation<D> {
    /// Simulation of a control whose override comes from `source`.
    pub fn new(control: Control, job: &Job, source: D) -> Self {
        Simulation {
            now: Micros(0),
            control,
            source,
            output: FeedOverride::PROGRAMMED,
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
    pub fn step(&mut self) {
        self.now = self.now.after(STEP);
        let before = self.control.moves_begun();
        self.control.step(self.now, STEP, self.output.percent);
        let active = self.control.active().map(|(count, segment)| (count, *segment));
        self.context = self.control.context().copied().unwrap_or(self.context);
        if let Some((count, segment)) = active.filter(|_| self.control.moves_begun() != before) {
            self.begin(count, &segment.shifted(Pose::ORIGIN.minus(self.context.origin)));
        }
        if active.is_none() {
            self.source.begin(None);
        }
        let mut sample = machine::sample(&self.control, self.now);
        sample.position = sample.position.minus(self.context.origin);
        self.measure(&sample);
        self.record_override(sample.block, sample.override_percent);
        self.output = self.source.decide(&self.shown(&sample.position, active.is_some()));
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

    /// The override source.
    pub fn source(&self) -> &D {
        &self.source
    }

    /// The override source, mutable.
    pub fn source_mut(&mut self) -> &mut D {
        &mut self.source
    }

    /// The override source, at the end.
    pub fn into_source(self) -> D {
        self.source
    }

    /// Override that the source gave last.
    pub fn override_output(&self) -> FeedOverride {
        self.output
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

    fn begin(&mut self, count: u32, segment: &Segment) {
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
        self.source.begin(Some(MoveStart { count, segment, rule, along, spindle, limit, end_percent }));
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

/// Takes the next of these moves that equals this one, or of which it is the first piece; discards those before it.
fn take_planned(
    ahead: &mut VecDeque<PlannedConditions>,
    segment: &Segment,
    is_in_pieces: bool,
) -> Option<PlannedConditions> {
    let at = ahead.iter().position(|known| known.is_at(segment, is_in_pieces))?;
    let known = ahead.drain(..=at).next_back()?;
    Some(if known.is_of(segment) { known } else { known.of_piece() })
}

/// Whether an arc is the next piece of another: it has no N, begins where the other ended, and continues about the same
/// centre. A piece belongs to its arc's rule, whatever N and level the rule requires.
fn continues(last: &Segment, next: &Segment) -> bool {
    let (Some(before), Some(arc)) = (last.arc(), next.arc()) else { return false };
    next.sequence.is_none() && next.start == last.end && is_same_circle(before, arc)
}

/// Whether two poses are the same point, but for the rounding of corners.
fn is_same_point(one: &Pose, other: &Pose) -> bool {
    let mut linear = one.linear.iter().zip(&other.linear);
    one.rotary == other.rotary && linear.all(|(a, b)| (a.0 - b.0).abs() <= SAME_POINT_MAX.0)
}

/// Whether two moves between the same points have the same path, but for the rounding of corners.
fn is_same_path(one: &Path, other: &Path) -> bool {
    match (one, other) {
        (Path::Arc(one), Path::Arc(other)) => {
            is_same_circle(one, other) && (one.from == one.to) == (other.from == other.to)
        }
        _ => one == other,
    }
}

/// Whether two arcs run about the same centre in the same sense.
fn is_same_circle(one: &Arc, other: &Arc) -> bool {
    let is_near = |a: Nm, b: Nm| (a.0 - b.0).abs() <= RADIUS_TOLERANCE.0;
    let mut centers = one.center.iter().zip(&other.center);
    (one.plane, one.turn) == (other.plane, other.turn) && centers.all(|(a, b)| is_near(*a, *b))
}

/// Target chip load on a move of the original program, for a tool whose target is the programmed feed.
fn programmed_target(segment: &Segment, setup: &ToolSetup, command: SpindleCommand) -> Option<MmPerTooth> {
    let Feed::PerMinute(feed) = segment.feed else { return None };
    let spindle = setup.speed(command).filter(|_| setup.follows_program)?;
    setup.target_of(feed, spindle)
}
