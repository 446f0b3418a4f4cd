//! Measurement of the chip load from positions that were recorded on the machine.
//!
//! ```text
//! distance from an arc:  | |p - A| - rho |                                          (1)
//! distance from a line:  | (p - S) - ((p - S) . t) t |                              (2)
//! ```
//!
//! Source: plane geometry; p in the plane of the arc, S the start of the line and t its direction.

use std::collections::HashMap;

use arcfeed_law::move_table::MoveTable;
use arcfeed_milling::cutting::measured_move::GoverningRule;
use arcfeed_milling::cutting::meter::ChipMeter;
use arcfeed_model::job::Job;
use arcfeed_model::telemetry::Sample;
use arcfeed_nc::modal::Pose;
use arcfeed_nc::segment::Segment;
use arcfeed_nc::text::Lines;
use arcfeed_units::{Micros, MmPerMin, Nm, PERCENT, RevPerMin, S_PER_MIN, US_PER_S};

use super::super::for_control::{TargetControl, feed_source, translated};
use super::super::outcome::Failure;
use super::super::simulate::run_figures::of_chips;
use crate::adapt::{Adapted, PlannedBlock};
use crate::job::JobFile;
use crate::program::Source;
use crate::report::figures::{OverrideFigures, RunReport};

/// Sample of a run that was recorded on a machine.
#[derive(Clone, Copy, Debug)]
pub struct MeasuredSample {
    /// Time, s.
    pub time_s: f64,
    /// Position relative to the workpiece's origin, in the job's unit.
    pub position: [f64; 3],
    /// Line of the NC file that ran, from 1.
    pub line: usize,
    /// Commanded feed in the job's unit per minute, if it is known.
    pub feed: Option<f64>,
    /// Spindle speed in rev/min, if it is known.
    pub spindle: Option<f64>,
    /// Feed override, as a fraction of F, if it is known.
    pub override_ratio: Option<f64>,
}

/// Planned block for each line of the NC file that ran. That file is the original program (`original`) or the adapted one, which may have
/// been written for the control `target`.
///
/// # Errors
/// The control cannot execute the program.
pub fn blocks_by_line<'a>(
    source: &Source,
    file: &JobFile,
    planned: &'a Adapted,
    original: bool,
    target: Option<TargetControl>,
) -> Result<HashMap<usize, &'a PlannedBlock>, Failure> {
    let program_lines = sent_lines(&source.bytes, planned, original);
    let text = if original { source.bytes.clone() } else { planned.text.clone() };
    let first_lines = match target {
        Some(TargetControl::Linuxcnc) => Some(translated(source, text, feed_source(file))?.first_lines),
        None => None,
    };
    let by_line: HashMap<usize, &PlannedBlock> = planned.blocks.iter().map(|block| (block.line, block)).collect();
    let place = |(index, line): (usize, usize)| {
        let sent = first_lines.as_ref().map_or(Some(index + 1), |lines| lines.get(index).copied())?;
        Some((sent, *by_line.get(&line)?))
    };
    Ok(program_lines.into_iter().enumerate().filter_map(place).collect())
}

/// Line of the program, counted from 1, for each line that ran.
fn sent_lines(program: &[u8], planned: &Adapted, original: bool) -> Vec<usize> {
    if original {
        return (1..=Lines::new(program).count()).collect();
    }
    let begins = std::iter::once(0).chain(planned.line_ends.iter().copied());
    let pieces = begins.zip(&planned.line_ends).map(|(begin, end)| planned.text.get(begin..*end).unwrap_or_default());
    (1..).zip(pieces).flat_map(|(line, text)| std::iter::repeat_n(line, Lines::new(text).count())).collect()
}

/// Results of a run that was recorded on a machine, computed sample by sample.
pub struct MeasuredRun<'a> {
    job: &'a Job,
    meter: ChipMeter,
    /// Block in execution, and the number of blocks so far.
    current: Option<&'a PlannedBlock>,
    /// The machine is past the end of its move: a period that ends one move and begins the next has one line.
    is_past: bool,
    count: u32,
    /// Begin of the first move, and the last sample of a move.
    first_s: Option<f64>,
    moved_s: Option<f64>,
    last: Option<MeasuredSample>,
    path_error_mm: f64,
    /// Override of governed samples, whole percent.
    percents: Option<OverrideFigures>,
    percent: Option<u8>,
}

impl<'a> MeasuredRun<'a> {
    /// State before the first sample.
    pub fn new(job: &'a Job) -> Self {
        let meter = ChipMeter::new(job.tools.first());
        MeasuredRun {
            job,
            meter,
            current: None,
            is_past: false,
            count: 0,
            first_s: None,
            moved_s: None,
            last: None,
            path_error_mm: 0.0,
            percents: None,
            percent: None,
        }
    }

    /// Processes the next sample; `block` is the planned block of its line.
    pub fn add(&mut self, row: MeasuredSample, block: Option<&'a PlannedBlock>) {
        if block.map(|block| block.line) != self.current.map(|block| block.line) {
            self.begin(block);
        }
        let unit_mm = self.job.unit.mm();
        let position_mm = row.position.map(|value| value * unit_mm);
        self.is_past |= self.passes_end(position_mm);
        if let Some(block) = self.block() {
            self.first_s.get_or_insert(row.time_s);
            let governing = block.rule.filter(|_| block.demand.is_some()).and_then(|rule| self.job.rules.get(rule));
            let setup = governing.map(|rule| self.job.tool_of(rule));
            let spindle = setup.map(|setup| block.spindle.unwrap_or(setup.spindle));
            let spindle = row.spindle.map(|speed| RevPerMin(speed.abs() as f32)).or(spindle);
            spindle.into_iter().for_each(|spindle| self.meter.set_spindle(spindle));
            if governing.is_some() {
                let distance_mm = distance_mm(&block.segment, position_mm);
                self.path_error_mm = self.path_error_mm.max(distance_mm);
                row.override_ratio.into_iter().for_each(|ratio| self.add_override(ratio));
            }
            self.meter.add_sample(&Sample {
                at: Micros((row.time_s * US_PER_S as f64).round() as u64),
                position: Pose { linear: position_mm.map(Nm::from_mm), ..Pose::ORIGIN },
                block: self.count,
                commanded: MmPerMin((self.feed(&row) * unit_mm) as f32),
                override_percent: PERCENT as u8,
            });
        }
        if block.is_some() && self.last.is_none_or(|last| last.position != row.position) {
            self.moved_s = Some(row.time_s);
        }
        self.last = Some(row);
    }

