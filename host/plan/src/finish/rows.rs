//! Spacing of passes up the span of a blade, from the scallop height.
//!
//! ```text
//! iso-parametric: m(v) = integral of max over u of |S_v| / s(u, v)         passes at equal m, v constant along each      (1)
//! iso-stepover:   m_u(v) = integral of |S_v| / s,  s the least of the surface, passes at equal shares of m_u            (2)
//! passes = ceil(greatest m) + 1                                                                                        (3)
//! ```
//!
//! s is the stepover (plunge/step.rs) on the curvature across the pass, for the mill's corner: an inclined filleted end leaves less.
//!
//! Source: (1) ours; (2) Feng et al., iso-stepover: the same number of points on every cross line.

use crate::geometry::face::Face;
use crate::plunge::step::{curvature_across_per_mm, stepover};

/// Lines of the surface along each parameter at which the spacing is evaluated.
const LINES: usize = 64;

/// Spacing of passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spacing {
    /// Constant parameter along each pass. (1)
    IsoParametric,
    /// Equal arcs on every line across. (2)
    IsoStepover,
}

/// Places of passes on one side of a blade.
#[derive(Clone, Debug)]
pub struct PassRows {
    span: [f64; 2],
    /// Cumulated measure over the span, of every line of u, or of one for all.
    columns: Vec<Vec<f64>>,
    /// Greatest measure. (1), (2)
    pub steps: f64,
}

impl PassRows {
    /// Rows of a side between two places of the span. `None` if the scallop is not below the corner's radius, or a hollow is as narrow as the corner.
    pub fn new(face: &Face, span: [f64; 2], spacing: Spacing, corner_mm: f64, scallop_mm: f64) -> Option<Self> {
        let at = |i: usize| i as f64 / LINES as f64;
        let v_of = |j: usize| span[0] + (span[1] - span[0]) * at(j);
        let mut lengths = vec![vec![0.0; LINES + 1]; LINES + 1];
        let mut steps = vec![vec![0.0; LINES + 1]; LINES + 1];
        for i in 0..=LINES {
            for j in 0..=LINES {
                let (u, v) = (at(i), v_of(j));
                let jet = face.jet(u, v);
                let curvature = curvature_across_per_mm(&jet, &face.normal(u, v), &jet.u.normalize());
                steps[i][j] = stepover(corner_mm, scallop_mm, curvature)?.wall_mm;
                // The way across the pass, not that along the line.
                lengths[i][j] = jet.v.cross(&jet.u.normalize()).norm() * (span[1] - span[0]).abs();
            }
        }
        let least_mm = steps.iter().flatten().copied().fold(f64::INFINITY, f64::min);
        let columns: Vec<Vec<f64>> = match spacing {
            Spacing::IsoParametric => {
                let ratio = |j: usize| (0..=LINES).map(|i| lengths[i][j] / steps[i][j]).fold(0.0, f64::max);
                vec![cumulated(&(0..=LINES).map(ratio).collect::<Vec<_>>())]
            }
            Spacing::IsoStepover => {
                lengths.iter().map(|line| cumulated(&line.iter().map(|mm| mm / least_mm).collect::<Vec<_>>())).collect()
            }
        };
        let most = columns.iter().filter_map(|column| column.last()).copied().fold(0.0, f64::max);
        Some(PassRows { span, columns, steps: most })
    }

    /// Place v on the line u at a share of the way up the span.
    pub fn v(&self, u: f64, share: f64) -> f64 {
        let place = u.clamp(0.0, 1.0) * (self.columns.len() - 1) as f64;
        let (low, part) = ((place as usize).min(self.columns.len() - 1), place.fract());
        let of = |column: usize| inverted(&self.columns[column.min(self.columns.len() - 1)], share);
        let mixed = of(low) + (of(low + 1) - of(low)) * part;
        self.span[0] + (self.span[1] - self.span[0]) * mixed
    }
}

/// Integral by trapezoids.
fn cumulated(rates: &[f64]) -> Vec<f64> {
    let mut whole = vec![0.0];
    for pair in rates.windows(2) {
        let so_far = whole[whole.len() - 1];
        whole.push(so_far + (pair[0] + pair[1]) / 2.0 / LINES as f64);
    }
    whole
}

/// Share of the lines at which a share of the whole measure is reached.
fn inverted(column: &[f64], share: f64) -> f64 {
    let wanted = share.clamp(0.0, 1.0) * column[column.len() - 1];
    let next = column.partition_point(|measure| *measure < wanted).clamp(1, column.len() - 1);
    let (from, to) = (column[next - 1], column[next]);
    let part = if to > from { (wanted - from) / (to - from) } else { 0.0 };
    (next as f64 - 1.0 + part) / LINES as f64
}
