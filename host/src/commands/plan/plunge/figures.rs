//! Output of a plan of plunges: text and JSON.

use std::fmt::Write as _;

use arcfeed_plan::plunge::machinability::SideMeasures;
use arcfeed_plan::plunge::mill::MillPart;
use arcfeed_plan::plunge::passage_plan::PlungeFamily;
use serde::Serialize;

use super::super::figures::obstacle_word;
use super::result::PlungeResult;

/// Results of a plunging plan as `arcfeed plan plunge --json` prints them (docs/json.md). Lengths are in mm, angles in degrees, times in
/// minutes, in the coordinates of the part.
#[derive(Debug, Serialize)]
pub struct PlungeFigures {
    /// Name of the part.
    pub name: String,
    /// The mill touches nothing that it must not cut, and keeps the allowance.
    pub safe: bool,
    /// Diameter of the mill.
    pub diameter_mm: f64,
    /// Largest diameter of a mill that passes in all planes along the blade; `None` if none was measured.
    pub largest_diameter_mm: Option<f64>,
    /// Number of passages between blades.
    pub passages: u32,
    /// Number of plunges in one passage.
    pub plunges: usize,
    /// Measures of the passage's two sides: pressure side, suction side.
    pub sides: [SideFigures; 2],
    /// Twist of the blades' camber lines.
    pub camber_twist_deg: f64,
    /// Smallest and largest distance of corresponding points of both sides.
    pub width_mm: [f64; 2],
    /// Smallest distance of both sides.
    pub free_width_mm: f64,
    /// Section planes with plunges, in the order of machining.
    pub planes: Vec<PlaneFigures>,
    /// Largest possible tool in planes along the blade.
    pub largest: Vec<LargestToolFigures>,
    /// Clearances of the mill.
    pub clearances: Vec<PlungeClearanceFigures>,
    /// Largest height by which the flat end of the mill stays above the floor.
    pub lift_max_mm: f64,
    /// Time of the feed moves of one passage.
    pub passage_min: f64,
}

/// Measures of one side of the passage. Pairs of values are for a side that is split at the greatest curvature, and at the point farthest
/// from the chord.
#[derive(Debug, Serialize)]
pub struct SideFigures {
    /// Largest twist.
    pub twist_deg: [f64; 2],
    /// Largest bend.
    pub bend_deg: [f64; 2],
    /// Largest distance from the straight line (sag).
    pub sag_mm: f64,
    /// Depth of the side, from tip to hub.
    pub depth_mm: f64,
}

/// Section plane with its plunges.
#[derive(Debug, Serialize)]
pub struct PlaneFigures {
    /// Kind of plane: `radial`, `lower-face` or `upper-face`.
    pub family: &'static str,
    /// Position of the plane's origin along the rotor's axis; 0 for planes along that axis.
    pub z_mm: f64,
    /// Distance of its origin from the rotor's axis; 0 for planes across it.
    pub radius_mm: f64,
    /// Distance between the two boundary axes (plunges nearest to the blades), at the outer end (roof) and at the floor.
    pub width_mm: [f64; 2],
    /// Angles of both boundary axes from the middle direction of the plane.
    pub tilt_deg: [f64; 2],
    /// Largest allowance beyond the part's own that remains beside the left and the right boundary axis.
    pub left_over_mm: [f64; 2],
    /// Number of plunge positions side by side in the plane.
    pub columns: usize,
    /// Distance of neighbouring plunge positions at the outer end.
    pub spacing_mm: f64,
    /// Distance from the preceding plane, divided by the distance that the permitted cusp allows.
    pub step_ratio: f64,
}

/// Largest tool that fits into the passage in one plane.
#[derive(Debug, Serialize)]
pub struct LargestToolFigures {
    /// Position of the plane along the rotor's axis.
    pub z_mm: f64,
    /// Diameter of that tool.
    pub diameter_mm: f64,
    /// Points of the two blades that it touches.
    pub touching_mm: [[f64; 3]; 2],
}

