//! Messages between main loop and control task: commands and notices to the task, status to the main loop.

use arcfeed_nc::modal::Pose;
use arcfeed_units::{Micros, Nm};
use heapless::spsc::Queue;

use crate::spsc::{Consumer, Producer, split};
use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::output::telemetry::record::TelemetryRecord;
use arcfeed_firmware::supervisor::Supervisor;
use arcfeed_firmware::supervisor::report::{Alarm, Refusal};
use arcfeed_firmware::supervisor::signals::BoardFault;
use arcfeed_firmware::supervisor::state::State;

use super::buffers::Buffers;

/// Tolerance of every axis at the start of a run's first segment: the distance of one or two ticks at a cutting feed.
const BEGIN_TOLERANCE_NM: u64 = 100_000;
/// Length of the queue of notices.
const NOTICES: usize = 17;
/// Length of the queue of status messages.
const STATUSES: usize = 9;

/// The queues between main loop and control task, with room for `AHEAD` - 1 segments, and the buffers of the main loop.
#[derive(Debug)]
pub struct Queues<const AHEAD: usize> {
    commands: Queue<Command, AHEAD>,
    notices: Queue<Notice, NOTICES>,
    status: Queue<TaskStatus, STATUSES>,
    buffers: Buffers,
}

/// The main loop's ends of the queues.
pub struct HostQueues<'q> {
    /// Commands, executed in order.
    pub commands: Producer<'q, Command>,
    /// Notices, which take effect at once.
    pub notices: Producer<'q, Notice>,
    /// Status of the control task.
    pub status: Consumer<'q, TaskStatus>,
    /// Buffers of the main loop.
    pub buffers: &'q mut Buffers,
}

/// The control task's ends of the queues.
pub struct TaskQueues<'q> {
    /// Commands, executed in order.
    pub commands: Consumer<'q, Command>,
    /// Notices, which take effect at once.
    pub notices: Consumer<'q, Notice>,
    /// Status, for the main loop.
    pub status: Producer<'q, TaskStatus>,
}

/// Command of the main loop to the control task, executed in order.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to box into; nearly all are segments")]
pub enum Command {
    /// Parameters and settings in force from here on.
    Parameters(Supervisor),
    /// The next move.
    Segment(PlannedMove),
}

/// A move that the control has yet to execute.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedMove {
    /// Run of segments to which it belongs; see [`Notice::Run`].
    pub run: u32,
    /// The sender's count.
    pub count: u32,
    /// Start position, if the segment has to wait until the axes are there.
    pub begins_at: Option<[Nm; 3]>,
    /// The move.
    pub segment: ActiveSegment,
}

/// A notice, which takes effect at the next tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notice {
    /// The host gave a sign of life at this time.
    HostAlive(Micros),
    /// The host's frames are corrupt: it counts as lost, as after a long silence.
    HostLost,
    /// The host has restarted or was replaced: it is lost, and its last value is invalid.
    HostChanged,
    /// A new run: segments of earlier runs are discarded.
    Run(u32),
    /// A person who has seen the state at this epoch asks to arm.
    Arm(u16),
    /// A request to disarm.
    Disarm,
    /// A fault of the board.
    Fault(BoardFault),
}

/// Status of the control task after a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaskStatus {
    /// Decision of the tick; its block is the sender's count.
    pub record: TelemetryRecord,
    /// State of the supervisor.
    pub state: State,
    /// Alarm for the operator.
    pub alarm: Alarm,
    /// Number of fallbacks, including the start; wraps around.
    pub epoch: u16,
    /// Number of executed segments; wraps around.
    pub executed: u32,
    /// Whether the record's block is in execution.
    pub is_in_work: bool,
    /// Reason of the last rejected arming since the previous status.
    pub refusal: Option<Refusal>,
}

impl<const AHEAD: usize> Default for Queues<AHEAD> {
    fn default() -> Self {
        Queues::new()
    }
}

impl<const AHEAD: usize> Queues<AHEAD> {
    /// Empty queues.
    pub const fn new() -> Self {
        Queues { commands: Queue::new(), notices: Queue::new(), status: Queue::new(), buffers: Buffers::new() }
    }

    /// Divides the queues into the ends of the main loop and of the control task.
    pub fn split(&mut self) -> (HostQueues<'_>, TaskQueues<'_>) {
        let ((commands, taken_commands), (notices, taken_notices)) =
            (split(&mut self.commands), split(&mut self.notices));
        let (status, heard) = split(&mut self.status);
        let buffers = &mut self.buffers;
        buffers.clear();
        let at_tick = TaskQueues { commands: taken_commands, notices: taken_notices, status };
        (HostQueues { commands, notices, status: heard, buffers }, at_tick)
    }
}

impl PlannedMove {
    /// Whether the axes are at the move's start position, if the move has to wait for them.
    pub fn can_begin(&self, position: Option<&Pose>) -> bool {
        self.begins_at.is_none_or(|begin| {
            position.is_some_and(|position| {
                let axes = position.linear.iter().zip(&begin);
                axes.map(|(at, begin)| at.0.abs_diff(begin.0)).all(|distance| distance <= BEGIN_TOLERANCE_NM)
            })
        })
    }

    /// Whether the move belongs to a run before `run`.
    pub fn is_before(&self, run: u32) -> bool {
        self.run != run && !self.is_behind(run)
    }

    /// Whether the move belongs to a run after `run`.
    pub fn is_behind(&self, run: u32) -> bool {
        // Run numbers wrap around: the shorter distance decides.
        self.run.wrapping_sub(run).cast_signed() > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_model::job::{FeedPolicy, Job, LawKind, ToolSetup, Tools};
    use arcfeed_model::tool::{EndMill, Tool};
    use arcfeed_nc::modal::Feed;
    use arcfeed_nc::segment::{Path, Segment};
    use arcfeed_units::{LengthUnit, MmPerTooth, RevPerMin};

    fn planned(run: u32) -> PlannedMove {
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
        PlannedMove { run, count: 1, begins_at, segment: ActiveSegment::new(&segment, None, &job) }
    }

    #[test]
    fn runs_are_distinguished_around_the_wrap() {
        for (run, now, is_before, is_behind) in [
            (5, 5, false, false),
            (4, 5, true, false),
            (6, 5, false, true),
            (u32::MAX, 0, true, false),
            (0, u32::MAX, false, true),
        ] {
            assert_eq!(
                (planned(run).is_before(now), planned(run).is_behind(now)),
                (is_before, is_behind),
                "{run} {now}"
            );
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
            assert_eq!(planned(0).can_begin(position.as_ref()), can, "{position:?}");
        }
        assert!(PlannedMove { begins_at: None, ..planned(0) }.can_begin(None));
    }
}
