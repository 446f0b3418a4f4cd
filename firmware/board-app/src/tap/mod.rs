//! Tap: feed adaptation between any sender and the control. It reads the characters of the DNC line and passes them on
//! unchanged.
//!
//! ```text
//! sender --> from_sender --> control        characters, each at once
//!                |
//!             intake: blocks that wait, as in the control's buffer
//!                |
//!       next: blocks -> moves -> segments with their law, a few ahead of the machine
//!                |                                        ^
//!                v                                        | follow: segment in work, position
//!        the queue of the tick ---------------------------+
//! ```
//! The program in the control is the reference: its F is the sent feed, and the override is the ratio of the target
//! feed to it. If the tap cannot know the behaviour of the control, it stops the adaptation until the next program
//! begins, or until the axes are at a known position: see docs/tap.md. No heap, no clock, no I/O.

pub mod settings;

pub mod status;

mod intake;

mod blocks;

mod watch;

use core::mem::MaybeUninit;

use arcfeed_model::governed::Governing;
use arcfeed_model::job::{FeedPolicy, Job};
use arcfeed_nc::modal::Pose;
use arcfeed_nc::segment::Segment;
use arcfeed_nc::tape_code::{DC1, DC3, without_parity};
use arcfeed_units::Micros;
use heapless::{Deque, Vec};

use arcfeed_firmware::active::{ActiveSegment, Conditions};
use blocks::{BlockMotion, Blocks};
use intake::Intake;
use settings::{LINE_MAX, TapSettings, TapSettingsError};
use status::{TapCounters, TapLossReason, TapState};
use watch::{Gate, PathLocation, PathProgress};

/// Largest number of moves that the tap has passed to the control task and that have not ended.
pub const AHEAD_MAX: usize = 16;
/// Number of consecutive equal positions at which the axes count as at rest.
const AT_REST: u8 = 10;

/// Reads an NC program off the line between sender and control, and makes moves for the control task of it. `N` is the
/// number of characters that it can hold between sender and machine: those of the control's buffer and a few blocks.
#[derive(Debug)]
pub struct Tap<const N: usize> {
    settings: TapSettings,
    intake: Intake<N>,
    blocks: Blocks,
    line: Vec<u8, LINE_MAX>,
    /// Emitted segments that are not done, with their counts.
    emitted: Deque<(u32, Segment), AHEAD_MAX>,
    /// Condition for the next segment.
    gate: Option<Gate>,
    /// Whether the emitted segments will not be executed.
    has_to_clear: bool,
    state: TapState,
    counters: TapCounters,
    tick: TaskProgress,
    axes: Axes,
    heard: Micros,
}

/// Progress of the control task. Keeps its state between calls.
#[derive(Clone, Copy, Debug, Default)]
struct TaskProgress {
    /// Number of segments that it has done.
    executed: u32,
    /// Count of a segment, and the number of segments done when it became the next.
    known: (u32, u32),
}

/// Evaluation of the positions. Keeps its state between calls.
#[derive(Clone, Copy, Debug, Default)]
struct Axes {
    /// Position at rest, or last position.
    place: Option<Pose>,
    /// Number of consecutive positions there.
    still: u8,
    /// Count of the current segment, and the progress along it.
    way: Option<(u32, PathProgress)>,
    /// Number of consecutive positions off its path.
    off_path: u8,
}

/// A move that the tap has read, prepared for the control task.
#[derive(Clone, Debug, PartialEq)]
pub struct TapSegment {
    /// Number of the move, one more than that of the one before.
    pub count: u32,
    /// The move, prepared under its law.
    pub segment: ActiveSegment,
}

impl<const N: usize> Tap<N> {
    /// Tap before the first program (state `Listening`).
    ///
    /// # Errors
    /// The settings are invalid.
    pub fn new(settings: TapSettings) -> Result<Self, TapSettingsError> {
        settings.checked().map(Tap::of)
    }

    /// Makes a tap in this memory, because it is too large to be returned by value.
    ///
    /// # Errors
    /// The settings are invalid.
    pub fn place(place: &mut MaybeUninit<Self>, settings: TapSettings) -> Result<&mut Self, TapSettingsError> {
        let settings = settings.checked()?;
        Ok(place.write(Tap::of(settings)))
    }

