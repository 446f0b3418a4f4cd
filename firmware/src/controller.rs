//! The tick: (segment, position, spindle) -> override, feed per tooth at the centre, reason.

use arcfeed_shared::fmath;
use arcfeed_shared::job::{Job, OverrideLimits};
use arcfeed_shared::nc::modal::Pose;
use arcfeed_shared::units::{MmPerMin, MmPerTooth, RevPerMin, Span};

use crate::active::{ActiveSegment, MachineRatio, SentFeed};
use crate::law::NoWish;
use crate::progress::{PositionFilter, Progress};
use crate::ramp::{Bound, FeedOverride, LimitsError, Ramp, RampState};

/// The controller of one machine; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller {
    ramp: Ramp,
    filter: PositionFilter,
}

/// What the controller remembers from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    ramp: RampState,
    progress: Progress,
    feed_sent: Option<MmPerMin>,
}

/// What is measured at a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// Where the tool's centre is; `None` if there is no new sample since the last tick.
    pub position: Option<Pose>,
    /// Spindle speed.
    pub spindle: RevPerMin,
    /// Time since the last tick.
    pub dt: Span,
}

/// What a tick decides.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Output {
    /// The override to put out.
    pub feed_override: FeedOverride,
    /// The feed per tooth at the centre wanted, along the path: what the law demands, lowered in time for what comes.
    pub ipt_center: Option<MmPerTooth>,
    /// Wanted feed over the feed as sent, before any bound.
    pub wanted_ratio: f32,
    /// Why this override.
    pub reason: Reason,
}

/// Why the override is what it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reason {
    /// The law's wish, rounded to the thin side.
    Law,
    /// The law's wish, held back by a bound.
    Bounded(Bound),
    /// No law governs this segment, or it has no wish here: 100 %, or less for what comes.
    NoWish(NoWish),
    /// Rapid, inverse time, or no programmed feed: the override has nothing to act on, 100 %.
    Inhibited,
    /// The spindle's speed is not a positive number: 100 %.
    NoSpindle,
}

/// What is wanted at a tick.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    ratio: f32,
    ipt_center: Option<MmPerTooth>,
    reason: Reason,
    machine: MachineRatio,
}

impl State {
    /// The ratio of wanted to sent feed in effect, before rounding.
    pub fn ratio(&self) -> f32 {
        self.ramp.ratio()
    }

    /// How far the segment in work is; of no meaning on rapids.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// Takes up the feed of the next segment; that feed over the one before.
    fn take_feed(&mut self, sent: Option<&SentFeed>) -> f32 {
        let feed_sent = sent.map(|sent| sent.feed);
        let change_ratio = match (self.feed_sent, feed_sent) {
            (Some(before), Some(now)) => now.0 / before.0,
            _ => 1.0,
        };
        self.feed_sent = feed_sent;
        change_ratio
    }

    /// Goes on from `ratio`: what was put out while something else had the override.
    pub fn force_ratio(&mut self, ratio: f32) {
        self.ramp.force(ratio);
    }
}

impl Controller {
    /// A controller for a job.
    ///
    /// # Errors
    /// Bounds of the override that make no sense.
    pub fn new(job: &Job) -> Result<Self, LimitsError> {
        Controller::within(&job.limits)
    }

    /// A controller for every job with these bounds.
    ///
    /// # Errors
    /// As of [`Controller::new`].
    pub fn within(limits: &OverrideLimits) -> Result<Self, LimitsError> {
        let ramp = Ramp::new(limits)?;
        Ok(Controller { ramp, filter: PositionFilter::Exact })
    }

    /// The same controller for positions that are noisy, late or now and then missing.
    #[must_use]
    pub fn with_filter(self, filter: PositionFilter) -> Self {
        Controller { filter, ..self }
    }

    /// The first tick on a segment that becomes active.
    pub fn begin(&self, state: &mut State, segment: &ActiveSegment, input: &Input) -> Output {
        self.step(state, segment, input, true)
    }

    /// Any other tick on the active segment.
    pub fn tick(&self, state: &mut State, segment: &ActiveSegment, input: &Input) -> Output {
        self.step(state, segment, input, false)
    }

    /// A tick without a decision: only the progress along the segment, which `begins` at the first one.
    #[inline(always)]
    pub fn follow(&self, state: &mut State, segment: &ActiveSegment, input: &Input, begins: bool) {
        if begins {
            state.take_feed(segment.sent());
        }
        self.move_on(&mut state.progress, segment, input, begins);
    }

    /// A tick, which is the first one on the segment or not.
    #[inline(always)]
    pub(crate) fn step(&self, state: &mut State, segment: &ActiveSegment, input: &Input, begins: bool) -> Output {
        self.move_on(&mut state.progress, segment, input, begins);
        let wanted = Wanted::at(state.progress.travelled_mm(), segment, input.spindle);
        let ratio = fmath::min(wanted.ratio, wanted.machine.feed_ratio);
        if begins {
            let feed_change_ratio = state.take_feed(segment.sent());
            self.ramp.enter_block(&mut state.ramp, ratio, feed_change_ratio);
        }
        let (feed_override, bound) = self.ramp.step(&mut state.ramp, ratio, input.dt);
        let reason = if !matches!(bound, Bound::Free) {
            Reason::Bounded(bound)
        } else if ratio < wanted.ratio {
            Reason::Bounded(Bound::Machine(wanted.machine.by))
        } else {
            wanted.reason
        };
        Output { feed_override, ipt_center: wanted.ipt_center, wanted_ratio: wanted.ratio, reason }
    }

    #[inline(always)]
    fn move_on(&self, progress: &mut Progress, segment: &ActiveSegment, input: &Input, begins: bool) {
        let Some(track) = segment.track() else {
            if begins {
                *progress = Progress::default();
            }
            return;
        };
        if begins {
            *progress = track.begin(progress.speed_mm_per_s());
        }
        track.advance(&self.filter, progress, input.position.as_ref(), input.dt);
    }
}

impl Wanted {
    /// What is wanted at a path from the segment's start.
    #[inline(always)]
    fn at(travelled_mm: f32, segment: &ActiveSegment, spindle: RevPerMin) -> Self {
        let (planned_ratio, answer) = segment.envelope.at(travelled_mm);
        let ratio = planned_ratio * segment.envelope.spindle_share(spindle);
        let as_programmed = |ratio, reason| Wanted { ratio, ipt_center: None, reason, machine: MachineRatio::FREE };
        let Some(sent) = segment.sent() else { return as_programmed(ratio, Reason::Inhibited) };
        match answer {
            Err(NoWish::NoLaw) => as_programmed(ratio, Reason::NoWish(NoWish::NoLaw)),
            // A spindle at rest makes no chip.
            _ if !fmath::is_positive(spindle.0) => as_programmed(1.0, Reason::NoSpindle),
            // No feed is too high for the chip: the bounds decide.
            Err(NoWish::ChipUnreachable) => {
                let reason = Reason::NoWish(NoWish::ChipUnreachable);
                Wanted { machine: sent.machine, ..as_programmed(ratio, reason) }
            }
            Err(refusal) => as_programmed(ratio, Reason::NoWish(refusal)),
            Ok(()) => Wanted {
                ratio,
                ipt_center: Some(MmPerTooth(sent.ipt_center.0 * planned_ratio)),
                reason: Reason::Law,
                machine: sent.machine,
            },
        }
    }
}
