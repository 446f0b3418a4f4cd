//! Writes the job file: found values as such, unknown ones as `"?"` below a comment that explains the answer.

use std::fmt::Write;

use arcfeed_model::cut::RotationCircle;
use arcfeed_model::tool::Edge;
use arcfeed_units::{LengthUnit, Nm};

use super::groups::Group;
use super::proposal::{LikelyTool, Proposal, ProposedCut};
use super::survey::Survey;
use super::wording::{self, length, lengths, quoted};

/// Input of the job file.
#[derive(Clone, Copy, Debug)]
pub struct Findings<'a> {
    /// Path of the program in the job file.
    pub program: &'a str,
    /// Survey of the program.
    pub survey: &'a Survey,
    /// Arcs of the program, grouped.
    pub groups: &'a [Group],
    /// Proposed tool and cut rules.
    pub proposal: &'a Proposal,
    /// Keys and values of `[control]`.
    pub control: &'a [(&'static str, String)],
}

const UNITS_QUESTION: &str = "
# QUESTION: the program has no G20 or G21. In which unit does it count, \"inch\" or \"mm\"?
units = \"?\"
";

const OTHER_LAWS: [&str; 2] = [
    "# Constant feed per tooth on the cutting circumference. Also for a cup mill: \"engaged-arc\" (the thickest chip over the
# whole engaged arc; takes every form of stock), \"table\", \"programmed\".",
    "# Constant feed per tooth along the finished contour. Also for an end mill: \"engagement\" (constant chip thickness),
# \"table\", \"programmed\".",
];

const STOCK_FORMS: &str = "
# STOCK. Each rule asks where the material is, in the program's coordinates of the arc's plane. The circumference law takes
# a straight edge, the engaged-arc law every form. Put one in place of \"?\", for example:
#   stock = { from = [0.0, 1.5], to = [-4.0, 2.0] }                  two points of its edge, the material on the left of the way
#   stock = { normal_deg = 54.2, offset = 4.24 }                     the edge by its normal, which points out of the material
#   stock = { polygon = [[0.0, 0.0], [6.0, 0.0], [6.0, 4.0]] }       3 to 8 corners, convex
#   stock = { disc = [0.0, 0.0, 5.0] }                               a round blank: centre and radius
# A rule can be narrowed: n = [144, 152] (first and last N), z = [-28.4, -27.5] (lowest and highest Z at the arc's start).
";

const SIDE_FORMS: &str = "
# CUTS. Each rule asks on which side of the contour the tool runs, and how deep it cuts radially:
#   side = \"inside\"     radial_depth = 1.0       in a pocket, along a concave wall
#   side = \"outside\"    radial_depth = 1.0       around an island
#   side = \"slot\"                               both walls at once: remove the line radial_depth
# A rule can be narrowed: n = [140, 200] (first and last N), z = [-5.0, -5.0] (lowest and highest Z at the arc's start).
# Straight moves: moves = \"lines\" without direction.
";

/// Text of the job file.
pub fn job(findings: &Findings<'_>) -> String {
    let Findings { program, survey, groups, proposal, control } = *findings;
    let unit = survey.unit.unwrap_or(LengthUnit::Inch);
    let mut text = String::from(
        "# A first job, made from its program by `arcfeed init`. Each \"?\" is a question still open; `arcfeed check` on this file
# says which. What was found stands as it was found, what is likely says so: look at both.
",
    );
    text += &match survey.unit {
        Some(LengthUnit::Inch) => "units = \"inch\"\n".into(),
        Some(LengthUnit::Mm) => "units = \"mm\"\n".into(),
        None => UNITS_QUESTION.to_owned(),
    };
    text += &format!("program = {}\n", quoted(program));
    text += &arcs_found(groups, survey, unit);
    text += &tool(survey, proposal, unit);
    text += &spindle(survey);
    text += &limits(unit);
    text += &law(survey, groups, proposal, unit);
    text += if proposal.tool == LikelyTool::EndMill { SIDE_FORMS } else { STOCK_FORMS };
    for cut in &proposal.cuts {
        text += &rule(cut, groups, unit);
    }
    text += "
# How the feed reaches the control: \"safe-base\" (the least feed of each arc as F, the override raises it), \"override-only\", or
# \"rewrite-only\" (arcs in pieces with F words, for a control without an override input).
[override]
mode = \"safe-base\"

[control]
";
    text.extend(control.iter().map(|(key, value)| format!("{key} = {}\n", quoted(value))));
    text += "
# The line of `arcfeed stream`, where it is not 9600 8N1 with XON/XOFF; many controls of that kind take:
# [serial]
# baudrate = 9600
# bytesize = 7
# parity = \"E\"
# stopbits = 2
# xonxoff = true
";
    text
}

