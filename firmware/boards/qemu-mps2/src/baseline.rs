//! Baseline of the tick's cost: the source's own loop on the same ticks, counted in the same way.

use core::hint::black_box;

use arcfeed_bench::thesis::{self, Fpu, Libm, Movement};
use arcfeed_model::cut::Work;
use arcfeed_model::job::Job;
use arcfeed_model::tool::Tool;
use arcfeed_nc::modal::{Pose, Turn};
use arcfeed_units::Nm;

use crate::clock::InstructionCounter;
use crate::example::Block;
use crate::figures::Costs;

const NAMES: [&str; 6] = [
    "thesis-11-26-f32",
    "thesis-8-29-f32",
    "thesis-11-26-f64",
    "thesis-8-29-f64",
    "thesis-8-29-f32-fpu",
    "thesis-8-29-f32-lean",
];

/// Instruction counts of six other implementations of the source's equations: (11) to (26) and (8) to (29) in f32 and
/// in f64; (8) to (29) in f32 with the FPU's square root, and an optimised version of it.
#[derive(Debug, Default)]
pub struct Baseline {
    costs: [Costs; 6],
}

impl Baseline {
    /// Counts all implementations on a block of the run, at a position of the tool. Does nothing if no cut rule
    /// applies to the block.
    pub fn add(&mut self, counter: &InstructionCounter, block: &Block, position: &Pose, job: &Job) {
        let Some(movement) = movement(block, position, job) else { return };
        let [step_f32, tooth_f32, step_f64, tooth_f64, tooth_fpu, tooth_lean] = &mut self.costs;
        let narrow = narrow(&movement);
        let (line, narrow_line) = (thesis::line(movement.limits), thesis::line(narrow.limits));
        step_f32.add(counter.of(|| black_box(thesis::step::<_, Libm>(black_box(&narrow), black_box(narrow_line)))).0);
        tooth_f32.add(counter.of(|| black_box(thesis::tooth::<_, Libm>(black_box(&narrow)))).0);
        step_f64.add(counter.of(|| black_box(thesis::step::<_, Libm>(black_box(&movement), black_box(line)))).0);
        tooth_f64.add(counter.of(|| black_box(thesis::tooth::<_, Libm>(black_box(&movement)))).0);
        tooth_fpu.add(counter.of(|| black_box(thesis::tooth::<_, Fpu>(black_box(&narrow)))).0);
        tooth_lean.add(counter.of(|| black_box(thesis::lean_tooth::<_, Fpu>(black_box(&narrow)))).0);
    }

    /// Prints one line for each implementation.
    pub fn print(&mut self) {
        for (name, costs) in NAMES.iter().zip(&mut self.costs) {
            costs.print("", name);
        }
    }
}

/// Inputs of the source's equations at this position: the stock limit in the frame at O, given by two points at a
/// distance of a tool radius on both sides of the foot of the perpendicular from O.
fn movement(block: &Block, position: &Pose, job: &Job) -> Option<Movement<f64>> {
    let segment = block.segment.as_ref()?;
    let (arc, rule) = (segment.arc()?, block.cut(job)?);
    let [x, y, _] = position.linear.map(Nm::to_mm);
    let [center_x, center_y] = arc.center.map(Nm::to_mm);
    let path_radius = arc.radius_mm();
    let (ex, ey) = ((x - center_x) / path_radius, (y - center_y) / path_radius);
    let turn = if arc.turn == Turn::Ccw { 1.0 } else { -1.0 };
    let (Tool::CupMill(tool), Work::Ring(edge, stock)) = (&job.tools.first().tool, &rule.work) else { return None };
    let line = stock.line()?.at_height(segment.height().to_mm());
    let [nx, ny] = line.normal;
    let (normal_x, normal_y) = (turn * (ny * ex - nx * ey), -(nx * ex + ny * ey));
    let distance = line.distance_mm([x, y]);
    let edge_radius = tool.radius(*edge).to_mm();
    let limit = |along: f64| [distance * normal_x - along * normal_y, distance * normal_y + along * normal_x];
    Some(Movement {
        limits: [limit(-edge_radius), limit(edge_radius)],
        edge_radius,
        path_radius,
        advance: f64::from(edge.advance()),
        feed_per_tooth: f64::from(job.tools.first().feed_per_tooth.0),
    })
}

fn narrow(movement: &Movement<f64>) -> Movement<f32> {
    Movement {
        limits: movement.limits.map(|point| point.map(|mm| mm as f32)),
        edge_radius: movement.edge_radius as f32,
        path_radius: movement.path_radius as f32,
        advance: movement.advance as f32,
        feed_per_tooth: movement.feed_per_tooth as f32,
    }
}
