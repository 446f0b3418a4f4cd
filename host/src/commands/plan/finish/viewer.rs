//! Data of the viewer on the pages of finishing passes and of repairs: the path of the mill, solids, closest places, and the findings of
//! the post-processor. Frame of the rotor; all lengths in millimetres, as in the program.

use arcfeed_kinematics::forward::ToolPose;
use arcfeed_plan::finish::access::{FinishMove, MoveKind};
use arcfeed_plan::finish::proof::FinishClearance;
use arcfeed_plan::geometry::blisk::Blisk;
use arcfeed_plan::geometry::mesh::{Triangle, finished};
use arcfeed_plan::vector::Point;
use arcfeed_units::LengthUnit;

use super::super::planned_path::{CHORD_MM, PathPoint, RUN, mill_outline, run, timed};
use super::super::slot_frame::{BESIDE_PITCHES, sector_about};
use super::result::{FinishResult, obstacle_word, part_word};
use crate::post::cl::ClPoint;
use crate::program::Severity;
use crate::report::page::viewer::{RunFinding, Solid, ViewerData};

/// Unit of the page.
pub const UNIT: LengthUnit = LengthUnit::Mm;
/// Purposes of moves at a feed.
const PURPOSES: [&str; 2] = ["approach, link", "cut"];

/// Data of the viewer with these solids.
pub fn data(title: String, result: &FinishResult, solids: Vec<Solid>) -> ViewerData {
    let mill = &result.part.mill;
    let end_mm = [mill.radius_mm, mill.corner_radius_mm, mill.length_mm];
    let steps = || result.cl.points.iter().zip(&result.plan.path);
    ViewerData {
        title,
        unit: UNIT.label(),
        runs: vec![run(UNIT, &points(steps()))],
        tools: vec![mill_outline(UNIT, end_mm, mill.neck_mm.iter().chain(&mill.holder_mm))],
        heights: None,
        solids,
        findings: findings(result),
        lines: steps().map(line).map(|line| [line.clone(), line]).collect(),
        purposes: &PURPOSES,
        is_live: false,
    }
}

/// Triangles of a blade of the rotor, by its index, with its neighbours and the hub about them.
pub fn surroundings(blisk: &Blisk, index: i32) -> Vec<Triangle> {
    let Point { coords } = blisk.blade(index).pressure.point(0.5, 0.5);
    let (middle_rad, reach_rad) = (libm::atan2(coords.y, coords.x), (1.0 + BESIDE_PITCHES) * blisk.pitch_rad());
    finished(blisk, &sector_about(blisk, middle_rad, reach_rad), [index - 1, index + 1], CHORD_MM)
}

fn points<'a>(steps: impl Iterator<Item = (&'a ClPoint, &'a FinishMove)>) -> Vec<PathPoint> {
    let point = |(ClPoint { line, pose, feed_mm_per_min }, step): (&ClPoint, &FinishMove)| {
        let ToolPose { tip_mm: place_mm, axis } = *pose;
        let purpose = feed_mm_per_min.map(|_| usize::from(step.kind == MoveKind::Cut));
        let (axis, line, feed_mm_per_min) = (Some(axis), *line, *feed_mm_per_min);
        PathPoint { time_s: 0.0, place_mm, axis, line, feed_mm_per_min, purpose }
    };
    timed(steps.map(point).collect())
}

/// Line of the list of moves.
fn line((point, step): (&ClPoint, &FinishMove)) -> Vec<u8> {
    let ToolPose { tip_mm: [x, y, z], axis: [i, j, k] } = point.pose;
    let purpose = match step.kind {
        MoveKind::Rapid => "rapid",
        MoveKind::Link => "link",
        MoveKind::Cut => "cut",
    };
    let feed = point.feed_mm_per_min.map_or(String::new(), |feed| format!(" F{feed:.1}"));
    format!("move {}: {purpose}, to X{x:.3} Y{y:.3} Z{z:.3}, axis {i:.4} {j:.4} {k:.4}{feed}", point.line).into_bytes()
}

/// Closest places in order of the distance that is left beyond the needed one, then the findings of the post-processor.
fn findings(result: &FinishResult) -> Vec<RunFinding> {
    let mut near: Vec<&FinishClearance> = result.clearances.iter().filter(|found| found.place.is_some()).collect();
    let left_mm = |found: &FinishClearance| found.certified_mm - found.needed_mm;
    near.sort_by(|a, b| left_mm(a).total_cmp(&left_mm(b)));
    // The last move leads back above the part, behind the last point of the path.
    let last = result.cl.points.len();
    let closest = near.into_iter().map(|found| RunFinding {
        severity: if found.holds() { "note" } else { "alarm" },
        run: RUN,
        block: (found.at + 1).min(last) as u32,
        at_s: None,
        place: found.place.map(Into::into),
        text: format!(
            "{} to {}, move {}: certified {:.3} mm, needed {:.3} mm",
            part_word(found.part),
            obstacle_word(found.obstacle),
            found.at + 1,
            found.certified_mm,
            found.needed_mm
        ),
    });
    let of_machine = result.axes.findings.iter().map(|finding| RunFinding {
        severity: if finding.severity() == Severity::Error { "alarm" } else { "warning" },
        run: RUN,
        block: finding.line as u32,
        at_s: None,
        place: None,
        text: format!("move {finding}"),
    });
    closest.chain(of_machine).collect()
}
