//! One run: its command, executed in this process, with its JSON object in place of a printed report.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use clap::{Parser, Subcommand};
use serde_json::Value;

use super::super::outcome::Failure;
use super::super::simulate::Simulate;
use super::super::stream::Stream;
use super::row::{Row, RunStatus};
use super::sweep_file::{Campaign, Placed, RunKind};
use crate::console::printed_by;
use crate::file_error::FileError;
use crate::key_values::KeyValue;

/// Exit code of a program or job at fault.
const INPUT: u8 = 1;

/// Command line of a run.
#[derive(Debug, Parser)]
struct RunLine {
    #[command(subcommand)]
    command: RunCommand,
}

#[derive(Debug, Subcommand)]
enum RunCommand {
    Simulate(Box<Simulate>),
    Stream(Box<Stream>),
}

impl Campaign {
    /// Whether a name is a value in the URLs of port and board; otherwise it is a key of the job.
    pub fn is_placeholder(&self, name: &str) -> bool {
        let placeholder = format!("{{{name}}}");
        self.urls().any(|url| url.text.contains(&placeholder))
    }

    /// URLs of the port and the board.
    pub fn urls(&self) -> impl Iterator<Item = &Placed> {
        let urls = match &self.kind {
            RunKind::Simulate => [None, None],
            RunKind::Stream { port, board } => [Some(port), board.as_ref()],
        };
        urls.into_iter().flatten()
    }

    /// Those of these values that belong to keys of the job.
    pub fn key_values(&self, values: &[(&str, String)]) -> Vec<KeyValue> {
        let of_job = values.iter().filter(|(name, _)| !self.is_placeholder(name));
        of_job.map(|(name, value)| KeyValue::new((*name).to_owned(), value.clone())).collect()
    }

    /// URL with these values in place of its placeholders.
    pub fn filled(&self, url: &Placed, values: &[(&str, String)]) -> String {
        let text = |value: &str| value.trim_matches(['"', '\'']).to_owned();
        values.iter().fold(url.text.clone(), |url, (name, value)| url.replace(&format!("{{{name}}}"), &text(value)))
    }

    /// Values of the run with this number, with the names of their axes.
    pub fn named_values(&self, run: u64) -> Vec<(&str, String)> {
        self.values(run).map(|(axis, literal)| (axis.name.as_str(), literal)).collect()
    }

    /// Arguments of the command that executes the run.
    pub fn arguments(&self, run: u64) -> Vec<String> {
        let values = self.named_values(run);
        let mut arguments = vec![String::new(), self.job.display().to_string()];
        arguments[0] = match &self.kind {
            RunKind::Simulate => "simulate".into(),
            RunKind::Stream { .. } => "stream".into(),
        };
        for (option, url) in ["--port", "--board"].iter().zip(self.urls()) {
            arguments.extend([(*option).to_owned(), self.filled(url, &values)]);
        }
        for value in self.key_values(&values) {
            arguments.extend(["--set".to_owned(), value.to_string()]);
        }
        for assertion in &self.assertions {
            arguments.extend(["--assert".to_owned(), assertion.text.clone()]);
        }
        arguments
    }

    /// Command line that repeats the run, for a shell.
    pub fn repeat(&self, run: u64) -> String {
        let arguments: Vec<String> = self.arguments(run).iter().map(|argument| quoted(argument)).collect();
        format!("arcfeed {}", arguments.join(" "))
    }

    /// Executes the run as its command does, with printed output.
    ///
    /// # Errors
    /// See the command.
    pub fn repeat_run(&self, run: u64, json: bool) -> Result<(), Failure> {
        let arguments = std::iter::once("arcfeed".to_owned()).chain(self.arguments(run));
        let arguments = arguments.chain(json.then(|| "--json".to_owned()));
        match RunLine::try_parse_from(arguments).map_err(|error| Failure::Usage(error.to_string()))?.command {
            RunCommand::Simulate(command) => command.run(),
            RunCommand::Stream(command) => command.run(),
        }
    }

