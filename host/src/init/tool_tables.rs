//! Tables of a tool in the job file: the cutter, its speed and its law.

use arcfeed_units::{LengthUnit, Nm};

use super::answers::Answers;
use super::findings::Findings;
use super::proposal::{LikelyTool, ProposedTool};
use super::wording::{length, lengths};

/// Lines of the `[tool]` table of a new job file.
pub fn tool(tool: &ProposedTool, findings: &Findings<'_>) -> String {
    let (unit, answers) = (findings.unit(), findings.answers);
    if tool.cuts.is_empty() {
        let number = tool.number.map_or(String::new(), |number| format!("number = {number}\n"));
        return format!(
            "# No end mill has arcs in G17: all feeds stay. The values of this tool have no effect.\nkind = \"end-mill\"\n{number}diameter = 1.0\nteeth = 1\n"
        );
    }
    let number = tool.number.map_or(String::new(), |number| format!("number = {number}\n"));
    if let LikelyTool::CupMill { outer_mm, inner_mm } = tool.kind {
        let (outer, inner) = (length(outer_mm, unit), length(inner_mm, unit));
        return format!(
            "# LIKELY: a cup mill. Two radii recur; it turns about points on its own outer and inner circle. If it is an end mill:\n\
             # kind = \"end-mill\", diameter and teeth.\nkind = \"cup-mill\"\n{number}outer_radius = {outer}\ninner_radius = {inner}\n\
             # QUESTION: how many teeth cut, of those on one circle? For example: active_teeth = 10\nactive_teeth = \"?\"\n"
        );
    }
    let mut text = format!("kind = \"end-mill\"\n{number}");
    let note = tool.note.as_ref();
    if let Some(note) = note {
        text += &format!("# Line {}: ({})\n", note.line, note.text.trim().replace(char::is_control, " "));
    }
    let noted = |mm: Option<f64>| mm.map(|mm| length(mm, unit));
    let given = Answers::of(&answers.diameters, tool.number).map(|given| given.to_toml());
    match given.or(noted(note.and_then(|note| note.data.diameter_mm))) {
        Some(diameter) => text += &format!("diameter = {diameter}\n"),
        None => {
            let example = length(10.0, unit);
            text += &format!(
                "# QUESTION: its diameter? For example: diameter = {example}, or \"10 mm\"\ndiameter = \"?\"\n"
            );
        }
    }
    if let Some(corner) = noted(note.and_then(|note| note.data.corner_radius_mm).filter(|radius| *radius > 0.0)) {
        text += &format!("corner_radius = {corner}\n");
    }
    match findings.teeth(tool) {
        Some(teeth) => text += &format!("teeth = {teeth}\n"),
        None if findings.follows_program(tool) => {
            text += "# The feed does not depend on the number of teeth here; figures per tooth are per revolution without it.\n# teeth = 4\n";
        }
        None => text += "# QUESTION: how many teeth? For example: teeth = 4\nteeth = \"?\"\n",
    }
    text
}

/// Lines of the `[spindle]` table of a new job file.
pub fn spindle(tool: &ProposedTool, findings: &Findings<'_>) -> String {
    let speeds = findings.survey.use_of(tool.number).map_or(&findings.survey.speeds, |used| &used.speeds);
    match (speeds.as_slice(), findings.answers.rev_per_min) {
        ([], None) if tool.cuts.is_empty() => "rev_per_min = 1000\n".into(),
        ([], None) => {
            "# QUESTION: the program has no S word. How fast does the operator let the spindle turn? For example: \
                       rev_per_min = 1000\nrev_per_min = \"?\"\nset_by = \"operator\"\n"
                .into()
        }
        ([], Some(speed)) => format!("rev_per_min = {speed}\nset_by = \"operator\"\n"),
        ([speed], _) => format!("rev_per_min = {speed}\n"),
        ([first, ..], _) => {
            let speeds: Vec<String> = speeds.iter().map(|speed| format!("S{speed}")).collect();
            format!(
                "# The program has {}; each block is governed at the speed in force there. This one is for reports.\n\
                 rev_per_min = {first}\n",
                speeds.join(", ")
            )
        }
    }
}

/// Lines of the `[law]` table of a new job file.
pub fn law(tool: &ProposedTool, findings: &Findings<'_>) -> String {
    let unit = findings.unit();
    let example = if unit == LengthUnit::Inch { "feed_per_tooth = 0.004" } else { "feed_per_tooth = 0.1" };
    if tool.cuts.is_empty() {
        return format!("kind = \"programmed\"\n{example}\n");
    }
    if tool.is_cup_mill() {
        return format!(
            "# Constant feed per tooth on the cutting circumference. Also for a cup mill: \"engaged-arc\" (the thickest chip over the\n\
             # whole engaged arc; takes every form of stock), \"table\", \"programmed\".\nkind = \"circumference\"\n\
             # QUESTION: the feed per tooth wanted on the circumference? For example: {example}\n{}feed_per_tooth = \"?\"\n",
            as_programmed(tool, findings)
        );
    }
    let mut text = String::from(
        "# Constant feed at the finished contour. Also for an end mill: \"engagement\" (constant chip thickness; needs radial_depth in\n\
         # the rules), \"engaged-arc\", \"table\", \"programmed\" (no change).\nkind = \"contour\"\n",
    );
    match Answers::of(&findings.answers.feeds_per_tooth, tool.number) {
        Some(feed) => text += &format!("feed_per_tooth = {}\n", feed.to_toml()),
        None if findings.follows_program(tool) => {
            text += &format!(
                "# The F of each block is the feed at the contour. Or a feed per tooth, for example: {example}\n"
            );
            text += "feed_per_tooth = \"programmed\"\n";
        }
        None => {
            text += &format!("# QUESTION: the feed per tooth wanted at the contour? For example: {example}\n");
            text += &as_programmed(tool, findings);
            text += "feed_per_tooth = \"?\"\n";
        }
    }
    if findings.answers.max_percent.is_some() {
        text += "# Outside arcs are fed faster than the contour, up to the limits.\ninside_only = false\n";
    }
    text
}

/// Feeds per turn as programmed, where the speed is known.
fn as_programmed(tool: &ProposedTool, findings: &Findings<'_>) -> String {
    let Findings { survey, groups, .. } = *findings;
    let mut feeds: Vec<Nm> =
        groups.iter().filter(|group| group.tool == tool.number).flat_map(|group| group.feeds.clone()).collect();
    feeds.sort_unstable();
    feeds.dedup();
    let speeds = survey.use_of(tool.number).map_or(&[][..], |used| &used.speeds);
    let ([speed], false) = (speeds, feeds.is_empty()) else { return String::new() };
    let per_turn: Vec<Nm> = feeds.iter().map(|feed| Nm(feed.0 / speed)).collect();
    let [feeds, per_turn] = [&feeds, &per_turn].map(|values| lengths(values, findings.unit()));
    format!(
        "# As programmed its arcs run at F {feeds}: {per_turn} a turn of the tool's centre, to be divided by the teeth.\n"
    )
}
