//! Row of a run: its end and its figures.

use serde::{Deserialize, Serialize};

/// End of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RunStatus {
    /// It ended, and every assertion holds.
    Passed,
    /// An assertion does not hold, or its figure is missing.
    Failed,
    /// The control stopped at an alarm, or the line failed.
    Stopped,
    /// Job or program were refused: nothing ran.
    Refused,
    /// A defect of arcfeed.
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

    /// The end of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|status| status.name() == name)
    }

    /// All names, for messages.
    pub fn names() -> String {
        Self::ALL.map(RunStatus::name).join(", ")
    }
}

/// Result of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// Number of the run, from 1.
    pub run: u64,
    /// End.
    pub status: RunStatus,
    /// Message of the command, in one line; empty for a run that passed.
    pub message: String,
    /// Bits of the figures of double precision, in the order of the sweep file; `None` where the run has no such figure.
    pub figures: Vec<Option<u64>>,
}
