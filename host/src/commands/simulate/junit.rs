//! Outcomes of assertions as JUnit XML, as CI servers read it: one `testsuite` with a `testcase` for each assertion.

use std::fmt::{self, Write};

use super::assertions::{AssertionOutcome, Verdict};
use crate::report::page::escaped;

/// Assertions of a run as a JUnit test suite.
pub struct TestSuite<'a> {
    /// Job.
    pub job: String,
    /// Outcomes, in order.
    pub outcomes: &'a [AssertionOutcome],
    /// Time that the command took, s.
    pub time_s: f64,
}

impl fmt::Display for TestSuite<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let TestSuite { job, outcomes, time_s } = self;
        let count = |choose: &dyn Fn(&Verdict) -> bool| outcomes.iter().filter(|case| choose(&case.verdict)).count();
        let failures = count(&|verdict| matches!(verdict, Verdict::Failed(_)));
        let errors = count(&|verdict| matches!(verdict, Verdict::Missing(_)));
        let counts = format!("tests=\"{}\" failures=\"{failures}\" errors=\"{errors}\"", outcomes.len());
        let job = attribute(job);
        writeln!(f, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
        writeln!(f, "<testsuites {counts} time=\"{time_s:.3}\">")?;
        writeln!(f, "  <testsuite name=\"arcfeed simulate {job}\" {counts} skipped=\"0\" time=\"{time_s:.3}\">")?;
        for AssertionOutcome { text, verdict } in *outcomes {
            // The run is one for all assertions, so none has a time of its own.
            write!(f, "    <testcase name=\"{}\" classname=\"{job}\" time=\"0\"", attribute(text))?;
            match verdict {
                Verdict::Passed => writeln!(f, "/>")?,
                Verdict::Failed(message) => write_cause(f, "failure", message)?,
                Verdict::Missing(message) => write_cause(f, "error", message)?,
            }
        }
        writeln!(f, "  </testsuite>\n</testsuites>")
    }
}

fn write_cause(f: &mut fmt::Formatter<'_>, element: &str, message: &str) -> fmt::Result {
    let message = attribute(message);
    writeln!(f, ">\n      <{element} message=\"{message}\" type=\"assertion\">{message}</{element}>\n    </testcase>")
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
        let outcome = |text: &str, verdict| AssertionOutcome { text: text.into(), verdict };
        let outcomes = [
            outcome("chip<=1.05", Verdict::Passed),
            outcome("time<=1s", Verdict::Failed("a&b.nc:3: N10: \u{7}".into())),
            outcome("power<=1kW", Verdict::Missing("add [cutting]".into())),
        ];
        let xml = TestSuite { job: "\"a\"<b>.toml".into(), outcomes: &outcomes, time_s: 0.25 }.to_string();
        assert!(xml.contains("<testsuites tests=\"3\" failures=\"1\" errors=\"1\" time=\"0.250\">"), "{xml}");
        assert!(xml.contains("classname=\"&quot;a&quot;&lt;b&gt;.toml\""), "{xml}");
        assert!(xml.contains("<testcase name=\"chip&lt;=1.05\"") && xml.contains("time=\"0\"/>"), "{xml}");
        assert!(xml.contains("message=\"a&amp;b.nc:3: N10: \\u{7}\""), "{xml}");
        assert_eq!((xml.matches("<failure").count(), xml.matches("</error>").count()), (1, 1));
    }
}
