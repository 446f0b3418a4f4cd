//! B-spline surfaces of a STEP file.
//!
//! ```text
//! S(u, v) = sum of w_ij N_i(u) N_j(v) P_ij / sum of w_ij N_i(u) N_j(v)                          (1)
//! N_i,p   = (u - u_i) / (u_i+p - u_i) N_i,p-1 + (u_i+p+1 - u) / (u_i+p+1 - u_i+1) N_i+1,p-1     (2)
//! ```
//!
//! Source: ISO 10303-42, `b_spline_surface_with_knots`, `rational_b_spline_surface`; any degree, which the faces of a blade's own splines
//! have not.

use crate::vector::{Point, Vector};

use super::step_text::{Part, Value, list, numbers, reference, rows};

/// Samples between two knots.
const SAMPLES: usize = 4;

/// B-spline surface as in the file.
pub(super) struct Spline {
    degrees: [usize; 2],
    pub(super) net: Vec<Vec<u64>>,
    knots: [Vec<f64>; 2],
    weights: Option<Vec<Vec<f64>>>,
}

impl Spline {
    /// Outer `None`: another surface; inner: not complete.
    pub(super) fn of(parts: &[Part]) -> Option<Option<Self>> {
        let part = |name: &str| parts.iter().find(|part| part.name == name).map(|part| part.values.as_slice());
        let with_knots = part("B_SPLINE_SURFACE_WITH_KNOTS")?;
        // A record of one type has all values behind its name, one of several types has its own with each.
        let (surface, knots) = match part("B_SPLINE_SURFACE") {
            Some(surface) => (surface, with_knots),
            None => (with_knots.get(1..8).unwrap_or_default(), with_knots.get(8..).unwrap_or_default()),
        };
        let weights = part("RATIONAL_B_SPLINE_SURFACE").map(|values| rows(&values[..1], numbers));
        let read = || {
            let [Value::Number(u), Value::Number(v), net, ..] = surface else { return None };
            let [of_u, of_v, u_knots, v_knots, ..] = knots else { return None };
            let net = rows(std::slice::from_ref(net), |row| list(row).iter().filter_map(reference).collect::<Vec<_>>());
            let repeated = |times: &Value, knots: &Value| -> Vec<f64> {
                let each = numbers(times).into_iter().zip(numbers(knots));
                each.flat_map(|(times, knot)| std::iter::repeat_n(knot, times.clamp(0.0, 100.0) as usize)).collect()
            };
            let is_sound = (1.0..=25.0).contains(u) && (1.0..=25.0).contains(v) && net.len() > 1 && net[0].len() > 1;
            is_sound.then(|| Spline {
                degrees: [*u as usize, *v as usize],
                net,
                knots: [repeated(of_u, u_knots), repeated(of_v, v_knots)],
                weights,
            })
        };
        Some(read())
    }

    /// Rows of points on the surface whose net is `points`; `None` if knots or weights do not fit it. (1)
    pub(super) fn grid(&self, points: &[Vec<Point>]) -> Option<Vec<Vec<Point>>> {
        let Spline { degrees, knots, weights, .. } = self;
        let counts = [points.len(), points[0].len()];
        let is_sound = (0..2).all(|k| knots[k].len() == counts[k] + degrees[k] + 1)
            && points.iter().all(|row| row.len() == counts[1])
            && weights
                .as_ref()
                .is_none_or(|rows| rows.len() == counts[0] && rows.iter().all(|row| row.len() == counts[1]));
        if !is_sound {
            return None;
        }
        let bases = [0, 1].map(|k: usize| {
            let at = places(&knots[k], degrees[k], counts[k]);
            at.into_iter().map(|t| basis(&knots[k], degrees[k], counts[k], t)).collect::<Vec<_>>()
        });
        let place = |(i, us): &(usize, Vec<f64>), (j, vs): &(usize, Vec<f64>)| {
            let (mut sum, mut whole) = (Vector::zeros(), 0.0);
            for (row, n) in us.iter().enumerate() {
                for (column, m) in vs.iter().enumerate() {
                    let weight = weights.as_ref().map_or(1.0, |rows| rows[i + row][j + column]) * n * m;
                    sum += points[i + row][j + column].coords * weight;
                    whole += weight;
                }
            }
            Point::from(sum / whole)
        };
        Some(bases[1].iter().map(|v| bases[0].iter().map(|u| place(u, v)).collect()).collect())
    }
}

/// Places between the first and the last knot that counts.
fn places(knots: &[f64], degree: usize, count: usize) -> Vec<f64> {
    let spans = knots[degree..=count].windows(2).filter(|pair| pair[1] > pair[0]);
    let inner = spans.flat_map(|pair| (0..SAMPLES).map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / SAMPLES as f64));
    inner.chain([knots[count]]).collect()
}

/// Functions that do not vanish at `t`, and the index of the first one. (2)
fn basis(knots: &[f64], degree: usize, count: usize, t: f64) -> (usize, Vec<f64>) {
    let span = knots.partition_point(|knot| *knot <= t).clamp(degree + 1, count) - 1;
    let mut values = vec![1.0];
    for p in 1..=degree {
        let mut next = vec![0.0; p + 1];
        for (k, value) in values.iter().enumerate() {
            let first = span + 1 + k - p;
            let (low, high) = (knots[first], knots[first + p]);
            let share = if high > low { (t - low) / (high - low) } else { 0.0 };
            next[k + 1] += share * value;
            next[k] += (1.0 - share) * value;
        }
        values = next;
    }
    (span - degree, values)
}
