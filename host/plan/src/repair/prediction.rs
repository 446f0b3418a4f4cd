//! Predicted result of a repair: what the balls of the finish leave on the nominal surface.
//!
//! ```text
//! t = (C - Q).n - sqrt(r^2 - |(C - Q) - ((C - Q).n) n|^2),   left = min over the centres C of t, at most what stands       (1)
//! ```
//!
//! with the node Q and its normal n: (1) is where the line along n enters a ball. The balls stand at the contact points, so that between two of them, a
//! tenth of a millimetre apart, less is left than predicted.
//!
//! Source: ours; geometry.

use rstar::RTree;
use rstar::primitives::GeomWithData;

use super::field::FieldNode;
use super::passes::RepairContact;
use super::plan::RepairPlan;
use crate::parallel;
use crate::vector::{Point, Vector};

/// Allowance, mm, that is left at each node of the lattice, row by row; `None` where nothing was measured. (1)
pub fn predicted_mm(plan: &RepairPlan, ball_mm: f64) -> Vec<Vec<Option<f64>>> {
    let centre = |at: &RepairContact| at.point + at.normal * ball_mm;
    let entry = |centre: Point| GeomWithData::new([centre.x, centre.y, centre.z], centre);
    let centres = RTree::bulk_load(plan.finish.iter().flatten().map(centre).map(entry).collect());
    let left = |node: &FieldNode| {
        let standing_mm = node.along_mm?;
        let near = centres
            .locate_within_distance((node.point + node.normal * standing_mm.max(0.0)).into(), 4.0 * ball_mm * ball_mm);
        Some(
            near.filter_map(|ball| entered_mm(node.point, node.normal, ball.data, ball_mm)).fold(standing_mm, f64::min),
        )
    };
    parallel::map(&plan.field.rows, &|row| row.iter().map(left).collect())
}

/// (1)
fn entered_mm(point: Point, normal: Vector, centre: Point, ball_mm: f64) -> Option<f64> {
    let off = centre - point;
    let along_mm = off.dot(&normal);
    let half_square = ball_mm * ball_mm - (off - normal * along_mm).norm_squared();
    let half_mm = libm::sqrt(half_square.max(0.0));
    // A ball on the other side of the blade ends behind it.
    (half_square > 0.0 && along_mm + half_mm > 0.0).then_some(along_mm - half_mm)
}
