//! Output of a cup-mill plan: text and JSON.

use std::fmt::Write as _;

use arcfeed_plan::cup_mill::level::{Stop, StopSurface};
use arcfeed_plan::cup_mill::normal_form::StartEdge;
use arcfeed_plan::cutter::ToolPart;
use arcfeed_plan::proof::clearance::{Clearance, Obstacle};
use serde::Serialize;

use super::plan_result::PlanResult;
use super::refusal::wider_ring;

/// Results of a cup-mill plan as `arcfeed plan cup-mill --json` prints them (docs/json.md). Lengths are in mm, angles
/// in degrees, volumes in mm3, times in minutes; coordinates are those of the slot unless stated.
#[derive(Debug, Serialize)]
pub struct Figures {
    /// Name of the part.
    pub name: String,
    /// Number of the pass through the slots, from 1.
    pub pass: usize,
    /// The proof shows that the tool collides with nothing.
    pub safe: bool,
    /// Direction of the tool's axis in the coordinates of the part.
    pub tool_axis: [f64; 3],
    /// Position of the machine's axis A (tilt).
    pub tilt_deg: f64,
    /// Position of the machine's axis B at which the first slot is machined.
    pub index_deg: f64,
    /// Number of slots that the program cuts: those of one kind.
    pub slots: u32,
    /// Kind of these slots: 1 at the pressure side of the main blade, 2 at that of the splitter.
    pub slot: i32,
    /// Number of kinds of slots, each of which needs its own plan.
    pub slot_kinds: i32,
    /// Clearance of the ring to each of the two blades, over the part `depth_ratio` of the slot's depth.
    pub room_mm: f64,
    /// `leading` or `trailing`: the blade edges near which the ring turns about its pivots.
    pub start_edge: &'static str,
    /// Part of the slot's depth, as a fraction from the blades' tips down, along which the ring passes.
    pub depth_ratio: f64,
    /// C: base position of the mill's centre, in which the ring touches both blades.
    pub base_mm: [f64; 2],
    /// A: pivot of the exterior turn.
    pub exterior_mm: [f64; 2],
    /// B1: pivot of the interior turn.
    pub interior_mm: [f64; 2],
    /// Levels of the path, from the top down.
    pub levels: Vec<LevelFigures>,
    /// Clearances of the parts of the tool from the obstacles.
    pub clearances: Vec<ClearanceFigures>,
    /// Material removed from a slot.
    pub removed: RemovedFigures,
    /// Time of one slot on the planned path.
    pub slot_min: f64,
    /// Time of one slot by flank milling, for comparison; `None` if that was not computed.
    pub baseline_slot_min: Option<f64>,
}

/// One level of a cup-mill path: a turn about A and a turn about B1 at the same height.
#[derive(Debug, Serialize)]
pub struct LevelFigures {
    /// Height of the tool's lower end.
    pub height_mm: f64,
    /// D: position of the mill's centre at the end of the exterior turn.
    pub exterior_end_mm: [f64; 2],
    /// Angle of the exterior turn, about A.
    pub exterior_deg: f64,
    /// Reason why the exterior turn ends there.
    pub exterior_stop: String,
    /// E: position of the mill's centre at the end of the interior turn.
    pub interior_end_mm: [f64; 2],
    /// Angle of the interior turn, about B1.
    pub interior_deg: f64,
    /// Reason why the interior turn ends there.
    pub interior_stop: String,
}

/// Clearance between a part of the tool and an obstacle over the whole path.
#[derive(Debug, Serialize)]
pub struct ClearanceFigures {
    /// Part of the tool: `ring`, `body` or `holder`.
    pub part: String,
    /// Obstacle: `blades`, `hub`, `fixture` or `blank`.
    pub obstacle: String,
    /// Proven lower bound of the distance.
    pub certified_mm: f64,
    /// Smallest distance that was found, which is not below the bound.
    pub found_mm: f64,
}

/// Material removed from a slot.
#[derive(Debug, Serialize)]
pub struct RemovedFigures {
    /// Volume removed from the blank in all.
    pub total_mm3: f64,
    /// Volume of the slot that is to be removed: between the allowances, within the blank.
    pub slot_mm3: f64,
    /// Fraction of `slot_mm3` that the path removes from what earlier passes have left.
    pub share_ratio: f64,
    /// The same fraction for this pass and all earlier ones together.
    pub with_earlier_ratio: f64,
    /// Thickest material that remains above the allowance: on the pressure side, the suction side and the hub.
    pub left_max_mm: [f64; 3],
    /// Smallest thickness of the remaining material above the allowance, in the same order; negative where the ring has
    /// cut into the allowance.
    pub left_min_mm: [f64; 3],
}

