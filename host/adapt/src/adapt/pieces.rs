//! Division of an arc into pieces of one feed each, for a control without an override input.
//!
//! Each cell of the arc may be run with the largest feed of the series
//!
//! ```text
//! F(k) = least * (1 + step)^k,    k = 0, 1, 2, ...     (1)
//! ```
//!
//! that is not above any demand in the cell. Neighbouring cells with the same feed are one piece. Then pieces are joined, at the lower of
//! the two feeds, wherever one of them is too short, F would rise by less than the hysteresis, or there are too many: each time the two
//! whose joining costs least time. Joining only ever lowers a feed, therefore no chip gets thicker.

use arcfeed_model::job::PieceSettings;
use arcfeed_units::PERCENT;

use super::profile::Profile;

/// Part of an arc or line that is run with one feed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// End of the piece, as a fraction (0 to 1) of the move; 1 for the last one.
    pub until_ratio: f64,
    /// Path of the tool centre per tooth, mm, which is not above the law's demand anywhere on the piece.
    pub path_mm_per_tooth: f64,
}

/// Divides a move of `length_mm` into pieces. `profile` is the law's demand, evaluated in all cells of the move; `most_ratio` is the
/// largest permitted ratio of a piece's feed to the smallest one. `None` if the law has no finite demand.
pub fn plan(profile: &Profile, length_mm: f64, settings: &PieceSettings, most_ratio: f64) -> Option<Vec<Piece>> {
    let least = profile.least()?;
    let step = 1.0 + f64::from(settings.step_percent) / f64::from(PERCENT);
    let mut pieces: Vec<Piece> = Vec::new();
    for (cell, demand) in filled(profile, least).into_iter().enumerate() {
        let path_mm_per_tooth = bucket(demand.min(most_ratio * least), least, step);
        let until_ratio = (cell + 1) as f64 / profile.bounds.len() as f64;
        match pieces.last_mut() {
            Some(last) if last.path_mm_per_tooth == path_mm_per_tooth => last.until_ratio = until_ratio,
            _ => pieces.push(Piece { until_ratio, path_mm_per_tooth }),
        }
    }
    let limits = Limits {
        least_ratio: settings.least_length.to_mm() / length_mm,
        rise: 1.0 + f64::from(settings.hysteresis_percent) / f64::from(PERCENT),
        most: usize::from(settings.most),
    };
    while let Some(before) = limits.cheapest_to_join(&pieces) {
        join(&mut pieces, before);
    }
    Some(pieces)
}

/// Joins the piece with the index `before` with the next one, at the lower of both feeds.
pub fn join(pieces: &mut Vec<Piece>, before: usize) {
    let first = pieces.remove(before);
    pieces[before].path_mm_per_tooth = pieces[before].path_mm_per_tooth.min(first.path_mm_per_tooth);
}

/// A feed for each cell: where the law says nothing, the least of the move; where no feed is too high, that of the nearest
/// cell with a demand, so that no F word is spent on it.
fn filled(profile: &Profile, least: f64) -> Vec<f64> {
    let cells = profile.bounds.iter().zip(&profile.covered);
    let mut demands: Vec<f64> = cells.map(|(bound, covered)| if *covered { *bound } else { least }).collect();
    for forward in [true, false] {
        let mut last = f64::INFINITY;
        let count = demands.len();
        for index in 0..count {
            let cell = if forward { index } else { count - 1 - index };
            if demands[cell].is_infinite() {
                demands[cell] = last;
            }
            last = demands[cell];
        }
    }
    demands
}

/// The largest of the feeds (1) that is not above `demand`.
fn bucket(demand: f64, least: f64, step: f64) -> f64 {
    let power = |k: f64| least * libm::pow(step, k);
    // The logarithm may miss the next power by a rounding; whole powers of it stay where they are.
    let k = libm::floor(libm::log(demand / least) / libm::log(step) + 1e-9).max(0.0);
    if power(k) <= demand { power(k) } else { power((k - 1.0).max(0.0)) } // (1)
}

/// Limits that pieces must keep.
struct Limits {
    least_ratio: f64,
    rise: f64,
    most: usize,
}

impl Limits {
    /// The first of the two neighbours that are to be joined next.
    fn cheapest_to_join(&self, pieces: &[Piece]) -> Option<usize> {
        let too_many = pieces.len() > self.most;
        let length = |index: usize| pieces[index].until_ratio - start(pieces, index);
        let joins = |before: &usize| {
            let is_short = |index: usize| length(index) < self.least_ratio;
            let ratio = pieces[before + 1].path_mm_per_tooth / pieces[*before].path_mm_per_tooth;
            let jitters = ratio == 1.0 || (ratio > 1.0 && ratio < self.rise);
            too_many || is_short(*before) || is_short(before + 1) || jitters
        };
        // Time that joining costs, but for a factor.
        let cost = |before: usize| {
            let (a, b) = (pieces[before].path_mm_per_tooth, pieces[before + 1].path_mm_per_tooth);
            let raised = if a > b { length(before) } else { length(before + 1) };
            raised * (1.0 / a.min(b) - 1.0 / a.max(b))
        };
        let candidates = (0..pieces.len().saturating_sub(1)).filter(joins);
        candidates.min_by(|a, b| cost(*a).total_cmp(&cost(*b)))
    }
}