fn arcs_found(groups: &[Group], survey: &Survey, unit: LengthUnit) -> String {
    let mut text = format!("\n# Found: {} arcs and {} straight cutting moves.\n", survey.arcs.len(), survey.lines);
    for group in groups {
        text += &format!("# {}\n", wording::group(group, unit));
    }
    text
}

fn tool(survey: &Survey, proposal: &Proposal, unit: LengthUnit) -> String {
    let named = |tool: &i64| format!("T{tool}");
    let mut text = match (survey.tools.as_slice(), proposal.number) {
        (_, None) => "\n# The program names no tool.\n".to_owned(),
        ([one], _) => format!("\n# {}.\n", named(one)),
        (all, Some(number)) => {
            let all: Vec<String> = all.iter().map(named).collect();
            format!(
                "\n# The program uses {}. This job is for T{number}, which has the most arcs; the others keep their feeds.\n",
                all.join(", ")
            )
        }
    };
    let number = proposal.number.map_or(String::new(), |number| format!("number = {number}\n"));
    match proposal.tool {
        LikelyTool::CupMill { outer_mm, inner_mm } => {
            let (outer, inner) = (length(outer_mm, unit), length(inner_mm, unit));
            text += "# LIKELY: a cup mill. Two radii recur; it turns about points on its own outer and inner circle. If it is an end mill:\n";
            text += "# kind = \"end-mill\", diameter and teeth.\n";
            text += &format!("[tool]\nkind = \"cup-mill\"\n{number}outer_radius = {outer}\ninner_radius = {inner}\n");
            text += "# QUESTION: how many teeth cut, of those on one circle? For example: active_teeth = 10\nactive_teeth = \"?\"\n";
        }
        LikelyTool::EndMill => {
            text += "# LIKELY: an end mill; no two radii recur as those of a ring would. If it is a cup mill: kind = \"cup-mill\", outer_radius,\n";
            text += "# inner_radius and active_teeth.\n[tool]\nkind = \"end-mill\"\n";
            text += &number;
            text += &format!(
                "# QUESTION: its diameter? For example: diameter = {}, or \"10 mm\"\ndiameter = \"?\"\n",
                length(10.0, unit)
            );
            text += "# QUESTION: how many teeth? For example: teeth = 4\nteeth = \"?\"\n";
        }
    }
    text
}

fn spindle(survey: &Survey) -> String {
    let question =
        |why: &str| format!("\n[spindle]\n# QUESTION: {why} For example: rev_per_min = 1000\nrev_per_min = \"?\"\n");
    match survey.speeds.as_slice() {
        [] => {
            question("the program has no S word. How fast does the operator let the spindle turn?")
                + "set_by = \"operator\"\n"
        }
        [speed] => format!("\n[spindle]\nrev_per_min = {speed}\n"),
        speeds => {
            let speeds: Vec<String> = speeds.iter().map(|speed| format!("S{speed}")).collect();
            question(&format!(
                "the program has {}; each block is governed at the speed in force there. Which is the one of this job's reports?",
                speeds.join(", ")
            ))
        }
    }
}

