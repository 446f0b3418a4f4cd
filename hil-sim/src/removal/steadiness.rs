//! Whether each tooth of a run finds the tool where the one before did.
//!
//! The tool's place against the workpiece is sampled once a tooth, at the same angle of the spindle; of a ring once for an outer
//! and an inner tooth together, which are not alike. A block's samples are judged in windows, each by itself (docs/forces.md), and the
//! block is as its worst window is. What a tool does when it enters, or has come down to its level, is left out, and what it does in a cut too short for a window.
//!
//! Source: own; the metric is that of [`crate::dynamics::chatter`].

use nalgebra::Vector3;

use crate::dynamics::chatter::{Sampling, Verdict, metric_mm};

use super::trail::Of;

/// Samples of a window.
const WINDOW: usize = 32;

/// Part of the feed per tooth that counts as no change.
pub const FLOOR_RATIO: f64 = 0.05;

/// How a block cuts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steadiness {
    /// Which one.
    pub of: Of,
    /// Mean change of the tool's place from tooth to tooth in the worst window.
    pub metric_mm: f64,
    /// What repeats there.
    pub verdict: Verdict,
}

/// The samples of a run.
#[derive(Clone, Debug)]
pub struct Samples {
    sampling: Sampling,
    /// Of the cut that is not over, and of its last block.
    window: Vec<Vector3<f64>>,
    /// Since the tool entered, in whole windows.
    windows: usize,
    of: Option<Of>,
    blocks: Vec<Steadiness>,
}

impl Samples {
    /// None yet; so many in a turn, and what counts as no change.
    pub fn new(a_turn: usize, floor_mm: f64) -> Self {
        let sampling = Sampling { teeth: a_turn, tooth_hz: 0.0, floor_mm };
        Samples { sampling, window: Vec::new(), windows: 0, of: None, blocks: Vec::new() }
    }

    /// How many are taken in a turn.
    pub fn a_turn(&self) -> usize {
        self.sampling.teeth
    }

    /// What counts as no change.
    pub fn floor_mm(&self) -> f64 {
        self.sampling.floor_mm
    }

    /// The next one.
    pub fn take(&mut self, of: &Of, place_mm: Vector3<f64>, rev_per_s: f64) {
        if self.of.replace(*of).is_some_and(|before| before != *of) {
            self.window.clear();
        }
        self.window.push(place_mm);
        if self.window.len() < WINDOW {
            return;
        }
        self.sampling.tooth_hz = rev_per_s * self.sampling.teeth as f64;
        if self.windows > 0 {
            self.judge(*of);
        }
        self.windows += 1;
        self.window.clear();
    }

    /// The tool has left the cut, or is in another one: the next window is its first.
    pub fn lift(&mut self) {
        self.window.clear();
        (self.windows, self.of) = (0, None);
    }

    /// The blocks that could be judged, in order.
    pub fn blocks(&self) -> &[Steadiness] {
        &self.blocks
    }

    fn judge(&mut self, of: Of) {
        let now = Steadiness { of, metric_mm: metric_mm(&self.window, 1), verdict: self.sampling.judge(&self.window) };
        match self.blocks.last_mut().filter(|block| block.of == of) {
            None => self.blocks.push(now),
            Some(block) if block.metric_mm < now.metric_mm => *block = now,
            Some(_) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(count: u32) -> Of {
        Of { count, sequence: None, rule: None, is_rapid: false }
    }

    #[test]
    fn the_worst_window_counts_and_the_first_does_not() {
        let mut samples = Samples::new(4, 1e-3);
        let mut take = |count: u32, off_mm: f64| {
            for n in 0..WINDOW {
                let place_mm = if n % 2 == 0 { off_mm } else { -off_mm };
                samples.take(&block(count), Vector3::new(place_mm, 0.0, 0.0), 50.0);
            }
        };
        take(1, 9.0);
        take(1, 0.0);
        take(1, 0.01);
        take(1, 0.0);
        take(2, 0.0);
        let found: Vec<(u32, f64, Verdict)> =
            samples.blocks().iter().map(|block| (block.of.count, block.metric_mm, block.verdict)).collect();
        assert_eq!(found.len(), 2);
        assert!((found[0].1 - 0.02).abs() < 1e-12);
        assert_eq!([found[0].2, found[1].2], [Verdict::PeriodDoubling, Verdict::Stable]);
    }

    #[test]
    fn a_cut_that_is_too_short_is_not_judged() {
        let mut samples = Samples::new(4, 1e-3);
        for _ in 0..3 {
            (0..2 * WINDOW - 1).for_each(|_| samples.take(&block(1), Vector3::zeros(), 50.0));
            samples.lift();
        }
        assert!(samples.blocks().is_empty());
    }
}
