//! Volume that the published tool's path removes, compared with the simulator's dexels, which share no method with the proof.

use arcfeed_dexel::frame::Frame;
use arcfeed_dexel::motion::{Move, Pose};
use arcfeed_dexel::section::Sweep;
use arcfeed_dexel::solid::Revolved;
use arcfeed_dexel::tool::Tool;
use arcfeed_dexel::workpiece::{Stock, Volume};
use arcfeed_plan::cup_mill::plan::{SlotPlan, plan};
use arcfeed_plan::cutter::CupMill;
use arcfeed_plan::geometry::blisk::Blisk;
use arcfeed_plan::path::Step;
use arcfeed_plan::proof::earlier::Earlier;
use arcfeed_plan::proof::floor::Floor;
use arcfeed_plan::proof::remaining::SlotWalls;
use arcfeed_plan::proof::removal;
use arcfeed_plan::vector::{Point, Vector};
use nalgebra::Rotation3;

use crate::proof_cases::published_tool;
use crate::proof_published::{ALLOWANCE_MM, ROUGHING};
use crate::published_rotor;

/// Between rays, and of the columns.
const STEP_MM: f64 = 0.5;
/// Error of arcs as straight sweeps, and of the inserts' corners as cones.
const TOLERANCE_MM: f64 = 0.01;
const MEMORY_MAX: usize = 1 << 30;

/// Dexels of the published rotor's blank, slot frame of a plan.
pub struct Dexels {
    stock: Stock,
    ring: Tool,
}

fn upright([x, y, z]: [f64; 3]) -> Pose {
    Pose { tip_mm: [x, y, z], axis: [0.0, 0.0, 1.0] }
}

fn moved(step: &Step) -> Move {
    let (from, to) = (upright(step.from), upright(step.to));
    let Some((centre, _)) = step.about else { return Move::Straight { from, to } };
    let [a, b] = [step.from, step.to].map(|at| Point::from(at).xy() - centre);
    let angle_rad = libm::atan2(a.perp(&b), a.dot(&b));
    Move::Turn { from, center_mm: [centre.x, centre.y, 0.0], normal: [0.0, 0.0, 1.0], angle_rad, rise_mm: 0.0 }
}

impl Dexels {
    pub fn new(blisk: &Blisk, tool: &CupMill, plan: &SlotPlan) -> Self {
        let [low_mm, high_mm] = blisk.blank.faces_mm;
        let bar = Tool::cylinder(blisk.blank.radius_mm, high_mm - low_mm).expect("a bar");
        let tip = plan.turn * Point::new(0.0, 0.0, low_mm);
        let pose = Pose { tip_mm: tip.coords.into(), axis: (plan.turn * Vector::z()).into() };
        let stock = Stock::new(&Revolved::new(bar, &pose).expect("a blank"), STEP_MM, MEMORY_MAX).expect("memory");
        let radii_mm = [tool.outer_radius_mm, tool.inner_radius_mm];
        let ring = Tool::ring(radii_mm, tool.insert_radius_mm, tool.height_mm, TOLERANCE_MM).expect("a ring");
        Dexels { stock, ring }
    }

    /// Cuts the path of a plan whose slot frame is turned by `turn` into that of the dexels.
    pub fn cut(&mut self, plan: &SlotPlan, turn: &Rotation3<f64>) -> Volume {
        let frame = Frame { axes: [0, 1, 2].map(|row: usize| turn.matrix().row(row).transpose().into()) };
        let steps = plan.path.steps();
        let sweeps = steps.iter().flat_map(|step| moved(step).sweeps(&self.ring, TOLERANCE_MM).expect("sweeps"));
        let sweeps: Vec<Sweep> = sweeps.map(|sweep| sweep.in_frame(&frame)).collect();
        self.stock.cut(&self.ring, &sweeps).expect("memory")
    }
}

#[test]
fn the_simulator_removes_as_much() {
    let (blisk, tool) = (published_rotor::blisk(), published_tool());
    let plan = plan(&blisk, &blisk.slot(), &tool, &ROUGHING).expect("a plan");
    let walls = SlotWalls::new(&blisk.slot(), &blisk.hub, ALLOWANCE_MM, plan.turn).expect("walls");
    let blank = removal::Stock { blank: &blisk.blank, to_slot: plan.turn, earlier: Earlier::none() };
    let floor = Floor::new(&tool, &plan.path.steps());
    let planned = removal::removed(&floor, plan.path.levels.len(), &blank, &walls, STEP_MM);
    let simulated = Dexels::new(&blisk, &tool, &plan).cut(&plan, &Rotation3::identity());
    let (planned_mm3, simulated_mm3) = (planned.total_mm3(), simulated.mean_mm3());
    println!(
        "columns {planned_mm3:.0} +- {:.0}, dexels {simulated_mm3:.0} +- {:.0} mm3",
        planned.error_mm3,
        simulated.spread_mm3()
    );
    assert!((planned_mm3 - simulated_mm3).abs() < planned.error_mm3 + simulated.spread_mm3());
}
