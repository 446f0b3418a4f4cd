//! Assertions on a simulated run (`--assert`): `FIGURE<=LIMIT`.
//!
//! A figure (a result of the run, such as the largest chip load) that the run does not produce is an error, never a
//! pass.

use std::fmt;
use std::str::FromStr;

use arcfeed_milling::cutting::meter::MoveChips;
use arcfeed_units::{LengthUnit, Micros};

use super::move_log::MoveLog;
use super::spindle_load::SpindleLoad;
use crate::report::figures::RunReport;
use crate::report::material::short;
use crate::report::spindle::BlockValue;
use crate::unit_value::{FORCE, POWER, TIME, TORQUE, with_unit};

/// Form of an assertion, for messages.
const FORM: &str =
    "write for example chip<=1.05, power<=11kW, torque<=40Nm, force<=800N, feed<=5000mm/min (or in/min) or time<=120s";

/// Units of the other figures.
const CHIP: &[(&str, f64)] = &[("", 1.0)];
const FEED: &[(&str, f64)] = &[("mm/min", 1.0), ("in/min", LengthUnit::Inch.mm())];

/// Assertion on a run (`--assert FIGURE<=LIMIT`): a result of the run must not exceed a limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Assertion {
    text: String,
    figure: AssertedFigure,
    /// Limit in mm/min, W, N m, N, s, or as a ratio.
    limit: f64,
}

/// Figure that an assertion limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum AssertedFigure {
    /// Chip load over its target, every sample in the cut.
    Chip,
    Power,
    Torque,
    Force,
    Feed,
    Time,
}

/// Data of a run on which assertions are judged.
pub struct Evidence<'a> {
    /// Results of the run.
    pub report: &'a RunReport,
    /// Moves of the run, with feed and chip load over time.
    pub log: &'a MoveLog,
    /// Measured chips of each move.
    pub chips: &'a [MoveChips],
    /// Power and torque of the spindle; `None` if the job has neither edges, for measured forces, nor a material, for an estimate.
    pub spindle: Option<&'a SpindleLoad>,
    /// Gives the line of the program for the number of an executed block; `None` if it has none.
    pub line_of: &'a dyn Fn(u32) -> Option<usize>,
    /// Name of the program for messages.
    pub program: String,
}

/// Outcome of an assertion, with the measured value.
#[derive(Clone, Debug, PartialEq)]
pub struct AssertionOutcome {
    /// The assertion as it was given.
    pub text: String,
    /// Whether the assertion holds.
    pub verdict: Verdict,
    /// Largest measured value with its unit, if the assertion holds.
    pub largest: Option<String>,
}

/// Verdict on an assertion: passed, failed, or not to be judged.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// The limit holds.
    Passed,
    /// The limit is exceeded; describes the first block above it.
    Failed(String),
    /// The run has no such result; says why, and what to do.
    Missing(String),
}

impl FromStr for Assertion {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = |what: &str| format!("{what}; {FORM}");
        let (name, limit) = text.split_once("<=").ok_or_else(|| wrong("an assertion has the form FIGURE<=LIMIT"))?;
        let figure = AssertedFigure::ALL.into_iter().find(|figure| figure.name() == name.trim());
        let figure = figure.ok_or_else(|| wrong(&format!("`{}` is no figure", name.trim())))?;
        let limit = with_unit(limit, figure.units()).filter(|limit| *limit >= 0.0);
        let limit = limit.ok_or_else(|| wrong(&format!("the limit of {} needs {}", figure.name(), figure.needs())))?;
        Ok(Assertion { text: text.trim().to_owned(), figure, limit })
    }
}

impl Assertion {
    /// Outcome if there is no run to judge, for this cause.
    pub fn without_run(&self, cause: &str) -> AssertionOutcome {
        let verdict = Verdict::Missing(format!("the run did not end: {cause}"));
        AssertionOutcome { text: self.text.clone(), verdict, largest: None }
    }

