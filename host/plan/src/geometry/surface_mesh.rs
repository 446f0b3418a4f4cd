//! Triangles with common points, as other programs export surfaces, and the smooth curves that lie behind their edges.
//!
//! ```text
//! n_i  = sum of a x b / (a^2 b^2), a and b the edges from point i, over the triangles at it that turn by
//!        less than 40 degrees                                                                            normal         (1)
//! c_i  = cosine between the edge d and its projection on the plane of n_i
//! t_i  = 2 |d| / (1 + c_i), along that projection                                                        tangent        (2)
//! C(t) = cubic with both end points and tangents                                                         edge           (3)
//! ```
//!
//! Source of (1): N. Max, *Weights for computing vertex normals from facet normals*, Journal of Graphics Tools 4(2), 1999: exact on spheres. (3) is a circle's arc to the fourth order of its angle if the normals are the circle's, where the straight edge
//! deviates in the second. Edges at which two triangles turn by more stay straight.

use std::collections::HashMap;
use std::io::{Read, Seek};

use crate::vector::{Point, Vector};

use super::point_file::PointFileFrame;

/// Largest turn between two triangles of one smooth surface, degrees.
const SMOOTH_DEG: f64 = 40.0;

/// Surface as a mesh of triangles with common vertices, in the rotor's own frame, mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceMesh {
    /// Positions of the vertices.
    pub points: Vec<Point>,
    /// Triangles, each as the indices of its three vertices; all have the same sense about the surface.
    pub triangles: Vec<[usize; 3]>,
}

/// Edge of a mesh: indices of its two vertices, the smaller one first.
pub type EdgeKey = [usize; 2];

/// Cubic curve that replaces a straight edge of a mesh.
#[derive(Clone, Copy, Debug)]
pub struct EdgeCurve {
    ends: [Point; 2],
    tangents: [Vector; 2],
}

/// Triangle mesh with normals at its corners, from which the curved surface is estimated.
pub struct SmoothMesh<'m> {
    mesh: &'m SurfaceMesh,
    /// Unit normals of the triangles.
    normals: Vec<Vector>,
    /// (1), by corner.
    corners: Vec<[Vector; 3]>,
    /// Triangles at each edge.
    edges: HashMap<EdgeKey, Vec<usize>>,
}

impl SurfaceMesh {
    /// Reads an STL file, binary or ASCII.
    ///
    /// # Errors
    /// The file is no STL file, or not complete.
    pub fn from_stl<R: Read + Seek>(file: &mut R, frame: &PointFileFrame) -> std::io::Result<Self> {
        let read = stl_io::read_stl(file)?;
        let point = |vertex: &stl_io::Vertex| frame.point([0, 1, 2].map(|axis: usize| f64::from(vertex.0[axis])));
        let triangles = read.faces.iter().map(|face| face.vertices).filter(|[a, b, c]| a != b && b != c && c != a);
        Ok(SurfaceMesh { points: read.vertices.iter().map(point).collect(), triangles: triangles.collect() })
    }

