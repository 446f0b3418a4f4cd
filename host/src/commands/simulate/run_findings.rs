//! Alarms, exceeded limits and warnings of both runs, each at its block, for the report's list.

use arcfeed_milling::cutting::meter::MoveChips;
use arcfeed_model::job::Job;

use super::chip_quantity::ChipQuantity;
use crate::plural::counted;
use crate::report::figures::RunReport;
use crate::report::loads::UnstableFigures;
use crate::report::material::{LeftOutBlocks, short};
use crate::report::page::viewer::RunFinding;
use crate::report::spindle::{BlockValue, SpindleLoadFigures};

/// Measured chip load over its target above which a move is a finding.
const CHIP_RATIO: f64 = 1.05;

/// Places that a finding about several moves names.
const PLACES_SHOWN: usize = 4;

/// Most findings of one kind and run.
const SHOWN: usize = 200;

/// Findings about a run for the viewer, the most important first; `chips` are those of the run and of the original
/// program.
pub fn findings(report: &RunReport, job: &Job, chips: [&[MoveChips]; 2]) -> Vec<RunFinding> {
    let unit = job.unit;
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
        add(&mut found, above_target(run, ChipQuantity::of(job).words(), moves).into_iter());
    }
    let limits = report.axis_limited.iter().map(|limit| finding("note", "after", limit.block, limit.to_string()));
    add(&mut found, limits);
    found
}

/// Moves whose measured chips are above their target, those with the same figure together.
fn above_target(run: &'static str, quantity: &str, moves: &[MoveChips]) -> Vec<RunFinding> {
    let mut groups: Vec<(String, Vec<&MoveChips>)> = Vec::new();
    let is_above = |chips: &&MoveChips| chips.any_contact.samples > 0 && chips.any_contact.max_ratio > CHIP_RATIO;
    for chips in moves.iter().filter(is_above) {
        let ratio = format!("{:.2}", chips.any_contact.max_ratio);
        match groups.iter_mut().find(|(of, _)| *of == ratio) {
            Some((_, moves)) => moves.push(chips),
            None => groups.push((ratio, vec![chips])),
        }
    }
    let group = |(ratio, moves): (String, Vec<&MoveChips>)| {
        let names = moves.iter().map(|chips| named(chips.block, chips.sequence, ""));
        let names: Vec<String> = names.map(|name| name.trim_end_matches(": ").to_owned()).collect();
        let more = match names.len() {
            1 => String::new(),
            count @ 2..=PLACES_SHOWN => format!("; {count} moves: {}", names.join(", ")),
            count => format!("; {count} moves: {}, ...", names[..PLACES_SHOWN].join(", ")),
        };
        finding("warning", run, moves[0].block, format!("{}: {quantity} {ratio} of its target{more}", names[0]))
    };
    groups.into_iter().map(group).collect()
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
