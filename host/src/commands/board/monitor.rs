//! `arcfeed board URL monitor`: reports of a board, one line for each change.

use std::sync::atomic::Ordering;

use arcfeed_firmware::output::telemetry::reason::Cause;
use arcfeed_link::message::codes::AlarmCode;
use arcfeed_link::message::{Message, table};
use arcfeed_units::Micros;
use serde::Serialize;

use super::super::outcome::{Failure, on_interrupt, say};
use super::connection::BoardConnection;
use crate::board::words;

/// Unknown value in a report.
const NONE: u32 = u32::MAX;

/// Print state, override and reason as they change, until Ctrl-C
#[derive(Debug, clap::Args)]
pub struct Monitor {
    /// Stop after this many seconds
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u32).range(1..))]
    seconds: Option<u32>,
    /// Every report, not only changes, as one JSON object each (docs/json.md)
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Shown {
    at_s: f64,
    state: &'static str,
    cause: String,
    alarm: bool,
    override_percent: u8,
    executed: u32,
    in_work: Option<u32>,
    ipt_center_mm: Option<f64>,
    feed_mm_per_min: Option<f64>,
}

impl Monitor {
    /// Prints reports.
    ///
    /// # Errors
    /// The link is lost.
    pub fn run(&self, connection: &mut BoardConnection) -> Result<(), Failure> {
        let interrupted = on_interrupt();
        let started = connection.line().now();
        let until = self.seconds.map(|seconds| started.after(Micros::from_ms(u64::from(seconds) * 1_000)));
        let mut last = None;
        while !interrupted.load(Ordering::Relaxed) && until.is_none_or(|until| connection.line().now() < until) {
            let reports = connection.take_messages()?.into_iter().filter_map(|message| match message {
                Message::Report(report) => Some(report),
                _ => None,
            });
            for report in reports {
                let seen = (report.state, report.cause, report.override_percent, report.in_work);
                if self.json {
                    let object =
                        serde_json::to_string(&shown(&report)).map_err(|error| Failure::Input(error.to_string()))?;
                    say(format_args!("{object}"));
                } else if last != Some(seen) {
                    say(format_args!("{}", line(&shown(&report))));
                }
                last = Some(seen);
            }
        }
        Ok(())
    }
}

fn shown(report: &table::Report) -> Shown {
    let cause = Cause::of_code(report.cause).map_or_else(|| report.cause.to_string(), |cause| format!("{cause:?}"));
    let known = |value: u32, scale: f64| (value != NONE).then(|| f64::from(value) * scale);
    Shown {
        at_s: report.at as f64 / 1e6,
        state: words::state(report.state),
        cause,
        alarm: report.alarm != AlarmCode::None,
        override_percent: report.override_percent,
        executed: report.executed,
        in_work: report.in_work,
        ipt_center_mm: known(report.ipt_center, 1e-6),
        feed_mm_per_min: known(report.feed, 1e-3),
    }
}

fn line(shown: &Shown) -> String {
    let Shown { at_s, state, cause, override_percent, executed, .. } = shown;
    let feed = shown.feed_mm_per_min.map_or(String::new(), |feed| format!("  {feed:.0} mm/min"));
    let alarm = if shown.alarm { "  ALARM" } else { "" };
    format!("{at_s:>10.3} s  {state:<9} {override_percent:>3} %  {cause:<18} {executed} done{feed}{alarm}")
}
