//! Shortest braking to a speed under limits of acceleration and jerk: acceleration ramps down, holds, ramps back to
//! zero.
//!
//! From speed v and acceleration a to the speed c, with the deceleration d held for the time h:
//!
//! ```text
//! a to -d at -J,  -d for h,  -d to 0 at +J
//! d = min(sqrt(J (v - c) + a^2/2), A)           (1)
//! h: what of v - c both ramps leave, over d     (2)
//! ```
//!
//! Source: the jerk-limited profile of Erkorkmaz, Altintas, High speed CNC system design, part I, Int. J. Machine Tools &
//! Manufacture 41 (2001).

use super::limits::PathLimits;

/// Fraction of a distance that counts when it must suffice in spite of rounding.
const SURE_RATIO: f64 = 0.99;
/// Relative differences and distances below this are too close to decide without the exact sum.
const CLOSE_RATIO: f64 = 1e-6;
const CLOSE: f64 = 1e-6;

/// Speed and acceleration along the path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Motion {
    /// Speed; never negative.
    pub(crate) speed: f64,
    /// Acceleration.
    pub(crate) acceleration: f64,
}

impl Motion {
    /// Distance and motion after `t_s` of constant jerk.
    pub(crate) fn after(&self, jerk: f64, t_s: f64) -> (f64, Motion) {
        let Motion { speed, acceleration } = *self;
        let distance = ((jerk * t_s / 6.0 + acceleration / 2.0) * t_s + speed) * t_s;
        let speed = (jerk * t_s / 2.0 + acceleration) * t_s + speed;
        (distance, Motion { speed, acceleration: acceleration + jerk * t_s })
    }

    /// Highest speed reached when acceleration is ended now.
    pub(crate) fn highest(&self, jerk: f64) -> f64 {
        if self.acceleration > 0.0 { self.settles_at(jerk) } else { self.speed }
    }

    /// Speed after the remaining acceleration or deceleration has been ramped to zero.
    pub(crate) fn settles_at(&self, jerk: f64) -> f64 {
        self.speed + 0.5 * self.acceleration * self.acceleration.abs() / jerk
    }
}

/// Braking in phases of constant jerk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Brake {
    from: Motion,
    to: f64,
    /// Jerk and duration, s.
    phases: [(f64, f64); 3],
    /// Phase after the end, if deceleration is not zero there.
    tail: (f64, f64),
}

impl Brake {
    /// Braking to `speed`; `None` if the motion never exceeds it.
    pub(crate) fn to(speed: f64, from: Motion, limits: &PathLimits) -> Option<Brake> {
        let PathLimits { acceleration: most, jerk, .. } = *limits;
        if from.highest(jerk) <= speed {
            return None;
        }
        if from.settles_at(jerk) <= speed {
            let until_s = until(speed, &from, jerk);
            let tail = (jerk, -from.acceleration / jerk - until_s);
            return Some(Brake { from, to: speed, phases: [(jerk, until_s), (0.0, 0.0), (0.0, 0.0)], tail });
        }
        let a = from.acceleration;
        let peak = libm::sqrt((jerk * (from.speed - speed) + 0.5 * a * a).max(0.0)).min(most); // (1)
        // If deceleration exceeds the limit here, it eases first.
        let turn = if a < -peak { jerk } else { -jerk };
        let ramp_s = (-peak - a) / turn;
        let held = from.speed + 0.5 * (a - peak) * ramp_s - 0.5 * peak * peak / jerk - speed;
        let hold_s = if peak > 0.0 { (held / peak).max(0.0) } else { 0.0 }; // (2)
        let first = (turn, ramp_s);
        Some(Brake { from, to: speed, phases: [first, (0.0, hold_s), (jerk, peak / jerk)], tail: (0.0, 0.0) })
    }

    /// Duration.
    pub(crate) fn duration_s(&self) -> f64 {
        self.phases.iter().map(|(_, duration_s)| duration_s).sum()
    }

    /// Whether the axes rest at its end.
    pub(crate) fn ends_at_rest(&self) -> bool {
        self.to == 0.0
    }

    /// Braking distance.
    pub(crate) fn distance(&self) -> f64 {
        self.phases.iter().fold((0.0, self.from), |done, phase| add_phase(done, *phase)).0
    }

    /// Distance and motion after `t_s`; the speed stays constant after the end.
    pub(crate) fn after(&self, t_s: f64) -> (f64, Motion) {
        let (mut done, mut left_s) = ((0.0, self.from), t_s);
        for (jerk, duration_s) in self.phases.into_iter().chain([self.tail]) {
            done = add_phase(done, (jerk, duration_s.min(left_s)));
            left_s = (left_s - duration_s).max(0.0);
        }
        let (distance, motion) = done;
        (distance + motion.speed * left_s, motion)
    }
}

/// Adds a phase of constant jerk to the distance and motion so far.
fn add_phase((distance, motion): (f64, Motion), (jerk, duration_s): (f64, f64)) -> (f64, Motion) {
    if duration_s == 0.0 {
        return (distance, motion);
    }
    let (covered, motion) = motion.after(jerk, duration_s);
    (distance + covered, motion)
}

