component arcfeed "Feed override that keeps the chip load constant, for motion.adaptive-feed";
description """
Follows the program line and the position, and sets motion.adaptive-feed and the dial so that the feed is F times the
override that the feed law of the job demands. docs/linuxcnc.md of arcfeed describes its wiring and its safety.
The moves come from the user-space half, arcfeed-program, through a HAL stream.""";
option singleton yes;
option extra_setup yes;
option extra_cleanup yes;
option extra_compile_args "-I$(ARCFEED_C)/include";

pin in float position-x "Position of the axis in machine units";
pin in float position-y;
pin in float position-z;
pin in float position-a "Position of the axis, degrees";
pin in float position-b;
pin in float position-c;
pin in float offset-x "Work, G92 and tool offset: position minus offset is in the program's coordinates";
pin in float offset-y;
pin in float offset-z;
pin in float offset-a;
pin in float offset-b;
pin in float offset-c;
pin in s32 program-line "motion.program-line";
pin in s32 motion-type "motion.motion-type";
pin in float spindle-speed "Measured spindle speed, rev/min; its sign is ignored";
pin in float feed-override = 1.0 "halui.feed-override.value: the control's own override in use";
pin in float current-velocity "motion.current-vel";
pin in float commanded-velocity "motion.feed-mm-per-second or motion.feed-inches-per-second, the one of machine units";
pin in float requested-velocity "motion.requested-vel";
pin in bit feed-hold "halui.program.is-paused";
pin in bit program-idle "halui.program.is-idle: its rising edge disarms";
pin in bit program-valid "From arcfeed-program: FALSE disarms";
pin in s32 program-heartbeat "From arcfeed-program: it changes while that lives";
pin in bit enable "halui.machine.is-on: FALSE disarms";
pin in bit arm "A person gives the feed to the law; acts when it rises";
pin in bit disarm "A person takes it back; acts when it rises";
pin in bit reset "A person resets a fault; acts when it rises";

pin out float adaptive-feed = 1.0 "For motion.adaptive-feed";
pin out s32 dial-percent = 100 "For halui.feed-override.counts, with scale 0.01 and direct-value TRUE";
pin out bit feed-inhibit "For motion.feed-inhibit, with the watchdog";
pin out bit heartbeat "It changes with each period";
pin out s32 state "0 idle, 1 armed, 2 running, 3 holding, 4 fallback, 5 faulted, 6 inhibited, 7 disarmed";
pin out bit armed "The law has the feed";
pin out s32 reason "Reason of the override, docs/outputs.md";
pin out s32 refusal "Why the last arming was rejected, RefusalCode of docs/protocol.md; 0 for none";
pin out float override-ratio = 1.0 "Feed over F";
pin out float wanted-ratio "Feed that the law demands over F; 0 without a law";
pin out float chip-estimate "Chip load over its target; 0 without a law";
pin out u32 moves "Moves of the program in force; 0 while there is none";
pin out s32 load-status "ArcfeedStatus of the last program";

param rw float mm-per-unit = 1.0 "Length of the machine's unit: 25.4 for inches";

function _ fp "Between motion-command-handler and motion-controller";

author "arcfeed";
license "GPL"; // this file may also be used under MIT or Apache-2.0
;;

#include <stdlib.h>
#include "arcfeed.h"

#define STREAM_KEY 0x4146
#define STREAM_DEPTH 8192
#define RECORDS_PER_PERIOD 32
#define HEARTBEAT_MAX_US 1000000u

static unsigned moves_max = 20000;
RTAPI_MP_INT(moves_max, "Room for moves");

static hal_stream_t stream;
static ArcfeedController *controller;
static void *memory;

EXTRA_SETUP() {
    size_t size = ARCFEED_CONTROLLER_SIZE + (size_t)moves_max * ARCFEED_MOVE_SIZE;
    (void)__comp_inst; (void)prefix; (void)extra_arg;
    memory = aligned_alloc(64, (size + 63) / 64 * 64);
    if (!memory) return -ENOMEM;
    memset(memory, 0, size);
    if (arcfeed_create(memory, size, &controller) != ARCFEED_STATUS_OK) return -EINVAL;
    return hal_stream_create(&stream, comp_id, STREAM_KEY, STREAM_DEPTH, "uu");
}

