//! The two sides of a wall's or blade's section, by points along its middle line.
//!
//! In the plane the first coordinate is along the chord, the second through the thickness. Lines through the thickness
//! meet the solid once. The middles of the met parts, with more weight for thick ones, give a parabola as middle line,
//! relative to the best straight line:
//!
//! ```text
//! least squares of w (a + b u + c u^2 - v)^2, w the square of what the line meets        (1)
//! middle line: v = c u^2, along a line that is turned by atan b and moved by a           (2)
//! ```
//!
//! The first lines are along the thickness, the second square to the straight line found by them, the last square to
//! the parabola. So a section that leans ends at its own edges, and the lines meet the sides squarely. Wherever the
//! middle line is, the points on the sides are exact.
//!
//! An edge is not part of the sides: they end where it is round or thin.
//!
//! Source: own.

use nalgebra::{Matrix3, Vector3};

use arcfeed_dexel::dexel::Interval;
use arcfeed_dexel::outline::{Outline, Point2};

/// Fraction of the largest thickness below which the sides end: elements that end in a line would be folded. The
/// resulting error: docs/fe.md.
const THIN_RATIO: f64 = 0.05;

/// Largest growth of the thickness over length: sides that meet at 60 degrees each, 2 tan 60, are the rounding of the
/// edge.
const STEEP_RATIO: f64 = 3.464;

/// Length over which growth is measured, as a fraction of the largest thickness.
const STEP_RATIO: f64 = 0.003;

/// Number of lines for finding the middle.
const LINES: usize = 64;

/// Number of these lines at both ends that may meet more than one part of the solid: facets of a leaning edge.
const OUTER_LINES: f64 = 8.0;

/// Halvings in the search for a section's end: one of `LINES` steps to 1e-11 of the chord.
const HALVINGS: usize = 30;

/// Reason why a section does not have two sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoSides {
    /// Point on the line.
    pub at_mm: Point2,
    /// Number of times that the line meets the solid.
    pub count: usize,
}

/// Middle line (2): its origin, its direction, c, and the coordinates between which the section is.
#[derive(Clone, Copy, Debug)]
struct Middle<'a> {
    outline: &'a Outline,
    origin_mm: Point2,
    along: Point2,
    bend_per_mm: f64,
    extent_mm: [f64; 2],
}

impl<'a> Middle<'a> {
    fn new(outline: &'a Outline, origin_mm: Point2, along: Point2, bend_per_mm: f64) -> Self {
        let extent_mm = outline.extent_mm(origin_mm, along).unwrap_or_default();
        Middle { outline, origin_mm, along, bend_per_mm, extent_mm }
    }

    /// Point on the middle line, and the direction square to it there.
    fn line(&self, u_mm: f64) -> (Point2, Point2) {
        let across = [-self.along[1], self.along[0]];
        let mixed = |u: f64, v: f64| [0, 1].map(|k| self.along[k] * u + across[k] * v);
        let place = mixed(u_mm, self.bend_per_mm * u_mm * u_mm);
        let slope = 2.0 * self.bend_per_mm * u_mm;
        let length = libm::hypot(1.0, slope);
        ([0, 1].map(|k| self.origin_mm[k] + place[k]), mixed(-slope / length, 1.0 / length))
    }

    /// Part of the solid on the line square to the middle line.
    fn met(&self, u_mm: f64) -> Result<Option<Interval>, NoSides> {
        let (at_mm, across) = self.line(u_mm);
        let met = self.outline.on_line(at_mm, across);
        let [low, high] = self.extent_mm;
        let is_outer = (u_mm - low).min(high - u_mm) < OUTER_LINES * self.step_mm();
        match met.intervals().len() {
            count if count > 1 && !is_outer => Err(NoSides { at_mm, count }),
            _ => Ok(met.extent()),
        }
    }

    /// Part of the solid on the line, which must exist.
    fn met_once(&self, u_mm: f64) -> Result<Interval, NoSides> {
        self.met(u_mm)?.ok_or_else(|| NoSides { at_mm: self.line(u_mm).0, count: 0 })
    }

    fn thickness_mm(&self, u_mm: f64) -> Result<f64, NoSides> {
        Ok(self.met(u_mm)?.map_or(0.0, |met| met.length_mm()))
    }

    fn step_mm(&self) -> f64 {
        (self.extent_mm[1] - self.extent_mm[0]) / LINES as f64
    }

    /// Coordinates of lines between both ends.
    fn lines(&self) -> [f64; LINES] {
        std::array::from_fn(|line| self.extent_mm[0] + (line as f64 + 0.5) * self.step_mm())
    }