    /// Latest sample.
    pub fn last(&self) -> Option<&MeasuredSample> {
        self.last.as_ref()
    }

    /// Block in execution at the latest sample; `None` once the machine has passed the end of its move.
    pub fn block(&self) -> Option<&'a PlannedBlock> {
        self.current.filter(|_| !self.is_past)
    }

    /// Number of blocks that have begun so far.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Chip meter, with the chips measured so far.
    pub fn meter(&self) -> &ChipMeter {
        &self.meter
    }

    fn add_override(&mut self, ratio: f64) {
        let percent = (ratio * f64::from(PERCENT)).round().clamp(0.0, f64::from(u8::MAX)) as u8;
        let changes = u32::from(self.percent.is_some_and(|last| last != percent));
        let figures = OverrideFigures { min: percent, max: percent, changes };
        self.percents = Some(self.percents.map_or(figures, |all| all.join(figures)));
        self.percent = Some(percent);
    }

    /// Whether the machine has passed the end of its move since the last sample.
    fn passes_end(&self, position_mm: [f64; 3]) -> bool {
        let (Some(block), Some(last)) = (self.current, self.last) else { return false };
        let end_mm = block.segment.end.linear.map(Nm::to_mm);
        let from_mm = last.position.map(|value| value * self.job.unit.mm());
        let along = direction_at_end(&block.segment);
        let beyond = |at_mm: [f64; 3]| dot(minus(at_mm, end_mm), along);
        let (offset, travel) = (minus(position_mm, end_mm), minus(position_mm, from_mm));
        beyond(from_mm) <= 0.0 && beyond(position_mm) > 0.0 && dot(offset, offset) <= dot(travel, travel)
    }

    /// Commanded feed, or the measured one.
    fn feed(&self, row: &MeasuredSample) -> f64 {
        let Some(last) = self.last else { return 0.0 };
        let squares = row.position.iter().zip(last.position).map(|(to, from)| (to - from) * (to - from));
        row.feed.unwrap_or(libm::sqrt(squares.sum()) / (row.time_s - last.time_s) * S_PER_MIN)
    }

    fn begin(&mut self, block: Option<&'a PlannedBlock>) {
        (self.current, self.is_past) = (block, false);
        let Some(block) = block else { return };
        self.count += 1;
        let index = block.rule.filter(|_| block.demand.is_some());
        let rule = index.and_then(|index| Some((index, self.job.rules.get(index)?)));
        let governing = rule.map(|(index, rule)| GoverningRule {
            index,
            rule,
            setup: self.job.tool_of(rule),
            along: block.along.as_deref().and_then(MoveTable::engaged),
            target: block.target(self.job),
        });
        self.meter.begin(self.count, &block.segment, governing.as_ref());
    }

    /// Ends the last block; returns the results of the whole run.
    pub fn end(&mut self) -> RunReport {
        let end = self.count + 1;
        if let Some(block) = self.current {
            self.meter.begin(end, &block.segment, None);
        }
        RunReport {
            blocks_executed: Some(self.count as usize),
            cycle_time_s: self.first_s.zip(self.moved_s).map(|(first, last)| last - first),
            r#override: self.percents,
            path_error: Some(self.path_error_mm / self.job.unit.mm()),
            ..of_chips(self.job, self.meter.moves())
        }
    }
}

/// Distance of a position from the path of a move; across the plane it does not count for an arc.
fn distance_mm(segment: &Segment, position_mm: [f64; 3]) -> f64 {
    let start_mm = segment.start.linear.map(Nm::to_mm);
    if let Some(arc) = segment.arc() {
        let (first, second, _) = arc.plane.axes();
        let center_mm = arc.center.map(Nm::to_mm);
        let radius_mm = |at: [f64; 3]| libm::hypot(at[first] - center_mm[0], at[second] - center_mm[1]);
        return (radius_mm(position_mm) - radius_mm(start_mm)).abs(); // (1)
    }
    let along = minus(segment.end.linear.map(Nm::to_mm), start_mm);
    let offset = minus(position_mm, start_mm);
    let share = dot(offset, along) / dot(along, along).max(f64::MIN_POSITIVE);
    let across: [f64; 3] = std::array::from_fn(|axis| offset[axis] - share * along[axis]);
    libm::sqrt(dot(across, across)) // (2)
}

/// Direction of a move at its end, of any length.
fn direction_at_end(segment: &Segment) -> [f64; 3] {
    let [start_mm, end_mm] = [segment.start, segment.end].map(|pose| pose.linear.map(Nm::to_mm));
    let Some(arc) = segment.arc() else { return minus(end_mm, start_mm) };
    let (first, second, _) = arc.plane.axes();
    let sign = f64::from(arc.turn.sign());
    let mut direction = [0.0; 3];
    direction[first] = -sign * (end_mm[second] - arc.center[1].to_mm());
    direction[second] = sign * (end_mm[first] - arc.center[0].to_mm());
    direction
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
