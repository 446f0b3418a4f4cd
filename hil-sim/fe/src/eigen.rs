//! Lowest eigenvalues of `K x = lambda M x`, K and M positive definite.
//!
//! Block Lanczos method on the inverse: from a block of vectors V_1, orthonormal in M,
//!
//! ```text
//! W = K^-1 M V_j                                                                        (1)
//! V_(j+1) R = W - sum over all i up to j of V_i A_ij,    A_ij = V_i' M W                (2)
//! A s = theta s,   lambda = 1 / theta,   x = V s,   error of theta at most |R s_last|   (3)
//! ```
//!
//! Every new vector is made orthogonal to all before it, twice, so no vector returns and no false copy of an eigenvalue
//! appears. Eigenvalues repeated as often as the block has vectors are found together; [`below`] counts all of them, to
//! show that none is missing. Source: Grimes, Lewis, Simon, A shifted block Lanczos algorithm, SIAM J. Matrix Anal.
//! Appl. 15, 1994 (with shift zero, without its selective orthogonality); the bound: Parlett, The Symmetric Eigenvalue
//! Problem, chapter 13.

use std::fmt;

use nalgebra::{DMatrix, SymmetricEigen};

use super::sparse::{Factor, Singular, Sparse, add_scaled, dot};

/// Number of vectors in a block.
const BLOCK: usize = 4;

/// Largest relative error of 1 / lambda; that of the vectors' direction is of this order over the gap to the next
/// eigenvalue.
const TOLERANCE_RATIO: f64 = 1e-10;

/// Fraction of a vector below which it has no new component.
const NEW_MIN_RATIO: f64 = 1e-10;

/// Eigenvalue with its eigenvector x, scaled so that x' M x = 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Eigenpair {
    /// lambda, the square of the angular frequency.
    pub lambda_per_s2: f64,
    /// Eigenvector x.
    pub vector: Vec<f64>,
}

impl Eigenpair {
    /// Angular frequency.
    pub fn omega_rad_per_s(&self) -> f64 {
        libm::sqrt(self.lambda_per_s2)
    }
}

/// Reason why no eigenvalues were computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EigenError {
    /// The stiffness matrix is singular: nothing holds the body.
    Singular,
    /// More eigenvalues are requested than there are.
    TooMany {
        /// Number of unknowns, which is that of the eigenvalues.
        size: usize,
    },
}

impl fmt::Display for EigenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EigenError::Singular => write!(f, "the body is not held: clamp some of its nodes"),
            EigenError::TooMany { size } => write!(f, "more modes are requested than the body has: {size}"),
        }
    }
}

impl std::error::Error for EigenError {}

impl From<Singular> for EigenError {
    fn from(_: Singular) -> Self {
        EigenError::Singular
    }
}

/// Pseudo-random numbers, the same in every run.
struct Noise(u64);

impl Noise {
    fn vector(&mut self, size: usize) -> Vec<f64> {
        // Knuth's MMIX generator; the upper bits are the better ones.
        let mut next = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 40) as f64 / (1u64 << 23) as f64 - 1.0
        };
        (0..size).map(|_| next()).collect()
    }
}

/// Krylov space, extended block by block.
struct Krylov<'a> {
    m: &'a Sparse,
    inverse: Factor,
    basis: Vec<Vec<f64>>,
    /// Columns of A, each down to the last vector that existed when it was computed.
    projected: Vec<Vec<f64>>,
    noise: Noise,
}

/// The `count` lowest eigenvalues, in ascending order.
///
/// # Errors
/// K is singular, or there are fewer eigenvalues.
pub fn lowest(k: &Sparse, m: &Sparse, count: usize) -> Result<Vec<Eigenpair>, EigenError> {
    let size = k.size();
    if count > size {
        return Err(EigenError::TooMany { size });
    }
    let mut krylov = Krylov { m, inverse: Factor::of(k, 0.0, m)?, basis: vec![], projected: vec![], noise: Noise(1) };
    for _ in 0..BLOCK.min(size) {
        let start = krylov.noise.vector(size);
        krylov.add(start);
    }
    let (mut done, mut look_at) = (0, 2 * count);
    loop {
        // The W of the last block is not yet in the basis; its own part bounds the error in (3).
        let from = done;
        done = krylov.basis.len();
        for column in from..done {
            krylov.extend(column);
        }
        let is_all = done == size;
        if done >= look_at || is_all {
            if let Some(pairs) = krylov.pairs(done, count, is_all) {
                return Ok(pairs);
            }
            look_at = done + done / 8;
        }
    }
}

