//! `arcfeed sweep`: campaigns of simulated runs, on all cores or in shards, that go on where they stopped.

mod axis;

mod row;

mod sweep_file;

mod single_run;

mod check;

mod journal;

mod results;

mod slurm;

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::{Builder, available_parallelism, scope};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::STACK_BYTES;
use super::outcome::{Failure, file_failure, json_text, on_interrupt, refuse_inputs, say};
use crate::console::{self, Progress, note};
use crate::plural::counted;
use crate::trace::TraceFormat;
use journal::Journal;
use results::{NAMED_MAX, Results, Summary};
use sweep_file::Campaign;

/// Suffix of journals.
const JOURNAL_SUFFIX: &str = "journal";

/// Run a campaign: one simulated run for each combination of values, with its results as a row of a table
///
/// Runs on all cores. After an interruption the same command continues where it stopped. Exit code 1 if a run fails, or ends
/// otherwise than the sweep file allows (docs/campaigns.md).
#[derive(Debug, clap::Args)]
pub struct Sweep {
    /// The sweep file
    #[arg(value_name = "SWEEP.toml")]
    sweep: PathBuf,
    /// Folder of the journals and of the table, DIR/runs/part-00001.parquet; without it SWEEP.out beside the sweep file
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Only the runs of shard I of N: all shards together are the campaign; --merge writes their table
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Run nothing: write the table of all shards in the folder
    #[arg(long, conflicts_with = "shard")]
    merge: bool,
    /// Only this run, with the output of its own command
    #[arg(long, value_name = "N", conflicts_with_all = ["shard", "merge", "output"])]
    run: Option<u64>,
    /// Run nothing: print the script of a Slurm job array with this number of shards
    #[arg(long, value_name = "SHARDS", conflicts_with_all = ["shard", "merge", "run"], value_parser = clap::value_parser!(u32).range(1..=100_000))]
    slurm: Option<u32>,
    /// Runs at a time; without it one for each core
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Write the table as CSV in place of Parquet
    #[arg(long)]
    csv: bool,
    /// Write the runs here as JUnit XML, one test case for each
    #[arg(long, value_name = "OUT.xml", conflicts_with_all = ["shard", "run", "slurm"])]
    junit: Option<PathBuf>,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    json: bool,
}

/// Part of a campaign: the runs whose number is `index` modulo `count`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shard {
    index: u64,
    count: u64,
}

impl FromStr for Shard {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (index, count) = text.split_once('/').ok_or("write I/N, for example 1/4")?;
        match (index.parse(), count.parse()) {
            (Ok(index), Ok(count)) if 1 <= index && index <= count => Ok(Shard { index, count }),
            _ => Err("write I/N with I from 1 to N"),
        }
    }
}

impl Shard {
    const WHOLE: Shard = Shard { index: 1, count: 1 };

    fn journal(self) -> String {
        format!("shard-{}-of-{}.{JOURNAL_SUFFIX}", self.index, self.count)
    }
}

impl Sweep {
    /// Runs the command.
    ///
    /// # Errors
    /// The sweep file or a job of it is at fault, a run is not accepted, a file cannot be written, or the operator stopped it.
    pub fn run(&self) -> Result<(), Failure> {
        let format = TraceFormat::of(Path::new(if self.csv { "runs.csv" } else { "runs.parquet" }));
        let format = format.map_err(|message| Failure::Usage(format!("{message}; --csv writes CSV")))?;
        let campaign = Campaign::load(&self.sweep)?;
        if let Some(run) = self.run {
            if !(1..=campaign.runs).contains(&run) {
                return Err(Failure::Usage(format!("--run {run}: the campaign has the runs 1 to {}", campaign.runs)));
            }
            note(format_args!("{}", campaign.repeat(run)));
            return campaign.repeat_run(run, self.json);
        }
        let inputs = check::check(&campaign)?;
        results::refuse_same_columns(&campaign)?;
        let fingerprint = check::fingerprint(&campaign, &inputs)?;
        if let Some(shards) = self.slurm {
            say(format_args!("{}", slurm::script(&self.sweep, &self.folder(), shards, self.csv)));
            return Ok(());
        }
        refuse_inputs(&[self.junit.as_deref()], &inputs)?;
        let folder = self.folder();
        fs::create_dir_all(&folder).map_err(|error| file_failure(&folder, &error))?;
        if !self.merge {
            self.execute(&campaign, &folder, fingerprint)?;
        }
        if self.shard.is_some_and(|shard| shard.count > 1) {
            return Ok(());
        }
        let mut results = Results::open(&campaign, &folder, fingerprint)?;
        let summary = results.write(&folder.join("runs"), format, self.junit.as_deref())?;
        self.report(&summary)
    }