    /// Judges the assertion on a run; `has_ended` is false if the run stopped early, so that nothing can pass.
    pub fn after(&self, evidence: &Evidence<'_>, has_ended: bool) -> AssertionOutcome {
        match evidence.report.alarms.first() {
            Some(alarm) => self.without_run(&alarm.to_string()),
            None if !has_ended => self.without_run("see the message of the command"),
            None => self.judge(evidence),
        }
    }

    /// Judges the assertion on what ran, to its end or not: a limit that is broken before the end is broken.
    #[cfg(not(target_family = "wasm"))]
    pub fn so_far(&self, evidence: &Evidence<'_>, has_ended: bool) -> AssertionOutcome {
        let outcome = self.judge(evidence);
        let is_open = !has_ended && !matches!(outcome.verdict, Verdict::Failed(_));
        if is_open { self.without_run("see the message of the command") } else { outcome }
    }

    /// Name of the figure, if it comes from the material that the simulated tool removes.
    #[cfg(not(target_family = "wasm"))]
    pub fn of_material(&self) -> Option<&'static str> {
        let is_load = matches!(self.figure, AssertedFigure::Power | AssertedFigure::Torque | AssertedFigure::Force);
        is_load.then(|| self.figure.name())
    }

    /// Judges the assertion on the data of a run that has ended.
    pub fn judge(&self, evidence: &Evidence<'_>) -> AssertionOutcome {
        let (verdict, largest) = match self.figure.values(self.limit, evidence) {
            Err(missing) => (Verdict::Missing(missing), None),
            Ok(blocks) => match blocks.iter().find(|block| block.value.is_nan() || block.value > self.limit) {
                None => {
                    let largest = blocks.iter().map(|block| block.value).fold(0.0, f64::max);
                    (Verdict::Passed, Some(self.figure.written(largest)))
                }
                Some(block) => (Verdict::Failed(self.failure(block, evidence)), None),
            },
        };
        AssertionOutcome { text: self.text.clone(), verdict, largest }
    }

    /// Description of the first block above the limit: `program:line: N, value, limit`.
    fn failure(&self, block: &BlockValue, evidence: &Evidence<'_>) -> String {
        let line = (evidence.line_of)(block.block).map_or(String::new(), |line| format!(":{line}"));
        let [value, limit] = [block.value, self.limit].map(|value| self.figure.written(value));
        format!("{}{line}: {}: {} is {value}, the limit {limit}", evidence.program, block.name(), self.figure.name())
    }
}

impl AssertedFigure {
    const ALL: [Self; 6] = [
        AssertedFigure::Chip,
        AssertedFigure::Power,
        AssertedFigure::Torque,
        AssertedFigure::Force,
        AssertedFigure::Feed,
        AssertedFigure::Time,
    ];

    const fn name(self) -> &'static str {
        match self {
            AssertedFigure::Chip => "chip",
            AssertedFigure::Power => "power",
            AssertedFigure::Torque => "torque",
            AssertedFigure::Force => "force",
            AssertedFigure::Feed => "feed",
            AssertedFigure::Time => "time",
        }
    }

    const fn units(self) -> &'static [(&'static str, f64)] {
        match self {
            AssertedFigure::Chip => CHIP,
            AssertedFigure::Power => POWER,
            AssertedFigure::Torque => TORQUE,
            AssertedFigure::Force => FORCE,
            AssertedFigure::Feed => FEED,
            AssertedFigure::Time => TIME,
        }
    }

    /// Value in the first of its units.
    fn written(self, value: f64) -> String {
        let [(unit, factor), ..] = self.units() else { return String::new() };
        let space = if unit.is_empty() { "" } else { " " };
        format!("{}{space}{unit}", short(value / factor))
    }

    const fn needs(self) -> &'static str {
        match self {
            AssertedFigure::Chip => "a number: the chip over its target",
            AssertedFigure::Power => "a power in kW or W",
            AssertedFigure::Torque => "a torque in Nm",
            AssertedFigure::Force => "a force in N or kN",
            AssertedFigure::Feed => "a feed in mm/min or in/min",
            AssertedFigure::Time => "a time in s or min",
        }
    }

    /// Values block by block, in order of execution.
    ///
    /// # Errors
    /// Says what the job needs to have this figure.
    fn values(self, limit: f64, evidence: &Evidence<'_>) -> Result<Vec<BlockValue>, String> {
        let (values, missing) = match self {
            AssertedFigure::Chip => {
                (chips(evidence), "no chip was measured: add a [[cut]] rule that a move of the program matches")
            }
            AssertedFigure::Power => (
                evidence.spindle.map_or(Vec::new(), |load| load.power_w.clone()),
                "no power was computed: add [workpiece] and [cutting], or [workpiece] with `material` for an estimate",
            ),
            AssertedFigure::Torque => (
                evidence.spindle.and_then(|load| load.torque_n_m.clone()).unwrap_or_default(),
                "no torque was computed: add [workpiece] and [cutting]",
            ),
            AssertedFigure::Force => (forces(evidence), "no force was computed: add [workpiece] and [cutting]"),
            AssertedFigure::Feed => (feeds(evidence), "the program has no move at a feed"),
            AssertedFigure::Time => (time(limit, evidence), "the program has no move"),
        };
        if values.is_empty() { Err(format!("{}: {missing}", self.name())) } else { Ok(values) }
    }
}