    #[inline(always)]
    fn of(settings: TapSettings) -> Self {
        Tap {
            intake: Intake::new(settings.code),
            blocks: Blocks::new(settings.nc, settings.resets_codes),
            settings,
            line: Vec::new(),
            emitted: Deque::new(),
            gate: None,
            has_to_clear: false,
            state: TapState::Listening,
            counters: TapCounters::default(),
            tick: TaskProgress::default(),
            axes: Axes::default(),
            heard: Micros(0),
        }
    }

    /// Processes a character that has arrived from the sender; returns it to be passed on to the control.
    #[inline]
    pub fn from_sender(&mut self, now: Micros, byte: u8) -> u8 {
        if self.is_long_since(now) {
            self.intake.separate();
        }
        self.heard = now;
        self.counters.from_sender = self.counters.from_sender.wrapping_add(1);
        if self.intake.push(byte) {
            self.begin();
        }
        byte
    }

    /// Processes a character that has arrived from the control; returns it to be passed on to the sender.
    #[inline]
    pub fn from_control(&mut self, now: Micros, byte: u8) -> u8 {
        self.counters.from_control = self.counters.from_control.wrapping_add(1);
        match without_parity(byte) {
            DC1 => {
                self.intake.separate();
                if self.is_long_since(now) {
                    self.intake.expect_label();
                }
            }
            DC3 => self.counters.stops = self.counters.stops.wrapping_add(1),
            _ => {}
        }
        self.heard = now;
        byte
    }

    /// Records that a character of the sender was lost or could not be read.
    pub fn on_line_error(&mut self) {
        self.intake.mark_damaged();
    }

    /// Processes a new position in workpiece coordinates. `in_work` is the number of the segment in execution (`None`
    /// if there is none), `executed` the number of segments that have ended.
    pub fn follow(&mut self, in_work: Option<u32>, executed: u32, position: &Pose) {
        self.axes.update(position);
        let in_work = self.tick.next_or_in_work(in_work, executed);
        let is_done = |(count, _): &(u32, Segment)| (count.wrapping_sub(in_work) as i32) < 0;
        while self.emitted.front().is_some_and(is_done) {
            self.emitted.pop_front();
        }
        let Some((count, segment)) = self.emitted.front() else {
            if self.gate.as_mut().is_some_and(|gate| gate.passes(position)) {
                (self.gate, self.state) = (None, TapState::InStep);
            }
            return;
        };
        let far_mm = self.settings.off_path.to_mm() as f32;
        let off_mm = self.axes.off_mm(*count, watch::place(segment, position));
        self.axes.off_path = if off_mm > far_mm { self.axes.off_path.saturating_add(1) } else { 0 };
        if self.axes.off_path >= self.settings.off_path_count {
            self.clear();
            self.set_lost(TapLossReason::OffPath);
        }
    }

    /// Whether the control task must drop all moves of the tap now, also the one in execution, because the axes are
    /// not on them; then resets this flag. The request must not wait in the queue of these moves.
    pub fn must_clear(&mut self) -> bool {
        core::mem::take(&mut self.has_to_clear)
    }

    /// The next move for the control task; `None` if none is complete. To be called after [`Tap::must_clear`], while
    /// the queue has a free place.
    pub fn next(&mut self, job: &Job) -> Option<TapSegment> {
        while self.gate.is_none() && !self.emitted.is_full() {
            let fits = self.intake.next_block(&mut self.line)?;
            if self.state != TapState::InStep {
                self.counters.passed_over = self.counters.passed_over.wrapping_add(1);
                continue;
            }
            self.counters.blocks = self.counters.blocks.wrapping_add(1);
            match self.read(fits) {
                Ok(Some((segment, may_govern))) => return Some(self.emit(segment, may_govern, job)),
                Ok(None) => {}
                Err(why) => self.set_lost(why),
            }
        }
        None
    }

    /// Whether the tap follows the program at present.
    pub fn state(&self) -> TapState {
        self.state
    }

    /// Counters of characters, blocks and losses.
    pub fn counters(&self) -> &TapCounters {
        &self.counters
    }

    fn is_long_since(&self, now: Micros) -> bool {
        now.since(self.heard).0 >= u64::from(self.settings.silence.0)
    }

