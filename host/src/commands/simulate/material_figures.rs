//! Removed material, as results for the report.

use std::collections::BTreeMap;

use arcfeed_dexel::deviation::HeightMap;
use arcfeed_dexel::lattice::Lattice;
use arcfeed_dexel::workpiece::Stock;
use arcfeed_hil_sim::removal::cutter::StockCutter;
use arcfeed_hil_sim::removal::placement::LeftOutReason;
use arcfeed_hil_sim::removal::rate::{Piece, RemovedVolume};
use arcfeed_hil_sim::removal::trail::BlockRef;
use arcfeed_units::LengthUnit;

use super::block_pairs::{BlockPairs, BlockPlace};
use super::edges::UPRIGHT;
use super::setup::Setup;
use crate::report::material::{
    BlockFigures, DeviationFigures, LeftOutBlocks, MaterialFigures, RemovalFigures, RuleFigures, VolumeUnit,
};

/// Results for the material removed by a run and by the original program.
pub fn figures(
    (unit, pairs): (LengthUnit, &BlockPairs),
    setup: &Setup<'_>,
    cutter: &StockCutter,
    baseline: &StockCutter,
) -> MaterialFigures {
    let volumes = VolumeUnit::of(unit);
    let step_mm = setup.workpiece.step_mm;
    let runs = [cutter, baseline];
    let removal = |choose: &dyn Fn(&StockCutter, &Piece) -> bool| {
        runs.map(|run| removal_of(run.pieces().iter().filter(|piece| choose(run, piece)), step_mm, volumes))
    };
    let [mut total, mut before] = removal(&|_, _| true);
    let [rapid, _] = removal(&|run, piece| run.blocks()[piece.block].is_rapid);
    let whole_mm3 = setup.settings.stock.volume().mean_mm3();
    let stock = cutter.stock();
    let mut rules: Vec<Option<usize>> = cutter.blocks().iter().map(|of| of.rule).collect();
    rules.sort_unstable_by_key(|rule| rule.unwrap_or(usize::MAX));
    rules.dedup();
    let rules = rules.into_iter().map(|rule| {
        let [after, before] = removal(&|run, piece| run.blocks()[piece.block].rule == rule);
        RuleFigures { rule: rule.map(|rule| rule + 1), removal: after, baseline: before }
    });
    let rules: Vec<RuleFigures> = rules.collect();
    // A window within one rule may be shorter than one over its neighbours, too.
    for rule in &rules {
        total.rate_max = total.rate_max.max(rule.removal.rate_max);
        before.rate_max = before.rate_max.max(rule.baseline.rate_max);
    }
    MaterialFigures {
        assumed_stock: setup.workpiece.assumed,
        volume_unit: volumes.label,
        rate_unit: volumes.rate_label,
        removal: total,
        baseline: before,
        at_rapid: rapid.removed,
        left: volumes.of_mm3(stock.volume().mean_mm3()),
        step: step_mm / unit.mm(),
        path_tolerance: cutter.tolerance_mm() / unit.mm(),
        rays: stock.grids().iter().map(|grid| grid.dexels().len()).sum(),
        memory_bytes: stock.memory_bytes(),
        bytes_per_mm3: stock.memory_bytes() as f64 / whole_mm3,
        rules,
        blocks: blocks([cutter, baseline], pairs, step_mm, volumes),
        left_out: cutter
            .left_out()
            .iter()
            .map(|left_out| left_out_figures(left_out.reason, &left_out.first, left_out.blocks))
            .collect(),
        deviation: None,
    }
}

/// Deviation of the remaining stock from the finished part, measured along the tool's axis, as a map and as numbers;
/// `None` if they have no common place.
pub fn deviation(unit: LengthUnit, stock: &Stock, target: &Stock) -> Option<(HeightMap, DeviationFigures)> {
    let heights = [stock, target].map(|stock| HeightMap::new(stock, UPRIGHT));
    let map = heights[0].above(&heights[1]).ok()?;
    let of_all = map.figures()?;
    let worst = map.heights_mm().iter().enumerate().filter_map(|(index, off)| Some((index, (*off)?)));
    let (index, off_mm) = worst.reduce(|a, b| if b.1.abs() > a.1.abs() { b } else { a })?;
    let (lattice, [width, _]) = (stock.lattice(), stock.lattice().size(UPRIGHT));
    let [column_axis, row_axis] = Lattice::across(UPRIGHT);
    let at = [lattice.center_mm(column_axis, index % width), lattice.center_mm(row_axis, index / width)];
    let in_unit = |mm: f64| mm / unit.mm();
    let figures = DeviationFigures {
        min: in_unit(of_all.min_mm),
        max: in_unit(of_all.max_mm),
        rms: in_unit(of_all.rms_mm),
        rays: of_all.rays,
        largest: in_unit(off_mm),
        x: in_unit(at[0]),
        y: in_unit(at[1]),
    };
    Some((map, figures))
}

