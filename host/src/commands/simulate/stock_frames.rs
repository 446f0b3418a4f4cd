//! Stock at many times of a run, for the viewer: its heights before the run, and those that have changed at each of a bounded
//! number of times.
//!
//! The number of frames of a run of any length is bounded: if there are too many, or too many changes, two and two are
//! merged, and the time between them is doubled.

use arcfeed_dexel::deviation::HeightMap;
use arcfeed_dexel::lattice::Lattice;
use arcfeed_dexel::workpiece::Stock;
use arcfeed_hil_sim::removal::cutter::StockCutter;
use arcfeed_units::Micros;

use super::edges::UPRIGHT;

/// Most cells of the heights along an edge; more rays share a cell.
const CELLS_MAX: usize = 256;
/// Most frames of a run.
const FRAMES_MAX: usize = 128;
/// Most changes of all frames.
const CHANGES_MAX: usize = 1 << 20;
/// Time between two frames at first.
const INTERVAL: Micros = Micros::from_ms(100);
/// Longest time between two frames.
const INTERVAL_MAX: Micros = Micros::from_ms(3_600_000);
/// Change of a height that counts.
const CHANGE_MM: f64 = 1e-3;

/// Highest material over each cell of a grid, seen along Z, mm; `None` where nothing is left.
type Heights = Vec<Option<f64>>;

/// Heights of the stock that have changed since the preceding frame.
#[derive(Clone, Debug, PartialEq)]
pub struct StockFrame {
    /// Machine time of the frame.
    pub at: Micros,
    /// Changed cells in ascending order, each with its new height, mm; `None` if nothing is left there.
    pub changes: Vec<(usize, Option<f64>)>,
}

/// Heights of a stock on a grid in the XY plane, before a run and at many times of it.
#[derive(Debug)]
pub struct StockFrames {
    /// Rays along an edge of a cell.
    shared: usize,
    /// Number of grid cells along X.
    pub columns: usize,
    /// Heights before the run.
    pub first: Heights,
    last: Heights,
    frames: Vec<StockFrame>,
    interval: Micros,
    next: Micros,
    /// Pieces of the path that had been cut at the last frame.
    pieces: usize,
}

impl StockFrames {
    /// Records the heights of a stock before its run.
    pub fn new(stock: &Stock) -> Self {
        let [columns, rows] = stock.lattice().size(UPRIGHT);
        let shared = columns.max(rows).div_ceil(CELLS_MAX).max(1);
        let first = heights(stock, shared);
        let (last, columns) = (first.clone(), columns.div_ceil(shared));
        StockFrames { shared, columns, first, last, frames: Vec::new(), interval: INTERVAL, next: INTERVAL, pieces: 0 }
    }

    /// Records the stock after it has been cut up to the time `now`.
    pub fn observe(&mut self, now: Micros, cutter: &StockCutter) {
        if now >= self.next {
            self.next = now.after(self.interval);
            self.take(now, cutter);
        }
    }

    /// Records the stock at the end of the run.
    pub fn end(&mut self, now: Micros, cutter: &StockCutter) {
        self.take(now, cutter);
    }

    /// Frames in the order of time.
    pub fn frames(&self) -> &[StockFrame] {
        &self.frames
    }

    /// X and Y of the grid's lowest corner, mm.
    pub fn lowest_mm(lattice: &Lattice) -> [f64; 2] {
        Lattice::across(UPRIGHT).map(|axis| lattice.lowest_mm()[axis])
    }

    /// Length of a cell's edge, mm.
    pub fn step_mm(&self, lattice: &Lattice) -> f64 {
        lattice.step_mm() * self.shared as f64
    }

    fn take(&mut self, at: Micros, cutter: &StockCutter) {
        let pieces = cutter.pieces().len();
        if pieces == self.pieces {
            return;
        }
        self.pieces = pieces;
        let now = heights(cutter.stock(), self.shared);
        let differs = |before: Option<f64>, now: Option<f64>| match (before, now) {
            (Some(before), Some(now)) => (before - now).abs() >= CHANGE_MM,
            (before, now) => before.is_some() != now.is_some(),
        };
        let pairs = self.last.iter().zip(&now).enumerate();
        let changes: Vec<_> =
            pairs.filter(|(_, (a, b))| differs(**a, **b)).map(|(cell, (_, now))| (cell, *now)).collect();
        for (cell, height) in &changes {
            self.last[*cell] = *height;
        }
        if !changes.is_empty() {
            self.add(StockFrame { at, changes });
        }
    }