    /// Reads the block in the line: its move, and whether a law may govern it.
    fn read(&mut self, fits: bool) -> Result<Option<(Segment, bool)>, TapLossReason> {
        match self.line.as_slice() {
            _ if !fits => return Err(TapLossReason::LongBlock),
            [intake::DAMAGED] => return Err(TapLossReason::Damaged),
            [intake::MISSING] => return Err(TapLossReason::TooFarAhead),
            _ => {}
        }
        let (motion, ends) = self.blocks.read(&self.line)?;
        if let BlockMotion::Passes { via, to } = motion {
            (self.gate, self.state) = (Some(Gate::new(via, to)), TapState::Passing);
        }
        if ends {
            (self.gate, self.state) = (None, TapState::Listening);
        }
        Ok(match motion {
            BlockMotion::Along(segment, may_govern) => Some((segment, may_govern)),
            BlockMotion::Nothing | BlockMotion::Passes { .. } => None,
        })
    }

    fn emit(&mut self, segment: Segment, may_govern: bool, job: &Job) -> TapSegment {
        let count = self.counters.segments;
        let has_override = !matches!(job.policy, FeedPolicy::RewriteOnly(_));
        let matched = job.match_move(&segment, &self.blocks.machining());
        let governing = matched.governing().filter(|_| may_govern && has_override);
        let rule = governing.map(|governing| governing.rule);
        let own = Conditions::of(&segment, rule, job);
        let conditions = governing.map_or(own, |Governing { spindle, .. }| Conditions { spindle, ..own });
        self.counters.segments = count.wrapping_add(1);
        self.counters.governed = self.counters.governed.wrapping_add(u32::from(rule.is_some()));
        if self.emitted.is_empty() {
            self.tick.expect(count);
        }
        let _room = self.emitted.push_back((count, segment));
        TapSegment { count, segment: ActiveSegment::with_conditions(&segment, &conditions, job) }
    }

    /// Starts a program; the rest of the previous one will not be executed.
    fn begin(&mut self) {
        let was_on = !matches!(self.state, TapState::Listening | TapState::Lost(_)) || !self.emitted.is_empty();
        self.counters.programs = self.counters.programs.wrapping_add(1);
        self.counters.restarts = self.counters.restarts.wrapping_add(u32::from(was_on));
        self.clear();
        self.blocks.begin(self.axes.resting_place());
        self.state = TapState::InStep;
    }

    fn clear(&mut self) {
        self.has_to_clear |= !self.emitted.is_empty();
        self.emitted.clear();
        (self.gate, self.axes.off_path) = (None, 0);
    }

    fn set_lost(&mut self, why: TapLossReason) {
        self.counters.losses = self.counters.losses.wrapping_add(1);
        (self.gate, self.state) = (None, TapState::Lost(why));
    }
}

impl TaskProgress {
    /// Sets the next segment; all earlier ones are done.
    fn expect(&mut self, count: u32) {
        self.known = (count, self.executed);
    }

    /// Count of the segment in execution, or of the next one.
    fn next_or_in_work(&mut self, in_work: Option<u32>, executed: u32) -> u32 {
        self.executed = executed;
        if let Some(count) = in_work {
            self.expect(count);
        }
        let (count, before) = self.known;
        count.wrapping_add(executed.wrapping_sub(before))
    }
}

impl Axes {
    fn update(&mut self, position: &Pose) {
        if self.place.is_some_and(|place| watch::is_at(position, &place)) {
            self.still = self.still.saturating_add(1);
        } else {
            (self.place, self.still) = (Some(*position), 0);
        }
    }

    /// Distance of the axes from the path of a segment, mm.
    fn off_mm(&mut self, count: u32, place: Option<PathLocation>) -> f32 {
        let Some(place) = place else { return 0.0 };
        let before = self.way.filter(|(same, _)| *same == count).map(|(_, way)| way);
        let mut way = before.unwrap_or_default();
        let off_mm = way.off_mm(&place);
        self.way = Some((count, way));
        off_mm
    }

    fn resting_place(&self) -> Option<Pose> {
        self.place.filter(|_| self.still >= AT_REST)
    }
}

#[cfg(test)]
mod tests;
