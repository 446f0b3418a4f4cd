//! Wording of numbers and terms in a new job file and its comments.

use std::fmt::Write;
use std::path::Path;

use arcfeed_nc::modal::{Plane, Turn};
use arcfeed_units::{LengthUnit, Nm};

use super::groups::Group;
use super::survey::Survey;
use crate::program::ToolNote;

/// Most levels and feeds in a list; more are given as a range.
const NAMED_MAX: usize = 6;

/// Length as text in a unit, to a quarter of a micrometre, without trailing zeros but with a decimal point.
pub fn length(mm: f64, unit: LengthUnit) -> String {
    let decimals = if unit == LengthUnit::Inch { 5 } else { 4 };
    let text = format!("{:.decimals$}", mm / unit.mm());
    let text = text.trim_end_matches('0');
    let text = if text.ends_with('.') { format!("{text}0") } else { text.to_owned() };
    if text == "-0.0" { "0.0".into() } else { text }
}

/// Lengths as a list, or as a range from the smallest to the largest if there are many.
pub fn lengths(values: &[Nm], unit: LengthUnit) -> String {
    let one = |value: &Nm| length(value.to_mm(), unit);
    match values {
        [] => "none".into(),
        [first, .., last] if values.len() > NAMED_MAX => {
            format!("{} from {} to {}", values.len(), one(first), one(last))
        }
        _ => values.iter().map(one).collect::<Vec<_>>().join(", "),
    }
}

/// List of words for a message; a long list is shortened to the first, the last and their number.
pub fn some(words: &[String]) -> String {
    match words {
        [first, .., last] if words.len() > NAMED_MAX => format!("{first} to {last} ({} values)", words.len()),
        _ => words.join(", "),
    }
}

/// Direction of an arc, as the value of `direction` in job files.
pub const fn direction(turn: Turn) -> &'static str {
    match turn {
        Turn::Ccw => "ccw",
        Turn::Cw => "cw",
    }
}

/// Plane of an arc, as its G code.
pub const fn plane(plane: Plane) -> &'static str {
    match plane {
        Plane::Xy => "G17",
        Plane::Zx => "G18",
        Plane::Yz => "G19",
    }
}

/// Description of a group in one line.
pub fn group(group: &Group, unit: LengthUnit) -> String {
    let mut text = format!(
        "{:>5} {:<4}{} R{}",
        group.arcs,
        direction(group.turn),
        plane(group.plane),
        length(group.radius_mm, unit)
    );
    let [least, most] = group.sweep_rad.map(f64::to_degrees);
    // Writing to a string cannot fail.
    let _ = match group.sequence {
        Some([first, last]) if first != last => write!(text, "  N{first} to N{last}"),
        Some([first, _]) => write!(text, "  N{first}"),
        None if group.lines[0] == group.lines[1] => write!(text, "  line {}", group.lines[0]),
        None => write!(text, "  lines {} to {}", group.lines[0], group.lines[1]),
    };
    let _ = write!(text, "  Z {}  F {}", lengths(&group.levels, unit), lengths(&group.feeds, unit));
    let _ = if most - least < 0.5 {
        write!(text, "  {least:.0} deg")
    } else {
        write!(text, "  {least:.0} to {most:.0} deg")
    };
    if group.helices > 0 {
        let _ = write!(text, "  helices: {}", group.helices);
    }
    if let Some(tool) = group.tool {
        let _ = write!(text, "  T{tool}");
    }
    text
}

/// String in TOML syntax.
pub fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        let _ = match c {
            '"' | '\\' => write!(quoted, "\\{c}"),
            c if c.is_control() => write!(quoted, "\\u{:04X}", u32::from(c)),
            c => write!(quoted, "{c}"),
        };
    }
    quoted + "\""
}

/// Note on a tool with arcs that keeps its feeds because of a comment, and the option that includes the tool.
pub fn exclusion(note: &ToolNote) -> String {
    let (line, text) = match &note.operation {
        Some(operation) if note.data.kind.is_none() => (operation.line, &operation.text),
        _ => (note.line, &note.text),
    };
    let (tool, text) = (note.tool, text.trim().replace(char::is_control, " "));
    format!("T{tool} keeps its feeds: by line {line} ({text}) it is no end mill; if it is one: --tool T{tool}=DIAMETER")
}

/// Sentence that explains why no move is governed.
pub const NO_ARCS: &str = "no end mill has arcs in G17 that a law can govern: all feeds stay";

/// Note on arcs under G41 and G42 that keep their feeds because the radius of D is unknown, with its place in the program.
pub fn unknown_radius(program: &Path, survey: &Survey) -> Option<String> {
    let (line, count) = survey.without_radius?;
    Some(format!(
        "{}:{line}: note: the arcs under G41 or G42 ({count}) keep their feed, because the radius of D is unknown: give a settings \
         file (--settings) with [radius], or with compensation = \"wear\" if D holds only wear (docs/compensation.md)",
        program.display()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_have_a_point_and_no_idle_zeros() {
        let inch = |value: f64| length(value * 25.4, LengthUnit::Inch);
        assert_eq!([inch(5.06205), inch(3.0), inch(-0.000_001), inch(0.5)], ["5.06205", "3.0", "0.0", "0.5"]);
        assert_eq!(length(128.57607, LengthUnit::Mm), "128.5761");
    }

    #[test]
    fn strings_come_back_from_toml_as_they_were() {
        let text = "C:\\shop\\\"new\"\t\u{e9}.nc";
        let read: toml::Table = toml::from_str(&format!("a = {}", quoted(text))).unwrap();
        assert_eq!(read["a"].as_str(), Some(text));
    }
}
