//! Sparse symmetric matrices, and the factors of those with a narrow envelope.
//!
//! ```text
//! A = L D L'     L with ones on its diagonal, within the envelope of A            (1)
//! ```
//!
//! Rows are reduced one by one, each within the columns from its first entry to its diagonal; entries before stay zero.
//! D has as many negative entries as A has negative eigenvalues (Sylvester's law of inertia). Source: Bathe, Finite
//! Element Procedures, 2nd ed., section 8.2. There is no pivoting: K - s M is only factored away from eigenvalues.

use std::ops::Range;

/// Sparse symmetric matrix, stored as its lower triangle with the diagonal, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Sparse {
    starts: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
}

/// Error: a pivot is zero, because the matrix is singular, like the stiffness of a body without a clamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Singular {
    /// Row of the pivot.
    pub row: usize,
}

/// Triangular factorisation L D L' of a symmetric matrix. (1)
#[derive(Clone, Debug)]
pub struct Factor {
    /// First column of each row.
    firsts: Vec<usize>,
    starts: Vec<usize>,
    /// Rows of L without the ones on the diagonal.
    lower: Vec<f64>,
    diagonal: Vec<f64>,
}

/// Smallest fraction of the diagonal entry that may remain as a pivot; less is rounding.
const PIVOT_MIN_RATIO: f64 = 1e-13;

/// Dot product, in four independent sums, so that the processor does not wait for each addition.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a_fours, b_fours) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a_fours.remainder().iter().zip(b_fours.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a_fours.zip(b_fours) {
        for k in 0..4 {
            sums[k] += x[k] * y[k];
        }
    }
    rest + (sums[0] + sums[1]) + (sums[2] + sums[3])
}

/// `y += factor x`.
pub(super) fn add_scaled(y: &mut [f64], factor: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * x;
    }
}

impl Sparse {
    /// Matrix from entries (column, value) of each row, in any order, with columns up to the row's own number; entries
    /// of equal column add up.
    pub fn from_rows(rows: Vec<Vec<(usize, f64)>>) -> Self {
        let mut matrix = Sparse { starts: vec![0], columns: Vec::new(), values: Vec::new() };
        for mut row in rows {
            row.sort_by_key(|(column, _)| *column);
            let start = matrix.columns.len();
            for (column, value) in row {
                if matrix.columns.len() > start && matrix.columns.last() == Some(&column) {
                    let last = matrix.values.len() - 1;
                    matrix.values[last] += value;
                } else {
                    matrix.columns.push(column);
                    matrix.values.push(value);
                }
            }
            matrix.starts.push(matrix.columns.len());
        }
        matrix
    }

    /// Number of rows and columns.
    pub fn size(&self) -> usize {
        self.starts.len() - 1
    }

    fn row(&self, row: usize) -> impl Iterator<Item = (usize, f64)> {
        let range: Range<usize> = self.starts[row]..self.starts[row + 1];
        self.columns[range.clone()].iter().copied().zip(self.values[range].iter().copied())
    }

    /// The matrix times a vector.
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.size()];
        for row in 0..self.size() {
            let mut sum = 0.0;
            for (column, value) in self.row(row) {
                sum += value * x[column];
                if column < row {
                    y[column] += value * x[row];
                }
            }
            y[row] += sum;
        }
        y
    }
}

impl Factor {
    /// Factors of `a - shift_per_s2 * b`, where `b` has no entry before the first of `a` in any row.
    ///
    /// # Errors
    /// A pivot is zero within rounding.
    pub fn of(a: &Sparse, shift_per_s2: f64, b: &Sparse) -> Result<Factor, Singular> {
        let size = a.size();
        let mut factor = Factor { firsts: vec![], starts: vec![0], lower: vec![], diagonal: Vec::with_capacity(size) };
        for row in 0..size {
            let first = a.row(row).next().map_or(row, |(column, _)| column);
            let mut values = vec![0.0; row + 1 - first];
            for (column, value) in a.row(row) {
                values[column - first] += value;
            }
            for (column, value) in b.row(row) {
                values[column - first] -= shift_per_s2 * value;
            }
            factor.push(first, values).map_err(|()| Singular { row })?;
        }
        Ok(factor)
    }

