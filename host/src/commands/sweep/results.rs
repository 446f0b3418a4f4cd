//! Results of a campaign: the rows of all journals in order of their runs, as tables, as JUnit XML and as counts.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use toml::de::DeTable;

use super::super::outcome::{Failure, file_failure};
use super::super::simulate::assertions::Verdict;
use super::super::simulate::junit;
use super::axis::SweepAxis;
use super::journal::{RowPlace, read, row_at};
use super::row::{Row, RunStatus};
use super::sweep_file::Campaign;
use crate::output::PendingFile;
use crate::trace::table::{Cell, Kind, Table, TableColumn};
use crate::trace::{TableFile, TraceFormat};

/// Runs of a file of the table.
const PART_RUNS: u64 = 100_000;

/// Largest number of failing runs that the summary names.
pub const NAMED_MAX: usize = 20;

/// Missing runs that are named.
const MISSING_MAX: usize = 5;

/// Columns before those of the campaign.
const RUN_COLUMNS: [&str; 3] = ["run", "status", "message"];

/// Journals of all shards of a campaign, from which the results are collected.
pub struct Results<'c> {
    campaign: &'c Campaign,
    journals: Vec<(PathBuf, BufReader<File>)>,
    /// For each run its journal and its place there, in order of the runs.
    places: Vec<(usize, RowPlace)>,
}

/// Summary of a campaign: numbers of its runs by outcome.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Summary {
    /// Number of runs in all.
    pub runs: usize,
    /// Number of runs whose outcome the sweep file does not accept.
    pub unaccepted: usize,
    /// Number of runs for each outcome, by its name.
    pub ends: BTreeMap<&'static str, usize>,
    /// First of the runs that are not accepted, at most [`NAMED_MAX`].
    pub failing: Vec<FailingRun>,
    /// Names of the files of the table.
    pub tables: Vec<String>,
}

/// Run that is not accepted.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FailingRun {
    /// Number of the run, counted from 1.
    pub run: u64,
    /// Outcome of the run.
    pub status: RunStatus,
    /// Message of the run's command.
    pub message: String,
    /// Command that repeats the run.
    pub repeat: String,
}

impl<'c> Results<'c> {
    /// Finds all runs in the journals of a folder.
    ///
    /// # Errors
    /// A journal is damaged or another campaign's; a run is missing.
    pub fn open(campaign: &'c Campaign, folder: &Path, fingerprint: u64) -> Result<Self, Failure> {
        let entries = std::fs::read_dir(folder).map_err(|error| file_failure(folder, &error))?;
        let paths = entries.flatten().map(|entry| entry.path());
        let is_journal = |path: &PathBuf| path.extension().is_some_and(|suffix| suffix == super::JOURNAL_SUFFIX);
        let mut paths: Vec<PathBuf> = paths.filter(is_journal).collect();
        paths.sort();
        let (mut journals, mut places) = (Vec::new(), Vec::new());
        for path in paths {
            read(&path, fingerprint, &mut |place| places.push((journals.len(), place)))?;
            let file = File::open(&path).map_err(|error| file_failure(&path, &error))?;
            journals.push((path, BufReader::new(file)));
        }
        // A run that is in the journals of two divisions has the same row in both.
        places.sort_by_key(|(journal, place)| (place.run, *journal));
        places.dedup_by_key(|(_, place)| place.run);
        let results = Results { campaign, journals, places };
        results.refuse_missing(folder)?;
        Ok(results)
    }

    fn refuse_missing(&self, folder: &Path) -> Result<(), Failure> {
        let missing = self.campaign.runs - self.places.len() as u64;
        if missing == 0 {
            return Ok(());
        }
        let has = |run: &u64| self.places.binary_search_by_key(run, |(_, place)| place.run).is_ok();
        let first: Vec<String> =
            (1..=self.campaign.runs).filter(|run| !has(run)).take(MISSING_MAX).map(|run| run.to_string()).collect();
        Err(Failure::Input(format!(
            "{}: {missing} of {} runs are missing, the first {}: start their shards again, they go on where they stopped",
            folder.display(),
            self.campaign.runs,
            first.join(", ")
        )))
    }

    /// Writes the table, and the JUnit file if there is one; returns the counts.
    ///
    /// # Errors
    /// A file cannot be written or read.
    pub fn write(&mut self, folder: &Path, format: TraceFormat, junit: Option<&Path>) -> Result<Summary, Failure> {
        let columns = Columns::new(self.campaign);
        let table = Table { name: "runs", suffix: "", columns: &columns.columns() };
        std::fs::create_dir_all(folder).map_err(|error| file_failure(folder, &error))?;
        let ends = RunStatus::ALL.map(|status| (status.name(), 0)).into();
        let mut summary = Summary { runs: self.places.len(), ends, ..Summary::default() };
        for part in 0..self.campaign.runs.div_ceil(PART_RUNS) {
            let path = folder.join(format!("part-{:05}.{}", part + 1, format.suffix()));
            let failed = |error: std::io::Error| file_failure(&path, &error);
            let mut file = TableFile::begin(format, &path, &table).map_err(failed)?;
            for run in part * PART_RUNS..((part + 1) * PART_RUNS).min(self.campaign.runs) {
                let row = self.row(run as usize)?;
                summary.add(self.campaign, &row);
                columns.with_cells(self.campaign, &row, &mut |cells| file.add(cells)).map_err(failed)?;
            }
            file.finish().map_err(failed)?;
            summary.tables.push(path.display().to_string());
        }
        if let Some(path) = junit {
            self.write_junit(path, &summary).map_err(|error| file_failure(path, &error))?;
        }
        Ok(summary)
    }

