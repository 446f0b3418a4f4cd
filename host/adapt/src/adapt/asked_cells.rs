//! Choice of the cells of a move in which a feed law is evaluated: all of them, or only those that decide about the smallest and the
//! largest demand.
//!
//! Between two turning points that a law states, the demand lies between the demands there. So the cell of each
//! turning point, of each knot and of each end of the move is enough, with one more on either side: the bound of a cell is
//! then the same as if all were asked.

use std::f64::consts::TAU;
use std::iter::once;
use std::ops::Range;

use arcfeed_law::{FeedLaw, SegmentLaw};

use super::places::MovePlaces;
use super::turning_points;

/// Number of equal cells into which a move is divided; a law is evaluated at their ends.
pub const CELLS: usize = 256;

/// Sweep of an arc, radians, below which f32 has too few directions in a cell to tell a demand that rises from its own rounding.
const SWEEP_MIN_RAD: f64 = 0.005;

/// Cells of a move in which a law is evaluated, in order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AskedCells {
    runs: Vec<Range<usize>>,
}

impl AskedCells {
    /// Every cell of the move.
    pub fn all() -> Self {
        AskedCells::from_run(0..CELLS)
    }

    /// The cells that contain the smallest and the largest demand of the law on the move. `knots_mm` are the places of the law's knots, as
    /// paths from the start of the move, mm. All cells if the law's turning points are not known.
    pub fn deciding(law: &SegmentLaw, places: &MovePlaces, knots_mm: &[f64]) -> Self {
        if law.is_uniform() {
            return AskedCells::from_run(0..1);
        }
        let mut runs = vec![around([0.0; 2]), around([1.0; 2])];
        let mut add = |ratios: [f64; 2]| {
            if ratios[1] >= 0.0 && ratios[0] <= 1.0 {
                runs.push(around(ratios));
            }
        };
        knots_mm.iter().for_each(|mm| add([mm / places.feed_length_mm(); 2]));
        if places.turn().is_some_and(|[_, _, sweep_rad]| sweep_rad < SWEEP_MIN_RAD) {
            return AskedCells::all();
        }
        let is_known = turning_points::each(law, &mut |[from, to]| {
            let Some([sense, start_rad, sweep_rad]) = places.turn() else { return };
            // In the sense of the arc, from its start, less than a turn.
            let first = sense * ((if sense > 0.0 { from } else { to }) - start_rad);
            let first = first - TAU * libm::floor(first / TAU);
            let ratios = |first: f64| [first / sweep_rad, (first + to - from) / sweep_rad];
            add(ratios(first));
            add(ratios(first - TAU));
        });
        if !is_known {
            return AskedCells::all();
        }
        runs.sort_unstable_by_key(|run| run.start);
        runs.dedup_by(|next, run| {
            let is_apart = next.start > run.end;
            run.end = if is_apart { run.end } else { run.end.max(next.end) };
            !is_apart
        });
        AskedCells { runs }
    }

    fn from_run(run: Range<usize>) -> Self {
        AskedCells { runs: once(run).collect() }
    }

    /// The chosen cells, as ranges of neighbouring cells in ascending order.
    pub fn runs(&self) -> &[Range<usize>] {
        &self.runs
    }

    /// Number of chosen cells.
    pub fn count(&self) -> usize {
        self.runs.iter().map(ExactSizeIterator::len).sum()
    }
}

/// The cells of these parts of a move, and one more on either side.
fn around([from, to]: [f64; 2]) -> Range<usize> {
    let cell = |ratio: f64| (ratio * CELLS as f64) as usize;
    cell(from).saturating_sub(1)..(cell(to) + 2).min(CELLS)
}
