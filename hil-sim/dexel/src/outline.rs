//! Section of a closed surface by a plane: closed polygons, and the material along lines in the plane.
//!
//! ```text
//! area = sum over pieces of a x b / 2        (1)
//! ```
//!
//! A vertex counts either as below the plane or as above it, and the end of an edge either as right of a line or as left of
//! it. Neighbouring triangles and edges agree on this, so closed polygons stay closed even if plane or line meet a vertex.
//!
//! Source: (1) Green's theorem.

use super::dexel::Dexel;
use super::mesh::{Mesh, wound};

/// Point of the plane, mm, or direction in it.
pub type Point2 = [f64; 2];

/// Section of a closed mesh by a plane: closed polygons, as directed edges with the solid on their left.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    pieces: Vec<[Point2; 2]>,
}

fn cross([a, b]: Point2, [c, d]: Point2) -> f64 {
    a * d - b * c
}

fn difference([a, b]: Point2, [c, d]: Point2) -> Point2 {
    [a - c, b - d]
}

impl Outline {
    /// Section of a mesh by the plane that two different axes (0, 1, 2 for x, y, z) span, at a coordinate along the third axis.
    pub fn of(mesh: &Mesh, axes: [usize; 2], at_mm: f64) -> Self {
        let is_mirrored = (axes[0] + 1) % 3 != axes[1];
        let pieces = mesh.triangles().iter().filter_map(|triangle| {
            let [down, up] = piece(mesh, triangle, axes, at_mm)?;
            Some(if is_mirrored { [up, down] } else { [down, up] })
        });
        Outline { pieces: pieces.collect() }
    }

    /// Enclosed area. (1)
    pub fn area_mm2(&self) -> f64 {
        self.pieces.iter().map(|[a, b]| cross(*a, *b) / 2.0).sum()
    }

    /// Lowest and highest coordinate of the outline along the direction `along`, measured from the point `from_mm`; `None` if the
    /// plane does not meet the solid.
    pub fn extent_mm(&self, from_mm: Point2, along: Point2) -> Option<[f64; 2]> {
        let at = self.pieces.iter().map(|[end, _]| dot(difference(*end, from_mm), along));
        at.fold(None, |extent, at| {
            let [low, high] = extent.unwrap_or([at; 2]);
            Some([at.min(low), at.max(high)])
        })
    }

    /// Material on the line through a point; the coordinate is measured from that point along `along`, a direction of length 1.
    pub fn on_line(&self, through_mm: Point2, along: Point2) -> Dexel {
        let mut crossings: Vec<(usize, f64, i32)> = Vec::new();
        for ends in &self.pieces {
            let [from, to] = ends.map(|end| difference(end, through_mm));
            let [before, after] = [cross(along, from), cross(along, to)];
            let sense = match (before < 0.0, after < 0.0) {
                (true, false) => 1,
                (false, true) => -1,
                _ => continue,
            };
            crossings.push((0, (dot(from, along) * after - dot(to, along) * before) / (after - before), sense));
        }
        crossings.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.2.cmp(&b.2)));
        wound(&crossings)
    }
}

fn dot([a, b]: Point2, [c, d]: Point2) -> f64 {
    a * c + b * d
}

/// From where a triangle's border comes down through the plane to where it goes up: along the first axis, the second and
/// the third as a right hand has them, the solid is on the left.
fn piece(mesh: &Mesh, triangle: &[usize; 3], axes: [usize; 2], at_mm: f64) -> Option<[Point2; 2]> {
    let height_mm = |vertex: usize| mesh.vertices_mm()[vertex][3 - axes[0] - axes[1]] - at_mm;
    let is_below = triangle.map(|vertex| height_mm(vertex) < 0.0);
    let crossing = |from_below: bool| {
        let side = (0..3).find(|side| is_below[*side] == from_below && is_below[(side + 1) % 3] != from_below)?;
        // In the same order for both triangles of an edge.
        let [a, b] = [triangle[side], triangle[(side + 1) % 3]];
        let (a, b) = (a.min(b), a.max(b));
        let (low, high) = (height_mm(a), height_mm(b));
        let part = low / (low - high);
        Some(axes.map(|axis| {
            let [from_mm, to_mm] = [a, b].map(|vertex| mesh.vertices_mm()[vertex][axis]);
            from_mm + (to_mm - from_mm) * part
        }))
    };
    Some([crossing(false)?, crossing(true)?])
}

#[cfg(test)]
mod tests {
    use super::super::dexel::Interval;
    use super::*;

    /// Corners at 0 and 2, 3, 4 along the axes.
    fn tetrahedron() -> Mesh {
        let corners = vec![[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 4.0]];
        Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap()
    }

    #[test]
    fn a_plane_and_its_lines_have_their_part_of_a_tetrahedron() {
        for (axes, at_mm, area_mm2, width_mm) in [
            ([0, 1], 2.0, 0.75, 1.0),
            ([1, 0], 2.0, 0.75, 1.5),
            ([1, 2], 1.0, 1.5, 1.5),
            ([2, 0], 1.5, 1.0, 2.0),
            ([0, 1], 4.0, 0.0, 0.0),
        ] {
            let outline = Outline::of(&tetrahedron(), axes, at_mm);
            assert!((outline.area_mm2() - area_mm2).abs() < 1e-12, "{axes:?} {at_mm}: {outline:?}");
            let extent_mm = outline.extent_mm([0.0; 2], [1.0, 0.0]).unwrap_or_default();
            assert!((extent_mm[1] - extent_mm[0] - width_mm).abs() < 1e-12, "{axes:?} {at_mm}: {extent_mm:?}");
        }
    }

    #[test]
    fn a_line_is_met_once_even_through_corners() {
        let outline = Outline::of(&tetrahedron(), [0, 1], 2.0);
        // Corners at (0, 0), (1, 0) and (0, 1.5); along the border the solid is on one side only.
        for (through_mm, along, expected) in [
            ([0.5, -1.0], [0.0, 1.0], Some([1.0, 1.75])),
            ([-1.0, 0.75], [1.0, 0.0], Some([1.0, 1.5])),
            ([0.0, -1.0], [0.0, 1.0], Some([1.0, 2.5])),
            ([0.0, -1.0], [0.0, -1.0], None),
            ([1.0, 0.0], [0.0, 1.0], None),
            ([2.0, 0.0], [0.0, 1.0], None),
        ] {
            let found = outline.on_line(through_mm, along);
            let expected = expected.map(|[from_mm, to_mm]| Interval { from_mm, to_mm });
            assert_eq!(found.extent(), expected, "{through_mm:?} {along:?}: {found:?}");
        }
    }
}
