//! Outline of one tooth, divided into pieces.
//!
//! On a rounded corner a piece is the chord of a step d at lead angle k: it rises by 2 c sin(k) sin(d/2) and so is
//! 2 c sin(d/2) wide, by (1) of the parent.

use std::f64::consts::FRAC_PI_2;

use arcfeed_model::tool::Edge;

use super::EdgePiece;

/// Fraction of a slice by which an edge may exceed a whole number of slices: rounding.
const WHOLE_RATIO: f64 = 1e-9;

/// Number of slices above which the slice height is taken for a mistake.
const SLICES_MAX: f64 = 1e5;

/// Way in which a cutting edge is divided into pieces: by length along the edge, or by height along the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pieces {
    /// About this many pieces of equal length along the edge.
    Along(usize),
    /// Slices of equal height along the axis, from the tip upwards until the edge is covered. Cutters in the layers of a workpiece
    /// need slices as high as the layers.
    Slices {
        /// Height of each slice.
        rise_mm: f64,
    },
}

/// Half a section through an edge: a rounded corner, then a straight wall.
pub(super) struct Meridian {
    pub(super) side: Edge,
    /// Radius of the wall.
    pub(super) radius_mm: f64,
    pub(super) corner_mm: f64,
    /// Height of the edge.
    pub(super) height_mm: f64,
    /// Lag angle of the helix per height.
    pub(super) lag_rad_per_mm: f64,
}

impl Meridian {
    /// Pieces of the edge; `None` if the dimensions are not those of an edge.
    pub(super) fn pieces(&self, pieces: Pieces) -> Option<Vec<EdgePiece>> {
        let positive = [self.radius_mm, self.height_mm].iter().all(|mm| *mm > 0.0 && mm.is_finite());
        if !(positive && self.corner_mm >= 0.0 && self.lag_rad_per_mm.is_finite()) {
            return None;
        }
        match pieces {
            Pieces::Along(count) => Some(self.along(count)),
            Pieces::Slices { rise_mm } => self.slices(rise_mm),
        }
    }

    fn along(&self, pieces: usize) -> Vec<EdgePiece> {
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
        arc.chain(wall).collect()
    }

    /// Divides the edge into slices, each with the lead angle that the edge has in the slice's middle.
    fn slices(&self, rise_mm: f64) -> Option<Vec<EdgePiece>> {
        let count = libm::ceil(self.height_mm / rise_mm - WHOLE_RATIO);
        let slice = |at: usize| {
            let height_mm = (at as f64 + 0.5) * rise_mm;
            let on_corner = height_mm < self.corner_mm;
            let lead_rad = if on_corner { libm::acos(1.0 - height_mm / self.corner_mm) } else { FRAC_PI_2 };
            self.piece(height_mm, rise_mm, lead_rad)
        };
        (1.0..=SLICES_MAX).contains(&count).then(|| (0..count as usize).map(slice).collect())
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
            radius_mm: self.radius_mm - f64::from(self.side.advance()) * inset_mm,
            angle_rad: height_mm * self.lag_rad_per_mm, // (6) of the parent
            lead_rad,
            side: self.side,
        }
    }
}
