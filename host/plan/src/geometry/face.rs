//! One side of a blade: a bicubic B-spline surface through its sections.
//!
//! ```text
//! t_j   = mean over sections of chord length up to point j, of the whole         (1)
//! u_j+p = (t_j + .. + t_j+p-1) / p                                               (2)
//! sum_i N_i(t_j) P_i = Q_j, along the sections and then across                   (3)
//! ```
//!
//! Source: L. Piegl, W. Tiller, *The NURBS Book*, 2nd ed., Springer 1997: eqs 9.5, 9.8, 9.20 to 9.23; 4.20 for derivatives. One set of parameters
//! for all sections keeps one knot vector. All weights are 1; the sum of the basis functions, which may round off 1, is divided by nevertheless.

use nalgebra::{DMatrix, Matrix3, Vector4};
use thiserror::Error;

use crate::vector::{Point, Vector};

use super::spline::{Basis, DEGREE_MAX, Spline, Weights};

/// Smooth surface over the unit square: u from the leading (0) to the trailing edge (1), v from the hub (0) to the tip
/// (1).
#[derive(Clone, Debug)]
pub struct Face {
    u: Spline,
    v: Spline,
    /// Control points, homogeneous, one row of `v` after the other.
    net: Vec<Vector4<f64>>,
    /// +1 if S_u x S_v points away from the blade, -1 if into it.
    outward: f64,
}

/// Point of a surface S(u, v) with its first and second derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Jet {
    /// Point S, mm.
    pub point: Point,
    /// Derivative S_u.
    pub u: Vector,
    /// Derivative S_v.
    pub v: Vector,
    /// Second derivative S_uu.
    pub uu: Vector,
    /// Second derivative S_uv.
    pub uv: Vector,
    /// Second derivative S_vv.
    pub vv: Vector,
}

/// Reason why a blade's sections define no surface.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FaceError {
    /// There are too few sections, or too few points in a section.
    #[error("a side of a blade needs two sections of four points at least, not {sections} of {points}")]
    TooFew {
        /// Number of sections.
        sections: usize,
        /// Number of points in the shortest section.
        points: usize,
    },
    /// The sections have different numbers of points.
    #[error("section {section} has {found} points, the first one {expected}")]
    Uneven {
        /// Section, from 1.
        section: usize,
        /// Number of its points.
        found: usize,
        /// Number of points of the first section.
        expected: usize,
    },
    /// Two neighbouring points coincide in all sections; the number is that of the point.
    #[error("points {0} and {next} of the sections lie in one place", next = .0 + 1)]
    Doubled(usize),
}

impl Face {
    /// Surface through `sections`, from the hub to the tip, each from the leading to the trailing edge, all with the
    /// same number of points. `outward` at its middle points away from the blade's material.
    ///
    /// # Errors
    /// There are too few points, or points coincide.
    pub fn through(sections: &[Vec<Point>], outward: Vector) -> Result<Self, FaceError> {
        check(sections)?;
        let columns = transposed(sections);
        let (u, along) = interpolation(&parameters(sections)?)?;
        let (v, across) = interpolation(&parameters(&columns)?)?;
        // (3), first every section, then every column of their control points
        let nets: Vec<Vec<Point>> = sections.iter().map(|points| solved(&along, points)).collect();
        let net =
            transposed(&nets).iter().flat_map(|column| solved(&across, column)).map(|p| p.to_homogeneous()).collect();
        let mut face = Face { u, v, net, outward: 1.0 };
        if face.normal(0.5, 0.5).dot(&outward) < 0.0 {
            face.outward = -1.0;
        }
        Ok(face)
    }

    /// Point at `(u, v)`; parameters outside the unit square are limited to it.
    pub fn point(&self, u: f64, v: f64) -> Point {
        let [u, v] = [self.u.basis::<1>(u.clamp(0.0, 1.0)), self.v.basis(v.clamp(0.0, 1.0))];
        let sum = combined(&self.isolines(&u, &v, 0), &v.rows[0]);
        Point::from(sum.xyz() / sum.w)
    }

