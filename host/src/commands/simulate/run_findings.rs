//! Alarms, exceeded limits and warnings of both runs, each at its block, for the report's list.

use arcfeed_milling::cutting::meter::MoveChips;
use arcfeed_units::LengthUnit;

use crate::plural::counted;
use crate::report::figures::RunReport;
use crate::report::loads::UnstableFigures;
use crate::report::material::{LeftOutBlocks, short};
use crate::report::page::viewer::RunFinding;
use crate::report::spindle::{BlockValue, SpindleLoadFigures};

/// Measured chip load over its target above which a move is a finding.
const CHIP_RATIO: f64 = 1.05;

/// Most findings of one kind and run.
const SHOWN: usize = 200;

/// Findings about a run for the viewer, the most important first; `chips` are those of the run and of the original
/// program.
pub fn findings(report: &RunReport, unit: LengthUnit, chips: [&[MoveChips]; 2]) -> Vec<RunFinding> {
    let last = report.blocks_executed.unwrap_or_default() as u32;
    let mut found = Vec::new();
    add(&mut found, report.alarms.iter().map(|alarm| finding("alarm", "after", last, alarm.to_string())));
    if let Some(material) = &report.material {
        let rapids = material.rapids(unit).map(|block| {
            let text = format!("{} {} taken at rapid", short(block.removal.removed), material.volume_unit);
            finding("warning", "after", block.block, named(block.block, block.n, &text))
        });
        add(&mut found, rapids);
        add(&mut found, material.left_out.iter().map(|left_out| omission("no material taken", left_out)));
    }
    if let Some(spindle) = &report.spindle {
        add_loads(&mut found, "power", ("kW", 1e3), &spindle.power);
        spindle.torque.iter().for_each(|torque| add_loads(&mut found, "torque", ("N m", 1.0), torque));
    }
    if let Some(loads) = &report.loads {
        if let Some(vibration) = &loads.vibration {
            for (run, blocks) in [("after", &vibration.unstable), ("before", &vibration.baseline_unstable)] {
                add(&mut found, blocks.iter().map(|block| unstable(run, block, loads.unit)));
            }
        }
        add(&mut found, loads.left_out.iter().map(|left_out| omission("no chips and forces", left_out)));
    }
    for (run, moves) in [("after", chips[0]), ("before", chips[1])] {
        let thick = moves.iter().filter(|chips| chips.any_contact.max_ratio > CHIP_RATIO);
        let thick = thick.filter(|chips| chips.any_contact.samples > 0).map(|chips| {
            let text = format!("measured chip load {} of its target", short(chips.any_contact.max_ratio));
            finding("warning", run, chips.block, named(chips.block, chips.sequence, &text))
        });
        add(&mut found, thick);
    }
    let limits = report.axis_limited.iter().map(|limit| finding("note", "after", limit.block, limit.to_string()));
    add(&mut found, limits);
    found
}

fn finding(severity: &'static str, run: &'static str, block: u32, text: String) -> RunFinding {
    RunFinding { severity, run, block, at_s: None, place: None, text }
}

fn named(block: u32, n: Option<i64>, text: &str) -> String {
    n.map_or_else(|| format!("block {block}: {text}"), |n| format!("N{n}: {text}"))
}

/// Adds the first findings of a kind, and how many more there are.
fn add(found: &mut Vec<RunFinding>, kind: impl Iterator<Item = RunFinding>) {
    let mut kind = kind.peekable();
    found.extend(kind.by_ref().take(SHOWN));
    if let Some(next) = kind.next() {
        let more = 1 + kind.count();
        found.push(RunFinding { text: format!("{more} more of this kind from here on"), ..next });
    }
}

fn add_loads(found: &mut Vec<RunFinding>, quantity: &str, (unit, per_unit): (&str, f64), load: &SpindleLoadFigures) {
    let Some(limit) = load.limit else { return };
    for (run, blocks) in [("after", &load.above), ("before", &load.baseline_above)] {
        let above = blocks.iter().map(|BlockValue { block, n, value }| {
            let [value, limit] = [*value, limit].map(|value| short(value / per_unit));
            let text = format!("{quantity} {value} {unit}, the spindle's limit {limit}");
            finding("warning", run, *block, named(*block, *n, &text))
        });
        add(found, above);
    }
}

fn unstable(run: &'static str, block: &UnstableFigures, unit: &str) -> RunFinding {
    let text = format!("{}: {} {unit} from tooth to tooth", block.verdict, short(block.metric));
    finding("warning", run, block.block, named(block.block, block.n, &text))
}

fn omission(what: &str, left_out: &LeftOutBlocks) -> RunFinding {
    let text = format!("{what} in {} from here on: {}", counted(left_out.blocks, "block"), left_out.words());
    finding("note", "after", left_out.first_block, named(left_out.first_block, left_out.first_n, &text))
}
