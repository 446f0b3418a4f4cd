//! Obstacles of a finishing mill: the blade that it finishes, and all else that it keeps away from.

use nalgebra::Rotation3;

use crate::geometry::blisk::Blisk;
use crate::geometry::mesh::Triangle;
use crate::proof::bodies;
use crate::proof::spheres::Tree;
use crate::vector::{Point, Vector};

/// Largest distance between the triangles of the blade to be finished and its true surface, mm.
pub const OWN_CHORD_MM: f64 = 0.002;
/// Largest distance of triangles from the other surfaces, mm.
const CHORD_MM: f64 = 0.02;

/// Kind of an obstacle for a finishing mill.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FinishObstacle {
    /// The blade that is finished, as it will be.
    Blade,
    /// The same blade before finishing, into which only the mill's end and flutes may cut.
    Stock,
    /// The other blades.
    Neighbours,
    /// The finished hub.
    Hub,
    /// Fixtures.
    Fixture,
}

/// Obstacle of a finishing mill as triangles, in the rotor's own frame.
#[derive(Clone, Debug)]
pub struct FinishBody {
    /// Kind.
    pub obstacle: FinishObstacle,
    /// Surface.
    pub tree: Tree,
    /// Rotations of its copies about the rotor's axis.
    pub turns: Vec<Rotation3<f64>>,
    /// Largest distance between the triangles and the true surface, mm.
    pub chord_mm: f64,
}

impl FinishBody {
    /// Body without copies.
    pub fn fixed(obstacle: FinishObstacle, triangles: Vec<Triangle>, chord_mm: f64) -> Self {
        FinishBody { obstacle, tree: Tree::new(triangles), turns: vec![Rotation3::identity()], chord_mm }
    }
}

/// All obstacles about the first blade of a rotor that are there.
pub fn obstacles(blisk: &Blisk, fixture: &[[Point; 2]]) -> Vec<FinishBody> {
    let own = FinishBody::fixed(FinishObstacle::Blade, bodies::blades(blisk, OWN_CHORD_MM), OWN_CHORD_MM);
    around(blisk, 1, vec![own], fixture)
}

/// The bodies of one blade of a rotor, by its number from 1, and all else about it that is there.
pub fn around(blisk: &Blisk, number: u32, own: Vec<FinishBody>, fixture: &[[Point; 2]]) -> Vec<FinishBody> {
    let turn = |k: u32| Rotation3::from_axis_angle(&Vector::z_axis(), f64::from(k) * blisk.pitch_rad());
    let neighbours = FinishBody {
        obstacle: FinishObstacle::Neighbours,
        tree: Tree::new(bodies::blades(blisk, CHORD_MM)),
        turns: (number..number + blisk.blades - 1).map(turn).collect(),
        chord_mm: CHORD_MM,
    };
    let hub = FinishBody::fixed(FinishObstacle::Hub, bodies::hub(blisk, CHORD_MM), CHORD_MM);
    let boxes = fixture.iter().flat_map(bodies::cuboid).collect();
    let others = [neighbours, hub, FinishBody::fixed(FinishObstacle::Fixture, boxes, 0.0)];
    let all = own.into_iter().chain(others);
    all.filter(|body| body.tree.root().is_some() && !body.turns.is_empty()).collect()
}
