//! Row of a run in the table of a campaign: its outcome and its figures (results as numbers).

use serde::{Deserialize, Serialize};

/// Outcome of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RunStatus {
    /// The run ended, and every assertion holds.
    Passed,
    /// The run ended, but an assertion does not hold or its figure is missing.
    Failed,
    /// The control stopped at an alarm, or the line failed.
    Stopped,
    /// The job or the program was rejected: nothing ran.
    Refused,
    /// A defect of arcfeed ended the run.
    Panicked,
}

impl RunStatus {
    /// All of them.
    pub const ALL: [RunStatus; 5] =
        [RunStatus::Passed, RunStatus::Failed, RunStatus::Stopped, RunStatus::Refused, RunStatus::Panicked];

    /// Name in tables and in SWEEP.toml.
    pub const fn name(self) -> &'static str {
        match self {
            RunStatus::Passed => "passed",
            RunStatus::Failed => "failed",
            RunStatus::Stopped => "stopped",
            RunStatus::Refused => "refused",
            RunStatus::Panicked => "panicked",
        }
    }

    /// Outcome with this name; `None` if there is none.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|status| status.name() == name)
    }

    /// Names of all outcomes, for messages.
    pub fn names() -> String {
        Self::ALL.map(RunStatus::name).join(", ")
    }
}

/// Result of one run of a campaign.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// Number of the run, from 1.
    pub run: u64,
    /// Outcome of the run.
    pub status: RunStatus,
    /// Message of the command, in one line; empty for a run that passed.
    pub message: String,
    /// Figures in the order of the sweep file, each as the bits of a double (`f64::to_bits`); `None` if the run has no such figure.
    pub figures: Vec<Option<u64>>,
}
