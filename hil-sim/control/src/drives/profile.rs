//! Speed along a path, period by period: as fast as the limits allow while the axes can still brake for everything
//! ahead.
//!
//! A span ahead has a speed limit and a safe speed: from the safe speed, without acceleration, the axes can keep to all
//! limits behind it. A state is safe if a braking ([`Brake`]) ends at the safe speed of some span before it begins, and
//! brakings to the speeds of all spans before that one end before those. From a safe state the planner takes the
//! largest acceleration whose state a period later is safe. If even the smallest is not, it follows the braking itself,
//! which keeps a safe state safe, to the last fraction of a period. On a straight line this is the time-optimal profile
//! of seven phases, apart from the period's resolution. Nothing is planned beyond the period, so override, feed hold
//! and blocks that come late need no replanning.
//!
//! ```text
//! wanted speed w: in n periods T from acceleration n J T down to 0, v gains J T^2 n (n + 1)/2          (1)
//! ```
//!
//! Source: Beudaert, Lavernhe, Tournier, Int. J. Machine Tools & Manufacture 57 (2012), set the feedrate by the largest
//! reachable step that still allows a stop, found by bisection; safety by braking with constant A and J is ours.

use super::brake::{Brake, Motion, fastest_within, fits};
use super::limits::PathLimits;

/// Width of the interval of time that ends the halvings, as a fraction of a period.
const NARROW_RATIO: f64 = 1e-9;
/// Ratio of acceleration to speed below which the acceleration is set to zero. Halved every period, it would become
/// subnormal, which is slow on processors.
const NO_ACCELERATION_PER_S: f64 = 1e-290;
/// Distance within which Newton's root counts as found, as a fraction of a period.
const NEAR_RATIO: f64 = 1e-7;
/// Distances that differ by less are equal: far below a nanometre.
pub(super) const EQUAL: f64 = 1e-11;
/// Number of periods before a stop in which the planner follows the braking to it, and the tolerance of its end.
const LAST: f64 = 3.0;
const TIGHT: f64 = 1e-10;

/// Beginning of a slower span ahead: slower by the axes' limits from there on, or by the speed wanted there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ahead {
    /// Position of the beginning, on the scale of [`SpeedProfile::at`].
    pub(crate) at: f64,
    /// Speed to have there.
    pub(crate) speed: f64,
    /// Whether the speed is only wanted, by programmed feed and override, which may fall later than the axes can
    /// follow.
    pub(crate) is_commanded_feed: bool,
    /// Safe speeds there, set by [`secure`]: for the axes' limits behind it, and for the wanted speeds too.
    pub(crate) safe: [f64; 2],
    /// Limits from there on.
    pub(crate) limits: PathLimits,
    /// Acceleration and jerk allowed on the whole distance to it.
    pub(crate) limits_before: PathLimits,
}

/// Limits to keep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keep {
    /// Limits of the axes.
    Limits,
    /// Limits of the axes, and wanted speeds.
    CommandedFeeds,
}

/// Result of a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    /// Distance covered.
    pub(crate) distance: f64,
    /// Speed and acceleration at the end.
    pub(crate) motion: Motion,
    /// Remaining time, if the path ended before the period.
    pub(crate) left_s: f64,
    period_motion: PeriodMotion,
}

/// Motion during a period.
#[derive(Clone, Copy, Debug, PartialEq)]
enum PeriodMotion {
    Jerk(Motion, f64),
    Down(Brake),
}

/// Planner of a period.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpeedProfile<'a> {
    /// Length of the period, s.
    pub(crate) period_s: f64,
    /// Position of the axes along the path.
    pub(crate) at: f64,
    /// Limits of the span that the axes are on.
    pub(crate) here: PathLimits,
    /// Spans ahead in order, as far as the axes travel before they can rest, or up to the end of the known path: speed
    /// 0.
    pub(crate) ahead: &'a [Ahead],
}

