//! Ramp: turns a wanted ratio into an override that the control can follow, by bounds, slew and rounding down.
//!
//! Every override passes through the ramp: the wanted ratio is limited to the bounds, the level moves there with the
//! slew, and the last stage rounds it down to a step of the control, at most `max`. The ramp is independent of laws,
//! so no law or state can bypass it. The level jumps only on request of the caller: for immediate falls, and at block
//! boundaries, where another programmed feed would change the actual feed ([`Level::carry`]).

use arcfeed_model::job::OverrideLimits;
use arcfeed_units::fmath;
use arcfeed_units::{PERCENT, Span, US_PER_S};

/// Relative tolerance below a step, which still counts as the step: prevents the loss of a whole step by f32 rounding.
const STEP_TOLERANCE_RATIO: f32 = 5e-6;

/// A feed override as the control receives it, whole per cent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FeedOverride {
    /// Per cent, 0 to 254.
    pub percent: u8,
}

impl FeedOverride {
    /// 100 %: the programmed feed.
    pub const PROGRAMMED: FeedOverride = FeedOverride { percent: 100 };
}

/// Checked bounds, slew rates and step of the override, by which a wanted ratio becomes an override.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    min_ratio: f32,
    max_ratio: f32,
    up_ratio_per_us: f32,
    /// Negative.
    down_ratio_per_us: f32,
    /// Number of steps in a ratio of one, including the tolerance.
    steps_per_ratio: f32,
    max_steps: u32,
    step_percent: u32,
}

/// Override at the output as a ratio (1 is 100 %), before it is rounded to a step of the control.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Level {
    ratio: f32,
}

/// Result of limiting a wanted override ratio to the bounds of the job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Bound {
    /// The ratio lies within the bounds.
    Free,
    /// The ratio is below the lower bound, which is used instead: the chip exceeds its target.
    Floor,
    /// The ratio is above the upper bound, which is used instead.
    Ceiling,
    /// The ratio is not a number; 100 % is used instead.
    NotANumber,
}

/// Reason why bounds, step or slew rates of the override are rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LimitsError {
    /// The lower bound is above 100 %, or the upper bound is below 100 % or above 254 %.
    Range,
    /// The step is zero, or does not divide 100 %.
    Step,
    /// A slew rate is not a positive number.
    Slew,
}

impl Ramp {
    /// Ramp with these bounds, step and slew rates.
    ///
    /// # Errors
    /// See [`LimitsError`].
    pub fn new(limits: &OverrideLimits) -> Result<Self, LimitsError> {
        let OverrideLimits { min_percent, max_percent, step_percent, .. } = *limits;
        if min_percent > 100 || !(100..=254).contains(&max_percent) {
            return Err(LimitsError::Range);
        }
        if step_percent == 0 || !100_u8.is_multiple_of(step_percent) {
            return Err(LimitsError::Step);
        }
        let positive = |slew: f32| slew > 0.0 && slew.is_finite();
        if !positive(limits.slew_up_percent_per_s) || !positive(limits.slew_down_percent_per_s) {
            return Err(LimitsError::Slew);
        }
        let per_us = |percent_per_s: f32| percent_per_s / PERCENT / US_PER_S as f32;
        Ok(Ramp {
            min_ratio: f32::from(min_percent) / PERCENT,
            max_ratio: f32::from(max_percent) / PERCENT,
            up_ratio_per_us: per_us(limits.slew_up_percent_per_s),
            down_ratio_per_us: -per_us(limits.slew_down_percent_per_s),
            steps_per_ratio: PERCENT * (1.0 + STEP_TOLERANCE_RATIO) / f32::from(step_percent),
            max_steps: u32::from(max_percent / step_percent),
            step_percent: u32::from(step_percent),
        })
    }

    /// Limits a wanted ratio to the bounds; returns it with the bound that was met.
    #[inline(always)]
    pub fn bounded(&self, ratio: f32) -> (f32, Bound) {
        if ratio > self.max_ratio {
            (self.max_ratio, Bound::Ceiling)
        } else if ratio >= self.min_ratio {
            (ratio, Bound::Free)
        } else if ratio < self.min_ratio {
            (self.min_ratio, Bound::Floor)
        } else {
            (1.0, Bound::NotANumber)
        }
    }

    /// The upper bound as a ratio, which also limits overrides without a law.
    pub fn max_ratio(&self) -> f32 {
        self.max_ratio
    }

