//! How high the override may be along a segment, so that it is low enough in time for what the law demands further on.
//!
//! An override takes effect a time w after the controller has decided it, and falls by s a second at most. With the feed as
//! sent F, the ratio r(p) that the law demands at the path p, its largest r_max, the segment's length L and the ratio e that is
//! safe behind its end:
//!
//! ```text
//! b(p)^2 = min(r(p)^2, b(p + dp)^2 + 2 s dp / F)                                  (1)
//! ratio at p <= min of b from p to p + F r_max w                                  (2)
//! ratio at p <= sqrt(e^2 + 2 s (L - p - F r_max w) / F)                           (3)
//! ```
//!
//! (1) and (3) are v^2 = 2 a s for a ratio that falls evenly in time. b is kept at the borders of equal cells, and is straight
//! between them. Where r dips below that within a cell, as it does where it jumps, both borders take the dip.
//!
//! Source: docs/safety-case.md#transitions.

use arcfeed_shared::fmath;
use arcfeed_shared::job::OverrideLimits;
use arcfeed_shared::units::{MmPerMin, PERCENT, RevPerMin, S_PER_MIN};

use crate::law::{FeedLaw, NoWish, SegmentLaw};
use crate::progress::{Progress, Track};

/// Cells along a segment.
const CELLS: usize = 32;
/// Points asked in a cell, its beginning among them.
const POINTS: usize = 4;
/// From a decision to the feed that it makes, s: a tick, two scans of a ladder of 8 ms, the axes' own lag (assumed)
pub const RESPONSE_S: f32 = 0.03;
/// The part of the slew that (1) counts on: ticks come one by one.
const SLEW_SHARE: f32 = 0.9;
/// A dip below the straight line between two borders that is passed over, as a part.
const DIP_MAX: f32 = 1e-3;
/// What falls by less between two points falls evenly, as a part.
const JUMP_MIN: f32 = 3e-3;
/// Bounds are kept in hundredths of a per cent.
const STEPS_PER_RATIO: f32 = 1e4;
/// Above every override that there is.
const RATIO_MAX: f32 = 6.0;
/// Above a whole per cent by less than this, an override is that per cent.
const PERCENT_TOLERANCE: f32 = 0.01;

/// Upper bounds of the override along one segment, prepared with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Envelope {
    /// At the border before each cell and behind the last one, the whole cells of (2) considered.
    bounds: [u16; CELLS + 1],
    cells_per_mm: f32,
    /// What (2) reaches ahead beyond whole cells.
    ahead_cells: f32,
    /// e^2 in (3).
    end_squared: f32,
    /// L - F r_max w in (3).
    fallen_mm: f32,
    /// 2 s / F.
    fall_per_mm: f32,
    /// Spindle speed that the bounds are for; no speed is below it where they hold at any.
    spindle: RevPerMin,
}

/// What an envelope is worked out from.
#[derive(Clone, Copy, Debug)]
pub struct Sent {
    /// The feed as sent.
    pub feed: MmPerMin,
    /// Teeth over the feed, min/mm.
    pub teeth_min_per_mm: f32,
    /// Commanded spindle speed.
    pub spindle: RevPerMin,
    /// Largest ratio that the override, the machine and the job allow.
    pub max_ratio: f32,
    /// Largest override at the segment's end.
    pub end_percent: u8,
}

impl Envelope {
    /// No bound: no law moves the override.
    pub const FREE: Envelope = Envelope {
        bounds: [u16::MAX; CELLS + 1],
        cells_per_mm: 0.0,
        ahead_cells: 0.0,
        end_squared: f32::INFINITY,
        fallen_mm: 0.0,
        fall_per_mm: 0.0,
        spindle: RevPerMin(f32::NEG_INFINITY),
    };

    /// The bounds under a law.
    pub fn new(law: &SegmentLaw, track: &Track, sent: &Sent, limits: &OverrideLimits) -> Self {
        let is_free = matches!(law, SegmentLaw::Programmed) && sent.end_percent >= PERCENT as u8;
        if is_free || !fmath::is_positive(sent.spindle.0) {
            return Envelope::FREE;
        }
        let length_mm = track.length_mm();
        let cells_per_mm = if length_mm > 0.0 { CELLS as f32 / length_mm } else { 0.0 };
        let (mut ratios, is_refused) = sent.border_ratios(law, track, cells_per_mm);
        if is_refused && sent.end_percent >= PERCENT as u8 {
            return Envelope::FREE;
        }
        let feed_mm_per_s = sent.feed.0 / S_PER_MIN as f32;
        let fall_per_mm = 2.0 * SLEW_SHARE * limits.slew_down_percent_per_s / (PERCENT * feed_mm_per_s);
        let most = fmath::min(ratios.iter().copied().fold(1.0, fmath::max), sent.max_ratio);
        let response_mm = feed_mm_per_s * most * RESPONSE_S;
        let mut behind = f32::INFINITY;
        for ratio in ratios.iter_mut().rev() {
            behind = fmath::min(*ratio, behind);
            *ratio = behind;
            behind = fmath::sqrt(behind * behind + fall_per_mm * length_mm / CELLS as f32);
        } // (1)
        let response_cells = response_mm * cells_per_mm;
        let whole = fmath::min(response_cells, CELLS as f32) as usize;
        let mut bounds = [0; CELLS + 1];
        for (cell, bound) in bounds.iter_mut().enumerate() {
            let ahead = ratios.get(cell..=(cell + whole).min(CELLS)).unwrap_or_default();
            *bound = (ahead.iter().copied().fold(f32::INFINITY, fmath::min) * STEPS_PER_RATIO + 0.5) as u16;
        } // (2)
        let end_ratio = f32::from(sent.end_percent) / PERCENT;
        Envelope {
            bounds,
            cells_per_mm,
            ahead_cells: response_cells - whole as f32,
            end_squared: end_ratio * end_ratio,
            fallen_mm: length_mm - response_mm,
            fall_per_mm,
            spindle: sent.spindle,
        }
    }

