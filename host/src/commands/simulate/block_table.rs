//! Table with the results of each block of a run, one row for a block.

use std::collections::BTreeMap;

use arcfeed_hil_sim::removal::cutter::StockCutter;
use arcfeed_hil_sim::removal::load_statistics::LoadStatistics;
use arcfeed_hil_sim::removal::loads::LoadMeter;
use arcfeed_hil_sim::removal::rate::RemovedVolume;
use arcfeed_hil_sim::simulated_machine::{STEP, SimulatedMachine};
use arcfeed_milling::cutting::meter::{ChipMeter, MoveChips};
use arcfeed_model::report::{ChipFigures, ExcludedSamples};
use arcfeed_nc::segment::Path as MovePath;
use arcfeed_units::{Micros, S_PER_MIN};

use super::load_figures;
use super::material_figures;
use crate::trace::table::Cell;
use crate::trace::tables::BLOCK_COLUMNS;

/// Data of the block that is in execution in one millisecond of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockRecord {
    /// Number of blocks executed so far, including this one.
    pub block: u32,
    /// N number of the block; `None` without one.
    pub n: Option<i64>,
    /// Line of the program's file, counted from 1; `None` if it is unknown.
    pub line: Option<i64>,
    /// Number of the cut rule that governs the block, counted from 1; `None` without one.
    pub rule: Option<i64>,
    /// The block's move is a rapid.
    pub is_rapid: bool,
    /// Speed along the commanded path, mm/min.
    pub feed_mm_per_min: f64,
    /// Override that the control uses, %.
    pub percent: u8,
    /// Target of the chip load that is measured, mm; `None` for a block without one.
    pub target_mm: Option<f64>,
}

/// Summaries of the blocks of a run, collected millisecond by millisecond.
#[derive(Debug, Default)]
pub struct BlockLog(BTreeMap<u32, BlockSummary>);

/// Summary of a block.
#[derive(Clone, Copy, Debug)]
struct BlockSummary {
    /// Last millisecond, with the largest feed and the first target.
    last: BlockRecord,
    begin: Micros,
    end: Micros,
    percent: [u8; 2],
    changes: u32,
}

/// Measurements of a finished run from which the table of blocks is filled.
pub struct BlockSources<'a> {
    /// Measured chip loads.
    pub meter: &'a ChipMeter,
    /// Stock model that was cut; `None` without a workpiece.
    pub cutter: Option<&'a StockCutter>,
    /// Chips and forces of the edges; `None` without `[cutting]` in the job.
    pub loads: Option<&'a LoadMeter>,
}

/// Chips of all moves of a block.
#[derive(Default)]
struct BlockChips {
    steady: ChipFigures,
    all: ChipFigures,
    left_out: ExcludedSamples,
}

impl BlockRecord {
    /// Data of the block in execution at present; `None` if there is none. `line_of` gives the line for the number of
    /// the block.
    pub fn of(simulation: &SimulatedMachine, line_of: impl FnOnce(u32) -> Option<usize>) -> Option<Self> {
        let control = simulation.control();
        let (block, segment) = control.active()?;
        Some(BlockRecord {
            block,
            n: segment.sequence,
            line: line_of(block).map(|line| line as i64),
            rule: simulation.rule().map(|rule| rule as i64 + 1),
            is_rapid: segment.path == MovePath::Rapid,
            feed_mm_per_min: control.speed_mm_per_s() * S_PER_MIN,
            percent: control.override_percent(),
            target_mm: simulation.meter().target_mm_per_tooth(),
        })
    }
}

impl BlockLog {
    /// Adds the data of the millisecond that ends at the time `now`.
    pub fn add(&mut self, record: BlockRecord, now: Micros) {
        let BlockRecord { percent, .. } = record;
        let begin = Micros(now.0.saturating_sub(STEP.0));
        let summary = self.0.entry(record.block).or_insert(BlockSummary {
            last: record,
            begin,
            end: now,
            percent: [percent; 2],
            changes: 0,
        });
        let BlockSummary { last, end, percent: [least, most], changes, .. } = summary;
        *changes += u32::from(percent != last.percent);
        (*least, *most, *end) = (percent.min(*least), percent.max(*most), now);
        *last = BlockRecord {
            feed_mm_per_min: record.feed_mm_per_min.max(last.feed_mm_per_min),
            target_mm: last.target_mm.or(record.target_mm),
            rule: last.rule.or(record.rule),
            is_rapid: record.is_rapid && last.is_rapid,
            ..record
        };
    }

