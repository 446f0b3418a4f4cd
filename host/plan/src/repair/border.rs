//! Border c_b of the repaired region as a function, and where the transition beside it begins.
//!
//! ```text
//! u = g(v), monotone piecewise cubic through the crossings;  f = g^-1                                         (1)
//! u1 = least u with |S(u, v) - S(g(s), s)| <= w for some v and s                                              (2)
//! ```
//!
//! Source: Feng et al.: c1 is the iso-curve through the innermost point of c_a, which lies at the width w beside c_b. The curve (1) is that of F. Fritsch,
//! R. Carlson, *Monotone piecewise cubic interpolation*, SIAM J. Numer. Anal. 17, 1980, with harmonic means as slopes.

use crate::geometry::surface::Surface;
use crate::search::{Minimum, descend};
use crate::vector::Point;

/// Pieces of c_b and of lines across, for (2).
const PIECES: usize = 400;
/// Halvings that exhaust a parameter.
const HALVINGS: usize = 60;

/// Border of the repaired region as a monotone curve u = g(v), through points with increasing v.
#[derive(Clone, Debug, PartialEq)]
pub struct MonotoneBorder {
    /// v and u of the places.
    places: Vec<[f64; 2]>,
    slopes: Vec<f64>,
}

impl MonotoneBorder {
    /// Curve through points `[v, u]`; `None` if there are fewer than two, or they are not monotone.
    pub fn new(places: Vec<[f64; 2]>) -> Option<Self> {
        let steps: Vec<[f64; 2]> =
            places.windows(2).map(|pair| [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]]).collect();
        let is_one = |sign: f64| steps.iter().all(|[dv, du]| *dv > 0.0 && du * sign >= 0.0);
        if steps.is_empty() || !(is_one(1.0) || is_one(-1.0)) {
            return None;
        }
        let ratios: Vec<f64> = steps.iter().map(|[dv, du]| du / dv).collect();
        let inner = |k: usize| {
            let (before, after) = (ratios[k - 1], ratios[k]);
            let (wide, narrow) = (2.0 * steps[k][0] + steps[k - 1][0], steps[k][0] + 2.0 * steps[k - 1][0]);
            if before * after > 0.0 { (wide + narrow) / (wide / before + narrow / after) } else { 0.0 }
        };
        let last = ratios.len();
        let slopes = (0..=last).map(|k| {
            if k == 0 {
                ratios[0]
            } else if k == last {
                ratios[last - 1]
            } else {
                inner(k)
            }
        });
        Some(MonotoneBorder { slopes: slopes.collect(), places })
    }

    /// u = g(v); beyond the ends, the value at the end.
    pub fn u_at(&self, v: f64) -> f64 {
        let last = self.places.len() - 2;
        let k = self.places.partition_point(|place| place[0] <= v).saturating_sub(1).min(last);
        let [[from_v, from_u], [to_v, to_u]] = [self.places[k], self.places[k + 1]];
        let h = to_v - from_v;
        let t = ((v - from_v) / h).clamp(0.0, 1.0);
        let (t2, t3) = (t * t, t * t * t);
        from_u * (2.0 * t3 - 3.0 * t2 + 1.0)
            + to_u * (3.0 * t2 - 2.0 * t3)
            + h * (self.slopes[k] * (t3 - 2.0 * t2 + t) + self.slopes[k + 1] * (t3 - t2)) // (1)
    }

    /// f(u): the v at which the border has this u, of a border that rises with v; beyond its ends 0 or 1.
    pub fn v_at(&self, u: f64) -> f64 {
        let [mut low, mut high] = [0.0, 1.0];
        for _ in 0..HALVINGS {
            let middle = (low + high) / 2.0;
            if self.u_at(middle) <= u { low = middle } else { high = middle }
        }
        (low + high) / 2.0
    }
}

/// u1 of (2) for a border u = g(v) over all v; never below the surface's own range.
pub fn transition_begin(surface: &dyn Surface, border: impl Fn(f64) -> f64, width_mm: f64) -> f64 {
    let [us, vs] = surface.ranges();
    let along = |k: usize| vs[0] + (vs[1] - vs[0]) * k as f64 / PIECES as f64;
    let line: Vec<Point> = (0..=PIECES).map(|k| surface.jet([border(along(k)), along(k)]).point).collect();
    let square_mm2 =
        |point: &Point| line.windows(2).map(|pair| square_to(point, pair[0], pair[1])).fold(f64::INFINITY, f64::min);
    // Along one line of constant v: from the root upwards the distance falls to the width once.
    let begin = |v: f64| {
        let [mut low, mut high] = [us[0], border(v)];
        for _ in 0..HALVINGS {
            let middle = (low + high) / 2.0;
            let is_beside = square_mm2(&surface.jet([middle, v]).point) <= width_mm * width_mm;
            if is_beside { high = middle } else { low = middle }
        }
        high
    };
    let coarse = (0..=PIECES / 8).map(|k| along(k * 8)).map(|v| Minimum { at: [v, 0.0], value: begin(v) });
    let Some(start) = coarse.min_by(|a, b| a.value.total_cmp(&b.value)) else { return us[0] };
    let found = descend([vs, [0.0, 0.0]], start, [along(8) - along(0), 0.0], |[v, _]| begin(v));
    found.value.max(us[0])
}

/// Squared distance of a point from a line's piece.
pub fn square_to(point: &Point, from: Point, to: Point) -> f64 {
    let way = to - from;
    let share = ((point - from).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
    let nearest = if share.is_nan() { from } else { from + way * share };
    (point - nearest).norm_squared()
}
