//! Ring of a cup mill that removes most from a slot (Petean, section 3.3.2, Fig. 3.11).
//!
//! A wider ring with the same limit points lies closer to both blades, until it does not pass any more. Each ring is planned and
//! proven as the part's own one is.

use crate::cup_mill::infeasibility::Infeasible;
use crate::cutter::CupMill;
use crate::parallel;

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

/// Whether two widths are the same but for rounding.
fn is_same(a_mm: f64, b_mm: f64) -> bool {
    (a_mm - b_mm).abs() < 1e-9
}

/// The trial of a width, if there has been one: each takes seconds.
fn tried(trials: &[Trial], width_mm: f64) -> Option<&Trial> {
    trials.iter().find(|trial| is_same(trial.width_mm, width_mm))
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
    let grid = (0..=LOOKS).map(|k| least_mm + step_mm * f64::from(k)).filter(|width_mm| !is_same(*width_mm, own_mm));
    let widths_mm: Vec<f64> = grid.chain([own_mm]).collect();
    let mut by_width: Vec<Trial> = parallel::map(&widths_mm, &|width_mm| trial(own_middle_mm, *width_mm));
    let most =
        |trials: &[Trial]| trials.iter().max_by(|a, b| a.worth().total_cmp(&b.worth())).map_or(own_mm, |t| t.width_mm);
    let best_mm = most(&by_width);
    let mut ends = [(best_mm - step_mm).max(least_mm), best_mm + step_mm];
    for _ in 0..SECTIONS {
        let inner = [GOLDEN, 1.0 - GOLDEN].map(|share| ends[0] * share + ends[1] * (1.0 - share));
        let new: Vec<f64> = inner.into_iter().filter(|width_mm| tried(&by_width, *width_mm).is_none()).collect();
        by_width.extend(parallel::map(&new, &|width_mm| trial(own_middle_mm, *width_mm)));
        let [low, high] = inner.map(|width_mm| tried(&by_width, width_mm).map(Trial::worth));
        ends = if low > high { [ends[0], inner[1]] } else { [inner[0], ends[1]] };
    }
    by_width.sort_by(|a, b| a.width_mm.total_cmp(&b.width_mm));
    let best_mm = most(&by_width);
    let by_middle = parallel::map(&MIDDLES, &|ratio| trial(ratio * own_middle_mm, best_mm));
    [by_width, by_middle]
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    /// Most at 15.2 mm; the part's own width lies on the grid.
    #[test]
    fn each_ring_is_planned_once_and_the_best_one_is_found() {
        let cutter = CupMill {
            outer_radius_mm: 128.0,
            inner_radius_mm: 112.0,
            insert_radius_mm: 0.8,
            cavity_depth_mm: 60.0,
            height_mm: 90.0,
            holder_mm: vec![],
            active_teeth: 10,
        };
        let planned = Mutex::new(Vec::new());
        let [by_width, by_middle] = trials(&cutter, |ring| {
            planned.lock().expect("a list").push([ring.outer_radius_mm, ring.inner_radius_mm]);
            Ok(1.0 - (ring.outer_radius_mm - ring.inner_radius_mm - 15.2).abs() / 100.0)
        });
        let planned = planned.into_inner().expect("a list");
        let apart = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
        for (at, ring) in planned.iter().enumerate() {
            assert!(planned[..at].iter().all(|earlier| apart(earlier, ring) > 1e-6), "{ring:?} twice in {planned:?}");
        }
        assert_eq!(planned.len(), by_width.len() + by_middle.len());
        assert!(by_width.iter().any(|trial| trial.width_mm == 16.0));
        // Three sections leave 0.63 mm of two steps of the grid, 1.33 mm each.
        assert!(by_middle.iter().all(|trial| (trial.width_mm - 15.2).abs() < 0.4), "{by_middle:?}");
    }
}
