//! Results of a run as data. Field names are the JSON keys of docs/json.md; lengths are in the job's unit, which `unit`
//! names.

use std::fmt;

use arcfeed_line_errors::Counts;
use arcfeed_nc::alarm::Cause;
use serde::Serialize;

use super::chip_load::{ChipLoadFigures, ToolFigures};
use super::loads::LoadsFigures;
use super::material::MaterialFigures;
use super::spindle::SpindleFigures;
use crate::dnc::reports::Reports;

/// Results of a run of `stream`, `simulate` or `serve`. Fields that do not apply are `None` (null).
#[derive(Clone, Debug, Default, Serialize)]
pub struct RunReport {
    /// Unit of lengths: `in` or `mm`.
    pub unit: &'static str,
    /// Number of blocks whose line end was sent.
    pub blocks_sent: Option<usize>,
    /// Number of blocks that the control has executed.
    pub blocks_executed: Option<usize>,
    /// Alarms that stopped the control.
    pub alarms: Vec<AlarmFigures>,
    /// Lines that the program has printed by DPRNT and the like.
    pub print_output: Vec<String>,
    /// Messages of the program to the operator, and texts of alarms; for an alarm in a called program also its place.
    pub messages: Vec<String>,
    /// Time from the first move to the end of the program, s.
    pub cycle_time_s: Option<f64>,
    /// The same time for the original program, s.
    pub baseline_cycle_time_s: Option<f64>,
    /// Measured chip load of all tools together.
    pub chip_load: Option<ChipLoadFigures>,
    /// Measured chip load of the original program.
    pub baseline_chip_load: Option<ChipLoadFigures>,
    /// Measured chip load of each tool of the job.
    pub tools: Vec<ToolFigures>,
    /// Smallest and largest override on the moves that a cut rule selects.
    pub r#override: Option<OverrideFigures>,
    /// Override and chip load of each cut rule's moves.
    pub movements: Vec<MovementFigures>,
    /// Override on the descents (plunges and ramps) that the plunge law governs with a table of feeds.
    pub descents: Option<DescentFigures>,
    /// Blocks that an axis of the machine kept below their programmed feed.
    pub axis_limited: Vec<AxisLimitFigures>,
    /// Material removed from the workpiece, if the job has one.
    pub material: Option<MaterialFigures>,
    /// Loads of the edges, if the job has `[cutting]`.
    pub loads: Option<LoadsFigures>,
    /// Load of the spindle, if the job describes edges or the material of its workpiece.
    pub spindle: Option<SpindleFigures>,
    /// Statistics of the serial line.
    pub link: Option<LinkFigures>,
    /// Numbers of the control's position reports, if the job requests them.
    pub reports: Option<ReportFigures>,
    /// State that the operator has to restore after a restart in the middle of the program.
    pub restart: Option<RestartFigures>,
    /// Simulated time divided by wall time.
    pub real_time_factor: Option<f64>,
    /// Largest distance of the measured positions of governed moves from the programmed path.
    pub path_error: Option<f64>,
}

/// Restart: functions given before its block, which the control does not send again, and the state before the block.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RestartFigures {
    /// Last T word before the block of the restart.
    pub t: Option<i64>,
    /// Last S word before the block of the restart.
    pub s: Option<i64>,
    /// M codes before the block of the restart, in order; the last 35.
    pub m: Vec<i64>,
    /// Feed in force, per minute or per revolution.
    pub feed: Option<f64>,
    /// Modal G codes in force.
    pub g: Vec<String>,
}

/// Alarm that stopped the control, with its place.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct AlarmFigures {
    /// Line of the program as sent, counted from 1.
    pub line: u32,
    /// Column, if it is known.
    pub column: Option<u16>,
    /// Number of the alarm (PS); `None` for a stop without one.
    pub alarm: Option<u16>,
    /// Description.
    pub message: String,
}

impl AlarmFigures {
    /// Figures of a fault at a line.
    pub fn new(line: u32, column: u16, cause: Cause) -> Self {
        let (alarm, message) = match cause {
            Cause::Alarm(alarm) => (Some(alarm.number()), alarm.explanation().to_string()),
            Cause::Macro(alarm) => (alarm.number(), alarm.explanation().to_string()),
            Cause::NotModelled(_) => (None, cause.to_string()),
        };
        AlarmFigures { line, column: (column > 0).then_some(column), alarm, message }
    }
}

impl fmt::Display for AlarmFigures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {} of the program as sent: ", self.line)?;
        if let Some(alarm) = self.alarm {
            write!(f, "PS{alarm:04} ")?;
        }
        f.write_str(&self.message)
    }
}

