//! Mesh of a wall or a blade from a closed surface: the volume between two sides, clamped at a face square to its span.
//!
//! Three axes: span, from the clamp; thickness, from side to side; chord, the third. The solid is cut square to the
//! span at every layer of nodes. Nodes at corners, on edges and in faces of elements are on its true sides, so that
//! bent sides are represented as well as quadratic elements can. Cells at the clamp have a fifth of the length of those
//! at the other end.

use std::fmt;

use arcfeed_kinematics::vector::Vector;

use super::clamped_block::Face;
use super::mesh::{TetMesh, TetMeshError};
use super::sides::{NoSides, SheetSection};
use arcfeed_dexel::mesh::Mesh as Surface;
use arcfeed_dexel::outline::{Outline, Point2};
use arcfeed_dexel::solid::Solid;

/// Distance of cuts from both ends, as a fraction of the span, because faces at the ends may be in the plane.
const ASIDE_RATIO: f64 = 1e-4;

/// Distance from an end, as a fraction of the span, at which a section is compared with the one at the end.
const NEAR_RATIO: f64 = 0.01;

/// Smallest ratio of the areas of two sections that are this near, or of neighbouring layers of nodes.
const ALIKE_RATIO: f64 = 0.5;

/// Largest difference of volume between elements and solid, as a fraction.
const VOLUME_RATIO: f64 = 0.05;

/// Thin solid that is meshed between its lower and upper side, with the axes of the mesh.
#[derive(Clone, Copy, Debug)]
pub struct Sheet<'a> {
    /// Surface of the solid.
    pub surface: &'a Surface,
    /// Axis through the thickness, 0 to 2.
    pub thickness: usize,
    /// Clamped face; its axis is the axis of the span.
    pub held: Face,
}

/// Reason why a sheet cannot be meshed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SheetError {
    /// No cells along an axis, or thickness along the span.
    Axes,
    /// The solid does not have two sides.
    NoSides {
        /// Axis of the thickness.
        axis: usize,
        /// Point on the line that meets the solid.
        at_mm: Vector,
        /// Number of times that the line meets the solid.
        count: usize,
    },
    /// An end of the span is slanted, round or pointed.
    NotFlat {
        /// Axis of the span.
        axis: usize,
        /// Coordinate of the end.
        at_mm: f64,
    },
    /// The section grows or shrinks too fast for the cells.
    Unlike {
        /// Axis of the span.
        axis: usize,
        /// Coordinates of two layers of nodes.
        at_mm: [f64; 2],
    },
    /// A cell is folded.
    Folded {
        /// Middle of the cell.
        at_mm: Vector,
    },
    /// The volume of the elements differs from that of the solid.
    Volume {
        /// Volume of the elements.
        mesh_mm3: f64,
        /// Volume of the solid.
        solid_mm3: f64,
    },
}

/// Names of the axes.
const NAMES: [&str; 3] = ["X", "Y", "Z"];

impl fmt::Display for SheetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SheetError::Axes => {
                write!(f, "a wall or a blade has cells along each axis, and its thickness not along its span")
            }
            SheetError::NoSides { axis, at_mm: [x, y, z], count } => write!(
                f,
                "at X{x:.3} Y{y:.3} Z{z:.3} a line through the thickness meets the body {count} times: it is no wall or blade along {}",
                NAMES[*axis]
            ),
            SheetError::NotFlat { axis, at_mm } => write!(
                f,
                "at {0}{at_mm:.3} the body does not end in a flat face square to {0}: cut it off there",
                NAMES[*axis]
            ),
            SheetError::Unlike { axis, at_mm: [from_mm, to_mm] } => write!(
                f,
                "between {0}{from_mm:.3} and {0}{to_mm:.3} the body's section changes to less than half or more than twice: leave out what is no wall or blade, or \
                 take more cells along {0}",
                NAMES[*axis]
            ),
            SheetError::Folded { at_mm: [x, y, z] } => write!(
                f,
                "at X{x:.3} Y{y:.3} Z{z:.3} a cell is folded: the body is too bent, twisted or pointed for these cells, take more of them"
            ),
            SheetError::Volume { mesh_mm3, solid_mm3 } => write!(
                f,
                "the cells enclose {mesh_mm3:.1} mm3 of the body's {solid_mm3:.1}: take more of them, or leave out what is no wall or blade"
            ),
        }
    }
}

impl std::error::Error for SheetError {}

