//! Plan of plunges with its proof, the machinability of the passage, and the position of the rotary axes.

use arcfeed_kinematics::machine::Machine;
use arcfeed_plan::cup_mill::side::edges;
use arcfeed_plan::frame::slot_frame;
use arcfeed_plan::geometry::flaws::flaws;
use arcfeed_plan::geometry::mesh::Sector;
use arcfeed_plan::output::plunge_nc::{AngleRelation, PlungeFeeds, plunging_min, tool_angles_rad};
use arcfeed_plan::placement::{PlacementError, any_table, check_places, placement};
use arcfeed_plan::plunge::assembly::{ball_mm, corner_mm};
use arcfeed_plan::plunge::field::Field;
use arcfeed_plan::plunge::left_over::{LeftOverRow, left_over};
use arcfeed_plan::plunge::machinability::{SideMeasures, Widths, camber_twist_rad, widths};
use arcfeed_plan::plunge::mill::PlungeMill;
use arcfeed_plan::plunge::passage::Passage;
use arcfeed_plan::plunge::passage_plan::PassagePlan;
use arcfeed_plan::plunge::proof::{PlungeProof, prove};
use arcfeed_plan::vector::Vector;

use super::super::slot_frame::sector_about;
use crate::part::plunge::PlungePart;

/// Difference of two tool axes by which the sense of a rotary axis is found, rad.
const TURN_RAD: f64 = 0.01;
/// Angle of a tool's axis up to which its frame follows from it alone, rad; beyond, it lies along the rotor's.
const STEEPEST_RAD: f64 = core::f64::consts::FRAC_PI_2 - 1e-5;
/// Difference of positions of an axis that are the same, degrees.
const SAME_DEG: f64 = 0.01;

/// Measures of a passage that decide how it can be machined.
pub struct Machinability {
    /// Measures of the pressure side and of the suction side.
    pub sides: [SideMeasures; 2],
    /// Twist of the blades' camber lines, rad.
    pub camber_twist_rad: f64,
    /// Distances between the two sides.
    pub widths: Widths,
}

/// Plan for one passage with everything derived from it.
pub struct PlungeResult {
    /// Content of the part file.
    pub part: PlungePart,
    /// Measures of the passage.
    pub machinability: Machinability,
    /// Plunges of one passage.
    pub plan: PassagePlan,
    /// Allowance beyond the part's own that the plunges leave on the blades.
    pub left_over: Vec<LeftOverRow>,
    /// Proof that the mill touches nothing that it must not cut.
    pub proof: PlungeProof,
    /// Relations of the rotary axes A and B to the angles of the tool in the part.
    pub rotary: [AngleRelation; 2],
    /// Feeds of the program.
    pub feeds: PlungeFeeds,
    /// Time of the feed moves of one passage, min.
    pub passage_min: f64,
}

impl PlungeResult {
    /// Plans the passages of the part, and evaluates the plan.
    ///
    /// # Errors
    /// The reason why there is no plan.
    pub fn of(part: PlungePart) -> Result<Self, String> {
        let found = flaws(&part.blisk, part.needs.allowance_mm);
        if !found.is_empty() {
            let said: Vec<String> = found.iter().map(ToString::to_string).collect();
            return Err(format!("this rotor cannot be planned: {}", said.join("; ")));
        }
        let field = Field::new(&part.blisk);
        let corners = part
            .fixtures
            .iter()
            .map(|[low, high]| libm::hypot(low.x.abs().max(high.x.abs()), low.y.abs().max(high.y.abs())));
        let turning_mm = corners.fold(part.blisk.blank.radius_mm, f64::max);
        let turning_ball_mm = part.fixtures.iter().map(corner_mm).fold(ball_mm(&part.blisk.blank), f64::max);
        let (blisk, mill, needs) = (&part.blisk, &part.mill, &part.needs);
        let passage = Passage { blisk, field: &field, mill, needs, turning_mm, turning_ball_mm };
        let plan = passage.plan().map_err(|why| why.to_string())?;
        let rotary = rotary(&part, &plan)?;
        let proof = prove(&part.blisk, &part.mill, &plan.plunges, part.needs.allowance_mm, &part.fixtures);
        let cutting = f64::from(part.mill.teeth) * part.feeds.per_tooth_mm * part.feeds.rev_per_min;
        let feeds = PlungeFeeds {
            plunge_mm_per_min: cutting,
            approach_mm_per_min: part.feeds.approach_mm_per_min.unwrap_or(cutting),
        };
        let passage_min = plunging_min(&plan.plunges, &feeds);
        let left_over = left_over(&plan, &field, part.mill.radius_mm + part.needs.allowance_mm);
        Ok(PlungeResult {
            machinability: machinability(&part),
            plan,
            left_over,
            proof,
            rotary,
            feeds,
            passage_min,
            part,
        })
    }

