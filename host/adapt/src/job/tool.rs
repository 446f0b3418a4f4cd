//! `[tool]` and `[[tool]]`: the cutter, the source of its speed, and its `[law]`.

use arcfeed_model::job::{LawKind, SpeedSource, TOOLS_MAX, ToolAxis, ToolSetup, Tools};
use arcfeed_model::tool::{CupMill, EndMill, Tool};
use arcfeed_units::{LengthUnit, MmPerTooth, Nm, PERCENT, RevPerMin};
use toml::Spanned;

use super::schema::{JobTable, LawTable, TargetFeed, ToolTable};
use super::{Complaint, at, length_mm, positive};

/// Name of the law that governs nothing but descending moves: it has a table of its own, `[plunge]`.
pub const PLUNGE_LAW: &str = "plunge";

/// Largest T number: eight digits.
const NUMBER_MAX: i64 = 99_999_999;

/// Lowest feed of the contour law where the job states none, as a fraction of the target (docs/laws.md#contour).
const CONTOUR_FLOOR_RATIO: f32 = 0.2;

/// Checks the tool. Its teeth need not be known if `follows_program`: the feed does not depend on them.
fn build(table: &ToolTable, unit: LengthUnit, follows_program: bool) -> Result<Tool, Complaint> {
    let ToolTable { kind, outer_radius, inner_radius, active_teeth, diameter, teeth, .. } = table;
    match (kind.as_ref().as_str(), outer_radius, inner_radius, active_teeth, diameter, teeth) {
        ("cup-mill", Some(outer), Some(inner), Some(teeth), None, None) => {
            let outer_mm = length_mm(outer, unit, "outer_radius")?;
            let inner_mm = length_mm(inner, unit, "inner_radius")?;
            if inner_mm >= outer_mm {
                return Err(at(inner, "inner_radius must be less than outer_radius"));
            }
            let (outer_radius, inner_radius) = (Nm::from_mm(outer_mm), Nm::from_mm(inner_mm));
            Ok(Tool::CupMill(CupMill { outer_radius, inner_radius, active_teeth: some_teeth(teeth)? }))
        }
        ("end-mill", None, None, None, Some(diameter), teeth) if teeth.is_some() || follows_program => {
            let radius = Nm::from_mm(length_mm(diameter, unit, "diameter")? / 2.0);
            Ok(Tool::EndMill(EndMill { radius, teeth: teeth.as_ref().map_or(Ok(1), some_teeth)? }))
        }
        ("cup-mill", ..) => Err(at(kind, "a cup-mill has outer_radius, inner_radius and active_teeth")),
        ("end-mill", ..) => Err(at(kind, "an end-mill has diameter and teeth")),
        _ => Err(at(kind, "no such tool; write \"cup-mill\" or \"end-mill\"")),
    }
}

/// Builds a tool with its number, spindle and law; the job's `[spindle]` and `[law]` apply to a tool without its own.
pub fn setup(table: &ToolTable, job: &JobTable) -> Result<ToolSetup, Complaint> {
    let unit = job.units.into();
    let missing = |name: &str, keys: &str| {
        at(&table.kind, &format!("the tool has no [{name}]: add a table [{name}] with {keys}"))
    };
    let spindle = table.spindle.as_ref().or(job.spindle.as_ref()).ok_or_else(|| missing("spindle", "rev_per_min"))?;
    let given = table.law.as_ref().or(job.law.as_ref()).ok_or_else(|| missing("law", "kind and feed_per_tooth"))?;
    let rev_per_min = positive(&spindle.rev_per_min, "the spindle speed")?;
    let (feed_mm, follows_program) = target(given, job)?;
    let tool = build(table, unit, follows_program)?;
    let number = match &table.number {
        Some(number) if !(0..=NUMBER_MAX).contains(number.as_ref()) => {
            return Err(at(number, &format!("number is the tool's T word: 0 to {NUMBER_MAX}")));
        }
        number => number.as_ref().map(|number| *number.as_ref()),
    };
    let axis = match table.axis.as_ref().map(|axis| (axis, axis.as_ref().as_str())) {
        None | Some((_, "z")) => ToolAxis::Z,
        Some((_, "y")) => ToolAxis::Y,
        Some((_, "x")) => ToolAxis::X,
        Some((axis, _)) => return Err(at(axis, "axis is \"x\", \"y\" or \"z\": what the tool turns about")),
    };
    let speed_source = match spindle.set_by.as_ref().map(|by| (by, by.as_ref().as_str())) {
        None | Some((_, "program")) => SpeedSource::Program,
        Some((_, "operator")) => SpeedSource::Operator,
        Some((by, _)) => return Err(at(by, "set_by is \"program\" (S and M3 in it) or \"operator\"")),
    };
    let law = law(given, &tool)?;
    let (spindle, feed_per_tooth) = (RevPerMin(rev_per_min as f32), MmPerTooth(feed_mm as f32));
    Ok(ToolSetup { number, axis, speed_source, follows_program, ..ToolSetup::new(tool, spindle, law, feed_per_tooth) })
}

