//! Structs and constants of the interface. Every number of a struct may have any value; the calls check them.

/// Size of a controller without moves, bytes.
pub const ARCFEED_CONTROLLER_SIZE: usize = 16_384;
/// Size of one stored move, bytes: a controller for n moves needs `ARCFEED_CONTROLLER_SIZE` + n * `ARCFEED_MOVE_SIZE`.
pub const ARCFEED_MOVE_SIZE: usize = 512;
/// Required alignment of the memory for a controller, bytes.
pub const ARCFEED_ALIGNMENT: usize = 8;

/// Value of `rule`: no law governs the move.
pub const ARCFEED_NO_RULE: u8 = 255;
/// Value of `line`: no block is in execution.
pub const ARCFEED_NO_LINE: i32 = -1;

/// Path of a move: rapid traverse, on a path that the control chooses.
pub const ARCFEED_PATH_RAPID: u8 = 0;
/// Path of a move: a straight cutting move.
pub const ARCFEED_PATH_LINE: u8 = 1;
/// Path of a move: a clockwise arc in XY.
pub const ARCFEED_PATH_CW_XY: u8 = 2;
/// Path of a move: a counter-clockwise arc in XY.
pub const ARCFEED_PATH_CCW_XY: u8 = 3;
/// Path of a move: a clockwise arc in ZX.
pub const ARCFEED_PATH_CW_ZX: u8 = 4;
/// Path of a move: a counter-clockwise arc in ZX.
pub const ARCFEED_PATH_CCW_ZX: u8 = 5;
/// Path of a move: a clockwise arc in YZ.
pub const ARCFEED_PATH_CW_YZ: u8 = 6;
/// Path of a move: a counter-clockwise arc in YZ.
pub const ARCFEED_PATH_CCW_YZ: u8 = 7;

/// Bit of `ArcfeedInput::signals`: cutter compensation (G41 or G42) is active.
pub const ARCFEED_SIGNAL_CUTTER_COMPENSATION: u32 = 0x1;
/// Bit of `ArcfeedInput::signals`: the control ignores the override.
pub const ARCFEED_SIGNAL_OVERRIDE_OFF: u32 = 0x2;
/// Bit of `ArcfeedInput::signals`: a tapping cycle is active.
pub const ARCFEED_SIGNAL_TAPPING: u32 = 0x4;
/// Bit of `ArcfeedInput::signals`: thread cutting is active.
pub const ARCFEED_SIGNAL_THREADING: u32 = 0x8;
/// Bit of `ArcfeedInput::signals`: G63 (tapping mode) is active, which holds the feed at 100 %.
pub const ARCFEED_SIGNAL_FEED_FORCED: u32 = 0x10;
/// Bit of `ArcfeedInput::signals`: the axes are in rapid traverse.
pub const ARCFEED_SIGNAL_RAPID: u32 = 0x20;
/// Bit of `ArcfeedInput::signals`: feed hold is active.
pub const ARCFEED_SIGNAL_FEED_HOLD: u32 = 0x40;
/// Bit of `ArcfeedInput::signals`: the watchdog has expired.
pub const ARCFEED_SIGNAL_FAULT_WATCHDOG: u32 = 0x100;
/// Bit of `ArcfeedInput::signals`: stored parameters are corrupt.
pub const ARCFEED_SIGNAL_FAULT_PARAMETERS: u32 = 0x200;
/// Bit of `ArcfeedInput::signals`: a failure of supply, clock, output or dial.
pub const ARCFEED_SIGNAL_FAULT_HARDWARE: u32 = 0x400;
/// Bit of `ArcfeedInput::signals`: a person arms, so that the laws may set the override; acts once when it rises.
pub const ARCFEED_SIGNAL_ARM: u32 = 0x1_0000;
/// Bit of `ArcfeedInput::signals`: a person takes the override from the laws; acts once when it rises.
pub const ARCFEED_SIGNAL_DISARM: u32 = 0x2_0000;
/// Bit of `ArcfeedInput::signals`: a person resets a fault; acts once when it rises.
pub const ARCFEED_SIGNAL_RESET: u32 = 0x4_0000;

/// Output state idle: the laws have not been armed since the start or a reset of a fault.
pub const ARCFEED_STATE_IDLE: u8 = 0;
/// Output state armed: a law sets the override as soon as a move begins.
pub const ARCFEED_STATE_ARMED: u8 = 1;
/// Output state running: a law sets the override.
pub const ARCFEED_STATE_RUNNING: u8 = 2;
/// Output state holding: feed hold or an override of 0 % stops the axes; the override does not rise.
pub const ARCFEED_STATE_HOLDING: u8 = 3;
/// Output state fallback: position or link was lost; a person must arm again.
pub const ARCFEED_STATE_FALLBACK: u8 = 4;
/// Output state faulted: 0 % until a person resets the fault.
pub const ARCFEED_STATE_FAULTED: u8 = 5;
/// Output state inhibited: the override does not act on the present feed (rapid, tapping, threading).
pub const ARCFEED_STATE_INHIBITED: u8 = 6;
/// Output state disarmed: the operator, a request or a condition of the control has taken the override from the laws.
pub const ARCFEED_STATE_DISARMED: u8 = 7;

