//! `arcfeed measure`: chip load of a run from the positions of the machine that made it.
//!
//! ```text
//! distance from an arc:  | |p - A| - rho |                                          (1)
//! distance from a line:  | (p - S) - ((p - S) . t) t |                              (2)
//! ```
//!
//! Source: plane geometry; p in the plane of the arc, S the start of the line and t its direction.

use std::collections::HashMap;
use std::path::PathBuf;

use arcfeed_milling::cutting::measured_move::GoverningRule;
use arcfeed_milling::cutting::meter::ChipMeter;
use arcfeed_model::job::Job;
use arcfeed_model::telemetry::Sample;
use arcfeed_nc::modal::Pose;
use arcfeed_nc::segment::Segment;
use arcfeed_nc::text::Lines;
use arcfeed_units::{Micros, MmPerMin, Nm, PERCENT, RevPerMin, S_PER_MIN, US_PER_S};

use super::for_control::{TargetControl, feed_source, translated};
use super::job_input::{JobInput, adapted};
use super::outcome::{Failure, file_failure};
use super::simulate::finish;
use super::simulate::run_figures::of_chips;
use crate::adapt::{Adapted, PlannedBlock};
use crate::job::JobFile;
use crate::program::Source;
use crate::report::figures::RunReport;

/// Measure the chip load of a run from the positions of the machine that made it
///
/// The file is CSV with a head line: time (s), x, y, z (the job's unit, relative to the workpiece's origin), line (of the NC
/// file that ran, from 1) and, if known, feed (commanded, per minute) and spindle (rev/min). Other columns are ignored.
#[derive(Debug, clap::Args)]
pub struct Measure {
    /// Positions of the machine, one row a sample
    #[arg(long, value_name = "FILE.csv")]
    positions: PathBuf,
    /// The original program ran, not the adapted one
    #[arg(long)]
    original: bool,
    /// The program ran as `adapt --for` this control wrote it
    #[arg(long = "for", value_enum, value_name = "CONTROL")]
    target: Option<TargetControl>,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    input: JobInput,
}

/// Row of the file.
#[derive(Clone, Copy, Debug)]
struct Row {
    time_s: f64,
    position: [f64; 3],
    line: usize,
    feed: Option<f64>,
    spindle: Option<f64>,
}

/// Columns of the file, by index.
struct Columns {
    time: usize,
    axes: [usize; 3],
    line: usize,
    feed: Option<usize>,
    spindle: Option<usize>,
}

impl Measure {
    /// Runs the command.
    ///
    /// # Errors
    /// The job, the program or the file is at fault.
    pub fn run(&self) -> Result<(), Failure> {
        let (file, source, _) = self.input.load_text()?;
        let program = source.whole().map_err(Failure::Input)?;
        let planned = adapted(&program, &file);
        let blocks = self.blocks_by_line(&source, &file, &planned)?;
        let text = std::fs::read_to_string(&self.positions).map_err(|error| file_failure(&self.positions, &error))?;
        let mut run = MeasuredRun::new(&file.job);
        let mut lines = text.lines().enumerate();
        let head = lines.next().map_or("", |(_, head)| head);
        let columns = Columns::read(head).map_err(|message| self.fault(0, &message))?;
        for (index, line) in lines {
            let row = columns.row(line).map_err(|message| self.fault(index, &message))?;
            if run.last.is_some_and(|last| row.time_s <= last.time_s) {
                return Err(self.fault(index, "the time does not grow; write the samples in their order"));
            }
            run.add(row, blocks.get(&row.line).copied());
        }
        let title = format!("{}: measured in {}", file.program.display(), self.positions.display());
        finish(&run.report(), self.json, title)
    }

    fn fault(&self, index: usize, message: &str) -> Failure {
        Failure::Input(format!("{}:{}:1: error: {message}", self.positions.display(), index + 1))
    }