/// Clearance between a part of the mill and an obstacle over all plunges.
#[derive(Debug, Serialize)]
pub struct PlungeClearanceFigures {
    /// Part of the mill: `cutter`, `neck` or `holder`.
    pub part: String,
    /// Obstacle: `blades`, `hub`, `fixture` or `blank`.
    pub obstacle: String,
    /// Proven lower bound of the distance.
    pub certified_mm: f64,
    /// Smallest distance that was found.
    pub found_mm: f64,
    /// Number of the plunge with that distance, counted from 1.
    pub plunge: usize,
}

impl PlungeFigures {
    /// Results of a plan.
    pub fn of(result: &PlungeResult) -> Self {
        let PlungeResult { part, machinability, plan, proof, .. } = result;
        let least_mm = plan.largest.iter().map(|found| found.radius_mm).fold(f64::INFINITY, f64::min);
        let planes = plan.planes.iter().map(|plane| PlaneFigures {
            family: family_word(plane.family),
            z_mm: plane.z_mm,
            radius_mm: plane.radius_mm,
            width_mm: plane.boundary.widths_mm(),
            tilt_deg: plane.boundary.tilts_rad().map(f64::to_degrees),
            left_over_mm: plane.boundary.gaps_mm(),
            columns: plane.columns,
            spacing_mm: plane.spacing_mm,
            step_ratio: plane.step_ratio,
        });
        let largest = plan.largest.iter().map(|found| LargestToolFigures {
            z_mm: found.z_mm,
            diameter_mm: 2.0 * found.radius_mm,
            touching_mm: found.touching.map(Into::into),
        });
        let clearances = proof.clearances.iter().map(|found| PlungeClearanceFigures {
            part: mill_part_word(found.part).into(),
            obstacle: obstacle_word(found.obstacle).into(),
            certified_mm: found.bounds_mm[0],
            found_mm: found.bounds_mm[1],
            plunge: found.plunge + 1,
        });
        PlungeFigures {
            name: part.name.clone(),
            safe: proof.holds(),
            diameter_mm: 2.0 * part.mill.radius_mm,
            largest_diameter_mm: least_mm.is_finite().then_some(2.0 * least_mm),
            passages: part.blisk.blades,
            plunges: plan.plunges.len(),
            sides: machinability.sides.each_ref().map(side),
            camber_twist_deg: machinability.camber_twist_rad.to_degrees(),
            width_mm: machinability.widths.corresponding_mm,
            free_width_mm: machinability.widths.free_mm,
            planes: planes.collect(),
            largest: largest.collect(),
            clearances: clearances.collect(),
            lift_max_mm: plan.plunges.iter().map(|plunge| plunge.lift_mm).fold(0.0, f64::max),
            passage_min: result.passage_min,
        }
    }

    /// Largest allowance beyond the part's own beside the left and the right boundary axis, mm.
    pub fn left_over_mm(&self) -> [f64; 2] {
        [0, 1].map(|side| self.planes.iter().map(|plane| plane.left_over_mm[side]).fold(0.0, f64::max))
    }
}

fn side(measures: &SideMeasures) -> SideFigures {
    SideFigures {
        twist_deg: measures.twist_rad.map(f64::to_degrees),
        bend_deg: measures.bend_rad.map(f64::to_degrees),
        sag_mm: measures.sag_mm,
        depth_mm: measures.depth_mm,
    }
}

/// Name of a family in the JSON and on the page.
pub fn family_word(family: PlungeFamily) -> &'static str {
    match family {
        PlungeFamily::Radial => "radial",
        PlungeFamily::LowerFace => "lower-face",
        PlungeFamily::UpperFace => "upper-face",
    }
}

/// Name of the part of the mill in the JSON and on the page.
pub fn mill_part_word(part: MillPart) -> &'static str {
    match part {
        MillPart::Cutter => "cutter",
        MillPart::Neck => "neck",
        MillPart::Holder => "holder",
    }
}

