//! Estimate of the peer's clock from round trips.
//!
//! In a round trip, times a are by our clock and times b by the peer's: we send at a1, the peer receives at b1 and
//! answers at b2, we receive at a2. No frame arrives before it is sent. Therefore the offset O = b - a satisfies, for
//! any delays:
//!
//! ```text
//! b2 - a2 <= O <= b1 - a1                                                           (1)
//! ```
//!
//! The bounds of consecutive round trips are intersected, after the earlier ones were widened by the largest drift
//! since then (2). A delayed round trip gives wide bounds and changes nothing, so no outliers have to be rejected.
//! Disjoint bounds mean that a clock has stepped or drifts more than allowed; then the newer bounds replace the older
//! ones, and the step is counted. The upper bound gives the earliest time at which a frame can have been sent (3): an
//! age computed from it can only be too large.
//!
//! The drift is the slope of a line through the narrowest round trip of each second, with weights that fall by 1/30
//! per point (4), as in Klipper's `clocksync.py`. Points more than twice as wide as the narrowest so far are left out;
//! that width grows by 1/16 with each point.
//!
//! Clocks are compared modulo 2^32 us, differences within half of that: 35 minutes.

use arcfeed_units::{Micros, Span, US_PER_S};

use super::session::Echo;

const PPM: u64 = 1_000_000;
/// Time between two points of the line.
const WINDOW_US: u64 = US_PER_S;
/// Decay of the weight from point to point.
const DECAY: f64 = 1.0 / 30.0;
/// Number of points before a slope is reported.
const POINTS_MIN: u32 = 4;
const PPB_PER_ONE: f64 = 1e9;

/// Bounds of the offset, and the time at which they were determined.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    at: Micros,
    low: u32,
    width: u32,
}

/// Estimate of the difference between the peer's clock and ours: bounds that certainly hold it, and its drift.
#[derive(Clone, Copy, Debug)]
pub struct PeerClock {
    drift_max_ppm: u32,
    bounds: Option<Bounds>,
    steps: u32,
    line: Line,
}

impl PeerClock {
    /// Estimate before the first round trip. `drift_max_ppm` is the largest difference of the two clocks' rates, in
    /// microseconds per second.
    pub const fn new(drift_max_ppm: u32) -> Self {
        PeerClock { drift_max_ppm, bounds: None, steps: 0, line: Line::NEW }
    }

    /// Updates the estimate with a frame that arrived `now` (our clock) and was sent at `theirs_us` (the peer's
    /// clock), and that echoes the time stamp of a frame of ours. Returns the time of the round trip without the time
    /// for which the peer held the echo; `None` for an echo that is impossible.
    pub fn on_echo(&mut self, now: Micros, theirs_us: u32, echo: Echo) -> Option<Span> {
        let there_and_back = low_bits(now).wrapping_sub(echo.t_us);
        let width = there_and_back.wrapping_sub(echo.held_us);
        // The echo lies in the future, or was held for longer than the round trip.
        if there_and_back > i32::MAX as u32 || width > i32::MAX as u32 {
            return None;
        }
        let low = theirs_us.wrapping_sub(low_bits(now)); // (1)
        let new = Bounds { at: now, low, width: width.saturating_add(self.drift(there_and_back)) };
        let known = self.bounds_at(now);
        self.bounds = Some(known.and_then(|known| known.intersected(&new)).unwrap_or(new));
        if known.is_some_and(|known| known.intersected(&new).is_none()) {
            self.steps = self.steps.wrapping_add(1);
            self.line = Line::NEW;
        }
        self.line.on_round_trip(now, low.wrapping_add(width / 2), width);
        Some(Span(width))
    }

    /// Earliest instant, by our clock, at which the peer's clock can have shown `theirs_us`; not after `now`. `None`
    /// before the first round trip.
    pub fn earliest(&self, now: Micros, theirs_us: u32) -> Option<Micros> {
        let bounds = self.bounds_at(now)?;
        let ours = theirs_us.wrapping_sub(bounds.low.wrapping_add(bounds.width)); // (3)
        Some(before(now, ours))
    }

    /// Most likely instant, by our clock, at which the peer's clock showed `theirs_us`; not after `now`. `None` before
    /// the first round trip.
    pub fn to_ours(&self, now: Micros, theirs_us: u32) -> Option<Micros> {
        let bounds = self.bounds_at(now)?;
        Some(before(now, theirs_us.wrapping_sub(bounds.low.wrapping_add(bounds.width / 2))))
    }

    /// Largest possible error of [`Self::to_ours`] at `now`; `None` before the first round trip.
    pub fn uncertainty(&self, now: Micros) -> Option<Span> {
        self.bounds_at(now).map(|bounds| Span(bounds.width.div_ceil(2)))
    }