impl SpeedProfile<'_> {
    /// Next period, towards the speed wanted here.
    pub(crate) fn step(&self, from: Motion, wanted: f64) -> Step {
        if let Some(last) = self.last(from) {
            return last;
        }
        let best = self.with(from, self.towards(from, wanted, &self.least()));
        let fast = self.fastest_safe(from, best, Keep::Limits);
        if let Some(fast) = fast.filter(|_| self.ahead.iter().all(|ahead| !ahead.is_commanded_feed)) {
            return fast;
        }
        let fast = fast.unwrap_or_else(|| self.hardest(from, best, Keep::Limits));
        let slow = self.fastest_safe(from, fast, Keep::CommandedFeeds);
        let slow = slow.unwrap_or_else(|| self.hardest(from, fast, Keep::CommandedFeeds));
        if slow == fast || self.is_safe(&slow, Keep::Limits) {
            return slow;
        }
        // A commanded feed must not be followed into braking that the limits ahead do not allow.
        self.between(from, [fast.motion.acceleration, slow.motion.acceleration], Keep::Limits).unwrap_or(fast)
    }

    /// Whether the axes can keep to their limits, from this motion.
    pub(crate) fn can_keep_limits(&self, from: Motion) -> bool {
        let here = Step { distance: 0.0, motion: from, left_s: 0.0, period_motion: PeriodMotion::Jerk(from, 0.0) };
        self.is_safe(&here, Keep::Limits)
    }

    /// Fastest safe period of constant jerk, no faster than `best`, if there is one.
    fn fastest_safe(&self, from: Motion, best: Step, keep: Keep) -> Option<Step> {
        if self.is_safe(&best, keep) {
            return Some(best);
        }
        let accelerations = [self.least_acceleration(from, &best), best.motion.acceleration];
        self.between(from, accelerations, keep)
    }

    /// Period if none of constant jerk is safe: braking, or the hardest deceleration.
    fn hardest(&self, from: Motion, best: Step, keep: Keep) -> Step {
        self.braking_step(from, keep).unwrap_or_else(|| self.with(from, self.least_acceleration(from, &best)))
    }

    /// Hardest deceleration that does not end in a speed below zero where less jerk is allowed.
    fn least_acceleration(&self, from: Motion, best: &Step) -> f64 {
        let hardest = PathLimits { jerk: self.least().jerk, ..self.here };
        self.towards(from, 0.0, &hardest).min(best.motion.acceleration)
    }

    /// Acceleration for a period on the way to a speed, without any limits ahead, braking within `braking`. (1)
    fn towards(&self, from: Motion, wanted: f64, braking: &PathLimits) -> f64 {
        let t = self.period_s;
        let gain = wanted - from.speed - 0.5 * from.acceleration * t;
        let of = |limits: &PathLimits| {
            let step = limits.jerk * t;
            let periods = gain.abs() / (step * t);
            let whole = libm::floor(0.5 * (libm::sqrt(1.0 + 8.0 * periods) - 1.0));
            let part = (periods - 0.5 * whole * (whole + 1.0)) / (whole + 1.0);
            (step * (whole + part)).min(limits.acceleration)
        };
        let aim = if gain < 0.0 { -of(braking) } else { of(&self.here) };
        let change = self.here.jerk * t;
        let next = aim.clamp(from.acceleration - change, from.acceleration + change);
        if next.abs() < NO_ACCELERATION_PER_S * from.speed { 0.0 } else { next }
    }

    /// Limits that all spans in view allow.
    fn least(&self) -> PathLimits {
        self.ahead.last().map_or(self.here, |last| last.limits_before.and(&last.limits).and(&self.here))
    }

    /// Period of constant jerk to that acceleration.
    pub(super) fn with(&self, from: Motion, acceleration: f64) -> Step {
        let jerk = (acceleration - from.acceleration) / self.period_s;
        let (distance, motion) = from.after(jerk, self.period_s);
        let motion = Motion { acceleration, ..motion };
        self.up_to_next(Step { distance, motion, left_s: 0.0, period_motion: PeriodMotion::Jerk(from, jerk) })
    }

    /// Period of braking.
    fn down(&self, brake: &Brake) -> Step {
        let (distance, motion) = brake.after(self.period_s);
        let left_s = if brake.ends_at_rest() { (self.period_s - brake.duration_s()).max(0.0) } else { 0.0 };
        self.up_to_next(Step { distance, motion, left_s, period_motion: PeriodMotion::Down(*brake) })
    }

    /// Ends the period at the beginning of the next span, because other limits hold behind it.
    fn up_to_next(&self, step: Step) -> Step {
        match self.ahead.first() {
            Some(next) if next.speed > 0.0 && self.left(next) + EQUAL < step.distance => {
                step.up_to(self.left(next), self.period_s)
            }
            _ => step,
        }
    }

    /// Last periods before a stop: those of the braking to it, if it ends there.
    fn last(&self, from: Motion) -> Option<Step> {
        let near = from.speed * LAST * self.period_s;
        let stop = self.ahead.last().filter(|ahead| ahead.speed == 0.0 && self.left(ahead) <= near)?;
        let brake = brake_to(0.0, stop, &from)?;
        let is_tight =
            (brake.distance() - self.left(stop)).abs() <= TIGHT && brake.duration_s() <= LAST * self.period_s;
        is_tight.then(|| self.down(&brake))
    }

    /// Distance to the beginning of a span.
    pub(super) fn left(&self, ahead: &Ahead) -> f64 {
        ahead.at - self.at
    }

    /// Spans ahead that `keep` includes, with their safe speeds.
    fn kept(&self, keep: Keep) -> impl DoubleEndedIterator<Item = (&Ahead, f64)> {
        let all = keep == Keep::CommandedFeeds;
        self.ahead
            .iter()
            .filter(move |ahead| all || !ahead.is_commanded_feed)
            .map(move |ahead| (ahead, ahead.safe[usize::from(all)]))
    }

    /// Whether all limits ahead can be kept, and the acceleration eases in time to what each span allows.
    fn is_safe(&self, step: &Step, keep: Keep) -> bool {
        self.check(step, keep).is_ok()
    }

    /// The same as [`SpeedProfile::is_safe`]; if a span is reached too fast, the error names it.
    pub(super) fn check(&self, step: &Step, keep: Keep) -> Result<(), Option<&Ahead>> {
        let Step { distance, motion, .. } = step;
        let left = |ahead: &Ahead| self.left(ahead) - distance;
        let arrives = |ahead: &Ahead| arrives(motion, &ahead.limits, left(ahead), self.here.jerk);
        let least = self.least();
        if motion.speed < 0.0 || !(eases(motion, &least) || self.ahead.iter().all(arrives)) {
            return Err(None);
        }
        // Every span before allows at least this jerk.
        let highest = motion.highest(least.jerk);
        let fits = |ahead: &Ahead, speed: f64| {
            highest <= speed || fits(speed, motion, &ahead.limits_before, left(ahead) + EQUAL)
        };
        let is_secure = |ahead: &Ahead, safe: f64| settles(motion, ahead) <= left(ahead).max(0.0) && fits(ahead, safe);
        let too_fast = self.kept(keep).find(|(ahead, _)| !fits(ahead, ahead.speed)).map(|(ahead, _)| ahead);
        // From the end, because the axes can mostly rest there.
        let is_reached = |ahead: &Ahead| too_fast.is_none_or(|too_fast| std::ptr::eq(ahead, too_fast));
        let mut reached = self.kept(keep).rev().skip_while(|(ahead, _)| !is_reached(ahead));
        if self.ahead.is_empty() || reached.any(|(ahead, safe)| is_secure(ahead, safe)) {
            return Ok(());
        }
        Err(too_fast)
    }

    /// Hardest of the brakings that make this state safe, for one period.
    fn braking_step(&self, from: Motion, keep: Keep) -> Option<Step> {
        let mut hardest: Option<Step> = None;
        for (ahead, safe) in self.kept(keep) {
            let (secure, left) = (brake_to(safe, ahead, &from), self.left(ahead));
            let is_secure =
                secure.is_none_or(|brake| brake.distance() <= left + 2.0 * EQUAL) && settles(&from, ahead) <= left;
            let brake = if is_secure { secure } else { brake_to(ahead.speed, ahead, &from) };
            if let Some(brake) = brake {
                let step = self.down(&brake);
                let is_harder = hardest.is_none_or(|hardest| step.motion.speed < hardest.motion.speed);
                if brake.distance() + step.distance >= left - EQUAL && is_harder {
                    hardest = Some(step);
                }
            }
            if is_secure {
                break;
            }
        }
        hardest
    }
}

