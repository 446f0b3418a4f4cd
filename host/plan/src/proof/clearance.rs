//! By how much a part of the tool misses something, all along its way.
//!
//! A body left larger by an allowance, all around, is the set of points no farther than the allowance from the body. So the tool's distance
//! from it is its distance from the body less the allowance, exactly: no surface has to be offset. It is negative where the tool has
//! cut into the allowance, by as much as the allowance lacks there.

use nalgebra::Rotation3;

use crate::cutter::{CupMill, Part};
use crate::path::Step;

use super::motion::Motion;
use super::search::{Place, Search};
use super::section::Section;
use super::spheres::Tree;

/// What a tool can meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Obstacle {
    /// All finished blades; copies count with the angle about the rotor's axis.
    Blades,
    /// The finished hub.
    Hub,
    /// What holds the part.
    Fixture,
    /// The blank before the first cut.
    Blank,
}

/// An obstacle as triangles.
#[derive(Clone, Debug)]
pub struct Body {
    /// What it is.
    pub obstacle: Obstacle,
    /// Its surface in its own frame.
    pub tree: Tree,
    /// How its copies lie in the slot frame.
    pub turns: Vec<Rotation3<f64>>,
    /// How far the triangles are from the surface they stand for.
    pub chord_mm: f64,
}

/// How near a part of the tool comes to an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// The part.
    pub part: Part,
    /// The obstacle.
    pub obstacle: Obstacle,
    /// It is never nearer than the first, and at the place no farther than the second, mm. Negative is how deep a point of the obstacle's
    /// surface is inside the part. Infinite where there is nothing.
    pub bounds_mm: [f64; 2],
    /// Where it is nearest; steps count as those of [`SlotPath::steps`](crate::path::SlotPath::steps).
    pub place: Option<Place>,
    /// How many pieces of way and obstacle were looked at.
    pub pieces: usize,
}

impl Clearance {
    /// What is left of the clearance if the obstacle is larger by an allowance, mm.
    pub fn beyond_mm(&self, allowance_mm: f64) -> [f64; 2] {
        self.bounds_mm.map(|bound_mm| bound_mm - allowance_mm)
    }

    /// Whether it is proven that the part never touches the obstacle.
    pub fn is_free(&self) -> bool {
        self.bounds_mm[0] > 0.0
    }
}

/// The least distance between a part of the tool on its way and an obstacle, to within `gap_mm` and twice the obstacle's
/// chord error; a depth to within a fiftieth.
pub fn clearance(tool: &CupMill, part: Part, steps: &[Step], body: &Body, gap_mm: f64) -> Clearance {
    let motions: Vec<Motion> = steps.iter().map(Motion::new).collect();
    let sections = Section::of(tool, part);
    let search = Search { sections: &sections, motions: &motions, tree: &body.tree, turns: &body.turns };
    let least = search.least(gap_mm);
    let [no_less_mm, found_mm] = least.bounds_mm;
    let bounds_mm = [no_less_mm - body.chord_mm, found_mm + body.chord_mm];
    Clearance { part, obstacle: body.obstacle, bounds_mm, place: least.place, pieces: least.pieces }
}
