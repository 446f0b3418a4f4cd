//! What main loop and tick tell each other.

use arcfeed_shared::nc::modal::Pose;
use arcfeed_shared::units::{Micros, Nm};
use heapless::spsc::Queue;

use crate::active::ActiveSegment;
use crate::output::telemetry::record::TelemetryRecord;
use crate::spsc::{Consumer, Producer, split};
use crate::supervisor::Supervisor;
use crate::supervisor::report::{Alarm, Refusal};
use crate::supervisor::signals::BoardFault;
use crate::supervisor::state::State;

use super::papers::Papers;

/// How near its beginning every axis must stand for the first segment of a run: what a tick or two at a cutting feed may leave.
const BEGIN_TOLERANCE_NM: u64 = 100_000;
/// Words on their way.
const WORDS: usize = 17;
/// What the tick told, and nobody has heard yet.
const TOLD: usize = 9;

/// The queues between main loop and tick, with room for `AHEAD` - 1 segments, and the desk's papers.
#[derive(Debug)]
pub struct Queues<const AHEAD: usize> {
    orders: Queue<Order, AHEAD>,
    words: Queue<Word, WORDS>,
    told: Queue<Told, TOLD>,
    papers: Papers,
}

/// The desk's ends of the queues.
pub struct DeskQueues<'q> {
    /// What the tick takes in its turn.
    pub orders: Producer<'q, Order>,
    /// What it takes at once.
    pub words: Producer<'q, Word>,
    /// What it tells.
    pub told: Consumer<'q, Told>,
    /// Memory of its own.
    pub papers: &'q mut Papers,
}

/// The tick's ends of the queues.
pub struct TickerQueues<'q> {
    /// What the desk wants in its turn.
    pub orders: Consumer<'q, Order>,
    /// What it wants at once.
    pub words: Consumer<'q, Word>,
    /// What it is told.
    pub told: Producer<'q, Told>,
}

/// What the tick takes up in its turn.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to box into; nearly all are segments")]
pub enum Order {
    /// Parameters and settings in force from here on.
    Parameters(Supervisor),
    /// The next move.
    Segment(Ahead),
}

/// A move ahead of the control.
#[derive(Clone, Debug, PartialEq)]
pub struct Ahead {
    /// Which run of segments it belongs to; see [`Word::Run`].
    pub run: u32,
    /// As the sender counts.
    pub count: u32,
    /// Where the axes must stand for it to begin; `None` where nothing has to be waited for.
    pub begins_at: Option<[Nm; 3]>,
    /// The move.
    pub segment: ActiveSegment,
}

/// What the tick must know at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Word {
    /// The host was heard at this time.
    Heard(Micros),
    /// The host does not speak to this board as it should: lost, as after a long silence.
    Lost,
    /// The host is another one, or began anew: lost, and its last value has no meaning any more.
    Gone,
    /// Segments of runs before this one are forgotten.
    Run(u32),
    /// A person asks to arm, having seen how things stood at this epoch.
    Arm(u16),
    /// Somebody asks to disarm.
    Disarm,
    /// The board is not to be trusted.
    Fault(BoardFault),
}

/// What the tick tells: how things stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told {
    /// What was decided, and when; its block is the sender's count.
    pub record: TelemetryRecord,
    /// Who has the override.
    pub state: State,
    /// Whether somebody should look.
    pub alarm: Alarm,
    /// How often the override was taken away, the start among it; wraps.
    pub epoch: u16,
    /// Segments done; wraps.
    pub executed: u32,
    /// Whether the record's block is in work.
    pub is_in_work: bool,
    /// The last arming that was refused since the word before.
    pub refusal: Option<Refusal>,
}

impl<const AHEAD: usize> Default for Queues<AHEAD> {
    fn default() -> Self {
        Queues::new()
    }
}

impl<const AHEAD: usize> Queues<AHEAD> {
    /// Empty.
    pub const fn new() -> Self {
        Queues { orders: Queue::new(), words: Queue::new(), told: Queue::new(), papers: Papers::new() }
    }

