//! Results of a run for reports.

use arcfeed_control::interpolator::AxisLimited;
use arcfeed_hil_sim::move_override::MoveOverride;
use arcfeed_hil_sim::simulated_machine::SimulatedMachine;
use arcfeed_milling::cutting::measured_move::ChipMeasure;
use arcfeed_milling::cutting::meter::MoveChips;
use arcfeed_model::cut::{CutRule, Moves};
use arcfeed_model::job::Job;
use arcfeed_units::{LengthUnit, S_PER_MIN};

use super::super::adapt::{direction_word, rotation_word, side_word};
use crate::report::chip_load::{ChipLoadFigures, ChipSamples, ToolFigures};
use crate::report::figures::{
    AlarmFigures, AxisLimitFigures, DescentFigures, MovementFigures, OverrideFigures, RestartFigures, RunReport,
};
use crate::report::print_output;

/// Adds to a report the results of the original program, for comparison.
pub fn compare(report: &mut RunReport, baseline: RunReport) {
    // A program that its control does not finish has no time to compare with.
    report.baseline_cycle_time_s = baseline.cycle_time_s.filter(|_| baseline.alarms.is_empty());
    report.baseline_chip_load = baseline.chip_load;
    for (tool, before) in report.tools.iter_mut().zip(baseline.tools) {
        tool.baseline_chip_load = before.chip_load;
    }
    for (movement, before) in report.movements.iter_mut().zip(baseline.movements) {
        movement.baseline_chip_load = before.chip_load;
    }
}

/// Results of everything that the simulation has executed so far.
pub fn measure(simulation: &SimulatedMachine, job: &Job) -> RunReport {
    let moves: Vec<(&MoveChips, Option<&MoveOverride>)> =
        simulation.meter().moves().iter().zip(simulation.overrides().iter().map(Some)).collect();
    let movements = (0..job.rules.len()).map(|rule| movement(job, rule, &moves)).collect();
    let alarm =
        simulation.control().alarm().map(|alarm| AlarmFigures::new(alarm.line, alarm.fault.column, alarm.fault.cause));
    RunReport {
        unit: job.unit.label(),
        blocks_executed: Some(simulation.control().executed().len()),
        alarms: alarm.into_iter().collect(),
        print_output: print_output::lines(simulation.control().output()),
        messages: simulation.control().messages().map(String::from).collect(),
        cycle_time_s: Some(simulation.cycle_time().to_s()),
        chip_load: chip_load(job, simulation.meter().moves(), &|_| true),
        tools: tools(job, simulation.meter().moves()),
        r#override: overrides(moves.iter().filter_map(|(_, figures)| *figures)),
        movements,
        descents: descents(simulation.descent_overrides()),
        axis_limited: simulation.control().limited().iter().map(|limited| axis_limit(job.unit, limited)).collect(),
        restart: simulation.control().restart_list().map(|list| RestartFigures {
            t: list.t,
            s: list.s,
            m: list.m.iter().copied().collect(),
            feed: list.feed().map(|feed| feed.0 as f64 / job.unit.nm() as f64),
            g: list.codes(),
        }),
        ..RunReport::default()
    }
}

/// Results of a run of which only chips were measured.
pub fn of_chips(job: &Job, chips: &[MoveChips]) -> RunReport {
    let moves: Vec<(&MoveChips, Option<&MoveOverride>)> = chips.iter().map(|chips| (chips, None)).collect();
    RunReport {
        unit: job.unit.label(),
        chip_load: chip_load(job, chips, &|_| true),
        tools: tools(job, chips),
        movements: (0..job.rules.len()).map(|rule| movement(job, rule, &moves)).collect(),
        ..RunReport::default()
    }
}

fn axis_limit(unit: LengthUnit, limited: &AxisLimited) -> AxisLimitFigures {
    let AxisLimited { count, sequence, axis, is_rotary, wanted_mm_per_s, allowed_mm_per_s } = *limited;
    let (of_mm, unit) = match unit {
        _ if is_rotary => (1.0, "deg/min"),
        LengthUnit::Inch => (unit.mm(), "in/min"),
        LengthUnit::Mm => (1.0, "mm/min"),
    };
    let per_min = |speed: f64| speed * S_PER_MIN / of_mm;
    AxisLimitFigures {
        block: count,
        n: sequence,
        axis: ["X", "Y", "Z", "A", "B", "C"][axis],
        demanded_feed: per_min(wanted_mm_per_s),
        allowed_feed: per_min(allowed_mm_per_s),
        unit,
    }
}

