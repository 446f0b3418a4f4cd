//! Conditions of the moves: the panel, the override input, and the functions that the program has switched off with
//! #3003 and #3004.

use arcfeed_units::{Micros, PERCENT};

use super::Control;
use super::canned_cycle_run::CannedCycleRun;
use super::feeds::FeedConditions;
use super::interpolator::AxisLimited;
use super::panel::Phase;

/// Bits of #3003 and #3004. Exact stop (bit 2 of #3004) is not modelled, so there is nothing to switch off.
const NO_SINGLE_BLOCK: u8 = 1;
const NO_FEED_HOLD: u8 = 1;
const NO_OVERRIDE: u8 = 2;

impl Control {
    /// Delays the override from its input by the scan time of the machine's ladder.
    pub(super) fn through_ladder(&mut self, override_percent: u8) -> u8 {
        self.ladder.push_back(override_percent);
        if self.ladder.len() > self.settings.ladder_delay_steps {
            return self.ladder.pop_front().unwrap_or(override_percent);
        }
        self.ladder_percent
    }

    /// Override in effect, %: that of the input after the delay of the machine's ladder, or 100 % while #3004 switches the override off.
    pub fn override_percent(&self) -> u8 {
        if self.ignored.feed & NO_OVERRIDE == 0 { self.ladder_percent } else { PERCENT as u8 }
    }

    /// Blocks that ran slower than the feed times the override because an axis reached its limit.
    pub fn limited(&self) -> &[AxisLimited] {
        self.interpolator.limited()
    }

    pub(super) fn conditions(&self) -> FeedConditions {
        let stops = self.is_over() || self.phase == Phase::Resetting || self.drive_state.holds();
        FeedConditions {
            override_percent: self.override_percent(),
            dry_run: self.switches.dry_run.then_some(self.settings.dry_run_feed),
            holds: self.holds() || stops,
            holds_but_taps: !stops,
            stops_at_block_end: self.is_in_single_block() || self.drive_state.stops_at_block_end(),
        }
    }

    /// Counts down a dwell, except in feed hold and before the axes are in position.
    pub(super) fn dwell(&mut self, dt: Micros) {
        let goes_on = !self.holds() || self.cycle_run.as_ref().is_some_and(CannedCycleRun::is_tapping);
        if goes_on && self.is_in_position() {
            self.dwell_left = self.dwell_left.since(dt);
        }
    }

    /// Whether the next block may begin. Axes that have passed the end of a move continue to a place where they can
    /// rest, whatever has happened.
    pub(super) fn may_begin(&self) -> bool {
        let is_running = self.phase == Phase::Running && self.dwell_left == Micros(0) && !self.is_over();
        self.interpolator.is_between() || is_running && !self.awaits_position()
    }

    /// Whether feed hold is on and in effect.
    pub(super) fn holds(&self) -> bool {
        self.held && self.ignored.feed & NO_FEED_HOLD == 0
    }

    /// Whether single block is on and in effect.
    pub(super) fn is_in_single_block(&self) -> bool {
        self.switches.single_block && self.ignored.stops & NO_SINGLE_BLOCK == 0
    }
}