    /// Both sides.
    pub fn split(&mut self) -> (DeskQueues<'_>, TickerQueues<'_>) {
        let ((orders, taken_orders), (words, taken_words)) = (split(&mut self.orders), split(&mut self.words));
        let (told, heard) = split(&mut self.told);
        let papers = &mut self.papers;
        papers.clear();
        let at_tick = TickerQueues { orders: taken_orders, words: taken_words, told };
        (DeskQueues { orders, words, told: heard, papers }, at_tick)
    }
}

impl Ahead {
    /// Whether the axes stand where it begins, if that has to be waited for.
    pub fn can_begin(&self, position: Option<&Pose>) -> bool {
        self.begins_at.is_none_or(|begin| {
            position.is_some_and(|position| {
                let axes = position.linear.iter().zip(&begin);
                axes.map(|(at, begin)| at.0.abs_diff(begin.0)).all(|distance| distance <= BEGIN_TOLERANCE_NM)
            })
        })
    }

    /// Whether it belongs to a run before `run`.
    pub fn is_before(&self, run: u32) -> bool {
        self.run != run && !self.is_behind(run)
    }

    /// Whether it belongs to a run after `run`.
    pub fn is_behind(&self, run: u32) -> bool {
        // Runs wrap: of two, the nearer way round counts.
        self.run.wrapping_sub(run).cast_signed() > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_shared::job::{FeedPolicy, Job, LawKind, ToolSetup, Tools};
    use arcfeed_shared::nc::modal::Feed;
    use arcfeed_shared::segment::{Path, Segment};
    use arcfeed_shared::tool::{EndMill, Tool};
    use arcfeed_shared::units::{LengthUnit, MmPerTooth, RevPerMin};

    fn ahead(run: u32) -> Ahead {
        let job = Job {
            unit: LengthUnit::Mm,
            tools: Tools::one(ToolSetup::new(
                Tool::EndMill(EndMill { radius: Nm(5), teeth: 1 }),
                RevPerMin(1.0),
                LawKind::Programmed,
                MmPerTooth(1.0),
            )),
            ceiling: Default::default(),
            policy: FeedPolicy::SafeBase,
            limits: Default::default(),
            machine: Default::default(),
            rules: Default::default(),
            knots: Default::default(),
        };
        let (start, end) = (Pose::default(), Pose::default());
        let segment = Segment { sequence: None, start, end, feed: Feed::Missing, path: Path::Rapid };
        let begins_at = Some([Nm(0), Nm(1_000_000), Nm(-5)]);
        Ahead { run, count: 1, begins_at, segment: ActiveSegment::new(&segment, None, &job) }
    }

    #[test]
    fn runs_are_told_apart_around_the_wrap() {
        for (run, now, is_before, is_behind) in [
            (5, 5, false, false),
            (4, 5, true, false),
            (6, 5, false, true),
            (u32::MAX, 0, true, false),
            (0, u32::MAX, false, true),
        ] {
            assert_eq!((ahead(run).is_before(now), ahead(run).is_behind(now)), (is_before, is_behind), "{run} {now}");
        }
    }

    #[test]
    fn a_first_segment_waits_for_all_axes_to_stand_at_its_beginning() {
        let at = |linear: [i64; 3]| Pose { linear: linear.map(Nm), ..Pose::default() };
        for (position, can) in [
            (Some(at([0, 1_000_000, -5])), true),
            (Some(at([100_000, 900_000, 99_995])), true),
            (Some(at([100_001, 1_000_000, -5])), false),
            (Some(at([0, 1_000_000, -100_006])), false),
            (None, false),
        ] {
            assert_eq!(ahead(0).can_begin(position.as_ref()), can, "{position:?}");
        }
        assert!(Ahead { begins_at: None, ..ahead(0) }.can_begin(None));
    }
}
