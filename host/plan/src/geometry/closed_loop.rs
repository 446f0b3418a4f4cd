//! Closed loop around a blade, split into its two sides.
//!
//! The edges are the points marked `le` and `te`. Without marks they are the two points of the loop farthest apart; the leading edge is
//! the one nearer to where the hub curve begins.

use crate::vector::Point;

use super::point_file::Fault;

/// Least number of points of a side.
const POINTS_MIN: usize = 5;

/// Largest gap of a closed loop, as a multiple of its widest step.
const GAP_STEPS: f64 = 2.0;

/// Mark of a point in a file, by which a closed loop is split into two sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// Leading edge, `le` in the file.
    Leading,
    /// Trailing edge, `te` in the file.
    Trailing,
}

/// Section of a blade in a file, as a closed loop of points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loop {
    /// Points around the blade; the first one may be repeated at the end.
    pub points: Vec<Point>,
    /// Marked points: index and mark.
    pub marks: Vec<(usize, Mark)>,
}

impl Loop {
    /// Splits the loop into both sides, from the leading to the trailing edge; `from_low_z` if the hub curve begins
    /// at low z.
    ///
    /// # Errors
    /// The loop is open, has too few points or wrong marks; `section` counts from 1.
    pub fn split(mut self, section: usize, from_low_z: bool) -> Result<[Vec<Point>; 2], Fault> {
        self.close(section)?;
        let count = self.points.len();
        let [leading, trailing] = match self.marked(section)? {
            Some(edges) => edges,
            None => self.farthest(from_low_z),
        };
        let walk = |from: usize, to: usize| -> Vec<Point> {
            let steps = (to + count - from) % count;
            (0..=steps).map(|step| self.points[(from + step) % count]).collect()
        };
        let mut back = walk(trailing, leading);
        back.reverse();
        let sides = [walk(leading, trailing), back];
        match sides.iter().map(Vec::len).find(|found| *found < POINTS_MIN) {
            Some(found) => Err(Fault::Points { section, found, least: POINTS_MIN }),
            None => Ok(sides),
        }
    }

    /// Removes a repeated first point.
    fn close(&mut self, section: usize) -> Result<(), Fault> {
        if self.points.len() < 2 * POINTS_MIN {
            return Err(Fault::Points { section, found: self.points.len() / 2, least: POINTS_MIN });
        }
        let last = self.points.len() - 1;
        let gap_mm = (self.points[last] - self.points[0]).norm();
        let step_mm = self.points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).fold(0.0, f64::max);
        if gap_mm > GAP_STEPS * step_mm {
            return Err(Fault::Open { section, gap_mm, step_mm });
        }
        if gap_mm < step_mm * 1e-3 {
            self.points.pop();
            for (at, _) in self.marks.iter_mut().filter(|(at, _)| *at == last) {
                *at = 0;
            }
            self.marks.dedup();
        }
        Ok(())
    }

    fn marked(&self, section: usize) -> Result<Option<[usize; 2]>, Fault> {
        let find = |wanted: Mark, mark: &'static str| {
            let found: Vec<usize> = self.marks.iter().filter(|(_, mark)| *mark == wanted).map(|(at, _)| *at).collect();
            match found.as_slice() {
                [at] => Ok(Some(*at)),
                [] if self.marks.is_empty() => Ok(None),
                _ => Err(Fault::Marks { section, mark, found: found.len() }),
            }
        };
        Ok(find(Mark::Leading, "le")?.zip(find(Mark::Trailing, "te")?).map(|(leading, trailing)| [leading, trailing]))
    }

    fn farthest(&self, from_low_z: bool) -> [usize; 2] {
        let mut best = (0.0, [0, 0]);
        for (i, a) in self.points.iter().enumerate() {
            for (j, b) in self.points.iter().enumerate().skip(i + 1) {
                let apart = (a - b).norm_squared();
                if apart > best.0 {
                    best = (apart, [i, j]);
                }
            }
        }
        let [a, b] = best.1;
        if (self.points[a].z < self.points[b].z) == from_low_z { [a, b] } else { [b, a] }
    }
}
