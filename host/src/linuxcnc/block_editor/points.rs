//! Points of blocks under polar coordinates (G16), scaling, mirror image (G51, G51.1) and rotation (G68), which LinuxCNC does not
//! have: written as coordinates along its axes.
//!
//! ```text
//! written = path - s
//! ```
//!
//! with the path and the shift s of `shared/nc/src/frame.rs`: LinuxCNC has the work offset, G52 and G92 itself.

use arcfeed_nc::modal::{Plane, Pose, Turn};
use arcfeed_nc::segment::{Arc, Path, Segment};
use arcfeed_nc::series::{Drill, Series};
use arcfeed_nc::settings::ArcCenters;
use arcfeed_units::Nm;

use super::motion::{hole_point, length};
use super::{BlockEditor, LinuxCncState, RefusedWord};
use crate::linuxcnc::codes::CodeGroup;

/// G51, G50.1, G51.1 and G68, whose blocks have words of their own.
const WITH_WORDS: [i64; 4] = [510, 501, 511, 680];
const ONE_SHOT: &str = "under G16, G51, G51.1 or G68 LinuxCNC goes to another point here; cancel them before the block";
const UNKNOWN: &str =
    "where this move begins under G16, G51, G51.1 or G68 is unknown; move all axes of the plane before it";
const SIDE: &str = "a mirror image exchanges G41 and G42, and LinuxCNC has none; post the contour without it";
const HOLES: &str = "under G16, G51, G51.1 or G68 holes are written for LinuxCNC in G17, and under G51 or G51.1 one a block and under G90; write them so";

impl BlockEditor<'_> {
    /// Writes the points of a block to which a transformation applies, or which follows one. Returns whether the motion of the
    /// block is written.
    pub(super) fn edit_points(&mut self, theirs: &mut LinuxCncState) -> Result<bool, RefusedWord> {
        let code = self.code(CodeGroup::Transformation);
        if let Some((word, code)) = code {
            self.drop_word(&word);
            if WITH_WORDS.contains(&code) {
                self.drop_words(b"XYZIJKPR");
            }
        }
        let modal = self.modal;
        let is_transformed = modal.polar.is_some() || !modal.frame.is_shift();
        theirs.is_transformed |= is_transformed;
        if !theirs.is_transformed || self.code(CodeGroup::Machine).is_some() {
            return Ok(false);
        }
        let column = self.words().first().map_or(1, |word| word.column);
        if let Some((word, _)) = self.code(CodeGroup::OneShot).filter(|(_, code)| *code != 40) {
            return if is_transformed && self.has_axis() { Err((word.column, ONE_SHOT)) } else { Ok(false) };
        }
        if modal.compensation.is_some() && modal.frame.scaling().is_some() {
            return Err((column, SIDE));
        }
        match (&self.line.segment, &self.line.step.series) {
            (_, Some(Series::Drill(drill))) => {
                let drill = *drill;
                self.write_hole_point(&drill, column)?;
                Ok(false)
            }
            (Some(segment), _) => {
                let (first, second, _) = modal.plane.axes();
                let names_both = [first, second].iter().all(|axis| self.word(b'X' + *axis as u8).is_some());
                let is_certain = modal.absolute && names_both && segment.arc().is_none();
                if self.line.starts_unknown && !is_certain {
                    return Err((column, UNKNOWN));
                }
                let segment = *segment;
                theirs.motion = Some(self.write_move(&segment));
                theirs.is_transformed = is_transformed || !names_both;
                Ok(true)
            }
            _ => Ok(false),
        }
    }

    /// Writes the point of a hole; the cycle keeps its other words.
    fn write_hole_point(&mut self, drill: &Drill, column: u16) -> Result<(), RefusedWord> {
        let is_single = drill.holes == 1 && self.modal.absolute;
        if drill.plane != Plane::Xy || !is_single && self.modal.frame.scaling().is_some() {
            return Err((column, HOLES));
        }
        if !is_single {
            return Ok(());
        }
        // A tap is written with its own point.
        if self.tapping_cycle().is_none() {
            self.drop_words(b"XY");
            let [x, y, _] = hole_point(drill, 0).linear.map(|value| length(value, self.modal.unit));
            self.insert += &format!("X{x} Y{y} ");
        }
        Ok(())
    }

    /// Writes a move with all its words; returns its motion code.
    fn write_move(&mut self, segment: &Segment) -> i64 {
        let Segment { start, end, path, .. } = segment;
        let shift = self.modal.frame.shift();
        let [from, to] = [start.minus(shift), end.minus(shift)];
        let origin = if self.modal.absolute { Pose::ORIGIN } else { from };
        let code = match path {
            Path::Rapid => 0,
            Path::Line => 1,
            Path::Arc(Arc { turn: Turn::Cw, .. }) => 2,
            Path::Arc(_) => 3,
        };
        let (unit, mut text) = (self.modal.unit, format!("G{code} "));
        let written = to.minus(origin).linear;
        for (axis, letter) in (b'X'..=b'Z').enumerate() {
            let (is_named, moves) = (self.word(letter).is_some(), to.linear.get(axis) != from.linear.get(axis));
            if let Some(value) = written.get(axis).filter(|_| is_named || moves) {
                text += &format!("{}{} ", char::from(letter), length(*value, unit));
            }
        }
        if let Path::Arc(arc) = path {
            let (first, second, _) = arc.plane.axes();
            let is_absolute = self.modal.arc_centers == ArcCenters::Absolute;
            let origin = if is_absolute { shift } else { *start };
            for (axis, center) in [first, second].into_iter().zip(arc.center) {
                let from = origin.linear.get(axis).copied().unwrap_or_default();
                let letter = char::from(b'I' + axis as u8);
                text += &format!("{letter}{} ", length(Nm(center.0 - from.0), unit));
            }
        }
        self.drop_words(b"XYZIJKR");
        let codes = [CodeGroup::Motion, CodeGroup::CycleEnd].map(|group| self.code(group));
        codes.iter().flatten().for_each(|(word, _)| self.drop_word(word));
        self.insert += &text;
        code
    }

    fn drop_words(&mut self, letters: &[u8]) {
        let words: Vec<_> = self.words().iter().filter(|word| letters.contains(&word.letter)).copied().collect();
        words.iter().for_each(|word| self.drop_word(word));
    }
}
