//! Output of the plan of a repair: text and JSON.

use std::fmt::Write as _;

use arcfeed_plan::geometry::edge_strip::BladeEdge;
use arcfeed_plan::geometry::flaws::BladeSide;
use arcfeed_plan::repair::blade::RepairedPart;
use arcfeed_plan::repair::field::FieldNode;
use arcfeed_plan::repair::regions::{Region, RepairBorder};
use arcfeed_plan::repair::registration::DIRECTIONS;
use serde::Serialize;

use super::super::finish::figures::{FinishClearanceFigures, clearances, feeds, range, tilts_deg, write_clearances};
use super::result::RepairResult;

/// Results of a repair plan as `arcfeed plan repair --json` prints them (docs/json.md). Lengths are in mm, angles in
/// degrees.
#[derive(Debug, Serialize)]
pub struct RepairFigures {
    /// Name of the repair.
    pub name: String,
    /// The mill keeps all distances, and the machine can follow the path.
    pub safe: bool,
    /// Part of the blade that is finished: the `pressure` or `suction` side, or both about the `leading` or `trailing` edge.
    pub side: &'static str,
    /// Number of the blade.
    pub blade: u32,
    /// Number of measured points in the file.
    pub points: usize,
    /// Number of the points that lie on this side.
    pub used_points: usize,
    /// Registration: position of the measured blade relative to the nominal one.
    pub registration: RegistrationFigures,
    /// Deviation of the old blade from the nominal surface, which stays; over an edge that of the pressure side.
    pub old_mm: f64,
    /// Deviation of the old suction side, if the repair runs over an edge.
    pub old_suction_mm: Option<f64>,
    /// Start of the transition, and lowest and highest point of the border of the repaired region, as places between
    /// root (0) and tip (1).
    pub places: [f64; 3],
    /// The border runs from edge to edge, so that the allowance of the published method applies.
    pub is_rising: bool,
    /// Allowance in each of the three regions: norm region, transition, repaired region.
    pub regions: [RegionFigures; 3],
    /// Number of finishing passes.
    pub passes: usize,
    /// Number of points of each pass.
    pub points_per_pass: usize,
    /// Smallest and largest distance of neighbouring passes.
    pub stepover_mm: [f64; 2],
    /// Heights of the roughing layers above the nominal surface.
    pub layers_mm: Vec<f64>,
    /// Volume to be removed in the repaired region and in the transition.
    pub removed_mm3: [f64; 2],
    /// Smallest and largest difference between the predicted result and the planned allowance, where material is
    /// removed; `None` if nothing is.
    pub predicted_mm: Option<[f64; 2]>,
    /// Number of points of the tool path.
    pub points_of_path: usize,
    /// Smallest and largest angle between the tool's axis and the normal of the surface.
    pub tilt_deg: [f64; 2],
    /// Target feed at the contact with the surface, mm/min.
    pub target_feed: f64,
    /// Smallest and largest F of the cutting moves, mm/min.
    pub feed: Option<[f64; 2]>,
    /// Time of the feed moves, min.
    pub minutes: f64,
    /// Clearances of the mill.
    pub clearances: Vec<FinishClearanceFigures>,
}

/// Results of a registration: the motion that fits the measured points to the nominal blade.
#[derive(Debug, Serialize)]
pub struct RegistrationFigures {
    /// Names of the directions of motion that the points determined; the other directions are held by the datum.
    pub free: Vec<&'static str>,
    /// Rotation about the middle of the blade.
    pub turn_deg: [f64; 3],
    /// Shift along X, Y and Z.
    pub shift_mm: [f64; 3],
    /// Root mean square of the distances that remain.
    pub rms_mm: f64,
    /// Standard deviations of the free directions, in degrees or mm.
    pub deviations: Vec<f64>,
    /// Condition number of the fit; 1 if no direction is free.
    pub condition: f64,
    /// Number of points that were left out as outliers, those of the weld included.
    pub outliers: usize,
    /// Smallest allowance that a motion within the datum's tolerances can give; `None` if they allow no motion.
    pub even_least_mm: Option<f64>,
}

