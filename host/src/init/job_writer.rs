//! Writes the job file: found and given values as such, unknown ones as `"?"` below a comment that explains the answer.

use arcfeed_model::cut::{ContourSide, RotationCircle};
use arcfeed_model::tool::Edge;
use arcfeed_units::{LengthUnit, Nm, PERCENT};

use super::findings::Findings;
use super::groups::Group;
use super::proposal::{Movement, ProposedCut, ProposedTool};
use super::tool_tables;
use super::wording::{self, length, lengths, quoted};
use crate::plural::counted;

/// Most radii in the comment.
const GROUPS_MAX: usize = 40;

const HEAD: &str = "# A first job, made from its program by `arcfeed init`. Each \"?\" is a question still open; `arcfeed check` on this file
# names them. Found values are written as such. Likely values are marked: check both.
";

const UNITS_QUESTION: &str = "
# QUESTION: the program has no G20 or G21. In which unit does it count, \"inch\" or \"mm\"?
units = \"?\"
";

const UNITS_LIKELY: &str = "
# LIKELY, by its comments or the decimals of its coordinates: the program has no G20 or G21. \"inch\" or \"mm\", as the control is set.
";

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
# CUTS. `side` says where the tool's centre runs: \"inside\" a contour (pocket, concave wall), \"outside\" (island), \"slot\" (both walls
# at once). Inside arcs are slowed down, outside arcs keep their feed. LIKELY, for climb milling with M3: counter-clockwise arcs run
# inside, clockwise ones outside. Conventional milling: exchange them. A rule can be narrowed, and the first that matches counts:
# n = [140, 200] (first and last N), z = [-5.0, -5.0] (lowest and highest Z at the arc's start).
";

