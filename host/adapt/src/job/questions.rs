//! Open questions of a job file: values written as `"?"`, as `arcfeed init` writes them.

use std::ops::Range;

use toml::de::DeValue;

use super::Complaint;
use crate::place::place;
use crate::toml_values::walk;

/// Placeholder of a missing answer.
pub const OPEN: &str = "?";

/// Open question in a job file: a value `"?"`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Question {
    /// Key of the value: `tool.active_teeth`, `cut.2.stock` (rules counted from 1).
    pub key: String,
    /// Line and column of the `"?"`, counted from 1.
    pub place: [usize; 2],
    span: Range<usize>,
}

/// Open questions of a job file, in the order of the file; empty if the text is not TOML.
pub fn open(text: &str) -> Vec<Question> {
    let mut found = Vec::new();
    walk(text, &mut |key, _, value| {
        if matches!(value.get_ref(), DeValue::String(string) if string == OPEN) {
            let span = value.span();
            found.push(Question { key: key.to_owned(), place: place(text, span.start), span });
        }
    });
    found.sort_by_key(|question| question.span.start);
    found
}

/// Rejects a job with open questions, at the first one.
pub(super) fn refuse_open(text: &str) -> Result<(), Complaint> {
    let questions = open(text);
    let Some((first, others)) = questions.split_first() else { return Ok(()) };
    let mut message =
        format!("an open question: `{}`; put the answer in place of \"?\", the lines above it say how", first.key);
    if !others.is_empty() {
        let others: Vec<String> =
            others.iter().map(|other| format!("{} (line {})", other.key, other.place[0])).collect();
        message += &format!("; behind it are open: {}", others.join(", "));
    }
    Err((first.span.start, message))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn open_questions_are_found_where_they_stand_and_comments_are_none() {
        let text = "a = 1 # \"?\"\n[tool]\nkind = \"cup?\"\nteeth = \"?\"\n[[cut]]\nn = [1, 2]\n[[cut]]\n  stock = { disc = [0, \"?\", 1] }\n";
        let found: Vec<(String, [usize; 2])> = open(text).into_iter().map(|open| (open.key, open.place)).collect();
        assert_eq!(found, [("tool.teeth".into(), [4, 9]), ("cut.2.stock.disc.2".into(), [8, 24])]);
        let (offset, message) = refuse_open(text).unwrap_err();
        assert!(
            text[offset..].starts_with("\"?\"\n[[cut]]") && message.contains("cut.2.stock.disc.2 (line 8)"),
            "{message}"
        );
    }
}
