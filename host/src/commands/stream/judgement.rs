//! Assertions (`--assert`) of a run on a control, and their outcomes as JUnit XML.

use crate::clock::Instant;
use crate::commands::outcome::Failure;
use crate::commands::simulate::assertions::{AssertionOutcome, Evidence, Verdict};
use crate::commands::simulate::junit::TestSuite;

use super::Stream;

impl Stream {
    /// Judges the assertions on what ran, to its end or not; prints those that hold, and writes the outcomes.
    pub(super) fn judge(&self, evidence: &Evidence<'_>, is_whole: bool, started: Instant) -> Result<(), Failure> {
        let outcomes: Vec<AssertionOutcome> =
            self.assertions.iter().map(|assertion| assertion.so_far(evidence, is_whole)).collect();
        let (job, time_s) = (self.input.job.display().to_string(), started.elapsed().as_secs_f64());
        let suite = TestSuite { command: "stream", job, outcomes: &outcomes, time_s };
        // The command says itself why a run did not end.
        suite.conclude(self.junit.as_deref(), self.json, |verdict| match verdict {
            Verdict::Passed => false,
            Verdict::Failed(_) => true,
            Verdict::Missing(_) => is_whole,
        })
    }
}
