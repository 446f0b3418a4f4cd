//! Status of the control task, encoded for the link.

use arcfeed_link::message::codes::{AlarmCode, RefusalCode, StateCode};
use arcfeed_link::message::table::Report;

use arcfeed_firmware::supervisor::report::{Alarm, Refusal};
use arcfeed_firmware::supervisor::state::State;

use super::messages::TaskStatus;

/// Code for a missing number.
const NONE: u32 = u32::MAX;

/// The code by which a report to the host states a state of the supervisor.
pub const fn state_code(state: &State) -> StateCode {
    match state {
        State::Idle => StateCode::Idle,
        State::Armed => StateCode::Armed,
        State::Running => StateCode::Running,
        State::Holding { .. } => StateCode::Holding,
        State::Fallback { .. } => StateCode::Fallback,
        State::Faulted { .. } => StateCode::Faulted,
        State::Inhibited { .. } => StateCode::Inhibited,
        State::Disarmed { .. } => StateCode::Disarmed,
    }
}

/// The code by which a message to the host states why arming was rejected.
pub const fn refusal_code(refusal: Refusal) -> RefusalCode {
    match refusal {
        Refusal::Faulted => RefusalCode::Faulted,
        Refusal::NotFresh | Refusal::NotResynchronised => RefusalCode::NotFresh,
        Refusal::Operator => RefusalCode::Operator,
        Refusal::Condition(_) => RefusalCode::Condition,
    }
}

/// Report to the host from a status; `room` is the number of segments that can be added, `set` the number of the job
/// in force.
pub fn report(status: &TaskStatus, room: usize, set: u32) -> Report {
    let record = &status.record;
    Report {
        at: record.at.0,
        state: state_code(&status.state),
        cause: record.cause as u8,
        alarm: match status.alarm {
            Alarm::None => AlarmCode::None,
            Alarm::Passing => AlarmCode::Passing,
            Alarm::Latched => AlarmCode::Latched,
        },
        override_percent: record.feed_override.percent,
        epoch: status.epoch,
        executed: status.executed,
        in_work: status.is_in_work.then_some(record.block),
        room: u16::try_from(room).unwrap_or(u16::MAX),
        set,
        ipt_center: record.ipt_center_nm.unwrap_or(NONE),
        feed: record.feed_um_per_min.unwrap_or(NONE),
        chip_excess_percent: record.chip_excess_percent,
    }
}
