//! A blade: a plate with twist, taper, lean and camber, clamped at its foot.
//!
//! Frame: z up the span from the foot, at the foot x along the chord (before stagger) and y through the thickness, the origin in the middle of the foot's chord.
//! With s from -1/2 to 1/2 along the chord, n from -1/2 to 1/2 through the thickness, c the chord, theta the camber's angle:
//!
//! ```text
//! R = c / (2 sin(theta / 2))                                                       (1)
//! middle line: R (sin(s theta), cos(s theta) - cos(theta / 2))                     (2)
//! thickness, square to it: t (1 - (1 - e) (2 s)^2), e at the edges over the middle (3)
//! ```
//!
//! (1) and (2): a circle through both ends of the chord. (3) is a parabola, which a quadratic element represents
//! exactly.

use arcfeed_fe::mesh::{TetMesh, TetMeshError, graded};

/// Angle of camber below which the middle line is straight.
const STRAIGHT_RAD: f64 = 1e-9;

/// Blade, by its dimensions. Pairs of values are those at the foot and at the tip, with linear change between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blade {
    /// Length from foot to tip.
    pub span_mm: f64,
    /// Chord length of the section.
    pub chord_mm: [f64; 2],
    /// Thickness in the middle of the chord.
    pub thickness_mm: [f64; 2],
    /// Thickness at the edges, as a ratio of that in the middle.
    pub edge_ratio: f64,
    /// Camber angle of the section's middle line.
    pub camber_rad: [f64; 2],
    /// Stagger angle from x to the chord, about z.
    pub stagger_rad: [f64; 2],
    /// Lean angle from z to the line through the sections' origins, towards y.
    pub lean_rad: f64,
}

impl Blade {
    /// Blade that is a flat plate of constant thickness.
    pub fn plate(span_mm: f64, chord_mm: f64, thickness_mm: f64) -> Self {
        Blade {
            span_mm,
            chord_mm: [chord_mm; 2],
            thickness_mm: [thickness_mm; 2],
            edge_ratio: 1.0,
            camber_rad: [0.0; 2],
            stagger_rad: [0.0; 2],
            lean_rad: 0.0,
        }
    }

    /// Point of the blade, mm, at `s` along the chord, `n` through the thickness (both -1/2 to 1/2) and `height` (0 to 1) up the span.
    pub fn point_mm(&self, [s, n, height]: [f64; 3]) -> [f64; 3] {
        let at = |[foot, tip]: [f64; 2]| foot + (tip - foot) * height;
        let (chord_mm, camber) = (at(self.chord_mm), at(self.camber_rad));
        let thickness_mm = at(self.thickness_mm) * (1.0 - (1.0 - self.edge_ratio) * 4.0 * s * s); // (3)
        let (sin, cos) = libm::sincos(s * camber);
        let middle_mm = if camber.abs() < STRAIGHT_RAD {
            [s * chord_mm, 0.0]
        } else {
            let radius_mm = chord_mm / (2.0 * libm::sin(camber / 2.0)); // (1)
            [radius_mm * sin, radius_mm * (cos - libm::cos(camber / 2.0))] // (2)
        };
        let section_mm = [middle_mm[0] + n * thickness_mm * sin, middle_mm[1] + n * thickness_mm * cos];
        let (sin, cos) = libm::sincos(at(self.stagger_rad));
        let z_mm = height * self.span_mm;
        [
            cos * section_mm[0] - sin * section_mm[1],
            sin * section_mm[0] + cos * section_mm[1] + z_mm * libm::tan(self.lean_rad),
            z_mm,
        ]
    }

    /// Mesh with these numbers of cells along chord, thickness and span. Cells at the foot have `foot_ratio` of the height of those at
    /// the tip, with linear change between: use less than 1, because the bending changes fast near the clamp.
    ///
    /// # Errors
    /// An axis has no cells, or the shape folds cells.
    pub fn mesh(&self, cells: [usize; 3], foot_ratio: f64) -> Result<TetMesh, TetMeshError> {
        let part = |at: [f64; 3], axis: usize| at[axis] / cells[axis] as f64 - 0.5;
        let height = |at: f64| graded(at / cells[2] as f64, cells[2], foot_ratio);
        TetMesh::mapped(cells, |_| true, |at| self.point_mm([part(at, 0), part(at, 1), height(at[2])]))
    }

    /// Indices of the nodes at the foot (the clamped end) of a blade's mesh.
    pub fn foot(mesh: &TetMesh) -> Vec<usize> {
        mesh.nodes_where(|place| place[2] == 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWISTED: Blade = Blade {
        span_mm: 40.0,
        chord_mm: [30.0, 24.0],
        thickness_mm: [3.0, 1.5],
        edge_ratio: 0.5,
        camber_rad: [0.5, 0.3],
        stagger_rad: [0.4, 0.9],
        lean_rad: 0.1,
    };

    #[test]
    fn the_ends_of_a_section_are_a_chord_apart_and_its_tangents_turn_by_the_camber() {
        for height in [0.0, 1.0] {
            let way = |a: f64, b: f64| {
                let (p, q) = (TWISTED.point_mm([a, 0.0, height]), TWISTED.point_mm([b, 0.0, height]));
                [q[0] - p[0], q[1] - p[1]]
            };
            let chord = way(-0.5, 0.5);
            assert!((libm::hypot(chord[0], chord[1]) - (30.0 - 6.0 * height)).abs() < 1e-12);
            assert!((libm::atan2(chord[1], chord[0]) - (0.4 + 0.5 * height)).abs() < 1e-12);
            let angle = |[x, y]: [f64; 2]| libm::atan2(y, x);
            let turned = angle(way(-0.5, -0.499_999)) - angle(way(0.499_999, 0.5));
            assert!((turned - (0.5 - 0.2 * height)).abs() < 1e-5);
        }
    }

    #[test]
    fn a_blade_too_thick_for_its_camber_is_refused() {
        let folded = Blade { thickness_mm: [90.0; 2], camber_rad: [1.0; 2], ..Blade::plate(40.0, 30.0, 1.0) };
        assert!(matches!(folded.mesh([4, 1, 2], 1.0), Err(TetMeshError::Folded { .. })));
        assert!(TWISTED.mesh([4, 1, 4], 0.3).is_ok());
        assert_eq!(TWISTED.mesh([4, 0, 4], 1.0), Err(TetMeshError::Empty));
    }
}