/// Allowance of one region of a repaired blade.
#[derive(Debug, Serialize)]
pub struct RegionFigures {
    /// `norm`, `transition` or `repaired`.
    pub region: &'static str,
    /// Number of grid points of the surface in the region.
    pub places: usize,
    /// Number of these grid points without a measurement near them.
    pub holes: usize,
    /// Smallest, median and largest allowance before finishing.
    pub before_mm: Option<[f64; 3]>,
    /// Smallest and largest allowance after finishing; `None` (null) where nothing is removed.
    pub left_mm: Option<[f64; 2]>,
}

/// Name of the repaired part in the JSON.
fn part_word(part: RepairedPart) -> &'static str {
    match part {
        RepairedPart::Side(BladeSide::Pressure) => "pressure",
        RepairedPart::Side(BladeSide::Suction) => "suction",
        RepairedPart::Edge(BladeEdge::Leading) => "leading",
        RepairedPart::Edge(BladeEdge::Trailing) => "trailing",
    }
}

/// Name of a region in the JSON and on the page.
pub fn region_word(region: Region) -> &'static str {
    match region {
        Region::Norm => "norm",
        Region::Transition => "transition",
        Region::Repaired => "repaired",
    }
}

impl RepairFigures {
    /// Results of a plan.
    pub fn of(result: &RepairResult) -> Self {
        let (file, plan) = (&result.file, &result.plan);
        let allowance = &plan.regions.allowance;
        RepairFigures {
            name: file.name.clone(),
            safe: result.path.refusal().is_none(),
            side: part_word(file.repaired),
            blade: file.blade,
            points: file.points.len(),
            used_points: result.used,
            registration: registration(result),
            old_mm: allowance.old_mm,
            old_suction_mm: matches!(file.repaired, RepairedPart::Edge(_)).then_some(plan.regions.old_beyond_mm),
            places: [allowance.from_u, allowance.leading_u, allowance.trailing_u],
            is_rising: matches!(plan.regions.border, RepairBorder::Rising { .. }),
            regions: [Region::Norm, Region::Transition, Region::Repaired].map(|region| of_region(result, region)),
            passes: plan.finish.len(),
            points_per_pass: plan.lines.points,
            stepover_mm: plan.lines.steps_mm,
            layers_mm: plan.layers.iter().map(|(height_mm, _)| *height_mm).collect(),
            removed_mm3: plan.removed_mm3,
            predicted_mm: predicted(result),
            points_of_path: result.path.plan.passes.iter().map(Vec::len).sum(),
            tilt_deg: tilts_deg(&result.path),
            target_feed: result.path.target_mm_per_min,
            feed: feeds(&result.path),
            minutes: result.path.minutes,
            clearances: clearances(&result.path),
        }
    }
}

/// Least and greatest difference between prediction and plan, where more stands than is planned.
fn predicted(result: &RepairResult) -> Option<[f64; 2]> {
    let plan = &result.plan;
    let nodes = plan.field.nodes().zip(result.predicted_mm.iter().flatten()).zip(plan.planned_mm.iter().flatten());
    let above = |((node, predicted), planned): ((&FieldNode, &Option<f64>), &Option<f64>)| {
        let planned_mm = (*planned)?;
        node.along_mm.filter(|standing_mm| *standing_mm > planned_mm)?;
        Some((*predicted)? - planned_mm)
    };
    range(&nodes.filter_map(above).collect::<Vec<f64>>())
}

fn registration(result: &RepairResult) -> RegistrationFigures {
    let (file, found) = (&result.file, &result.registration);
    let free = || (0..6).filter(|k| file.free[*k]);
    let deviations = found.deviations();
    RegistrationFigures {
        free: free().map(|k| DIRECTIONS[k]).collect(),
        turn_deg: found.motion.omega_rad.map(f64::to_degrees).into(),
        shift_mm: found.motion.shift_mm.into(),
        rms_mm: found.rms_mm,
        deviations: free().map(|k| if k < 3 { deviations[k].to_degrees() } else { deviations[k] }).collect(),
        condition: found.condition,
        outliers: found.outliers,
        even_least_mm: result.even.map(|motion| motion.least_mm),
    }
}