    /// Parabola fitted by lines square to this straight middle line. (1)
    fn fitted(&self) -> Result<Self, NoSides> {
        let (mut left, mut right) = (Matrix3::zeros(), Vector3::zeros());
        let half_mm = self.step_mm() * LINES as f64 / 2.0;
        for u_mm in self.lines() {
            let met = self.met_once(u_mm)?;
            let powers = Vector3::new(1.0, u_mm / half_mm, u_mm * u_mm / (half_mm * half_mm));
            let weight = met.length_mm() * met.length_mm();
            left += powers * powers.transpose() * weight;
            right += powers * ((met.from_mm + met.to_mm) / 2.0 * weight);
        }
        let [a, b, c] = left.try_inverse().map_or([0.0; 3], |inverse| (inverse * right).into());
        let slope = b / half_mm;
        let length = libm::hypot(1.0, slope);
        let [x, y] = self.along;
        let along = [(x - slope * y) / length, (y + slope * x) / length];
        let origin_mm = [self.origin_mm[0] - a * y, self.origin_mm[1] + a * x];
        Ok(Middle::new(self.outline, origin_mm, along, c / (half_mm * half_mm))) // (2)
    }

    fn straightened(self) -> Self {
        Middle { bend_per_mm: 0.0, ..self }
    }

    fn thickest_mm(&self) -> Result<f64, NoSides> {
        self.lines().into_iter().try_fold(0.0, |thickest_mm: f64, u_mm| Ok(thickest_mm.max(self.thickness_mm(u_mm)?)))
    }

    /// Beginning of the sides, from the section's end; `inwards` is 1 from the lower end, -1 from the upper.
    fn end_mm(&self, inwards: f64, thickest_mm: f64) -> Result<f64, NoSides> {
        let next_mm = inwards * STEP_RATIO * thickest_mm;
        let is_side = |u_mm: f64| {
            let here_mm = self.thickness_mm(u_mm)?;
            let grown_mm = self.thickness_mm(u_mm + next_mm)? - here_mm;
            Ok(here_mm >= THIN_RATIO * thickest_mm && grown_mm <= STEEP_RATIO * next_mm.abs())
        };
        let mut outside = self.extent_mm[usize::from(inwards < 0.0)];
        let mut inside = outside + inwards * self.step_mm();
        for _ in 1..LINES {
            if is_side(inside)? {
                break;
            }
            (outside, inside) = (inside, inside + inwards * self.step_mm());
        }
        for _ in 0..HALVINGS {
            let between = (inside + outside) / 2.0;
            if is_side(between)? {
                inside = between;
            } else {
                outside = between;
            }
        }
        Ok(inside)
    }
}

/// Section of a sheet, with its lower and upper side.
#[derive(Clone, Copy, Debug)]
pub struct SheetSection<'a> {
    middle: Middle<'a>,
    /// Distances along the chord from the section's ends to the sides.
    pub inset_mm: [f64; 2],
}

impl<'a> SheetSection<'a> {
    /// Section inside an outline.
    ///
    /// # Errors
    /// A line through the thickness meets the solid never, or more than once.
    pub fn of(outline: &'a Outline) -> Result<Self, NoSides> {
        let middle_mm = [[1.0, 0.0], [0.0, 1.0]].map(|axis| {
            let [low, high] = outline.extent_mm([0.0; 2], axis).unwrap_or_default();
            (low + high) / 2.0
        });
        let straight = Middle::new(outline, middle_mm, [1.0, 0.0], 0.0);
        let middle = straight.fitted()?.straightened().fitted()?;
        let thickest_mm = middle.thickest_mm()?;
        let [low, high] = middle.extent_mm;
        let inset_mm = [middle.end_mm(1.0, thickest_mm)? - low, high - middle.end_mm(-1.0, thickest_mm)?];
        Ok(SheetSection { middle, inset_mm })
    }

    /// `places` pairs of points, one on the lower and one on the upper side, at equal distances along the middle line, from `inset_mm` within one end
    /// of the section to `inset_mm` within the other.
    ///
    /// # Errors
    /// The same as for [`Self::of`].
    pub fn sides(&self, inset_mm: [f64; 2], places: usize) -> Result<Vec<[Point2; 2]>, NoSides> {
        let [low, high] = self.middle.extent_mm;
        let (from_mm, to_mm) = (low + inset_mm[0], high - inset_mm[1]);
        let place = |place: usize| {
            let part = place as f64 / (places - 1) as f64;
            let u_mm = from_mm * (1.0 - part) + to_mm * part;
            let (at_mm, across) = self.middle.line(u_mm);
            let met = self.middle.met_once(u_mm)?;
            Ok([met.from_mm, met.to_mm].map(|v_mm| [0, 1].map(|k| at_mm[k] + across[k] * v_mm)))
        };
        (0..places).map(place).collect()
    }
}
