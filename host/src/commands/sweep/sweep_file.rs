//! `SWEEP.toml`: a campaign of runs, read with the place of every value.
//!
//! Runs are numbered from 1. Each combination of the values in `[grid]` and of the places in the lists of `[list]` is run
//! `random.runs` times. Draws change fastest, then places in lists, then the keys of the grid, the last one first.

use std::borrow::Cow;
use std::ops::Range;
use std::path::{Path, PathBuf};

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::axis::{Choice, Literal, SweepAxis, Values};
use super::row::RunStatus;
use crate::file_error::FileError;
use crate::place::place;
use crate::toml_values::{self, with_key};

/// Most runs of a campaign.
const RUNS_MAX: u64 = 1_000_000_000;

/// Keys of `[random]` that are no axes.
const RANDOM_SETTINGS: [&str; 2] = ["runs", "seed"];

/// Error in the sweep file: byte offset of its place, and message.
pub type Complaint = (usize, String);

/// Text with its place in the file.
#[derive(Clone, Debug)]
pub struct Placed {
    /// The text.
    pub text: String,
    /// Byte offset in the sweep file.
    pub offset: usize,
}

/// Command by which the runs of a campaign are executed.
#[derive(Clone, Debug)]
pub enum RunKind {
    /// `arcfeed simulate`.
    Simulate,
    /// `arcfeed stream` to the simulated control.
    Stream {
        /// URL of the port, with `{name}` in place of values.
        port: Placed,
        /// URL of the board, with `{name}` in place of values; `None` without a board.
        board: Option<Placed>,
    },
}

/// Campaign as its sweep file describes it: many runs of a job with different values.
#[derive(Clone, Debug)]
pub struct Campaign {
    /// Path of the sweep file.
    pub path: PathBuf,
    /// Text of the sweep file.
    pub text: String,
    /// Path of the job file of all runs.
    pub job: PathBuf,
    /// Byte offset of that path in the sweep file.
    pub job_offset: usize,
    /// Command of every run.
    pub kind: RunKind,
    /// Assertions on every run.
    pub assertions: Vec<Placed>,
    /// Results of a run to be kept, as keys of its JSON output.
    pub figures: Vec<Placed>,
    /// Outcomes that are accepted.
    pub accept: Vec<RunStatus>,
    /// Axes: the names whose values differ from run to run.
    pub axes: Vec<SweepAxis>,
    /// Number of runs.
    pub runs: u64,
}

/// Known keys at the top of the file.
#[derive(Default)]
struct Top {
    job: Option<Placed>,
    command: Option<Placed>,
    port: Option<Placed>,
    board: Option<Placed>,
    assertions: Vec<Placed>,
    figures: Vec<Placed>,
    accept: Vec<Placed>,
    axes: Vec<SweepAxis>,
    list_len: Option<u64>,
    draws: Option<u64>,
}

impl Campaign {
    /// Reads and checks a file, without the files that it names.
    ///
    /// # Errors
    /// See [`FileError`].
    pub fn load(path: &Path) -> Result<Self, FileError> {
        let text = std::fs::read_to_string(path).map_err(|source| FileError::Read { path: path.into(), source })?;
        parse(path, &text).map_err(|complaint| at(path, &text, complaint))
    }

    /// Error at a byte offset of the sweep file, with this message.
    pub fn complaint(&self, offset: usize, message: String) -> FileError {
        at(&self.path, &self.text, (offset, message))
    }

    /// Values of the run with this number, in the order of the axes.
    pub fn values(&self, run: u64) -> impl Iterator<Item = (&SweepAxis, String)> {
        self.axes.iter().map(move |axis| (axis, axis.literal(run)))
    }
}

fn at(path: &Path, text: &str, (offset, message): Complaint) -> FileError {
    let [line, column] = place(text, offset);
    FileError::Content { path: path.into(), line, column, message: with_key(text, offset, &message) }
}

