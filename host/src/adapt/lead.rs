//! Engaged arcs told before they come, so that an override that falls no faster than its slew has fallen when they do.
//!
//! Along the path p the law wants r(p) of the feed as sent, F; the override falls by s at most, and takes effect a way w late. While it
//! falls its square does so evenly along the path:
//!
//! ```text
//! d(r^2)/dp = 2 r (dr/dt) / (F r) = -2 s / F
//! e(p)^2 = min over q > p of r(q)^2 + 2 s max(q - p - w, 0) / F                      (1)
//! ```
//!
//! Where e(p) < r(p) the arcs at the q of the minimum are engaged at p already: the law then wants no more than r(q), and the slew makes e of
//! that. Feeds in pieces need none of this.
//!
//! Source: own.

use arcfeed_shared::engaged::EngagedTable;
use arcfeed_shared::job::{Job, OverrideLimits};
use arcfeed_shared::tool::Edge;
use arcfeed_shared::units::{Nm, PERCENT, S_PER_MIN};

use super::profile::{Answer, CELLS, Profile};
use super::teeth_per_min;
use crate::engagement::covering::{self, Sample, hull};

/// From a wish to the feed that it makes: the controller's tick, the ladder's scan of some 8 ms that may just have passed, and another
/// until the control has it [assumed].
const LATE_S: f64 = 0.02;

/// An override on a move.
#[derive(Clone, Copy, Debug)]
pub struct Falling {
    /// Teeth over the feed as sent, 1/mm: times a path per tooth it is a ratio.
    pub teeth_per_mm: f64,
    /// The feed as sent.
    pub feed_mm_per_s: f64,
    /// The least and the largest ratio that there can be.
    pub ratios: [f64; 2],
    /// How fast it falls.
    pub slew_ratio_per_s: f64,
}

/// A place of the move, and the ratio wanted there.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    at_mm: f64,
    ratio: f64,
}

impl Falling {
    /// The override of a job's controller on a move that is sent with this feed, and that the machine follows up to the limit.
    pub fn on(job: &Job, sent: Nm, limit_mm_per_min: f64) -> Self {
        let OverrideLimits { min_percent, max_percent, slew_down_percent_per_s, .. } = job.limits;
        let [least, most] = [min_percent, max_percent].map(|percent| f64::from(percent) / f64::from(PERCENT));
        Falling {
            teeth_per_mm: teeth_per_min(job) / sent.to_mm(),
            feed_mm_per_s: sent.to_mm() / S_PER_MIN,
            ratios: [least, most.min(limit_mm_per_min / sent.to_mm())],
            slew_ratio_per_s: f64::from(slew_down_percent_per_s) / f64::from(PERCENT),
        }
    }

    /// The arcs of a move so long, told in time; those that come are told as they are where that is early enough.
    pub fn in_time(&self, table: &EngagedTable, profile: &Profile, length_mm: f64) -> EngagedTable {
        let wanted: Vec<Wanted> = profile
            .answers
            .iter()
            .map(|(cell, answer)| Wanted { at_mm: cell / CELLS as f64 * length_mm, ratio: self.ratio(*answer) })
            .collect();
        let ahead: Vec<usize> = (0..wanted.len()).map(|index| self.binding(index, &wanted)).collect();
        if ahead.iter().enumerate().all(|(index, ahead)| index == *ahead) {
            return table.clone();
        }
        let arcs_deg = |index: usize| {
            let at = |edge: Edge| table.arc_at(wanted[index].at_mm as f32, edge);
            [Edge::Outer, Edge::Inner].map(|edge| at(edge).map(|arc| arc.degrees().map(f64::from)))
        };
        let sample = |(index, ahead): (usize, &usize)| {
            let (here, there) = (arcs_deg(index), arcs_deg(*ahead));
            let both = [0, 1].map(|circle: usize| [here[circle], there[circle]].into_iter().flatten().reduce(hull));
            Sample { at_mm: wanted[index].at_mm, intervals_deg: both }
        };
        let samples: Vec<Sample<2>> = ahead.iter().enumerate().map(sample).collect();
        covering::table(&samples).unwrap_or_else(|| table.clone())
    }

    /// Where the law says nothing the override is at 100 %.
    fn ratio(&self, answer: Answer) -> f64 {
        let [least, most] = self.ratios;
        let ratio = match answer {
            Answer::Wish(path_mm, _) => path_mm * self.teeth_per_mm,
            Answer::Anything => most,
            Answer::Nothing => 1.0,
        };
        ratio.min(most).max(least)
    }