    /// Reduces one row, given from its first column to its diagonal.
    fn push(&mut self, first: usize, mut values: Vec<f64>) -> Result<(), ()> {
        let row = self.firsts.len();
        let whole = values.pop().unwrap_or(0.0);
        for column in first + 1..row {
            let from = self.firsts[column].max(first);
            let above = &self.lower[self.starts[column] + from - self.firsts[column]..self.starts[column + 1]];
            values[column - first] -= dot(above, &values[from - first..column - first]);
        }
        let mut pivot = whole;
        for (value, diagonal) in values.iter_mut().zip(&self.diagonal[first..]) {
            let l = *value / diagonal;
            pivot -= *value * l;
            *value = l;
        }
        if pivot.abs() <= PIVOT_MIN_RATIO * whole.abs() || !pivot.is_finite() {
            return Err(());
        }
        self.firsts.push(first);
        self.lower.append(&mut values);
        self.starts.push(self.lower.len());
        self.diagonal.push(pivot);
        Ok(())
    }

    /// Replaces the right-hand side `x` by the solution of the equations.
    pub fn solve(&self, x: &mut [f64]) {
        let rows = 0..self.diagonal.len();
        let of_row = |row: usize| &self.lower[self.starts[row]..self.starts[row + 1]];
        for row in rows.clone() {
            x[row] -= dot(of_row(row), &x[self.firsts[row]..row]);
        }
        for row in rows.clone() {
            x[row] /= self.diagonal[row];
        }
        for row in rows.rev() {
            let (done, rest) = x.split_at_mut(row);
            add_scaled(&mut done[self.firsts[row]..], -rest[0], of_row(row));
        }
    }

    /// Number of negative eigenvalues of the factored matrix.
    pub fn negatives(&self) -> usize {
        self.diagonal.iter().filter(|d| **d < 0.0).count()
    }

    /// Number of stored entries, a measure of the cost of factors and solutions.
    pub fn entries(&self) -> usize {
        self.lower.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of springs: 2 on the diagonal, -1 beside it; eigenvalues 2 - 2 cos(k pi / 11).
    fn chain() -> Sparse {
        Sparse::from_rows(
            (0..10).map(|i| if i == 0 { vec![(0, 2.0)] } else { vec![(i, 2.0), (i - 1, -1.0)] }).collect(),
        )
    }

    fn identity() -> Sparse {
        Sparse::from_rows((0..10).map(|i| vec![(i, 0.25), (i, 0.75)]).collect())
    }

    #[test]
    fn a_solution_gives_the_right_side_again() {
        let right: Vec<f64> = (0..10).map(|i| f64::from(i * i % 7)).collect();
        for shift in [0.0, 0.5, 3.7] {
            let mut x = right.clone();
            Factor::of(&chain(), shift, &identity()).unwrap().solve(&mut x);
            let mut again = chain().times(&x);
            add_scaled(&mut again, -shift, &x);
            assert!(again.iter().zip(&right).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }

    #[test]
    fn negatives_are_the_eigenvalues_below_the_shift() {
        for below in 0..=10 {
            let shift = 2.0 - 2.0 * libm::cos((f64::from(below) + 0.5) * std::f64::consts::PI / 11.0);
            assert_eq!(Factor::of(&chain(), shift, &identity()).unwrap().negatives(), below as usize);
        }
    }

    #[test]
    fn a_body_without_a_clamp_is_singular() {
        let loose = Sparse::from_rows(vec![vec![(0, 1.0)], vec![(0, -1.0), (1, 2.0)], vec![(1, -1.0), (2, 1.0)]]);
        assert_eq!(Factor::of(&loose, 0.0, &identity()).err(), Some(Singular { row: 2 }));
    }
}