/// Text of a new job file.
pub fn job(findings: &Findings<'_>) -> String {
    let Findings { program, survey, groups, proposal, answers, control } = *findings;
    let unit = findings.unit();
    let mut text = String::from(HEAD);
    let word = |unit| if unit == LengthUnit::Inch { "inch" } else { "mm" };
    text += &match (survey.unit.or(answers.units), survey.likely_unit) {
        (Some(unit), _) => format!("units = \"{}\"\n", word(unit)),
        (None, Some(unit)) => format!("{UNITS_LIKELY}units = \"{}\"\n", word(unit)),
        (None, None) => UNITS_QUESTION.to_owned(),
    };
    text += &format!("program = {}\n", quoted(program));
    text += &arcs_found(findings);
    let is_kind =
        |is_cup: bool| proposal.tools.iter().any(|tool| !tool.cuts.is_empty() && tool.is_cup_mill() == is_cup);
    text += if is_kind(true) { STOCK_FORMS } else { "" };
    text += if is_kind(false) { SIDE_FORMS } else { "" };
    let names = if proposal.tools.len() == 1 { &SINGLE } else { &SEVERAL };
    let is_known = |tool: &ProposedTool| tool.is_cup_mill() || findings.diameter_mm(tool).is_some();
    let has_known = proposal.tools.iter().any(is_known);
    for tool in &proposal.tools {
        let mut tables = format!("\n{}\n{}", names.tool, tool_tables::tool(tool, findings));
        tables += &format!("\n{}\n{}", names.spindle, tool_tables::spindle(tool, findings));
        tables += &format!("\n{}\n{}", names.law, tool_tables::law(tool, findings));
        tables.extend(tool.cuts.iter().map(|cut| rule(cut, names.cut, groups, unit)));
        text += &if has_known && !is_known(tool) { commented_out(tool, &tables) } else { tables };
    }
    text += &limits(findings);
    let has_cup = proposal.tools.iter().any(ProposedTool::is_cup_mill);
    let mode = answers.mode.as_deref().unwrap_or(if has_cup { "safe-base" } else { "rewrite-only" });
    text += &format!(
        "
# How the feed reaches the control: \"safe-base\" (the least feed of each arc as F, the override raises it), \"override-only\", or
# \"rewrite-only\" (arcs with F words of their own, for a control without an override input).
[override]
mode = {}

[control]
",
        quoted(mode)
    );
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

/// Names of a tool's tables.
struct TableNames {
    tool: &'static str,
    spindle: &'static str,
    law: &'static str,
    cut: &'static str,
}

const SINGLE: TableNames = TableNames { tool: "[tool]", spindle: "[spindle]", law: "[law]", cut: "[[cut]]" };
const SEVERAL: TableNames =
    TableNames { tool: "[[tool]]", spindle: "[tool.spindle]", law: "[tool.law]", cut: "[[tool.cut]]" };

fn arcs_found(findings: &Findings<'_>) -> String {
    let Findings { survey, groups, proposal, .. } = *findings;
    let mut text = format!(
        "\n# Found: {} and {}.\n",
        counted(survey.arcs.len(), "arc"),
        counted(survey.lines, "straight cutting move")
    );
    for group in groups.iter().take(GROUPS_MAX) {
        text += &format!("# {}\n", wording::group(group, findings.unit()));
    }
    if groups.len() > GROUPS_MAX {
        text += &format!("# and {} radii more\n", groups.len() - GROUPS_MAX);
    }
    let own: Vec<Option<i64>> = proposal.tools.iter().map(|tool| tool.number).collect();
    let others: Vec<String> =
        survey.tools.iter().filter(|tool| !own.contains(&Some(**tool))).map(|tool| format!("T{tool}")).collect();
    match (survey.tools.as_slice(), others.as_slice()) {
        ([], _) => text += "# The program names no tool.\n",
        (_, []) => {}
        _ => text += &format!("# Tools that are not in this job keep their feeds: {}.\n", others.join(", ")),
    }
    for excluded in &proposal.excluded {
        text += &format!("# {}\n", wording::exclusion(excluded));
    }
    if !proposal.left_out.is_empty() {
        let left_out: Vec<String> = proposal.left_out.iter().map(|tool| format!("T{tool}")).collect();
        text += &format!("# A job has no room for the arcs of {}.\n", left_out.join(", "));
    }
    text
}

/// Tables of a tool that keeps its feeds until a person completes them.
fn commented_out(tool: &ProposedTool, tables: &str) -> String {
    let number = tool.number.map_or("This tool".into(), |number| format!("T{number}"));
    let lines: String = tables.lines().skip(1).map(|line| format!("# {line}\n")).collect();
    format!(
        "\n# {number} keeps its feeds: its diameter is unknown. To adapt them, answer the question and remove the first # of each line.\n{lines}"
    )
}

fn limits(findings: &Findings<'_>) -> String {
    let Findings { survey, proposal, answers, .. } = *findings;
    let mut text = String::from(
        "\n# No governed block is fed faster than max_feed, nor faster than max_raise times its own F.\n[limits]\n",
    );
    let raise = answers.max_percent.map(|percent| f64::from(percent) / f64::from(PERCENT));
    if proposal.tools.iter().all(|tool| findings.follows_program(tool)) {
        return text + &format!("max_raise = {}\n", raise.unwrap_or(1.0));
    }
    let own = |tool: &ProposedTool| survey.use_of(tool.number).and_then(|used| used.feed_max);
    let highest = proposal.tools.iter().filter_map(own).max().filter(|_| !answers.feeds_per_tooth.is_empty());
    match highest {
        Some(highest) => {
            let raised = highest.to_mm() * raise.unwrap_or(1.0);
            text += &format!("# The highest F of these tools{}.\n", if raise.is_some() { ", raised" } else { "" });
            text += &format!("max_feed = {}\nmax_raise = {}\n", length(raised, findings.unit()), raise.unwrap_or(1.0));
        }
        None => {
            let example = if findings.unit() == LengthUnit::Inch { 100 } else { 3_000 };
            text += &format!(
                "# QUESTION: the fastest feed of these cuts, per minute? For example: max_feed = {example}\nmax_feed = \"?\"\nmax_raise = {}\n",
                raise.unwrap_or(2.0)
            );
        }
    }
    text
}

fn rule(cut: &ProposedCut, table: &str, groups: &[Group], unit: LengthUnit) -> String {
    let arcs: usize = cut.groups.iter().map(|index| groups[*index].arcs).sum();
    let levels: Vec<Nm> = cut.groups.iter().flat_map(|index| groups[*index].levels.clone()).collect();
    let mut radii: Vec<String> = cut.groups.iter().map(|index| length(groups[*index].radius_mm, unit)).collect();
    radii.dedup();
    let mut text =
        format!("\n# {}, R {}, Z {}.\n{table}\n", counted(arcs, "arc"), wording::some(&radii), lengths(&levels, unit));
    let direction = wording::direction(cut.turn);
    match cut.movement {
        Movement::Rotation(rotation, edge) => {
            let rotation = if rotation == RotationCircle::Interior { "interior" } else { "exterior" };
            let side = if edge == Edge::Outer { "outer" } else { "inner" };
            text += &format!(
                "rotation = \"{rotation}\"\ndirection = \"{direction}\"\n# LIKELY, in the published order of movements: the circle that cuts here, \"outer\" or \"inner\".\n\
                 side = \"{side}\"\n# QUESTION: where is the material? Forms: see STOCK above.\nstock = \"?\"\n"
            );
        }
        Movement::Contour(side) => {
            let side = if side == ContourSide::Inside { "inside" } else { "outside" };
            text += &format!("moves = \"arcs\"\ndirection = \"{direction}\"\nside = \"{side}\"\n");
        }
    }
    text
}
