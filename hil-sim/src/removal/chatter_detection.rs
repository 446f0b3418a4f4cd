//! Chatter detection: whether each tooth of a run finds the tool at the same position as the tooth before.
//!
//! The tool's position relative to the workpiece is sampled once a tooth, at the same angle of the spindle; for a ring
//! once for an outer and an inner tooth together, which differ. The samples of a block are evaluated in separate
//! windows (docs/forces.md); the worst window gives the block's result. The window after the tool enters, or has
//! descended to its level, is left out, and so is a cut too short for a window.
//!
//! Source: own; the metric is that of [`arcfeed_modal::dynamics::chatter`].

use nalgebra::Vector3;

use arcfeed_modal::dynamics::chatter::{Sampling, Verdict, metric_mm};

use super::trail::BlockRef;

/// Number of samples in a window.
const WINDOW: usize = 32;

/// Change of the tool's position from tooth to tooth, as a fraction of the feed per tooth, up to which a cut counts as stable.
pub const FLOOR_RATIO: f64 = 0.05;

/// Result of chatter detection for one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChatterResult {
    /// Block in which the tool cut.
    pub block: BlockRef,
    /// Mean change of the tool's position from tooth to tooth in the worst window.
    pub metric_mm: f64,
    /// Verdict for that window.
    pub verdict: Verdict,
}

/// Tool positions of a run, sampled once per tooth, from which chatter is detected.
#[derive(Clone, Debug)]
pub struct ChatterSamples {
    sampling: Sampling,
    /// Samples of the present cut and its last block.
    window: Vec<Vector3<f64>>,
    /// Whole windows since the tool entered.
    windows: usize,
    block: Option<BlockRef>,
    blocks: Vec<ChatterResult>,
}

impl ChatterSamples {
    /// Empty samples. `per_turn` is their number per turn; changes of position up to `floor_mm` count as none.
    pub fn new(per_turn: usize, floor_mm: f64) -> Self {
        let sampling = Sampling { teeth: per_turn, tooth_hz: 0.0, floor_mm };
        ChatterSamples { sampling, window: Vec::new(), windows: 0, block: None, blocks: Vec::new() }
    }

    /// Number of samples per turn.
    pub fn per_turn(&self) -> usize {
        self.sampling.teeth
    }

    /// Largest change of position that counts as no change.
    pub fn floor_mm(&self) -> f64 {
        self.sampling.floor_mm
    }

    /// Adds the next sample, the tool's position relative to the workpiece, at this spindle speed.
    pub fn add(&mut self, block: &BlockRef, place_mm: Vector3<f64>, rev_per_s: f64) {
        if self.block.replace(*block).is_some_and(|before| before != *block) {
            self.window.clear();
        }
        self.window.push(place_mm);
        if self.window.len() < WINDOW {
            return;
        }
        self.sampling.tooth_hz = rev_per_s * self.sampling.teeth as f64;
        if self.windows > 0 {
            self.evaluate(*block);
        }
        self.windows += 1;
        self.window.clear();
    }

    /// Ends the cut: the next window is the first one of another cut.
    pub fn lift(&mut self) {
        self.window.clear();
        (self.windows, self.block) = (0, None);
    }

    /// Results of the blocks that were long enough, in order.
    pub fn blocks(&self) -> &[ChatterResult] {
        &self.blocks
    }

    fn evaluate(&mut self, block: BlockRef) {
        let now = ChatterResult {
            block,
            metric_mm: metric_mm(&self.window, 1),
            verdict: self.sampling.evaluate(&self.window),
        };
        match self.blocks.last_mut().filter(|result| result.block == block) {
            None => self.blocks.push(now),
            Some(result) if result.metric_mm < now.metric_mm => *result = now,
            Some(_) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(count: u32) -> BlockRef {
        BlockRef { count, sequence: None, rule: None, is_rapid: false }
    }

    #[test]
    fn the_worst_window_counts_and_the_first_does_not() {
        let mut samples = ChatterSamples::new(4, 1e-3);
        let mut take = |count: u32, off_mm: f64| {
            for n in 0..WINDOW {
                let place_mm = if n % 2 == 0 { off_mm } else { -off_mm };
                samples.add(&block(count), Vector3::new(place_mm, 0.0, 0.0), 50.0);
            }
        };
        take(1, 9.0);
        take(1, 0.0);
        take(1, 0.01);
        take(1, 0.0);
        take(2, 0.0);
        let found: Vec<(u32, f64, Verdict)> =
            samples.blocks().iter().map(|result| (result.block.count, result.metric_mm, result.verdict)).collect();
        assert_eq!(found.len(), 2);
        assert!((found[0].1 - 0.02).abs() < 1e-12);
        assert_eq!([found[0].2, found[1].2], [Verdict::PeriodDoubling, Verdict::Stable]);
    }

    #[test]
    fn a_cut_that_is_too_short_has_no_result() {
        let mut samples = ChatterSamples::new(4, 1e-3);
        for _ in 0..3 {
            (0..2 * WINDOW - 1).for_each(|_| samples.add(&block(1), Vector3::zeros(), 50.0));
            samples.lift();
        }
        assert!(samples.blocks().is_empty());
    }
}