/// Target feed per tooth of a law, mm, and whether each block's F replaces it.
fn target(given: &LawTable, job: &JobTable) -> Result<(f64, bool), Complaint> {
    let feed = &given.feed_per_tooth;
    match *feed.as_ref() {
        TargetFeed::PerTooth(quantity) => {
            let quantity = Spanned::new(feed.span(), quantity);
            Ok((length_mm(&quantity, job.units.into(), "the feed per tooth")?, false))
        }
        TargetFeed::Programmed if given.kind.as_ref() != "contour" => {
            Err(at(feed, "only the contour law takes \"programmed\"; write the wanted feed per tooth"))
        }
        TargetFeed::Programmed if job.r#override.mode.as_ref() != "rewrite-only" => Err(at(
            feed,
            "\"programmed\" needs [override] mode = \"rewrite-only\": a board at the override does not know the F of the \
             program; write that mode, or the wanted feed per tooth",
        )),
        // Any positive value: the F of the block replaces it.
        TargetFeed::Programmed => Ok((1.0, true)),
    }
}

/// All tools of a job, in order; fails at the first faulty value. If there are several, each needs a number.
pub fn setups(job: &JobTable) -> Result<Tools, Complaint> {
    let tables = &job.tool.0;
    let [first, more @ ..] = tables.as_slice() else {
        return Err((0, "the job has no tool: add a table [tool]".into()));
    };
    let mut tools = Tools::one(setup(first, job)?);
    for table in more {
        let setup = setup(table, job)?;
        if let Some(number) = table.number.as_ref().filter(|_| tools.iter().any(|other| other.number == setup.number)) {
            return Err(at(number, "another [[tool]] has this number: each T number stands once"));
        }
        tools.push(setup).map_err(|_| at(&table.kind, &format!("a job has at most {TOOLS_MAX} tools")))?;
    }
    match tables.iter().find(|table| tables.len() > 1 && table.number.is_none()) {
        Some(table) => Err(at(&table.kind, "of several tools each needs `number`, its T word in the program")),
        None => Ok(tools),
    }
}

fn some_teeth(teeth: &Spanned<u16>) -> Result<u16, Complaint> {
    match *teeth.as_ref() {
        0 => Err(at(teeth, "a tool needs at least one active tooth")),
        teeth => Ok(teeth),
    }
}

/// Feed law from `[law]`; fails if it does not suit the tool.
pub fn law(table: &LawTable, tool: &Tool) -> Result<LawKind, Complaint> {
    let kind = table.kind.as_ref().as_str();
    let settings = (&table.edges, table.inside_only, &table.floor);
    match (kind, tool, settings) {
        ("programmed" | PLUNGE_LAW, _, (None, None, None)) => Ok(LawKind::Programmed),
        ("table", _, (None, None, None)) => Ok(LawKind::Table),
        ("circumference", Tool::CupMill(_), (None, None, None)) => Ok(LawKind::Circumference),
        ("engaged-arc", Tool::CupMill(_), (edges, None, None)) => {
            match edges.as_ref().map(|edges| edges.as_ref().as_str()) {
                None | Some("both") => Ok(LawKind::EngagedArc { both_edges: true }),
                Some("side") => Ok(LawKind::EngagedArc { both_edges: false }),
                Some(_) => Err(at(&table.kind, "edges must be \"both\" or \"side\" (the one the cut rule names)")),
            }
        }
        ("engaged-arc", Tool::EndMill(_), (None, None, None)) => Ok(LawKind::EngagedArc { both_edges: false }),
        ("engagement", Tool::EndMill(_), (None, None, None)) => Ok(LawKind::Engagement),
        ("contour", Tool::EndMill(_), (None, inside_only, floor)) => {
            let floor_ratio = floor.as_ref().map_or(CONTOUR_FLOOR_RATIO, |floor| *floor.as_ref() / PERCENT);
            match floor {
                Some(floor) if !(0.0..=1.0).contains(&floor_ratio) => Err(at(floor, "floor must be 0 to 100 %")),
                _ => Ok(LawKind::Contour { inside_only: inside_only.unwrap_or(true), floor_ratio }),
            }
        }
        ("engaged-arc", Tool::EndMill(_), (Some(edges), ..)) => Err(at(edges, "an end-mill has one circle only")),
        ("circumference", Tool::EndMill(_), _) => Err(at(&table.kind, "this law needs a cup-mill")),
        ("engagement" | "contour", Tool::CupMill(_), _) => Err(at(&table.kind, "this law needs an end-mill")),
        ("circumference" | "engaged-arc" | "engagement" | "contour" | "table" | "programmed" | PLUNGE_LAW, ..) => {
            Err(at(
                &table.kind,
                "`edges` belongs to engaged-arc, `inside_only` and `floor` to contour; remove what does not",
            ))
        }
        _ => Err(at(
            &table.kind,
            "no such law; write \"circumference\" (cup mills), \"contour\" or \"engagement\" (end mills), \"engaged-arc\", \
             \"table\", \"plunge\" or \"programmed\"",
        )),
    }
}