/// Start of the piece with this index, as a fraction (0 to 1) of the move.
pub fn start(pieces: &[Piece], index: usize) -> f64 {
    index.checked_sub(1).map_or(0.0, |before| pieces[before].until_ratio)
}

#[cfg(test)]
mod tests {
    use super::super::asked_cells::CELLS;
    use super::*;
    use arcfeed_units::Nm;

    /// A move whose law demands `demand` of the way.
    fn profile(demand: impl Fn(f64) -> f64) -> Profile {
        let bounds: Vec<f64> = (0..CELLS).map(|cell| demand((cell as f64 + 0.5) / CELLS as f64)).collect();
        Profile { answers: Vec::new(), bounds, covered: vec![true; CELLS] }
    }

    fn settings(step: f32, hysteresis: f32, least_mm: f64, most: u16) -> PieceSettings {
        let least_length = Nm::from_mm(least_mm);
        PieceSettings { step_percent: step, hysteresis_percent: hysteresis, least_length, most }
    }

    fn feeds(pieces: &[Piece]) -> Vec<f64> {
        pieces.iter().map(|piece| piece.path_mm_per_tooth).collect()
    }

    #[test]
    fn a_slope_becomes_a_stair_of_steps_below_it() {
        let slope = profile(|x| 1.0 + 0.25 * x);
        let pieces = plan(&slope, 100.0, &settings(5.0, 0.0, 1.0, 99), 2.0).unwrap();
        let least = slope.bounds[0];
        for (index, (feed, power)) in feeds(&pieces).into_iter().zip(0..).enumerate() {
            assert!((feed / (least * 1.05_f64.powi(power)) - 1.0).abs() < 1e-12, "{pieces:?}");
            assert!(feed <= 1.0 + 0.25 * start(&pieces, index) + 1e-3, "{pieces:?}");
        }
        // ln(1.25) / ln(1.05) = 4.57.
        assert_eq!((pieces.len(), pieces[4].until_ratio), (5, 1.0));
    }

    #[test]
    fn what_does_not_vary_is_one_piece_at_its_own_feed() {
        let pieces = plan(&profile(|_| 0.123), 100.0, &PieceSettings::default(), 2.0).unwrap();
        assert_eq!(pieces, [Piece { until_ratio: 1.0, path_mm_per_tooth: 0.123 }]);
    }

    #[test]
    fn ripple_below_the_hysteresis_costs_no_f_word_and_a_fall_always_does() {
        let ripple = |x: f64| 1.0 + 0.012 * f64::from((x * 40.0) as u32 % 2);
        assert!(plan(&profile(ripple), 1e3, &settings(1.0, 0.0, 1.0, 99), 2.0).unwrap().len() > 30);
        assert_eq!(plan(&profile(ripple), 1e3, &settings(1.0, 2.0, 1.0, 99), 2.0).unwrap().len(), 1);
        let fall = |x: f64| if x < 0.5 { 1.012 } else { 1.0 };
        assert_eq!(feeds(&plan(&profile(fall), 1e3, &settings(1.0, 2.0, 1.0, 99), 2.0).unwrap()), [1.01, 1.0]);
    }

    #[test]
    fn no_piece_is_too_short_and_none_too_many() {
        let wave = profile(|x| 1.0 + 0.3 * libm::sin(20.0 * x) * x);
        let pieces = plan(&wave, 100.0, &settings(1.0, 0.0, 6.0, 99), 2.0).unwrap();
        assert!(pieces.len() > 5);
        for (index, piece) in pieces.iter().enumerate() {
            assert!(100.0 * (piece.until_ratio - start(&pieces, index)) >= 6.0, "{pieces:?}");
        }
        assert_eq!(plan(&wave, 100.0, &settings(1.0, 0.0, 0.1, 7), 2.0).unwrap().len(), 7);
    }

    #[test]
    fn without_a_demand_a_piece_has_the_least_feed() {
        let mut gap = profile(|x| if x < 0.5 { 1.0 } else { 1.5 });
        gap.covered[200..210].fill(false);
        gap.bounds[200..210].fill(f64::INFINITY);
        gap.bounds[60..70].fill(f64::INFINITY);
        let pieces = plan(&gap, 1e3, &settings(1.0, 0.0, 0.1, 99), 2.0).unwrap();
        let until: Vec<f64> = pieces.iter().map(|piece| piece.until_ratio * CELLS as f64).collect();
        assert_eq!((until, pieces.len()), (vec![128.0, 200.0, 210.0, 256.0], 4));
        assert!(pieces[2].path_mm_per_tooth == 1.0 && pieces[1].path_mm_per_tooth > 1.48);
    }

    #[test]
    fn no_feed_is_above_the_ceiling() {
        let pieces = plan(&profile(|x| 1.0 + 9.0 * x), 1e3, &settings(10.0, 0.0, 0.1, 99), 1.5).unwrap();
        assert!(feeds(&pieces).into_iter().fold(0.0, f64::max) <= 1.5 * 1.02);
    }
}
