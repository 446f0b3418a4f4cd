//! Structs and constants of the interface. Every number of a struct may have any value; the calls check them.

/// Size of a controller without moves, bytes.
pub const ARCFEED_CONTROLLER_SIZE: usize = 16_384;
/// Size of a move, bytes: the memory for n moves is `ARCFEED_CONTROLLER_SIZE` + n * `ARCFEED_MOVE_SIZE`.
pub const ARCFEED_MOVE_SIZE: usize = 512;
/// Alignment of the memory, bytes.
pub const ARCFEED_ALIGNMENT: usize = 8;

/// No cut rule governs the move.
pub const ARCFEED_NO_RULE: u8 = 255;
/// A line that is no line: no block is in execution.
pub const ARCFEED_NO_LINE: i32 = -1;

/// Path of a move: positioning, on a path that the control chooses.
pub const ARCFEED_PATH_RAPID: u8 = 0;
/// Path of a move: a line.
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

/// Signal: G41 or G42 is active.
pub const ARCFEED_SIGNAL_CUTTER_COMPENSATION: u32 = 0x1;
/// Signal: the control ignores the override.
pub const ARCFEED_SIGNAL_OVERRIDE_OFF: u32 = 0x2;
/// Signal: a tapping cycle is active.
pub const ARCFEED_SIGNAL_TAPPING: u32 = 0x4;
/// Signal: thread cutting is active.
pub const ARCFEED_SIGNAL_THREADING: u32 = 0x8;
/// Signal: G63 is active.
pub const ARCFEED_SIGNAL_FEED_FORCED: u32 = 0x10;
/// Signal: the axes are positioning.
pub const ARCFEED_SIGNAL_RAPID: u32 = 0x20;
/// Signal: feed hold is active.
pub const ARCFEED_SIGNAL_FEED_HOLD: u32 = 0x40;
/// Signal: the watchdog has expired.
pub const ARCFEED_SIGNAL_FAULT_WATCHDOG: u32 = 0x100;
/// Signal: stored parameters are corrupt.
pub const ARCFEED_SIGNAL_FAULT_PARAMETERS: u32 = 0x200;
/// Signal: a failure of supply, clock, output or dial.
pub const ARCFEED_SIGNAL_FAULT_HARDWARE: u32 = 0x400;
/// Signal: a person arms; acts once when it rises.
pub const ARCFEED_SIGNAL_ARM: u32 = 0x1_0000;
/// Signal: a person disarms; acts once when it rises.
pub const ARCFEED_SIGNAL_DISARM: u32 = 0x2_0000;
/// Signal: a person resets a fault; acts once when it rises.
pub const ARCFEED_SIGNAL_RESET: u32 = 0x4_0000;

/// Output state: not armed since the start or a reset.
pub const ARCFEED_STATE_IDLE: u8 = 0;
/// Output state: a law acts as soon as a move begins.
pub const ARCFEED_STATE_ARMED: u8 = 1;
/// Output state: the laws set the override.
pub const ARCFEED_STATE_RUNNING: u8 = 2;
/// Output state: the axes are held.
pub const ARCFEED_STATE_HOLDING: u8 = 3;
/// Output state: position or link was lost.
pub const ARCFEED_STATE_FALLBACK: u8 = 4;
/// Output state: 0 % until a person resets the fault.
pub const ARCFEED_STATE_FAULTED: u8 = 5;
/// Output state: the override has nothing to act on.
pub const ARCFEED_STATE_INHIBITED: u8 = 6;
/// Output state: operator, request or condition have taken the override.
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
    /// Feed as the control has it, nm/min; 0 or below if there is none.
    pub feed_nm_per_min: i64,
    /// Upper limit of the feed by the job's ceiling, nm/min; 0 for none but that of the job.
    pub max_feed_nm_per_min: i64,
    /// Commanded spindle speed, rev/min; 0 for that of the tool.
    pub spindle_rev_per_min: f32,
    /// `ARCFEED_PATH_...`.
    pub path: u8,
    /// Index of the governing cut rule, or `ARCFEED_NO_RULE`.
    pub rule: u8,
    /// Largest override at the end, %: the one with which the next move can begin.
    pub end_percent: u8,
}

/// Inputs of a tick.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct ArcfeedInput {
    /// X, Y, Z of the tool's centre in workpiece coordinates, nm; see `arcfeed_nm`.
    pub position_nm: [i64; 3],
    /// A, B, C, microdegrees; see `arcfeed_microdeg`.
    pub position_microdeg: [i64; 3],
    /// Age of the position, us: 0 for a new one.
    pub position_age_us: u32,
    /// Age of the last sign of life of the host that supplies the moves, us; 0 if all are here.
    pub link_age_us: u32,
    /// Time since the last tick, us.
    pub dt_us: u32,
    /// Union of `ARCFEED_SIGNAL_...`.
    pub signals: u32,
    /// Line of the block in execution; `ARCFEED_NO_LINE` or any negative number if there is none.
    pub line: i32,
    /// Spindle speed, rev/min.
    pub spindle_rev_per_min: f32,
    /// The operator's dial, %, if the controller's output replaces it; 100 if the control applies the dial itself.
    pub operator_percent: u8,
}

/// Outputs of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct ArcfeedOutput {
    /// Override as a ratio: `override_percent` / 100.
    pub override_ratio: f32,
    /// Ratio of the feed that the law demands to the feed that the control has; 0 without a law.
    pub wanted_ratio: f32,
    /// Estimated chip load as a ratio of its target; 0 without a law.
    pub chip_ratio: f32,
    /// Override, %.
    pub override_percent: u8,
    /// `ARCFEED_STATE_...`.
    pub state: u8,
    /// Reason of the override: a number of docs/outputs.md.
    pub reason: u8,
    /// 0 none, 1 passing, 2 latched until a person acts.
    pub alarm: u8,
    /// Reason why an arming of this tick was rejected, a `RefusalCode` of docs/protocol.md; 0 for none.
    pub refusal: u8,
    /// 1 if a move of the program is followed.
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
    /// Reduction for the control's input, 0 to 1.
    pub adaptive_feed_ratio: f64,
    /// Value to which the control's own override is to be set when this number changes, %.
    pub dial_percent: i32,
    /// 1 if no axis may feed.
    pub feed_inhibit: u8,
}
