//! Summary of a run's results, for a shop engineer without a manual.

use std::fmt::{self, Write};

use arcfeed_model::report::THIN_RATIO;

use super::chip_load::ChipLoadFigures;
use super::figures::{
    DescentFigures, LineErrorFigures, MovementFigures, OverrideFigures, ReportFigures, RestartFigures, RunReport,
};
use crate::plural::counted;

/// Most blocks limited by an axis in the summary.
const SHOWN: usize = 10;

/// Warning about the spindle override, which a control behind a serial line does not report.
const SPINDLE_OVERRIDE: &str = "  spindle override: not known here. Without a tacho at a feed board the chip is its target times 100 % over that override, at \
     50 % twice its target: keep it at 100 %";

/// Summary of a run for a person, as text of several complete lines.
#[derive(Debug)]
pub struct RunSummary<'a> {
    /// Name of the run, for the headline.
    pub title: String,
    /// Figures of the run.
    pub report: &'a RunReport,
}

impl fmt::Display for RunSummary<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let report = self.report;
        writeln!(f, "{}", self.title)?;
        write_blocks(f, report)?;
        write_times(f, report)?;
        if let Some(chip_load) = &report.chip_load {
            write_chips(f, report, chip_load)?;
        }
        write_descents_and_path(f, report)?;
        if let Some(material) = &report.material {
            write!(f, "{material}")?;
        }
        if let Some(loads) = &report.loads {
            write!(f, "{loads}")?;
        }
        if let Some(spindle) = &report.spindle {
            writeln!(f, "  {}", spindle.words())?;
        }
        if let Some(restart) = &report.restart {
            write_restart(f, restart)?;
        }
        if let Some(link) = &report.link {
            write!(f, "  line: {} characters, busy {:.0} % of the time", link.bytes, 1e2 * link.utilization)?;
            write!(f, ", stopped by the control {}", counted(link.xoff_count as usize, "time"))?;
            if let Some(after) = link.max_bytes_after_xoff {
                write!(f, ", at most {after} characters after XOFF")?;
            }
            match link.starved_ms {
                Some(0) => writeln!(f, ", control never starved")?,
                Some(ms) => writeln!(f, ", control starved for {ms} ms")?,
                None => writeln!(f)?,
            }
            if let Some(errors) = &link.line_errors {
                write_line_errors(f, errors)?;
            }
            if report.blocks_executed.is_none() {
                writeln!(f, "{SPINDLE_OVERRIDE}")?;
            }
        }
        if let Some(ReportFigures { requested, confirmed, line }) = &report.reports {
            write!(f, "  reports of the control: {confirmed} of {requested} as the program has it")?;
            writeln!(f, "{}", line.map_or(String::new(), |line| format!(", it has read up to line {line}")))?;
        }
        for limited in report.axis_limited.iter().take(SHOWN) {
            writeln!(f, "  slower than programmed: {limited}")?;
        }
        if let more @ 1.. = report.axis_limited.len().saturating_sub(SHOWN) {
            writeln!(f, "  slower than programmed: {more} more of these blocks")?;
        }
        for line in &report.print_output {
            writeln!(f, "  printed: {line}")?;
        }
        for message in &report.messages {
            writeln!(f, "  message: {message}")?;
        }
        for alarm in &report.alarms {
            writeln!(f, "  ALARM at {alarm}")?;
        }
        Ok(())
    }
}

fn write_restart(f: &mut fmt::Formatter<'_>, restart: &RestartFigures) -> fmt::Result {
    let word = |letter: char, number: i64| format!(" {letter}{number}");
    let given = [restart.t.map(|t| word('T', t)), restart.s.map(|s| word('S', s))].into_iter().flatten();
    let given: String = given.chain(restart.m.iter().map(|m| word('M', *m))).collect();
    writeln!(f, "  restart: not sent again:{}", if given.is_empty() { " nothing" } else { &given })?;
    write!(f, "  restart: in force: {}", restart.g.join(" "))?;
    writeln!(f, "{}", restart.feed.map_or(String::new(), |feed| format!(", F{feed}")))
}