/// Text of the plan for people.
pub fn text(figures: &PlungeFigures) -> String {
    let mut text = format!(
        "{}: {} passages, {} planes, {} plunges each, diameter {:.3} mm",
        figures.name,
        figures.passages,
        figures.planes.len(),
        figures.plunges,
        figures.diameter_mm
    );
    let is_radial = figures.planes.iter().all(|plane| plane.family == "radial");
    if let Some(largest_mm) = figures.largest_diameter_mm {
        let whither = if is_radial { "passes" } else { "passes radially" };
        let _ = write!(text, " (the largest that {whither}: {largest_mm:.2} mm)");
    }
    if !is_radial {
        let count = |family: &str| figures.planes.iter().filter(|plane| plane.family == family).count();
        let counted = ["radial", "lower-face", "upper-face"].map(|family| (family, count(family)));
        let named: Vec<String> =
            counted.iter().filter(|(_, count)| *count > 0).map(|(family, count)| format!("{count} {family}")).collect();
        let _ = write!(text, "\n  planes: {}", named.join(", "));
    }
    let _ = writeln!(text, "\n  side      twist, degrees   bend, degrees   sag, mm   depth, mm");
    for (name, side) in ["pressure", "suction"].iter().zip(&figures.sides) {
        let ([twist, _], [bend, _]) = (side.twist_deg, side.bend_deg);
        let _ =
            writeln!(text, "  {name:<8}  {twist:>14.2}  {bend:>14.2}  {:>8.3}  {:>10.2}", side.sag_mm, side.depth_mm);
    }
    let [narrow, wide] = figures.width_mm;
    let _ = writeln!(
        text,
        "  width {narrow:.2} to {wide:.2} mm between corresponding points, {:.2} mm free",
        figures.free_width_mm
    );
    let [left, right] = figures.left_over_mm();
    let _ = writeln!(
        text,
        "  left over for finishing, beyond the allowance: at most {left:.2} mm left, {right:.2} mm right"
    );
    let _ = writeln!(text, "  clearances over all plunges, mm, at least:");
    for found in &figures.clearances {
        let _ = writeln!(text, "    {:<6} from {:<8} {:>9.3}", found.part, found.obstacle, found.certified_mm);
    }
    let _ = write!(
        text,
        "  time: {:.1} min a passage, {:.0} min the part, without rapids and indexing",
        figures.passage_min,
        f64::from(figures.passages) * figures.passage_min
    );
    text
}

/// Reason why no files are written for this plan, in words.
pub fn refusal(result: &PlungeResult) -> String {
    let open: Vec<String> = result
        .proof
        .open()
        .map(|found| {
            let (part, obstacle) = (mill_part_word(found.part), obstacle_word(found.obstacle));
            let plunge = &result.plan.plunges[found.plunge];
            let point = found.place.map(|place| plunge.to_tool.inverse() * place.point);
            let at = point.map_or(String::new(), |at| format!(", at ({:.2}, {:.2}, {:.2})", at.x, at.y, at.z));
            let distance_mm = found.bounds_mm[0];
            if part == "cutter" && distance_mm > 0.0 {
                format!(
                    "the cutter comes as near as {distance_mm:.3} mm to the {obstacle} in plunge {}{at}",
                    found.plunge + 1
                )
            } else {
                format!(
                    "the {part} touches the {obstacle} in plunge {}, {:.3} mm deep{at}",
                    found.plunge + 1,
                    -distance_mm
                )
            }
        })
        .collect();
    let least_mm = result.plan.largest.iter().map(|found| found.radius_mm).fold(f64::INFINITY, f64::min);
    let has_faces = result.plan.planes.iter().any(|plane| plane.family != PlungeFamily::Radial);
    let radially = if has_faces && least_mm.is_finite() {
        format!("; radially the largest mill that passes everywhere has a diameter of {:.2} mm", 2.0 * least_mm)
    } else {
        String::new()
    };
    format!("{}{radially}; nothing is written", open.join("; "))
}