impl Step {
    /// Whether the axes rest at its end.
    pub(crate) fn is_over(&self) -> bool {
        self.left_s > 0.0 || self.motion == Motion::default()
    }

    /// Part of the period up to a position; `duration_s` is the duration of the whole.
    fn up_to(&self, distance: f64, duration_s: f64) -> Step {
        let at = |t_s: f64| match &self.period_motion {
            PeriodMotion::Jerk(from, jerk) => from.after(*jerk, t_s),
            PeriodMotion::Down(brake) => brake.after(t_s),
        };
        // Newton's root replaces all halvings but the last few.
        let newton = |t_s: f64| {
            let (covered, motion) = at(t_s);
            t_s - (covered - distance) / motion.speed
        };
        let root_s = newton(newton(newton(duration_s)));
        let near_s = NEAR_RATIO * duration_s;
        let close = [root_s - near_s, root_s + near_s];
        let is_root =
            close[0] >= 0.0 && close[1] <= duration_s && at(close[0]).0 < distance && at(close[1]).0 >= distance;
        let [mut before, mut behind] = if is_root { close } else { [0.0, duration_s] };
        while behind - before > NARROW_RATIO * duration_s {
            let middle = 0.5 * (before + behind);
            if at(middle).0 < distance { before = middle } else { behind = middle }
        }
        let (distance, motion) = at(behind);
        Step { distance, motion, left_s: duration_s - behind, period_motion: self.period_motion }
    }
}