/// Blocks that removed material, each once.
fn blocks(
    [cutter, baseline]: [&StockCutter; 2],
    pairs: &BlockPairs,
    step_mm: f64,
    volumes: VolumeUnit,
) -> Vec<BlockFigures> {
    let after = by_place(cutter, |count| pairs.place(count));
    let before = by_place(baseline, BlockPlace::Original);
    let removal = |pieces: &[&Piece]| removal_of(pieces.iter().copied(), step_mm, volumes);
    let cutting = after.into_iter().map(|(key, (of, pieces))| {
        let before = before.get(&key).filter(|(other, _)| other.sequence == of.sequence);
        BlockFigures {
            block: of.count,
            n: of.sequence,
            rule: of.rule.map(|rule| rule + 1),
            rapid: of.is_rapid,
            removal: removal(&pieces),
            baseline: before.map(|(_, pieces)| removal(pieces)),
        }
    });
    let mut blocks: Vec<BlockFigures> = cutting.filter(|block| block.removal.removed > 0.0).collect();
    blocks.sort_by_key(|block| block.block);
    blocks
}

/// Largest removal rate of each block, mm3/min, rapids left out.
pub fn block_rates(cutter: &StockCutter) -> Vec<(BlockRef, f64)> {
    let step_mm = cutter.stock().lattice().step_mm();
    let rate = |pieces: &[&Piece]| RemovedVolume::of(pieces.iter().copied(), step_mm).rate_max_per_min;
    let blocks = by_place(cutter, |count| count).into_values().filter(|(of, _)| !of.is_rapid);
    blocks.map(|(of, pieces)| (of, rate(&pieces))).collect()
}

/// Pieces of removed material, grouped by the value that `place` returns for their block, and by whether the move was a
/// rapid.
pub fn by_place<P: Ord>(
    cutter: &StockCutter,
    place: impl Fn(u32) -> P,
) -> BTreeMap<(P, bool), (BlockRef, Vec<&Piece>)> {
    let mut found = BTreeMap::new();
    for piece in cutter.pieces() {
        let of = cutter.blocks()[piece.block];
        found.entry((place(of.count), of.is_rapid)).or_insert((of, Vec::new())).1.push(piece);
    }
    found
}

fn removal_of<'p>(
    pieces: impl Iterator<Item = &'p Piece> + Clone,
    step_mm: f64,
    volumes: VolumeUnit,
) -> RemovalFigures {
    let removal = RemovedVolume::of(pieces, step_mm);
    RemovalFigures {
        removed: volumes.of_mm3(removal.mean_mm3()),
        spread: volumes.of_mm3(removal.spread_mm3()),
        cutting_time_s: removal.time.to_s(),
        rate_mean: volumes.of_mm3(removal.rate_mean_per_min()),
        rate_max: volumes.of_mm3(removal.rate_max_per_min),
    }
}

/// Entry of the report for blocks whose material was not removed in the model, for one reason.
pub fn left_out_figures(reason: LeftOutReason, first: &BlockRef, blocks: usize) -> LeftOutBlocks {
    let cause = match reason {
        LeftOutReason::Turning => "turning",
        LeftOutReason::OtherPosition => "other-position",
        LeftOutReason::NoMachine => "no-machine",
        LeftOutReason::MachinePosition => "machine-position",
        LeftOutReason::Contour => "contour",
        LeftOutReason::Tilted => "tilted",
        LeftOutReason::AxisTurns => "axis-turns",
        LeftOutReason::OtherTool => "other-tool",
        LeftOutReason::Backwards => "backwards",
    };
    LeftOutBlocks { cause, blocks, first_block: first.count, first_n: first.sequence }
}