fn chips(evidence: &Evidence<'_>) -> Vec<BlockValue> {
    let measured = evidence.chips.iter().filter(|chips| chips.any_contact.samples > 0);
    let value =
        |chips: &MoveChips| BlockValue { block: chips.block, n: chips.sequence, value: chips.any_contact.max_ratio };
    measured.map(value).collect()
}

fn forces(evidence: &Evidence<'_>) -> Vec<BlockValue> {
    let blocks = evidence.report.loads.iter().flat_map(|loads| &loads.blocks);
    blocks.map(|block| BlockValue { block: block.block, n: block.n, value: block.load.force_max_n }).collect()
}

fn feeds(evidence: &Evidence<'_>) -> Vec<BlockValue> {
    let moves = evidence.log.moves.iter().filter(|log| log.feed_max_mm_per_min > 0.0);
    let value = |log: &super::move_log::LoggedMove| BlockValue {
        block: log.block,
        n: log.sequence,
        value: log.feed_max_mm_per_min,
    };
    moves.map(value).collect()
}

/// Time of the run, at the block in execution when the limit was reached.
fn time(limit_s: f64, evidence: &Evidence<'_>) -> Vec<BlockValue> {
    let (Some(cycle_s), Some(first)) = (evidence.report.cycle_time_s, evidence.log.moves.first()) else {
        return Vec::new();
    };
    let until = |began: Micros| began.since(first.began).to_s() <= limit_s;
    let last = evidence.log.moves.iter().take_while(|log| until(log.began)).last().unwrap_or(first);
    vec![BlockValue { block: last.block, n: last.sequence, value: cycle_s }]
}

impl fmt::Display for AssertionOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.verdict {
            Verdict::Passed => {
                write!(f, "--assert {}: holds, at most {}", self.text, self.largest.as_deref().unwrap_or_default())
            }
            Verdict::Failed(message) | Verdict::Missing(message) => write!(f, "--assert {}: {message}", self.text),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limit(text: &str) -> f64 {
        text.parse::<Assertion>().unwrap_or_else(|error| panic!("{text}: {error}")).limit
    }

    #[test]
    fn limits_are_read_with_their_units() {
        assert_eq!([limit("chip<=1.05"), limit("power <= 11 kW"), limit("force<=800N")], [1.05, 11e3, 800.0]);
        assert_eq!([limit("torque<=40Nm"), limit("time<=2min"), limit("feed<=100in/min")], [40.0, 120.0, 2540.0]);
    }

    #[test]
    fn an_assertion_that_cannot_be_read_says_what_to_write() {
        for (text, words) in [
            ("chip<1.05", "FIGURE<=LIMIT"),
            ("chips<=1", "`chips` is no figure"),
            ("power<=11", "a power in kW or W"),
            ("chip<=1mm", "a number"),
            ("time<=-1s", "a time in s or min"),
            ("feed<=nan mm/min", "a feed in"),
        ] {
            let error = text.parse::<Assertion>().unwrap_err();
            assert!(error.contains(words) && error.contains("chip<=1.05"), "{text}: {error}");
        }
    }
}