impl Figures {
    /// Results of a plan.
    pub fn of(composed: &PlanResult) -> Self {
        let plan = &composed.valued.plan;
        let left = [&composed.proof.left.pressure, &composed.proof.left.suction, &composed.proof.left.hub];
        let levels = plan.path.levels.iter().zip(&plan.stops).map(|(level, [exterior, interior])| LevelFigures {
            height_mm: level.height_mm,
            exterior_end_mm: level.exterior_end.into(),
            exterior_deg: exterior.turn_rad.to_degrees(),
            exterior_stop: stop_reason(exterior),
            interior_end_mm: level.interior_end.into(),
            interior_deg: interior.turn_rad.to_degrees(),
            interior_stop: stop_reason(interior),
        });
        let near = composed.proof.clearances.iter().filter(|found| found.place.is_some());
        Figures {
            name: composed.part.name.clone(),
            pass: composed.number(),
            safe: composed.is_safe(),
            tool_axis: plan.tool_axis().into(),
            tilt_deg: composed.placement.tilt_deg,
            index_deg: composed.placement.index_deg,
            slots: composed.part.blisk.blades,
            slot: composed.part.slot,
            slot_kinds: composed.part.blisk.kinds(),
            room_mm: plan.free_width.per_side_mm,
            start_edge: edge_word(plan.start),
            depth_ratio: plan.depth_ratio(),
            base_mm: plan.base.centre.into(),
            exterior_mm: plan.base.exterior.into(),
            interior_mm: plan.interior.pivot.into(),
            levels: levels.collect(),
            clearances: near.map(clearance).collect(),
            removed: RemovedFigures {
                total_mm3: composed.proof.removed.total_mm3(),
                slot_mm3: composed.proof.removed.slot_mm3,
                share_ratio: composed.proof.removed.share_ratio(),
                with_earlier_ratio: composed.with_earlier_ratio,
                left_max_mm: left.map(|map| map.range_mm()[1]),
                left_min_mm: left.map(|map| map.range_mm()[0]),
            },
            slot_min: composed.time.slot.cutting_min,
            baseline_slot_min: composed.baseline.as_ref().ok().map(|baseline| baseline.time.cutting_min),
        }
    }
}

fn clearance(found: &Clearance) -> ClearanceFigures {
    let [certified_mm, found_mm] = found.bounds_mm;
    ClearanceFigures {
        part: part_word(found.part).into(),
        obstacle: obstacle_word(found.obstacle).into(),
        certified_mm,
        found_mm,
    }
}

/// Name of these edges in the JSON and on the page.
pub fn edge_word(start: StartEdge) -> &'static str {
    match start {
        StartEdge::Leading => "leading",
        StartEdge::Trailing => "trailing",
    }
}

/// Phrase for a part of the slot's depth.
pub fn depth_phrase(depth_ratio: f64) -> String {
    if depth_ratio < 1.0 {
        format!(
            "over the upper {:.0} % of the blades' height, farther down the ring does not pass: the rest is left to another tool",
            100.0 * depth_ratio
        )
    } else {
        "over the whole depth".into()
    }
}

/// Name of the part of the tool in the JSON and on the page.
pub fn part_word(part: ToolPart) -> &'static str {
    match part {
        ToolPart::Ring => "ring",
        ToolPart::Body => "body",
        ToolPart::Holder => "holder",
    }
}

/// Name of the obstacle in the JSON and on the page.
pub fn obstacle_word(obstacle: Obstacle) -> &'static str {
    match obstacle {
        Obstacle::Blades => "blades",
        Obstacle::Hub => "hub",
        Obstacle::Fixture => "fixture",
        Obstacle::Blank => "blank",
    }
}

/// Reason why a turn ends, in words.
pub fn stop_reason(stop: &Stop) -> String {
    match stop.at {
        None => "as far as the level below".into(),
        Some((surface, ..)) => match surface {
            StopSurface::Pressure => "pressure side".into(),
            StopSurface::Suction => "suction side".into(),
            StopSurface::Hub => "hub".into(),
            // Blade 0 is that of the slot's pressure side.
            StopSurface::Blade(blade, side) => format!("{side} of blade {blade:+}"),
        },
    }
}