/// Sets the safe speeds from the end backwards, each such that the next can be reached. The end is a stop.
pub(crate) fn secure(ahead: &mut [Ahead]) {
    let mut behind: Option<Ahead> = None;
    for ahead in ahead.iter_mut().rev() {
        let fastest = |most: f64, keep: usize| match behind {
            Some(behind) => fastest_within(most, behind.safe[keep], behind.at - ahead.at, &ahead.limits),
            None => 0.0,
        };
        let limit = fastest(ahead.limits.speed, 0);
        let is_one = !ahead.is_commanded_feed && behind.is_none_or(|behind| behind.safe[0] == behind.safe[1]);
        ahead.safe = [limit, if is_one { limit } else { fastest(ahead.speed, 1) }];
        behind = Some(*ahead);
    }
}

/// Braking to a speed before a span begins, with the limits of the spans before it.
fn brake_to(speed: f64, ahead: &Ahead, from: &Motion) -> Option<Brake> {
    Brake::to(speed, *from, &ahead.limits_before)
}

/// Distance within which acceleration ends, before a span begins: a safe speed is one without acceleration.
fn settles(from: &Motion, ahead: &Ahead) -> f64 {
    if from.acceleration <= 0.0 {
        return 0.0;
    }
    let jerk = ahead.limits_before.jerk;
    from.after(-jerk, from.acceleration.max(0.0) / jerk).0
}

/// Whether the acceleration is already within the limits of all spans.
fn eases(motion: &Motion, least: &PathLimits) -> bool {
    let a = motion.acceleration;
    if a >= 0.0 { a <= least.acceleration } else { a >= -least.acceleration && motion.settles_at(least.jerk) >= 0.0 }
}

/// Whether the acceleration is within the limit of a span when it begins after `left`, easing at `jerk` before it; in
/// braking, whether a speed above zero remains there.
fn arrives(motion: &Motion, there: &PathLimits, left: f64, jerk: f64) -> bool {
    let a = motion.acceleration;
    if a >= 0.0 {
        let excess = (a - there.acceleration).max(0.0);
        return motion.after(-jerk, excess / jerk).0 <= left.max(0.0);
    }
    let allowed = a >= -there.acceleration && motion.settles_at(there.jerk) >= 0.0;
    allowed || motion.after(jerk, -a / jerk).0 <= left + EQUAL
}
