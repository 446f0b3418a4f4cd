//! Tools, ways and bodies for the proof's tests.

use arcfeed_nc::modal::Turn;
use arcfeed_plan::cutter::{CupMill, ToolPart};
use arcfeed_plan::geometry::mesh::Triangle;
use arcfeed_plan::path::{Purpose, Step};
use arcfeed_plan::proof::clearance::{Body, Clearance, Obstacle, clearance};
use arcfeed_plan::proof::spheres::Tree;
use arcfeed_plan::vector::{Flat, Point};
use nalgebra::Rotation3;

/// Largest gap between the bounds of a clearance.
pub const GAP_MM: f64 = 0.0005;

/// The ring of the published job with a body and a holder.
pub fn published_tool() -> CupMill {
    CupMill {
        outer_radius_mm: 128.576,
        inner_radius_mm: 112.702,
        insert_radius_mm: 3.0,
        cavity_depth_mm: 60.0,
        height_mm: 90.0,
        holder_mm: vec![[40.0, 100.0], [80.0, 50.0]],
        active_teeth: 10,
    }
}

/// A line, or an arc about a centre.
pub fn step(from: [f64; 3], to: [f64; 3], about: Option<(Flat, Turn)>) -> Step {
    Step { purpose: Purpose::Movement1, level: 0, from, to, about }
}

/// An arc about the origin at a height, from one angle to another, the way that their difference says.
pub fn arc(radius_mm: f64, height_mm: f64, [from_deg, to_deg]: [f64; 2]) -> Step {
    let at = |angle_deg: f64| {
        let (sin, cos) = libm::sincos(angle_deg.to_radians());
        [radius_mm * cos, radius_mm * sin, height_mm]
    };
    let turn = if to_deg > from_deg { Turn::Ccw } else { Turn::Cw };
    step(at(from_deg), at(to_deg), Some((Flat::origin(), turn)))
}

/// One body where it is.
pub fn body(triangles: Vec<Triangle>, chord_mm: f64) -> Body {
    Body { obstacle: Obstacle::Hub, tree: Tree::new(triangles), turns: vec![Rotation3::identity()], chord_mm }
}

/// The clearance of a part, whose bounds are as near to each other as they should be.
pub fn least(tool: &CupMill, part: ToolPart, steps: &[Step], body: &Body) -> Clearance {
    let found = clearance(tool, part, steps, body, GAP_MM);
    let [low_mm, high_mm] = found.bounds_mm;
    let gap_mm = GAP_MM.max(-high_mm / 50.0);
    assert!((0.0..=gap_mm + 2.0 * body.chord_mm + 1e-12).contains(&(high_mm - low_mm)), "{found:?}");
    found
}

/// Poses of a step that are not farther apart than a spacing, by turns of a vector; of less than half a turn.
pub fn poses(step: &Step, spacing_mm: f64) -> Vec<Point> {
    let (from, to) = (Point::from(step.from), Point::from(step.to));
    let shares = |length_mm: f64| {
        let count = (length_mm / spacing_mm).ceil().max(1.0) as u32;
        (0..=count).map(move |k| f64::from(k) / f64::from(count))
    };
    let Some((centre, _)) = step.about else {
        return shares((to - from).norm()).map(|share| from + (to - from) * share).collect();
    };
    let (a, b) = (from.xy() - centre, to.xy() - centre);
    let sweep_rad = libm::atan2(a.perp(&b), a.dot(&b));
    let at = |share: f64| centre + nalgebra::Rotation2::new(sweep_rad * share) * a;
    shares(sweep_rad.abs() * a.norm()).map(|share| Point::new(at(share).x, at(share).y, from.z)).collect()
}
