//! A line that ends in a chamfer or rounded corner, as two blocks: its own feed, programmed or that of its law, up to a point
//! shortly before the corner, the corner's feed from there on.
//!
//! The point is one of the control's least increments exactly on the line, so the path stays the same. Let the line have the
//! components `a` and `b` in increments: such points are the multiples of
//!
//! ```text
//! (a, b) / gcd(a, b)     (1)
//! ```
//!
//! from its start. The text of both blocks is read back as the control will read it.

use arcfeed_model::cut::Work;
use arcfeed_model::job::{Job, LawKind};
use arcfeed_model::tool::Tool;
use arcfeed_nc::modal::{Corner, Plane, Pose};
use arcfeed_nc::reader::Reader;
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::Nm;

use super::modes::Modes;
use super::rewrite::{FeedRewriter, apply};
use super::spelling::{Spelling, increment_nm};
use super::split::Whole;
use crate::program::ProgramLine;

/// Rounding of lengths whose ends are whole nanometres, mm.
const ROUNDING_MM: f64 = 1e-5;
/// Shortest part, whatever the job allows: far above the rounding.
const LEAST_MM: f64 = 0.01;

/// Straight move that ends in a chamfer or rounded corner (`,C`, `,R`), with its surroundings.
#[derive(Debug)]
pub struct CornerLine<'a> {
    /// Program line of the move.
    pub line: &'a ProgramLine,
    /// Straight move as programmed, between the points where the contour would have its sharp corners.
    pub programmed: Segment,
    /// Straight move that remains between the ends of the chamfers or rounded corners at its two ends.
    pub cut_off: Segment,
    /// Modes in force after the G words of the line.
    pub modes: Modes,
    /// State of the control before the line.
    pub before: &'a Reader,
    /// Shortest permitted length of each of the two blocks, mm.
    pub least_mm: f64,
}

/// Straight move with a corner at its end, written as two blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct TwoBlocks {
    /// Texts of the two blocks, without line ends.
    pub texts: Vec<Vec<u8>>,
    /// End of the first block, as a fraction (0 to 1) of the straight move that remains between the corners.
    pub until_ratio: f64,
}

impl CornerLine<'_> {
    /// Writes both blocks: the first with the feed `governed` of its law, or with the programmed one, the second with that of
    /// the `corner`. `rewriter` knows the F in force on the control; it does not change if the line stays whole.
    ///
    /// # Errors
    /// The reason why the line stays one block.
    pub fn write(&self, (governed, corner): (Option<Nm>, Nm), rewriter: &mut FeedRewriter) -> Result<TwoBlocks, Whole> {
        let meaning = self.line.meaning.as_ref().ok_or(Whole::Words)?;
        let plane = meaning.step.motion.as_ref().ok_or(Whole::Words)?.plane;
        let (end, until_ratio) = self.point(plane).ok_or(Whole::Digits)?;
        let block = &meaning.parsed.block;
        let spelling = Spelling::of_line(&self.line.text, block, self.modes, plane).ok_or(Whole::Words)?;
        let mut after = *rewriter;
        let mut edits = spelling.line_up_to(&self.programmed.start, &end).ok_or(Whole::Digits)?;
        edits.extend(after.edit(self.line, governed, self.modes).map_err(|_| Whole::Words)?);
        let rest = spelling.rest_of_line(&end, &self.programmed.end).ok_or(Whole::Digits)?;
        let rest = (rest + &after.added(corner, self.modes.unit)).into_bytes();
        let texts = vec![apply(&self.line.text, &edits), rest];
        if !self.reads_back(&texts, &end) {
            return Err(Whole::ReadBack);
        }
        *rewriter = after;
        Ok(TwoBlocks { texts, until_ratio })
    }

    /// The point next to the corner at which the line can be divided, and its place on the line that is cut off.
    fn point(&self, plane: Plane) -> Option<(Pose, f64)> {
        let Segment { start, end, .. } = self.programmed;
        let (first, second, _) = plane.axes();
        let step_nm = increment_nm(self.modes.unit);
        let origin = |axis: usize| if self.modes.absolute { 0 } else { start.linear[axis].0 };
        let increments = |nm: i64| (nm % step_nm == 0).then_some(nm / step_nm);
        let mut delta = [0; 3];
        for axis in [first, second] {
            increments(start.linear[axis].0 - origin(axis))?;
            delta[axis] = increments(end.linear[axis].0 - start.linear[axis].0)?;
        }
        let count = greatest_common_divisor(delta[first], delta[second]);
        let apart_mm = self.programmed.length_mm() / count as f64;
        let distance_mm = |from: &Pose, to: &Pose| Segment { start: *from, end: *to, ..self.programmed }.length_mm();
        let taken_mm = distance_mm(&self.cut_off.end, &end);
        let least_mm = self.least_mm.max(LEAST_MM);
        let from_end = libm::ceil((taken_mm + least_mm - ROUNDING_MM) / apart_mm);
        let (left_mm, whole_mm) = (from_end * apart_mm - taken_mm, self.cut_off.length_mm());
        if count == 0 || whole_mm - left_mm < least_mm {
            return None;
        }
        let mut point = start;
        for axis in [first, second] {
            point.linear[axis] = Nm(end.linear[axis].0 - delta[axis] / count * from_end as i64 * step_nm); // (1)
        }
        Some((point, 1.0 - left_mm / whole_mm))
    }

    fn reads_back(&self, texts: &[Vec<u8>], end: &Pose) -> bool {
        let programmed = self.programmed;
        let mut reader = self.before.clone();
        let mut read = |text: &[u8]| -> Option<(Segment, Option<Corner>)> {
            let read = reader.read(text).ok()?;
            Some((read.segment?.shifted(Pose::ORIGIN.minus(self.line.origin)), read.step.corner))
        };
        let own = self.line.meaning.as_ref().and_then(|meaning| meaning.step.corner);
        let wanted = [(programmed.start, *end, None), (*end, programmed.end, own)];
        texts.len() == wanted.len()
            && texts.iter().zip(wanted).all(|(text, (start, end, corner))| {
                read(text).is_some_and(|(segment, found)| {
                    (segment.start, segment.end, segment.path, found) == (start, end, Path::Line, corner)
                })
            })
    }
}

/// Whether the law of this cut rule (index in the job) evaluates each move by itself, so that it can also govern moves next to chamfers
/// and rounded corners.
pub fn governs_corners(job: &Job, rule: usize) -> bool {
    job.rules.get(rule).is_some_and(|rule| {
        let setup = job.tool_of(rule);
        let is_mill = matches!((&setup.tool, &rule.work), (Tool::EndMill(_), Work::Mill { .. }));
        is_mill && matches!(setup.law, LawKind::Contour { .. } | LawKind::Engagement)
    })
}

fn greatest_common_divisor(a: i64, b: i64) -> i64 {
    let (mut a, mut b) = (a.abs(), b.abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_a_line_are_as_far_apart_as_its_components_allow() {
        let divisors = [(12, 18), (0, 7), (-4, 0), (0, 0), (-9, 6), (1, 1_000_000)];
        assert_eq!(divisors.map(|(a, b)| greatest_common_divisor(a, b)), [6, 7, 4, 0, 3, 1]);
    }
}
