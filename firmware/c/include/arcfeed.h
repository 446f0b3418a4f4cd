// arcfeed: feed controller for milling, C interface. See firmware/c/README.md.
//
// Every call checks its arguments; one with an error does nothing, except that arcfeed_tick and arcfeed_adaptive_feed
// write outputs that stop the feed. Calls for one controller must not overlap in time.

#ifndef ARCFEED_H
#define ARCFEED_H

#include <stddef.h>
#include <stdint.h>

// Size of a controller without moves, bytes.
#define ARCFEED_CONTROLLER_SIZE 16384

// Size of one stored move, bytes: a controller for n moves needs `ARCFEED_CONTROLLER_SIZE` + n * `ARCFEED_MOVE_SIZE`.
#define ARCFEED_MOVE_SIZE 512

// Required alignment of the memory for a controller, bytes.
#define ARCFEED_ALIGNMENT 8

// Value of `rule`: no law governs the move.
#define ARCFEED_NO_RULE 255

// Value of `line`: no block is in execution.
#define ARCFEED_NO_LINE -1

// Path of a move: rapid traverse, on a path that the control chooses.
#define ARCFEED_PATH_RAPID 0

// Path of a move: a straight cutting move.
#define ARCFEED_PATH_LINE 1

// Path of a move: a clockwise arc in XY.
#define ARCFEED_PATH_CW_XY 2

// Path of a move: a counter-clockwise arc in XY.
#define ARCFEED_PATH_CCW_XY 3

// Path of a move: a clockwise arc in ZX.
#define ARCFEED_PATH_CW_ZX 4

// Path of a move: a counter-clockwise arc in ZX.
#define ARCFEED_PATH_CCW_ZX 5

// Path of a move: a clockwise arc in YZ.
#define ARCFEED_PATH_CW_YZ 6

// Path of a move: a counter-clockwise arc in YZ.
#define ARCFEED_PATH_CCW_YZ 7

// Bit of `ArcfeedInput::signals`: cutter compensation (G41 or G42) is active.
#define ARCFEED_SIGNAL_CUTTER_COMPENSATION 1

// Bit of `ArcfeedInput::signals`: the control ignores the override.
#define ARCFEED_SIGNAL_OVERRIDE_OFF 2

// Bit of `ArcfeedInput::signals`: a tapping cycle is active.
#define ARCFEED_SIGNAL_TAPPING 4

// Bit of `ArcfeedInput::signals`: thread cutting is active.
#define ARCFEED_SIGNAL_THREADING 8

// Bit of `ArcfeedInput::signals`: G63 (tapping mode) is active, which holds the feed at 100 %.
#define ARCFEED_SIGNAL_FEED_FORCED 16

// Bit of `ArcfeedInput::signals`: the axes are in rapid traverse.
#define ARCFEED_SIGNAL_RAPID 32

// Bit of `ArcfeedInput::signals`: feed hold is active.
#define ARCFEED_SIGNAL_FEED_HOLD 64

// Bit of `ArcfeedInput::signals`: the watchdog has expired.
#define ARCFEED_SIGNAL_FAULT_WATCHDOG 256

// Bit of `ArcfeedInput::signals`: stored parameters are corrupt.
#define ARCFEED_SIGNAL_FAULT_PARAMETERS 512

// Bit of `ArcfeedInput::signals`: a failure of supply, clock, output or dial.
#define ARCFEED_SIGNAL_FAULT_HARDWARE 1024

// Bit of `ArcfeedInput::signals`: a person arms, so that the laws may set the override; acts once when it rises.
#define ARCFEED_SIGNAL_ARM 65536

// Bit of `ArcfeedInput::signals`: a person takes the override from the laws; acts once when it rises.
#define ARCFEED_SIGNAL_DISARM 131072

// Bit of `ArcfeedInput::signals`: a person resets a fault; acts once when it rises.
#define ARCFEED_SIGNAL_RESET 262144

// Output state idle: the laws have not been armed since the start or a reset of a fault.
#define ARCFEED_STATE_IDLE 0

// Output state armed: a law sets the override as soon as a move begins.
#define ARCFEED_STATE_ARMED 1

// Output state running: a law sets the override.
#define ARCFEED_STATE_RUNNING 2

// Output state holding: feed hold or an override of 0 % stops the axes; the override does not rise.
#define ARCFEED_STATE_HOLDING 3

// Output state fallback: position or link was lost; a person must arm again.
#define ARCFEED_STATE_FALLBACK 4

// Output state faulted: 0 % until a person resets the fault.
#define ARCFEED_STATE_FAULTED 5

// Output state inhibited: the override does not act on the present feed (rapid, tapping, threading).
#define ARCFEED_STATE_INHIBITED 6

// Output state disarmed: the operator, a request or a condition of the control has taken the override from the laws.
#define ARCFEED_STATE_DISARMED 7

