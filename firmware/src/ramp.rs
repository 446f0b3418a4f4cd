//! From a wished ratio to an override the control can follow: clamp, slew, rounding to the thin side.
//!
//! No law can violate these bounds, because every law's wish passes through here. The slew bounds how fast the *feed*
//! changes. Where a new block brings another programmed feed, the ratio that keeps the feed is carried over, no lower
//! than 100 % (safe by policy), and a wish below it takes effect at once: a block boundary never thickens a chip.

use arcfeed_shared::fmath;
use arcfeed_shared::job::OverrideLimits;
use arcfeed_shared::machine::LimitedBy;
use arcfeed_shared::units::{PERCENT, Span, US_PER_S};

/// A wish this part below a step counts as on it: against losing a whole step to f32 rounding.
const STEP_TOLERANCE_RATIO: f32 = 5e-6;

/// An override as the control takes it, whole per cent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FeedOverride {
    /// 0 to 254.
    pub percent: u8,
}

impl FeedOverride {
    /// 100 %: the programmed feed.
    pub const PROGRAMMED: FeedOverride = FeedOverride { percent: 100 };
}

/// Validated bounds; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    min_ratio: f32,
    max_ratio: f32,
    min_percent: i32,
    step_percent: i32,
    /// Steps in a ratio of one, the tolerance included.
    steps_per_ratio: f32,
    slew: Slew,
}

/// How fast the ratio may change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slew {
    up_ratio_per_us: f32,
    /// Negative.
    down_ratio_per_us: f32,
}

/// The ratio in effect before rounding; state.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RampState {
    ratio: f32,
}

/// Which bound kept the override from the wish.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Bound {
    /// None.
    Free,
    /// The wish lies below `min`: the chip exceeds its target.
    Floor,
    /// The wish lies above `max`.
    Ceiling,
    /// The wish lies above what the machine can follow on this segment.
    Machine(LimitedBy),
    /// Still on its way.
    Slew,
    /// The wish is not a number: 100 %.
    NotANumber,
}

/// Why bounds are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LimitsError {
    /// `min` above 100, `max` below 100 or above 254.
    Range,
    /// A step of zero, or one that 100 is not a multiple of.
    Step,
    /// A slew that is not a positive number.
    Slew,
}

impl Default for RampState {
    fn default() -> Self {
        RampState { ratio: 1.0 }
    }
}

impl RampState {
    /// The ratio in effect.
    pub fn ratio(&self) -> f32 {
        self.ratio
    }

    /// Goes on from `ratio`, which the caller keeps within the bounds of what it puts out.
    pub fn force(&mut self, ratio: f32) {
        self.ratio = ratio;
    }
}

impl Slew {
    /// The slew of bounds that are positive numbers.
    pub fn new(limits: &OverrideLimits) -> Self {
        let per_us = |percent_per_s: f32| percent_per_s / PERCENT / US_PER_S as f32;
        Slew {
            up_ratio_per_us: per_us(limits.slew_up_percent_per_s),
            down_ratio_per_us: -per_us(limits.slew_down_percent_per_s),
        }
    }

    /// The largest rise in a span.
    #[inline(always)]
    pub fn rise(&self, dt: Span) -> f32 {
        self.up_ratio_per_us * dt.us()
    }

    /// From `ratio` towards a target, by no more than a rise and a fall in these spans.
    #[inline(always)]
    pub fn towards(&self, ratio: f32, target_ratio: f32, [rise, fall]: [Span; 2]) -> f32 {
        let (rise, fall) = (self.rise(rise), self.down_ratio_per_us * fall.us());
        let way = target_ratio - ratio;
        // By the way that is left: the least number above or below would tell two who arrive by it apart.
        if way > rise {
            ratio + rise
        } else if way < fall {
            ratio + fall
        } else {
            target_ratio
        }
    }
}

