// The arcfeed controller in a firmware written in C: a page of parameters, two moves, arming, and a tick every millisecond.
//
// The axes are simulated: replace `advance` by your encoders, `print` by your override output, and the lines by those that
// your control reports. The page is what `arcfeed parameters job.toml -o page.bin` writes.
#include <stdint.h>

#include "arcfeed.h"

#define MOVES 2
#define RADIUS_MM 20.0f
#define FEED_MM_PER_MIN 800.0f
#define SPINDLE_REV_PER_MIN 4000.0f
#define TICK_US 1000u

extern const uint8_t page[], page_end[];

void print(const char *text); // start.c
void leave(int failed);

static uint64_t memory[(ARCFEED_CONTROLLER_SIZE + MOVES * ARCFEED_MOVE_SIZE) / 8];
static ArcfeedController *controller;

static void print_number(int64_t number) {
    char text[24];
    char *at = text + sizeof text;
    uint64_t rest = number < 0 ? -(uint64_t)number : (uint64_t)number;
    *--at = 0;
    do *--at = '0' + rest % 10; while (rest /= 10);
    if (number < 0) *--at = '-';
    print(at);
}

// A half circle about the origin from (x, 0) to (-x, 0).
static ArcfeedStatus add_arc(uint32_t line, int64_t x_nm, uint8_t path, uint8_t rule) {
    const ArcfeedMove move = {
        .start_nm = {x_nm, 0, 0},
        .end_nm = {-x_nm, 0, 0},
        .center_nm = {0, 0},
        .feed_nm_per_min = (int64_t)(FEED_MM_PER_MIN * 1e6f),
        .path = path,
        .rule = rule,
        .end_percent = 100,
    };
    return arcfeed_add_move(controller, line, &move);
}

// Turns a point about the origin by a small arc; what the rounding takes from the radius is given back.
static void advance(float at[2], float arc_mm, float turn) {
    const float angle = turn * arc_mm / RADIUS_MM;
    const float x = at[0] - angle * at[1], y = at[1] + angle * at[0];
    const float scale = 1.5f - 0.5f * (x * x + y * y) / (RADIUS_MM * RADIUS_MM);
    at[0] = x * scale, at[1] = y * scale;
}

static ArcfeedOutput tick(int32_t line, const float at[2], uint32_t signals) {
    const ArcfeedInput in = {
        .position_nm = {(int64_t)(at[0] * 1e6f), (int64_t)(at[1] * 1e6f), 0},
        .dt_us = TICK_US,
        .signals = signals,
        .line = line,
        .spindle_rev_per_min = SPINDLE_REV_PER_MIN,
        .operator_percent = 100,
    };
    ArcfeedOutput out;
    if (arcfeed_tick(controller, &in, &out) != ARCFEED_STATUS_OK) leave(1);
    const int64_t line_of_output[] = {line, in.position_nm[0], in.position_nm[1], out.state, out.reason, out.override_percent};
    for (unsigned n = 0; n < 6; n++) print_number(line_of_output[n]), print(n < 5 ? " " : "\n");
    return out;
}

int main(void) {
    static float at[2] = {-RADIUS_MM, 0};
    if (arcfeed_create(memory, sizeof memory, &controller) != ARCFEED_STATUS_OK) return 1;
    if (arcfeed_load_page(controller, page, page_end - page) != ARCFEED_STATUS_OK) return 2;
    if (add_arc(6, -20000000, ARCFEED_PATH_CW_XY, 0) != ARCFEED_STATUS_OK) return 3;
    if (add_arc(7, 20000000, ARCFEED_PATH_CCW_XY, 1) != ARCFEED_STATUS_OK) return 4;
    tick(ARCFEED_NO_LINE, at, 0);
    if (tick(ARCFEED_NO_LINE, at, ARCFEED_SIGNAL_ARM).state != ARCFEED_STATE_ARMED) return 5;
    for (int32_t line = 6; line < 8; line++) {
        for (float left_mm = 3.14159f * RADIUS_MM; left_mm > 0;) {
            const ArcfeedOutput out = tick(line, at, 0);
            const float arc_mm = FEED_MM_PER_MIN / 60.0f * out.override_ratio * (TICK_US * 1e-6f);
            advance(at, arc_mm, line == 6 ? -1.0f : 1.0f);
            left_mm -= arc_mm;
        }
    }
    return tick(ARCFEED_NO_LINE, at, 0).state == ARCFEED_STATE_ARMED ? 0 : 6;
}