/// Fastest speed without acceleration from which braking to another speed fits into a distance.
///
/// ```text
/// 2 L = (v + u) ((v - u)/A + A/J)     where v - u >= A^2/J        (3)
/// L sqrt(J) = w^3 + 2 u w             else, w^2 = v - u           (4)
/// ```
pub(crate) fn fastest_into(speed: f64, distance: f64, limits: &PathLimits) -> f64 {
    let PathLimits { acceleration, jerk, .. } = *limits;
    if distance <= 0.0 {
        return speed;
    }
    let half = 0.5 * acceleration * acceleration / jerk;
    let fast = libm::sqrt((speed - half) * (speed - half) + 2.0 * distance * acceleration) - half; // (3)
    if fast - speed >= 2.0 * half {
        return fast;
    }
    let (p, q) = (2.0 * speed, distance * libm::sqrt(jerk));
    let third = libm::sqrt(p / 3.0);
    // Cardano's root, by sinh; braking to rest has p = 0.
    let root =
        if p > 0.0 { 2.0 * third * libm::sinh(libm::asinh(q / (2.0 * third * third * third)) / 3.0) } else { 0.0 };
    let root = if root > 0.0 { root } else { libm::cbrt(q) };
    speed + root * root // (4)
}

/// The same as [`fastest_into`], limited to `most`.
pub(crate) fn fastest_within(most: f64, speed: f64, distance: f64, limits: &PathLimits) -> f64 {
    let gain = most - speed;
    // The root is computed only if it decides.
    let is_enough = || gain > CLOSE_RATIO * most && braking_distance(most, speed, limits) < SURE_RATIO * distance;
    if gain <= 0.0 || is_enough() { most } else { fastest_into(speed, distance, limits).min(most) }
}

/// Braking distance from one speed to another, without acceleration at either: (3) and (4) solved for L.
fn braking_distance(from: f64, to: f64, limits: &PathLimits) -> f64 {
    let PathLimits { acceleration, jerk, .. } = *limits;
    let loss = from - to;
    if loss >= acceleration * acceleration / jerk {
        return 0.5 * (from + to) * (loss / acceleration + acceleration / jerk);
    }
    (from + to) * libm::sqrt(loss / jerk)
}

/// Whether the braking distance to a speed is at most `left`.
pub(crate) fn fits(speed: f64, from: &Motion, limits: &PathLimits, left: f64) -> bool {
    let exactly = || Brake::to(speed, *from, limits).is_none_or(|brake| brake.distance() <= left);
    surely_fits(speed, from, limits, left).unwrap_or_else(exactly)
}

/// The same as [`fits`], for all cases that need no root: all but close ones.
///
/// On its ramp of acceleration a motion comes from a crest without acceleration, or goes to one, t = |a|/J away:
///
/// ```text
/// v' = v + |a| t/2        s' = +-(v + |a| t/3) t                              (5)
/// ```
///
/// and the braking distance is s' plus that from the crest, by (3) and (4) without their roots.
pub(crate) fn surely_fits(speed: f64, from: &Motion, limits: &PathLimits, left: f64) -> Option<bool> {
    let PathLimits { acceleration: most, jerk, .. } = *limits;
    let a = from.acceleration.abs();
    if from.highest(jerk) <= speed {
        return Some(true);
    }
    let ramp_s = a / jerk;
    let (crest, distance) = (from.speed + 0.5 * a * ramp_s, (from.speed + a * ramp_s / 3.0) * ramp_s); // (5)
    let is_braking = from.acceleration < 0.0;
    let (loss, room) = (crest - speed, if is_braking { left + distance } else { left - distance });
    let eases = is_braking && (a > most || from.speed - 0.5 * a * ramp_s <= speed);
    if eases || loss < CLOSE_RATIO * crest || room.abs() < CLOSE {
        return None;
    }
    if room < 0.0 {
        return Some(false);
    }
    let (needed, there) = if loss * jerk >= most * most {
        (0.5 * (crest + speed) * (loss * jerk + most * most), room * most * jerk)
    } else {
        ((crest + speed) * (crest + speed) * loss, jerk * room * room)
    };
    let is_close = (needed - there).abs() <= CLOSE_RATIO * there;
    (!is_close).then_some(needed < there)
}

/// Shortest time for a distance that begins at a speed without acceleration, with a speed of at most `most`.
pub(crate) fn time_s(speed: f64, distance: f64, most: f64, limits: &PathLimits) -> f64 {
    let PathLimits { acceleration, jerk, .. } = *limits;
    let reached = fastest_into(speed, distance, limits).min(most).max(speed);
    let gain = reached - speed;
    let ramp_s = if gain >= acceleration * acceleration / jerk {
        gain / acceleration + acceleration / jerk
    } else {
        2.0 * libm::sqrt(gain / jerk)
    };
    ramp_s + (distance - 0.5 * (speed + reached) * ramp_s) / reached
}

