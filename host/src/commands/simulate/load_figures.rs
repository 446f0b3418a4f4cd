//! Loads of the cutting edges (chips, forces, power), as results for the report and over time.

use std::collections::BTreeMap;

use arcfeed_hil_sim::removal::load_statistics::LoadStatistics;
use arcfeed_hil_sim::removal::loads::LoadMeter;
use arcfeed_hil_sim::removal::trail::BlockRef;
use arcfeed_modal::dynamics::chatter::Verdict;
use arcfeed_units::LengthUnit;

use super::block_pairs::{BlockPairs, BlockPlace};
use super::material_figures::left_out_figures;
use crate::report::loads::{
    LoadBlockFigures, LoadFigures, LoadRuleFigures, LoadsFigures, UnstableFigures, VibrationFigures,
};
use crate::report::page::plot::{Lane, Series};

/// W per kW.
const W_PER_KW: f64 = 1e3;

/// Results for the cutting loads of a run and of the original program.
pub fn figures((unit, pairs): (LengthUnit, &BlockPairs), meter: &LoadMeter, baseline: &LoadMeter) -> LoadsFigures {
    let runs = [meter, baseline];
    let of = |choose: &dyn Fn(&BlockRef) -> bool| runs.map(|run| load(&sum(run, choose), unit));
    let [total, before] = of(&|_| true);
    let mut rules: Vec<Option<usize>> = runs.iter().flat_map(|run| run.blocks()).map(|(of, _)| of.rule).collect();
    rules.sort_unstable_by_key(|rule| rule.unwrap_or(usize::MAX));
    rules.dedup();
    let rules = rules.into_iter().map(|rule| {
        let [load, baseline] = of(&|of| of.rule == rule);
        LoadRuleFigures { rule: rule.map(|rule| rule + 1), load, baseline }
    });
    let layers = meter.process().engagement().layers();
    LoadsFigures {
        unit: unit.label(),
        load: total,
        baseline: before,
        layer: layers.rise_mm() / unit.mm(),
        step_deg: meter.step_rad().to_degrees(),
        rules: rules.collect(),
        blocks: blocks((unit, pairs), meter, baseline),
        vibration: (!meter.process().vibration().is_rigid()).then(|| vibration(unit, meter, baseline)),
        marks: None,
        baseline_marks: None,
        left_out: meter
            .left_out()
            .iter()
            .map(|left_out| left_out_figures(left_out.reason, &left_out.first, left_out.blocks))
            .collect(),
    }
}

fn vibration(unit: LengthUnit, meter: &LoadMeter, baseline: &LoadMeter) -> VibrationFigures {
    let worst = |meter: &LoadMeter| meter.chatter().iter().map(|block| block.metric_mm / unit.mm()).reduce(f64::max);
    let unstable = |meter: &LoadMeter| {
        let unstable = meter.chatter().iter().filter_map(|block| {
            let verdict = match block.verdict {
                Verdict::Stable => return None,
                Verdict::Uneven => "uneven",
                Verdict::PeriodDoubling => "period-doubling",
                Verdict::Chatter { .. } => "chatter",
            };
            let BlockRef { count, sequence, rule, .. } = block.block;
            let (rule, metric) = (rule.map(|rule| rule + 1), block.metric_mm / unit.mm());
            Some(UnstableFigures { block: count, n: sequence, rule, verdict, metric })
        });
        unstable.collect()
    };
    VibrationFigures {
        floor: meter.floor_mm() / unit.mm(),
        workpiece_hz: meter.workpiece_hz().collect(),
        judged_blocks: meter.chatter().len(),
        metric_max: worst(meter),
        baseline_metric_max: worst(baseline),
        unstable: unstable(meter),
        baseline_unstable: unstable(baseline),
    }
}

/// Curves of force and power over time, of the run (`after`) and of the original program (`before`).
pub fn lanes(after: &LoadMeter, before: &LoadMeter) -> [Lane; 2] {
    let lane = |title: &str, value: &dyn Fn(&LoadStatistics) -> f64| {
        let series = [("before", "#999", before), ("after", "#c03020", after)].map(|(name, color, meter)| {
            let step = |window: &arcfeed_hil_sim::removal::load_statistics::LoadWindow| {
                ([window.from.to_s(), window.to.to_s()], value(&window.statistics))
            };
            Series { name, color, steps: meter.windows().iter().map(step).collect() }
        });
        Lane { title: title.into(), series: series.into(), mark: None, has_gaps: false }
    };
    [
        lane("largest bending force, N", &|statistics| statistics.bending.max()),
        lane("mean power in the cut, kW", &|statistics| statistics.mean(&statistics.power) / W_PER_KW),
    ]
}

fn sum(meter: &LoadMeter, choose: &dyn Fn(&BlockRef) -> bool) -> LoadStatistics {
    let mut sum = LoadStatistics::default();
    meter.blocks().iter().filter(|(of, _)| choose(of)).for_each(|(_, statistics)| sum.merge(statistics));
    sum
}

/// Blocks of the run, with those of the original program if it has the same block.
fn blocks((unit, pairs): (LengthUnit, &BlockPairs), meter: &LoadMeter, baseline: &LoadMeter) -> Vec<LoadBlockFigures> {
    let after = by_place(meter, |count| pairs.place(count));
    let before = by_place(baseline, BlockPlace::Original);
    let block = |(place, (of, statistics)): (&BlockPlace, &(BlockRef, LoadStatistics))| {
        let before = before.get(place).filter(|(other, _)| other.sequence == of.sequence);
        LoadBlockFigures {
            block: of.count,
            n: of.sequence,
            rule: of.rule.map(|rule| rule + 1),
            load: load(statistics, unit),
            baseline: before.map(|(_, statistics)| load(statistics, unit)),
        }
    };
    let mut blocks: Vec<LoadBlockFigures> = after.iter().map(block).collect();
    blocks.sort_by_key(|block| block.block);
    blocks
}

/// Load statistics of a run, summed over the blocks for which `place` returns the same value.
pub fn by_place<P: Ord>(meter: &LoadMeter, place: impl Fn(u32) -> P) -> BTreeMap<P, (BlockRef, LoadStatistics)> {
    let mut found = BTreeMap::new();
    for (of, statistics) in meter.blocks() {
        found.entry(place(of.count)).or_insert((*of, LoadStatistics::default())).1.merge(statistics);
    }
    found
}

fn load(statistics: &LoadStatistics, unit: LengthUnit) -> LoadFigures {
    let in_unit = |mm: f64| mm / unit.mm();
    LoadFigures {
        time_s: statistics.time_s,
        force_max_n: statistics.bending.max(),
        force_mean_n: statistics.mean(&statistics.bending),
        force_variation_ratio: statistics.variation_ratio(),
        thrust_max_n: statistics.thrust.max(),
        thrust_mean_n: statistics.mean(&statistics.thrust),
        torque_max_n_m: statistics.torque.max(),
        torque_mean_n_m: statistics.mean(&statistics.torque),
        power_max_w: statistics.power.max(),
        power_mean_w: statistics.mean(&statistics.power),
        chips: statistics.passes.map(|passes| passes.count),
        chip_mean: statistics.passes.map(|passes| passes.mean_mm().map(in_unit)),
        chip_max: statistics.passes.map(|passes| (passes.count > 0).then(|| in_unit(passes.max_mm))),
        end_chip_max: (statistics.end_max_mm > 0.0).then(|| in_unit(statistics.end_max_mm)),
    }
}
