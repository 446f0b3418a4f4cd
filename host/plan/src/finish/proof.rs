//! Proof that the whole mill keeps its distances on a path along which its axis turns.
//!
//! Between two places the pivot runs straight and the axis along the arc between its directions, an angle alpha. Seen in the frame of the middle axis, a piece
//! of the mill whose surface moves by at most L per radian about the pivot is never farther from the piece that only translates than
//!
//! ```text
//! loss = L (alpha / 2 + delta) + r (alpha^2 / 8 + delta)                                        (1)
//! ```
//!
//! with the corner's radius r, and delta, the angle by which a machine's axis may leave the arc. The second term is the pivot's: a control leads the tip
//! straight, r below it. The search for the translating piece is that of all proofs here; its lower bound less (1) is one for the turning mill.

use nalgebra::Rotation3;

use crate::parallel;
use crate::path::{Purpose, Step};
use crate::proof::motion::Motion;
use crate::proof::search::Search;
use crate::vector::Point;

use super::axis::along_arc;
use super::mill::{CutterLocation, FinishMill, FinishPart, MillPiece};
use super::obstacles::{FinishBody, FinishObstacle};
use super::reach::{Margins, upright};

/// Distance above the needed one at which a search ends.
const ENOUGH_MM: f64 = 1.0;

/// Least distance between a part of the mill and an obstacle over the whole path, as a proven lower bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FinishClearance {
    /// Part of the mill.
    pub part: FinishPart,
    /// Kind of obstacle.
    pub obstacle: FinishObstacle,
    /// Lower bound of the distance, mm; bounds that exceed the needed distance by more than a millimetre may be far below the distance.
    pub certified_mm: f64,
    /// Distance that the part must keep, mm.
    pub needed_mm: f64,
    /// Index of the move with that bound: from position `at` of the path to the next one.
    pub at: usize,
    /// Point of the obstacle at which it occurs, in the rotor's own frame; `None` without an obstacle.
    pub place: Option<Point>,
}

/// Mill with its obstacles, for proving that it keeps its distances on a path.
pub struct FinishProof<'a> {
    /// Mill.
    pub mill: &'a FinishMill,
    /// Obstacles.
    pub bodies: &'a [FinishBody],
    /// Distances to keep.
    pub margins: Margins,
    /// Angle delta by which the machine's rotary axes may turn the tool axis off the arc between two positions, rad.
    pub departure_rad: f64,
}

impl FinishClearance {
    /// Whether the required distance is kept.
    pub fn holds(&self) -> bool {
        self.certified_mm >= self.needed_mm
    }
}

impl FinishProof<'_> {
    /// Clearances of every part from every obstacle along the places of a path.
    pub fn clearances(&self, path: &[CutterLocation]) -> Vec<FinishClearance> {
        let mut found: Vec<FinishClearance> = Vec::new();
        for piece in self.mill.pieces() {
            for body in self.bodies {
                let needed_mm = self.margins.needed_mm(piece.part, body.obstacle);
                let least = needed_mm.and_then(|needed_mm| self.least(&piece, body, needed_mm, path));
                let Some(least) = least else { continue };
                let known = |other: &FinishClearance| other.part == least.part && other.obstacle == least.obstacle;
                match found.iter_mut().find(|other| known(other)) {
                    Some(other) if other.certified_mm <= least.certified_mm => {}
                    Some(other) => *other = least,
                    None => found.push(least),
                }
            }
        }
        found
    }

    /// Least distance of a piece from an obstacle.
    fn least(
        &self,
        piece: &MillPiece,
        body: &FinishBody,
        needed_mm: f64,
        path: &[CutterLocation],
    ) -> Option<FinishClearance> {
        let pairs: Vec<(usize, &[CutterLocation])> = path.windows(2).enumerate().collect();
        let on = |(at, pair): &(usize, &[CutterLocation])| {
            let (certified_mm, place) = self.on_move(piece, body, needed_mm, pair);
            let (part, obstacle) = (piece.part, body.obstacle);
            FinishClearance { part, obstacle, certified_mm, needed_mm, at: *at, place }
        };
        let found = parallel::map(&pairs, &on);
        found.into_iter().min_by(|one, other| one.certified_mm.total_cmp(&other.certified_mm))
    }

    /// Lower bound of the distance on the move between two places, and where it is.
    fn on_move(
        &self,
        piece: &MillPiece,
        body: &FinishBody,
        needed_mm: f64,
        pair: &[CutterLocation],
    ) -> (f64, Option<Point>) {
        let (from, to) = (&pair[0], &pair[1]);
        let to_tool = upright(&along_arc(&from.axis, &to.axis, 0.5));
        let [start, end] = [from, to].map(|location| (to_tool * self.mill.pivot(location)).into());
        let motion = Motion::new(&Step { purpose: Purpose::Link, level: 0, from: start, to: end, about: None });
        let turns: Vec<Rotation3<f64>> = body.turns.iter().map(|turn| to_tool * turn).collect();
        let sections = [piece.section];
        let search = Search { sections: &sections, motions: &[motion], tree: &body.tree, turns: &turns };
        let alpha_rad = from.axis.angle(&to.axis);
        let pivot_mm = self.mill.corner_radius_mm * (alpha_rad * alpha_rad / 8.0 + self.departure_rad);
        let loss_mm = piece.reach_mm * (alpha_rad / 2.0 + self.departure_rad) + pivot_mm; // (1)
        let enough_mm = needed_mm + loss_mm + body.chord_mm + ENOUGH_MM;
        let least = search.least_until(self.margins.gap_mm(body.obstacle), [f64::NEG_INFINITY, enough_mm]);
        let place = least.place.map(|place| to_tool.inverse() * place.point);
        (least.bounds_mm[0] - loss_mm - body.chord_mm, place)
    }
}
