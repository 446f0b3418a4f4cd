//! Data of the viewer on the page of a plan of plunges: the moves of the first passage, its blades and hub, the mill, and the closest
//! places. Frame of the rotor.

use arcfeed_plan::geometry::mesh::finished;
use arcfeed_plan::output::plunge_nc::{PlungeMove, in_part, plunge_moves};
use arcfeed_plan::plunge::passage_plan::Plunge;
use arcfeed_plan::plunge::proof::PlungeClearance;
use arcfeed_plan::proof::search::Place;
use arcfeed_plan::vector::Point;
use arcfeed_units::LengthUnit;

use super::super::figures::obstacle_word;
use super::super::planned_path::{CHORD_MM, PathPoint, RUN, mill_outline, run, solid, timed};
use super::super::slot_frame::BESIDE_PITCHES;
use super::figures::{family_word, mill_part_word};
use super::result::PlungeResult;
use crate::report::page::viewer::{RunFinding, ViewerData};

/// Purposes of moves at a feed.
const PURPOSES: [&str; 3] = ["approach", "plunge", "off the wall"];

/// Data of the viewer.
pub fn data(result: &PlungeResult) -> ViewerData {
    let (part, unit) = (&result.part, result.part.output.unit);
    let moves = moves(result);
    let points = points(result, &moves);
    let mill = &part.mill;
    let end_mm = [mill.radius_mm, mill.corner_radius_mm, mill.length_mm];
    let reach_rad = (0.5 + BESIDE_PITCHES) * part.blisk.pitch_rad();
    let shown = finished(&part.blisk, &result.sector(reach_rad), [0, 1], CHORD_MM);
    ViewerData {
        title: format!("Plan: {}", part.name),
        unit: unit.label(),
        runs: vec![run(unit, &points)],
        tools: vec![mill_outline(unit, end_mm, mill.neck_mm.iter().chain(&mill.holder_mm))],
        heights: None,
        solids: vec![solid(unit, "blades and hub", &shown)],
        findings: findings(result, &points),
        lines: moves.iter().map(|moved| line(result, moved)).map(|line| [line.clone(), line]).collect(),
        purposes: &PURPOSES,
        is_live: false,
    }
}

/// Move of a plunge, by the plunge's index.
struct PlannedMove {
    plunge: usize,
    to: Point,
    feed_mm_per_min: Option<f64>,
    purpose: Option<usize>,
}

fn moves(result: &PlungeResult) -> Vec<PlannedMove> {
    let of_plunge = |(index, plunge): (usize, &Plunge)| {
        let moves = plunge_moves(plunge, &result.feeds);
        // A step off the wall is the last move before the way out.
        let off = moves.len().checked_sub(2).filter(|_| plunge.relief_mm != 0.0);
        let planned = |(at, PlungeMove { to, feed_mm_per_min }): (usize, &PlungeMove)| {
            let purpose = match at {
                _ if Some(at) == off => 2,
                1 => 0,
                _ => 1,
            };
            let to = in_part(plunge, to, 0.0);
            PlannedMove {
                plunge: index,
                to,
                feed_mm_per_min: *feed_mm_per_min,
                purpose: feed_mm_per_min.map(|_| purpose),
            }
        };
        moves.iter().enumerate().map(planned).collect::<Vec<_>>()
    };
    result.plan.plunges.iter().enumerate().flat_map(of_plunge).collect()
}

fn points(result: &PlungeResult, moves: &[PlannedMove]) -> Vec<PathPoint> {
    let point = |(index, moved): (usize, &PlannedMove)| PathPoint {
        time_s: 0.0,
        place_mm: moved.to.into(),
        axis: Some(result.plan.plunges[moved.plunge].axis.into()),
        line: index + 1,
        feed_mm_per_min: moved.feed_mm_per_min,
        purpose: moved.purpose,
    };
    timed(moves.iter().enumerate().map(point).collect())
}

/// Line of the list of moves.
fn line(result: &PlungeResult, moved: &PlannedMove) -> Vec<u8> {
    let PlannedMove { plunge, to, feed_mm_per_min, purpose } = moved;
    let unit = result.part.output.unit;
    let family = family_word(result.plan.planes[result.plan.plunges[*plunge].plane].family);
    let [x, y, z] = [to.x, to.y, to.z].map(|mm| mm / unit.mm());
    let feed = feed_mm_per_min.map_or(String::new(), |feed| format!(" F{}", shown_feed(unit, feed)));
    let purpose = purpose.map_or("rapid", |purpose| PURPOSES[purpose]);
    let [i, j, k]: [f64; 3] = result.plan.plunges[*plunge].axis.into();
    let axis = format!("axis {i:.4} {j:.4} {k:.4}");
    format!("plunge {}, {family}: {purpose}, to X{x:.3} Y{y:.3} Z{z:.3}, {axis}{feed}", plunge + 1).into_bytes()
}

fn shown_feed(unit: LengthUnit, feed_mm_per_min: f64) -> String {
    match unit {
        LengthUnit::Inch => format!("{:.2}", feed_mm_per_min / unit.mm()),
        LengthUnit::Mm => format!("{feed_mm_per_min:.0}"),
    }
}

/// Closest places in order of the certified distance.
fn findings(result: &PlungeResult, points: &[PathPoint]) -> Vec<RunFinding> {
    let mut near: Vec<(&PlungeClearance, &Place)> =
        result.proof.clearances.iter().filter_map(|found| Some((found, found.place.as_ref()?))).collect();
    near.sort_by(|(a, _), (b, _)| a.bounds_mm[0].total_cmp(&b.bounds_mm[0]));
    let open: Vec<&PlungeClearance> = result.proof.open().collect();
    let unit = result.part.output.unit;
    let finding = |(found, place): (&PlungeClearance, &Place)| {
        let plunge = result.plan.plunges.get(found.plunge)?;
        let ([tool, at], mm) = ([place.tool, place.point].map(|place| in_part(plunge, &place, 0.0)), unit.mm());
        let [certified, distance] = found.bounds_mm.map(|distance_mm| distance_mm / mm);
        let reached = nearest(points, &tool)?;
        Some(RunFinding {
            severity: if open.contains(&found) { "alarm" } else { "note" },
            run: RUN,
            block: reached.0 as u32,
            at_s: Some(reached.1),
            place: Some([at.x / mm, at.y / mm, at.z / mm]),
            text: format!(
                "{} to {}, plunge {}: certified {certified:.3} {}, found {distance:.3} {}",
                mill_part_word(found.part),
                obstacle_word(found.obstacle),
                found.plunge + 1,
                unit.label(),
                unit.label()
            ),
        })
    };
    near.into_iter().filter_map(finding).collect()
}

/// Line and time of the place of the path nearest to a position of the tool.
fn nearest(points: &[PathPoint], tool: &Point) -> Option<(usize, f64)> {
    let place = |pair: &[PathPoint]| {
        let [from, to] = [pair[0], pair[1]].map(|point| Point::from(point.place_mm));
        let way = to - from;
        let ratio = ((tool - from).dot(&way) / way.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let time_s = pair[0].time_s + ratio * (pair[1].time_s - pair[0].time_s);
        ((from + way * ratio - tool).norm(), (pair[1].line, time_s))
    };
    points.windows(2).map(place).min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, reached)| reached)
}
