//! Stock of a later pass: what earlier ones have left of the blank, or of its part about the first slot, in dexels.

use std::fmt::Display;
use std::io::Cursor;

use arcfeed_dexel::files::write_stl;
use arcfeed_dexel::frame::Frame;
use arcfeed_dexel::mesh::Mesh;
use arcfeed_dexel::motion::{Move, Pose};
use arcfeed_dexel::section::Sweep;
use arcfeed_dexel::surface::surface;
use arcfeed_dexel::tool::Tool;
use arcfeed_dexel::workpiece::Stock;
use arcfeed_plan::geometry::mesh::Triangle;
use arcfeed_plan::path::{Pass, Step};
use arcfeed_plan::vector::{FrameRotation, Vector};

use super::plan_result::PlanResult;

/// Largest distance of sweeps from arcs and from the inserts' corners.
const TOLERANCE_MM: f64 = 0.01;
/// Memory for the dexels.
const MEMORY_MAX_BYTES: usize = 1 << 30;

/// Content of a binary STL file with what the earlier passes have left of the `blank` in all slots; blank and result are in the slot frame of
/// this pass. Rays of the dexels are `step_mm` apart.
///
/// # Errors
/// The dexels need too much memory, or nothing is left.
pub fn stl(composed: &PlanResult, blank: &[Triangle], step_mm: f64) -> Result<Vec<u8>, String> {
    let mill = &composed.part.cutter;
    let radii_mm = [mill.outer_radius_mm, mill.inner_radius_mm];
    let ring = Tool::ring(radii_mm, mill.insert_radius_mm, mill.height_mm, TOLERANCE_MM).map_err(text)?;
    let blank = Mesh::from_corners(blank.iter().map(|corners| corners.map(|corner| corner.coords.into())));
    let mut stock = Stock::new(&blank.map_err(text)?, step_mm, MEMORY_MAX_BYTES).map_err(text)?;
    let blisk = &composed.part.blisk;
    for pass in &composed.earlier {
        for slot in 0..blisk.blades {
            let to_slot = FrameRotation::from_axis_angle(&Vector::z_axis(), f64::from(slot) * blisk.pitch_rad());
            let to_here = composed.valued.plan.turn * to_slot * pass.to_slot.inverse();
            stock.cut(&ring, &sweeps(pass, &ring, &to_here)?).map_err(text)?;
        }
    }
    let mut bytes = Cursor::new(Vec::new());
    write_stl(&surface(&stock).map_err(text)?, &mut bytes).map_err(text)?;
    Ok(bytes.into_inner())
}

fn text(error: impl Display) -> String {
    error.to_string()
}

/// Sweeps of the ring along a pass, turned from its slot frame.
fn sweeps(pass: &Pass, ring: &Tool, to_here: &FrameRotation) -> Result<Vec<Sweep>, String> {
    let frame = Frame { axes: [0, 1, 2].map(|row: usize| to_here.matrix().row(row).transpose().into()) };
    let mut sweeps = Vec::new();
    for step in pass.path.steps() {
        let moved = moved(&step).sweeps(ring, TOLERANCE_MM).map_err(text)?;
        sweeps.extend(moved.iter().map(|sweep| sweep.in_frame(&frame)));
    }
    Ok(sweeps)
}

fn moved(step: &Step) -> Move {
    let [from, to] = [step.from, step.to].map(|tip_mm| Pose { tip_mm, axis: [0.0, 0.0, 1.0] });
    let Some((center, turn)) = step.about else { return Move::Straight { from, to } };
    let angle_rad = step.sweep_rad() * f64::from(turn.sign());
    Move::Turn { from, center_mm: [center.x, center.y, 0.0], normal: [0.0, 0.0, 1.0], angle_rad, rise_mm: 0.0 }
}
