//! Repair plan with the registration that precedes it.

use arcfeed_plan::finish::access::{BladeAccess, outward};
use arcfeed_plan::finish::obstacles::{FinishBody, FinishObstacle, around};
use arcfeed_plan::geometry::edge_strip::EdgeStrip;
use arcfeed_plan::geometry::face::Face;
use arcfeed_plan::geometry::flaws::BladeSide;
use arcfeed_plan::geometry::mesh::Triangle;
use arcfeed_plan::repair::blade::{NominalBlade, RepairedPart, sides};
use arcfeed_plan::repair::cloud_check::{check_edges, check_outliers, check_tip};
use arcfeed_plan::repair::evenness::{AllowancePlace, EvenMotion, most_even};
use arcfeed_plan::repair::field::{AllowanceField, FieldNode};
use arcfeed_plan::repair::plan::{RepairPlan, RepairSettings, plan};
use arcfeed_plan::repair::prediction::predicted_mm;
use arcfeed_plan::repair::regions::{Region, regions};
use arcfeed_plan::repair::registration::{NominalFoot, Registration, RegistrationSettings, RigidMotion, register};
use arcfeed_plan::repair::scan::{HeightSample, NominalSurface};
use arcfeed_plan::repair::solids::{
    LEFT_CHORD_MM, STOCK_CHORD_MM, left_blade, left_edge, standing_blade, standing_edge,
};
use arcfeed_plan::repair::tool_path::tool_path;
use arcfeed_plan::vector::Point;

use super::super::finish::result::{FinishResult, check_rotor, clearances};
use crate::console::note;
use crate::part::repair::RepairFile;

/// Most points of a registration; of more points every k-th is taken.
const REGISTERED_MAX: usize = 10_000;
/// Repetitions of the linear program for the most even allowance.
const EVEN_ROUNDS: usize = 2;

/// Repair plan of one blade side, or of both about an edge, with everything derived from it.
pub struct RepairResult {
    /// Content of the repair file.
    pub file: RepairFile,
    /// Registration of the measured points on the nominal blade.
    pub registration: Registration,
    /// Additional motion that makes the allowance most even, if the datum's tolerances allow any.
    pub even: Option<EvenMotion>,
    /// Number of measured points on that part.
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
        let nominal = Nominal::new(&blade, [&faces[0], &faces[1]], file.repaired)?;
        blade.check(&file.points, file.blade, file.stylus_mm).map_err(|fault| fault.to_string())?;
        let registration = registration(&file, &blade, &faces[0])?;
        let mut points: Vec<Point> = file.points.iter().map(|point| registration.motion.moved(point)).collect();
        let mut even = None;
        for _ in 0..if file.tolerance.is_some() { EVEN_ROUNDS } else { 0 } {
            let found = nominal.evened(&file, &points, &registration.motion.centre)?;
            let centre = registration.motion.centre;
            let motion = RigidMotion { centre, omega_rad: found.omega_rad, shift_mm: found.shift_mm };
            points.iter_mut().for_each(|point| *point = motion.moved(point));
            even = Some(found);
        }
        let samples = nominal.heights(&points, file.stylus_mm)?;
        nominal.check_points(&file, &points, &samples)?;
        let plan = nominal.plan(&samples, &file.settings)?;
        nominal.check_edges(&file, &points)?;
        let predicted_mm = predicted_mm(&plan, file.part.mill.radius_mm);
        note(format_args!("planning the path, then proving every move of the whole mill"));
        let solids = nominal.solids(&file, &plan);
        let path = path(&file, &plan, &solids, &faces[0])?;
        // They borrow the file.
        drop(nominal);
        drop(blade);
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
        machine: &part.machine.machine,
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

/// Nominal surface of the part that is repaired.
enum Nominal<'b, 'f> {
    Side(&'b NominalBlade<'f>, BladeSide),
    Edge { blade: &'b NominalBlade<'f>, strip: EdgeStrip<'f>, surface: NominalSurface<'f> },
}

impl<'b, 'f> Nominal<'b, 'f> {
    fn new(blade: &'b NominalBlade<'f>, faces: [&'f Face; 2], repaired: RepairedPart) -> Result<Self, String> {
        match repaired {
            RepairedPart::Side(side) => Ok(Nominal::Side(blade, side)),
            RepairedPart::Edge(edge) => {
                let strip = EdgeStrip::new(faces, edge).map_err(|open| open.to_string())?;
                let surface = NominalSurface::new(strip.clone());
                Ok(Nominal::Edge { blade, strip, surface })
            }
        }
    }

    fn surface(&self) -> &NominalSurface<'f> {
        match self {
            Nominal::Side(blade, side) => blade.side(*side),
            Nominal::Edge { surface, .. } => surface,
        }
    }

