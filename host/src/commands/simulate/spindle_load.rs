//! Power and torque of the spindle in each block, from simulated forces or estimated from the removal rate.
//!
//! ```text
//! P = k(h) Q,   k(h) = kc1.1 h^-mc     (1)
//! ```
//!
//! with the removal rate Q of the stock model and Kienzle's specific cutting force at half the feed per tooth that the
//! block's rule (or the tool) aims at: about the mean chip of a full slot. Source: docs/forces.md.

use arcfeed_hil_sim::removal::cutter::StockCutter;
use arcfeed_hil_sim::removal::load_statistics::LoadStatistics;
use arcfeed_hil_sim::removal::loads::LoadMeter;
use arcfeed_hil_sim::removal::trail::BlockRef;
use arcfeed_milling::cutting::material::Kienzle;
use arcfeed_model::job::Job;
use arcfeed_units::{MmPerTooth, S_PER_MIN};

use super::load_figures::by_place;
use super::material_figures::block_rates;
use super::observer::RunObserver;
use super::setup::Setup;
use crate::job::JobFile;
use crate::report::spindle::{BlockValue, SpindleFigures, SpindleLoadFigures};

/// Mean chip over the target feed per tooth in the estimate.
const MEAN_CHIP_RATIO: f64 = 0.5;

/// N mm per J.
const N_MM_PER_J: f64 = 1e3;

/// Largest power and torque of the spindle in each block of a run.
pub struct SpindleLoad {
    /// Largest power of each block, W.
    pub power_w: Vec<BlockValue>,
    /// Largest torque of each block, N m; `None` for an estimate.
    pub torque_n_m: Option<Vec<BlockValue>>,
}

impl SpindleLoad {
    /// Spindle load in a run; `None` if the job describes neither cutting edges nor a material.
    pub fn of(job: &Job, setup: &Setup<'_>, observer: &RunObserver) -> Option<Self> {
        match (&observer.loads, &setup.material, &observer.cutter) {
            (Some(meter), _, _) => Some(SpindleLoad {
                power_w: largest(meter, &|load| load.power.max()),
                torque_n_m: Some(largest(meter, &|load| load.torque.max())),
            }),
            (None, Some(material), Some(cutter)) => {
                Some(SpindleLoad { power_w: estimate(job, material, cutter), torque_n_m: None })
            }
            _ => None,
        }
    }
}

/// Results for both runs (`after`: adapted, `before`: original program), compared with the job's limits.
pub fn figures(file: &JobFile, setup: &Setup<'_>, [after, before]: [&SpindleLoad; 2]) -> SpindleFigures {
    let limits = file.spindle;
    let own = setup.material.as_ref().map(|material| specific_mpa(material, file.job.tools.first().feed_per_tooth));
    let torque = after.torque_n_m.as_deref().zip(before.torque_n_m.as_deref());
    SpindleFigures {
        source: if torque.is_some() { "cutting" } else { "estimate" },
        specific_force_n_per_mm2: own.filter(|_| torque.is_none()),
        power: SpindleLoadFigures::new(limits.power_w, [&after.power_w, &before.power_w]),
        torque: torque.map(|(after, before)| SpindleLoadFigures::new(limits.torque_n_m, [after, before])),
    }
}

fn largest(meter: &LoadMeter, value: &dyn Fn(&LoadStatistics) -> f64) -> Vec<BlockValue> {
    let blocks = by_place(meter, |count| count).into_values();
    blocks.map(|(of, load)| BlockValue { block: of.count, n: of.sequence, value: value(&load) }).collect()
}

fn estimate(job: &Job, material: &Kienzle, cutter: &StockCutter) -> Vec<BlockValue> {
    let power_w = |of: &BlockRef, mm3_per_min: f64| {
        let rule = of.rule.and_then(|rule| job.rules.get(rule));
        let target = rule.map_or(job.tools.first().feed_per_tooth, |rule| job.feed_per_tooth_of(rule));
        specific_mpa(material, target) * mm3_per_min / S_PER_MIN / N_MM_PER_J // (1)
    };
    let blocks = block_rates(cutter).into_iter();
    blocks
        .map(|(of, rate)| BlockValue { block: of.count, n: of.sequence, value: power_w(&of, rate) })
        .filter(|block| block.value > 0.0)
        .collect()
}

fn specific_mpa(material: &Kienzle, target: MmPerTooth) -> f64 {
    let chip_mm = MEAN_CHIP_RATIO * f64::from(target.0);
    material.specific_mpa * libm::pow(chip_mm, -material.exponent_ratio)
}
