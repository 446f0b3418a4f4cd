//! Few knots for many samples of engaged arcs: the straight lines between the knots cover every sample.
//!
//! The sample farthest from the lines becomes the next knot, again and again. Then each knot is widened by the largest
//! part that the lines beside it still leave out:
//!
//! ```text
//! excess of a line over its samples' ends, e = max (from(line) - from(sample), to(sample) - to(line), 0)
//! each of its two knots moves outwards by e                                                              (1)
//! ```
//!
//! A line whose ends both move outwards by e does so everywhere.
//!
//! Source: the picking is Douglas and Peucker's (1973), breadth first; (1) own.

use arcfeed_model::engaged::{ENGAGED_KNOTS_MAX, EngagedInterval, EngagedKnot, EngagedTable};
use arcfeed_units::Mm;

/// Full turn.
const TURN_DEG: f64 = 360.0;
/// Half the resolution of a table's arc ends.
const ROUNDING_DEG: f64 = 0.5 / 90.0;

/// Engaged arcs of the cutting circles at one position of a move, as intervals of direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample<const N: usize> {
    /// Path along the move up to the position, mm; increases from sample to sample.
    pub at_mm: f64,
    /// Interval of each cutting circle, from and to in degrees; `None` if it is not engaged.
    pub intervals_deg: [Option<[f64; 2]>; N],
}

/// Table of the arcs of the outer and the inner circle along a move that covers all samples; `None` if all arcs are
/// empty.
pub fn table(samples: &[Sample<2>]) -> Option<EngagedTable> {
    let knots = covering_knots(samples, ENGAGED_KNOTS_MAX).into_iter().map(|(path_mm, [outer, inner])| {
        Some(EngagedKnot { travelled: Mm(path_mm as f32), outer: outwards(outer)?, inner: outwards(inner)? })
    });
    EngagedTable::new(&knots.collect::<Option<Vec<_>>>()?).ok()
}

/// Arc rounded outwards to the resolution of a table; an empty arc stays empty.
fn outwards([from_deg, to_deg]: [f64; 2]) -> Option<EngagedInterval> {
    let spare_deg = if from_deg < to_deg { ROUNDING_DEG } else { 0.0 };
    EngagedInterval::from_degrees((from_deg - spare_deg).max(-TURN_DEG / 2.0), (to_deg + spare_deg).min(TURN_DEG / 2.0))
}

/// Knots that cover the samples, at most `count` and at least the first and the last one; an empty interval has equal
/// ends. Between two samples, the union of their intervals is covered.
fn covering_knots<const N: usize>(samples: &[Sample<N>], count: usize) -> Vec<(f64, [[f64; 2]; N])> {
    let wide = dilated(samples);
    let at: Vec<f64> = samples.iter().map(|sample| sample.at_mm).collect();
    let ends: [Vec<[f64; 2]>; N] = std::array::from_fn(|which| closed(&wide, which));
    let picked = picked(&at, &ends, count);
    let mut knots: Vec<(f64, [[f64; 2]; N])> =
        picked.iter().map(|index| (at[*index], std::array::from_fn(|which| ends[which][*index]))).collect();
    let mut excess = vec![[[0.0_f64; 2]; N]; knots.len()];
    for (line, pair) in picked.windows(2).enumerate() {
        let (first, last) = (knots[line].1, knots[line + 1].1);
        for index in pair[0]..=pair[1] {
            let part = (at[index] - at[pair[0]]) / (at[pair[1]] - at[pair[0]]);
            for (which, interval) in wide[index].intervals_deg.iter().enumerate() {
                let Some([from, to]) = interval else { continue };
                let on_line = |end: usize| between(first[which][end], last[which][end], part);
                let off = [on_line(0) - from, to - on_line(1)];
                for knot in &mut excess[line..=line + 1] {
                    knot[which] = [0, 1].map(|end: usize| knot[which][end].max(off[end])); // (1)
                }
            }
        }
    }
    for ((_, intervals), excess) in knots.iter_mut().zip(&excess) {
        for (interval, excess) in intervals.iter_mut().zip(excess) {
            *interval = [interval[0] - excess[0], interval[1] + excess[1]];
        }
    }
    knots
}

fn between(a: f64, b: f64, part: f64) -> f64 {
    a + (b - a) * part
}

/// Each sample joined with its neighbours.
fn dilated<const N: usize>(samples: &[Sample<N>]) -> Vec<Sample<N>> {
    let near = |index: usize| &samples[index.saturating_sub(1)..(index + 2).min(samples.len())];
    let hull =
        |index: usize, which: usize| near(index).iter().filter_map(|sample| sample.intervals_deg[which]).reduce(hull);
    let at = |index: usize| Sample {
        at_mm: samples[index].at_mm,
        intervals_deg: std::array::from_fn(|which| hull(index, which)),
    };
    (0..samples.len()).map(at).collect()
}

/// Smallest interval that contains both intervals.
pub fn hull([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a.min(c), b.max(d)]
}