    /// Adds a surface given as rows of points, all of the same length.
    pub fn add_rows(&mut self, rows: &[Vec<Point>]) {
        let first = self.points.len();
        let wide = rows.first().map_or(0, Vec::len);
        self.points.extend(rows.iter().flatten());
        let at = |row: usize, column: usize| first + row * wide + column;
        for row in 1..rows.len() {
            for column in 1..wide {
                let [a, b] = [at(row - 1, column - 1), at(row - 1, column)];
                let [c, d] = [at(row, column), at(row, column - 1)];
                self.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }

    /// Corners of a triangle.
    pub fn corners(&self, triangle: &[usize; 3]) -> [Point; 3] {
        triangle.map(|corner| self.points[corner])
    }

    /// Twice the area of a triangle along its normal.
    pub fn area_vector(&self, triangle: &[usize; 3]) -> Vector {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(&(c - a))
    }
}

impl EdgeCurve {
    /// Point at a parameter from 0 to 1. (3)
    pub fn at(&self, t: f64) -> Point {
        let [a, b] = self.ends;
        let (t2, t3) = (t * t, t * t * t);
        let along = self.tangents[0] * (t3 - 2.0 * t2 + t) + self.tangents[1] * (t3 - t2);
        a + (b - a) * (3.0 * t2 - 2.0 * t3) + along
    }
}

impl<'m> SmoothMesh<'m> {
    /// Computes the normals of a mesh.
    pub fn new(mesh: &'m SurfaceMesh) -> Self {
        let areas: Vec<Vector> = mesh.triangles.iter().map(|triangle| mesh.area_vector(triangle)).collect();
        let normals: Vec<Vector> = areas.iter().map(|area| area.try_normalize(0.0).unwrap_or_default()).collect();
        let mut about: Vec<Vec<usize>> = vec![Vec::new(); mesh.points.len()];
        let mut edges: HashMap<EdgeKey, Vec<usize>> = HashMap::new();
        for (index, triangle) in mesh.triangles.iter().enumerate() {
            triangle.iter().for_each(|corner| about[*corner].push(index));
            edge_keys(triangle).into_iter().for_each(|key| edges.entry(key).or_default().push(index));
        }
        let least_cos = libm::cos(SMOOTH_DEG.to_radians());
        let corner = |own: usize, point: usize| {
            let smooth = about[point].iter().filter(|other| normals[**other].dot(&normals[own]) > least_cos);
            let sum: Vector = smooth.map(|other| weighted(mesh, &mesh.triangles[*other], point)).sum(); // (1)
            sum.try_normalize(0.0).unwrap_or(normals[own])
        };
        let corners =
            mesh.triangles.iter().enumerate().map(|(own, triangle)| triangle.map(|point| corner(own, point))).collect();
        SmoothMesh { mesh, corners, normals, edges }
    }

    /// The mesh.
    pub fn mesh(&self) -> &SurfaceMesh {
        self.mesh
    }

    /// Estimated curve on the smooth surface for a mesh edge.
    pub fn curve(&self, [from, to]: EdgeKey) -> EdgeCurve {
        let ends = [self.mesh.points[from], self.mesh.points[to]];
        let way = ends[1] - ends[0];
        let beside = self.edges.get(&[from, to]).map_or(&[][..], Vec::as_slice);
        let is_smooth = beside
            .iter()
            .all(|triangle| self.normals[*triangle].dot(&self.normals[beside[0]]) > libm::cos(SMOOTH_DEG.to_radians()));
        if !is_smooth {
            return EdgeCurve { ends, tangents: [way; 2] };
        }
        let tangent = |point: usize| {
            let normal: Vector = beside.iter().map(|triangle| self.normal_at(*triangle, point)).sum();
            let Some(normal) = normal.try_normalize(0.0) else { return way };
            let flat = way - normal * way.dot(&normal);
            let cos = flat.norm() / way.norm();
            flat * (2.0 / (cos * (1.0 + cos))) // (2)
        };
        EdgeCurve { ends, tangents: [tangent(from), tangent(to)] }
    }

    fn normal_at(&self, triangle: usize, point: usize) -> Vector {
        let corner = self.mesh.triangles[triangle].iter().position(|corner| *corner == point).unwrap_or(0);
        self.corners[triangle][corner]
    }
}

/// Term of (1) of a triangle at one of its points.
fn weighted(mesh: &SurfaceMesh, triangle: &[usize; 3], point: usize) -> Vector {
    let first = triangle.iter().position(|corner| *corner == point).unwrap_or(0);
    let [own, next, last] = [0, 1, 2].map(|step: usize| mesh.points[triangle[(first + step) % 3]]);
    let (a, b) = (next - own, last - own);
    a.cross(&b) / (a.norm_squared() * b.norm_squared())
}

/// The three edges of a triangle, each with its corners in a fixed order.
pub fn edge_keys([a, b, c]: &[usize; 3]) -> [EdgeKey; 3] {
    [[a, b], [b, c], [c, a]].map(|[from, to]| [*from.min(to), *from.max(to)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_of_a_cylinders_mesh_are_arcs_to_the_fourth_order() {
        let mut last_mm = 0.0;
        for (steps, most_mm) in [(12_u32, 2e-3), (24, 1.3e-4), (48, 8e-6)] {
            let ring = |z: f64| -> Vec<Point> {
                let at = |k: u32| libm::sincos(core::f64::consts::TAU * f64::from(k) / f64::from(steps));
                (0..=steps).map(|k| Point::new(10.0 * at(k).1, 10.0 * at(k).0, z)).collect()
            };
            let mut mesh = SurfaceMesh::default();
            mesh.add_rows(&[-2.0, 0.0, 2.0].map(ring));
            let smooth = SmoothMesh::new(&mesh);
            let row = steps as usize + 1;
            // Edges of the middle ring away from the seam.
            let off_mm = |k: usize| {
                let curve = smooth.curve([row + k, row + k + 1]);
                let off = |t: u32| {
                    let point = curve.at(f64::from(t) / 16.0);
                    (libm::hypot(point.x, point.y) - 10.0).abs()
                };
                (0..=16).map(off).fold(0.0, f64::max)
            };
            let worst_mm = (2..row - 3).map(off_mm).fold(0.0, f64::max);
            println!(
                "{steps} facets: {worst_mm:.2e} mm off, straight {:.2e} mm",
                10.0 * (1.0 - libm::cos(core::f64::consts::PI / f64::from(steps)))
            );
            assert!(worst_mm < most_mm, "{worst_mm}");
            assert!(last_mm == 0.0 || last_mm / worst_mm > 14.0, "{last_mm} {worst_mm}");
            last_mm = worst_mm;
        }
    }
}