// Result of a call of this interface.
enum ArcfeedStatus
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The call has done what it should.
  ARCFEED_STATUS_OK = 0,
  // More bytes of the prepared program are needed.
  ARCFEED_STATUS_INCOMPLETE = 1,
  // A pointer is null.
  ARCFEED_STATUS_NULL = -1,
  // A pointer is not aligned to its type, or the memory of a controller not to `ARCFEED_ALIGNMENT`.
  ARCFEED_STATUS_ALIGNMENT = -2,
  // The memory is smaller than a controller without moves.
  ARCFEED_STATUS_SIZE = -3,
  // There is no controller at this address.
  ARCFEED_STATUS_NO_CONTROLLER = -4,
  // There is a controller at this address already.
  ARCFEED_STATUS_EXISTS = -5,
  // Not possible while the laws are armed: disarm first.
  ARCFEED_STATUS_BUSY = -6,
  // The bytes are not a page or a prepared program.
  ARCFEED_STATUS_FORM = -7,
  // The bytes were written for another version of the messages.
  ARCFEED_STATUS_SCHEMA = -8,
  // Wrong checksum.
  ARCFEED_STATUS_CHECKSUM = -9,
  // A value is invalid.
  ARCFEED_STATUS_VALUE = -10,
  // The memory has no place for another move.
  ARCFEED_STATUS_FULL = -11,
  // A line is not after the line of the last move.
  ARCFEED_STATUS_ORDER = -12,
  // There are no parameters yet.
  ARCFEED_STATUS_NO_PARAMETERS = -13,
  // An input of the tick is invalid; the tick has been done without it.
  ARCFEED_STATUS_INPUT = -14,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum ArcfeedStatus ArcfeedStatus;
#else
typedef int32_t ArcfeedStatus;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// A feed controller in the caller's memory; used only through pointers.
typedef struct ArcfeedController {
  uint8_t _opaque[0];
} ArcfeedController;

// A move of the program, in workpiece coordinates.
typedef struct ArcfeedMove {
  // X, Y, Z at the start, nm.
  int64_t start_nm[3];
  // X, Y, Z at the end, nm.
  int64_t end_nm[3];
  // A, B, C at the start, microdegrees.
  int64_t start_microdeg[3];
  // A, B, C at the end, microdegrees.
  int64_t end_microdeg[3];
  // Centre of an arc in its plane, nm: X Y, Z X or Y Z; ignored for other paths.
  int64_t center_nm[2];
  // Feed as the control receives it (F), nm/min; 0 or below if there is none.
  int64_t feed_nm_per_min;
  // Further upper limit of the feed, nm/min, such as the job's ceiling for the programmed feed; 0: only the job's limits.
  int64_t max_feed_nm_per_min;
  // Commanded spindle speed, rev/min; 0 for the job's speed of the tool.
  float spindle_rev_per_min;
  // Shape of the path, one of `ARCFEED_PATH_...`.
  uint8_t path;
  // Index, from 0, of the cut rule whose law governs the move, or `ARCFEED_NO_RULE`.
  uint8_t rule;
  // Largest override at the end of the move, %, with which the next move may begin; 100 if that does not matter.
  uint8_t end_percent;
} ArcfeedMove;

// Inputs of a control tick: measured values, signals, and the line in execution.
typedef struct ArcfeedInput {
  // X, Y, Z of the tool's centre in workpiece coordinates, nm; see `arcfeed_nm`.
  int64_t position_nm[3];
  // A, B, C, microdegrees; see `arcfeed_microdeg`.
  int64_t position_microdeg[3];
  // Age of the position, us: 0 for a new one.
  uint32_t position_age_us;
  // Age of the last valid frame of the host that supplies the moves, us; 0 if all moves are stored here.
  uint32_t link_age_us;
  // Time since the last tick, us.
  uint32_t dt_us;
  // Signals that are active: the sum of their `ARCFEED_SIGNAL_...`.
  uint32_t signals;
  // Line of the block in execution; `ARCFEED_NO_LINE` or any negative number if there is none.
  int32_t line;
  // Measured spindle speed, rev/min; 0 if unknown.
  float spindle_rev_per_min;
  // The operator's dial, %, if the controller's output replaces it; 100 if the control applies the dial itself.
  uint8_t operator_percent;
} ArcfeedInput;

// Outputs of a control tick: override, state, and reason.
typedef struct ArcfeedOutput {
  // Override as a ratio: `override_percent` / 100.
  float override_ratio;
  // Feed that the law demands, divided by F as the control receives it; 0 without a law.
  float wanted_ratio;
  // Estimated chip load divided by its target; 0 without a law.
  float chip_ratio;
  // Override to be set, %.
  uint8_t override_percent;
  // State of the supervisor, one of `ARCFEED_STATE_...`.
  uint8_t state;
  // Reason of the override: a number of docs/outputs.md.
  uint8_t reason;
  // Alarm: 0 none, 1 as long as its condition lasts, 2 until a person acts.
  uint8_t alarm;
  // Reason why arming, requested at this tick, was rejected: a `RefusalCode` of docs/protocol.md; 0 for none.
  uint8_t refusal;
  // 1 if the position is followed along a move that began at its start; otherwise 0.
  uint8_t is_followed;
} ArcfeedOutput;