    /// Planned block of each line of the NC file that ran.
    fn blocks_by_line<'a>(
        &self,
        source: &Source,
        file: &JobFile,
        planned: &'a Adapted,
    ) -> Result<HashMap<usize, &'a PlannedBlock>, Failure> {
        let program_lines = sent_lines(&source.bytes, planned, self.original);
        let text = if self.original { source.bytes.clone() } else { planned.text.clone() };
        let first_lines = match self.target {
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

impl Columns {
    fn read(head: &str) -> Result<Self, String> {
        let names: Vec<String> = head.split(',').map(|name| name.trim().to_ascii_lowercase()).collect();
        let find = |wanted: &str| names.iter().position(|name| name == wanted);
        let need = |wanted: &str| find(wanted).ok_or(format!("no column `{wanted}`; the head line is time,x,y,z,line"));
        let axes = [need("x")?, need("y")?, need("z")?];
        Ok(Columns { time: need("time")?, axes, line: need("line")?, feed: find("feed"), spindle: find("spindle") })
    }

    fn row(&self, line: &str) -> Result<Row, String> {
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        let number = |column: usize| {
            let field = fields.get(column).copied().unwrap_or_default();
            let value = field.parse().ok().filter(|value: &f64| value.is_finite());
            value.ok_or(format!("column {}: write a number (found `{field}`)", column + 1))
        };
        let [x, y, z] = self.axes;
        Ok(Row {
            time_s: number(self.time)?,
            position: [number(x)?, number(y)?, number(z)?],
            line: number(self.line)?.max(0.0) as usize,
            feed: self.feed.map(number).transpose()?,
            spindle: self.spindle.map(number).transpose()?,
        })
    }
}

/// Run measured so far.
struct MeasuredRun<'a> {
    job: &'a Job,
    meter: ChipMeter,
    /// Block in execution, and the number of blocks so far.
    current: Option<&'a PlannedBlock>,
    /// The machine is past the end of its move: a period that ends one move and begins the next has one line.
    is_past: bool,
    count: u32,
    first_s: Option<f64>,
    last: Option<Row>,
    path_error_mm: f64,
}

impl<'a> MeasuredRun<'a> {
    fn new(job: &'a Job) -> Self {
        let meter = ChipMeter::new(job.tools.first());
        MeasuredRun {
            job,
            meter,
            current: None,
            is_past: false,
            count: 0,
            first_s: None,
            last: None,
            path_error_mm: 0.0,
        }
    }

    fn add(&mut self, row: Row, block: Option<&'a PlannedBlock>) {
        if block.map(|block| block.line) != self.current.map(|block| block.line) {
            self.begin(block);
        }
        let unit_mm = self.job.unit.mm();
        let position_mm = row.position.map(|value| value * unit_mm);
        self.is_past |= self.passes_end(position_mm);
        if let Some(block) = self.current.filter(|_| !self.is_past) {
            self.first_s.get_or_insert(row.time_s);
            let governing = block.rule.filter(|_| block.demand.is_some()).and_then(|rule| self.job.rules.get(rule));
            let setup = governing.map(|rule| self.job.tool_of(rule));
            let spindle = setup.map(|setup| block.spindle.unwrap_or(setup.spindle));
            let spindle = row.spindle.map(|speed| RevPerMin(speed.abs() as f32)).or(spindle);
            spindle.into_iter().for_each(|spindle| self.meter.set_spindle(spindle));
            if governing.is_some() {
                let distance_mm = distance_mm(&block.segment, position_mm);
                self.path_error_mm = self.path_error_mm.max(distance_mm);
            }
            self.meter.add_sample(&Sample {
                at: Micros((row.time_s * US_PER_S as f64).round() as u64),
                position: Pose { linear: position_mm.map(Nm::from_mm), ..Pose::ORIGIN },
                block: self.count,
                commanded: MmPerMin((self.feed(&row) * unit_mm) as f32),
                override_percent: PERCENT as u8,
            });
        }
        self.last = Some(row);
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
    fn feed(&self, row: &Row) -> f64 {
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
            along: block.along.as_ref(),
            target: block.target(self.job),
        });
        self.meter.begin(self.count, &block.segment, governing.as_ref());
    }

    /// Figures of the run; the last block is over.
    fn report(mut self) -> RunReport {
        let end = self.count + 1;
        if let Some(block) = self.current {
            self.meter.begin(end, &block.segment, None);
        }
        RunReport {
            blocks_executed: Some(self.count as usize),
            cycle_time_s: self.first_s.zip(self.last).map(|(first, last)| last.time_s - first),
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
