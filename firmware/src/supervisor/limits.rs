//! The last stage: whatever decided, nothing leaves these bounds.
//!
//! The level put out lies between 0 and `max`, rises no faster than the slew, and is rounded down to the control's step.
//! It knows nothing of laws, so no law and no state can get around it. Only two things move it at once: a fall that the
//! caller says is due at once, and [`Limits::carry`] at a block boundary.

use arcfeed_shared::fmath;
use arcfeed_shared::job::OverrideLimits;
use arcfeed_shared::units::{PERCENT, Span};

use crate::ramp::{FeedOverride, Slew};

/// A level this little below a step counts as on it, %.
const STEP_TOLERANCE_PERCENT: f32 = 1e-3;

/// Bounds of what is put out; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    max_ratio: f32,
    step_percent: i32,
    steps_per_ratio: f32,
    step_tolerance: f32,
    slew: Slew,
    longest_tick: Span,
}

/// The ratio put out, before rounding; state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Level {
    ratio: f32,
}

impl Limits {
    /// Bounds that the ramp has validated.
    pub fn new(limits: &OverrideLimits, longest_tick: Span) -> Self {
        let step_percent = f32::from(limits.step_percent.max(1));
        Limits {
            max_ratio: f32::from(limits.max_percent.min(254)) / PERCENT,
            step_percent: i32::from(limits.step_percent.max(1)),
            steps_per_ratio: PERCENT / step_percent,
            step_tolerance: STEP_TOLERANCE_PERCENT / step_percent,
            slew: Slew::new(limits),
            longest_tick,
        }
    }

    /// Moves the level towards `target_ratio`, up and down by the slew.
    #[inline(always)]
    pub fn slew(&self, level: &mut Level, target_ratio: f32, dt: Span) {
        let target_ratio = self.within(level, target_ratio);
        level.ratio = self.slew.towards(level.ratio, target_ratio, [dt.min(self.longest_tick), dt]);
    }

    /// Moves the level towards `target_ratio`, down at once and up by the slew.
    #[inline(always)]
    pub fn follow(&self, level: &mut Level, target_ratio: f32, dt: Span) {
        let target_ratio = self.within(level, target_ratio);
        let rise = self.slew.rise(dt.min(self.longest_tick));
        // By the way that is left, as in `slew` and in the ramp: the least number above or below would tell them apart.
        level.ratio = if target_ratio - level.ratio > rise { level.ratio + rise } else { target_ratio };
    }

    /// Scales the level at a block boundary that keeps the feed.
    #[inline(always)]
    pub fn carry(&self, level: &mut Level, change_ratio: f32) {
        level.ratio = self.within(level, level.ratio * change_ratio);
    }

    /// The level as the control takes it, on the thin side.
    #[inline(always)]
    pub fn round(&self, level: &Level) -> FeedOverride {
        // At most 254 %: whole numbers serve, and the conversion drops what is left of a step.
        let steps = (level.ratio * self.steps_per_ratio + self.step_tolerance) as i32;
        FeedOverride { percent: (steps * self.step_percent) as u8 }
    }

    /// A target within the bounds; what is not a number raises nothing and asks for 100 % at most.
    #[inline(always)]
    fn within(&self, level: &Level, target_ratio: f32) -> f32 {
        if target_ratio >= 0.0 {
            fmath::min(target_ratio, self.max_ratio)
        } else if target_ratio < 0.0 {
            0.0
        } else {
            fmath::min(level.ratio, 1.0)
        }
    }
}

impl Level {
    /// The level that a whole override stands for.
    pub fn at(feed_override: FeedOverride) -> Self {
        Level { ratio: f32::from(feed_override.percent) / PERCENT }
    }

    /// The ratio put out, before rounding.
    pub fn ratio(self) -> f32 {
        self.ratio
    }

    /// Falls at once to `ceiling_ratio` if it lies above.
    pub fn fall_to(&mut self, ceiling_ratio: f32) {
        self.ratio = fmath::min(self.ratio, fmath::max(ceiling_ratio, 0.0));
    }

    /// Falls at once to this share of itself.
    pub fn fall_by(&mut self, share_ratio: f32) {
        self.fall_to(self.ratio * share_ratio);
    }

    /// Falls to zero at once.
    pub fn stop(&mut self) {
        self.ratio = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK: Span = Span(1_000);

    fn limits(step_percent: u8) -> Limits {
        Limits::new(&OverrideLimits { step_percent, ..OverrideLimits::default() }, Span::from_ms(10))
    }

    fn at(percent: u8) -> Level {
        Level::at(FeedOverride { percent })
    }

    #[test]
    fn it_rises_and_falls_no_faster_than_the_slew() {
        let (limits, mut level) = (limits(1), at(100));
        limits.slew(&mut level, 2.0, TICK);
        assert!((level.ratio - 1.000_5).abs() < 1e-6, "{level:?}");
        limits.slew(&mut level, 0.0, TICK);
        assert!((level.ratio - 0.998_5).abs() < 1e-6, "{level:?}");
        limits.follow(&mut level, 0.5, TICK);
        assert_eq!(level.ratio, 0.5);
    }

    #[test]
    fn a_tick_that_came_late_raises_no_further_than_the_longest_one() {
        let (limits, mut level) = (limits(1), at(100));
        limits.slew(&mut level, 2.0, Span(u32::MAX));
        assert!((level.ratio - 1.005).abs() < 1e-6, "{level:?}");
        limits.slew(&mut level, 0.1, Span(u32::MAX));
        assert_eq!(level.ratio, 0.1);
    }

    #[test]
    fn no_target_leaves_the_bounds() {
        let (limits, mut level) = (limits(1), at(100));
        for target in [f32::INFINITY, f32::MAX, 1e-45, -1e-45, f32::NEG_INFINITY, f32::NAN, -0.0] {
            limits.follow(&mut level, target, TICK);
            limits.carry(&mut level, target);
            assert!((0.0..=2.0).contains(&level.ratio), "{target}: {level:?}");
        }
        let mut level = at(180);
        limits.follow(&mut level, f32::NAN, TICK);
        assert_eq!(level.ratio, 1.0);
    }

    #[test]
    fn it_rounds_down_to_the_step() {
        assert_eq!(limits(1).round(&Level { ratio: 1.239_9 }).percent, 123);
        assert_eq!(limits(1).round(&Level { ratio: 1.24 - f32::EPSILON }).percent, 124);
        assert_eq!(limits(10).round(&Level { ratio: 1.29 }).percent, 120);
        assert_eq!(limits(10).round(&Level { ratio: 0.09 }).percent, 0);
    }
}
