//! Input of the page: values of the form, names of files, open questions of the job.

use std::num::NonZeroU16;
use std::path::Path;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use toml::de::DeValue;

use crate::files;
use crate::init::answers::{ForTool, Length};
use crate::job::questions;
use crate::toml_values::walk;

/// Longest name of a program.
const NAME_MAX: usize = 64;

/// Value that the job still needs from a person.
#[derive(Debug, Serialize)]
pub struct OpenQuestion {
    key: String,
    /// Line and column of the `"?"`, counted from 1.
    line: usize,
    column: usize,
    /// Comment above it.
    help: String,
}

/// Value of the form that cannot be used, in the words of a form.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FormProblem {
    /// Name of the field.
    field: &'static str,
    /// T number, if the value is for one of several tools.
    tool: Option<i64>,
    text: String,
}

/// Values of the page's form, which become options of `arcfeed init`; empty ones are left out.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FormValues {
    tool: String,
    teeth: String,
    feed_per_tooth: String,
    spindle: String,
    max: String,
    mode: String,
    milling: String,
}

impl FormValues {
    /// Options of `arcfeed init`. Option and value are one argument, so that no value can be read as an option.
    pub fn options(&self) -> impl Iterator<Item = String> {
        let FormValues { tool, teeth, feed_per_tooth, spindle, max, mode, milling } = self;
        let several = [("tool", tool), ("teeth", teeth), ("feed-per-tooth", feed_per_tooth)];
        // One value for all tools, or T1=10 T3=6.
        let several =
            several.into_iter().flat_map(|(option, values)| values.split_whitespace().map(move |v| (option, v)));
        let single = [("spindle", spindle), ("max", max), ("mode", mode), ("milling", milling)];
        let single =
            single.into_iter().map(|(option, value)| (option, value.trim())).filter(|(_, value)| !value.is_empty());
        several.chain(single).map(|(option, value)| format!("--{option}={value}"))
    }

    /// Values that cannot be used; empty if all can.
    pub fn problems(&self) -> Vec<FormProblem> {
        let mut found = Vec::new();
        let length = "write a length above 0: 10, 10mm or 0.5in";
        each_tool::<Length>(&mut found, "tool", &self.tool, length);
        each_tool::<NonZeroU16>(&mut found, "teeth", &self.teeth, "write a whole number, 1 or more");
        each_tool::<Length>(&mut found, "feed_per_tooth", &self.feed_per_tooth, length);
        let whole = [
            ("spindle", &self.spindle, 1..=1_000_000, "write whole revolutions per minute, 1 to 1000000"),
            ("max", &self.max, 100..=250, "write a whole percentage from 100 to 250"),
        ];
        for (field, value, range, words) in whole {
            let value = value.trim();
            if !value.is_empty() && !value.parse::<u32>().is_ok_and(|number| range.contains(&number)) {
                found.push(FormProblem { field, tool: None, text: refusal(value, words) });
            }
        }
        found
    }
}

/// Adds the values of a field that cannot be used, of one tool or of several.
fn each_tool<T>(found: &mut Vec<FormProblem>, field: &'static str, values: &str, words: &str)
where
    T: FromStr,
    T::Err: std::fmt::Display,
{
    for value in values.split_whitespace().filter(|value| value.parse::<ForTool<T>>().is_err()) {
        let (tool, value) = value.split_once('=').unwrap_or(("", value));
        let tool = tool.trim_start_matches(['T', 't']).parse().ok();
        found.push(FormProblem { field, tool, text: refusal(value, words) });
    }
}

fn refusal(value: &str, words: &str) -> String {
    let comma = if value.contains(',') { "; the decimals stand behind a point, not a comma" } else { "" };
    format!("{value} cannot be used: {words}{comma}")
}

/// Words for a file that is no NC program, by its bytes and by the JSON of `arcfeed init` for it; `None` for a program.
pub fn is_no_program(bytes: &[u8], found: Option<&Value>) -> Option<&'static str> {
    let mut lines =
        bytes.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii).filter(|line| !line.is_empty() && *line != b"%");
    let count = |key: &str| found.and_then(|found| found[key].as_u64()).unwrap_or_default() as usize;
    let moves = count("arcs") + count("lines");
    if lines.next().is_none() {
        return Some("the file is empty");
    }
    // Most lines are none of a program, and nothing moves.
    (moves == 0 && 2 * count("errors") > lines.count()).then_some("this is no NC program")
}

/// Name for a dropped program: without folders and special characters; the ending `.toml`, which belongs
/// to jobs, is removed.
pub fn plain_name(name: &str) -> String {
    let allowed = |letter: &char| letter.is_ascii_alphanumeric() || matches!(letter, '.' | '-' | '_');
    let name: String =
        name.rsplit(['/', '\\']).next().unwrap_or_default().chars().filter(allowed).take(NAME_MAX).collect();
    let name = name.trim_start_matches(['.', '-']);
    match name.strip_suffix(".toml").unwrap_or(name) {
        "" => "program.nc".into(),
        name => name.into(),
    }
}