    /// Moves the level towards the target ratio, by the upward slew rate for at most the time `rise`, or by the
    /// downward one for at most `fall`. If the target is NaN, the level becomes NaN, which is output as 0 %.
    #[inline(always)]
    pub fn slew(&self, level: &mut Level, target_ratio: f32, [rise, fall]: [Span; 2]) {
        let (rise, fall) = (self.up_ratio_per_us * rise.us(), self.down_ratio_per_us * fall.us());
        let way = target_ratio - level.ratio;
        // Uses the remaining difference, so that a level that reaches its target equals it exactly.
        level.ratio = if way > rise {
            level.ratio + rise
        } else if way < fall {
            level.ratio + fall
        } else {
            target_ratio
        };
    }

    /// The level rounded down to a step of the control, but not above the upper bound; 0 % for NaN.
    #[inline(always)]
    pub fn round_down(&self, level: &Level) -> FeedOverride {
        // The conversion drops the fraction of a step.
        let steps = (level.ratio * self.steps_per_ratio) as u32;
        FeedOverride { percent: (steps.min(self.max_steps) * self.step_percent) as u8 }
    }
}

impl Level {
    /// The level of this override.
    pub fn at(feed_override: FeedOverride) -> Self {
        Level { ratio: f32::from(feed_override.percent) / PERCENT }
    }

    /// The level as a ratio: 1 is 100 %.
    pub fn ratio(self) -> f32 {
        self.ratio
    }

    /// Lowers the level at once to this ratio if it is higher; zero if the ratio is negative.
    #[inline(always)]
    pub fn fall_to(&mut self, ceiling_ratio: f32) {
        self.ratio = fmath::min(self.ratio, fmath::max(ceiling_ratio, 0.0));
    }

    /// Lowers the level at once to this fraction of its value.
    pub fn fall_by(&mut self, share_ratio: f32) {
        self.fall_to(self.ratio * share_ratio);
    }

    /// Sets the level to zero at once.
    pub fn stop(&mut self) {
        self.ratio = 0.0;
    }