fn of_region(result: &RepairResult, region: Region) -> RegionFigures {
    let plan = &result.plan;
    let nodes = plan.field.nodes().zip(plan.regions.regions.iter().flatten()).zip(plan.planned_mm.iter().flatten());
    let (mut before, mut left, mut places) = (Vec::new(), Vec::new(), 0);
    for ((node, _), planned) in nodes.filter(|((_, found), _)| **found == region) {
        places += 1;
        before.extend(node.along_mm);
        left.extend(*planned);
    }
    before.sort_unstable_by(f64::total_cmp);
    left.sort_unstable_by(f64::total_cmp);
    RegionFigures {
        region: region_word(region),
        places,
        holes: places - before.len(),
        before_mm: before.first().zip(before.last()).map(|(low, high)| [*low, before[before.len() / 2], *high]),
        left_mm: left.first().zip(left.last()).map(|(low, high)| [*low, *high]),
    }
}

/// Figures as text.
pub fn text(figures: &RepairFigures) -> String {
    let found = &figures.registration;
    let mut text = format!(
        "{}: blade {}, {} {}; {} of {} points lie on it\n",
        figures.name,
        figures.blade,
        figures.side,
        if figures.old_suction_mm.is_some() { "edge with both sides" } else { "side" },
        figures.used_points,
        figures.points
    );
    let free = if found.free.is_empty() { "nothing is free".into() } else { found.free.join(", ") };
    let _ = writeln!(
        text,
        "registration: {free}; rms {:.4} mm, condition {:.3}, {} outliers (the weld among them)",
        found.rms_mm, found.condition, found.outliers
    );
    for (direction, deviation) in found.free.iter().zip(&found.deviations) {
        let unit = if direction.starts_with("omega") { "degrees" } else { "mm" };
        let _ = writeln!(text, "  {direction}: standard deviation {deviation:.5} {unit}");
    }
    if let Some(least_mm) = found.even_least_mm {
        let _ = writeln!(text, "most even allowance within the datum's tolerances: {least_mm:.4} mm at least");
    }
    for region in &figures.regions {
        let before = region.before_mm.map_or("not measured".into(), |[low, middle, high]| {
            format!("{low:.3} .. {middle:.3} .. {high:.3} mm stand")
        });
        let left = region
            .left_mm
            .map_or("nothing is taken".into(), |[low, high]| format!("{low:.3} .. {high:.3} mm are left"));
        let _ = writeln!(
            text,
            "{:<10} {:>5} places, {} in holes: {before}; {left}",
            region.region, region.places, region.holes
        );
    }
    let [from, low, high] = figures.places;
    let _ = writeln!(text, "finishing begins at u {from:.4}, the border lies at u {low:.4} .. {high:.4}");
    let _ = writeln!(
        text,
        "{} passes of {} points, {:.3} .. {:.3} mm apart; {} rough layers",
        figures.passes,
        figures.points_per_pass,
        figures.stepover_mm[0],
        figures.stepover_mm[1],
        figures.layers_mm.len()
    );
    let _ = writeln!(
        text,
        "to be taken: {:.1} mm3 in the repaired region, {:.2} mm3 in the transition",
        figures.removed_mm3[0], figures.removed_mm3[1]
    );
    write_path(&mut text, figures);
    text
}

/// Writes what is known of the mill's path.
fn write_path(text: &mut String, figures: &RepairFigures) {
    if let Some([low, high]) = figures.predicted_mm {
        let _ = writeln!(text, "predicted result: {low:.4} .. {high:.4} mm above the planned allowance");
    }
    let RepairFigures { points_of_path, tilt_deg: [least, greatest], target_feed, minutes, .. } = figures;
    let _ = writeln!(
        text,
        "path: {points_of_path} points, angle between tool axis and normal {least:.1} .. {greatest:.1} degrees, {minutes:.1} min of feed moves"
    );
    if let Some([low, high]) = figures.feed {
        let _ = writeln!(text, "  feed {target_feed:.1} mm/min wanted, F {low:.1} to {high:.1}");
    }
    write_clearances(text, &figures.clearances);
}
