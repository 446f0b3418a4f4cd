//! Report page of a plan.

use arcfeed_plan::proof::clearance::Clearance as Found;
use arcfeed_plan::proof::remaining::Map;
use arcfeed_plan::vector::Point;

use super::figures::{depth_phrase, edge_word, obstacle_word, part_word, refusal, stop_reason};
use super::plan_result::PlanResult;
use crate::report::page::plan::{Axis, Clearance, LeftMap, Outline, PlanReport, PlanVerdict, Removed, Stops, Times};

/// Number of points of an outline.
const OUTLINE: u32 = 40;

/// Content of the report page of a cup-mill plan.
pub fn report(composed: &PlanResult) -> PlanReport {
    let plan = &composed.valued.plan;
    let direction = plan.tool_axis();
    let near = composed.proof.clearances.iter().filter(|found| found.place.is_some());
    let stops = plan
        .stops
        .iter()
        .map(|[exterior, interior]| Stops { exterior: stop_reason(exterior), interior: stop_reason(interior) });
    PlanReport {
        name: composed.part.name.clone(),
        unit: composed.part.output.unit,
        verdict: verdict(composed),
        axis: Axis {
            direction: direction.into(),
            tilt_deg: composed.placement.tilt_deg,
            first_deg: composed.placement.index_deg,
            slots: composed.part.blisk.blades,
        },
        mill: composed.part.cutter.clone(),
        path: plan.path.clone(),
        stops: stops.collect(),
        limits: composed.limits.clone(),
        times: Times { planned: composed.time.clone(), baseline: composed.baseline.clone() },
        clearances: near.map(clearance).collect(),
        removed: Some(Removed {
            available_mm3: composed.proof.removed.slot_mm3,
            removed_mm3: composed.proof.removed.slot_removed_mm3(),
            levels_mm3: composed.proof.removed.slot_by_level_mm3.clone(),
        }),
        left: left(composed),
        outlines: outlines(composed),
    }
}

fn verdict(composed: &PlanResult) -> PlanVerdict {
    let is_safe = composed.is_safe();
    let mut sentences = Vec::new();
    if is_safe {
        sentences.push(
            "Ring, body and holder touch nothing on the whole way of a slot, and the part can be indexed.".into(),
        );
    } else {
        sentences.push(refusal(composed));
    }
    let plan = &composed.valued.plan;
    if plan.free_width == plan.blade_free_width {
        sentences.push("The tool lies along the blade's edge (LN3).".into());
    } else {
        let degrees = plan.blade_axis.direction.angle(&plan.tool_axis()).to_degrees();
        sentences.push(format!(
            "The tool is tilted by {degrees:.1} degrees from the blade's edge (LN3): the ring has {:.2} mm of room on each side, {:.2} mm along \
             the edge.",
            plan.free_width.per_side_mm, plan.blade_free_width.per_side_mm
        ));
    }
    sentences.extend(composed.part.both_slots());
    sentences.push(format!("The ring turns near the blades' {} edges.", edge_word(plan.start)));
    if plan.depth_ratio() < 1.0 {
        sentences.push(format!("The path leads {}.", depth_phrase(plan.depth_ratio())));
    }
    PlanVerdict { is_safe, sentences }
}

fn clearance(found: &Found) -> Clearance {
    let [certified_mm, found_mm] = found.bounds_mm;
    let place = found.place.as_ref().map_or(String::new(), |place| {
        let [x, y, z] = [place.point.x, place.point.y, place.point.z];
        format!("piece {} of the way, at X{x:.2} Y{y:.2} Z{z:.2} mm", place.step + 1)
    });
    let (part, obstacle) = (part_word(found.part).into(), obstacle_word(found.obstacle).into());
    Clearance { part, obstacle, certified_mm, found_mm, place }
}

fn left(composed: &PlanResult) -> Vec<LeftMap> {
    let left = &composed.proof.left;
    let along = |low: &str, high: &str| ["leading edge", "trailing edge", low, high].map(String::from);
    let map = |surface: &str, map: &Map, sides| LeftMap {
        surface: surface.into(),
        sides,
        columns: map.columns,
        values_mm: map.values_mm.iter().copied().map(Some).collect(),
    };
    vec![
        map("pressure side", &left.pressure, along("hub", "tip")),
        map("suction side", &left.suction, along("hub", "tip")),
        map("hub", &left.hub, along("pressure side", "suction side")),
    ]
}

/// Sections of both blades at the tip and at the hub, seen along the tool.
fn outlines(composed: &PlanResult) -> Vec<Outline> {
    let blisk = &composed.part.blisk;
    let turn = composed.valued.plan.turn;
    let section = |index: i32, v: f64| -> Vec<[f64; 2]> {
        let blade = blisk.blade(index);
        let share = |k: u32| f64::from(k) / f64::from(OUTLINE);
        let pressure = (0..=OUTLINE).map(|k| blade.pressure.point(share(k), v));
        let suction = (0..=OUTLINE).rev().map(|k| blade.suction.point(share(k), v));
        let seen = |point: Point| (turn * point).xy().into();
        pressure.chain(suction).map(seen).collect()
    };
    let blades = [(0, "blade"), (blisk.facing(), "next blade")];
    let places = blades.into_iter().flat_map(|(index, name)| [(index, name, 1.0, "tip"), (index, name, 0.0, "hub")]);
    places
        .map(|(index, name, v, end)| Outline { name: format!("{name}, {end}"), points_mm: section(index, v) })
        .collect()
}
