//! Status of the control task, encoded for the link.

use arcfeed_link::message::codes::{AlarmCode, RefusalCode, StateCode};
use arcfeed_link::message::table::Report;

use arcfeed_firmware::supervisor::report::{Alarm, Refusal};
use arcfeed_firmware::supervisor::state::State;

use super::messages::TaskStatus;

/// Code for a missing number.
const NONE: u32 = u32::MAX;

/// Code of a supervisor state in a report.
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

/// Code of a rejected arming in a report.
pub const fn refusal_code(refusal: Refusal) -> RefusalCode {
    match refusal {
        Refusal::Faulted => RefusalCode::Faulted,
        Refusal::NotFresh | Refusal::NotResynchronised => RefusalCode::NotFresh,
        Refusal::Operator => RefusalCode::Operator,
        Refusal::Condition(_) => RefusalCode::Condition,
    }
}

/// Report of a status, with free slots `room` and the parameters `set` in force.
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
