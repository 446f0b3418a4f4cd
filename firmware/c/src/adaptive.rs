//! Override of a control whose input only reduces, as LinuxCNC's adaptive feed, so that 100 % stays safe.
//!
//! ```text
//! feed = F dial adaptive                      dial: the control's own override; adaptive: 0 to 1, this output      (1)
//! ```
//! A feed above F needs a dial above 1. While the laws have the override the dial is raised to `RAISED`, and
//!
//! ```text
//! adaptive = override / max(RAISED, dial)     so feed <= F override for each dial                                  (2)
//! ```
//! The dial is raised only then. It changes with the delay of a user interface; (2) therefore applies from the request
//! until the dial has read 1 or less for `SETTLING`. In between the feed is at most F override, whatever the dial is.
//! A control on which the laws never act thus has its dial at 1 and an adaptive feed of 1.
//!
//! A rapid is not slowed down by the factor of `RAISED`, except towards its end: the control applies the dial to the
//! first period of the next feed move, before its type can be known here.
//!
//! (2) fails if the control does not apply this output (M52 P0). While the dial is raised it is a fault if both the
//! velocity that the control commands and the present one are above F override for `EXCESS`: the output is not in
//! force, and no axis may feed. Only the present velocity is above it while the axes brake, and only the commanded one
//! where an axis limits the feed.

use arcfeed_firmware::supervisor::state::State;
use arcfeed_units::{PERCENT, Span};

use crate::values::{ArcfeedAdaptiveInput, ArcfeedAdaptiveOutput};

/// Dial while the laws have the override.
const RAISED: f64 = 2.0;
/// Time for which the dial must read 1 or less before it counts as lowered: several periods of a user interface.
const SETTLING: Span = Span::from_ms(1_000);
/// Time for which velocities may be too high: some periods of the control.
const EXCESS: Span = Span::from_ms(5);
/// Ratio of velocities above which one is too high.
const EXCESS_RATIO: f64 = 1.02;
/// Time before the end of a rapid from which (2) applies to it: longer than blending with the next move.
const RAPID_END_S: f64 = 0.5;
/// Motion type of a rapid.
const RAPID: i32 = 1;
/// Motion types of feed moves.
const FEEDS: core::ops::RangeInclusive<i32> = 2..=3;

/// Combines arcfeed's override with the control's own, for a control whose override input can only reduce the feed: it
/// raises the control's own override while the laws act, and reduces the feed by the input.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AdaptiveFeed {
    /// Dial requested last, %; `None` before the first request.
    dial_percent: Option<u8>,
    was_engaged: bool,
    is_raised: bool,
    lowered_for: Span,
    excess_for: Span,
    /// Remaining distance of the rapid in execution, and whether it is near its end.
    rapid: Option<(f64, bool)>,
}

impl AdaptiveFeed {
    /// Processes a tick at which the supervisor has this state and override. Returns the outputs, and whether the
    /// control does not apply them, which is a fault.
    pub fn update(
        &mut self,
        state: &State,
        override_ratio: f32,
        input: &ArcfeedAdaptiveInput,
    ) -> (ArcfeedAdaptiveOutput, bool) {
        let dial = if input.dial_ratio >= 0.0 { input.dial_ratio } else { f64::INFINITY };
        self.request(state.is_engaged(), dial);
        self.settle(state.is_engaged(), dial, Span(input.dt_us));
        let has_failed = self.has_excess(override_ratio, input);
        let is_faulted = matches!(state, State::Faulted { .. });
        let divisor = if self.is_raised { dial.max(RAISED) } else { 1.0 };
        let adaptive_feed_ratio = if is_faulted || has_failed {
            0.0
        } else if self.is_free_rapid(input) {
            1.0
        } else {
            (f64::from(override_ratio) / divisor).clamp(0.0, 1.0)
        };
        let dial_percent = i32::from(self.dial_percent.unwrap_or(PERCENT as u8));
        let feed_inhibit = u8::from(is_faulted || has_failed);
        (ArcfeedAdaptiveOutput { adaptive_feed_ratio, dial_percent, feed_inhibit }, has_failed)
    }

    /// Requests the dial: the operator's reduction keeps its share.
    fn request(&mut self, is_engaged: bool, dial: f64) {
        // The casts saturate.
        let percent = f64::from(PERCENT);
        match (self.was_engaged, is_engaged) {
            (false, true) => self.dial_percent = Some((dial.min(1.0) * RAISED * percent) as u8),
            (true, false) => self.dial_percent = Some(((dial / RAISED).min(1.0) * percent) as u8),
            (false, false) | (true, true) => {}
        }
        self.was_engaged = is_engaged;
    }

    fn settle(&mut self, is_engaged: bool, dial: f64, dt: Span) {
        let is_low = !is_engaged && dial <= 1.0;
        self.lowered_for = if is_low { self.lowered_for.longer_by(dt) } else { Span(0) };
        self.is_raised = is_engaged || self.is_raised && self.lowered_for < SETTLING;
    }

    /// Whether a rapid is far from its end. Once it is not, it stays so until the distance grows: another move, whose
    /// type is known a period later.
    fn is_free_rapid(&mut self, input: &ArcfeedAdaptiveInput) -> bool {
        let remaining = input.remaining_units;
        let is_far = remaining > 0.0 && remaining > input.current_units_per_s * RAPID_END_S;
        let same = self.rapid.filter(|(before, _)| remaining <= *before);
        let is_ending = same.is_some_and(|(_, was_ending)| was_ending) || !is_far;
        self.rapid = (input.motion_type == RAPID).then_some((remaining, is_ending));
        self.rapid.is_some() && same.is_some() && !is_ending
    }

    fn has_excess(&mut self, override_ratio: f32, input: &ArcfeedAdaptiveInput) -> bool {
        let highest = input.requested_units_per_s * f64::from(override_ratio) * EXCESS_RATIO;
        let is_feed = FEEDS.contains(&input.motion_type) && input.requested_units_per_s > 0.0;
        let is_above = input.commanded_units_per_s > highest && input.current_units_per_s > highest;
        let has_excess = self.is_raised && is_feed && is_above;
        self.excess_for = if has_excess { self.excess_for.longer_by(Span(input.dt_us)) } else { Span(0) };
        self.excess_for > EXCESS
    }
}

#[cfg(test)]
mod tests;
