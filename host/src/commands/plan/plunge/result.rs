//! Plan of plunges with its proof, the machinability of the passage, and the position of the rotary axes.

use arcfeed_plan::cup_mill::side::edges;
use arcfeed_plan::frame::slot_frame;
use arcfeed_plan::geometry::flaws::flaws;
use arcfeed_plan::output::plunge_nc::{IndexAxis, PlungeFeeds, plunging_min};
use arcfeed_plan::placement::{any_table, placement};
use arcfeed_plan::plunge::field::Field;
use arcfeed_plan::plunge::machinability::{SideMeasures, Widths, camber_twist_rad, widths};
use arcfeed_plan::plunge::passage::Passage;
use arcfeed_plan::plunge::plan::PassagePlan;
use arcfeed_plan::plunge::proof::{PlungeProof, prove};
use arcfeed_plan::vector::Vector;

use crate::part::plunge::PlungePart;

/// Difference of two tool axes by which the sense of the indexing axis is found, rad.
const TURN_RAD: f64 = 0.01;

/// Measures of the passage.
pub struct Machinability {
    /// Pressure and suction side.
    pub sides: [SideMeasures; 2],
    /// Twist of the camber lines.
    pub camber_twist_rad: f64,
    /// Widths.
    pub widths: Widths,
}

/// Plan of one part and its evaluation.
pub struct PlungeResult {
    /// Part file.
    pub part: PlungePart,
    /// Measures of the passage.
    pub machinability: Machinability,
    /// Plan of one passage.
    pub plan: PassagePlan,
    /// Proof of the plan.
    pub proof: PlungeProof,
    /// A
    pub tilt_deg: f64,
    /// B
    pub index: IndexAxis,
    /// Feeds.
    pub feeds: PlungeFeeds,
    /// Time of the feed moves of one passage.
    pub passage_min: f64,
}

impl PlungeResult {
    /// Plans a part.
    ///
    /// # Errors
    /// Describes why there is no plan.
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
        let passage = Passage { blisk: &part.blisk, field: &field, mill: &part.mill, needs: &part.needs, turning_mm };
        let plan = passage.plan().map_err(|why| why.to_string())?;
        let (tilt_deg, index) = rotary(&part, &plan)?;
        let proof = prove(&part.blisk, &part.mill, &plan.plunges, part.needs.allowance_mm, &part.fixtures);
        let cutting = f64::from(part.mill.teeth) * part.feeds.per_tooth_mm * part.feeds.rev_per_min;
        let feeds = PlungeFeeds {
            plunge_mm_per_min: cutting,
            approach_mm_per_min: part.feeds.approach_mm_per_min.unwrap_or(cutting),
        };
        let passage_min = plunging_min(&plan.plunges, &feeds);
        Ok(PlungeResult { machinability: machinability(&part), plan, proof, tilt_deg, index, feeds, passage_min, part })
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

/// Positions of the rotary axes: the tool's axis lies across the rotor's, so one of them stands still.
fn rotary(part: &PlungePart, plan: &PassagePlan) -> Result<(f64, IndexAxis), String> {
    let any = any_table().map_err(|error| format!("{error:?}"))?;
    let machine = part.machine.as_ref().map_or(&any, |file| &file.machine);
    let at = |angle_rad: f64| {
        let (sin, cos) = libm::sincos(angle_rad);
        let turn = slot_frame(&Vector::new(cos, sin, 0.0)).ok_or("the tool's axis lies along the rotor's")?;
        placement(machine, &turn).map_err(|error| error.to_string())
    };
    let axis = plan.plunges.first().map_or(Vector::x(), |plunge| plunge.axis);
    let angle_rad = libm::atan2(axis.y, axis.x);
    let (here, beside) = (at(angle_rad)?, at(angle_rad + TURN_RAD)?);
    let turned_deg = libm::remainder(beside.index_deg - here.index_deg, 360.0);
    let sign = turned_deg.signum();
    Ok((here.tilt_deg, IndexAxis { sign, zero_deg: here.index_deg - sign * angle_rad.to_degrees() }))
}
