//! `arcfeed measure`: chip load of a run from the positions of the machine that made it.

pub mod measured_run;

use std::path::PathBuf;

use super::for_control::TargetControl;
use super::job_input::{JobInput, adapted};
use super::outcome::{Failure, file_failure};
use super::simulate::finish;
use measured_run::{MeasuredRun, MeasuredSample, blocks_by_line};

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
        let blocks = blocks_by_line(&source, &file, &planned, self.original, self.target)?;
        let text = std::fs::read_to_string(&self.positions).map_err(|error| file_failure(&self.positions, &error))?;
        let mut run = MeasuredRun::new(&file.job);
        let mut lines = text.lines().enumerate();
        let head = lines.next().map_or("", |(_, head)| head);
        let columns = Columns::read(head).map_err(|message| self.fault(0, &message))?;
        for (index, line) in lines {
            let row = columns.row(line).map_err(|message| self.fault(index, &message))?;
            if run.last().is_some_and(|last| row.time_s <= last.time_s) {
                return Err(self.fault(index, "the time does not grow; write the samples in their order"));
            }
            run.add(row, blocks.get(&row.line).copied());
        }
        let title = format!("{}: measured in {}", file.program.display(), self.positions.display());
        finish(&run.end(), self.json, title)
    }

    fn fault(&self, index: usize, message: &str) -> Failure {
        Failure::Input(format!("{}:{}:1: error: {message}", self.positions.display(), index + 1))
    }
}

impl Columns {
    fn read(head: &str) -> Result<Self, String> {
        let names: Vec<String> = head.split(',').map(|name| name.trim().to_ascii_lowercase()).collect();
        let find = |wanted: &str| names.iter().position(|name| name == wanted);
        let need = |wanted: &str| find(wanted).ok_or(format!("no column `{wanted}`; the head line is time,x,y,z,line"));
        let axes = [need("x")?, need("y")?, need("z")?];
        Ok(Columns { time: need("time")?, axes, line: need("line")?, feed: find("feed"), spindle: find("spindle") })
    }

    fn row(&self, line: &str) -> Result<MeasuredSample, String> {
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        let number = |column: usize| {
            let field = fields.get(column).copied().unwrap_or_default();
            let value = field.parse().ok().filter(|value: &f64| value.is_finite());
            value.ok_or(format!("column {}: write a number (found `{field}`)", column + 1))
        };
        let [x, y, z] = self.axes;
        Ok(MeasuredSample {
            time_s: number(self.time)?,
            position: [number(x)?, number(y)?, number(z)?],
            line: number(self.line)?.max(0.0) as usize,
            feed: self.feed.map(number).transpose()?,
            spindle: self.spindle.map(number).transpose()?,
            override_ratio: None,
        })
    }
}