// What motion.adaptive-feed keeps is at most F with a dial of 2; the watchdog then stops the feed.
EXTRA_CLEANUP() {
    struct __comp_state *__comp_inst = __comp_first_inst;
    if (__comp_inst && adaptive_feed > 0.5) adaptive_feed = 0.5;
    hal_stream_destroy(&stream);
    free(memory);
}

// A record: 0 and anything for a new program, or the number of its bytes and up to four bytes.
static void load(struct __comp_state *__comp_inst) {
    union hal_stream_data record[2];
    for (int n = 0; n < RECORDS_PER_PERIOD && hal_stream_read(&stream, record, 0) == 0; n++) {
        if (record[0].u == 0) {
            load_status = arcfeed_begin_program(controller);
            if (load_status == ARCFEED_STATUS_OK) load_status = ARCFEED_STATUS_INCOMPLETE;
        } else if (load_status >= 0 && record[0].u <= 4) {
            uint8_t bytes[4];
            for (int at = 0; at < 4; at++) bytes[at] = record[1].u >> (8 * at);
            load_status = arcfeed_load_program(controller, bytes, record[0].u);
        }
    }
}

FUNCTION(_) {
    static int beat, was_idle;
    static uint32_t beat_age_us;
    const uint32_t dt_us = period / 1000;
    ArcfeedInput in = {0};
    ArcfeedOutput out;
    ArcfeedAdaptiveInput control = {0};
    ArcfeedAdaptiveOutput feed;

    load(__comp_inst);
    beat_age_us = program_heartbeat != beat ? 0 : beat_age_us < UINT32_MAX - dt_us ? beat_age_us + dt_us : UINT32_MAX;
    beat = program_heartbeat;
    in.position_nm[0] = arcfeed_nm((position_x - offset_x) * mm_per_unit);
    in.position_nm[1] = arcfeed_nm((position_y - offset_y) * mm_per_unit);
    in.position_nm[2] = arcfeed_nm((position_z - offset_z) * mm_per_unit);
    in.position_microdeg[0] = arcfeed_microdeg(position_a - offset_a);
    in.position_microdeg[1] = arcfeed_microdeg(position_b - offset_b);
    in.position_microdeg[2] = arcfeed_microdeg(position_c - offset_c);
    in.link_age_us = beat_age_us > HEARTBEAT_MAX_US ? beat_age_us - HEARTBEAT_MAX_US : 0;
    in.dt_us = dt_us;
    in.line = motion_type == 0 ? ARCFEED_NO_LINE : program_line;
    in.spindle_rev_per_min = fabs(spindle_speed);
    in.operator_percent = 100; // the control applies the dial itself
    if (motion_type == 1) in.signals |= ARCFEED_SIGNAL_RAPID;
    if (feed_hold) in.signals |= ARCFEED_SIGNAL_FEED_HOLD;
    if (arm && enable && program_valid) in.signals |= ARCFEED_SIGNAL_ARM;
    if (disarm || !enable || !program_valid || (program_idle && !was_idle)) in.signals |= ARCFEED_SIGNAL_DISARM;
    if (reset) in.signals |= ARCFEED_SIGNAL_RESET;
    was_idle = program_idle;
    arcfeed_tick(controller, &in, &out);

    control.dial_ratio = feed_override;
    control.current_velocity = current_velocity;
    control.commanded_velocity = commanded_velocity;
    control.requested_velocity = requested_velocity;
    control.dt_us = dt_us;
    control.motion_type = motion_type;
    arcfeed_adaptive_feed(controller, &control, &feed);

    adaptive_feed = feed.adaptive_feed;
    dial_percent = feed.dial_percent;
    feed_inhibit = feed.feed_inhibit;
    heartbeat = !heartbeat;
    state = out.state;
    armed = state == ARCFEED_STATE_ARMED || state == ARCFEED_STATE_RUNNING || state == ARCFEED_STATE_HOLDING
        || state == ARCFEED_STATE_INHIBITED;
    reason = out.reason;
    if (out.refusal || armed) refusal = out.refusal;
    override_ratio = out.override_ratio;
    wanted_ratio = out.wanted_ratio;
    chip_estimate = requested_velocity > 0 && out.override_ratio > 0
        ? out.chip_ratio * current_velocity / (requested_velocity * out.override_ratio) : 0;
    moves = arcfeed_moves(controller);
}
