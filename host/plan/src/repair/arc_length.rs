//! Points at equal distances along a curve, measured by arc length.
//!
//! ```text
//! L = integral of |r'(t)| dt         Gauss's rule of five points on equal panels        (1)
//! L(t_i) = i L / (n - 1)             Newton's steps within the panel                    (2)
//! ```
//!
//! Source: Feng et al. ask for points of equal arc length without a formula.

/// Panels of a curve.
const PANELS: usize = 256;
/// Newton's steps, more than a smooth curve needs.
const STEPS: usize = 30;

/// Nodes and weights of Gauss's rule on -1 to 1: the middle one, then the pairs.
const MIDDLE_WEIGHT: f64 = 128.0 / 225.0;
const PAIRS: [[f64; 2]; 2] =
    [[0.538_469_310_105_683_1, 0.478_628_670_499_366_47], [0.906_179_845_938_664, 0.236_926_885_056_189_1]];

/// Curve with its arc length, measured from its beginning.
pub struct ArcLength<F> {
    range: [f64; 2],
    /// Lengths up to the ends of the panels, from 0.
    lengths_mm: Vec<f64>,
    speed: F,
}

impl<F: Fn(f64) -> f64> ArcLength<F> {
    /// Curve over a range of its parameter; `speed` is the length of its derivative.
    pub fn new(range: [f64; 2], speed: F) -> Self {
        let mut curve = ArcLength { range, lengths_mm: vec![0.0], speed };
        let mut whole_mm = 0.0;
        for panel in 0..PANELS {
            whole_mm += curve.integral_mm(curve.place(panel), curve.place(panel + 1));
            curve.lengths_mm.push(whole_mm);
        }
        curve
    }

    /// Length of the whole curve, mm.
    pub fn length_mm(&self) -> f64 {
        self.lengths_mm[PANELS]
    }

    /// Parameter of the curve at an arc length from its beginning.
    pub fn at(&self, length_mm: f64) -> f64 {
        let panel = self.lengths_mm.partition_point(|end| *end <= length_mm).clamp(1, PANELS) - 1;
        let (from, to) = (self.place(panel), self.place(panel + 1));
        let wanted_mm = length_mm - self.lengths_mm[panel];
        let whole_mm = self.lengths_mm[panel + 1] - self.lengths_mm[panel];
        let mut at = if whole_mm > 0.0 { from + (to - from) * wanted_mm / whole_mm } else { from };
        for _ in 0..STEPS {
            let step = (wanted_mm - self.integral_mm(from, at)) / (self.speed)(at); // (2)
            if !step.is_finite() {
                break;
            }
            let next = (at + step).clamp(from, to);
            if next == at {
                break;
            }
            at = next;
        }
        at
    }

    /// `count` parameters at equal distances along the curve, both ends included.
    pub fn equal_arcs(&self, count: usize) -> Vec<f64> {
        let last = count.max(2) - 1;
        let place = |i: usize| self.at(self.length_mm() * i as f64 / last as f64);
        (0..=last).map(|i| if i == last { self.range[1] } else { place(i) }).collect()
    }

    fn place(&self, panel: usize) -> f64 {
        self.range[0] + (self.range[1] - self.range[0]) * panel as f64 / PANELS as f64
    }

    /// (1)
    fn integral_mm(&self, from: f64, to: f64) -> f64 {
        let (middle, half) = ((from + to) / 2.0, (to - from) / 2.0);
        let pair = |[node, weight]: [f64; 2]| {
            weight * ((self.speed)(middle - half * node) + (self.speed)(middle + half * node))
        };
        half * (MIDDLE_WEIGHT * (self.speed)(middle) + PAIRS.into_iter().map(pair).sum::<f64>())
    }
}