    /// The place ahead that bounds the ratio at one, by (1); that place itself if none does. What is wanted at a place may be wanted
    /// from right behind the one before it.
    fn binding(&self, index: usize, wanted: &[Wanted]) -> usize {
        let here = wanted[index];
        let late_mm = self.feed_mm_per_s * here.ratio * LATE_S;
        let square = |ahead: usize| {
            let way_mm = (wanted[ahead - 1].at_mm - here.at_mm - late_mm).max(0.0);
            wanted[ahead].ratio * wanted[ahead].ratio + 2.0 * self.slew_ratio_per_s * way_mm / self.feed_mm_per_s
        };
        let ahead = (index + 1..wanted.len()).map(|ahead| (ahead, square(ahead)));
        let first = (index, here.ratio * here.ratio);
        ahead.fold(first, |least, ahead| if ahead.1 < least.1 { ahead } else { least }).0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_shared::engaged::{EngagedInterval, EngagedKnot};
    use arcfeed_shared::units::Mm;

    const LENGTH_MM: f64 = 25.6;
    const CORNER_MM: f64 = 20.0;
    const FALLING: Falling =
        Falling { teeth_per_mm: 10.0, feed_mm_per_s: 10.0, ratios: [0.1, 2.0], slew_ratio_per_s: 2.0 };

    /// A shoulder up to the corner, a full slot from there on; wanted are these ratios.
    fn corner(shoulder_ratio: f64, slot_ratio: f64) -> (EngagedTable, Profile) {
        let knot = |at_mm: f64, from_deg: f64| {
            let outer = EngagedInterval::from_degrees(from_deg, 180.0).expect("an arc");
            EngagedKnot { travelled: Mm(at_mm as f32), outer, inner: EngagedInterval::EMPTY }
        };
        let knots = [knot(0.0, 120.0), knot(CORNER_MM, 120.0), knot(CORNER_MM + 0.001, 0.0), knot(LENGTH_MM, 0.0)];
        let path_mm = |cell: usize| {
            let at_mm = cell as f64 / CELLS as f64 * LENGTH_MM;
            if at_mm <= CORNER_MM { shoulder_ratio / 10.0 } else { slot_ratio / 10.0 }
        };
        let answers = (0..=CELLS).map(|cell| (cell as f64, Answer::Wish(path_mm(cell), 0.0))).collect();
        (EngagedTable::new(&knots).expect("a table"), Profile { answers, bounds: Vec::new(), covered: Vec::new() })
    }

    #[test]
    fn the_arcs_behind_a_corner_are_told_as_early_as_the_slew_and_the_delay_want() {
        let (table, profile) = corner(2.0, 1.0);
        let led = FALLING.in_time(&table, &profile, LENGTH_MM);
        // From 2 to 1 at 2 a second: 0.5 s at 1.5 times 10 mm/s; and 0.02 s at 20 mm/s.
        let begins_mm = CORNER_MM - 7.5 - 0.4;
        let from_deg = |at_mm: f64| led.arc_at(at_mm as f32, Edge::Outer).expect("an arc").degrees()[0];
        assert!(from_deg(begins_mm) <= 0.0 && from_deg(begins_mm - 0.35) > 119.0, "{led:?}");
        assert!(from_deg(CORNER_MM) <= 0.0 && from_deg(LENGTH_MM) <= 0.0);
        assert_eq!(led.arc_at(3.0, Edge::Inner), None);
    }

    #[test]
    fn what_falls_no_lower_or_rises_stays_as_it_is() {
        for (shoulder_ratio, slot_ratio) in [(1.0, 1.0), (0.5, 2.0), (9.0, 3.0), (0.05, 0.01)] {
            let (table, profile) = corner(shoulder_ratio, slot_ratio);
            assert_eq!(FALLING.in_time(&table, &profile, LENGTH_MM), table, "{shoulder_ratio} {slot_ratio}");
        }
    }

    #[test]
    fn a_fast_override_is_told_next_to_nothing_earlier() {
        let (table, profile) = corner(2.0, 1.0);
        let led = Falling { slew_ratio_per_s: 2_000.0, ..FALLING }.in_time(&table, &profile, LENGTH_MM);
        let from_deg = led.arc_at((CORNER_MM - 0.8) as f32, Edge::Outer).expect("an arc").degrees()[0];
        assert!(from_deg > 119.0, "{led:?}");
    }
}
