component arcfeed "Feed override that keeps the chip load constant, for motion.adaptive-feed";
description """
Follows the program line and the position, and sets motion.adaptive-feed and the dial so that the feed is F times the
override that the feed law of the job demands. docs/linuxcnc-safety.md of arcfeed describes its wiring and its safety.
The moves come from the user-space half, arcfeed-program, through a HAL stream.""";
option singleton yes;
option extra_setup yes;
option extra_cleanup yes;
option no_convenience_defines yes;

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
pin in float distance-to-go "motion.distance-to-go: rapids are slow without it";
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

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "arcfeed.h"

#define STREAM_KEY 0x4146
#define STREAM_DEPTH 8192
#define RECORDS_PER_PERIOD 32
#define HEARTBEAT_MAX_US 1000000u
#define LONGEST_US 1000000000u

typedef struct __comp_state Pins;

static int moves_max = 20000;
RTAPI_MP_INT(moves_max, "Room for moves");

static hal_stream_t stream;
static ArcfeedController *controller;
static void *memory;
// The function is in execution; it is to do nothing any more.
static int is_called, is_ended;

static int extra_setup(Pins *pins, char *prefix, long extra_arg) {
    const size_t size = ARCFEED_CONTROLLER_SIZE + (size_t)(moves_max > 0 ? moves_max : 0) * ARCFEED_MOVE_SIZE;
    (void)pins, (void)prefix, (void)extra_arg;
    is_ended = 0;
    memory = calloc(1, size);
    if (!memory) return -ENOMEM;
    if (arcfeed_create(memory, size, &controller) != ARCFEED_STATUS_OK) return -EINVAL;
    return hal_stream_create(&stream, comp_id, STREAM_KEY, STREAM_DEPTH, "uu");
}

// The servo thread calls the function until HAL has removed it, which is after this: it must use nothing that is destroyed here.
static void end_calls(void) {
    __atomic_store_n(&is_ended, 1, __ATOMIC_SEQ_CST);
    while (__atomic_load_n(&is_called, __ATOMIC_SEQ_CST)) usleep(100);
}

// motion.adaptive-feed keeps its last value: with a dial of 2, at most F. The watchdog then stops the feed.
static void extra_cleanup(void) {
    end_calls();
    if (__comp_first_inst && *__comp_first_inst->adaptive_feed > 0.5) *__comp_first_inst->adaptive_feed = 0.5;
    hal_stream_destroy(&stream);
    free(memory);
}

// A record of the stream: 0 and anything for a new program, or the number of its bytes and up to four bytes.
static void load(Pins *pins) {
    union hal_stream_data record[2];
    for (int n = 0; n < RECORDS_PER_PERIOD && hal_stream_read(&stream, record, 0) == 0; n++) {
        if (record[0].u == 0) {
            const ArcfeedStatus begun = arcfeed_begin_program(controller);
            *pins->load_status = begun == ARCFEED_STATUS_OK ? ARCFEED_STATUS_INCOMPLETE : begun;
        } else if (*pins->load_status >= 0 && record[0].u <= 4) {
            uint8_t bytes[4];
            for (int at = 0; at < 4; at++) bytes[at] = record[1].u >> (8 * at);
            *pins->load_status = arcfeed_load_program(controller, bytes, record[0].u);
        }
    }
}

static uint32_t signals(const Pins *pins) {
    static int was_idle;
    const int is_over = *pins->program_idle && !was_idle;
    const int may_arm = *pins->enable && *pins->program_valid;
    was_idle = *pins->program_idle;
    return (*pins->motion_type == 1 ? ARCFEED_SIGNAL_RAPID : 0) | (*pins->feed_hold ? ARCFEED_SIGNAL_FEED_HOLD : 0)
        | (*pins->arm && may_arm ? ARCFEED_SIGNAL_ARM : 0) | (*pins->reset ? ARCFEED_SIGNAL_RESET : 0)
        | (*pins->disarm || !may_arm || is_over ? ARCFEED_SIGNAL_DISARM : 0);
}

