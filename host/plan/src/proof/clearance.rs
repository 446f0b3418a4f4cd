//! Clearance between a part of the tool and an obstacle, along the whole path.
//!
//! A body with an allowance all around is the set of points within the allowance of the body. So the tool's distance
//! from it is exactly its distance from the body less the allowance: no surface has to be offset. The distance is
//! negative where the tool has cut into the allowance, by the missing amount.

use nalgebra::Rotation3;

use crate::cutter::{CupMill, ToolPart};
use crate::path::Step;

use super::motion::Motion;
use super::search::{Place, Search};
use super::section::Section;
use super::spheres::Tree;

/// Kind of a body that the tool must not touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Obstacle {
    /// All finished blades; copies are numbered by increasing angle about the rotor's axis.
    Blades,
    /// The finished hub.
    Hub,
    /// Fixtures of the part.
    Fixture,
    /// The blank before the first cut.
    Blank,
}

/// Body that the tool must not touch, as triangles, with its copies about the rotor's axis.
#[derive(Clone, Debug)]
pub struct Body {
    /// Kind of obstacle.
    pub obstacle: Obstacle,
    /// Triangles of the body in its own frame.
    pub tree: Tree,
    /// Rotations of its copies into the slot frame.
    pub turns: Vec<Rotation3<f64>>,
    /// Largest distance between the triangles and the true surface, mm.
    pub chord_mm: f64,
}

/// Least distance between one part of the tool and one obstacle over the whole path, as proven bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// Part of the tool: ring, body or holder.
    pub part: ToolPart,
    /// Kind of obstacle.
    pub obstacle: Obstacle,
    /// Lower bound of the distance, and the distance at the place, mm. A negative value is the depth of a point of the
    /// obstacle's surface inside the part. Infinite if there is no obstacle.
    pub bounds_mm: [f64; 2],
    /// Place where the distance occurs; steps count as in [`SlotPath::steps`](crate::path::SlotPath::steps). `None` without an obstacle.
    pub place: Option<Place>,
    /// Number of pieces of path and obstacle that the search has bounded.
    pub pieces: usize,
}

impl Clearance {
    /// Bounds of the distance, mm, if the obstacle is larger by an allowance on all sides.
    pub fn beyond_mm(&self, allowance_mm: f64) -> [f64; 2] {
        self.bounds_mm.map(|bound_mm| bound_mm - allowance_mm)
    }

    /// Whether it is proven that this part of the tool does not touch this obstacle anywhere on the path: the lower bound of their distance is above 0.
    pub fn is_free(&self) -> bool {
        self.bounds_mm[0] > 0.0
    }
}

/// Least distance between a part of the tool on its path and an obstacle, to within `gap_mm` and twice the obstacle's
/// chord error; a depth to within a fiftieth.
pub fn clearance(tool: &CupMill, part: ToolPart, steps: &[Step], body: &Body, gap_mm: f64) -> Clearance {
    let motions: Vec<Motion> = steps.iter().map(Motion::new).collect();
    let sections = Section::of(tool, part);
    let search = Search { sections: &sections, motions: &motions, tree: &body.tree, turns: &body.turns };
    let least = search.least(gap_mm);
    let [no_less_mm, found_mm] = least.bounds_mm;
    let bounds_mm = [no_less_mm - body.chord_mm, found_mm + body.chord_mm];
    Clearance { part, obstacle: body.obstacle, bounds_mm, place: least.place, pieces: least.pieces }
}