    /// +1 if S_u x S_v points away from the blade, -1 if into it.
    pub fn outward(&self) -> f64 {
        self.outward
    }

    /// Unit normal, away from the blade.
    pub fn normal(&self, u: f64, v: f64) -> Vector {
        self.point_and_normal(u, v).1
    }

    /// Point of the surface moved outwards by the allowance.
    pub fn offset(&self, u: f64, v: f64, allowance_mm: f64) -> Point {
        let (point, normal) = self.point_and_normal(u, v);
        point + normal * allowance_mm
    }

    fn point_and_normal(&self, u: f64, v: f64) -> (Point, Vector) {
        let [u, v] = [self.u.basis::<2>(u.clamp(0.0, 1.0)), self.v.basis(v.clamp(0.0, 1.0))];
        let [on, by_u] = [0, 1].map(|order| self.isolines(&u, &v, order));
        let [s, su, sv] = [combined(&on, &v.rows[0]), combined(&by_u, &v.rows[0]), combined(&on, &v.rows[1])];
        let point = s.xyz() / s.w;
        let [along, across] = [su, sv].map(|derivative| (derivative.xyz() - point * derivative.w) / s.w);
        (Point::from(point), along.cross(&across).normalize() * self.outward)
    }

    /// Point at `(u, v)` with its derivatives up to the second.
    pub fn jet(&self, u: f64, v: f64) -> Jet {
        let [u, v] = [self.u.basis::<3>(u.clamp(0.0, 1.0)), self.v.basis(v.clamp(0.0, 1.0))];
        let lines = [0, 1, 2].map(|order| self.isolines(&u, &v, order));
        let at = |k: usize, l: usize| combined(&lines[k], &v.rows[l]);
        let w = at(0, 0).w;
        let point = at(0, 0).xyz() / w;
        let first = |sum: Vector4<f64>| (sum.xyz() - point * sum.w) / w;
        let (by_u, by_v) = (first(at(1, 0)), first(at(0, 1)));
        let twice = |sum: Vector4<f64>, by: Vector, weight: f64| (sum.xyz() - by * (2.0 * weight) - point * sum.w) / w;
        let [uu, vv] = [twice(at(2, 0), by_u, at(1, 0).w), twice(at(0, 2), by_v, at(0, 1).w)];
        let mixed = at(1, 1);
        let uv = (mixed.xyz() - by_u * at(0, 1).w - by_v * at(1, 0).w - point * mixed.w) / w;
        Jet { point: Point::from(point), u: by_u, v: by_v, uu, uv, vv }
    }

    /// Control points about a place, combined along u, with derivatives up to `order`.
    fn isolines<const ROWS: usize>(&self, u: &Basis<ROWS>, v: &Basis<ROWS>, order: usize) -> Isolines {
        let (wide, columns) = (self.v.count(), self.v.degree() + 1);
        let mut lines = Isolines::default();
        for (row, weight) in u.rows[order].iter().enumerate().take(self.u.degree() + 1) {
            let start = (u.first + row) * wide + v.first;
            for (line, point) in lines.iter_mut().zip(&self.net[start..start + columns]) {
                *line += point * *weight;
            }
        }
        lines
    }

    /// The same surface after a rotation or mirroring, with u counted from its other end if `is_reversed`.
    pub fn mapped(&self, map: &Matrix3<f64>, is_reversed: bool) -> Self {
        let mapped = |p: &Vector4<f64>| (map * p.xyz()).push(p.w);
        let rows = self.net.chunks(self.v.count());
        let ordered: Vec<_> = if is_reversed { rows.rev().flatten().collect() } else { rows.flatten().collect() };
        let net = ordered.into_iter().map(mapped).collect();
        let sense = if is_reversed { -1.0 } else { 1.0 };
        let u = if is_reversed { self.u.reversed() } else { self.u.clone() };
        let outward = libm::copysign(1.0, self.outward * sense * map.determinant());
        Face { u, v: self.v.clone(), net, outward }
    }

