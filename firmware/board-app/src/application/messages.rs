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

/// Queues between main loop and control task, with places for `AHEAD` - 1 segments, and the main loop's buffers.
#[derive(Debug)]
pub struct Queues<const AHEAD: usize> {
    commands: Queue<Command, AHEAD>,
    notices: Queue<Notice, NOTICES>,
    status: Queue<TaskStatus, STATUSES>,
    buffers: Buffers,
}

/// Ends of the queues that the main loop uses.
pub struct HostQueues<'q> {
    /// Commands to the control task, which executes them in order.
    pub commands: Producer<'q, Command>,
    /// Notices to the control task, which take effect at its next tick.
    pub notices: Producer<'q, Notice>,
    /// Status messages of the control task.
    pub status: Consumer<'q, TaskStatus>,
    /// Large data of the main loop: jobs and engaged arcs.
    pub buffers: &'q mut Buffers,
}

/// Ends of the queues that the control task uses.
pub struct TaskQueues<'q> {
    /// Commands of the main loop, executed in order.
    pub commands: Consumer<'q, Command>,
    /// Notices of the main loop, which take effect at the next tick.
    pub notices: Consumer<'q, Notice>,
    /// Status messages to the main loop.
    pub status: Producer<'q, TaskStatus>,
}

/// Command of the main loop to the control task, executed in order.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to box into; nearly all are segments")]
pub enum Command {
    /// New parameters and settings, in force for the moves after this command.
    Parameters(Supervisor),
    /// A move that the control will execute after those before it.
    Segment(PlannedMove),
}

/// A move that the control is expected to execute.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedMove {
    /// Number of the run of segments to which the move belongs; see [`Notice::Run`].
    pub run: u32,
    /// Number of the move, as its sender counts.
    pub count: u32,
    /// Position of X, Y and Z at which the axes must be before the move counts as begun; `None` if it follows the move
    /// before it.
    pub begins_at: Option<[Nm; 3]>,
    /// The move.
    pub segment: ActiveSegment,
}

/// Notice of the main loop to the control task, which takes effect at the next tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notice {
    /// A valid frame of the host arrived at this time.
    HostAlive(Micros),
    /// The host's frames are corrupt: it counts as lost, as after a long silence.
    HostLost,
    /// The host has restarted or was replaced: it counts as lost, and the override does not keep its last value.
    HostChanged,
    /// A new run of segments with this number begins: segments of earlier runs are discarded.
    Run(u32),
    /// A person requests to arm, who has seen a report with this epoch (count of fallbacks); an older epoch is stale.
    Arm(u16),
    /// A person requests to disarm.
    Disarm,
    /// The board has this fault.
    Fault(BoardFault),
}

/// Status of the control task after a tick, for the main loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaskStatus {
    /// Decision of the tick as a telemetry record; its block is the number that the sender has given the move.
    pub record: TelemetryRecord,
    /// State of the supervisor.
    pub state: State,
    /// Alarm to be shown to the operator.
    pub alarm: Alarm,
    /// Epoch: number of changes to fallback, disarmed or faulted, plus one for the start; wraps around.
    pub epoch: u16,
    /// Number of segments that have ended since the start; wraps around.
    pub executed: u32,
    /// Whether a move is in execution, whose number is the block of the record; otherwise that number means nothing.
    pub is_in_work: bool,
    /// Reason why arming was rejected, if it was since the previous status; the last one counts.
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
    /// Whether the axes are where the move begins, or the move does not have to wait for that.
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
