//! Search for the largest safe acceleration between a safe one and an unsafe one.
//!
//! Near the bound a single braking decides. The secant method with halved ends ("Illinois") estimates its root; the
//! search then tries accelerations close to either side of it, and halves the interval if they do not end the search.
//! Every accepted acceleration has passed [`SpeedProfile::check`].
//!
//! Source: Dowell, Jarratt, A modified regula falsi method for computing the root of an equation, BIT 11 (1971).

use super::brake::{Brake, Motion};
use super::profile::{Ahead, EQUAL, Keep, SpeedProfile, Step};

/// Largest number of rounds: enough for halving alone.
const ROUNDS: usize = 26;
/// Relative to the initial interval: the width that ends the search, and the distance of trials from a root.
const NARROW_RATIO: f64 = 5e-8;
const ASIDE_RATIO: f64 = 2e-8;
/// Largest number of secants.
const SECANTS: usize = 6;

/// Interval of accelerations.
struct Interval<'a> {
    safe: f64,
    too_fast: f64,
    /// Period with the safe acceleration.
    best: Step,
    /// Span ahead that the unsafe acceleration reaches too fast.
    obstacle: Option<&'a Ahead>,
}

impl Interval<'_> {
    fn width(&self) -> f64 {
        (self.too_fast - self.safe).abs()
    }

    fn contains(&self, acceleration: f64) -> bool {
        (acceleration - self.safe) * (self.too_fast - acceleration) > 0.0
    }
}

impl SpeedProfile<'_> {
    /// Last safe period between two accelerations, if the first is safe.
    pub(super) fn between(&self, from: Motion, [first, last]: [f64; 2], keep: Keep) -> Option<Step> {
        let best = Some(self.with(from, first)).filter(|step| self.check(step, keep).is_ok())?;
        let obstacle = self.check(&self.with(from, last), keep).err().flatten();
        let mut interval = Interval { safe: first, too_fast: last, best, obstacle };
        let (narrow, aside) = (NARROW_RATIO * interval.width(), ASIDE_RATIO * (last - first));
        for _ in 0..ROUNDS {
            let width = interval.width();
            if width <= narrow {
                break;
            }
            // With a root at the safe end, only the other side is open.
            if let Some(root) = self.root(from, &interval, 0.1 * aside.abs()) {
                let before = root - aside;
                if !interval.contains(before) || self.narrow(from, &mut interval, before, keep) {
                    self.narrow(from, &mut interval, root + aside, keep);
                }
            }
            if interval.width() > 0.5 * width {
                let middle = 0.5 * (interval.safe + interval.too_fast);
                self.narrow(from, &mut interval, middle, keep);
            }
        }
        Some(interval.best)
    }

    /// Tries an acceleration; returns whether it is safe.
    fn narrow<'a>(&'a self, from: Motion, interval: &mut Interval<'a>, acceleration: f64, keep: Keep) -> bool {
        if !interval.contains(acceleration) {
            return false;
        }
        let step = self.with(from, acceleration);
        match self.check(&step, keep) {
            Ok(()) => {
                (interval.safe, interval.best) = (acceleration, step);
                true
            }
            Err(obstacle) => {
                (interval.too_fast, interval.obstacle) = (acceleration, obstacle);
                false
            }
        }
    }

    /// Acceleration in an interval with which the braking to the obstacle's speed fits exactly.
    fn root(&self, from: Motion, interval: &Interval<'_>, close: f64) -> Option<f64> {
        let ahead = interval.obstacle?;
        // Where braking begins, its length jumps; there the speed decides.
        let gets_too_fast = |step: &Step| step.motion.highest(ahead.limits_before.jerk) - ahead.speed;
        let is_slow_enough = gets_too_fast(&interval.best) <= 0.0;
        let room = |acceleration: f64| {
            let step = self.with(from, acceleration);
            if is_slow_enough {
                return -gets_too_fast(&step);
            }
            let brake = Brake::to(ahead.speed, step.motion, &ahead.limits_before);
            self.left(ahead) + EQUAL - step.distance - brake.map_or(0.0, |brake| brake.distance())
        };
        let (mut fits, mut fails) = (interval.safe, interval.too_fast);
        let (mut room_of_fits, mut room_of_fails) = (room(fits), room(fails));
        if room_of_fits < 0.0 || room_of_fails >= 0.0 {
            return None;
        }
        let (mut root, mut did_fit) = (fits, None);
        for _ in 0..SECANTS {
            let next = fails - room_of_fails * (fails - fits) / (room_of_fails - room_of_fits);
            let is_close = (next - root).abs() <= close;
            root = next;
            if is_close {
                break;
            }
            let room_of_root = room(root);
            let does_fit = room_of_root >= 0.0;
            let is_same_end = did_fit == Some(does_fit);
            if does_fit {
                (fits, room_of_fits) = (root, room_of_root);
                room_of_fails *= if is_same_end { 0.5 } else { 1.0 };
            } else {
                (fails, room_of_fails) = (root, room_of_root);
                room_of_fits *= if is_same_end { 0.5 } else { 1.0 };
            }
            did_fit = Some(does_fit);
        }
        Some(root)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drives::limits::PathLimits;
    use crate::drives::profile::secure;

    const HERE: PathLimits = PathLimits { speed: 100.0, acceleration: 500.0, jerk: 20_000.0, axis: None };
    const HALVINGS: usize = 40;

    fn ahead(at: f64, speed: f64) -> Ahead {
        let limits = PathLimits { speed, ..HERE };
        Ahead { at, speed, is_commanded_feed: false, safe: [0.0; 2], limits, limits_before: HERE }
    }

    fn halved(profile: &SpeedProfile<'_>, from: Motion, [mut safe, mut too_fast]: [f64; 2]) -> f64 {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (safe + too_fast);
            let is_safe = profile.check(&profile.with(from, middle), Keep::Limits).is_ok();
            if is_safe { safe = middle } else { too_fast = middle }
        }
        safe
    }

    /// If no span is reached within the period, the safe accelerations are an interval.
    #[test]
    fn the_search_ends_where_halving_alone_ends() {
        let mut stretches = [ahead(0.2, 30.0), ahead(0.5, 8.0), ahead(0.9, 60.0), ahead(2.5, 0.0)];
        secure(&mut stretches);
        let mut searched = 0;
        for at in 0..40 {
            for from in 0..400 {
                let from = Motion { speed: 0.1 * f64::from(from), acceleration: f64::from(from * 37 % 800) - 400.0 };
                let profile = SpeedProfile { period_s: 1e-3, at: 0.004 * f64::from(at), here: HERE, ahead: &stretches };
                let ends = [from.acceleration - 20.0, from.acceleration + 20.0];
                let Some(step) = profile.between(from, ends, Keep::Limits) else { continue };
                if profile.check(&profile.with(from, ends[1]), Keep::Limits).is_ok() {
                    continue;
                }
                assert!(profile.check(&step, Keep::Limits).is_ok(), "{from:?}");
                let lost = halved(&profile, from, ends) - step.motion.acceleration;
                assert!(lost <= 2.0 * NARROW_RATIO * 40.0, "{from:?}: {lost}");
                searched += 1;
            }
        }
        assert!(searched > 100, "{searched}");
    }
}
