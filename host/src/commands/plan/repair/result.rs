//! Repair plan with the registration that precedes it.

use arcfeed_plan::finish::access::{BladeAccess, outward};
use arcfeed_plan::finish::obstacles::{FinishBody, FinishObstacle, around};
use arcfeed_plan::geometry::face::Face;
use arcfeed_plan::geometry::mesh::Triangle;
use arcfeed_plan::repair::blade::{NominalBlade, sides};
use arcfeed_plan::repair::evenness::{AllowancePlace, EvenMotion, most_even};
use arcfeed_plan::repair::field::AllowanceField;
use arcfeed_plan::repair::plan::{RepairPlan, plan};
use arcfeed_plan::repair::prediction::predicted_mm;
use arcfeed_plan::repair::regions::{Region, regions};
use arcfeed_plan::repair::registration::{NominalFoot, Registration, RegistrationSettings, RigidMotion, register};
use arcfeed_plan::repair::solids::{LEFT_CHORD_MM, STOCK_CHORD_MM, left_blade, standing_blade};
use arcfeed_plan::repair::tool_path::tool_path;
use arcfeed_plan::vector::Point;

use super::super::finish::result::{FinishResult, check_rotor, clearances};
use crate::console::note;
use crate::part::repair::RepairFile;

/// Most points of a registration; of more points every k-th is taken.
const REGISTERED_MAX: usize = 10_000;
/// Repetitions of the linear program for the most even allowance.
const EVEN_ROUNDS: usize = 2;

/// Repair plan of one blade side with everything derived from it.
pub struct RepairResult {
    /// Content of the repair file.
    pub file: RepairFile,
    /// Registration of the measured points on the nominal blade.
    pub registration: Registration,
    /// Additional motion that makes the allowance most even, if the datum's tolerances allow any.
    pub even: Option<EvenMotion>,
    /// Number of measured points on the side.
    pub used: usize,
    /// Allowances and finishing passes.
    pub plan: RepairPlan,
    /// Predicted allowance after finishing at each grid point, mm; `None` where it is unknown.
    pub predicted_mm: Vec<Vec<Option<f64>>>,
    /// Blade before and after finishing, as triangles.
    pub solids: [Vec<Triangle>; 2],
    /// Path of the mill, with its proof and feeds.
    pub path: FinishResult,
}

impl RepairResult {
    /// Plans the repair, and evaluates the plan.
    ///
    /// # Errors
    /// The reason why there is no plan.
    pub fn of(file: RepairFile) -> Result<Self, String> {
        check_rotor(&file.part.blisk)?;
        let faces = sides(&file.part.blisk, file.blade);
        let blade = NominalBlade::new([&faces[0], &faces[1]], &file.part.blisk);
        blade.check(&file.points, file.blade, file.stylus_mm).map_err(|fault| fault.to_string())?;
        let registration = registration(&file, &blade, &faces[0])?;
        let mut points: Vec<Point> = file.points.iter().map(|point| registration.motion.moved(point)).collect();
        let mut even = None;
        for _ in 0..if file.tolerance.is_some() { EVEN_ROUNDS } else { 0 } {
            let found = evened(&file, &blade, &points, &registration.motion.centre)?;
            let centre = registration.motion.centre;
            let motion = RigidMotion { centre, omega_rad: found.omega_rad, shift_mm: found.shift_mm };
            points.iter_mut().for_each(|point| *point = motion.moved(point));
            even = Some(found);
        }
        let samples = blade.heights(&points, file.side, file.stylus_mm).map_err(|fault| fault.to_string())?;
        let plan = plan(blade.side(file.side), &samples, &file.settings).map_err(|why| why.to_string())?;
        let predicted_mm = predicted_mm(&plan, file.part.mill.radius_mm);
        note(format_args!("planning the path, then proving every move of the whole mill"));
        let solids = [standing_blade, left_blade].map(|solid| solid(&file.part.blisk, file.blade, file.side, &plan));
        let path = path(&file, &plan, &solids, &faces[0])?;
        Ok(RepairResult { registration, even, used: samples.len(), plan, predicted_mm, solids, path, file })
    }
}

/// Path of the mill, with its proof against the blade as it will be; neck and holder keep their distance from the weld, too.
fn path(
    file: &RepairFile,
    plan: &RepairPlan,
    [standing, left]: &[Vec<Triangle>; 2],
    face: &Face,
) -> Result<FinishResult, String> {
    let mut part = file.part.clone();
    part.name.clone_from(&file.name);
    part.needs.sampling.tolerance_mm /= 2.0;
    let own = vec![
        FinishBody::fixed(FinishObstacle::Blade, left.clone(), LEFT_CHORD_MM),
        FinishBody::fixed(FinishObstacle::Stock, standing.clone(), STOCK_CHORD_MM),
    ];
    let bodies = around(&part.blisk, file.blade, own, &part.fixtures);
    let access = BladeAccess {
        mill: &part.mill,
        needs: &part.needs,
        bodies: &bodies,
        outward: outward(face),
        blank_radius_mm: part.blisk.blank.radius_mm,
    };
    let path = tool_path(plan, &access).map_err(|why| why.to_string())?;
    let clearances = clearances(&path, &access);
    Ok(FinishResult::proven(part, path, clearances))
}

fn registration(file: &RepairFile, blade: &NominalBlade<'_>, face: &Face) -> Result<Registration, String> {
    let every = file.points.len().div_ceil(REGISTERED_MAX).max(1);
    let registered: Vec<Point> = file.points.iter().step_by(every).copied().collect();
    let settings = RegistrationSettings {
        centre: face.point(0.5, 0.5),
        free: file.free,
        is_robust: true,
        uncertainty_mm: file.uncertainty_mm,
    };
    let foot = |point: &Point| {
        let NominalFoot { point, normal } = blade.foot(point);
        NominalFoot { point: point + normal * file.stylus_mm, normal }
    };
    register(&registered, &settings, foot).map_err(|error| error.to_string())
}

/// Motion that makes the repaired region's allowance most even.
fn evened(file: &RepairFile, blade: &NominalBlade<'_>, points: &[Point], centre: &Point) -> Result<EvenMotion, String> {
    let nominal = blade.side(file.side);
    let samples = blade.heights(points, file.side, file.stylus_mm).map_err(|fault| fault.to_string())?;
    let heights = file.settings.height_field(nominal, &samples);
    let field = AllowanceField::new(nominal, &heights, file.settings.spacing_mm).map_err(|error| error.to_string())?;
    let found = regions(nominal.surface(), &field, &file.settings.regions).ok_or("nothing is repaired on this side")?;
    let of_repair =
        field.nodes().zip(found.regions.iter().flatten()).filter(|(_, region)| **region == Region::Repaired);
    let places: Vec<AllowancePlace> = of_repair
        .filter_map(|(node, _)| {
            let allowance_mm = node.along_mm?;
            Some(AllowancePlace { point: node.point, normal: node.normal, allowance_mm })
        })
        .collect();
    let tolerance = file.tolerance.as_ref().ok_or("the datums allow no motion")?;
    most_even(&places, centre, tolerance).ok_or_else(|| "the most even allowance was not found".into())
}