    /// Changes the level at once so that the actual feed stays the same when the programmed feed becomes
    /// `feed_change_ratio` times as large; the level does not fall below `safe_ratio`. The caller then lowers it to
    /// the target of the new block.
    pub fn carry(&mut self, feed_change_ratio: f32, safe_ratio: f32) {
        self.ratio = fmath::max(self.ratio / feed_change_ratio, safe_ratio);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK: Span = Span(1_000);

    fn ramp(limits: OverrideLimits) -> Ramp {
        Ramp::new(&limits).unwrap()
    }

    fn at(ratio: f32) -> Level {
        Level { ratio }
    }

    /// The override after `ms` ticks towards what is wanted.
    fn after(ramp: &Ramp, level: &mut Level, wanted: f32, ms: usize) -> u8 {
        for _ in 0..ms {
            ramp.slew(level, ramp.bounded(wanted).0, [TICK; 2]);
        }
        ramp.round_down(level).percent
    }

    #[test]
    fn it_rises_at_one_rate_and_falls_at_another() {
        let (ramp, mut level) = (ramp(OverrideLimits::default()), at(1.0));
        assert_eq!(after(&ramp, &mut level, 1.5, 505), 125);
        assert_eq!(after(&ramp, &mut level, 1.5, 505), 150);
        assert_eq!(after(&ramp, &mut level, 1.0, 122), 125);
    }

    #[test]
    fn half_the_tick_takes_the_same_time() {
        let ramp = ramp(OverrideLimits::default());
        let (mut whole, mut half) = (at(1.0), at(1.0));
        for _ in 0..100 {
            ramp.slew(&mut whole, 1.5, [Span(1_000); 2]);
            ramp.slew(&mut half, 1.5, [Span(500); 2]);
            ramp.slew(&mut half, 1.5, [Span(500); 2]);
        }
        assert!((whole.ratio - half.ratio).abs() < 1e-5);
    }

    #[test]
    fn a_tick_that_came_late_may_fall_further_than_it_may_rise() {
        let (ramp, mut level) = (ramp(OverrideLimits::default()), at(1.0));
        ramp.slew(&mut level, 2.0, [Span::from_ms(10), Span(u32::MAX)]);
        assert!((level.ratio - 1.005).abs() < 1e-6, "{level:?}");
        ramp.slew(&mut level, 0.1, [Span::from_ms(10), Span(u32::MAX)]);
        assert_eq!(level.ratio, 0.1);
    }

    #[test]
    fn it_rounds_to_the_thin_side_and_loses_no_step_to_rounding() {
        let round = |ratio, step_percent| {
            let limits = OverrideLimits { step_percent, ..OverrideLimits::default() };
            ramp(limits).round_down(&at(ratio)).percent
        };
        for (ratio, step_percent, percent) in [
            (1.019_9, 1, 101),
            (1.02 - f32::EPSILON, 1, 102),
            (1.0 - f32::EPSILON, 1, 100),
            (1.29, 10, 120),
            (0.09, 10, 0),
            (1.999_9, 100, 100),
        ] {
            assert_eq!(round(ratio, step_percent), percent, "{ratio} in steps of {step_percent}");
        }
    }

    #[test]
    fn nothing_is_put_out_beyond_max_whatever_the_level() {
        let ramp = ramp(OverrideLimits { max_percent: 254, step_percent: 4, ..OverrideLimits::default() });
        for (ratio, percent) in
            [(f32::INFINITY, 252), (f32::MAX, 252), (3.0, 252), (-1.0, 0), (f32::NEG_INFINITY, 0), (f32::NAN, 0)]
        {
            assert_eq!(ramp.round_down(&at(ratio)).percent, percent, "{ratio}");
        }
    }

    #[test]
    fn ratios_are_limited_to_the_bounds_and_nan_becomes_100_percent() {
        let ramp = ramp(OverrideLimits::default());
        for (wanted, bounded) in [
            (f32::INFINITY, (2.0, Bound::Ceiling)),
            (2.0, (2.0, Bound::Free)),
            (0.1, (0.1, Bound::Free)),
            (0.0, (0.1, Bound::Floor)),
            (f32::NEG_INFINITY, (0.1, Bound::Floor)),
            (f32::NAN, (1.0, Bound::NotANumber)),
        ] {
            assert_eq!(ramp.bounded(wanted), bounded, "{wanted}");
        }
    }

    #[test]
    fn a_target_that_is_no_number_puts_out_nothing() {
        let (ramp, mut level) = (ramp(OverrideLimits::default()), at(1.9));
        ramp.slew(&mut level, f32::NAN, [TICK; 2]);
        assert_eq!(ramp.round_down(&level).percent, 0);
        level.fall_to(1.0);
        assert_eq!(ramp.round_down(&level).percent, 100);
    }

    #[test]
    fn it_falls_at_once_where_that_is_asked_for_and_never_rises_so() {
        let mut level = at(1.5);
        level.fall_to(1.6);
        assert_eq!(level.ratio, 1.5);
        level.fall_to(1.2);
        assert_eq!(level.ratio, 1.2);
        level.fall_by(0.5);
        assert_eq!(level.ratio, 0.6);
        level.fall_to(-1.0);
        assert_eq!(level.ratio, 0.0);
    }

    #[test]
    fn a_block_boundary_keeps_the_feed_or_takes_what_is_safe() {
        let carried = |ratio: f32, feed_change_ratio: f32, safe_ratio: f32| {
            let mut level = at(ratio);
            level.carry(feed_change_ratio, safe_ratio);
            level.ratio
        };
        // Half the programmed feed: twice the ratio.
        assert_eq!(carried(1.25, 0.5, 1.0), 2.5);
        // A higher programmed feed begins at 100 %, or the operator's share, not below.
        assert_eq!(carried(1.2, 3.0, 1.0), 1.0);
        assert_eq!(carried(1.2, 3.0, 0.6), 0.6);
    }

    #[test]
    fn senseless_bounds_are_refused() {
        let limits = OverrideLimits::default();
        for (bad, error) in [
            (OverrideLimits { min_percent: 101, ..limits }, LimitsError::Range),
            (OverrideLimits { max_percent: 99, ..limits }, LimitsError::Range),
            (OverrideLimits { max_percent: 255, ..limits }, LimitsError::Range),
            (OverrideLimits { step_percent: 0, ..limits }, LimitsError::Step),
            (OverrideLimits { step_percent: 3, ..limits }, LimitsError::Step),
            (OverrideLimits { slew_up_percent_per_s: f32::NAN, ..limits }, LimitsError::Slew),
            (OverrideLimits { slew_down_percent_per_s: 0.0, ..limits }, LimitsError::Slew),
        ] {
            assert_eq!(Ramp::new(&bad), Err(error), "{bad:?}");
        }
    }
}
