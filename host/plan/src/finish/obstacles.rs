//! Obstacles of a finishing mill: the blade that it finishes, and all else that it keeps away from.

use nalgebra::Rotation3;

use crate::geometry::blisk::Blisk;
use crate::proof::bodies;
use crate::proof::spheres::Tree;
use crate::vector::{Point, Vector};

/// Largest distance of triangles from the finished blade, mm.
const OWN_CHORD_MM: f64 = 0.002;
/// Largest distance of triangles from the other surfaces, mm.
const CHORD_MM: f64 = 0.02;

/// Kind of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FinishObstacle {
    /// The blade that is finished.
    Blade,
    /// The other blades.
    Neighbours,
    /// The finished hub.
    Hub,
    /// Fixtures.
    Fixture,
}

/// Obstacle as triangles, part frame.
#[derive(Clone, Debug)]
pub struct FinishBody {
    /// Kind.
    pub obstacle: FinishObstacle,
    /// Surface.
    pub tree: Tree,
    /// Rotations of its copies.
    pub turns: Vec<Rotation3<f64>>,
    /// Largest distance of the triangles from the surface.
    pub chord_mm: f64,
}

/// All obstacles about the first blade of a rotor that are there.
pub fn obstacles(blisk: &Blisk, fixture: &[[Point; 2]]) -> Vec<FinishBody> {
    let turn = |k: u32| Rotation3::from_axis_angle(&Vector::z_axis(), f64::from(k) * blisk.pitch_rad());
    let here = || vec![Rotation3::identity()];
    let boxes = fixture.iter().flat_map(bodies::cuboid).collect();
    let body =
        |obstacle, triangles, turns, chord_mm| FinishBody { obstacle, tree: Tree::new(triangles), turns, chord_mm };
    let bodies = vec![
        body(FinishObstacle::Blade, bodies::blade(blisk, OWN_CHORD_MM), here(), OWN_CHORD_MM),
        body(
            FinishObstacle::Neighbours,
            bodies::blade(blisk, CHORD_MM),
            (1..blisk.blades).map(turn).collect(),
            CHORD_MM,
        ),
        body(FinishObstacle::Hub, bodies::hub(blisk, CHORD_MM), here(), CHORD_MM),
        body(FinishObstacle::Fixture, boxes, here(), 0.0),
    ];
    bodies.into_iter().filter(|body| body.tree.root().is_some() && !body.turns.is_empty()).collect()
}
