//! Statistics of the chip load of a run, accumulated sample by sample.

/// A chip counts as thin if it is below its target by more than this fraction of the target.
pub const THIN_RATIO: f64 = 0.02;

/// Statistics of the chip load of a run, each sample as its ratio to the target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChipFigures {
    /// Smallest ratio of chip to target.
    pub min_ratio: f64,
    /// Largest ratio of chip to target.
    pub max_ratio: f64,
    /// Number of samples.
    pub samples: u64,
    /// Number of samples whose chip is below the target by more than [`THIN_RATIO`].
    pub thin: u64,
    square_sum: f64,
}

impl Default for ChipFigures {
    fn default() -> Self {
        ChipFigures { min_ratio: f64::INFINITY, max_ratio: f64::NEG_INFINITY, samples: 0, thin: 0, square_sum: 0.0 }
    }
}

impl ChipFigures {
    /// Adds one sample of the ratio of chip to target.
    pub fn add(&mut self, ratio: f64) {
        self.min_ratio = self.min_ratio.min(ratio);
        self.max_ratio = self.max_ratio.max(ratio);
        self.samples += 1;
        self.thin += u64::from(ratio < 1.0 - THIN_RATIO);
        self.square_sum += (ratio - 1.0) * (ratio - 1.0);
    }

    /// Adds all samples of other statistics.
    pub fn merge(&mut self, other: &ChipFigures) {
        self.min_ratio = self.min_ratio.min(other.min_ratio);
        self.max_ratio = self.max_ratio.max(other.max_ratio);
        self.samples += other.samples;
        self.thin += other.thin;
        self.square_sum += other.square_sum;
    }

    /// Root mean square of (chip / target - 1); `None` without samples.
    pub fn rms_error_ratio(&self) -> Option<f64> {
        (self.samples > 0).then(|| libm::sqrt(self.square_sum / self.samples as f64))
    }

    /// Smallest and largest value of (chip / target - 1); `None` without samples.
    pub fn error_ratio_range(&self) -> Option<(f64, f64)> {
        (self.samples > 0).then_some((self.min_ratio - 1.0, self.max_ratio - 1.0))
    }
}

/// Numbers of samples that are left out of [`ChipFigures`], by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExcludedSamples {
    /// The machine was not within 0.5 % of the commanded feed during the whole cut of the tooth.
    pub not_steady: u64,
    /// The block ended during the cut of the tooth.
    pub block_end: u64,
    /// The cutting circle met no stock, or met it at a place where the contact formula is not valid.
    pub no_contact: u64,
}

impl ExcludedSamples {
    /// Number of all excluded samples.
    pub fn total(&self) -> u64 {
        self.not_steady + self.block_end + self.no_contact
    }

    /// Adds the counts of another run.
    pub fn merge(&mut self, other: &ExcludedSamples) {
        self.not_steady += other.not_steady;
        self.block_end += other.block_end;
        self.no_contact += other.no_contact;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_two_halves_are_the_figures_of_the_whole() {
        let ratios = [0.98, 1.0, 1.004, 0.991];
        let mut whole = ChipFigures::default();
        let (mut left, mut right) = (ChipFigures::default(), ChipFigures::default());
        for (index, ratio) in ratios.into_iter().enumerate() {
            whole.add(ratio);
            if index < 2 { left.add(ratio) } else { right.add(ratio) }
        }
        left.merge(&right);
        assert_eq!(left, whole);
        let rms = libm::sqrt((4e-4 + 1.6e-5 + 8.1e-5) / 4.0);
        assert!((whole.rms_error_ratio().unwrap() - rms).abs() < 1e-12);
    }

    #[test]
    fn nothing_measured_gives_no_figures() {
        assert_eq!(ChipFigures::default().rms_error_ratio(), None);
        assert_eq!(ChipFigures::default().error_ratio_range(), None);
    }
}
