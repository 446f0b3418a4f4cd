//! Assertions (`--assert`) of a run on a control, and their outcomes as JUnit XML.

use crate::clock::Instant;
use crate::commands::outcome::{Failure, say, write_whole};
use crate::commands::simulate::assertions::{AssertionOutcome, Evidence, Verdict};
use crate::commands::simulate::junit::TestSuite;

use super::Stream;

impl Stream {
    /// Judges the assertions on what ran, to its end or not; prints those that hold, and writes the outcomes.
    pub(super) fn judge(&self, evidence: &Evidence<'_>, is_whole: bool, started: Instant) -> Result<(), Failure> {
        let outcomes: Vec<AssertionOutcome> =
            self.assertions.iter().map(|assertion| assertion.so_far(evidence, is_whole)).collect();
        if let Some(path) = &self.junit {
            let (job, time_s) = (self.input.job.display().to_string(), started.elapsed().as_secs_f64());
            let suite = TestSuite { command: "stream", job, outcomes: &outcomes, time_s };
            write_whole(path, suite.to_string().as_bytes())?;
        }
        if !self.json {
            let held = outcomes.iter().filter(|outcome| outcome.verdict == Verdict::Passed);
            held.for_each(|outcome| say(format_args!("{outcome}")));
        }
        // The command says itself why a run did not end.
        let is_broken = |verdict: &Verdict| match verdict {
            Verdict::Passed => false,
            Verdict::Failed(_) => true,
            Verdict::Missing(_) => is_whole,
        };
        let broken = outcomes.iter().filter(|outcome| is_broken(&outcome.verdict));
        let broken: Vec<String> = broken.map(AssertionOutcome::to_string).collect();
        if broken.is_empty() { Ok(()) } else { Err(Failure::Input(broken.join("\n"))) }
    }
}