/// Time after which easing at `jerk` reaches `speed`.
fn until(speed: f64, from: &Motion, jerk: f64) -> f64 {
    let root = libm::sqrt((from.acceleration * from.acceleration - 2.0 * jerk * (from.speed - speed)).max(0.0));
    (-from.acceleration - root) / jerk
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: PathLimits = PathLimits { speed: 100.0, acceleration: 500.0, jerk: 20_000.0, axis: None };

    #[test]
    fn braking_ends_at_its_speed_without_acceleration() {
        for speed in [0.0, 3.0, 40.0] {
            for from in [(50.0, 0.0), (50.0, 400.0), (50.0, -300.0), (90.0, 500.0), (41.0, 10.0), (90.0, -900.0)] {
                let from = Motion { speed: from.0, acceleration: from.1 };
                let Some(brake) = Brake::to(speed, from, &LIMITS) else { continue };
                let (_, end) = brake.after(brake.duration_s());
                assert!((end.speed - speed).abs() < 1e-9, "{from:?} to {speed}: {end:?}");
                let eases = from.settles_at(LIMITS.jerk) <= speed;
                assert!(end.acceleration.abs() < 1e-9 || eases, "{from:?} to {speed}: {end:?}");
            }
        }
    }

    /// Without initial acceleration, reaching the limit of deceleration: v^2/2A + v A/2J.
    #[test]
    fn long_braking_has_the_distance_of_the_closed_form() {
        let speed = 60.0;
        let brake = Brake::to(0.0, Motion { speed, acceleration: 0.0 }, &LIMITS).unwrap();
        let distance = speed * speed / (2.0 * 500.0) + speed * 500.0 / (2.0 * 20_000.0);
        assert!((brake.distance() - distance).abs() < 1e-12);
    }

    /// Without reaching that limit: v sqrt(v/J).
    #[test]
    fn short_braking_has_the_distance_of_the_closed_form() {
        let speed = 5.0;
        let brake = Brake::to(0.0, Motion { speed, acceleration: 0.0 }, &LIMITS).unwrap();
        assert!((brake.distance() - speed * libm::sqrt(speed / 20_000.0)).abs() < 1e-12);
    }

    #[test]
    fn braking_from_the_fastest_speed_uses_the_whole_distance() {
        for speed in [0.0, 1e-9, 0.3, 7.0, 80.0] {
            for distance in [1e-6, 1e-3, 0.4, 5.0, 90.0] {
                let from = Motion { speed: fastest_into(speed, distance, &LIMITS), acceleration: 0.0 };
                let took = Brake::to(speed, from, &LIMITS).unwrap().distance();
                // Rounding of the speeds limits their difference.
                let rounding =
                    4.0 * f64::EPSILON * from.speed * from.speed / libm::sqrt((from.speed - speed) * LIMITS.jerk);
                assert!((took - distance).abs() < 1e-9 * distance + rounding, "{distance} to {speed}: {took}");
            }
        }
    }

    #[test]
    fn braking_in_parts_has_the_same_distance() {
        let from = Motion { speed: 60.0, acceleration: 300.0 };
        let brake = Brake::to(2.0, from, &LIMITS).unwrap();
        let (first, middle) = brake.after(0.05);
        let rest = Brake::to(2.0, middle, &LIMITS).unwrap();
        assert!((first + rest.distance() - brake.distance()).abs() < 1e-9);
    }

    #[test]
    fn decisions_without_a_root_agree_with_the_exact_distance() {
        let (mut decided, mut all) = (0, 0);
        for speed in [0.0, 1e-9, 3.0, 40.0, 59.0] {
            for from in [0.0, 1e-7, 3.1, 41.0, 60.0, 99.0] {
                for acceleration in [-900.0, -500.0, -300.0, -1e-5, 0.0, 10.0, 499.0] {
                    let from = Motion { speed: from, acceleration };
                    let Some(brake) = Brake::to(speed, from, &LIMITS) else { continue };
                    for ratio in [0.0, 0.5, 0.9999, 0.999_999_9, 1.0, 1.000_000_1, 1.0001, 2.0] {
                        let left = brake.distance() * ratio;
                        let surely = surely_fits(speed, &from, &LIMITS, left);
                        assert!(
                            surely.is_none_or(|fits| fits == (brake.distance() <= left)),
                            "{from:?} to {speed}: {left}"
                        );
                        (decided, all) = (decided + usize::from(surely.is_some()), all + 1);
                    }
                }
            }
        }
        // The remaining cases are close, or ease.
        assert!(3 * decided > all, "{decided} of {all}");
    }

    #[test]
    fn the_fastest_speed_within_a_bound_is_the_lower_of_both() {
        for speed in [0.0, 1e-9, 0.3, 7.0, 80.0] {
            for distance in [0.0, 1e-6, 1e-3, 0.4, 5.0, 90.0] {
                let fastest = fastest_into(speed, distance, &LIMITS);
                for most in [0.5, 0.99, 1.0 - 1e-12, 1.0, 1.0 + 1e-12, 1.01, 2.0].map(|ratio| ratio * fastest) {
                    assert_eq!(
                        fastest_within(most, speed, distance, &LIMITS),
                        fastest.min(most),
                        "{distance} to {speed}: {most}"
                    );
                }
            }
        }
    }
}
