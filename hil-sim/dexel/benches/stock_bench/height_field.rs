//! The yardstick: a height field. Of each ray along z the lowest place that an upright tool reaches on a level straight move, in
//! closed form; material above it is gone. It holds no undercut, no side face, no other tool axis.

/// Height field over a square, for comparison with the dexels.
pub struct HeightField {
    width: usize,
    centers_mm: Vec<f64>,
    pub heights_mm: Vec<f64>,
}

impl HeightField {
    /// Field of this height with columns `step_mm` apart.
    pub fn new(edge_mm: f64, height_mm: f64, step_mm: f64) -> Self {
        let width = (edge_mm / step_mm).round() as usize;
        let centers_mm = (0..width).map(|cell| (cell as f64 + 0.5) * step_mm).collect();
        HeightField { width, centers_mm, heights_mm: vec![height_mm; width * width] }
    }

    /// Lowers the material to the tool; `bottom_mm` gives the tool's height above a point for the square of the
    /// point's distance from the path. Returns the number of columns examined.
    #[inline(always)]
    pub fn cut(&mut self, [from, to]: [[f64; 3]; 2], radius_mm: f64, bottom_mm: impl Fn(f64) -> f64) -> usize {
        let way = [to[0] - from[0], to[1] - from[1]];
        let square = way[0] * way[0] + way[1] * way[1];
        let per_way = way.map(|part| part / square);
        let mut asked = 0;
        for row in self.cells(from[1].min(to[1]) - radius_mm, from[1].max(to[1]) + radius_mm) {
            let off_mm = self.centers_mm[row] - from[1];
            let Some([low_mm, high_mm]) = chord(way, off_mm, radius_mm) else { continue };
            let columns = self.cells(from[0] + low_mm, from[0] + high_mm);
            let heights_mm = &mut self.heights_mm[row * self.width..][columns.clone()];
            asked += heights_mm.len();
            for (height_mm, x_mm) in heights_mm.iter_mut().zip(&self.centers_mm[columns]) {
                let arm_mm = x_mm - from[0];
                let part = arm_mm * per_way[0] + off_mm * per_way[1];
                // As comparisons, which are an instruction each.
                let part = if part > 0.0 { part } else { 0.0 };
                let part = if part < 1.0 { part } else { 1.0 };
                let [a, b] = [arm_mm - part * way[0], off_mm - part * way[1]];
                let reached_mm = bottom_mm(a * a + b * b);
                *height_mm = if reached_mm < *height_mm { reached_mm } else { *height_mm };
            }
        }
        asked
    }

    fn cells(&self, from_mm: f64, to_mm: f64) -> std::ops::Range<usize> {
        let step_mm = 2.0 * self.centers_mm[0];
        let end = ((to_mm / step_mm - 0.5).floor() + 1.0) as usize;
        let first = ((from_mm / step_mm - 0.5).ceil() as usize).min(self.width);
        first..end.clamp(first, self.width)
    }
}

/// Interval of a line along x that lies within the radius of a path from the origin.
fn chord(way: [f64; 2], off_mm: f64, radius_mm: f64) -> Option<[f64; 2]> {
    let half_mm = |off_mm: f64| libm::sqrt(radius_mm * radius_mm - off_mm * off_mm);
    let at_ends = [(0.0, off_mm), (way[0], off_mm - way[1])].map(|(x, off)| [x - half_mm(off), x + half_mm(off)]);
    // NaN where a disc is missed: the others are taken.
    let mut chord = [at_ends[0][0].min(at_ends[1][0]), at_ends[0][1].max(at_ends[1][1])];
    let length_mm = libm::sqrt(way[0] * way[0] + way[1] * way[1]);
    for normal in [[-way[1], way[0]], [way[1], -way[0]]].map(|n| n.map(|part| part / length_mm * radius_mm)) {
        let part = (off_mm - normal[1]) / way[1];
        if (0.0..=1.0).contains(&part) {
            let x_mm = part * way[0] + normal[0];
            chord = [chord[0].min(x_mm), chord[1].max(x_mm)];
        }
    }
    (chord[0] <= chord[1]).then_some(chord)
}