    /// The same surface with control points rounded to `grain_mm`, and knots to multiples of the largest power of two below 1e-9, so that mirror images
    /// and renumbered blades have exactly the same numbers.
    pub fn rounded(&self, grain_mm: f64) -> Self {
        let net = self.net.iter().map(|p| p.xyz().map(|mm| libm::round(mm / grain_mm) * grain_mm).push(p.w));
        Face { u: self.u.rounded(), v: self.v.rounded(), net: net.collect(), outward: self.outward }
    }

    /// The same surface after a rotation about the origin.
    pub fn turned(&self, turn: &nalgebra::Rotation3<f64>) -> Self {
        let net = self.net.iter().map(|p| (turn * p.xyz()).push(p.w)).collect();
        Face { net, ..self.clone() }
    }
}

/// Control points of the isoparametric curve across through a place.
type Isolines = [Vector4<f64>; DEGREE_MAX + 1];

fn combined(lines: &Isolines, weights: &Weights) -> Vector4<f64> {
    lines.iter().zip(weights).fold(Vector4::zeros(), |sum, (line, weight)| sum + line * *weight)
}

fn check(sections: &[Vec<Point>]) -> Result<(), FaceError> {
    let expected = sections.first().map_or(0, Vec::len);
    let points = sections.iter().map(Vec::len).min().unwrap_or(0);
    if sections.len() < 2 || points <= DEGREE_MAX {
        return Err(FaceError::TooFew { sections: sections.len(), points });
    }
    match sections.iter().position(|section| section.len() != expected) {
        Some(at) => Err(FaceError::Uneven { section: at + 1, found: sections[at].len(), expected }),
        None => Ok(()),
    }
}

fn transposed(rows: &[Vec<Point>]) -> Vec<Vec<Point>> {
    (0..rows[0].len()).map(|j| rows.iter().map(|row| row[j]).collect()).collect()
}

/// (1)
fn parameters(rows: &[Vec<Point>]) -> Result<Vec<f64>, FaceError> {
    let mut mean = vec![0.0; rows[0].len()];
    for row in rows {
        let steps: Vec<f64> = row.windows(2).map(|pair| (pair[1] - pair[0]).norm()).collect();
        let whole_mm: f64 = steps.iter().sum();
        let mut so_far_mm = 0.0;
        for (j, step_mm) in steps.iter().enumerate().filter(|_| whole_mm > 0.0) {
            so_far_mm += step_mm;
            mean[j + 1] += so_far_mm / whole_mm / rows.len() as f64;
        }
    }
    match mean.windows(2).position(|pair| pair[1] - pair[0] < 1e-9) {
        Some(at) => Err(FaceError::Doubled(at + 1)),
        None => {
            // The last one is a sum with rounding errors.
            let last = mean.len() - 1;
            mean[last] = 1.0;
            Ok(mean)
        }
    }
}

/// Knots (2), and the inverse of the matrix that (3) multiplies with the control points.
fn interpolation(parameters: &[f64]) -> Result<(Spline, DMatrix<f64>), FaceError> {
    let count = parameters.len();
    let degree = DEGREE_MAX.min(count - 1);
    let inner = (1..count - degree).map(|j| parameters[j..j + degree].iter().sum::<f64>() / degree as f64);
    let knots = std::iter::repeat_n(0.0, degree + 1).chain(inner).chain(std::iter::repeat_n(1.0, degree + 1)).collect();
    let spline = Spline::new(degree, knots);
    let mut weights = DMatrix::zeros(count, count);
    for (row, t) in parameters.iter().enumerate() {
        let Basis { first, rows: [values] } = spline.basis(*t);
        for (k, value) in values.into_iter().enumerate().take(degree + 1) {
            weights[(row, first + k)] = value;
        }
    }
    let inverse = weights.try_inverse().ok_or(FaceError::TooFew { sections: count, points: count })?;
    Ok((spline, inverse))
}

fn solved(inverse: &DMatrix<f64>, points: &[Point]) -> Vec<Point> {
    let row = |i: usize| {
        let terms = points.iter().enumerate().map(|(j, point)| point.coords * inverse[(i, j)]);
        Point::from(terms.sum::<Vector>())
    };
    (0..points.len()).map(row).collect()
}