    /// Sector of the part to both sides of the middle of the first passage.
    pub fn sector(&self, reach_rad: f64) -> Sector {
        let middle_rad = self.plan.planes.first().map_or(0.0, |plane| plane.boundary.middle_rad);
        sector_about(&self.part.blisk, middle_rad, reach_rad)
    }
}

fn machinability(part: &PlungePart) -> Machinability {
    let slot = part.blisk.slot();
    let ranges = [edges(&part.blisk.pressure), edges(&part.blisk.suction)];
    let sides = [SideMeasures::new(&part.blisk.pressure, ranges[0]), SideMeasures::new(&part.blisk.suction, ranges[1])];
    let both = [ranges[0][0].max(ranges[1][0]), ranges[0][1].min(ranges[1][1])];
    Machinability {
        sides,
        camber_twist_rad: camber_twist_rad(&part.blisk.pressure, &part.blisk.suction, both),
        widths: widths(&slot.pressure, &slot.suction, [0.0, 1.0]),
    }
}

/// Relations of the rotary axes to the tool's angles, for a machine that reaches all plunges with them and with X, Y and Z.
fn rotary(part: &PlungePart, plan: &PassagePlan) -> Result<[AngleRelation; 2], String> {
    let any = any_table().map_err(|error| format!("{error:?}"))?;
    let machine = part.machine.as_ref().map_or(&any, |file| &file.machine);
    let at = |[angle_rad, tilt_rad]: [f64; 2]| {
        let ((sin, cos), (up, out)) = (libm::sincos(angle_rad), libm::sincos(tilt_rad));
        let turn =
            slot_frame(&Vector::new(out * cos, out * sin, up)).ok_or("the tool's axis lies along the rotor's")?;
        placement(machine, &turn).map_err(|error| error.to_string())
    };
    let angles = || plan.plunges.iter().map(|plunge| tool_angles_rad(&plunge.to_tool));
    let angle_rad = angles().next().map_or(0.0, |[angle_rad, _]| angle_rad);
    let (here, beside) = (at([angle_rad, 0.0])?, at([angle_rad + TURN_RAD, 0.0])?);
    // A may end where the tool lies across the rotor's axis. Without either neighbour no plunge is tilted, or the range refuses it below.
    let up = at([angle_rad, TURN_RAD]).map(|above| above.tilt_deg - here.tilt_deg);
    let raised_deg =
        up.or_else(|_| at([angle_rad, -TURN_RAD]).map(|below| here.tilt_deg - below.tilt_deg)).unwrap_or(1.0);
    let sign = |turned_deg: f64| libm::remainder(turned_deg, 360.0).signum();
    let index_sign = sign(beside.index_deg - here.index_deg);
    let relations = [
        AngleRelation { sign: sign(raised_deg), zero_deg: here.tilt_deg },
        AngleRelation { sign: index_sign, zero_deg: here.index_deg - index_sign * angle_rad.to_degrees() },
    ];
    // The steepest axes to either side are the farthest positions of A.
    for tilt_rad in
        [angles().map(|[_, tilt]| tilt).fold(0.0, f64::min), angles().map(|[_, tilt]| tilt).fold(0.0, f64::max)]
    {
        let found = at([angle_rad, tilt_rad.clamp(-STEEPEST_RAD, STEEPEST_RAD)])?;
        let expected_deg = relations[0].sign * tilt_rad.to_degrees() + relations[0].zero_deg;
        if libm::remainder(found.tilt_deg - expected_deg, 360.0).abs() > SAME_DEG {
            return Err(PlacementError::Range { tilt_deg: expected_deg }.to_string());
        }
    }
    check_reach(part, plan, machine)?;
    Ok(relations)
}

/// X, Y and Z reach all plunges of the first passage; in the others the table presents the same places.
fn check_reach(part: &PlungePart, plan: &PassagePlan, machine: &Machine) -> Result<(), String> {
    let PlungeMill { length_mm, neck_mm, holder_mm, .. } = &part.mill;
    let tool_mm = length_mm + neck_mm.iter().chain(holder_mm).map(|[_, length_mm]| length_mm).sum::<f64>();
    let places = plan.plunges.iter().enumerate().flat_map(|(number, plunge)| {
        plunge.places().into_iter().map(move |place| ([place.x, place.y, place.z], number))
    });
    check_places(machine, places, tool_mm, |number| format!("plunge {}", number + 1)).map_err(|error| error.to_string())
}