fn parse(path: &Path, text: &str) -> Result<Campaign, Complaint> {
    let root = toml_values::parse(text)?;
    let mut top = Top::default();
    for (key, value) in root.get_ref() {
        top.read(text, key, value)?;
    }
    let needed = |given: Option<Placed>, what: &str| given.ok_or_else(|| (0, format!("`{what}` is missing")));
    let job = needed(top.job.take(), "job")?;
    let kind = match (top.command.take(), top.port.take(), top.board.take()) {
        (Some(command), port, board) if command.text == "stream" => {
            RunKind::Stream { port: needed(port, "port")?, board }
        }
        (Some(command), ..) if command.text != "simulate" => {
            return Err((command.offset, "write \"simulate\" or \"stream\"".into()));
        }
        (_, Some(port), _) | (_, None, Some(port)) => {
            return Err((port.offset, "only runs of `command = \"stream\"` have a port and a board".into()));
        }
        _ => RunKind::Simulate,
    };
    let accept = top.accept.iter().map(|placed| {
        RunStatus::named(&placed.text)
            .ok_or_else(|| (placed.offset, format!("no such end; write {}", RunStatus::names())))
    });
    let accept = accept.collect::<Result<Vec<_>, _>>()?;
    let runs = top.count_runs()?;
    Ok(Campaign {
        path: path.to_owned(),
        text: text.to_owned(),
        job: path.parent().unwrap_or(Path::new("")).join(&job.text),
        job_offset: job.offset,
        kind,
        assertions: top.assertions,
        figures: top.figures,
        accept: if accept.is_empty() { vec![RunStatus::Passed] } else { accept },
        axes: top.axes,
        runs,
    })
}

impl Top {
    fn read(&mut self, text: &str, key: &Spanned<Cow<'_, str>>, value: &Spanned<DeValue<'_>>) -> Result<(), Complaint> {
        match key.get_ref().as_ref() {
            "job" => self.job = Some(words(value)?),
            "command" => self.command = Some(words(value)?),
            "port" => self.port = Some(words(value)?),
            "board" => self.board = Some(words(value)?),
            "assert" => self.assertions = list_of_words(value)?,
            "figures" => self.figures = list_of_words(value)?,
            "accept" => self.accept = list_of_words(value)?,
            "grid" => self.axes.extend(axes(text, table(value)?, Choice::Grid { every: 1 })?),
            "list" => self.axes.extend(axes(text, table(value)?, Choice::List { every: 1 })?),
            "random" => {
                let table = table(value)?;
                let seed = table.get("seed").map_or(Ok(0), |seed| count(seed, 0.0))?;
                let missing = || (value.span().start, "`runs`, the number of draws, is missing".to_owned());
                self.draws = Some(count(table.get("runs").ok_or_else(missing)?, 1.0)?);
                self.axes.extend(axes(text, table, Choice::Random { seed })?);
            }
            _ => {
                let known = "job, command, port, board, assert, figures, accept, grid, list, random";
                return Err((key.span().start, format!("no such key; write one of {known}")));
            }
        }
        Ok(())
    }

    /// Number of runs; gives every axis the number of runs after which it changes.
    fn count_runs(&mut self) -> Result<u64, Complaint> {
        self.axes.sort_by_key(|axis| axis.offset);
        let mut runs = self.draws.unwrap_or(1);
        let too_many = |offset: usize| (offset, format!("more than {RUNS_MAX} runs: divide the campaign"));
        for axis in &mut self.axes {
            if let Choice::List { every } = &mut axis.choice {
                let len = axis.values.len();
                if self.list_len.is_some_and(|other| other != len) {
                    return Err((
                        axis.offset,
                        format!("all lists of [list] have the same length; found {len} values here"),
                    ));
                }
                (self.list_len, *every) = (Some(len), runs);
            }
        }
        runs = runs.saturating_mul(self.list_len.unwrap_or(1));
        for axis in self.axes.iter_mut().rev() {
            if let Choice::Grid { every } = &mut axis.choice {
                *every = runs;
                runs = runs
                    .checked_mul(axis.values.len())
                    .filter(|runs| *runs <= RUNS_MAX)
                    .ok_or_else(|| too_many(axis.offset))?;
            }
        }
        let mut names: Vec<(&str, usize)> = self.axes.iter().map(|axis| (axis.name.as_str(), axis.offset)).collect();
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return Err((pair[1].1.max(pair[0].1), "this key has values already".into()));
        }
        if runs > RUNS_MAX { Err(too_many(0)) } else { Ok(runs) }
    }
}

