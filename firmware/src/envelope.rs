//! Envelope: the largest ratio of wanted to sent feed along a segment from which the override can still fall in time
//! to later demands.
//!
//! An override takes effect a time w after the controller has decided it, and falls by at most s per second. With the
//! sent feed F, the ratio r(p) that the law demands at the path p, its maximum r_max, the segment's length L and the
//! safe ratio e after its end:
//!
//! ```text
//! b(p)^2 = min(r(p)^2, b(p + dp)^2 + 2 s dp / F)                                  (1)
//! ratio at p <= min of b from p to p + F r_max w                                  (2)
//! ratio at p <= sqrt(e^2 + 2 s (L - p - F r_max w) / F)                           (3)
//! ```
//!
//! (1) and (3) are v^2 = 2 a s for a ratio that falls linearly in time. The law is evaluated when the segment is
//! prepared, at the borders of equal cells; the tick interpolates. So that no interpolated ratio exceeds the law's
//! demand, even at bends and jumps, a border has the smallest b of the cells on both sides and of all cells within the
//! reach of (2). This is valid as long as the demand has no minimum within a cell; the knots of a law are known
//! minima, which both borders of the cell include.
//!
//! Source: docs/safety-case.md#transitions.

use core::cell::Cell;

use arcfeed_model::job::OverrideLimits;
use arcfeed_units::fmath;
use arcfeed_units::{MmPerMin, PERCENT, RevPerMin, S_PER_MIN};

use crate::progress::Track;
use arcfeed_law::{FeedLaw, NoDemand, Place, SegmentLaw};

/// Cells along a segment.
const CELLS: usize = 128;
/// Assumed time from a decision of the controller to the feed that it causes, s: a tick, two scans of 8 ms of the
/// machine's PLC, and the lag of the axes.
pub const RESPONSE_S: f32 = 0.03;
/// Fraction of the slew that (1) uses, because of the discrete ticks.
const SLEW_SHARE: f32 = 0.9;
/// Resolution of a border's ratio.
const STEPS_PER_RATIO: f32 = 2_500.0;
/// Resolution of the interpolation: the tick interpolates in whole numbers, whose results never exceed both ends of a
/// cell.
const PART_BITS: u32 = 16;
const PARTS: u32 = 1 << PART_BITS;
const RATIO_PER_PART: f32 = 1.0 / (STEPS_PER_RATIO * PARTS as f32);
/// Tolerance below a step, which still counts as the step.
const STEP_TOLERANCE: f32 = 0.02;
/// Largest ratio of a border; above every possible override.
const RATIO_MAX: f32 = 3.0;
/// Tolerance of the rounding to a whole per cent.
const PERCENT_TOLERANCE: f32 = 0.01;

/// Largest override ratio at each place of a segment from which the override can still fall, at its slew rate, to what
/// the rest of the segment and the next one need. Computed once, when the segment is prepared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Envelope {
    /// Borders: before each cell and after the last one.
    borders: [Border; CELLS + 1],
    parts_per_mm: f32,
    /// e^2 in (3).
    end_squared: f32,
    /// L - F r_max w in (3).
    fallen_mm: f32,
    /// 2 s / F.
    fall_per_mm: f32,
    /// Spindle speed for which the ratios are computed; minus infinity if they are valid at any speed.
    spindle: RevPerMin,
}

/// Ratio at a border, in steps; the lower [`ANSWER_BITS`] hold the law's answer there.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Border(u16);

const ANSWER_BITS: u32 = 3;
const ANSWERS: u16 = (1 << ANSWER_BITS) - 1;
/// Code of a demand; the codes of refusals follow the order of [`NoDemand`], so that the compiler needs no conversion.
const ANSWERED: u16 = 5;

/// Sent feed and limits of a segment, from which its envelope (largest override ratio at each place) is computed.
#[derive(Clone, Copy, Debug)]
pub struct Sent {
    /// Feed along the path that the control received.
    pub feed: MmPerMin,
    /// Number of teeth that cut, divided by the sent feed in mm/min; divided by the spindle speed it is the reciprocal
    /// of the feed per tooth.
    pub teeth_min_per_mm: f32,
    /// Commanded spindle speed, for which the law's demand is converted to a ratio.
    pub spindle: RevPerMin,
    /// Largest ratio of wanted to sent feed that the override, the machine and the job allow.
    pub max_ratio: f32,
    /// Largest override at the segment's end, %, above which the next move would begin too fast.
    pub end_percent: u8,
}