impl Ramp {
    /// Checks the bounds.
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
        let (min_ratio, max_ratio) = (f32::from(min_percent) / PERCENT, f32::from(max_percent) / PERCENT);
        Ok(Ramp {
            min_ratio,
            max_ratio,
            min_percent: i32::from(min_percent),
            step_percent: i32::from(step_percent),
            steps_per_ratio: PERCENT * (1.0 + STEP_TOLERANCE_RATIO) / f32::from(step_percent),
            slew: Slew::new(limits),
        })
    }

    /// Carries the state into a block whose programmed feed is `feed_change_ratio` times the one before.
    #[inline(always)]
    pub fn enter_block(&self, state: &mut RampState, wanted_ratio: f32, feed_change_ratio: f32) {
        let same_feed = fmath::max(state.ratio / feed_change_ratio, 1.0);
        state.ratio = self.at_bound(fmath::min(wanted_ratio, same_feed)).0;
    }

    /// One tick towards `wanted_ratio` (wanted feed / programmed feed).
    #[inline(always)]
    pub fn step(&self, state: &mut RampState, wanted_ratio: f32, dt: Span) -> (FeedOverride, Bound) {
        let (target_ratio, bound) = self.at_bound(wanted_ratio);
        let ratio = self.slew.towards(state.ratio, target_ratio, [dt; 2]);
        let arrives = ratio == target_ratio;
        state.ratio = ratio;
        (self.round_down(state), if arrives { bound } else { Bound::Slew })
    }

    #[inline(always)]
    fn at_bound(&self, ratio: f32) -> (f32, Bound) {
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

    /// The ratio in effect as the control takes it. The bounds leave 0 to 254, so whole numbers serve: the conversion drops what is left of a step.
    #[inline(always)]
    pub fn round_down(&self, state: &RampState) -> FeedOverride {
        let steps = (state.ratio * self.steps_per_ratio) as i32;
        FeedOverride { percent: (steps * self.step_percent).max(self.min_percent) as u8 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK: Span = Span(1_000);

    fn ramp() -> Ramp {
        Ramp::new(&OverrideLimits::default()).unwrap()
    }

    /// The override after `ms` ticks of the same wish.
    fn after(ramp: &Ramp, state: &mut RampState, wanted: f32, ms: usize) -> (u8, Bound) {
        let mut last = (FeedOverride::PROGRAMMED, Bound::Free);
        for _ in 0..ms {
            last = ramp.step(state, wanted, TICK);
        }
        (last.0.percent, last.1)
    }

    #[test]
    fn it_rises_at_one_rate_and_falls_at_another() {
        let (ramp, mut state) = (ramp(), RampState::default());
        assert_eq!(after(&ramp, &mut state, 1.5, 505), (125, Bound::Slew));
        assert_eq!(after(&ramp, &mut state, 1.5, 505), (150, Bound::Free));
        assert_eq!(after(&ramp, &mut state, 1.0, 122), (125, Bound::Slew));
    }

    #[test]
    fn half_the_tick_takes_the_same_time() {
        let ramp = ramp();
        let (mut whole, mut half) = (RampState::default(), RampState::default());
        for _ in 0..100 {
            ramp.step(&mut whole, 1.5, Span(1_000));
            ramp.step(&mut half, 1.5, Span(500));
            ramp.step(&mut half, 1.5, Span(500));
        }
        assert!((whole.ratio - half.ratio).abs() < 1e-5);
    }

    #[test]
    fn it_rounds_to_the_thin_side_and_loses_no_step_to_rounding() {
        let (ramp, mut state) = (ramp(), RampState::default());
        assert_eq!(after(&ramp, &mut state, 1.019_9, 1_000), (101, Bound::Free));
        assert_eq!(after(&ramp, &mut state, 1.02 - f32::EPSILON, 1_000), (102, Bound::Free));
        assert_eq!(after(&ramp, &mut state, 1.0 - f32::EPSILON, 1_000), (100, Bound::Free));
    }

    #[test]
    fn coarser_controls_get_coarser_steps() {
        let limits = OverrideLimits { step_percent: 10, ..OverrideLimits::default() };
        let (ramp, mut state) = (Ramp::new(&limits).unwrap(), RampState::default());
        assert_eq!(after(&ramp, &mut state, 1.29, 2_000), (120, Bound::Free));
    }

    #[test]
    fn wishes_beyond_the_bounds_end_there_and_say_so() {
        let (ramp, mut state) = (ramp(), RampState::default());
        assert_eq!(after(&ramp, &mut state, f32::INFINITY, 5_000), (200, Bound::Ceiling));
        assert_eq!(after(&ramp, &mut state, 0.0, 5_000), (10, Bound::Floor));
    }

    #[test]
    fn a_wish_that_is_not_a_number_is_no_wish() {
        let (ramp, mut state) = (ramp(), RampState::default());
        assert_eq!(after(&ramp, &mut state, f32::INFINITY, 5_000), (200, Bound::Ceiling));
        assert_eq!(after(&ramp, &mut state, f32::NAN, 5_000), (100, Bound::NotANumber));
    }

    #[test]
    fn a_block_boundary_keeps_the_feed_and_never_thickens_a_chip() {
        let ramp = ramp();
        let enter = |ratio: f32, wanted: f32, feed_change_ratio: f32| {
            let mut state = RampState { ratio };
            ramp.enter_block(&mut state, wanted, feed_change_ratio);
            state.ratio
        };
        // Half the programmed feed: the ratio may double at once, up to the wish.
        assert_eq!(enter(1.0, 1.25, 0.5), 1.25);
        assert_eq!(enter(1.0, 2.5, 0.5), 2.0);
        // A lower wish takes effect at once.
        assert_eq!(enter(1.5, 1.1, 1.0), 1.1);
        // A higher programmed feed starts at 100 %, which is safe by policy, not below.
        assert_eq!(enter(1.2, 1.3, 3.0), 1.0);
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