/// The axes of a table: a list or a range is one, a table has more of them below its name.
fn axes(text: &str, table: &DeTable<'_>, choice: Choice) -> Result<Vec<SweepAxis>, Complaint> {
    let (mut found, mut open) = (Vec::new(), vec![(String::new(), table)]);
    while let Some((prefix, table)) = open.pop() {
        for (key, value) in table {
            let name = format!("{prefix}{}", key.get_ref());
            let is_setting = prefix.is_empty() && RANDOM_SETTINGS.contains(&name.as_str());
            if is_setting && matches!(choice, Choice::Random { .. }) {
                continue;
            }
            let values = match value.get_ref() {
                DeValue::Array(items) if !items.is_empty() => {
                    let items = items.iter().map(|item| literal(text, item.span()));
                    Values::Listed(items.collect::<Result<_, _>>()?)
                }
                DeValue::Table(inner) => match range(inner, choice) {
                    Some(values) => values.map_err(|message| (value.span().start, message.into()))?,
                    None => {
                        open.push((format!("{name}."), inner));
                        continue;
                    }
                },
                _ => return Err((value.span().start, "write a list of values, or { from = 1, to = 9 }".into())),
            };
            found.push(SweepAxis { name, offset: key.span().start, values, choice });
        }
    }
    Ok(found)
}

/// Values of a table with two numbers `from` and `to`; `None` for any other.
fn range(table: &DeTable<'_>, choice: Choice) -> Option<Result<Values, &'static str>> {
    let end = |name: &str| number(table.get(name)?.get_ref());
    let ([from, to], steps) = ([end("from")?, end("to")?], table.get("steps"));
    let is_drawn = matches!(choice, Choice::Random { .. });
    let count = steps.and_then(|steps| number(steps.get_ref())).filter(|count| *count >= 2.0 && count.fract() == 0.0);
    Some(match (steps, count) {
        _ if from >= to => Err("`from` must be below `to`"),
        _ if table.iter().any(|(key, _)| !["from", "to", "steps"].contains(&key.get_ref().as_ref())) => {
            Err("a range has `from`, `to` and `steps` only")
        }
        (Some(_), _) if is_drawn => Err("values that are drawn have no `steps`"),
        (Some(_), None) => Err("`steps` is the number of values, a whole number of 2 or more"),
        (Some(_), Some(count)) => Ok(Values::Real { from, to, steps: count as u64 }),
        (None, _) if is_whole(table, "from") && is_whole(table, "to") => {
            Ok(Values::Whole { from: from as i64, to: to as i64 })
        }
        (None, _) if is_drawn => Ok(Values::Real { from, to, steps: 0 }),
        (None, _) => Err("a range of numbers that are not whole needs `steps`, the number of its values"),
    })
}

fn is_whole(table: &DeTable<'_>, name: &str) -> bool {
    table.get(name).is_some_and(|value| matches!(value.get_ref(), DeValue::Integer(_)))
}

fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) => {
            i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|number| number as f64)
        }
        _ => None,
    }
}

/// A value as it is written.
fn literal(text: &str, span: Range<usize>) -> Result<Literal, Complaint> {
    let offset = span.start;
    match text.get(span) {
        Some(text) if !text.contains(['\n', '\r']) => Ok(Literal { text: text.to_owned(), offset }),
        _ => Err((offset, "write each value on one line".into())),
    }
}

fn table<'t, 'd>(value: &'t Spanned<DeValue<'d>>) -> Result<&'t DeTable<'d>, Complaint> {
    match value.get_ref() {
        DeValue::Table(table) => Ok(table),
        _ => Err((value.span().start, "this is a table".into())),
    }
}

fn words(value: &Spanned<DeValue<'_>>) -> Result<Placed, Complaint> {
    match value.get_ref() {
        DeValue::String(text) => Ok(Placed { text: text.to_string(), offset: value.span().start }),
        _ => Err((value.span().start, "write a text in quotes".into())),
    }
}

fn list_of_words(value: &Spanned<DeValue<'_>>) -> Result<Vec<Placed>, Complaint> {
    match value.get_ref() {
        DeValue::Array(items) => items.iter().map(words).collect(),
        _ => Err((value.span().start, "write a list of texts in quotes".into())),
    }
}

fn count(value: &Spanned<DeValue<'_>>, least: f64) -> Result<u64, Complaint> {
    let whole = number(value.get_ref()).filter(|number| number.fract() == 0.0 && *number >= least);
    whole
        .map(|number| number as u64)
        .ok_or_else(|| (value.span().start, format!("write a whole number of {least} or more")))
}