// Inputs for a control whose override input can only reduce the feed.
typedef struct ArcfeedAdaptiveInput {
  // The control's own feed override in use, as a ratio.
  double dial_ratio;
  // Velocity along the path at present, in any unit per second.
  double current_units_per_s;
  // Velocity that the control commands: F with all of its overrides, in the same unit.
  double commanded_units_per_s;
  // Velocity of F without any override, in the same unit.
  double requested_units_per_s;
  // Distance to the end of the move, in that unit's length; 0 if it is not known.
  double remaining_units;
  // Time since the last call, us.
  uint32_t dt_us;
  // LinuxCNC's `motion.motion-type`: 0 idle, 1 rapid, 2 line, 3 arc.
  int32_t motion_type;
} ArcfeedAdaptiveInput;

// Outputs for a control whose override input can only reduce the feed.
typedef struct ArcfeedAdaptiveOutput {
  // Factor for the control's input that reduces the feed, 0 to 1.
  double adaptive_feed_ratio;
  // Value to which the control's own override is to be set when this number changes, %.
  int32_t dial_percent;
  // 1 if the control must stop the feed of all axes; otherwise 0.
  uint8_t feed_inhibit;
} ArcfeedAdaptiveOutput;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Creates a controller without parameters in `memory`, which must stay where it is, aligned to `ARCFEED_ALIGNMENT`.
// Every `ARCFEED_MOVE_SIZE` beyond `ARCFEED_CONTROLLER_SIZE` is room for a move.
//
// # Safety
// `memory` has `size` bytes that only the functions of this interface use; `controller` is writable.
ArcfeedStatus arcfeed_create(void *memory,
                             size_t size,
                             struct ArcfeedController **controller);

// Ends a controller; its memory may be used for anything else.
//
// # Safety
// `controller` is null, or leads to `ARCFEED_CONTROLLER_SIZE` bytes.
ArcfeedStatus arcfeed_discard(struct ArcfeedController *controller);

// Puts the parameters of a page of flash in force (written by `arcfeed parameters`) and deletes all moves.
//
// # Safety
// As of `arcfeed_discard`; `page` has `length` bytes.
ArcfeedStatus arcfeed_load_page(struct ArcfeedController *controller, const uint8_t *page, size_t length);

// Adds a move, whose line must be after that of the last one; the first line of a file is 1.
//
// # Safety
// As of `arcfeed_discard`; `added` is null or leads to a move.
ArcfeedStatus arcfeed_add_move(struct ArcfeedController *controller,
                               uint32_t line,
                               const struct ArcfeedMove *added);

// Deletes parameters and moves; the bytes of a prepared program follow.
//
// # Safety
// As of `arcfeed_discard`.
ArcfeedStatus arcfeed_begin_program(struct ArcfeedController *controller);

// Reads the next bytes of a prepared program, in parts of any length. `ARCFEED_STATUS_OK` after the last one: only then
// is the program in force.
//
// # Safety
// As of `arcfeed_discard`; `bytes` has `length` bytes.
ArcfeedStatus arcfeed_load_program(struct ArcfeedController *controller,
                                   const uint8_t *bytes,
                                   size_t length);

// Number of moves in force; 0 without parameters, with an incomplete program, and without a controller.
//
// # Safety
// As of `arcfeed_discard`.
size_t arcfeed_moves(struct ArcfeedController *controller);

// Runs one tick. `output` is written in any case in which it can be; without a controller it is 0 % and faulted.
//
// # Safety
// As of `arcfeed_discard`; `input` and `output` are null or lead to one value.
ArcfeedStatus arcfeed_tick(struct ArcfeedController *controller,
                           const struct ArcfeedInput *input,
                           struct ArcfeedOutput *output);

// Combines the override of the last tick with that of a control whose override input only reduces (LinuxCNC's adaptive
// feed). Call it after each tick or never.
//
// # Safety
// As of `arcfeed_tick`.
ArcfeedStatus arcfeed_adaptive_feed(struct ArcfeedController *controller,
                                    const struct ArcfeedAdaptiveInput *input,
                                    struct ArcfeedAdaptiveOutput *output);

// Millimetres as nanometres; what is no number or too large becomes a position that a tick refuses.
int64_t arcfeed_nm(double mm);

// Degrees as microdegrees; what is no number or too large becomes a position that a tick refuses.
int64_t arcfeed_microdeg(double deg);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* ARCFEED_H */