fn movement(job: &Job, rule: usize, moves: &[(&MoveChips, Option<&MoveOverride>)]) -> MovementFigures {
    let of_rule = || moves.iter().filter(move |(chips, _)| chips.rule == rule);
    let thickest = |circle: usize| {
        let ratios = of_rule().filter(|(chips, _)| chips.thickest[circle].samples > 0);
        ratios.map(|(chips, _)| chips.thickest[circle].max_ratio).reduce(f64::max)
    };
    let cut = &job.rules[rule];
    MovementFigures {
        rule: rule + 1,
        tool: job.tool_of(cut).number,
        rotation: rotation_word(cut.moves),
        direction: match cut.moves {
            Moves::Rotations(_, turn) | Moves::Arcs(turn) => Some(direction_word(turn)),
            Moves::Lines => None,
        },
        side: side_word(&cut.work),
        measure: ChipMeasure::of(cut, job.tool_of(cut)).map(measure_name),
        arcs: of_rule().count(),
        chip_load: chip_load(job, moves.iter().map(|(chips, _)| *chips), &|other| std::ptr::eq(other, cut)),
        baseline_chip_load: None,
        thickest_ratio: [thickest(0), thickest(1)],
        r#override: overrides(of_rule().filter_map(|(_, figures)| *figures)),
        changes_per_arc: of_rule().filter_map(|(_, figures)| *figures).map(|figures| figures.changes).collect(),
    }
}

/// Name of a measured quantity in JSON.
const fn measure_name(measure: ChipMeasure) -> &'static str {
    match measure {
        ChipMeasure::Contact => "contact",
        ChipMeasure::Contour => "contour",
        ChipMeasure::Thickest => "thickest-chip",
    }
}

fn tools(job: &Job, moves: &[MoveChips]) -> Vec<ToolFigures> {
    let figures = (0_u8..).zip(job.tools.iter()).map(|(tool, setup)| ToolFigures {
        tool: setup.number,
        chip_load: chip_load(job, moves, &|rule| rule.tool == tool),
        baseline_chip_load: None,
    });
    figures.collect()
}

/// Chip load under these rules, with a target if all of them have the same.
fn chip_load<'a>(
    job: &Job,
    moves: impl IntoIterator<Item = &'a MoveChips>,
    choose: &dyn Fn(&CutRule) -> bool,
) -> Option<ChipLoadFigures> {
    let mut samples = ChipSamples::default();
    let (mut targets_mm, mut follows_program): (Vec<f64>, bool) = (Vec::new(), false);
    for chips in moves {
        let Some(rule) = job.rules.get(chips.rule).filter(|rule| choose(rule)) else { continue };
        samples.steady.merge(&chips.contact);
        samples.all.merge(&chips.any_contact);
        samples.left_out.merge(&chips.left_out);
        let target_mm = f64::from(job.feed_per_tooth_of(rule).0);
        follows_program |= job.tool_of(rule).follows_program;
        if chips.any_contact.samples > 0 && !targets_mm.contains(&target_mm) {
            targets_mm.push(target_mm);
        }
    }
    let only = (targets_mm.len() == 1 && !follows_program).then(|| targets_mm[0]);
    ChipLoadFigures::new(&samples, only, job.unit)
}

/// Results of all descents with a table of feeds; `None` without one.
fn descents(executed: &[MoveOverride]) -> Option<DescentFigures> {
    Some(DescentFigures { moves: executed.len(), r#override: overrides(executed.iter())? })
}

fn overrides<'a>(arcs: impl Iterator<Item = &'a MoveOverride>) -> Option<OverrideFigures> {
    let figures = arcs.map(|arc| OverrideFigures { min: arc.min_percent, max: arc.max_percent, changes: arc.changes });
    figures.reduce(OverrideFigures::join)
}
