//! Basis functions of a B-spline of degree 1 to 3 with their derivatives, in arrays of fixed size: a surface is evaluated millions of times.
//!
//! ```text
//! N_i,0 = 1 on [u_i, u_i+1)
//! N_i,p = (u - u_i) N_i,p-1 / (u_i+p - u_i) + (u_i+p+1 - u) N_i+1,p-1 / (u_i+p+1 - u_i+1)     (1)
//! N'_i,p = p (N_i,p-1 / (u_i+p - u_i) - N_i+1,p-1 / (u_i+p+1 - u_i+1))                        (2)
//! ```
//!
//! Source: L. Piegl, W. Tiller, *The NURBS Book*, 2nd ed., Springer 1997: eqs 2.5 and 2.7, algorithms A2.1 to A2.3, in whose order all operations
//! are done, so that the results are those of the crate curvo to the bit.

/// Highest degree.
pub const DEGREE_MAX: usize = 3;

/// Rounding steps of knots.
const KNOT_STEPS: f64 = (1 << 30) as f64;

/// Values of the basis functions that are not zero at a parameter; unused ones are 0.
pub type Weights = [f64; DEGREE_MAX + 1];

/// One direction of a spline surface: degree and knots, clamped at both ends.
#[derive(Clone, Debug)]
pub struct Spline {
    degree: usize,
    knots: Vec<f64>,
}

/// Values of the basis functions that do not vanish at a parameter, with their derivatives.
pub struct Basis<const ROWS: usize> {
    /// Index of the control point to which the first of these functions belongs.
    pub first: usize,
    /// Values, then first and second derivatives; 0 beyond the degree.
    pub rows: [Weights; ROWS],
}

impl Spline {
    /// Spline with `knots`, of `degree` 1 to 3.
    pub fn new(degree: usize, knots: Vec<f64>) -> Self {
        Spline { degree, knots }
    }

    /// Spline with knots rounded to a power of two, below 1e-9.
    pub fn rounded(&self) -> Self {
        let knots = self.knots.iter().map(|knot| libm::round(knot * KNOT_STEPS) / KNOT_STEPS).collect();
        Spline { degree: self.degree, knots }
    }

    /// The same spline with its parameter counted from the other end.
    pub fn reversed(&self) -> Self {
        Spline { degree: self.degree, knots: self.knots.iter().rev().map(|knot| 1.0 - knot).collect() }
    }

    /// Degree of the spline.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Number of control points.
    pub fn count(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// Basis functions at `t`, with `ROWS - 1` derivatives.
    pub fn basis<const ROWS: usize>(&self, t: f64) -> Basis<ROWS> {
        let first = self.span(t) - self.degree;
        let rows = match self.degree {
            3 => rows::<3, ROWS>(&self.knots[first + 1..], t),
            2 => rows::<2, ROWS>(&self.knots[first + 1..], t),
            _ => rows::<1, ROWS>(&self.knots[first + 1..], t),
        };
        Basis { first, rows }
    }

    /// Index of the knot at or below `t`; at the ends that of the outermost span.
    fn span(&self, t: f64) -> usize {
        let (low, high) = (self.degree, self.count());
        if t > self.knots[high] - f64::EPSILON {
            return high - 1;
        }
        if t < self.knots[low] + f64::EPSILON {
            return low;
        }
        low + self.knots[low + 1..high].partition_point(|knot| *knot <= t)
    }
}

/// Basis functions of degree `P` from the knots about a span: `P` up to its beginning and `P` from its end.
fn rows<const P: usize, const ROWS: usize>(knots: &[f64], t: f64) -> [Weights; ROWS] {
    let knots = &knots[..2 * P];
    let (mut left, mut right) = ([0.0; DEGREE_MAX + 1], [0.0; DEGREE_MAX + 1]);
    // Functions by degree, and below the diagonal the knot differences that divide them.
    let mut lower = [Weights::default(); DEGREE_MAX + 1];
    let mut widths = [Weights::default(); DEGREE_MAX + 1];
    lower[0][0] = 1.0;
    for j in 1..=P {
        left[j] = t - knots[P - j];
        right[j] = knots[P - 1 + j] - t;
        let mut saved = 0.0;
        for r in 0..j {
            widths[j][r] = right[r + 1] + left[j - r];
            let part = lower[j - 1][r] / widths[j][r];
            lower[j][r] = saved + right[r + 1] * part;
            saved = left[j - r] * part;
        }
        lower[j][j] = saved; // (1)
    }
    let mut rows = [Weights::default(); ROWS];
    rows[0] = lower[P];
    if ROWS == 1 {
        return rows;
    }
    let mut inverse = Weights::default();
    for r in 0..P {
        inverse[r] = 1.0 / widths[P][r];
    }
    for r in 0..=P {
        let rising = if r > 0 { inverse[r - 1] * lower[P - 1][r - 1] } else { 0.0 };
        let falling = if r < P { inverse[r] * lower[P - 1][r] } else { 0.0 };
        rows[1][r] = (rising - falling) * P as f64; // (2)
    }
    if ROWS > 2 && P > 1 {
        rows[2] = second::<P>(&lower[P - 2], &widths[P - 1], &inverse);
    }
    rows
}

/// Second derivatives: (2) of (2).
fn second<const P: usize>(lower: &Weights, widths: &Weights, inverse: &Weights) -> Weights {
    let mut found = Weights::default();
    for r in 0..=P {
        let mut sum = 0.0;
        if r > 1 {
            sum = inverse[r - 1] / widths[r - 2] * lower[r - 2];
        }
        if r > 0 && r < P {
            sum += (-inverse[r] - inverse[r - 1]) / widths[r - 1] * lower[r - 1];
        }
        if r + 1 < P {
            sum += inverse[r] / widths[r] * lower[r];
        }
        found[r] = sum * (P * (P - 1)) as f64;
    }
    found
}