/// First value in the text of a job that names a file outside `folder`; `None` if there is none.
pub fn foreign_file(text: &str, folder: &Path) -> Option<String> {
    let mut found = None;
    walk(text, &mut |_, _, value| {
        if let DeValue::String(string) = value.get_ref()
            && let Ok(path) = files::canonicalize(folder.join(string.as_ref()))
            && !path.starts_with(folder)
        {
            found.get_or_insert_with(|| string.to_string());
        }
    });
    found
}

/// Open questions of a job, each with the comment above it.
pub fn open_questions(text: &str) -> Vec<OpenQuestion> {
    let lines: Vec<&str> = text.lines().collect();
    let help = |line: usize| {
        let above = lines[..line.saturating_sub(1).min(lines.len())].iter().rev();
        let mut comments: Vec<&str> = above.map_while(|line| line.strip_prefix("# ")).collect();
        comments.reverse();
        comments.join(" ").trim_start_matches("QUESTION: ").to_owned()
    };
    let question = |question: questions::Question| {
        let [line, column] = question.place;
        OpenQuestion { key: question.key, line, column, help: help(line) }
    };
    questions::open(text).into_iter().map(question).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_a_plain_file_of_the_folder() {
        for (given, wanted) in [
            ("part.nc", "part.nc"),
            ("../../etc/passwd", "passwd"),
            ("C:\\NC\\O1546 (2).TAP", "O15462.TAP"),
            (".profile", "profile"),
            ("--json", "json"),
            ("job.toml", "job"),
            ("..", "program.nc"),
            ("", "program.nc"),
        ] {
            assert_eq!(plain_name(given), wanted, "{given}");
        }
    }

    #[test]
    fn a_job_names_no_file_outside_the_folder() {
        let scratch = tempfile::tempdir().unwrap();
        let folder = scratch.path().canonicalize().unwrap().join("in");
        std::fs::create_dir(&folder).unwrap();
        std::fs::write(folder.join("part.nc"), "M30\n").unwrap();
        std::fs::write(scratch.path().join("secret"), "").unwrap();
        let foreign = |value: &str| foreign_file(&format!("units = \"mm\"\n[a]\nb = [\"{value}\"]\n"), &folder);
        assert_eq!(foreign("part.nc"), None);
        assert_eq!(foreign("mm/min"), None);
        for path in ["../secret", "/dev/null", "part.nc/../../secret", ".."] {
            assert_eq!(foreign(path).is_some(), folder.join(path).exists(), "{path}");
        }
        assert!(foreign("../secret").is_some() && foreign("/dev/null").is_some());
    }

    #[test]
    fn a_question_has_the_comment_above_it() {
        let text = "a = 1\n# not this one\n\n# QUESTION: how many\n# teeth cut?\nteeth = \"?\"\n";
        let [question] = open_questions(text).try_into().unwrap();
        assert_eq!((question.key.as_str(), question.line, question.column), ("teeth", 6, 9));
        assert_eq!(question.help, "how many teeth cut?");
    }

    #[test]
    fn a_value_that_init_would_refuse_is_refused_at_its_field() {
        let values = |tool: &str, teeth: &str, max: &str| FormValues {
            tool: tool.into(),
            teeth: teeth.into(),
            max: max.into(),
            ..FormValues::default()
        };
        assert_eq!(values("10mm", "3", "120").problems(), []);
        let found = values("T1=10 T3=0,05", "2.5", "-20").problems();
        let fields: Vec<_> = found.iter().map(|found| (found.field, found.tool)).collect();
        assert_eq!(fields, [("tool", Some(3)), ("teeth", None), ("max", None)]);
        assert!(found[0].text.contains("not a comma") && !found[1].text.contains("--"), "{found:?}");
        for wrong in ["-10", "0", "ten", "10ft"] {
            assert_eq!(values(wrong, "", "").problems().len(), 1, "{wrong}");
        }
    }

    #[test]
    fn a_file_without_blocks_is_no_program() {
        let found = |arcs: u64, errors: u64| serde_json::json!({ "arcs": arcs, "lines": 0, "errors": errors });
        assert!(is_no_program(b"", None).is_some() && is_no_program(b"%\r\n\n%\n", Some(&found(0, 0))).is_some());
        assert!(is_no_program(b"two apples\nbread\n", Some(&found(0, 2))).is_some());
        assert_eq!(is_no_program(b"G81X1.Z-2.R1.F100.\nX5.\nG12.4\nM30\n", Some(&found(0, 1))), None);
        assert_eq!(is_no_program(b"G2I5.\nbread\n", Some(&found(1, 1))), None);
    }

    #[test]
    fn no_value_of_the_form_is_an_option_of_its_own() {
        let values = FormValues { tool: "T1=10 T3=--json".into(), max: " 120 ".into(), ..FormValues::default() };
        assert_eq!(values.options().collect::<Vec<_>>(), ["--tool=T1=10", "--tool=T3=--json", "--max=120"]);
    }
}
