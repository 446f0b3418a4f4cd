//! Data of the viewer on the page of a plan: the path through one slot, blades and hub, the tool, ends of the turns and closest
//! places. Slot frame.

use arcfeed_plan::cutter::CupMill;
use arcfeed_plan::geometry::mesh::{Triangle, finished};
use arcfeed_plan::path::{Purpose, Step};
use arcfeed_plan::proof::clearance::Clearance;
use arcfeed_units::LengthUnit;

use super::figures::{obstacle_word, part_word, stop_reason};
use super::plan_result::{PlanResult, feeds};
use super::planned_path::{CHORD_MM, PathPoint, RUN, outside, run, seconds, solid};
use super::slot_frame::{blades, in_slot, sector};
use crate::report::page::viewer::{RunFinding, ViewerData};

/// Points of an arc; a line has both ends.
const POINTS: u32 = 33;
/// Purposes of moves at a feed, as the viewer shows them.
const PURPOSES: [&str; 5] = ["movement 1", "movement 2", "movement 3", "movement 4", "to this level"];

/// Data of the viewer.
pub fn data(composed: &PlanResult) -> ViewerData {
    let unit = composed.part.output.unit;
    let steps = composed.valued.plan.path.steps();
    let feed_mm_per_min = feeds(&composed.part).cutting_mm_per_min;
    let ends_s = ends_s(&steps, feed_mm_per_min);
    ViewerData {
        title: format!("Plan: {}", composed.part.name),
        unit: unit.label(),
        runs: vec![run(unit, &points(&steps, &ends_s, feed_mm_per_min))],
        tools: vec![outline(&composed.part.cutter).map(|[r, h]| [r / unit.mm(), h / unit.mm()]).collect()],
        heights: None,
        solids: vec![solid(unit, "blades and hub", &in_slot(composed, finished_part(composed)))],
        findings: findings(composed, &steps, &ends_s),
        lines: steps.iter().map(|step| line(unit, step)).map(|line| [line.clone(), line]).collect(),
        purposes: &PURPOSES,
        is_live: false,
    }
}

fn finished_part(composed: &PlanResult) -> Vec<Triangle> {
    finished(&composed.part.blisk, &sector(composed), blades(composed), CHORD_MM)
}

/// Time at the end of each step, all at the cutting feed.
fn ends_s(steps: &[Step], feed_mm_per_min: f64) -> Vec<f64> {
    let time_s = |step: &Step| seconds(step.length_mm(), None, feed_mm_per_min);
    let sum = |sum: &mut f64, step: &Step| {
        *sum += time_s(step);
        Some(*sum)
    };
    steps.iter().scan(0.0, sum).collect()
}

fn points(steps: &[Step], ends_s: &[f64], feed_mm_per_min: f64) -> Vec<PathPoint> {
    let mut points = Vec::new();
    for (index, step) in steps.iter().enumerate() {
        let begin_s = index.checked_sub(1).map_or(0.0, |before| ends_s[before]);
        let count = if step.about.is_some() { POINTS } else { 2 };
        let purpose = purpose_index(step.purpose);
        let places = step.places(count).into_iter().enumerate().skip(usize::from(index > 0));
        points.extend(places.map(|(k, place_mm)| {
            let ratio = k as f64 / f64::from(count - 1);
            let time_s = begin_s + ratio * (ends_s[index] - begin_s);
            let feed_mm_per_min = purpose.map(|_| feed_mm_per_min);
            PathPoint { time_s, place_mm, axis: None, line: index + 1, feed_mm_per_min, purpose }
        }));
    }
    points
}

/// Closed outline, from the bottom of the ring outside, up the holder, and down the cavity.
fn outline(mill: &CupMill) -> impl Iterator<Item = [f64; 2]> + use<> {
    let (inner_mm, depth_mm) = (mill.inner_radius_mm, mill.cavity_depth_mm);
    let up = outside(mill.outer_radius_mm, mill.height_mm, &mill.holder_mm);
    let cavity = [[0.0, depth_mm], [inner_mm, depth_mm], [inner_mm, 0.0]];
    std::iter::once([mill.outer_radius_mm, 0.0]).chain(up).chain(cavity)
}

/// Line of the list of steps.
fn line(unit: LengthUnit, step: &Step) -> Vec<u8> {
    let [x, y, z] = step.to.map(|mm| mm / unit.mm());
    format!("level {}: {}, to X{x:.3} Y{y:.3} Z{z:.3}", step.level + 1, purpose(step.purpose)).into_bytes()
}

const fn purpose(purpose: Purpose) -> &'static str {
    match purpose {
        Purpose::Approach => "down",
        Purpose::Entry => "into the blank",
        Purpose::Movement1 => "movement 1, about B1",
        Purpose::Movement2 => "movement 2, about A",
        Purpose::Movement3 => "movement 3, about A",
        Purpose::Movement4 => "movement 4, about B1",
        Purpose::Link => "to this level",
        Purpose::Retract => "up",
    }
}

/// Index in [`PURPOSES`]; `None` for rapids.
const fn purpose_index(purpose: Purpose) -> Option<usize> {
    match purpose {
        Purpose::Approach | Purpose::Retract => None,
        Purpose::Movement1 => Some(0),
        Purpose::Movement2 => Some(1),
        Purpose::Movement3 => Some(2),
        Purpose::Movement4 => Some(3),
        Purpose::Entry | Purpose::Link => Some(4),
    }
}

/// Closest places in order of the certified distance, then the ends of the turns.
fn findings(composed: &PlanResult, steps: &[Step], ends_s: &[f64]) -> Vec<RunFinding> {
    let mut near: Vec<&Clearance> = composed.proof.clearances.iter().filter(|found| found.place.is_some()).collect();
    near.sort_by(|a, b| a.bounds_mm[0].total_cmp(&b.bounds_mm[0]));
    let unit = composed.part.output.unit;
    let closest = near.into_iter().filter_map(|found| {
        let place = found.place.as_ref()?;
        let (step, mm) = (steps.get(place.step)?, unit.mm());
        let begin_s = place.step.checked_sub(1).map_or(0.0, |before| ends_s[before]);
        let ratio = (place.way_mm / step.length_mm().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let [certified, distance] = found.bounds_mm.map(|distance_mm| distance_mm / mm);
        Some(RunFinding {
            severity: if found.bounds_mm[0] > 0.0 { "note" } else { "alarm" },
            run: RUN,
            block: place.step as u32 + 1,
            at_s: Some(begin_s + ratio * (ends_s[place.step] - begin_s)),
            place: Some([place.point.x / mm, place.point.y / mm, place.point.z / mm]),
            text: format!(
                "{} to {}: certified {certified:.3} {}, found {distance:.3} {}",
                part_word(found.part),
                obstacle_word(found.obstacle),
                unit.label(),
                unit.label()
            ),
        })
    });
    let stops = &composed.valued.plan.stops;
    let ends = steps.iter().zip(ends_s).enumerate().filter_map(|(index, (step, end_s))| {
        let [exterior, interior] = stops.get(step.level)?;
        let (stop, centre) = match step.purpose {
            Purpose::Movement2 => (exterior, "A"),
            Purpose::Movement4 => (interior, "B1"),
            _ => return None,
        };
        Some(RunFinding {
            severity: "note",
            run: RUN,
            block: index as u32 + 1,
            at_s: Some(*end_s),
            place: None,
            text: format!("level {}, end of the turn about {centre}: {}", step.level + 1, stop_reason(stop)),
        })
    });
    closest.chain(ends).collect()
}