    /// Executes the run and returns its row; `None` if the operator has stopped it.
    ///
    /// # Errors
    /// A figure of the campaign is no key of a run.
    pub fn row(&self, run: u64) -> Result<Option<Row>, FileError> {
        let part = || catch_unwind(AssertUnwindSafe(|| self.repeat_run(run, true)));
        let (result, out) = printed_by(part);
        let report: Option<Value> = out.lines().last().and_then(|line| serde_json::from_str(line).ok());
        let (status, message) = match result {
            Err(panic) => (RunStatus::Panicked, panic_message(&*panic)),
            Ok(Ok(())) => (RunStatus::Passed, String::new()),
            Ok(Err(Failure::Stopped(_))) => return Ok(None),
            Ok(Err(failure)) => {
                let (message, code) = failure.into_message();
                let status = match (code, &report) {
                    (INPUT, Some(_)) => RunStatus::Failed,
                    (3 | 4, _) => RunStatus::Stopped,
                    _ => RunStatus::Refused,
                };
                (status, message)
            }
        };
        let figures = self.figures.iter().map(|figure| {
            let value = report.as_ref().map_or(Ok(None), |report| figure_in(report, &figure.text));
            value.map_err(|message| self.complaint(figure.offset, message))
        });
        let figures = figures.map(|value| Ok(value?.map(f64::to_bits))).collect::<Result<_, FileError>>()?;
        Ok(Some(Row { run, status, message: message.replace(['\n', '\r'], " "), figures }))
    }
}

/// Figure at a dotted key of a report; `None` where a part of the key does not apply to this run.
fn figure_in(report: &Value, key: &str) -> Result<Option<f64>, String> {
    let mut found = report;
    for part in key.split('.') {
        found = match found {
            Value::Object(fields) => fields.get(part).ok_or_else(|| {
                let known: Vec<&str> = fields.keys().map(String::as_str).collect();
                format!("a run has no figure `{key}`: there is no `{part}`, only {}", known.join(", "))
            })?,
            Value::Array(items) => {
                let index = part.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
                let index =
                    index.ok_or_else(|| format!("`{part}` of `{key}` must be the number of an item, from 1"))?;
                match items.get(index) {
                    Some(item) => item,
                    None => return Ok(None),
                }
            }
            Value::Null => return Ok(None),
            _ => return Err(format!("`{key}` goes on below `{part}`, where a run has a single value")),
        };
    }
    match found {
        Value::Number(number) => Ok(number.as_f64()),
        Value::Bool(flag) => Ok(Some(f64::from(u8::from(*flag)))),
        Value::Array(items) => Ok(Some(items.len() as f64)),
        Value::Null => Ok(None),
        _ => Err(format!("`{key}` is no number of a run")),
    }
}

fn panic_message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    format!("a defect of arcfeed: {}", text.unwrap_or_else(|| "no message".into()))
}

/// An argument as a shell reads it back.
pub fn quoted(argument: &str) -> String {
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "-_./:=,+%@".contains(letter);
    if !argument.is_empty() && argument.chars().all(is_plain) {
        return argument.to_owned();
    }
    format!("'{}'", argument.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_found_by_their_keys() {
        let report = serde_json::json!({ "a": { "b": [1.5, null], "c": "text" }, "d": null, "e": true });
        let figure = |key: &str| figure_in(&report, key);
        assert_eq!(
            [figure("a.b.1"), figure("a.b.2"), figure("a.b.3"), figure("d.x")],
            [Ok(Some(1.5)), Ok(None), Ok(None), Ok(None)]
        );
        assert_eq!([figure("a.b"), figure("e")], [Ok(Some(2.0)), Ok(Some(1.0))]);
        for (key, words) in
            [("a.x", "there is no `x`, only b, c"), ("a.c", "no number"), ("e.x", "single value"), ("a.b.0", "from 1")]
        {
            assert!(figure(key).is_err_and(|error| error.contains(words)), "{key}");
        }
    }

    #[test]
    fn arguments_are_quoted_where_a_shell_would_take_them_apart() {
        let quoted = ["a=1", "chip<=1", "x='in'", ""].map(quoted);
        assert_eq!(quoted, ["a=1", "'chip<=1'", "'x='\\''in'\\'''", "''"]);
    }
}
