//! Removal rates: volume over time, in windows long enough for the resolution of the rays.
//!
//! Rays are one step apart, so material removed on less than a step appears in lumps. A window lasts at least a quarter
//! of a second and covers at least four steps of the path, unless the axes stop earlier.

use arcfeed_units::{Micros, S_PER_MIN};

use super::trail::SECTION_TIME_MAX;

/// Steps between rays that a window covers.
const STEPS: f64 = 4.0;

/// Volume that was removed on one path section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Index of the section's block among the blocks that cut.
    pub block: usize,
    /// Beginning of the section.
    pub from: Micros,
    /// End of the section.
    pub to: Micros,
    /// Length of the section.
    pub path_mm: f64,
    /// Volume that the rays along x, y, z measure, mm3.
    pub removed: [f64; 3],
}

/// Time window with the volume removed in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateWindow {
    /// Beginning of the window.
    pub from: Micros,
    /// End of the window.
    pub to: Micros,
    /// Removed volume: the mean of what the rays along x, y and z measure.
    pub removed_mm3: f64,
    path_mm: f64,
    /// Total time of the path sections.
    cut: Micros,
}

/// Removed volume and largest removal rate of several path sections together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RemovedVolume {
    /// Volume that the rays along x, y, z measure, mm3.
    pub removed: [f64; 3],
    /// Total time of the path sections that removed material.
    pub time: Micros,
    /// Largest removal rate of all windows, mm3/min.
    pub rate_max_per_min: f64,
}

impl Piece {
    /// Volume, mm3, as the mean of the three families of rays.
    pub fn mean_mm3(&self) -> f64 {
        mean(&self.removed)
    }
}

impl RateWindow {
    /// Removal rate: volume over the time of the window's path sections, mm3/min.
    pub fn rate_per_min(&self) -> f64 {
        self.removed_mm3 / self.cut.to_s() * S_PER_MIN
    }
}

impl RemovedVolume {
    /// Volume removed in all `pieces`, which must be in the order of time, and the largest rate; `step_mm` is the distance of the rays.
    pub fn of<'p>(pieces: impl Iterator<Item = &'p Piece> + Clone, step_mm: f64) -> Self {
        let mut removed_volume = RemovedVolume::default();
        for piece in pieces.clone().filter(|piece| piece.mean_mm3() > 0.0) {
            removed_volume.time = removed_volume.time.after(piece.to.since(piece.from));
            removed_volume.removed.iter_mut().zip(piece.removed).for_each(|(sum, removed)| *sum += removed);
        }
        let pieces: Vec<RateWindow> = pieces.map(RateWindow::of).collect();
        removed_volume.rate_max_per_min = rate_max_per_min(&pieces, step_mm);
        removed_volume
    }

    /// Volume, mm3, as the mean of the three families of rays.
    pub fn mean_mm3(&self) -> f64 {
        mean(&self.removed)
    }

    /// Largest less smallest of the volumes that the three families of rays measured, mm3.
    pub fn spread_mm3(&self) -> f64 {
        let [x, y, z] = self.removed;
        x.max(y).max(z) - x.min(y).min(z)
    }

    /// Mean rate over the time of removal, mm3/min.
    pub fn rate_mean_per_min(&self) -> f64 {
        if self.time.0 > 0 { self.mean_mm3() / self.time.to_s() * S_PER_MIN } else { 0.0 }
    }
}

/// Divides the path sections, in the order of time, into consecutive windows; `step_mm` is the distance of the rays.
pub fn windows<'p>(pieces: impl Iterator<Item = &'p Piece>, step_mm: f64) -> Vec<RateWindow> {
    let mut windows: Vec<RateWindow> = Vec::new();
    for piece in pieces {
        let own = RateWindow::of(piece);
        match windows.last_mut().filter(|window| window.continues(&own) && !window.is_long(step_mm)) {
            Some(window) => window.join(&own),
            None => windows.push(own),
        }
    }
    let is_rest = |pair: &[RateWindow]| pair[0].continues(&pair[1]) && !pair[1].is_long(step_mm);
    if windows.len() > 1 && is_rest(&windows[windows.len() - 2..]) {
        let rest = windows.pop();
        windows.last_mut().zip(rest).into_iter().for_each(|(last, rest)| last.join(&rest));
    }
    windows
}

/// Largest rate of all windows that begin with a piece, mm3/min. Pieces between two pauses that do not fill a window
/// form one.
fn rate_max_per_min(pieces: &[RateWindow], step_mm: f64) -> f64 {
    let mut most: f64 = 0.0;
    for (start, first) in pieces.iter().enumerate() {
        let mut window = *first;
        for next in &pieces[start + 1..] {
            if window.is_long(step_mm) || !window.continues(next) {
                break;
            }
            window.join(next);
        }
        let is_first = start.checked_sub(1).is_none_or(|before| !pieces[before].continues(first));
        if is_first || window.is_long(step_mm) {
            most = most.max(window.rate_per_min());
        }
    }
    most
}

impl RateWindow {
    fn of(piece: &Piece) -> Self {
        let Piece { from, to, path_mm, .. } = *piece;
        RateWindow { from, to, removed_mm3: piece.mean_mm3(), path_mm, cut: to.since(from) }
    }

    fn is_long(&self, step_mm: f64) -> bool {
        self.cut >= SECTION_TIME_MAX && self.path_mm >= STEPS * step_mm
    }

    fn continues(&self, next: &RateWindow) -> bool {
        next.from.since(self.to) < SECTION_TIME_MAX
    }

    fn join(&mut self, next: &RateWindow) {
        self.to = next.to;
        self.removed_mm3 += next.removed_mm3;
        self.path_mm += next.path_mm;
        self.cut = self.cut.after(next.cut);
    }
}

fn mean(by_axis: &[f64; 3]) -> f64 {
    by_axis.iter().sum::<f64>() / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(from_ms: u64, to_ms: u64, path_mm: f64, removed: f64) -> Piece {
        let [from, to] = [from_ms, to_ms].map(Micros::from_ms);
        Piece { block: 0, from, to, path_mm, removed: [removed; 3] }
    }

    #[test]
    fn a_window_lasts_until_its_path_is_long_enough_and_a_remainder_joins_the_window_before() {
        let pieces: Vec<Piece> = (0..9).map(|n| piece(n * 100, n * 100 + 100, 1.0, f64::from(n as u32))).collect();
        let spans = |step_mm: f64| -> Vec<(u64, u64, f64)> {
            let windows = windows(pieces.iter(), step_mm);
            windows.iter().map(|w| (w.from.0 / 1000, w.to.0 / 1000, w.removed_mm3)).collect()
        };
        assert_eq!(spans(0.1), [(0, 300, 3.0), (300, 600, 12.0), (600, 900, 21.0)]);
        assert_eq!(spans(1.0), [(0, 400, 6.0), (400, 900, 30.0)]);
    }

    #[test]
    fn standing_still_is_no_cutting_time() {
        let pieces = [piece(0, 200, 9.0, 2.0), piece(5_000, 5_300, 9.0, 1.0), piece(5_300, 5_600, 9.0, 0.0)];
        let removed_volume = RemovedVolume::of(pieces.iter(), 0.1);
        assert_eq!(
            (removed_volume.time, removed_volume.removed, removed_volume.spread_mm3()),
            (Micros::from_ms(500), [3.0; 3], 0.0)
        );
        assert!(
            (removed_volume.rate_mean_per_min() - 360.0).abs() < 1e-9
                && (removed_volume.rate_max_per_min - 600.0).abs() < 1e-9
        );
    }
}