    /// Rate of the peer's clock relative to ours, in nanoseconds per second; positive if the peer's runs faster.
    /// `None` in the first four seconds.
    pub fn drift_ppb(&self) -> Option<i32> {
        self.line.slope().map(|slope| libm::round(slope * PPB_PER_ONE) as i32)
    }

    /// Number of times that the peer's clock was found to have stepped, or to drift more than allowed; wraps around.
    pub const fn steps(&self) -> u32 {
        self.steps
    }

    /// The bounds, widened to `now`.
    fn bounds_at(&self, now: Micros) -> Option<Bounds> {
        let Bounds { at, low, width } = self.bounds?;
        let drift = self.drift(Span::from(now.since(at)).0);
        let width = width.saturating_add(drift.saturating_mul(2)).min(i32::MAX as u32);
        Some(Bounds { at: now, low: low.wrapping_sub(drift), width }) // (2)
    }

    /// Largest drift over a time, rounded up.
    fn drift(&self, span_us: u32) -> u32 {
        let drift = (u64::from(span_us) * u64::from(self.drift_max_ppm)).div_ceil(PPM);
        u32::try_from(drift).unwrap_or(u32::MAX)
    }
}

impl Bounds {
    /// Intersection of two bounds; `None` if they are disjoint.
    fn intersected(&self, other: &Bounds) -> Option<Bounds> {
        let shift = i64::from(other.low.wrapping_sub(self.low) as i32);
        let low = shift.max(0);
        let high = i64::from(self.width).min(shift + i64::from(other.width));
        let width = u32::try_from(high - low).ok()?;
        Some(Bounds { at: other.at, low: self.low.wrapping_add(low as u32), width })
    }
}

fn low_bits(at: Micros) -> u32 {
    at.0 as u32
}

/// Latest instant up to `now` with these low bits; `now` if they lie in the future.
fn before(now: Micros, low: u32) -> Micros {
    let age = low_bits(now).wrapping_sub(low) as i32;
    Micros(now.0.saturating_sub(u64::from(age.max(0) as u32)))
}

/// Regression line of the offset over time.
#[derive(Clone, Copy, Debug)]
struct Line {
    /// Narrowest round trip of this window: time, offset, width.
    best: Option<(Micros, u32, u32)>,
    window_ends: Micros,
    /// Width of the narrowest round trip so far; it grows with time.
    least_width: u32,
    /// Last point: origin of the next one.
    last: Option<(Micros, u32)>,
    points: u32,
    /// Means of time and offset relative to the last point, their variance and covariance, in seconds.
    mean_s: [f64; 2],
    variance: f64,
    covariance: f64,
}

impl Line {
    const NEW: Line = Line {
        best: None,
        window_ends: Micros(0),
        least_width: u32::MAX,
        last: None,
        points: 0,
        mean_s: [0.0; 2],
        variance: 0.0,
        covariance: 0.0,
    };

    fn on_round_trip(&mut self, now: Micros, offset: u32, width: u32) {
        if let Some((at, offset, width)) = self.best.filter(|_| now >= self.window_ends) {
            let is_narrow = width / 2 <= self.least_width;
            self.least_width = self.least_width.saturating_add(self.least_width / 16).min(width);
            if is_narrow {
                self.add(at, offset);
            }
            self.best = None;
        }
        if self.best.is_none() {
            self.window_ends = now.after(Micros(WINDOW_US));
        }
        if self.best.is_none_or(|(_, _, least)| width < least) {
            self.best = Some((now, offset, width));
        }
    }

    /// Adds a point, which becomes the new origin.
    fn add(&mut self, at: Micros, offset: u32) {
        if let Some((last_at, last_offset)) = self.last {
            let time_s = at.since(last_at).to_s();
            let offset_s = f64::from(offset.wrapping_sub(last_offset) as i32) / US_PER_S as f64;
            let [mean_time_s, mean_offset_s] = self.mean_s;
            // Difference of the new point from the old means.
            let (ahead_s, off_s) = (time_s - mean_time_s, offset_s - mean_offset_s);
            // The first points have equal weights.
            let weight = DECAY.max(1.0 / f64::from(self.points.saturating_add(1)));
            self.variance = (1.0 - weight) * (self.variance + weight * ahead_s * ahead_s); // (4)
            self.covariance = (1.0 - weight) * (self.covariance + weight * ahead_s * off_s); // (4)
            self.mean_s = [-ahead_s * (1.0 - weight), -off_s * (1.0 - weight)];
        }
        self.last = Some((at, offset));
        self.points = self.points.saturating_add(1);
    }

    fn slope(&self) -> Option<f64> {
        (self.points >= POINTS_MIN && self.variance > 0.0).then(|| self.covariance / self.variance)
    }
}

#[cfg(test)]
mod tests;
