//! Control, machine, controller and meter on one time base: a run.

use std::collections::VecDeque;

use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::settings::SettingsError;
use arcfeed_firmware::supervisor::signals::Signals;
use arcfeed_shared::engaged::EngagedTable;
use arcfeed_shared::job::{FeedPolicy, Job};
use arcfeed_shared::machine::FeedLimit;
use arcfeed_shared::nc::machining::SpindleCommand;
use arcfeed_shared::nc::modal::Pose;
use arcfeed_shared::segment::{RADIUS_TOLERANCE, Segment};
use arcfeed_shared::telemetry::Sample;
use arcfeed_shared::units::{Micros, Nm, PERCENT, RevPerMin, US_PER_S};

use crate::control::action::Manner;
use crate::control::{Control, ControlSettings};
use crate::cutting::meter::{ChipMeter, MeterSettings, STEADY_RATIO};
use crate::decider::told::Told;
use crate::decider::{Begun, Decider, Shown};
use crate::faults::ControllerFault;
use crate::machine;

/// The period of interpolation, of the machine's reports and of the controller's tick.
pub const STEP: Micros = Micros::from_ms(1);

/// Everything that runs; deterministic.
#[derive(Debug)]
pub struct Rig<D = Told> {
    now: Micros,
    control: Control,
    decider: D,
    output: FeedOverride,
    job: Job,
    meter: ChipMeter,
    overrides: Vec<MoveOverride>,
    first_move: Option<Micros>,
    /// Up to here the axes still come from the move before.
    settles_until: Micros,
    /// Of the move begun last. Positions and moves are the workpiece's: seen from its origin.
    manner: Manner,
    /// The move begun last, and its rule.
    last: Option<(Segment, Option<usize>)>,
    /// Those still to come.
    foreseen: VecDeque<Foreseen>,
}

/// A move that cannot be looked at by itself, and what was worked out of it beforehand.
#[derive(Clone, Debug, PartialEq)]
pub struct Foreseen {
    /// The move, in the workpiece's coordinates; its feed does not count.
    pub segment: Segment,
    /// Index of the cut rule that governs it.
    pub rule: Option<usize>,
    /// Where the tool's circles are engaged along it, where its rule leaves that to be told.
    pub along: Option<EngagedTable>,
    /// The fastest feed on it, where that is known.
    pub limit: Option<FeedLimit>,
    /// Largest override at its end, %: what the move behind it begins with.
    pub end_percent: u8,
}

impl Foreseen {
    fn is_of(&self, segment: &Segment) -> bool {
        let Segment { start, end, path, .. } = &self.segment;
        (start, end, path) == (&segment.start, &segment.end, &segment.path)
    }
}

/// What the override did on one move that a cut rule speaks of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MoveOverride {
    /// Least, %.
    pub min_percent: u8,
    /// Largest, %.
    pub max_percent: u8,
    /// How often it changed.
    pub changes: u32,
    last_percent: u8,
}

impl Rig {
    /// A control that reads from its DNC line, with the controller of the job.
    ///
    /// # Errors
    /// Bounds of the override that make no sense.
    pub fn on_line(settings: ControlSettings, job: &Job, fault: ControllerFault) -> Result<Self, SettingsError> {
        Ok(Rig::new(Control::on_line(settings), job, Told::new(job, fault, STEP.into())?))
    }

    /// A control with the program in its memory, with the controller of the job.
    ///
    /// # Errors
    /// Bounds of the override that make no sense.
    pub fn from_memory(
        settings: ControlSettings,
        program: &[u8],
        job: &Job,
        fault: ControllerFault,
    ) -> Result<Self, SettingsError> {
        Ok(Rig::new(Control::from_memory(settings, program), job, Told::new(job, fault, STEP.into())?))
    }
}

impl<D: Decider> Rig<D> {
    /// A control whose override is decided by `decider`.
    pub fn new(control: Control, job: &Job, decider: D) -> Self {
        Rig {
            now: Micros(0),
            control,
            decider,
            output: FeedOverride::PROGRAMMED,
            meter: ChipMeter::new(MeterSettings {
                tool: job.tools.first().tool,
                spindle: job.tools.first().spindle,
                target_mm_per_tooth: f64::from(job.tools.first().feed_per_tooth.0),
            }),
            job: job.clone(),
            overrides: Vec::new(),
            first_move: None,
            settles_until: Micros(0),
            manner: Manner::default(),
            last: None,
            foreseen: VecDeque::new(),
        }
    }

