//! Line on one side of a curve, as near to it as possible.
//!
//! The curve is known by samples h at places y. A line A + B y may nowhere lie below it:
//!
//! ```text
//! A(B) = max_k (h_k - B y_k)                                                    (1)
//! g(B) = A(B) - min_k (h_k - B y_k)              least greatest gap             (2)
//! B    = slope of the upper hull over the middle of y     least area            (3)
//! ```
//!
//! (1) is over all samples, (2) over those of the objective only. g is convex and piecewise linear in B: its least value lies at the slope of an edge
//! of the upper hull of all samples or of the lower hull of the objective's. Our own; the source has lines through four points instead.

/// Sample of a curve: height over a position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveSample {
    /// Position y.
    pub along_mm: f64,
    /// Height h of the curve.
    pub height_mm: f64,
    /// Whether the gap between line and curve counts here.
    pub is_counted: bool,
}

/// Line A + B y on one side of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportLine {
    /// Height A at y = 0, mm.
    pub offset_mm: f64,
    /// Slope B.
    pub slope: f64,
    /// Greatest gap between the line and the counted samples, mm.
    pub gap_max_mm: f64,
}

/// Quantity that is minimised to choose the line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fit {
    /// Greatest gap: the most even allowance for the finishing that follows.
    #[default]
    Gap,
    /// Area between line and curve. Its slope is that of the curve at one place, and moves with it.
    Area,
}

/// Line nowhere below the samples. `None` without two counted samples at different places; samples are sorted by place.
pub fn support_line(samples: &[CurveSample], fit: Fit) -> Option<SupportLine> {
    fitted(samples, |hulls| match fit {
        Fit::Gap => least_gap(&hulls.upper, &hulls.lower),
        Fit::Area => edge_slope(edge_over(&hulls.upper, hulls.middle_mm)),
    })
}

/// The same line for samples of a smooth curve: where the line of least area touches it, its slope is the tangent's and not that of the edge between two
/// samples, which depends on where they lie.
pub fn tangent_line(samples: &[CurveSample], fit: Fit) -> Option<SupportLine> {
    match fit {
        Fit::Gap => support_line(samples, fit),
        Fit::Area => {
            fitted(samples, |hulls| smooth_slope(samples, edge_over(&hulls.upper, hulls.middle_mm), hulls.middle_mm))
        }
    }
}

/// Hulls of the samples, and the middle of the counted range.
struct Hulls {
    upper: Vec<[f64; 2]>,
    lower: Vec<[f64; 2]>,
    middle_mm: f64,
}

fn fitted(samples: &[CurveSample], slope: impl Fn(&Hulls) -> f64) -> Option<SupportLine> {
    let points = |sample: &CurveSample| [sample.along_mm, sample.height_mm];
    let upper = hull(samples.iter().map(points), 1.0);
    let counted = || samples.iter().filter(|sample| sample.is_counted).map(points);
    let (first, last) = (counted().next()?[0], counted().next_back()?[0]);
    if last <= first || upper.len() < 2 {
        return None;
    }
    let hulls = Hulls { lower: hull(counted(), -1.0), upper, middle_mm: f64::midpoint(first, last) };
    let slope = slope(&hulls);
    let offset_mm = highest(&hulls.upper, slope);
    Some(SupportLine { offset_mm, slope, gap_max_mm: offset_mm - lowest(&hulls.lower, slope) })
}

impl SupportLine {
    /// Height of the line at a position.
    pub fn at_mm(&self, along_mm: f64) -> f64 {
        self.offset_mm + self.slope * along_mm
    }
}

/// Upper (1) or lower (-1) hull of points sorted by their first coordinate.
fn hull(points: impl Iterator<Item = [f64; 2]>, sign: f64) -> Vec<[f64; 2]> {
    let mut hull: Vec<[f64; 2]> = Vec::new();
    for point in points {
        while let [.., a, b] = hull.as_slice() {
            let turn = (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0]);
            if turn * sign < 0.0 {
                break;
            }
            hull.pop();
        }
        hull.push(point);
    }
    hull
}

fn slopes(hull: &[[f64; 2]]) -> impl Iterator<Item = f64> {
    hull.windows(2).map(|pair| (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0]))
}

/// (1), on the hull's corners.
fn highest(upper: &[[f64; 2]], slope: f64) -> f64 {
    upper.iter().map(|[y, h]| h - slope * y).fold(f64::NEG_INFINITY, f64::max)
}

fn lowest(lower: &[[f64; 2]], slope: f64) -> f64 {
    lower.iter().map(|[y, h]| h - slope * y).fold(f64::INFINITY, f64::min)
}

/// Slope of the least greatest gap (2); the middle one if there are several.
fn least_gap(upper: &[[f64; 2]], lower: &[[f64; 2]]) -> f64 {
    let gap = |slope: f64| highest(upper, slope) - lowest(lower, slope);
    let mut all: Vec<f64> = slopes(upper).chain(slopes(lower)).collect();
    all.sort_unstable_by(f64::total_cmp);
    // The gap falls up to its least value and then grows.
    let (mut low, mut high) = (0, all.len() - 1);
    while low < high {
        let middle = usize::midpoint(low, high);
        if gap(all[middle]) <= gap(all[middle + 1]) { high = middle } else { low = middle + 1 }
    }
    let least = gap(all[low]);
    let last = all[low..].iter().take_while(|slope| gap(**slope) <= least).last();
    f64::midpoint(all[low], last.copied().unwrap_or(all[low]))
}

/// Edge of the upper hull over a place (3).
fn edge_over(upper: &[[f64; 2]], place_mm: f64) -> [[f64; 2]; 2] {
    let mut edges = upper.windows(2).map(|pair| [pair[0], pair[1]]);
    let over = edges.clone().find(|pair| pair[1][0] >= place_mm);
    over.or_else(|| edges.next_back()).unwrap_or([[0.0; 2], [1.0, 0.0]])
}

fn edge_slope([from, to]: [[f64; 2]; 2]) -> f64 {
    (to[1] - from[1]) / (to[0] - from[0])
}

/// Slope of an edge, or of the curve's tangent if the edge joins neighbouring samples.
fn smooth_slope(samples: &[CurveSample], edge: [[f64; 2]; 2], place_mm: f64) -> f64 {
    let first = samples.partition_point(|sample| sample.along_mm < edge[0][0]);
    let is_short = samples.get(first + 1).is_some_and(|next| next.along_mm >= edge[1][0]);
    if !is_short || first == 0 || first + 2 >= samples.len() {
        return edge_slope(edge);
    }
    let place = |at: usize| [samples[at].along_mm, samples[at].height_mm];
    tangent([first - 1, first, first + 1, first + 2].map(place), place_mm)
}

/// Slope at a place of the cubic through four points.
fn tangent(points: [[f64; 2]; 4], at: f64) -> f64 {
    let term = |i: usize| {
        let others = || (0..4).filter(move |j| *j != i);
        let below: f64 = others().map(|j| points[i][0] - points[j][0]).product();
        let without = |k: usize| others().filter(move |j| *j != k).map(|j| at - points[j][0]).product::<f64>();
        points[i][1] * others().map(without).sum::<f64>() / below
    };
    (0..4).map(term).sum()
}
