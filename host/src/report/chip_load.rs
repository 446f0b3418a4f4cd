//! Measured chip load as results: of a run, of each tool and of each cut rule (JSON keys of docs/json.md).

use arcfeed_model::report::{ChipFigures, ExcludedSamples};
use arcfeed_units::LengthUnit;
use serde::Serialize;

/// Measured chip load (feed per tooth or chip thickness) of the moves that a cut rule selects; lengths in the job's
/// unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ChipLoadFigures {
    /// Target; `None` (null) if the moves have several.
    pub target: Option<f64>,
    /// Smallest measured value at steady feed; `None` with several targets.
    pub min: Option<f64>,
    /// Largest measured value at steady feed; `None` with several targets.
    pub max: Option<f64>,
    /// Root mean square of (measured - target) / target over the steady samples.
    pub rms_error_ratio: f64,
    /// Smallest (measured - target) / target of the steady samples.
    pub error_ratio_min: f64,
    /// Largest (measured - target) / target of the steady samples.
    pub error_ratio_max: f64,
    /// Largest (measured - target) / target of all samples in the cut, including those that are not steady.
    pub error_ratio_max_all: f64,
    /// Number of samples measured at steady feed.
    pub samples: u64,
    /// Number of steady samples more than 2 % below the target.
    pub samples_thin: u64,
    /// Number of samples that are not steady.
    pub samples_left_out: u64,
    /// Samples that are not steady, by cause.
    pub left_out: LeftOutSamples,
}

/// Numbers of samples that are not steady, by cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct LeftOutSamples {
    /// The feed was not within 0.5 % of the commanded one throughout the tooth's cut: the axes accelerated or braked.
    pub not_steady: u64,
    /// The block ended within the tooth's cut.
    pub block_end: u64,
    /// The law has no contact point with the stock there.
    pub no_contact: u64,
}

/// Chip load of all moves that the cut rules of one tool match.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ToolFigures {
    /// T number, if the job or the program gives one.
    pub tool: Option<i64>,
    /// Measured chip load; `None` without samples.
    pub chip_load: Option<ChipLoadFigures>,
    /// Measured chip load of the original program; `None` without samples.
    pub baseline_chip_load: Option<ChipLoadFigures>,
}

/// Chip samples of several moves together.
#[derive(Clone, Copy, Debug, Default)]
pub struct ChipSamples {
    /// Steady samples.
    pub steady: ChipFigures,
    /// All samples.
    pub all: ChipFigures,
    /// Samples that are not steady.
    pub left_out: ExcludedSamples,
}

impl ChipLoadFigures {
    /// Results of these samples; `None` if there are none. `target_mm` is `None` if the moves have several targets.
    pub fn new(samples: &ChipSamples, target_mm: Option<f64>, unit: LengthUnit) -> Option<Self> {
        let ChipSamples { steady, all, left_out } = samples;
        let (error_ratio_min, error_ratio_max) = steady.error_ratio_range()?;
        let target = target_mm.map(|mm| mm / unit.mm());
        let times = |ratio: f64| target.map(|target| target * ratio);
        Some(ChipLoadFigures {
            target,
            min: times(steady.min_ratio),
            max: times(steady.max_ratio),
            rms_error_ratio: steady.rms_error_ratio()?,
            error_ratio_min,
            error_ratio_max,
            error_ratio_max_all: all.error_ratio_range()?.1,
            samples: steady.samples,
            samples_thin: steady.thin,
            samples_left_out: left_out.total(),
            left_out: LeftOutSamples {
                not_steady: left_out.not_steady,
                block_end: left_out.block_end,
                no_contact: left_out.no_contact,
            },
        })
    }
}
