//! Proof that the whole mill touches nothing on all plunges of a passage: bounds between all samples, as for the cup mill.
//!
//! Each plunge has its own frame, in which its axis is z; the part is turned by it. Neck and holder are checked against the blank before its first
//! cut, unless they fit into the hole that the mill itself cuts.

use nalgebra::Rotation3;

use crate::geometry::blisk::Blisk;
use crate::parallel;
use crate::path::{Purpose, Step};
use crate::proof::bodies;
use crate::proof::clearance::{Body, Obstacle};
use crate::proof::motion::Motion;
use crate::proof::search::{Place, Search};
use crate::proof::spheres::Tree;
use crate::vector::{Point, Vector};

use super::mill::{MillPart, PlungeMill};
use super::passage_plan::Plunge;

/// Largest distance of triangles from the surfaces, mm.
const CHORD_MM: f64 = 0.005;
/// Largest difference between the bounds of a distance, mm.
const GAP_MM: f64 = 0.002;
/// Largest loss of allowance that the proof accepts, mm: the precision of its bodies and bounds.
const SLACK_MM: f64 = 0.01;

/// Clearance: least distance between a part of the mill and an obstacle over all plunges of a passage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlungeClearance {
    /// Part of the mill.
    pub part: MillPart,
    /// Obstacle.
    pub obstacle: Obstacle,
    /// Lower bound of the distance, and a distance that occurs, mm; both negative inside the obstacle.
    pub bounds_mm: [f64; 2],
    /// Index of the plunge with the smallest lower bound.
    pub plunge: usize,
    /// Place where that distance occurs, in the frame of that plunge; `None` without an obstacle.
    pub place: Option<Place>,
}

/// Collision proof of all plunges of a passage: clearances of every part of the mill from every obstacle.
#[derive(Clone, Debug, PartialEq)]
pub struct PlungeProof {
    /// Clearances by part and obstacle.
    pub clearances: Vec<PlungeClearance>,
    /// Allowance on blades and hub, mm.
    pub allowance_mm: f64,
}

impl PlungeProof {
    /// Clearances for which a collision, or a cut into the allowance, is not excluded.
    pub fn open(&self) -> impl Iterator<Item = &PlungeClearance> {
        self.clearances.iter().filter(|found| found.bounds_mm[0] <= self.needed_mm(found))
    }

    /// Distance that a part must keep from an obstacle.
    fn needed_mm(&self, found: &PlungeClearance) -> f64 {
        let keeps_allowance = matches!(found.obstacle, Obstacle::Blades | Obstacle::Hub);
        if found.part == MillPart::Cutter && keeps_allowance { self.allowance_mm - SLACK_MM } else { 0.0 }
    }

    /// Whether it is proven that nothing is touched and the allowance is kept.
    pub fn holds(&self) -> bool {
        !self.clearances.is_empty() && self.open().next().is_none()
    }
}

/// Proves the plunges of one passage, or finds their faults.
pub fn prove(
    blisk: &Blisk,
    mill: &PlungeMill,
    plunges: &[Plunge],
    allowance_mm: f64,
    fixture: &[[Point; 2]],
) -> PlungeProof {
    let pitch = |k: u32| Rotation3::from_axis_angle(&Vector::z_axis(), f64::from(k) * blisk.pitch_rad());
    let here = vec![Rotation3::identity()];
    let body = |obstacle, triangles, turns, chord_mm| Body { obstacle, tree: Tree::new(triangles), turns, chord_mm };
    let boxes = fixture.iter().flat_map(bodies::cuboid).collect();
    let bodies = [
        body(Obstacle::Blades, bodies::blades(blisk, CHORD_MM), (0..blisk.blades).map(pitch).collect(), CHORD_MM),
        body(Obstacle::Hub, bodies::hub(blisk, CHORD_MM), here.clone(), CHORD_MM),
        body(Obstacle::Fixture, boxes, here.clone(), 0.0),
        body(Obstacle::Blank, bodies::blank(&blisk.blank, CHORD_MM), here, CHORD_MM),
    ];
    let parts = [MillPart::Cutter, MillPart::Neck, MillPart::Holder];
    let pairs = parts.into_iter().flat_map(|part| bodies.iter().map(move |body| (part, body)));
    let pairs = pairs.filter(|(part, body)| body.obstacle != Obstacle::Blank || !mill.fits_hole(*part));
    let clearances = pairs.filter_map(|(part, body)| least(mill, part, body, plunges));
    PlungeProof { clearances: clearances.collect(), allowance_mm }
}

/// Least distance of a part from a body over all plunges; `None` if one of them is empty.
fn least(mill: &PlungeMill, part: MillPart, body: &Body, plunges: &[Plunge]) -> Option<PlungeClearance> {
    let sections = mill.sections(part);
    if sections.is_empty() || body.tree.root().is_none() {
        return None;
    }
    let one = |plunge: &Plunge| {
        let motions: Vec<Motion> = motions(plunge);
        let turns: Vec<Rotation3<f64>> = body.turns.iter().map(|turn| plunge.to_tool * turn).collect();
        Search { sections: &sections, motions: &motions, tree: &body.tree, turns: &turns }.least(GAP_MM)
    };
    let found = parallel::map(plunges, &one);
    let plunge = (0..found.len()).min_by(|a, b| found[*a].bounds_mm[0].total_cmp(&found[*b].bounds_mm[0]))?;
    let [no_less_mm, found_mm] = found[plunge].bounds_mm;
    Some(PlungeClearance {
        part,
        obstacle: body.obstacle,
        bounds_mm: [no_less_mm - body.chord_mm, found_mm + body.chord_mm],
        plunge,
        place: found[plunge].place,
    })
}

/// Moves of a plunge in its own frame: down, off the wall, out.
fn motions(plunge: &Plunge) -> Vec<Motion> {
    let places = plunge.places();
    let pair = |pair: &[Point]| {
        Motion::new(&Step { purpose: Purpose::Link, level: 0, from: pair[0].into(), to: pair[1].into(), about: None })
    };
    places.windows(2).map(pair).filter(|motion| motion.length_mm > 0.0).collect()
}