    /// Rows of the table, in the order of the blocks.
    pub fn rows(&self, sources: &BlockSources<'_>) -> impl Iterator<Item = [Cell<'static>; BLOCK_COLUMNS]> {
        let chips = chips(sources.meter.moves());
        let loads = sources.loads.map_or(BTreeMap::new(), |loads| load_figures::by_place(loads, |count| count));
        let removed = sources.cutter.map_or(BTreeMap::new(), removed_mm3);
        let has_stock = sources.cutter.is_some();
        let row = move |(block, summary): (&u32, &BlockSummary)| {
            let removed = removed.get(block).copied().or(has_stock.then_some(0.0));
            row(summary, chips.get(block), removed, loads.get(block).map(|(_, load)| load))
        };
        self.0.iter().map(row)
    }
}

fn chips(moves: &[MoveChips]) -> BTreeMap<u32, BlockChips> {
    let mut blocks: BTreeMap<u32, BlockChips> = BTreeMap::new();
    for chips in moves {
        let of_block = blocks.entry(chips.block).or_default();
        of_block.steady.merge(&chips.contact);
        of_block.all.merge(&chips.any_contact);
        of_block.left_out.merge(&chips.left_out);
    }
    blocks
}

fn removed_mm3(cutter: &StockCutter) -> BTreeMap<u32, f64> {
    let step_mm = cutter.stock().lattice().step_mm();
    let mut blocks = BTreeMap::new();
    for (of, pieces) in material_figures::by_place(cutter, |count| count).into_values() {
        *blocks.entry(of.count).or_insert(0.0) += RemovedVolume::of(pieces.into_iter(), step_mm).mean_mm3();
    }
    blocks
}

fn row(
    summary: &BlockSummary,
    chips: Option<&BlockChips>,
    removed_mm3: Option<f64>,
    load: Option<&LoadStatistics>,
) -> [Cell<'static>; BLOCK_COLUMNS] {
    let BlockSummary { last, begin, end, percent, changes } = summary;
    let chip =
        |ratio: &dyn Fn(&BlockChips) -> f64| Cell::from(chips.zip(last.target_mm).map(|(chips, mm)| ratio(chips) * mm));
    let count = |samples: &dyn Fn(&BlockChips) -> u64| Cell::from(chips.map(|chips| samples(chips) as i64));
    let loaded = |value: &dyn Fn(&LoadStatistics) -> f64| Cell::from(load.map(value));
    [
        last.block.into(),
        last.n.into(),
        last.line.into(),
        last.rule.into(),
        last.is_rapid.into(),
        begin.to_s().into(),
        end.to_s().into(),
        last.feed_mm_per_min.into(),
        u32::from(percent[0]).into(),
        u32::from(percent[1]).into(),
        (*changes).into(),
        last.target_mm.into(),
        chip(&|chips| chips.steady.min_ratio),
        chip(&|chips| chips.steady.max_ratio),
        chip(&|chips| chips.all.max_ratio),
        chips.and_then(|chips| chips.steady.rms_error_ratio()).into(),
        count(&|chips| chips.steady.samples),
        count(&|chips| chips.steady.thin),
        count(&|chips| chips.left_out.not_steady),
        count(&|chips| chips.left_out.block_end),
        count(&|chips| chips.left_out.no_contact),
        removed_mm3.into(),
        loaded(&|load| load.time_s),
        loaded(&|load| load.bending.max()),
        loaded(&|load| load.mean(&load.bending)),
        loaded(&|load| load.torque.max()),
        loaded(&|load| load.mean(&load.torque)),
        loaded(&|load| load.power.max()),
        loaded(&|load| load.mean(&load.power)),
        loaded(&|load| load.passes.iter().map(|passes| passes.max_mm).fold(0.0, f64::max)),
    ]
}