    /// Takes what is known of special moves, and of those whose engagement is told, in the order in which they come; one that never comes hides none behind it.
    pub fn foresee(&mut self, moves: impl IntoIterator<Item = Foreseen>) {
        self.foreseen = moves.into_iter().collect();
    }

    /// One step of everything: the control moves, the machine reports, the meter measures, the controller decides.
    pub fn step(&mut self) {
        self.now = self.now.after(STEP);
        let before = self.control.active().map(|(count, segment)| (count, *segment));
        self.control.step(self.now, STEP, self.output.percent);
        let active = self.control.active().map(|(count, segment)| (count, *segment));
        self.manner = self.control.manner().copied().unwrap_or(self.manner);
        if let Some((count, segment)) = active.filter(|_| active != before) {
            self.begin(count, &segment.shifted(Pose::ORIGIN.minus(self.manner.origin)));
        }
        if active.is_none() {
            self.decider.begin(None);
        }
        let mut sample = machine::sample(&self.control, self.now);
        sample.position = sample.position.minus(self.manner.origin);
        self.measure(&sample);
        self.record_override(sample.block, sample.override_percent);
        self.output = self.decider.decide(&self.shown(&sample.position, active.is_some()));
    }

    /// Time since power-on.
    pub fn now(&self) -> Micros {
        self.now
    }

    /// Whether the program is over and the axes rest in position.
    pub fn is_done(&self) -> bool {
        let rests = self.control.is_at_rest() && self.control.is_in_position();
        self.control.is_over() && rests && !self.control.is_punching()
    }

    /// The control.
    pub fn control(&self) -> &Control {
        &self.control
    }

    /// The control, to act on.
    pub fn control_mut(&mut self) -> &mut Control {
        &mut self.control
    }

    /// Who decides the override.
    pub fn decider(&self) -> &D {
        &self.decider
    }

    /// Who decides the override, to act on.
    pub fn decider_mut(&mut self) -> &mut D {
        &mut self.decider
    }

    /// Who decided the override.
    pub fn into_decider(self) -> D {
        self.decider
    }

    /// The override as it was decided last.
    pub fn decided(&self) -> FeedOverride {
        self.output
    }

    /// The meter.
    pub fn meter(&self) -> &ChipMeter {
        &self.meter
    }

    /// The override on each move of [`ChipMeter::moves`], in the same order.
    pub fn overrides(&self) -> &[MoveOverride] {
        &self.overrides
    }

    /// Index of the cut rule that governs the move begun last.
    pub fn rule(&self) -> Option<usize> {
        self.last.and_then(|(_, rule)| rule)
    }

    /// What holds for the move begun last.
    pub fn manner(&self) -> &Manner {
        &self.manner
    }

    /// Time from the first move to now.
    pub fn cycle_time(&self) -> Micros {
        self.first_move.map_or(Micros(0), |first| self.now.since(first))
    }

    fn begin(&mut self, count: u32, segment: &Segment) {
        self.first_move.get_or_insert(self.now);
        let rules = &self.job.rules;
        let continued = self.last.filter(|(last, _)| self.is_in_pieces() && continues(last, segment));
        let is_special = self.manner.is_special;
        let matched = self.job.match_move(segment, &self.manner.machining);
        let plain = matched.governing().filter(|_| !is_special).map(|governing| (governing.index, governing.rule));
        let is_next = self.foreseen.front().is_some_and(|known| known.is_of(segment));
        let known = if is_special || plain.is_some() || is_next { foreseen(&mut self.foreseen, segment) } else { None };
        let by_index = |index: usize| Some((index, rules.get(index)?));
        let found = match continued {
            Some((_, rule)) => rule.and_then(by_index),
            None if known.as_ref().is_some_and(|known| known.rule.is_none()) => None,
            None if is_special => known.as_ref().and_then(|known| known.rule).and_then(by_index),
            None => plain,
        };
        if let Some((_, rule)) = found {
            let setup = self.job.tool_of(rule);
            self.meter.set_tool(setup.tool, f64::from(setup.feed_per_tooth.0));
        }
        match continued {
            Some(_) => self.meter.go_on(count, segment, found),
            None => {
                let settling_us = self.control.settling_s(STEADY_RATIO) * US_PER_S as f64;
                self.settles_until = self.now.after(Micros(settling_us as u64));
                self.meter.begin(count, segment, found);
            }
        }
        if found.is_some() && continued.is_none() {
            self.overrides.push(MoveOverride { min_percent: u8::MAX, max_percent: 0, changes: 0, last_percent: 0 });
        }
        self.last = Some((*segment, found.map(|(index, _)| index)));
        let limit = known.as_ref().and_then(|known| known.limit);
        let along = known.as_ref().and_then(|known| known.along.as_ref());
        let end_percent = known.as_ref().map_or(FeedOverride::PROGRAMMED.percent, |known| known.end_percent);
        let rule = found.map(|(_, rule)| rule);
        let machining = self.manner.machining;
        let setup = rule.map_or(self.job.setup_in(machining.tool), |rule| self.job.tool_of(rule));
        let spindle = setup.speed(machining.spindle).unwrap_or(setup.spindle);
        self.decider.begin(Some(Begun { count, segment, rule, along, spindle, limit, end_percent }));
    }