// Time since the user-space half was last heard, beyond the time that it may be silent.
static uint32_t link_age_us(const Pins *pins, uint32_t dt_us) {
    static hal_s32_t beat;
    static uint32_t age_us;
    age_us = *pins->program_heartbeat != beat ? 0 : age_us < LONGEST_US ? age_us + dt_us : age_us;
    beat = *pins->program_heartbeat;
    return age_us > HEARTBEAT_MAX_US ? age_us - HEARTBEAT_MAX_US : 0;
}

static ArcfeedInput inputs(const Pins *pins, uint32_t dt_us) {
    const double unit = pins->mm_per_unit;
    const ArcfeedInput in = {
        .position_nm = {arcfeed_nm((*pins->position_x - *pins->offset_x) * unit),
                        arcfeed_nm((*pins->position_y - *pins->offset_y) * unit),
                        arcfeed_nm((*pins->position_z - *pins->offset_z) * unit)},
        .position_microdeg = {arcfeed_microdeg(*pins->position_a - *pins->offset_a),
                              arcfeed_microdeg(*pins->position_b - *pins->offset_b),
                              arcfeed_microdeg(*pins->position_c - *pins->offset_c)},
        .link_age_us = link_age_us(pins, dt_us),
        .dt_us = dt_us,
        .signals = signals(pins),
        .line = *pins->motion_type == 0 ? ARCFEED_NO_LINE : *pins->program_line,
        .spindle_rev_per_min = fabs(*pins->spindle_speed),
        .operator_percent = 100, // the control applies its dial itself
    };
    return in;
}

static void put(Pins *pins, const ArcfeedOutput *out) {
    const double feed = *pins->requested_velocity * out->override_ratio;
    *pins->state = out->state;
    *pins->armed = out->state == ARCFEED_STATE_ARMED || out->state == ARCFEED_STATE_RUNNING
        || out->state == ARCFEED_STATE_HOLDING || out->state == ARCFEED_STATE_INHIBITED;
    *pins->reason = out->reason;
    if (out->refusal || *pins->armed) *pins->refusal = out->refusal;
    *pins->override_ratio = out->override_ratio;
    *pins->wanted_ratio = out->wanted_ratio;
    *pins->chip_estimate = feed > 0 ? out->chip_ratio * *pins->current_velocity / feed : 0;
    *pins->moves = arcfeed_moves(controller);
    *pins->heartbeat = !*pins->heartbeat;
}

static void control(Pins *pins, long period) {
    const uint32_t dt_us = period / 1000;
    ArcfeedOutput out;
    ArcfeedAdaptiveOutput feed;

    load(pins);
    const ArcfeedInput in = inputs(pins, dt_us);
    arcfeed_tick(controller, &in, &out);
    const ArcfeedAdaptiveInput adaptive = {
        .dial_ratio = *pins->feed_override,
        .current_units_per_s = *pins->current_velocity,
        .commanded_units_per_s = *pins->commanded_velocity,
        .requested_units_per_s = *pins->requested_velocity,
        .remaining_units = *pins->distance_to_go,
        .dt_us = dt_us,
        .motion_type = *pins->motion_type,
    };
    arcfeed_adaptive_feed(controller, &adaptive, &feed);
    *pins->adaptive_feed = feed.adaptive_feed_ratio;
    *pins->dial_percent = feed.dial_percent;
    *pins->feed_inhibit = feed.feed_inhibit;
    put(pins, &out);
}

// FUNCTION(_): by this word halcompile finds that the functions are written out.
static void _(Pins *pins, long period) {
    __atomic_store_n(&is_called, 1, __ATOMIC_SEQ_CST);
    if (!__atomic_load_n(&is_ended, __ATOMIC_SEQ_CST)) control(pins, period);
    __atomic_store_n(&is_called, 0, __ATOMIC_SEQ_CST);
}