    fn folder(&self) -> PathBuf {
        self.output.clone().unwrap_or_else(|| self.sweep.with_extension("out"))
    }

    /// Executes the runs of the shard that are not in its journal.
    fn execute(&self, campaign: &Campaign, folder: &Path, fingerprint: u64) -> Result<(), Failure> {
        let shard = self.shard.unwrap_or(Shard::WHOLE);
        let (journal, done) = Journal::open(&folder.join(shard.journal()), fingerprint)?;
        let done: HashSet<u64> = done.into_iter().collect();
        let count = (campaign.runs + shard.count - shard.index) / shard.count;
        let capture = console::capture();
        let target = if capture.is_some() { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(count), target);
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} runs, {per_sec}, {eta} left{msg}") {
            bar.set_style(style);
        }
        bar.inc(done.len() as u64);
        // Each run is captured, and would not watch for Ctrl-C by itself.
        let is_interrupted = on_interrupt();
        let threads = self.threads.map_or_else(|| available_parallelism().map_or(1, usize::from), usize::from);
        let next = AtomicU64::new(0);
        let work = Work { campaign, shard, done, next, count, journal: Mutex::new(journal), bar, is_interrupted };
        let ended = scope(|scope| {
            let run = || console::captured(capture.clone(), || work.run());
            let start = |_| Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, run);
            let workers: Vec<_> = (0..threads).map(start).collect();
            let ends = workers.into_iter().map(|worker| {
                let worker = worker.map_err(|error| Failure::Machine(format!("no thread for a run: {error}")))?;
                worker.join().unwrap_or_else(|_| Err(Failure::Machine("a worker ended: a defect of arcfeed".into())))
            });
            ends.collect::<Vec<_>>()
        });
        work.bar.finish_and_clear();
        work.journal.into_inner().map_or(Ok(()), |journal| journal.sync())?;
        ended.into_iter().collect()
    }

    /// Prints the counts, and the runs that are not accepted.
    fn report(&self, summary: &Summary) -> Result<(), Failure> {
        if self.json {
            say(format_args!("{}", json_text(summary)));
        } else {
            let ends = summary.ends.iter().filter(|(_, count)| **count > 0);
            let ends: Vec<String> = ends.map(|(name, count)| format!("{count} {name}")).collect();
            let last = summary.tables.last().map_or("", String::as_str);
            say(format_args!("{}: {}; rows in {last}", counted(summary.runs, "run"), ends.join(", ")));
        }
        if summary.unaccepted == 0 {
            return Ok(());
        }
        let mut lines: Vec<String> = Vec::new();
        for run in &summary.failing {
            lines.push(format!("run {}: {}: {}\n    {}", run.run, run.status.name(), run.message, run.repeat));
        }
        let more = summary.unaccepted.saturating_sub(NAMED_MAX);
        lines.extend((more > 0).then(|| format!("and {more} more: see the table")));
        lines.push(format!("{} of {} are not accepted", counted(summary.unaccepted, "run"), summary.runs));
        Err(Failure::Input(lines.join("\n")))
    }
}

/// Runs of a shard, and what its workers share.
struct Work<'c> {
    campaign: &'c Campaign,
    shard: Shard,
    done: HashSet<u64>,
    /// Runs of the shard that have been taken by a worker.
    next: AtomicU64,
    count: u64,
    journal: Mutex<Journal>,
    bar: ProgressBar,
    is_interrupted: &'c AtomicBool,
}

impl Work<'_> {
    /// Takes one run after the other until none is left.
    fn run(&self) -> Result<(), Failure> {
        loop {
            let taken = self.next.fetch_add(1, Ordering::Relaxed);
            if taken >= self.count {
                return Ok(());
            }
            let run = self.shard.index + taken * self.shard.count;
            if self.done.contains(&run) {
                continue;
            }
            let row = self.campaign.row(run);
            // The others end with the runs that they have.
            if row.is_err() {
                self.next.store(self.count, Ordering::Relaxed);
            }
            let stopped = || Failure::Stopped("stopped by the operator: started again, the campaign goes on".into());
            let Some(row) = row? else { return Err(stopped()) };
            let capture = console::capture();
            let is_stopped = capture.as_ref().is_some_and(|capture| capture.is_stopped());
            if is_stopped || self.is_interrupted.load(Ordering::Relaxed) {
                return Err(stopped());
            }
            let added = self.journal.lock().map(|mut journal| journal.add(&row));
            added.unwrap_or_else(|_| Err(Failure::Machine("the journal is lost: a defect of arcfeed".into())))?;
            self.bar.inc(1);
            if let Some(capture) = capture {
                capture.set_progress(Progress::Campaign { done: self.bar.position(), runs: self.count });
            }
        }
    }
}