fn write_line_errors(f: &mut fmt::Formatter<'_>, errors: &LineErrorFigures) -> fmt::Result {
    let LineErrorFigures { frame, overrun, parity, r#break, buffer_overrun } = errors;
    let is_clean = [frame, overrun, parity, r#break, buffer_overrun].into_iter().all(|count| *count == 0);
    let from_control = "characters from the control";
    if is_clean {
        return writeln!(f, "  line: no damaged {from_control}, as the operating system counts them");
    }
    writeln!(
        f,
        "  line: DAMAGED {from_control}: {parity} with wrong parity, {frame} without stop bits, {} breaks, {overrun} lost in \
         the chip, {buffer_overrun} lost in the driver",
        r#break
    )
}

fn write_blocks(f: &mut fmt::Formatter<'_>, report: &RunReport) -> fmt::Result {
    let mut parts = Vec::new();
    if let Some(sent) = report.blocks_sent {
        parts.push(format!("{sent} sent"));
    }
    if let Some(executed) = report.blocks_executed {
        parts.push(format!("{executed} executed"));
        parts.push(if report.alarms.is_empty() { "no alarm".into() } else { "STOPPED BY AN ALARM".into() });
    }
    writeln!(f, "  blocks: {}", parts.join(", "))
}

fn write_times(f: &mut fmt::Formatter<'_>, report: &RunReport) -> fmt::Result {
    match (report.baseline_cycle_time_s, report.cycle_time_s) {
        (Some(before), Some(after)) => {
            let change = 1e2 * (after / before - 1.0);
            writeln!(f, "  cycle time: {before:.1} s before, {after:.1} s after ({change:+.0} %)")
        }
        (None, Some(after)) => writeln!(f, "  cycle time: {after:.1} s"),
        _ => Ok(()),
    }
}

fn write_descents_and_path(f: &mut fmt::Formatter<'_>, report: &RunReport) -> fmt::Result {
    if let Some(DescentFigures { moves, r#override: OverrideFigures { min, max, changes } }) = report.descents {
        let (moves, changes) = (counted(moves, "descent"), counted(changes as usize, "change"));
        writeln!(f, "  plunge law: {moves} at an override of {min} .. {max} %, {changes}")?;
    }
    if let Some(error) = report.path_error {
        writeln!(f, "  largest distance from the programmed path: {error:.6} {}", report.unit)?;
    }
    Ok(())
}

fn write_chips(f: &mut fmt::Formatter<'_>, report: &RunReport, all: &ChipLoadFigures) -> fmt::Result {
    let mut before: Option<&MovementFigures> = None;
    for movement in &report.movements {
        let group = |movement: &MovementFigures| (movement.tool, movement.measure);
        if before.replace(movement).map(group) != Some(group(movement)) {
            write_measure(f, report, movement)?;
        }
        write_movement(f, movement)?;
    }
    let left_out = &all.left_out;
    writeln!(
        f,
        "    {} samples at steady feed; left out: {} speeding up or slowing down, {} at block ends, {} without contact",
        all.samples, left_out.not_steady, left_out.block_end, left_out.no_contact
    )?;
    writeln!(
        f,
        "    of all samples in the cut, steady or not, the largest is {:+.2} % off its target\n    {:.1} % of the steady ones are \
         below it by more than {:.0} %",
        1e2 * all.error_ratio_max_all,
        1e2 * all.samples_thin as f64 / all.samples as f64,
        1e2 * THIN_RATIO
    )?;
    let mut rings = report.movements.iter().filter(|movement| movement.thickest_ratio != [None; 2]).peekable();
    if rings.peek().is_none() {
        return Ok(());
    }
    write!(f, "    thickest chip anywhere inside the stock line, over the target (outer, inner circle), by movement:")?;
    for movement in rings {
        let [outer, inner] =
            movement.thickest_ratio.map(|ratio| ratio.map_or("-".into(), |ratio| format!("{ratio:.2}")));
        write!(f, "  {}: {outer}, {inner}", movement.rule)?;
    }
    writeln!(f)
}

/// Heading of the movements from this one on: the tool, if the job has several, and the measured quantity.
fn write_measure(f: &mut fmt::Formatter<'_>, report: &RunReport, movement: &MovementFigures) -> fmt::Result {
    let measure = match movement.measure {
        Some("contact") => "feed per tooth on the circumference, measured on the machine at the contact",
        Some("contour") => "feed per tooth at the contour, measured on the machine",
        Some(_) => "thickest chip over the engaged arc, measured on the machine",
        None => "moves that are not measured",
    };
    let tool = movement.tool.filter(|_| report.tools.len() > 1).map_or(String::new(), |tool| format!("T{tool}: "));
    let is_alike = |other: &MovementFigures| (other.tool, other.measure) == (movement.tool, movement.measure);
    let is_own = |other: &MovementFigures| is_alike(other) && other.chip_load.is_some() && target(other).is_none();
    let unit = if !report.movements.iter().any(is_own) {
        report.unit
    } else {
        "as a multiple of what the block's own F gives"
    };
    writeln!(f, "  {tool}{measure}, {unit}:")?;
    writeln!(
        f,
        "    {:<24}{:>5}  {:<9}{:<20}{:<20}{:<19}{:<14}changes per arc",
        "movement", "arcs", "target", "before", "after", "after, error", "override"
    )
}

/// Target of a movement; `None` if it is that of each block's own F.
fn target(movement: &MovementFigures) -> Option<f64> {
    movement.chip_load.or(movement.baseline_chip_load).and_then(|figures| figures.target)
}

fn write_movement(f: &mut fmt::Formatter<'_>, movement: &MovementFigures) -> fmt::Result {
    let MovementFigures { rule, rotation, direction, side, arcs, chip_load, baseline_chip_load, .. } = movement;
    let range = |chip_load: &Option<ChipLoadFigures>| match chip_load {
        Some(ChipLoadFigures { min: Some(min), max: Some(max), .. }) => format!("{min:.5} .. {max:.5}"),
        Some(ChipLoadFigures { error_ratio_min, error_ratio_max, .. }) => {
            format!("{:.3} .. {:.3}", 1.0 + error_ratio_min, 1.0 + error_ratio_max)
        }
        None => "-".into(),
    };
    let own = if chip_load.is_some() { "own F" } else { "-" };
    let target = target(movement).map_or(own.into(), |target| format!("{target:.5}"));
    let error = chip_load.map_or("-".into(), |figures| {
        format!("{:+.2} .. {:+.2} %", 1e2 * figures.error_ratio_min, 1e2 * figures.error_ratio_max)
    });
    let bounds = movement.r#override.map_or("-".into(), |figures| format!("{} .. {} %", figures.min, figures.max));
    let mut changes = String::new();
    if movement.changes_per_arc.iter().all(|count| *count == 0) {
        changes.push_str("none");
    } else {
        movement.changes_per_arc.iter().try_for_each(|count| write!(changes, "{count} "))?;
    }
    writeln!(
        f,
        "    {:<24}{arcs:>5}  {target:<9}{:<20}{:<20}{error:<18} {bounds:<14}{}",
        [Some(rule.to_string().as_str()), *rotation, Some(direction.unwrap_or("lines")), Some(side)]
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
            .join(" "),
        range(baseline_chip_load),
        range(chip_load),
        changes.trim_end()
    )
}