impl Sheet<'_> {
    /// A mesh with cells along x, y and z.
    ///
    /// # Errors
    /// The solid is no sheet between two flat ends, or the cells do not follow it.
    pub fn mesh(&self, cells: [usize; 3]) -> Result<TetMesh, SheetError> {
        let (thickness, span) = (self.thickness, self.held.axis);
        if thickness == span || cells.contains(&0) {
            return Err(SheetError::Axes);
        }
        let chord = 3 - thickness - span;
        self.check_ends()?;
        let part = |half: usize| self.held.graded(half as f64 / (2 * cells[span]) as f64, cells[span]);
        let cuts: Vec<(f64, Outline)> = (0..=2 * cells[span]).map(|half| self.cut(part(half))).collect();
        self.check_neighbours(&cuts)?;
        let layers = self.layers(&cuts, 2 * cells[chord] + 1)?;
        let place = |at: [f64; 3]| {
            // Whole numbers of half cells.
            let [row, column] = [span, chord].map(|axis| (2.0 * at[axis]) as usize);
            let part = at[thickness] / cells[thickness] as f64;
            let [lower, upper] = layers[row][column];
            self.place(cuts[row].0, [0, 1].map(|k| lower[k] * (1.0 - part) + upper[k] * part))
        };
        let middle = |cell: [usize; 3]| place(cell.map(|cell| cell as f64 + 0.5));
        let mesh = TetMesh::mapped(cells, |_| true, place).map_err(|error| match error {
            TetMeshError::Empty => SheetError::Axes,
            TetMeshError::Folded { element } => SheetError::Folded { at_mm: middle(cell_of(element, cells)) },
        })?;
        let (mesh_mm3, solid_mm3) = (mesh.volume_mm3(), self.surface.volume_mm3());
        let is_whole = (mesh_mm3 / solid_mm3 - 1.0).abs() <= VOLUME_RATIO;
        if is_whole { Ok(mesh) } else { Err(SheetError::Volume { mesh_mm3, solid_mm3 }) }
    }

    /// Coordinate at a fraction of the span, and the cut there.
    fn cut(&self, part: f64) -> (f64, Outline) {
        let span = self.held.axis;
        let [low, high] = self.surface.bounds_mm().map(|corner| corner[span]);
        let at_mm = |part: f64| low * (1.0 - part) + high * part;
        let axes = [3 - self.thickness - span, self.thickness];
        (at_mm(part), Outline::of(self.surface, axes, at_mm(part.clamp(ASIDE_RATIO, 1.0 - ASIDE_RATIO))))
    }

    /// Points on both sides of each cut, `places` of them.
    fn layers(&self, cuts: &[(f64, Outline)], places: usize) -> Result<Vec<Vec<[Point2; 2]>>, SheetError> {
        let no_sides = |at_mm: f64, NoSides { at_mm: flat, count }: NoSides| SheetError::NoSides {
            axis: self.thickness,
            at_mm: self.place(at_mm, flat),
            count,
        };
        let mut sections = Vec::with_capacity(cuts.len());
        for (at_mm, outline) in cuts {
            sections.push(SheetSection::of(outline).map_err(|error| no_sides(*at_mm, error))?);
        }
        let insets_mm = [0, 1].map(|end: usize| evened(sections.iter().map(|section| section.inset_mm[end]).collect()));
        let of_layer = |layer: usize| {
            let inset_mm = [insets_mm[0][layer], insets_mm[1][layer]];
            sections[layer].sides(inset_mm, places).map_err(|error| no_sides(cuts[layer].0, error))
        };
        (0..cuts.len()).map(of_layer).collect()
    }

    /// Point in the plane at a coordinate along the span.
    fn place(&self, at_mm: f64, [along_mm, through_mm]: Point2) -> Vector {
        [0, 1, 2].map(|axis: usize| match axis {
            axis if axis == self.held.axis => at_mm,
            axis if axis == self.thickness => through_mm,
            _ => along_mm,
        })
    }

    fn check_ends(&self) -> Result<(), SheetError> {
        for (end, near) in [(0.0, NEAR_RATIO), (1.0, 1.0 - NEAR_RATIO)] {
            let ((at_mm, at_end), (_, near_it)) = (self.cut(end), self.cut(near));
            if at_end.area_mm2() < ALIKE_RATIO * near_it.area_mm2() {
                return Err(SheetError::NotFlat { axis: self.held.axis, at_mm });
            }
        }
        Ok(())
    }

    fn check_neighbours(&self, cuts: &[(f64, Outline)]) -> Result<(), SheetError> {
        for pair in cuts.windows(2) {
            let [below, above] = [0, 1].map(|k| pair[k].1.area_mm2());
            if below.min(above) < ALIKE_RATIO * below.max(above) {
                return Err(SheetError::Unlike { axis: self.held.axis, at_mm: [pair[0].0, pair[1].0] });
            }
        }
        Ok(())
    }
}