/// Number of eigenvalues below `lambda_per_s2`.
///
/// # Errors
/// The given value is an eigenvalue.
pub fn below(k: &Sparse, m: &Sparse, lambda_per_s2: f64) -> Result<usize, EigenError> {
    Ok(Factor::of(k, lambda_per_s2, m)?.negatives())
}

impl Krylov<'_> {
    /// Adds the new component of a vector to the basis, normalised in M; noise if there is none. Returns the vector's
    /// coefficients in the basis, the new one last. A basis as large as the space does not change.
    fn add(&mut self, mut vector: Vec<f64>) -> Vec<f64> {
        let mut coefficients = self.make_orthogonal(&mut vector);
        if self.basis.len() == vector.len() {
            return coefficients;
        }
        let mut length = self.length(&vector);
        let known = libm::sqrt(dot(&coefficients, &coefficients));
        let is_new = length > NEW_MIN_RATIO * known;
        coefficients.push(if is_new { length } else { 0.0 });
        if !is_new {
            vector = self.noise.vector(vector.len());
            self.make_orthogonal(&mut vector);
            length = self.length(&vector);
        }
        vector.iter_mut().for_each(|x| *x /= length);
        self.basis.push(vector);
        coefficients
    }

    fn length(&self, vector: &[f64]) -> f64 {
        libm::sqrt(dot(vector, &self.m.times(vector)))
    }

    /// Removes all components along the basis from a vector; twice, because the first pass leaves its own rounding.
    /// Returns the removed coefficients.
    fn make_orthogonal(&self, vector: &mut [f64]) -> Vec<f64> {
        let mut coefficients = vec![0.0; self.basis.len()];
        for _ in 0..2 {
            let in_m = self.m.times(vector);
            for (coefficient, base) in coefficients.iter_mut().zip(&self.basis) {
                let part = dot(base, &in_m);
                *coefficient += part;
                add_scaled(vector, -part, base);
            }
        }
        coefficients
    }

    /// (1) and (2) for one vector of the basis.
    fn extend(&mut self, column: usize) {
        let mut w = self.m.times(&self.basis[column]);
        self.inverse.solve(&mut w);
        let coefficients = self.add(w);
        self.projected.push(coefficients);
    }

    /// (3) with the first `done` vectors: the `count` lowest, if they are exact enough.
    fn pairs(&self, done: usize, count: usize, is_all: bool) -> Option<Vec<Eigenpair>> {
        // A is symmetric: of two equal entries the one in the later column is used, which has all rows needed.
        let entry = |row: usize, column: usize| self.projected[column].get(row).copied().unwrap_or(0.0);
        let a = DMatrix::from_fn(done, done, |i, j| entry(i.min(j), i.max(j)));
        let eigen = SymmetricEigen::new(a);
        let mut order: Vec<usize> = (0..done).collect();
        order.sort_by(|i, j| eigen.eigenvalues[*j].total_cmp(&eigen.eigenvalues[*i]));
        order.truncate(count);
        let error = |mode: usize| {
            let left_out = (done..self.basis.len()).map(|row| {
                let sum: f64 = (0..done).map(|column| entry(row, column) * eigen.eigenvectors[(column, mode)]).sum();
                sum * sum
            });
            libm::sqrt(left_out.sum())
        };
        if !is_all && !order.iter().all(|mode| error(*mode) <= TOLERANCE_RATIO * eigen.eigenvalues[*mode]) {
            return None;
        }
        let pair = |mode: usize| {
            let mut vector = vec![0.0; self.basis[0].len()];
            for (column, base) in self.basis[..done].iter().enumerate() {
                add_scaled(&mut vector, eigen.eigenvectors[(column, mode)], base);
            }
            Eigenpair { lambda_per_s2: 1.0 / eigen.eigenvalues[mode], vector }
        };
        Some(order.into_iter().map(pair).collect())
    }
}