/// Answers of the law at the borders.
struct Answers {
    ratios: [f32; CELLS + 1],
    borders: [Border; CELLS + 1],
    /// Whether the law has no demand anywhere.
    is_refused: bool,
}

impl Envelope {
    /// Envelope of a segment whose path is `track` under this law, for an override within these limits.
    pub fn new(law: &SegmentLaw, track: &Track, sent: &Sent, limits: &OverrideLimits) -> Self {
        let constant = Envelope::constant(sent.end_percent);
        let keeps_feed_behind = sent.end_percent >= PERCENT as u8;
        if keeps_feed_behind && matches!(law, SegmentLaw::Programmed) {
            return constant;
        }
        let Answers { mut ratios, mut borders, is_refused } = Answers::of(law, track, sent);
        let length_mm = track.length_mm();
        let cells_per_mm = if length_mm > 0.0 { CELLS as f32 / length_mm } else { 0.0 };
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
        let reach = 2 + fmath::min(response_mm * cells_per_mm, CELLS as f32) as usize;
        lower_to_least(&mut ratios, reach + 1);
        let mut before = f32::INFINITY;
        for (border, &ratio) in borders.iter_mut().zip(&ratios) {
            *border = border.with_ratio(fmath::min(fmath::min(before, ratio), RATIO_MAX));
            before = ratio;
        } // (2)
        let spindle = if keeps_feed_behind && is_refused { constant.spindle } else { sent.spindle };
        let parts_per_mm = cells_per_mm * PARTS as f32;
        Envelope { borders, parts_per_mm, fallen_mm: length_mm - response_mm, fall_per_mm, spindle, ..constant }
    }

    /// Envelope of a segment without a law: 100 % at any spindle speed, or `end_percent` if that is lower, because the
    /// next segment cannot begin with more.
    pub fn constant(end_percent: u8) -> Self {
        let end_ratio = f32::from(end_percent) / PERCENT;
        Envelope {
            borders: [Border::answering::<()>(Err(NoDemand::NoLaw)).with_ratio(1.0); CELLS + 1],
            parts_per_mm: 0.0,
            end_squared: end_ratio * end_ratio,
            fallen_mm: 0.0,
            fall_per_mm: 0.0,
            spindle: RevPerMin(f32::NEG_INFINITY),
        }
    }

    /// Largest override with which the segment may begin, %.
    pub fn begin_percent(&self) -> u8 {
        (self.at(0.0).0 * PERCENT + PERCENT_TOLERANCE) as u8
    }

    /// Amount by which the override must be below 100 % at the segment's end because of the next one, as a ratio; 0 if
    /// 100 % is allowed.
    pub fn reserve_ratio(&self) -> f32 {
        1.0 - fmath::sqrt(fmath::min(self.end_squared, 1.0))
    }

    /// Largest override ratio after a distance travelled on the segment, for the commanded spindle speed. With the
    /// reason if the law has no demand there.
    #[inline(always)]
    pub fn at(&self, travelled_mm: f32) -> (f32, Result<(), NoDemand>) {
        let place = ((travelled_mm * self.parts_per_mm) as u32).min(CELLS as u32 * PARTS - 1);
        let cell = (place / PARTS) as usize;
        let [before, behind] = [cell, cell + 1].map(|border| self.borders.get(border).copied().unwrap_or(Border(0)));
        // Below 2^31: a border has less than 2^13 steps.
        let steps = before.steps() * PARTS as i32 + (behind.steps() - before.steps()) * (place % PARTS) as i32;
        let ratio = steps as f32 * RATIO_PER_PART;
        let falling = self.end_squared + fmath::max(self.fallen_mm - travelled_mm, 0.0) * self.fall_per_mm;
        let ratio = if falling < ratio * ratio { fmath::sqrt(falling) } else { ratio }; // (3)
        (ratio, before.answer())
    }

    /// Factor, at most 1, for the ratio if the spindle is slower than commanded: the feed per tooth then stays the
    /// same. A faster spindle does not raise the ratio.
    #[inline(always)]
    pub fn spindle_share(&self, measured: RevPerMin) -> f32 {
        let is_slower = fmath::is_positive(measured.0) && measured.0 < self.spindle.0;
        if is_slower { measured.0 / self.spindle.0 } else { 1.0 }
    }
}

