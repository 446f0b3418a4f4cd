//! The outline of one tooth, cut in pieces.
//!
//! On a rounded corner a piece is the chord of a step d at lead angle k: it rises by 2 c sin(k) sin(d/2) and so is
//! 2 c sin(d/2) wide, by (1) of the parent.

use std::f64::consts::FRAC_PI_2;

use super::{EdgePiece, Side};

/// Half a section through an edge: a rounded corner, then a straight wall.
pub(super) struct Meridian {
    pub(super) side: Side,
    /// Of the wall.
    pub(super) radius_mm: f64,
    pub(super) corner_mm: f64,
    /// How far up it goes.
    pub(super) height_mm: f64,
    /// Of the helix.
    pub(super) lag_rad_per_mm: f64,
}

impl Meridian {
    /// Pieces of about equal length; none if the measures are none of an edge.
    pub(super) fn pieces(&self, pieces: usize) -> Option<Vec<EdgePiece>> {
        let positive = [self.radius_mm, self.height_mm].iter().all(|mm| *mm > 0.0 && mm.is_finite());
        if !(positive && self.corner_mm >= 0.0 && self.lag_rad_per_mm.is_finite()) {
            return None;
        }
        let corner_rad = match self.height_mm < self.corner_mm {
            true => libm::acos(1.0 - self.height_mm / self.corner_mm),
            false if self.corner_mm > 0.0 => FRAC_PI_2,
            false => 0.0,
        };
        let (arc_mm, wall_mm) = (corner_rad * self.corner_mm, (self.height_mm - self.corner_mm).max(0.0));
        let part = |mm: f64| libm::ceil(pieces as f64 * mm / (arc_mm + wall_mm)) as usize;
        let (on_arc, on_wall) = (part(arc_mm), part(wall_mm));
        let arc = (0..on_arc).map(|at| self.on_arc(corner_rad, at, on_arc));
        let rise_mm = wall_mm / on_wall as f64;
        let wall = (0..on_wall).map(|at| {
            let height_mm = self.height_mm - wall_mm + (at as f64 + 0.5) * rise_mm;
            self.piece(height_mm, rise_mm, FRAC_PI_2)
        });
        Some(arc.chain(wall).collect())
    }

    fn on_arc(&self, corner_rad: f64, at: usize, of: usize) -> EdgePiece {
        let step_rad = corner_rad / of as f64;
        let lead_rad = (at as f64 + 0.5) * step_rad;
        let rise_mm = 2.0 * self.corner_mm * libm::sin(lead_rad) * libm::sin(step_rad / 2.0);
        self.piece(self.corner_mm * (1.0 - libm::cos(lead_rad)), rise_mm, lead_rad)
    }

    fn piece(&self, height_mm: f64, rise_mm: f64, lead_rad: f64) -> EdgePiece {
        let inset_mm = self.corner_mm * (1.0 - libm::sin(lead_rad));
        EdgePiece {
            tooth: 0,
            height_mm,
            rise_mm,
            radius_mm: self.radius_mm - self.side.sign() * inset_mm,
            angle_rad: height_mm * self.lag_rad_per_mm, // (6) of the parent
            lead_rad,
            side: self.side,
        }
    }
}