/// Values not less than before, without the jumps that facets of an edge cause from layer to layer: the mean of three
/// neighbours, each the largest of three.
fn evened(values: Vec<f64>) -> Vec<f64> {
    let around = |at: usize| at.saturating_sub(1)..(at + 2).min(values.len());
    let greatest: Vec<f64> =
        (0..values.len()).map(|at| values[around(at)].iter().copied().fold(0.0, f64::max)).collect();
    (0..values.len()).map(|at| greatest[around(at)].iter().sum::<f64>() / around(at).len() as f64).collect()
}

/// Cell of an element; each cell has six elements.
fn cell_of(element: usize, cells: [usize; 3]) -> [usize; 3] {
    let index = element / 6;
    [index % cells[0], index / cells[0] % cells[1], index / (cells[0] * cells[1])]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Solid between a face below and one above, both with corners in the right-handed sense about z.
    fn hexahedron(corners: [[Vector; 4]; 2]) -> Surface {
        let sides = (0..4).flat_map(|k| [[k, (k + 1) % 4, (k + 1) % 4 + 4], [k, (k + 1) % 4 + 4, k + 4]]);
        let ends = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]];
        Surface::new(corners.concat(), sides.chain(ends).collect()).unwrap()
    }

    /// A rectangle about the origin, turned about z.
    fn rectangle([length_mm, width_mm]: Point2, turned_rad: f64, z_mm: f64) -> [Vector; 4] {
        let (sin, cos) = libm::sincos(turned_rad);
        [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|[x, y]| {
            let (x_mm, y_mm) = (x * length_mm, y * width_mm);
            [cos * x_mm - sin * y_mm, sin * x_mm + cos * y_mm, z_mm]
        })
    }

    const HELD: Face = Face { axis: 2, is_upper: false };

    fn upright(surface: &Surface) -> Sheet<'_> {
        Sheet { surface, thickness: 1, held: HELD }
    }

    #[test]
    fn a_leaning_bar_is_meshed_squarely_up_to_its_edges() {
        for turned_rad in [0.0, 0.3, -0.8] {
            let surface = hexahedron([0.0, 9.0].map(|z_mm| rectangle([12.0, 2.0], turned_rad, z_mm)));
            let mesh = upright(&surface).mesh([4, 1, 3]).unwrap();
            assert!((mesh.volume_mm3() - 216.0).abs() < 1e-6, "{turned_rad}: {}", mesh.volume_mm3());
            let corner = mesh.nodes_where(|place| place == [8, 2, 0])[0];
            let truth = rectangle([12.0, 2.0], turned_rad, 0.0)[2];
            assert!((0..3).all(|k| (mesh.nodes_mm()[corner][k] - truth[k]).abs() < 1e-8), "{turned_rad}");
        }
    }

    #[test]
    fn a_wall_thinner_at_its_top_is_as_large_as_it_is() {
        let surface = hexahedron([rectangle([20.0, 4.0], 0.0, 0.0), rectangle([14.0, 2.0], 0.0, 10.0)]);
        let mesh = upright(&surface).mesh([6, 1, 6]).unwrap();
        // A prismatoid, its middle section 17 by 3.
        assert!((mesh.volume_mm3() - 10.0 / 6.0 * (80.0 + 4.0 * 51.0 + 28.0)).abs() < 1e-2, "{}", mesh.volume_mm3());
    }

    #[test]
    fn a_solid_that_is_no_sheet_is_refused() {
        let pointed = hexahedron([rectangle([20.0, 4.0], 0.0, 0.0), rectangle([0.1, 0.1], 0.0, 10.0)]);
        let leaning = |z_mm: f64| {
            let mut top = rectangle([20.0, 4.0], 0.0, z_mm);
            (top[1][2], top[2][2]) = (z_mm + 0.1, z_mm + 0.1);
            hexahedron([rectangle([20.0, 4.0], 0.0, 0.0), top])
        };
        for (surface, cells, expected) in [
            (&pointed, [6, 0, 6], SheetError::Axes),
            (&leaning(10.0), [6, 1, 6], SheetError::NotFlat { axis: 2, at_mm: 10.1 }),
        ] {
            assert_eq!(upright(surface).mesh(cells), Err(expected));
        }
        assert_eq!(Sheet { thickness: 2, ..upright(&pointed) }.mesh([6, 1, 6]), Err(SheetError::Axes));
        assert!(matches!(upright(&pointed).mesh([6, 1, 6]), Err(SheetError::NotFlat { .. })));
    }
}