/// Lowers each ratio to the least of itself and those that follow it, `count` in all.
fn lower_to_least(ratios: &mut [f32], count: usize) {
    let ratios = Cell::from_mut(ratios).as_slice_of_cells();
    let mut covered = 1;
    while covered < count {
        // Each is the least of `covered` by now: with the one a step ahead, of a step more.
        let step = covered.min(count - covered);
        for (ratio, ahead) in ratios.iter().zip(ratios.iter().skip(step)) {
            ratio.set(fmath::min(ratio.get(), ahead.get()));
        }
        covered += step;
    }
}

impl Border {
    /// A border with an answer but without a ratio.
    fn answering<T>(answer: Result<T, NoDemand>) -> Self {
        Border(match answer {
            Err(NoDemand::NoLaw) => 0,
            Err(NoDemand::NoContact) => 1,
            Err(NoDemand::OutsideValidity) => 2,
            Err(NoDemand::ChipUnreachable) => 3,
            Err(NoDemand::BadInput) => 4,
            Ok(_) => ANSWERED,
        })
    }

    /// The same answer with this ratio, rounded down.
    fn with_ratio(self, ratio: f32) -> Self {
        let steps = (ratio * STEPS_PER_RATIO + STEP_TOLERANCE) as u16;
        Border(steps << ANSWER_BITS | self.0 & ANSWERS)
    }

    #[inline(always)]
    fn steps(self) -> i32 {
        i32::from(self.0 >> ANSWER_BITS)
    }

    #[inline(always)]
    fn answer(self) -> Result<(), NoDemand> {
        match self.0 & ANSWERS {
            0 => Err(NoDemand::NoLaw),
            1 => Err(NoDemand::NoContact),
            2 => Err(NoDemand::OutsideValidity),
            3 => Err(NoDemand::ChipUnreachable),
            4 => Err(NoDemand::BadInput),
            _ => Ok(()),
        }
    }
}

impl Answers {
    /// Evaluates the law along the track.
    fn of(law: &SegmentLaw, track: &Track, sent: &Sent) -> Self {
        let length_mm = track.length_mm();
        let mut answers =
            Answers { ratios: [0.0; CELLS + 1], borders: [Border(ANSWERED); CELLS + 1], is_refused: true };
        let borders = answers.ratios.iter_mut().zip(&mut answers.borders);
        for ((ratio, border), place) in borders.zip(track.places(CELLS)) {
            let demand = sent.demand(law, &place);
            (*ratio, *border) = (sent.bound(demand), Border::answering(demand));
            answers.is_refused &= matches!(demand, Err(refusal) if refusal != NoDemand::ChipUnreachable);
        }
        law.knots_mm(&mut |knot_mm| {
            if knot_mm > 0.0 && knot_mm < length_mm {
                let bound = sent.bound(sent.demand(law, &track.place_after(knot_mm)));
                let cell = (knot_mm / length_mm * CELLS as f32) as usize;
                for ratio in answers.ratios.iter_mut().skip(cell).take(2) {
                    *ratio = fmath::min(*ratio, bound);
                }
            }
        });
        answers
    }
}

impl Sent {
    /// Ratio that the law demands at a place.
    fn demand(&self, law: &SegmentLaw, place: &Place) -> Result<f32, NoDemand> {
        let path_mm_per_tooth = law.demand(place)?.path_mm_per_tooth;
        let is_known = fmath::is_positive(self.spindle.0);
        is_known.then_some(self.spindle.0 * path_mm_per_tooth * self.teeth_min_per_mm).ok_or(NoDemand::BadInput)
    }

    /// Largest ratio that a demand allows.
    fn bound(&self, demand: Result<f32, NoDemand>) -> f32 {
        match demand {
            Ok(ratio) => fmath::min(ratio, RATIO_MAX),
            Err(NoDemand::ChipUnreachable) => RATIO_MAX,
            Err(NoDemand::NoLaw) => 1.0,
            // Without a demand: the sent feed, within the job's limits.
            Err(_) => fmath::min(1.0, self.max_ratio),
        }
    }
}

#[cfg(test)]
mod tests;