    fn shown(&self, position: &Pose, is_moving: bool) -> Shown {
        let held = if self.control.is_held() { Signals::FEED_HOLD } else { Signals::NONE };
        let forced = if is_moving && self.manner.is_tapping { Signals::TAPPING } else { Signals::NONE };
        Shown {
            at: self.now,
            position: machine::feedback(position),
            spindle: self.spindle(),
            operator_percent: PERCENT as u8,
            signals: held.with(forced),
        }
    }

    /// Chips are measured with the spindle's speed, once the axes are on the move in work. What its feed is to be compared with
    /// reaches the axes as late as they are.
    fn measure(&mut self, sample: &Sample) {
        self.meter.set_spindle(self.spindle());
        if self.now < self.settles_until {
            self.meter.leave_out(sample);
        } else {
            self.meter.take(&Sample { commanded: self.control.followed_feed(), ..*sample });
        }
    }

    /// The spindle's speed: its drive's, or without a drive what the program commands, or the job where it commands nothing.
    pub fn spindle(&self) -> RevPerMin {
        match (self.control.spindle(), self.manner.machining.spindle) {
            (Some(drive), _) => RevPerMin(libm::fabs(drive.rev_per_min()) as f32),
            (None, SpindleCommand::RevPerMin(speed)) => RevPerMin(speed as f32),
            (None, SpindleCommand::Stopped) => RevPerMin(0.0),
            (None, SpindleCommand::Unstated) => self.job.setup_in(self.manner.machining.tool).spindle,
        }
    }

    fn is_in_pieces(&self) -> bool {
        matches!(self.job.policy, FeedPolicy::RewriteOnly(_))
    }

    fn record_override(&mut self, block: u32, percent: u8) {
        let Some(figures) = self.overrides.last_mut().filter(|_| self.meter.is_on(block)) else { return };
        figures.changes += u32::from(figures.max_percent > 0 && percent != figures.last_percent);
        figures.min_percent = figures.min_percent.min(percent);
        figures.max_percent = figures.max_percent.max(percent);
        figures.last_percent = percent;
    }
}

/// The next of these moves that is this one; those before it are over.
fn foreseen(ahead: &mut VecDeque<Foreseen>, segment: &Segment) -> Option<Foreseen> {
    let at = ahead.iter().position(|known| known.is_of(segment))?;
    ahead.drain(..=at).next_back()
}

/// Whether an arc is the next piece of another: it has no N, begins where that one ended, and goes on about the same
/// centre. A piece belongs to its arc's rule, whatever N and level the rule asks for.
fn continues(last: &Segment, next: &Segment) -> bool {
    let (Some(before), Some(arc)) = (last.arc(), next.arc()) else { return false };
    let is_near = |a: Nm, b: Nm| (a.0 - b.0).abs() <= RADIUS_TOLERANCE.0;
    let centers = before.center.iter().zip(&arc.center);
    next.sequence.is_none()
        && next.start == last.end
        && (arc.plane, arc.turn) == (before.plane, before.turn)
        && centers.into_iter().all(|(a, b)| is_near(*a, *b))
}
