//! Texts for people about a feed board and its link.

use arcfeed_firmware::output::telemetry::reason::Cause;
use arcfeed_link::link::{LinkState, Loss, Refusal};
use arcfeed_link::message::SCHEMA_HASH;
use arcfeed_link::message::codes::{RefusalCode, ResetCode, SettingCode, StateCode};

/// Name of a state of the supervisor, for a person.
pub const fn state(state: StateCode) -> &'static str {
    match state {
        StateCode::Idle => "idle",
        StateCode::Armed => "armed",
        StateCode::Running => "running",
        StateCode::Holding => "holding",
        StateCode::Fallback => "fallback",
        StateCode::Faulted => "faulted",
        StateCode::Inhibited => "inhibited",
        StateCode::Disarmed => "disarmed",
    }
}

/// Whether the laws control the override in this state of the supervisor, or will do so as soon as a move begins.
pub const fn is_engaged(state: StateCode) -> bool {
    matches!(state, StateCode::Armed | StateCode::Running | StateCode::Holding | StateCode::Inhibited)
}

/// Text for the cause of a board fault, by the code in its report.
pub fn fault(cause: u8) -> &'static str {
    match Cause::of_code(cause) {
        Some(Cause::Watchdog) => "its watchdog found it stopped",
        Some(Cause::Parameters) => "its parameters are torn or make no sense",
        Some(Cause::Hardware) => "its hardware",
        _ => "a cause that this release does not know",
    }
}

/// Text for the reason why the board last started.
pub const fn reset(reset: ResetCode) -> &'static str {
    match reset {
        ResetCode::Power => "power-on or its reset pin",
        ResetCode::Watchdog => "its watchdog",
        ResetCode::Hardware => "a fault of supply or clock",
        ResetCode::Software => "software request",
    }
}

/// Text for the reason why the board refused a message or to arm.
pub const fn refusal(why: RefusalCode) -> &'static str {
    match why {
        RefusalCode::Message => "unknown message",
        RefusalCode::Busy => "the laws have the override: disarm it first",
        RefusalCode::NoSet => "a parameter that belongs to no set",
        RefusalCode::Checksum => "the parameters arrived corrupt",
        RefusalCode::Incomplete => "parameters, or the engaged arcs of a segment, are incomplete",
        RefusalCode::Value => "a value is out of range",
        RefusalCode::NoParameters => "it has no parameters of this session",
        RefusalCode::Full => "it has no room for another segment, or for more engaged arcs of one",
        RefusalCode::Order => "the segment or its engaged arcs are out of order",
        RefusalCode::Outdated => "the request is stale: the laws have lost the override meanwhile",
        RefusalCode::Faulted => "there is a fault, or it was not reset at the board",
        RefusalCode::NotFresh => "position or link is not there, or not for long enough",
        RefusalCode::Operator => "the operator's dial is too low",
        RefusalCode::Condition => "a condition of the control (G41, G42, #3004) forbids it",
    }
}

/// Text for the state of the link to a board.
pub fn link(state: LinkState) -> String {
    match state {
        LinkState::Up => "up".into(),
        LinkState::Greeting => "no answer: check the port, the cable, 115 200 baud, 8N1, no flow control, and that \
                                the board is on"
            .into(),
        LinkState::Refused(Refusal::Version(theirs)) => {
            format!("the board speaks version {theirs} of the protocol; flash firmware of this release")
        }
        LinkState::Refused(Refusal::Schema(theirs)) => format!(
            "the board's message set {theirs:08x} differs from ours, {SCHEMA_HASH:08x}: flash firmware of this release"
        ),
        LinkState::Refused(Refusal::Role(_)) => "our own echo, or another host: check the cable".into(),
        LinkState::Refused(Refusal::Heartbeat(theirs)) => {
            format!("the board's heartbeat of {} ms is slower than we wait", theirs.0 / 1_000)
        }
        LinkState::Lost(loss) => link_loss(loss).into(),
    }
}

/// Text for the reason why a link ended.
pub const fn link_loss(loss: Loss) -> &'static str {
    match loss {
        Loss::Silence => "the board is silent",
        Loss::PeerRestarted => "the board has restarted",
        Loss::Unacknowledged => "the board sends but acknowledges nothing",
        Loss::Garbled => "most frames of the board arrive corrupt: check cable and baud rate",
        Loss::PeerClosed => "the board has closed the link",
        Loss::Closed => "closed",
    }
}

/// Name of a board setting as an option of the command line, and its unit as text.
pub const fn setting(setting: SettingCode) -> (&'static str, &'static str) {
    match setting {
        SettingCode::PositionStale => ("position-stale", "us"),
        SettingCode::PositionLost => ("position-lost", "us"),
        SettingCode::PositionKeep => ("position-keep", "us"),
        SettingCode::LinkStale => ("link-stale", "us"),
        SettingCode::LinkLost => ("link-lost", "us"),
        SettingCode::LinkKeep => ("link-keep", "us"),
        SettingCode::LostFrames => ("lost-frames", ""),
        SettingCode::Resync => ("resync", "us"),
        SettingCode::LongestTick => ("longest-tick", "us"),
        SettingCode::DialBelow => ("dial-below", "%"),
        SettingCode::DialDrop => ("dial-drop", "%"),
        SettingCode::ReportEvery => ("report-every", "us"),
    }
}
