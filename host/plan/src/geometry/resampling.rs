//! New distribution of points along a side.
//!
//! ```text
//! c_k = (1 - cos(pi k / (n - 1))) / 2                dense at both edges
//! s_k = L ((1 - e) c_k + e k / (n - 1))              less dense with e > 0       (1)
//! m_i = (h_i d_i-1 + h_i-1 d_i) / (h_i-1 + h_i)      tangents                    (2)
//! ```
//!
//! with chord lengths h, divided differences d and a cubic between two points that has their tangents. (2) is the slope of the
//! parabola through three points (Bessel); the ends take that of their neighbours' parabola.

use crate::vector::{Point, Vector};

/// `count` points on the curve through `points`, both ends kept.
pub fn resampled(points: &[Point], count: usize) -> Vec<Point> {
    spread(points, count, 0.0)
}

/// `count` points on the curve through `points`, both ends kept; `even_ratio` is e of (1).
pub fn spread(points: &[Point], count: usize, even_ratio: f64) -> Vec<Point> {
    let mut lengths = vec![0.0];
    let mut kept: Vec<Point> = points.first().copied().into_iter().collect();
    for point in points {
        let last = kept[kept.len() - 1];
        let step_mm = (point - last).norm();
        if step_mm > 0.0 {
            lengths.push(lengths[lengths.len() - 1] + step_mm);
            kept.push(*point);
        }
    }
    let tangents = tangents(&kept, &lengths);
    let whole_mm = lengths[lengths.len() - 1];
    let place = |k: usize| {
        let share = k as f64 / (count - 1) as f64;
        let dense = (1.0 - libm::cos(core::f64::consts::PI * share)) / 2.0;
        whole_mm * ((1.0 - even_ratio) * dense + even_ratio * share) // (1)
    };
    (0..count)
        .map(|k| if k + 1 == count { kept[kept.len() - 1] } else { on(&kept, &lengths, &tangents, place(k)) })
        .collect()
}

/// (2)
fn tangents(points: &[Point], lengths: &[f64]) -> Vec<Vector> {
    let h: Vec<f64> = lengths.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let d: Vec<Vector> = points.windows(2).zip(&h).map(|(pair, h)| (pair[1] - pair[0]) / *h).collect();
    if d.len() < 2 {
        return vec![d.first().copied().unwrap_or_default(); points.len()];
    }
    let inner = (1..d.len()).map(|i| (d[i - 1] * h[i] + d[i] * h[i - 1]) / (h[i - 1] + h[i]));
    let inner: Vec<Vector> = inner.collect();
    let last = d.len() - 1;
    let first = d[0] * 2.0 - inner[0];
    let end = d[last] * 2.0 - inner[inner.len() - 1];
    std::iter::once(first).chain(inner).chain([end]).collect()
}

fn on(points: &[Point], lengths: &[f64], tangents: &[Vector], at_mm: f64) -> Point {
    let last = points.len() - 2;
    let i = lengths.partition_point(|length| *length <= at_mm).saturating_sub(1).min(last);
    let h = lengths[i + 1] - lengths[i];
    let t = (at_mm - lengths[i]) / h;
    let (a, b) = (points[i].coords, points[i + 1].coords);
    let (t2, t3) = (t * t, t * t * t);
    let ends = a * (2.0 * t3 - 3.0 * t2 + 1.0) + b * (3.0 * t2 - 2.0 * t3);
    Point::from(ends + (tangents[i] * (t3 - 2.0 * t2 + t) + tangents[i + 1] * (t3 - t2)) * h)
}