/// Intervals of one quantity. An empty interval becomes the middle of the last non-empty one before it, or, at the
/// start, of the first one after it.
fn closed<const N: usize>(samples: &[Sample<N>], which: usize) -> Vec<[f64; 2]> {
    let middle = |[from, to]: [f64; 2]| (from + to) / 2.0;
    let first = samples.iter().find_map(|sample| sample.intervals_deg[which]);
    let mut last = first.map_or(0.0, middle);
    let each = samples.iter().map(|sample| match sample.intervals_deg[which] {
        Some(interval) => {
            last = middle(interval);
            interval
        }
        None => [last; 2],
    });
    each.collect()
}

/// Indices of the samples that are knots, in order.
fn picked<const N: usize>(at: &[f64], ends: &[Vec<[f64; 2]>; N], count: usize) -> Vec<usize> {
    let last = at.len().saturating_sub(1);
    let mut picked = vec![0, last];
    picked.truncate(at.len());
    while picked.len() < count {
        let off = |index: usize| {
            let next = picked.partition_point(|knot| *knot < index).clamp(1, picked.len() - 1);
            let (a, b) = (picked[next - 1], picked[next]);
            let part = (at[index] - at[a]) / (at[b] - at[a]);
            let along = |values: &[[f64; 2]], end: usize| {
                libm::fabs(between(values[a][end], values[b][end], part) - values[index][end])
            };
            ends.iter().map(|values| along(values, 0).max(along(values, 1))).fold(0.0, f64::max)
        };
        let others = (0..at.len()).filter(|index| picked.binary_search(index).is_err());
        let worst = others.map(|index| (off(index), index)).max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, worst)) = worst.filter(|(off, _)| *off > 0.0) else { break };
        let place = picked.partition_point(|knot| *knot < worst);
        picked.insert(place, worst);
    }
    picked
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(interval: impl Fn(f64) -> Option<[f64; 2]>) -> Vec<Sample<1>> {
        (0..=200).map(|at| Sample { at_mm: f64::from(at), intervals_deg: [interval(f64::from(at))] }).collect()
    }

    /// As a reader of the knots has it.
    fn read(knots: &[(f64, [[f64; 2]; 1])], at: f64) -> [f64; 2] {
        let next = knots.partition_point(|knot| knot.0 <= at).clamp(1, knots.len() - 1);
        let ((a, [from]), (b, [to])) = (knots[next - 1], knots[next]);
        [0, 1].map(|end: usize| between(from[end], to[end], (at - a) / (b - a)))
    }

    #[test]
    fn knots_stand_where_lines_bend() {
        let bent = |x: f64| if x < 30.0 { x } else { 30.0 + 4.0 * (x - 30.0).min(10.0) };
        // Neighbours' ends count, so that what grows does so one sample earlier.
        let knots = covering_knots(&samples(|at| Some([0.0, bent(at)])), 4);
        assert_eq!(knots.iter().map(|knot| knot.0).collect::<Vec<_>>(), [0.0, 29.0, 39.0, 200.0]);
        let [first, .., last] = knots.as_slice() else { panic!("knots") };
        assert!(first.1[0][1] >= 1.0 && last.1[0] == [0.0, 70.0], "{knots:?}");
    }

    #[test]
    fn nothing_of_any_sample_is_left_out_however_few_the_knots() {
        let wavy = |at: f64| [40.0 * libm::sin(at / 9.0), 60.0 + 30.0 * libm::cos(at / 17.0)];
        let torn = |at: f64| (!(60.0..90.0).contains(&at) && at < 170.0).then(|| wavy(at));
        for count in [2, 3, 8, 16, 300] {
            let samples = samples(torn);
            let knots = covering_knots(&samples, count);
            assert!(knots.len() <= count);
            for at in (0..=2000).map(|tenth| f64::from(tenth) / 10.0) {
                let (Some(before), Some(behind)) = (torn(libm::floor(at)), torn(libm::ceil(at))) else { continue };
                let (covered, [from, to]) = (read(&knots, at), hull(before, behind));
                assert!(covered[0] <= from + 1e-9 && covered[1] >= to - 1e-9, "{count} {at}: {covered:?} {from} {to}");
            }
        }
    }

    #[test]
    fn with_a_knot_at_each_sample_nothing_is_where_nothing_was() {
        let knots = covering_knots(&samples(|at| (at < 60.0).then_some([10.0, 20.0])), 300);
        let [from, to] = read(&knots, 61.5);
        assert!(from >= to, "{from} {to}");
        assert_eq!(covering_knots(&samples(|_| None), 16), [(0.0, [[0.0; 2]]), (200.0, [[0.0; 2]])]);
        assert_eq!(covering_knots(&samples(|_| Some([1.0, 2.0]))[..1], 16), [(0.0, [[1.0, 2.0]])]);
        assert_eq!(covering_knots::<1>(&[], 16), []);
    }
}
