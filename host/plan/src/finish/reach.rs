//! Admissible tool axes at contacts, and the smoothest sequence of them.
//!
//! ```text
//! admissible: distance(mill, neighbours, hub, fixture) >= safety
//!             distance(neck, holder, own blade and its stock) >= safety,   distance(end, flutes, own blade) >= -gouge     (1)
//! smoothest:  minimise sum |t_{i+1} - t_i|^2 over one admissible axis a station                             (2)
//! ```
//!
//! The distances are lower bounds of the proof's search, for a mill at rest. (2) is solved by dynamic programming; for a closed course once for each
//! first axis.
//!
//! Source: reach cones, ours; the search is Bellman's, as for the machine's branches.

use nalgebra::Rotation3;

use crate::path::{Purpose, Step};
use crate::proof::motion::Motion;
use crate::proof::search::Search;
use crate::vector::Vector;

use super::contact::Contact;
use super::mill::{CutterLocation, FinishMill, FinishPart, MillPiece};
use super::obstacles::{FinishBody, FinishObstacle};

/// Gap of the search for the finished blade, mm.
const OWN_GAP_MM: f64 = 0.002;
/// Gap for all else, as a share of the safety distance, and at least in mm.
const GAP_RATIO: f64 = 0.1;

/// Further angle for what a machine's axes leave the path by.
const SPARE_RAD: f64 = 5e-4;

/// Distances that a finishing mill must keep from obstacles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// Distance from everything but the blade that it finishes, mm.
    pub safety_mm: f64,
    /// Depth to which its end may cut into that blade, mm.
    pub gouge_mm: f64,
}

/// Test whether tool axes keep the mill away from obstacles.
pub struct AxisReach<'a> {
    /// Mill.
    pub mill: &'a FinishMill,
    /// Pieces of the mill.
    pub pieces: &'a [MillPiece],
    /// Obstacles.
    pub bodies: &'a [FinishBody],
    /// Distances to keep.
    pub margins: Margins,
    /// Half the angle by which the axis turns on one move of the path, for which the proof needs additional distance.
    pub turn_rad: f64,
}

impl Margins {
    /// Distance, mm, that a part of the mill must keep from an obstacle; `None` if it may cut into it.
    pub fn needed_mm(&self, part: FinishPart, obstacle: FinishObstacle) -> Option<f64> {
        match (part, obstacle) {
            (FinishPart::End | FinishPart::Flutes, FinishObstacle::Blade) => Some(-self.gouge_mm),
            (FinishPart::End | FinishPart::Flutes, FinishObstacle::Stock) => None,
            _ => Some(self.safety_mm),
        }
    }

    /// Precision, mm, of the search for the distance from an obstacle.
    pub fn gap_mm(&self, obstacle: FinishObstacle) -> f64 {
        if obstacle == FinishObstacle::Blade { OWN_GAP_MM } else { GAP_RATIO * self.safety_mm }
    }
}

impl AxisReach<'_> {
    /// Whether the mill at a contact, with this tool axis, keeps all distances. (1)
    pub fn is_admissible(&self, contact: &Contact, axis: Vector) -> bool {
        let location = self.mill.at(contact, axis);
        // A ball is the same about any axis. Necks and holders decide most often, and their search is the quicker one.
        let turns = |piece: &&MillPiece| piece.part != FinishPart::End || !self.mill.is_ball();
        let order: Vec<&MillPiece> = self.pieces.iter().rev().filter(turns).collect();
        self.bodies.iter().rev().all(|body| order.iter().all(|piece| self.keeps(&location, piece, body)))
    }

    fn keeps(&self, location: &CutterLocation, piece: &MillPiece, body: &FinishBody) -> bool {
        let Some(needed_mm) = self.margins.needed_mm(piece.part, body.obstacle) else { return true };
        let to_tool = upright(&location.axis);
        let pivot = (to_tool * self.mill.pivot(location)).into();
        let still = Motion::new(&Step { purpose: Purpose::Link, level: 0, from: pivot, to: pivot, about: None });
        let turns: Vec<Rotation3<f64>> = body.turns.iter().map(|turn| to_tool * turn).collect();
        let sections = [piece.section];
        let search = Search { sections: &sections, motions: &[still], tree: &body.tree, turns: &turns };
        let turned_mm = piece.reach_mm * (self.turn_rad + SPARE_RAD);
        let needed_mm = needed_mm + body.chord_mm + turned_mm;
        let least = search.least_until(self.margins.gap_mm(body.obstacle), [needed_mm, needed_mm]);
        least.bounds_mm[0] >= needed_mm
    }
}

/// Rotation that makes a tool axis vertical; the rest of it does not matter to a solid of revolution.
pub fn upright(axis: &Vector) -> Rotation3<f64> {
    Rotation3::rotation_between(axis, &Vector::z())
        .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector::x_axis(), core::f64::consts::PI))
}

/// Smoothest sequence of one axis from each layer; `None` if a layer is empty. A closed sequence returns to its first axis. (2)
pub fn smoothest(layers: &[Vec<Vector>], is_closed: bool) -> Option<Vec<Vector>> {
    let first = layers.first()?;
    if !is_closed {
        return cheapest(layers, None).map(|(_, axes)| axes);
    }
    let starts = (0..first.len()).filter_map(|start| cheapest(layers, Some(first[start])));
    starts.min_by(|one, other| one.0.total_cmp(&other.0)).map(|(_, axes)| axes)
}

/// Cost and axes of the best sequence; with `ends` it begins with that axis and returns to it.
fn cheapest(layers: &[Vec<Vector>], ends: Option<Vector>) -> Option<(f64, Vec<Vector>)> {
    let start = ends.map_or_else(|| layers[0].clone(), |axis| vec![axis]);
    let mut costs: Vec<f64> = vec![0.0; start.len()];
    let mut links: Vec<Vec<usize>> = Vec::new();
    let mut before = &start;
    let last = ends.map(|axis| vec![axis]);
    let steps: Vec<&Vec<Vector>> = layers[1..].iter().chain(&last).collect();
    for layer in &steps {
        let arrive = |axis: &Vector| {
            let from = |at: usize| costs[at] + (axis - before[at]).norm_squared(); // (2)
            (0..before.len()).map(|at| (from(at), at)).min_by(|one, other| one.0.total_cmp(&other.0))
        };
        let found = layer.iter().map(arrive).collect::<Option<Vec<_>>>()?;
        if found.is_empty() {
            return None;
        }
        costs = found.iter().map(|(cost, _)| *cost).collect();
        links.push(found.iter().map(|(_, at)| *at).collect());
        before = layer;
    }
    let (mut at, cost) = costs.iter().copied().enumerate().min_by(|one, other| one.1.total_cmp(&other.1))?;
    let mut axes = Vec::with_capacity(layers.len());
    for (layer, link) in steps.iter().zip(&links).rev() {
        axes.push(layer[at]);
        at = link[at];
    }
    axes.push(start[at]);
    axes.reverse();
    axes.truncate(layers.len());
    Some((cost, axes))
}