/// Block that ran slower than its feed times the override because one axis reached its limit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AxisLimitFigures {
    /// Number of blocks executed then, including this one.
    pub block: u32,
    /// N of the block.
    pub n: Option<i64>,
    /// Limiting axis.
    pub axis: &'static str,
    /// Feed that the block demanded when the limit was first reached.
    pub demanded_feed: f64,
    /// Feed that the axis permitted.
    pub allowed_feed: f64,
    /// Unit of both feeds.
    pub unit: &'static str,
}

impl fmt::Display for AxisLimitFigures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let AxisLimitFigures { block, n, axis, demanded_feed, allowed_feed, unit } = self;
        match n {
            Some(n) => write!(f, "N{n}")?,
            None => write!(f, "block {block}")?,
        }
        write!(f, ": {axis} allows {allowed_feed:.1} of {demanded_feed:.1} {unit}")
    }
}

/// Smallest and largest override on some moves, and the number of changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct OverrideFigures {
    /// Least, %.
    pub min: u8,
    /// Largest, %.
    pub max: u8,
    /// Changes in all.
    pub changes: u32,
}

impl OverrideFigures {
    /// Results of several groups of moves together.
    pub fn join(self, other: Self) -> Self {
        OverrideFigures {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            changes: self.changes + other.changes,
        }
    }
}

/// Results for all descents that the plunge law governs with a table of feeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct DescentFigures {
    /// Number of executed moves.
    pub moves: usize,
    /// Smallest and largest override on these moves.
    pub r#override: OverrideFigures,
}

/// Results for all moves that one cut rule selects.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MovementFigures {
    /// Rule, counted from 1 in the order of the job file.
    pub rule: usize,
    /// T number of its tool, if the job or the program gives one.
    pub tool: Option<i64>,
    /// `interior` or `exterior`; null for end mills.
    pub rotation: Option<&'static str>,
    /// `cw` or `ccw`; null for lines.
    pub direction: Option<&'static str>,
    /// Side on which the tool cuts: `outer` or `inner` for a ring; `inside`, `outside` or `slot` for an end mill.
    pub side: &'static str,
    /// Measured quantity: `contact`, `contour` or `thickest-chip`; `None` (null) if the rule's moves cannot be
    /// measured.
    pub measure: Option<&'static str>,
    /// Number of executed moves.
    pub arcs: usize,
    /// Measured chip load.
    pub chip_load: Option<ChipLoadFigures>,
    /// Measured chip load of the original program.
    pub baseline_chip_load: Option<ChipLoadFigures>,
    /// Thickest chip at any place of the outer and of the inner cutting circle, in the material behind the rule's stock
    /// line, divided by the target.
    pub thickest_ratio: [Option<f64>; 2],
    /// Smallest and largest override on these moves.
    pub r#override: Option<OverrideFigures>,
    /// Number of changes of the override on each arc, in order of execution.
    pub changes_per_arc: Vec<u32>,
}

/// Numbers of the control's position reports (`[dnc] report_every`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct ReportFigures {
    /// Number of requested reports.
    pub requested: usize,
    /// Number of received reports that agree with the program.
    pub confirmed: usize,
    /// Line of the program's file up to which the control has read, by its latest report; `None` before the first.
    pub line: Option<usize>,
}

impl ReportFigures {
    /// Numbers for these reports; `None` if none was requested.
    pub fn of(reports: &Reports) -> Option<Self> {
        let (requested, confirmed) = reports.counts();
        (requested > 0).then(|| ReportFigures { requested, confirmed, line: reports.read_up_to() })
    }
}

/// Statistics of the serial line during a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LinkFigures {
    /// Number of characters sent over the line.
    pub bytes: u64,
    /// Fraction of the run's time in which the line was busy.
    pub utilization: f64,
    /// Number of DC3 that the control sent.
    pub xoff_count: u32,
    /// Largest number of characters that arrived after one DC3, if arcfeed is the receiving end.
    pub max_bytes_after_xoff: Option<u32>,
    /// Total time in which the control had nothing to execute because the line was too slow, ms, if arcfeed simulates
    /// the control.
    pub starved_ms: Option<u64>,
    /// Number of repeated transmissions; always 0 on a plain DNC line.
    pub retries: u32,
    /// Damaged characters from the other end; `None` if the port does not report them.
    pub line_errors: Option<LineErrorFigures>,
}

/// Numbers of damaged characters, counted by the operating system since the port was opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct LineErrorFigures {
    /// Characters whose stop bit was missing.
    pub frame: u32,
    /// Characters lost in the UART, because the driver did not read them in time.
    pub overrun: u32,
    /// Characters with wrong parity.
    pub parity: u32,
    /// Break conditions received.
    pub r#break: u32,
    /// Characters lost in the driver, because its buffer was full.
    pub buffer_overrun: u32,
}

impl From<Counts> for LineErrorFigures {
    fn from(counts: Counts) -> Self {
        let Counts { frame, overrun, parity, breaks, buffer_overrun } = counts;
        LineErrorFigures { frame, overrun, parity, r#break: breaks, buffer_overrun }
    }
}
