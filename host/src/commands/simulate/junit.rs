//! Outcomes in JUnit XML, which CI servers read: one `testsuite` with a `testcase` for each assertion or run.

use std::fmt::{self, Write};
use std::path::Path;

use super::super::outcome::{Failure, say, write_whole};
use super::assertions::{AssertionOutcome, Verdict};
use crate::report::page::escaped;

/// Assertions of a run as a JUnit test suite.
pub struct TestSuite<'a> {
    /// Command of arcfeed that made the run.
    pub command: &'static str,
    /// Path of the job file, the name of the suite.
    pub job: String,
    /// Outcomes of the assertions, in order.
    pub outcomes: &'a [AssertionOutcome],
    /// Time that the command took, s.
    pub time_s: f64,
}

impl TestSuite<'_> {
    /// Writes the suite to the file of `--junit`, and prints the assertions that hold, unless the command prints JSON.
    ///
    /// # Errors
    /// The file cannot be written, or an assertion's verdict is one for which `is_broken` is true: all of these, a line each.
    pub fn conclude(
        &self,
        junit: Option<&Path>,
        has_json: bool,
        is_broken: impl Fn(&Verdict) -> bool,
    ) -> Result<(), Failure> {
        if let Some(path) = junit {
            write_whole(path, self.to_string().as_bytes())?;
        }
        if !has_json {
            let held = self.outcomes.iter().filter(|outcome| outcome.verdict == Verdict::Passed);
            held.for_each(|outcome| say(format_args!("{outcome}")));
        }
        let broken = self.outcomes.iter().filter(|outcome| is_broken(&outcome.verdict));
        let broken: Vec<String> = broken.map(AssertionOutcome::to_string).collect();
        if broken.is_empty() { Ok(()) } else { Err(Failure::Input(broken.join("\n"))) }
    }
}

impl fmt::Display for TestSuite<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let TestSuite { command, job, outcomes, time_s } = self;
        let count = |choose: &dyn Fn(&Verdict) -> bool| outcomes.iter().filter(|case| choose(&case.verdict)).count();
        let failures = count(&|verdict| matches!(verdict, Verdict::Failed(_)));
        let errors = count(&|verdict| matches!(verdict, Verdict::Missing(_)));
        f.write_str(&begin(&format!("arcfeed {command} {job}"), [outcomes.len(), failures, errors], *time_s))?;
        // The run is one for all assertions, so none has a time of its own.
        outcomes.iter().try_for_each(|outcome| f.write_str(&case(&outcome.text, job, &outcome.verdict)))?;
        f.write_str(END)
    }
}

/// Closing tags after the last case of a suite.
pub const END: &str = "  </testsuite>\n</testsuites>\n";

/// Opening tags of a suite with these numbers of tests, failures and errors, which took `time_s`.
pub fn begin(name: &str, [tests, failures, errors]: [usize; 3], time_s: f64) -> String {
    let counts = format!("tests=\"{tests}\" failures=\"{failures}\" errors=\"{errors}\"");
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {counts} time=\"{time_s:.3}\">\n  \
         <testsuite name=\"{}\" {counts} skipped=\"0\" time=\"{time_s:.3}\">\n",
        attribute(name)
    )
}

/// Text of one case.
pub fn case(name: &str, class: &str, verdict: &Verdict) -> String {
    let cause = |element: &str, message: &str| {
        let message = attribute(message);
        format!(">\n      <{element} message=\"{message}\" type=\"assertion\">{message}</{element}>\n    </testcase>")
    };
    let rest = match verdict {
        Verdict::Passed => "/>".to_owned(),
        Verdict::Failed(message) => cause("failure", message),
        Verdict::Missing(message) => cause("error", message),
    };
    format!("    <testcase name=\"{}\" classname=\"{}\" time=\"0\"{rest}\n", attribute(name), attribute(class))
}

/// Text for an attribute or an element; XML has no other control characters than tabs and line ends.
fn attribute(text: &str) -> String {
    let mut allowed = String::new();
    for letter in text.chars() {
        match letter {
            '\t' | '\n' | '\r' => allowed.push(' '),
            letter if letter.is_control() || matches!(letter, '\u{fffe}' | '\u{ffff}') => {
                let _ = write!(allowed, "{}", letter.escape_unicode());
            }
            letter => allowed.push(letter),
        }
    }
    escaped(&allowed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_assertion_is_a_case_and_markup_in_names_is_text() {
        let outcome = |text: &str, verdict| AssertionOutcome { text: text.into(), verdict, largest: None };
        let outcomes = [
            outcome("chip<=1.05", Verdict::Passed),
            outcome("time<=1s", Verdict::Failed("a&b.nc:3: N10: \u{7}".into())),
            outcome("power<=1kW", Verdict::Missing("add [cutting]".into())),
        ];
        let job = "\"a\"<b>.toml".into();
        let xml = TestSuite { command: "simulate", job, outcomes: &outcomes, time_s: 0.25 }.to_string();
        assert!(xml.contains("<testsuite name=\"arcfeed simulate &quot;a&quot;"), "{xml}");
        assert!(xml.contains("<testsuites tests=\"3\" failures=\"1\" errors=\"1\" time=\"0.250\">"), "{xml}");
        assert!(xml.contains("classname=\"&quot;a&quot;&lt;b&gt;.toml\""), "{xml}");
        assert!(xml.contains("<testcase name=\"chip&lt;=1.05\"") && xml.contains("time=\"0\"/>"), "{xml}");
        assert!(xml.contains("message=\"a&amp;b.nc:3: N10: \\u{7}\""), "{xml}");
        assert_eq!((xml.matches("<failure").count(), xml.matches("</error>").count()), (1, 1));
    }
}
