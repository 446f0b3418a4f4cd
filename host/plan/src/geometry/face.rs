//! One side of a blade: a bicubic B-spline surface through its sections.
//!
//! ```text
//! t_j   = mean over sections of chord length up to point j, of the whole         (1)
//! u_j+p = (t_j + .. + t_j+p-1) / p                                               (2)
//! sum_i N_i(t_j) P_i = Q_j, along the sections and then across                   (3)
//! ```
//!
//! Source: L. Piegl, W. Tiller, *The NURBS Book*, 2nd ed., Springer 1997: eqs 9.5, 9.8, 9.20 to 9.23. One set of parameters for all sections
//! keeps one knot vector; the library's loft joins the knots of every section, some hundreds, lying next to each other.

use curvo::prelude::{KnotVector, NurbsSurface3D};
use nalgebra::{DMatrix, Point4};
use thiserror::Error;

use crate::vector::{Point, Vector};

/// Degree, where there are points enough.
const DEGREE: usize = 3;

/// A smooth surface over the unit square: u from the leading (0) to the trailing edge (1), v from the hub (0) to the tip (1).
#[derive(Clone, Debug)]
pub struct Face {
    surface: NurbsSurface3D<f64>,
    /// +1 where S_u x S_v points away from the blade, -1 where into it.
    outward: f64,
}

/// A point of a surface with its derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Jet {
    /// S
    pub point: Point,
    /// S_u
    pub u: Vector,
    /// S_v
    pub v: Vector,
    /// S_uu
    pub uu: Vector,
    /// S_uv
    pub uv: Vector,
    /// S_vv
    pub vv: Vector,
}

/// Why sections make no surface.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FaceError {
    /// Too few.
    #[error("a side of a blade needs two sections of four points at least, not {sections} of {points}")]
    TooFew {
        /// Sections.
        sections: usize,
        /// Points in the shortest.
        points: usize,
    },
    /// Lengths differ.
    #[error("section {section} has {found} points, the first one {expected}")]
    Uneven {
        /// Which, from 1.
        section: usize,
        /// Its points.
        found: usize,
        /// The first one's.
        expected: usize,
    },
    /// Two points in one place, for all sections.
    #[error("points {0} and {next} of the sections lie in one place", next = .0 + 1)]
    Doubled(usize),
}

impl Face {
    /// The surface through `sections`, from the hub to the tip, each from the leading to the trailing edge, all of one length. `outward` at
    /// its middle points away from the blade's material.
    ///
    /// # Errors
    /// Too few points, or they lie in one place.
    pub fn through(sections: &[Vec<Point>], outward: Vector) -> Result<Self, FaceError> {
        check(sections)?;
        let columns = transposed(sections);
        let (u_knots, along) = interpolation(&parameters(sections)?)?;
        let (v_knots, across) = interpolation(&parameters(&columns)?)?;
        // (3), first every section, then every column of their control points
        let nets: Vec<Vec<Point>> = sections.iter().map(|points| solved(&along, points)).collect();
        let net: Vec<Vec<Point4<f64>>> = transposed(&nets)
            .iter()
            .map(|column| solved(&across, column).iter().map(|p| Point4::new(p.x, p.y, p.z, 1.0)).collect())
            .collect();
        let degree = |count: usize| DEGREE.min(count - 1);
        let surface = NurbsSurface3D::new(degree(columns.len()), degree(sections.len()), u_knots, v_knots, net);
        let mut face = Face { surface, outward: 1.0 };
        if face.normal(0.5, 0.5).dot(&outward) < 0.0 {
            face.outward = -1.0;
        }
        Ok(face)
    }

    /// The point at `(u, v)`; beyond the unit square that of its border.
    pub fn point(&self, u: f64, v: f64) -> Point {
        self.surface.point_at(u.clamp(0.0, 1.0), v.clamp(0.0, 1.0))
    }

    /// The unit normal, away from the blade.
    pub fn normal(&self, u: f64, v: f64) -> Vector {
        let ders = self.surface.rational_derivatives(u.clamp(0.0, 1.0), v.clamp(0.0, 1.0), 1);
        ders[1][0].cross(&ders[0][1]).normalize() * self.outward
    }

    /// The point of the surface that lies `allowance` outside of this one.
    pub fn offset(&self, u: f64, v: f64, allowance_mm: f64) -> Point {
        self.point(u, v) + self.normal(u, v) * allowance_mm
    }

    /// Point and derivatives up to the second.
    pub fn jet(&self, u: f64, v: f64) -> Jet {
        let ders = self.surface.rational_derivatives(u.clamp(0.0, 1.0), v.clamp(0.0, 1.0), 2);
        let point = Point::from(ders[0][0]);
        Jet { point, u: ders[1][0], v: ders[0][1], uu: ders[2][0], uv: ders[1][1], vv: ders[0][2] }
    }

    /// The same surface elsewhere: every point moved by a turn about the origin.
    pub fn turned(&self, turn: &nalgebra::Rotation3<f64>) -> Self {
        let net = self.surface.control_points().iter();
        let net = net.map(|row| row.iter().map(|p| turned(turn, p)).collect()).collect();
        let (u, v) = (self.surface.u_knots().clone(), self.surface.v_knots().clone());
        let surface = NurbsSurface3D::new(self.surface.u_degree(), self.surface.v_degree(), u, v, net);
        Face { surface, outward: self.outward }
    }
}

fn turned(turn: &nalgebra::Rotation3<f64>, point: &Point4<f64>) -> Point4<f64> {
    let place = turn * Vector::new(point.x, point.y, point.z);
    Point4::new(place.x, place.y, place.z, point.w)
}

fn check(sections: &[Vec<Point>]) -> Result<(), FaceError> {
    let expected = sections.first().map_or(0, Vec::len);
    let points = sections.iter().map(Vec::len).min().unwrap_or(0);
    if sections.len() < 2 || points <= DEGREE {
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
            // The last one is the sum of rounded shares.
            let last = mean.len() - 1;
            mean[last] = 1.0;
            Ok(mean)
        }
    }
}

/// Knots (2) and the inverse of what (3) multiplies the control points with.
fn interpolation(parameters: &[f64]) -> Result<(KnotVector<f64>, DMatrix<f64>), FaceError> {
    let count = parameters.len();
    let degree = DEGREE.min(count - 1);
    let inner = (1..count - degree).map(|j| parameters[j..j + degree].iter().sum::<f64>() / degree as f64);
    let knots: Vec<f64> =
        std::iter::repeat_n(0.0, degree + 1).chain(inner).chain(std::iter::repeat_n(1.0, degree + 1)).collect();
    let knots = KnotVector::new(knots);
    let mut weights = DMatrix::zeros(count, count);
    for (row, t) in parameters.iter().enumerate() {
        let span = knots.find_knot_span_index(count - 1, degree, *t);
        for (k, value) in knots.basis_functions(span, *t, degree).into_iter().enumerate() {
            weights[(row, span - degree + k)] = value;
        }
    }
    let inverse = weights.try_inverse().ok_or(FaceError::TooFew { sections: count, points: count })?;
    Ok((knots, inverse))
}

fn solved(inverse: &DMatrix<f64>, points: &[Point]) -> Vec<Point> {
    let row = |i: usize| {
        let terms = points.iter().enumerate().map(|(j, point)| point.coords * inverse[(i, j)]);
        Point::from(terms.sum::<Vector>())
    };
    (0..points.len()).map(row).collect()
}
