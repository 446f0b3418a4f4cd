//! Ring of a cup mill that removes most from a slot (Petean, section 3.3.2, Fig. 3.11).
//!
//! A wider ring with the same limit points lies closer to both blades, until it does not pass any more. Each ring is planned and
//! proven as the part's own one is.

use rayon::iter::{IntoParallelIterator, ParallelIterator};

use crate::cup_mill::infeasibility::Infeasible;
use crate::cutter::CupMill;

/// One ring of a cup mill that was tried in a slot, with the result of its plan.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Mean of outer and inner radius, mm.
    pub middle_mm: f64,
    /// Width of the ring: outer minus inner radius, mm.
    pub width_mm: f64,
    /// Fraction of the slot's volume that the ring removes, or the reason why there is no plan.
    pub share_ratio: Result<f64, Infeasible>,
}

/// Width of the cutter's ring from which and to which others are tried, as a fraction of it.
const WIDTHS: [f64; 2] = [0.5, 1.5];
/// Number of widths tried on a grid.
const LOOKS: u32 = 12;
/// Steps of the golden-section search after it.
const SECTIONS: u32 = 3;
/// Ratio of the golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_8;
/// Middle radii tried with the best width, as fractions of the cutter's.
const MIDDLES: [f64; 4] = [0.8, 0.9, 1.1, 1.2];

impl Trial {
    /// Removed fraction, for comparison; a ring without a plan is below all others.
    pub fn worth(&self) -> f64 {
        self.share_ratio.as_ref().map_or(-1.0, |share| *share)
    }
}

/// Cutter with a ring of another middle radius and width.
pub fn resized(cutter: &CupMill, middle_mm: f64, width_mm: f64) -> CupMill {
    let (outer_radius_mm, inner_radius_mm) = (middle_mm + width_mm / 2.0, middle_mm - width_mm / 2.0);
    CupMill { outer_radius_mm, inner_radius_mm, ..cutter.clone() }
}

/// Results of rings about the cutter's middle radius, by width, and then of other middle radii with the best of these widths.
/// `share_ratio` is the removed fraction of a cutter.
pub fn trials(cutter: &CupMill, share_ratio: impl Fn(&CupMill) -> Result<f64, Infeasible> + Sync) -> [Vec<Trial>; 2] {
    let own_mm = cutter.outer_radius_mm - cutter.inner_radius_mm;
    let own_middle_mm = (cutter.outer_radius_mm + cutter.inner_radius_mm) / 2.0;
    let trial = |middle_mm: f64, width_mm: f64| {
        let share_ratio = share_ratio(&resized(cutter, middle_mm, width_mm));
        Trial { middle_mm, width_mm, share_ratio }
    };
    let [low, high] = WIDTHS;
    // No insert is wider than half of its ring.
    let least_mm = (low * own_mm).max(2.0 * cutter.insert_radius_mm);
    let step_mm = (high * own_mm - least_mm) / f64::from(LOOKS);
    let mut widths_mm: Vec<f64> = (0..=LOOKS).map(|k| least_mm + step_mm * f64::from(k)).collect();
    widths_mm.push(own_mm);
    let mut by_width: Vec<Trial> = widths_mm.into_par_iter().map(|width_mm| trial(own_middle_mm, width_mm)).collect();
    let most =
        |trials: &[Trial]| trials.iter().max_by(|a, b| a.worth().total_cmp(&b.worth())).map_or(own_mm, |t| t.width_mm);
    let best_mm = most(&by_width);
    let mut ends = [(best_mm - step_mm).max(least_mm), best_mm + step_mm];
    for _ in 0..SECTIONS {
        let inner = [GOLDEN, 1.0 - GOLDEN].map(|share| ends[0] * share + ends[1] * (1.0 - share));
        let (low, high) = rayon::join(|| trial(own_middle_mm, inner[0]), || trial(own_middle_mm, inner[1]));
        ends = if low.worth() > high.worth() { [ends[0], inner[1]] } else { [inner[0], ends[1]] };
        by_width.extend([low, high]);
    }
    by_width.sort_by(|a, b| a.width_mm.total_cmp(&b.width_mm));
    let best_mm = most(&by_width);
    let by_middle = MIDDLES.into_par_iter().map(|ratio| trial(ratio * own_middle_mm, best_mm)).collect();
    [by_width, by_middle]
}