/// A move of the program, in workpiece coordinates.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct ArcfeedMove {
    /// X, Y, Z at the start, nm.
    pub start_nm: [i64; 3],
    /// X, Y, Z at the end, nm.
    pub end_nm: [i64; 3],
    /// A, B, C at the start, microdegrees.
    pub start_microdeg: [i64; 3],
    /// A, B, C at the end, microdegrees.
    pub end_microdeg: [i64; 3],
    /// Centre of an arc in its plane, nm: X Y, Z X or Y Z; ignored for other paths.
    pub center_nm: [i64; 2],
    /// Feed as the control receives it (F), nm/min; 0 or below if there is none.
    pub feed_nm_per_min: i64,
    /// Further upper limit of the feed, nm/min, such as the job's ceiling for the programmed feed; 0: only the job's limits.
    pub max_feed_nm_per_min: i64,
    /// Commanded spindle speed, rev/min; 0 for the job's speed of the tool.
    pub spindle_rev_per_min: f32,
    /// Shape of the path, one of `ARCFEED_PATH_...`.
    pub path: u8,
    /// Index, from 0, of the cut rule whose law governs the move, or `ARCFEED_NO_RULE`.
    pub rule: u8,
    /// Largest override at the end of the move, %, with which the next move may begin; 100 if that does not matter.
    pub end_percent: u8,
}

/// Inputs of a control tick: measured values, signals, and the line in execution.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct ArcfeedInput {
    /// X, Y, Z of the tool's centre in workpiece coordinates, nm; see `arcfeed_nm`.
    pub position_nm: [i64; 3],
    /// A, B, C, microdegrees; see `arcfeed_microdeg`.
    pub position_microdeg: [i64; 3],
    /// Age of the position, us: 0 for a new one.
    pub position_age_us: u32,
    /// Age of the last valid frame of the host that supplies the moves, us; 0 if all moves are stored here.
    pub link_age_us: u32,
    /// Time since the last tick, us.
    pub dt_us: u32,
    /// Signals that are active: the sum of their `ARCFEED_SIGNAL_...`.
    pub signals: u32,
    /// Line of the block in execution; `ARCFEED_NO_LINE` or any negative number if there is none.
    pub line: i32,
    /// Measured spindle speed, rev/min; 0 if unknown.
    pub spindle_rev_per_min: f32,
    /// The operator's dial, %, if the controller's output replaces it; 100 if the control applies the dial itself.
    pub operator_percent: u8,
}

/// Outputs of a control tick: override, state, and reason.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct ArcfeedOutput {
    /// Override as a ratio: `override_percent` / 100.
    pub override_ratio: f32,
    /// Feed that the law demands, divided by F as the control receives it; 0 without a law.
    pub wanted_ratio: f32,
    /// Estimated chip load divided by its target; 0 without a law.
    pub chip_ratio: f32,
    /// Override to be set, %.
    pub override_percent: u8,
    /// State of the supervisor, one of `ARCFEED_STATE_...`.
    pub state: u8,
    /// Reason of the override: a number of docs/outputs.md.
    pub reason: u8,
    /// Alarm: 0 none, 1 as long as its condition lasts, 2 until a person acts.
    pub alarm: u8,
    /// Reason why arming, requested at this tick, was rejected: a `RefusalCode` of docs/protocol.md; 0 for none.
    pub refusal: u8,
    /// 1 if the position is followed along a move that began at its start; otherwise 0.
    pub is_followed: u8,
}

/// Inputs for a control whose override input can only reduce the feed.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct ArcfeedAdaptiveInput {
    /// The control's own feed override in use, as a ratio.
    pub dial_ratio: f64,
    /// Velocity along the path at present, in any unit per second.
    pub current_units_per_s: f64,
    /// Velocity that the control commands: F with all of its overrides, in the same unit.
    pub commanded_units_per_s: f64,
    /// Velocity of F without any override, in the same unit.
    pub requested_units_per_s: f64,
    /// Distance to the end of the move, in that unit's length; 0 if it is not known.
    pub remaining_units: f64,
    /// Time since the last call, us.
    pub dt_us: u32,
    /// LinuxCNC's `motion.motion-type`: 0 idle, 1 rapid, 2 line, 3 arc.
    pub motion_type: i32,
}

/// Outputs for a control whose override input can only reduce the feed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct ArcfeedAdaptiveOutput {
    /// Factor for the control's input that reduces the feed, 0 to 1.
    pub adaptive_feed_ratio: f64,
    /// Value to which the control's own override is to be set when this number changes, %.
    pub dial_percent: i32,
    /// 1 if the control must stop the feed of all axes; otherwise 0.
    pub feed_inhibit: u8,
}