fn limits(unit: LengthUnit) -> String {
    let example = if unit == LengthUnit::Inch { 100 } else { 3_000 };
    format!(
        "\n# No governed block is fed faster than max_feed, nor faster than max_raise times its own F.\n[limits]\n\
         # QUESTION: the fastest feed of these cuts, per minute? For example: max_feed = {example}\nmax_feed = \"?\"\nmax_raise = 2\n"
    )
}

fn law(survey: &Survey, groups: &[Group], proposal: &Proposal, unit: LengthUnit) -> String {
    let (law, others, of) = match proposal.tool {
        LikelyTool::CupMill { .. } => ("circumference", OTHER_LAWS[0], "on the circumference"),
        LikelyTool::EndMill => ("contour", OTHER_LAWS[1], "at the contour"),
    };
    let mut text =
        format!("\n{others}\n[law]\nkind = \"{law}\"\n# QUESTION: the feed per tooth wanted {of}? For example: ");
    text += if unit == LengthUnit::Inch { "feed_per_tooth = 0.004\n" } else { "feed_per_tooth = 0.1\n" };
    let mut feeds: Vec<Nm> =
        groups.iter().filter(|group| group.tool == proposal.number).flat_map(|group| group.feeds.clone()).collect();
    feeds.sort_unstable();
    feeds.dedup();
    if let ([speed], false) = (survey.speeds.as_slice(), feeds.is_empty()) {
        let per_turn: Vec<Nm> = feeds.iter().map(|feed| Nm(feed.0 / speed)).collect();
        let (feeds, per_turn) = (lengths(&feeds, unit), lengths(&per_turn, unit));
        text += &format!(
            "# As programmed its arcs run at F {feeds}: {per_turn} a turn of the tool's centre, to be divided by the teeth.\n"
        );
    }
    text + "feed_per_tooth = \"?\"\n"
}

fn rule(cut: &ProposedCut, groups: &[Group], unit: LengthUnit) -> String {
    let arcs: usize = cut.groups.iter().map(|index| groups[*index].arcs).sum();
    let levels: Vec<Nm> = cut.groups.iter().flat_map(|index| groups[*index].levels.clone()).collect();
    let mut radii: Vec<String> = cut.groups.iter().map(|index| length(groups[*index].radius_mm, unit)).collect();
    radii.dedup();
    let plural = if arcs == 1 { "" } else { "s" };
    let mut text = format!("\n# {arcs} arc{plural}, R {}, Z {}.\n", radii.join(", "), lengths(&levels, unit));
    if cut.is_ambiguous {
        text += "# Arcs of another kind or tool fit this rule, too, and neither N nor Z distinguishes them: number the program's blocks.\n";
    }
    text += "[[cut]]\n";
    let direction = wording::direction(cut.turn);
    let restrictions = {
        let sequence = cut.sequence.map(|[first, last]| format!("n = [{first}, {last}]\n"));
        let depth = cut.depth.map(|[low, high]| {
            format!("z = [{}, {}]\n", length(low.to_mm() - 0.001, unit), length(high.to_mm() + 0.001, unit))
        });
        sequence.unwrap_or_default() + &depth.unwrap_or_default()
    };
    let _ = match (cut.rotation, cut.edge) {
        (Some(rotation), Some(edge)) => {
            let rotation = if rotation == RotationCircle::Interior { "interior" } else { "exterior" };
            let side = if edge == Edge::Outer { "outer" } else { "inner" };
            write!(
                text,
                "rotation = \"{rotation}\"\ndirection = \"{direction}\"\n# LIKELY, in the published order of movements: the circle that cuts here, \"outer\" or \"inner\".\n\
                 side = \"{side}\"\n{restrictions}# QUESTION: where is the material? Forms: see STOCK above.\nstock = \"?\"\n"
            )
        }
        _ => write!(
            text,
            "moves = \"arcs\"\ndirection = \"{direction}\"\n{restrictions}# QUESTION: which side, and how deep? Forms: see CUTS above.\n\
             side = \"?\"\nradial_depth = \"?\"\n"
        ),
    };
    text
}