    fn heights(&self, points: &[Point], stylus_mm: f64) -> Result<Vec<HeightSample>, String> {
        let found = match self {
            Nominal::Side(blade, side) => blade.heights(points, *side, stylus_mm),
            Nominal::Edge { blade, surface, .. } => blade.edge_heights(points, surface, stylus_mm),
        };
        found.map_err(|fault| fault.to_string())
    }

    fn check_points(&self, file: &RepairFile, points: &[Point], samples: &[HeightSample]) -> Result<(), String> {
        let off_mm = file.settings.regions.threshold_mm;
        let most_mm = file.stylus_mm + off_mm;
        let found = check_outliers(samples, self.surface(), off_mm);
        found.and_then(|()| check_tip(points, self.surface(), most_mm)).map_err(|fault| fault.to_string())
    }

    fn check_edges(&self, file: &RepairFile, points: &[Point]) -> Result<(), String> {
        let Nominal::Side(blade, side) = self else { return Ok(()) };
        let most_mm = file.stylus_mm + file.settings.regions.threshold_mm;
        check_edges(points, blade, *side, most_mm).map_err(|fault| fault.to_string())
    }

    fn plan(&self, samples: &[HeightSample], settings: &RepairSettings) -> Result<RepairPlan, String> {
        plan(self.surface(), samples, settings).map_err(|why| why.to_string())
    }

    /// Blade before and after finishing.
    fn solids(&self, file: &RepairFile, plan: &RepairPlan) -> [Vec<Triangle>; 2] {
        let (blisk, blade) = (&file.part.blisk, file.blade);
        match self {
            Nominal::Side(_, side) => [standing_blade, left_blade].map(|solid| solid(blisk, blade, *side, plan)),
            Nominal::Edge { strip, .. } => {
                [standing_edge(blisk, blade, strip, plan), left_edge(blisk, blade, strip, plan)]
            }
        }
    }

    /// Motion that makes the repaired region's allowance most even.
    fn evened(&self, file: &RepairFile, points: &[Point], centre: &Point) -> Result<EvenMotion, String> {
        let samples = self.heights(points, file.stylus_mm)?;
        let places = places(self.surface(), &samples, &file.settings)?;
        let tolerance = file.tolerance.as_ref().ok_or("the datums allow no motion")?;
        most_even(&places, centre, tolerance).ok_or_else(|| "the most even allowance was not found".into())
    }
}

/// Places of the repaired region with their allowances.
fn places(
    nominal: &NominalSurface<'_>,
    samples: &[HeightSample],
    settings: &RepairSettings,
) -> Result<Vec<AllowancePlace>, String> {
    let heights = settings.height_field(nominal, samples);
    let field = AllowanceField::new(nominal, &heights, settings.spacing_mm).map_err(|error| error.to_string())?;
    let found = regions(nominal.surface(), &field, &settings.regions).ok_or("nothing is repaired on this side")?;
    let of_repair =
        field.nodes().zip(found.regions.iter().flatten()).filter(|(_, region)| **region == Region::Repaired);
    let place = |(node, _): (&FieldNode, &Region)| {
        let allowance_mm = node.along_mm?;
        Some(AllowancePlace { point: node.point, normal: node.normal, allowance_mm })
    };
    Ok(of_repair.filter_map(place).collect())
}