    /// One bound for a whole segment on which the override does not act: ready for what follows.
    pub fn constant(percent: u8) -> Self {
        let ratio = f32::from(percent) / PERCENT;
        Envelope { end_squared: ratio * ratio, ..Envelope::FREE }
    }

    /// The largest override at the segment's beginning, %.
    pub fn begin_percent(&self) -> u8 {
        (self.ratio_at(0.0, RevPerMin(f32::INFINITY)) * PERCENT + PERCENT_TOLERANCE) as u8
    }

    /// How far below 1 the ratio must be behind the segment's end.
    pub fn reserve_ratio(&self) -> f32 {
        1.0 - fmath::sqrt(fmath::min(self.end_squared, 1.0))
    }

    /// The largest ratio at a path from the segment's start, at this spindle speed. A slower spindle scales all demands.
    #[inline(always)]
    pub fn ratio_at(&self, travelled_mm: f32, spindle: RevPerMin) -> f32 {
        let here = fmath::min(travelled_mm * self.cells_per_mm, CELLS as f32);
        let reached = fmath::min(here + self.ahead_cells, CELLS as f32);
        // Between the two there is one border at most.
        let steps = fmath::min(fmath::min(self.between(here), self.at(reached as usize)), self.between(reached));
        let least = steps / STEPS_PER_RATIO;
        let falling = self.end_squared + fmath::max(self.fallen_mm - travelled_mm, 0.0) * self.fall_per_mm;
        let ratio = if falling < least * least { fmath::sqrt(falling) } else { least }; // (3)
        if spindle.0 < self.spindle.0 { ratio * spindle.0 / self.spindle.0 } else { ratio }
    }

    #[inline(always)]
    fn at(&self, border: usize) -> f32 {
        let [.., last] = self.bounds;
        f32::from(self.bounds.get(border).copied().unwrap_or(last))
    }

    #[inline(always)]
    fn between(&self, place: f32) -> f32 {
        let cell = place as usize;
        let before = self.at(cell);
        before + (self.at(cell + 1) - before) * (place - cell as f32)
    }
}

impl Sent {
    /// The ratios that the law demands at the borders of the cells, lowered to what it demands between them, and whether it
    /// demands nothing anywhere.
    fn border_ratios(&self, law: &SegmentLaw, track: &Track, cells_per_mm: f32) -> ([f32; CELLS + 1], bool) {
        let mut is_refused = true;
        // Without a demand the feed as sent, within the job's limits.
        let unasked = fmath::min(1.0, self.max_ratio);
        let length_mm = track.length_mm();
        let step_mm = length_mm / (CELLS * POINTS) as f32;
        let mut progress = track.begin(0.0);
        let points: [f32; CELLS * POINTS + 1] = core::array::from_fn(|point| {
            if point > 0 {
                track.move_on(&mut progress, step_mm);
            }
            let ratio = self.ratio(law, track, &progress);
            is_refused &= ratio.is_none();
            ratio.unwrap_or(unasked)
        });
        let point = |index: usize| points.get(index).copied().unwrap_or(1.0);
        let mut ratios: [f32; CELLS + 1] = core::array::from_fn(|border| point(border * POINTS));
        let mut lower = |place: f32, ratio: f32| {
            let cell = (place as usize).min(CELLS - 1);
            let (before, behind) = (point(cell * POINTS), point((cell + 1) * POINTS));
            if ratio < (before + (behind - before) * (place - cell as f32)) * (1.0 - DIP_MAX) {
                for border in ratios.iter_mut().skip(cell).take(2) {
                    *border = fmath::min(*border, ratio);
                }
            }
        };
        for (index, ratio) in points.iter().enumerate() {
            let next = points.get(index + 1).unwrap_or(ratio);
            // Where it jumps between two points, it may do so right behind the first.
            let jumps = *next < ratio * (1.0 - JUMP_MIN);
            lower(index as f32 / POINTS as f32, if jumps { *next } else { *ratio });
        }
        law.knots_mm(&mut |knot_mm| {
            if knot_mm > 0.0 && knot_mm < length_mm {
                let mut progress = track.begin(0.0);
                // An arc turns by small angles only.
                let steps = 1 + (knot_mm / (8.0 * step_mm)) as usize;
                for _ in 0..steps {
                    track.move_on(&mut progress, knot_mm / steps as f32);
                }
                lower(knot_mm * cells_per_mm, self.ratio(law, track, &progress).unwrap_or(unasked));
            }
        });
        (ratios, is_refused)
    }

    /// What the law demands at a place; `None` where it demands nothing.
    fn ratio(&self, law: &SegmentLaw, track: &Track, progress: &Progress) -> Option<f32> {
        match law.wish(&track.place(progress)) {
            Ok(wish) => Some(fmath::min(self.spindle.0 * wish.path_mm_per_tooth * self.teeth_min_per_mm, RATIO_MAX)),
            Err(NoWish::ChipUnreachable) => Some(RATIO_MAX),
            Err(_) => None,
        }
    }
}

#[cfg(test)]
mod tests;