/// Slots, levels, and the tool's axis in words.
fn heading(composed: &PlanResult, figures: &Figures) -> String {
    let plan = &composed.valued.plan;
    format!(
        "{}{}: {} slots, {} levels of {:.3} mm\n  tool: A {:.3} degrees, B {:.3} for the first slot; {:.3} mm of room on each side {}\n  the ring turns near the blades' {} edges\n",
        figures.name,
        if figures.pass > 1 { format!(", pass {}", figures.pass) } else { String::new() },
        figures.slots,
        figures.levels.len(),
        plan.path.levels.first().zip(plan.path.levels.get(1)).map_or(0.0, |(a, b)| a.height_mm - b.height_mm),
        figures.tilt_deg,
        figures.index_deg,
        figures.room_mm,
        depth_phrase(figures.depth_ratio),
        figures.start_edge,
    )
}

/// Removed part of the slot and what remains, in words.
fn taken(figures: &Figures) -> String {
    let removed = &figures.removed;
    let [pressure, suction, hub] = removed.left_max_mm;
    let with_earlier = if figures.pass > 1 {
        format!(", {:.1} % with the earlier passes", 100.0 * removed.with_earlier_ratio)
    } else {
        String::new()
    };
    format!(
        "  taken: {:.1} % of the slot between the allowances ({:.2} of {:.2} cm3){with_earlier}; left above them at most {pressure:.2} mm on the \
         pressure side, {suction:.2} on the suction side, {hub:.2} on the hub",
        100.0 * removed.share_ratio,
        removed.share_ratio * removed.slot_mm3 / 1e3,
        removed.slot_mm3 / 1e3,
    )
}

/// Text of the plan for people.
pub fn text(composed: &PlanResult, figures: &Figures) -> String {
    let mut text = heading(composed, figures);
    let _ =
        writeln!(text, "  level  height, mm   D, degrees about A, ended by            E, degrees about B1, ended by");
    for (index, level) in figures.levels.iter().enumerate() {
        let _ = writeln!(
            text,
            "  {:>5}  {:>10.3}   {:>8.3}  {:<27}    {:>8.3}  {}",
            index + 1,
            level.height_mm,
            level.exterior_deg,
            level.exterior_stop,
            level.interior_deg,
            level.interior_stop
        );
    }
    let _ = writeln!(text, "  clearances over the whole way, mm, at least:");
    for found in &figures.clearances {
        let _ = writeln!(text, "    {:<6} from {:<8} {:>9.3}", found.part, found.obstacle, found.certified_mm);
    }
    let _ = writeln!(text, "{}", taken(figures));
    text.extend(composed.part.both_slots().map(|sentence| format!("  {sentence}\n")));
    let cutter = &composed.part.cutter;
    if composed.part.passes_max == 1
        && let Some(hint) = wider_ring(cutter.outer_radius_mm - cutter.inner_radius_mm, figures.room_mm)
    {
        let _ = writeln!(text, "  {hint}");
    }
    let whole = if figures.slot_kinds > 1 { "these slots" } else { "the part" };
    let _ = write!(
        text,
        "  time: {:.1} min a slot, {:.0} min {whole}, without indexing",
        figures.slot_min,
        f64::from(figures.slots) * figures.slot_min
    );
    match &composed.baseline {
        Ok(baseline) => {
            let minutes = baseline.time.cutting_min;
            let _ = write!(
                text,
                "; flank milling {minutes:.1} min a slot ({} passes), {:.1} times as long",
                baseline.passes.passes,
                minutes / figures.slot_min
            );
        }
        Err(why) => {
            let _ = write!(text, "; not compared: {why}");
        }
    }
    text
}

/// Reason why no files are written for this plan, in words.
pub fn refusal(composed: &PlanResult) -> String {
    let allowance_mm = composed.part.roughing.allowance_mm;
    let touched: Vec<String> = composed
        .proof
        .open()
        .map(|found| format!("the {} touches the {}", part_word(found.part), obstacle_word(found.obstacle)))
        .collect();
    if !touched.is_empty() {
        return format!("{}; nothing is written", touched.join(", "));
    }
    if composed.proof.indexing_mm <= 0.0 {
        return "the lifted tool is not above all that turns while the part is indexed; raise `clearance`; nothing is written".into();
    }
    let nearest = composed.proof.clearance(ToolPart::Ring, Obstacle::Blades).map_or(0.0, |found| found.bounds_mm[0]);
    format!(
        "the ring comes as near as {nearest:.3} mm to a finished blade, of {allowance_mm:.3} mm that are to be left; nothing is written"
    )
}
