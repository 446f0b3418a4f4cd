//! The library's edges and forces under the sine law, in the frame of the closed forms.

use std::f64::consts::{FRAC_PI_2, TAU};

use arcfeed_milling::cutting::edges::meridian::Pieces;
use arcfeed_milling::cutting::edges::{Cutter, EdgePiece, EndMill};
use arcfeed_milling::cutting::force::Loads;
use arcfeed_milling::cutting::material::{ChipSection, Cutting};

use crate::cutting_forces::closed_form::Milling;

/// The same cut, its edges in pieces.
pub struct InPieces {
    milling: Milling,
    cutter: Cutter,
    cutting: Cutting,
}

impl InPieces {
    pub fn new(milling: Milling, pieces: usize) -> Self {
        let Milling { teeth, helix_rad, .. } = milling;
        let diameter_mm = 2.0 * milling.radius_mm;
        let mill = EndMill { diameter_mm, corner_mm: 0.0, teeth, helix_rad, height_mm: milling.depth_mm };
        let cutter = Cutter::end_mill(&mill, Pieces::Along(pieces)).unwrap();
        InPieces { milling, cutter, cutting: Cutting::linear(milling.cutting, milling.edge) }
    }

    /// With tooth 0 at this angle from y, clockwise, at its tip.
    pub fn loads(&self, angle_rad: f64) -> Loads {
        // Tooth 0 begins at x, which is a quarter of a turn from y.
        let turned_rad = angle_rad - FRAC_PI_2;
        let mut loads = Loads::default();
        for piece in self.cutter.pieces() {
            loads.add(piece, turned_rad, &self.cutting.force(&self.chip(piece, turned_rad)));
        }
        loads
    }

    /// The part of the piece within the material, and the chip in the middle of that part.
    fn chip(&self, piece: &EdgePiece, turned_rad: f64) -> ChipSection {
        let middle = (FRAC_PI_2 - piece.angle_at_rad(turned_rad)).rem_euclid(TAU);
        let half = piece.rise_mm * libm::tan(self.milling.helix_rad) / self.milling.radius_mm / 2.0;
        let [begin, end] = self.milling.engaged_rad;
        if half == 0.0 {
            let width_mm = if (begin..=end).contains(&middle) { piece.width_mm() } else { 0.0 };
            return ChipSection { thickness_mm: self.milling.feed_mm_per_tooth * libm::sin(middle), width_mm };
        }
        // A piece that lies across the angle zero is seen from both sides of it.
        let parts = [middle, middle - TAU, middle + TAU].map(|at| ((at - half).max(begin), (at + half).min(end)));
        let (from, to) = parts.into_iter().find(|(from, to)| from < to).unwrap_or((0.0, 0.0));
        let width_mm = piece.width_mm() * (to - from) / (2.0 * half);
        ChipSection { thickness_mm: self.milling.feed_mm_per_tooth * libm::sin((from + to) / 2.0), width_mm }
    }
}
