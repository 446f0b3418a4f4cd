//! Allowance of the measured surface above the nominal one, at places of equal arcs on lines u = const.
//!
//! ```text
//! D_n = (P - Q).n_Q,  P on the normal of Q          material to remove if positive, as the cutter meets it     (1)
//! D_p = |P - Q|,  P the measured point nearest to Q                                                           (2)
//! ```
//!
//! Source: Feng et al. measure (2). It is at most |(1)| and equal to first order; where they differ, at edges, (1) decides.

use super::arc_length::ArcLength;
use super::scan::{HeightField, NominalSurface};
use crate::geometry::face::{Face, FaceError};
use crate::geometry::surface::{SpanwiseFace, Surface, Unfolded};
use crate::vector::{Point, Vector};

/// Node: point of the nominal surface with its measured allowance.
#[derive(Clone, Copy, Debug)]
pub struct FieldNode {
    /// Parameters u and v of the point.
    pub at: [f64; 2],
    /// Position Q of the point.
    pub point: Point,
    /// Outward unit normal n_Q.
    pub normal: Vector,
    /// The point, as distances along the surface count from it.
    pub unfolded: Unfolded,
    /// Allowance D_n along the normal; `None` in a hole of the measurement.
    pub along_mm: Option<f64>,
    /// Distance D_p of the nearest measured point, with the sign of D_n; `None` in a hole of the measurement, and on a surface over an edge.
    pub nearest_mm: Option<f64>,
}

/// Measured allowance on a lattice of nodes: rows of constant u, from the root to the tip, all with the same number of nodes.
#[derive(Clone, Debug)]
pub struct AllowanceField {
    /// Rows of nodes.
    pub rows: Vec<Vec<FieldNode>>,
}

impl AllowanceField {
    /// Lattice with places at most `spacing_mm` apart, and the height above each.
    ///
    /// # Errors
    /// The measured points define no surface.
    pub fn new(nominal: &NominalSurface<'_>, heights: &HeightField, spacing_mm: f64) -> Result<Self, FaceError> {
        let mut field = AllowanceField::lattice(nominal.surface(), nominal.lengths_mm(), spacing_mm);
        for node in field.rows.iter_mut().flatten() {
            node.along_mm = heights.height_mm(node.at);
        }
        // Round an edge the places of the old surface lie too close for a B-spline through them.
        if !nominal.surface().is_over_edge() {
            field.measure_nearest()?;
        }
        Ok(field)
    }

    /// Lattice without allowances.
    pub fn lattice(surface: &dyn Surface, [along_mm, across_mm]: [f64; 2], spacing_mm: f64) -> Self {
        let count = |length_mm: f64| libm::ceil(length_mm / spacing_mm).max(4.0) as usize + 1;
        let [us, vs] = surface.ranges();
        let middle_v = (vs[0] + vs[1]) / 2.0;
        let up = ArcLength::new(us, |u| surface.jet([u, middle_v]).u.norm());
        let row = |u: f64| {
            let line = ArcLength::new(vs, |v| surface.speed_mm([u, v], surface.gauge_mm()));
            let node = |v: f64| {
                let (point, normal) = surface.point_and_normal([u, v]);
                let unfolded = surface.unfolded([u, v], &point);
                FieldNode { at: [u, v], point, normal, unfolded, along_mm: None, nearest_mm: None }
            };
            line.equal_arcs(count(across_mm)).into_iter().map(node).collect()
        };
        AllowanceField { rows: up.equal_arcs(count(along_mm)).into_iter().map(row).collect() }
    }

    /// (2) from the B-spline through the measured points of the lattice; holes take the height of a neighbour for it.
    fn measure_nearest(&mut self) -> Result<(), FaceError> {
        let known = |node: &FieldNode| node.along_mm;
        let measured: Vec<Vec<Point>> = self
            .rows
            .iter()
            .map(|row| {
                let mut last = row.iter().find_map(known).unwrap_or(0.0);
                let place = |node: &FieldNode| {
                    last = node.along_mm.unwrap_or(last);
                    node.point + node.normal * last
                };
                row.iter().map(place).collect()
            })
            .collect();
        let outward = self.rows[self.rows.len() / 2][self.rows[0].len() / 2].normal;
        let face = Face::through(&measured, outward)?;
        let surface = SpanwiseFace(&face);
        let (last_row, last_column) = ((self.rows.len() - 1) as f64, (self.rows[0].len() - 1) as f64);
        for (i, row) in self.rows.iter_mut().enumerate() {
            for (j, node) in row.iter_mut().enumerate() {
                let seed = [i as f64 / last_row, j as f64 / last_column];
                let distance = |along_mm: f64| {
                    let distance_mm = surface.foot(&node.point, seed).distance_mm;
                    // At the border of the patch the nearest point may be missing.
                    libm::copysign(distance_mm.min(along_mm.abs()), along_mm)
                };
                node.nearest_mm = node.along_mm.map(distance);
            }
        }
        Ok(())
    }

    /// Nodes.
    pub fn nodes(&self) -> impl Iterator<Item = &FieldNode> {
        self.rows.iter().flatten()
    }

    /// Area about a node: half of the cells beside it, on the surface displaced by `height_mm`.
    pub fn area_mm2(&self, row: usize, column: usize, height_mm: f64) -> f64 {
        let at = |i: usize, j: usize| self.rows[i][j].point + self.rows[i][j].normal * height_mm;
        let cell = |i: usize, j: usize| {
            let diagonals = (at(i + 1, j + 1) - at(i, j)).cross(&(at(i + 1, j) - at(i, j + 1)));
            diagonals.norm() / 2.0
        };
        let beside = |k: usize, count: usize| k.saturating_sub(1)..(k + 1).min(count - 1);
        let rows = beside(row, self.rows.len());
        rows.flat_map(|i| beside(column, self.rows[0].len()).map(move |j| (i, j))).map(|(i, j)| cell(i, j) / 4.0).sum()
    }
}