    fn add(&mut self, frame: StockFrame) {
        self.frames.push(frame);
        let changes = |frames: &[StockFrame]| frames.iter().map(|frame| frame.changes.len()).sum::<usize>();
        while self.frames.len() > 1 && (self.frames.len() > FRAMES_MAX || changes(&self.frames) > CHANGES_MAX) {
            self.interval = Micros(2 * self.interval.0).min(INTERVAL_MAX);
            let pairs = std::mem::take(&mut self.frames);
            let mut pairs = pairs.into_iter();
            while let Some(early) = pairs.next() {
                self.frames.push(match pairs.next() {
                    Some(late) => merged(early, late),
                    None => early,
                });
            }
        }
    }
}

/// Both frames at the time of the second: its heights, and those of the first that it does not change.
fn merged(early: StockFrame, late: StockFrame) -> StockFrame {
    let mut changes = Vec::with_capacity(early.changes.len() + late.changes.len());
    let mut old = early.changes.into_iter().peekable();
    for (cell, height) in late.changes {
        while let Some(before) = old.next_if(|(before, _)| *before < cell) {
            changes.push(before);
        }
        let _replaced = old.next_if(|(before, _)| *before == cell);
        changes.push((cell, height));
    }
    changes.extend(old);
    StockFrame { at: late.at, changes }
}

/// Highest material over each cell.
fn heights(stock: &Stock, shared: usize) -> Heights {
    let [columns, _] = stock.lattice().size(UPRIGHT);
    let map = HeightMap::new(stock, UPRIGHT);
    let rows: Vec<&[Option<f64>]> = map.heights_mm().chunks(columns.max(1)).collect();
    let width = columns.div_ceil(shared);
    let cells = rows.chunks(shared).flat_map(|rows| (0..width).map(move |column| (rows, column)));
    let highest = cells.map(|(rows, column)| {
        let cells = rows.iter().flat_map(|row| row.iter().skip(column * shared).take(shared)).flatten();
        cells.copied().reduce(f64::max)
    });
    highest.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(ms: u64, changes: &[(usize, f64)]) -> StockFrame {
        let changes = changes.iter().map(|(cell, height)| (*cell, Some(*height))).collect();
        StockFrame { at: Micros::from_ms(ms), changes }
    }

    #[test]
    fn merged_frames_have_the_later_height_of_each_cell() {
        let both = merged(frame(1, &[(1, -1.0), (4, -1.0), (7, -1.0)]), frame(2, &[(0, -2.0), (4, -2.0), (9, -2.0)]));
        assert_eq!(both, frame(2, &[(0, -2.0), (1, -1.0), (4, -2.0), (7, -1.0), (9, -2.0)]));
    }

    #[test]
    fn a_run_of_any_length_has_a_bounded_number_of_frames_that_add_up_to_its_end() {
        let (shared, columns, first) = (1, 100, vec![Some(0.0); 100]);
        let (last, next, pieces) = (first.clone(), INTERVAL, 0);
        let mut all = StockFrames {
            shared,
            columns,
            first: first.clone(),
            last,
            frames: Vec::new(),
            interval: INTERVAL,
            next,
            pieces,
        };
        let mut wanted = first;
        for index in 0..10_000 {
            let (cell, height) = (index * 37 % 100, -(index as f64));
            wanted[cell] = Some(height);
            all.add(frame(index as u64, &[(cell, height)]));
        }
        assert!(all.frames.len() <= FRAMES_MAX && all.frames.len() >= FRAMES_MAX / 2, "{}", all.frames.len());
        let mut replayed = all.first.clone();
        for (cell, height) in all.frames.iter().flat_map(|frame| &frame.changes) {
            replayed[*cell] = *height;
        }
        assert_eq!(replayed, wanted);
        assert_eq!(all.frames.last().map(|frame| frame.at), Some(Micros::from_ms(9_999)));
    }
}