    fn row(&mut self, index: usize) -> Result<Row, Failure> {
        let (journal, place) = self.places[index];
        let (path, file) = &mut self.journals[journal];
        row_at(file, path, place)
    }

    fn write_junit(&mut self, path: &Path, summary: &Summary) -> std::io::Result<()> {
        let mut file = BufWriter::new(PendingFile::begin(path)?);
        let class = self.campaign.path.display().to_string();
        let failures = summary.count(RunStatus::Failed).min(summary.unaccepted);
        let counts = [summary.runs, failures, summary.unaccepted - failures];
        file.write_all(junit::begin(&format!("arcfeed sweep {class}"), counts, 0.0).as_bytes())?;
        for index in 0..self.places.len() {
            let row = self.row(index).map_err(|failure| std::io::Error::other(failure.into_message().0))?;
            let values: Vec<String> =
                self.campaign.values(row.run).map(|(axis, value)| format!("{}={value}", axis.name)).collect();
            let cause = || format!("{}; repeat: {}", row.message, self.campaign.repeat(row.run));
            let verdict = match row.status {
                status if self.campaign.accept.contains(&status) => Verdict::Passed,
                RunStatus::Failed => Verdict::Failed(cause()),
                _ => Verdict::Missing(cause()),
            };
            file.write_all(
                junit::case(&format!("run {}: {}", row.run, values.join(", ")), &class, &verdict).as_bytes(),
            )?;
        }
        file.write_all(junit::END.as_bytes())?;
        file.into_inner()?.finish()
    }
}

impl Summary {
    /// Counts a run.
    fn add(&mut self, campaign: &Campaign, row: &Row) {
        *self.ends.entry(row.status.name()).or_default() += 1;
        if campaign.accept.contains(&row.status) {
            return;
        }
        self.unaccepted += 1;
        if self.failing.len() < NAMED_MAX {
            let Row { run, status, message, .. } = row.clone();
            self.failing.push(FailingRun { run, status, message, repeat: campaign.repeat(run) });
        }
    }

    fn count(&self, status: RunStatus) -> usize {
        self.ends.get(status.name()).copied().unwrap_or_default()
    }
}

/// Columns of a campaign's table.
struct Columns {
    axes: Vec<(String, Kind, String)>,
    figures: Vec<(String, String)>,
}

impl Columns {
    fn new(campaign: &Campaign) -> Self {
        let axis = |axis: &SweepAxis| (column_of(&axis.name), axis.kind(), format!("value of {}", axis.name));
        let figure = |key: &str| (column_of(key), format!("{key} of the run's JSON"));
        let figures = campaign.figures.iter().map(|key| figure(&key.text)).collect();
        Columns { axes: campaign.axes.iter().map(axis).collect(), figures }
    }

    fn columns(&self) -> Vec<TableColumn<'_>> {
        let [run, status, message] = RUN_COLUMNS;
        let mut columns = vec![
            TableColumn::integer(run, "number of the run, from 1"),
            TableColumn::text(status, "passed, failed, stopped, refused or panicked"),
            TableColumn::text(message, "message of the command; nothing if the run passed"),
        ];
        columns.extend(self.axes.iter().map(|(name, kind, about)| TableColumn { name, unit: "", kind: *kind, about }));
        columns.extend(self.figures.iter().map(|(name, about)| TableColumn::number(name, "", about)));
        columns
    }

    /// Passes the cells of a row.
    fn with_cells<T>(&self, campaign: &Campaign, row: &Row, take: &mut dyn FnMut(&[Cell<'_>]) -> T) -> T {
        let values: Vec<String> = campaign.values(row.run).map(|(_, value)| plain_text(value)).collect();
        let message = Some(row.message.as_str()).filter(|message| !message.is_empty());
        let mut cells = vec![Cell::Integer(row.run as i64), Cell::Text(row.status.name()), Cell::from(message)];
        cells.extend(self.axes.iter().zip(&values).map(|((_, kind, _), value)| match kind {
            Kind::Integer => Cell::from(value.parse::<i64>().ok()),
            Kind::Number => Cell::from(value.parse::<f64>().ok()),
            Kind::Flag => Cell::from(value.parse::<bool>().ok()),
            Kind::Text => Cell::Text(value),
        }));
        cells.extend(row.figures.iter().map(|bits| Cell::from(bits.map(f64::from_bits))));
        take(&cells)
    }
}

/// Rejects figures whose columns in the table would have the same name.
///
/// # Errors
/// Names the second key, with its place.
pub fn refuse_same_columns(campaign: &Campaign) -> Result<(), Failure> {
    let axes = campaign.axes.iter().map(|axis| (axis.name.as_str(), axis.offset));
    let figures = campaign.figures.iter().map(|figure| (figure.text.as_str(), figure.offset));
    let mut known: Vec<String> = RUN_COLUMNS.map(str::to_owned).into();
    for (name, offset) in axes.chain(figures) {
        let column = column_of(name);
        if known.contains(&column) {
            let message = format!("the table would have two columns `{column}`: rename or remove `{name}`");
            return Err(campaign.complaint(offset, message).into());
        }
        known.push(column);
    }
    Ok(())
}

/// Name of a key's column: Parquet's readers take names with dots apart.
fn column_of(key: &str) -> String {
    key.replace(['.', '-'], "_")
}

/// A literal without the quotes of a text.
fn plain_text(literal: String) -> String {
    let table = format!("value = {literal}");
    let text = DeTable::parse(&table)
        .ok()
        .and_then(|table| Some(table.get_ref().get("value")?.get_ref().as_str()?.to_owned()));
    text.unwrap_or(literal)
}
