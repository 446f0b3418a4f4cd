//! Text of the blocks into which a move is divided, in the style of the program: letters of its plane, G90 or G91, decimal points or least
//! increments, I, J, K or R.
//!
//! The first piece is the block itself with another end point; what else stands in the block stays there. The pieces behind
//! it repeat only what they need: `/`, the G word if there was one, the end point, the centre.

use arcfeed_nc::block::Block;
use arcfeed_nc::modal::{Plane, Pose};
use arcfeed_nc::number::DIGITS_MAX;
use arcfeed_nc::segment::Arc;
use arcfeed_nc::word::{CHAMFER, ROUNDING, Word};
use arcfeed_units::LengthUnit;

use super::modes::Modes;
use super::rewrite::Edit;

const AXES: [u8; 3] = *b"XYZ";
const OFFSETS: [u8; 3] = *b"IJK";
/// Words that a block may have to be written in pieces: what they do holds for all pieces, or has no harm done twice.
const G_WORDS: [i64; 26] =
    [1, 2, 3, 17, 18, 19, 20, 21, 40, 49, 54, 55, 56, 57, 58, 59, 61, 64, 80, 90, 91, 94, 98, 99, 15, 69];

/// Least increment of an axis word in this unit, nm.
pub const fn increment_nm(unit: LengthUnit) -> i64 {
    match unit {
        LengthUnit::Inch => unit.nm() / 10_000,
        LengthUnit::Mm => unit.nm() / 1_000,
    }
}

/// Style in which a block of the program is written, for the pieces that replace the block.
#[derive(Clone, Copy, Debug)]
pub struct Spelling<'a> {
    text: &'a [u8],
    block: &'a Block,
    modes: Modes,
    shape: WrittenShape,
}

/// Shape of a move that is written as several blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WrittenShape {
    /// An arc in this plane, or a line in it that ends at a chamfer or rounded corner.
    InPlane(Plane),
    /// A line along the axis with this index (0 X, 1 Y, 2 Z).
    Line(usize),
}

impl<'a> Spelling<'a> {
    /// Style of a move's block; `None` if the block has words that several blocks cannot share.
    pub fn of(text: &'a [u8], block: &'a Block, modes: Modes, shape: WrittenShape) -> Option<Self> {
        let is_shared = |word: &Word| match word.letter {
            b'G' => word.number.as_whole().is_some_and(|code| G_WORDS.contains(&code)),
            letter => b"XYZIJKRF".contains(&letter),
        };
        let is_plain = block.words.iter().all(is_shared) && !block.assigns && block.program.is_none();
        is_plain.then_some(Spelling { text, block, modes, shape })
    }

    /// Style of the block of a line that ends at a chamfer or rounded corner; `None` if it has words that two blocks cannot share.
    pub fn of_line(text: &'a [u8], block: &'a Block, modes: Modes, plane: Plane) -> Option<Self> {
        let is_shared = |word: &Word| match word.letter {
            b'G' => word.number.as_whole().is_some_and(|code| G_WORDS.contains(&code) && code != 2 && code != 3),
            CHAMFER | ROUNDING => true,
            letter => b"XYZF".contains(&letter),
        };
        let is_plain = block.words.iter().all(is_shared) && !block.assigns && block.program.is_none();
        let shape = WrittenShape::InPlane(plane);
        (is_plain && block.delete.is_none()).then_some(Spelling { text, block, modes, shape })
    }

    /// Edits that turn a line's block into its first part, which ends at `end` and has no corner; `None` if a number cannot be written in
    /// the program's style.
    pub fn line_up_to(&self, start: &Pose, end: &Pose) -> Option<Vec<Edit>> {
        let mut edits = vec![Edit::replacing(self.corner()?, String::new())];
        for (axis, word) in self.axis_words() {
            edits.push(Edit::replacing(word, self.coordinate(axis, start, end)?));
        }
        Some(edits)
    }

    /// Text of the second part of a line, with its corner but without F; `None` if a number cannot be written.
    pub fn rest_of_line(&self, start: &Pose, end: &Pose) -> Option<String> {
        let words = self.axis_words().map(|(axis, _)| self.coordinate(axis, start, end)).collect::<Option<String>>()?;
        Some(words + self.written(self.corner()?))
    }

    fn corner(&self) -> Option<&'a Word> {
        self.block.words.iter().find(|word| matches!(word.letter, CHAMFER | ROUNDING))
    }

    /// Words of the axes in the plane, in the order X, Y, Z.
    fn axis_words(&self) -> impl Iterator<Item = (usize, &'a Word)> + use<'a> {
        let block = self.block;
        self.axes(false).filter_map(move |axis| Some((axis, block.word(AXES[axis])?)))
    }

    /// The block gives the arc by its radius R, not by its centre.
    pub fn is_by_radius(&self) -> bool {
        self.block.word(b'R').is_some()
    }

    /// Edits that turn the block into its first piece, which ends at `end`; `None` if a number cannot be written.
    pub fn first(&self, start: &Pose, end: &Pose, rises: bool) -> Option<Vec<Edit>> {
        let mut edits = Vec::new();
        let mut missing = String::new();
        for axis in self.axes(rises) {
            let new = self.coordinate(axis, start, end)?;
            match self.block.word(AXES[axis]) {
                Some(word) => edits.push(Edit::replacing(word, new)),
                None => missing += &new,
            }
        }
        if let Some(word) = self.block.word(b'R') {
            edits.push(Edit::replacing(word, self.radius()?));
        }
        if !missing.is_empty() {
            let center = self.block.words.iter().find(|word| b"IJKR".contains(&word.letter));
            edits.push(Edit { at: center.map_or(self.block.code_len, column), len: 0, new: missing });
        }
        Some(edits)
    }

    /// Text of a later piece, without F; `None` if a number cannot be written.
    pub fn later(&self, start: &Pose, end: &Pose, arc: Option<&Arc>, rises: bool) -> Option<String> {
        let mut text = match self.block.delete {
            Some(1) => "/".to_owned(),
            Some(switch) => format!("/{switch}"),
            None => String::new(),
        };
        let motion = self
            .block
            .words
            .iter()
            .rev()
            .find(|word| word.letter == b'G' && word.number.as_whole().is_some_and(|code| code == 2 || code == 3));
        text += motion.map_or("", |word| self.written(word));
        for axis in self.axes(rises) {
            text += &self.coordinate(axis, start, end)?;
        }
        if self.is_by_radius() {
            return Some(text + &self.radius()?);
        }
        let Some(arc) = arc else { return Some(text) };
        let (first, second, _) = arc.plane.axes();
        for (axis, center) in [(first, arc.center[0]), (second, arc.center[1])] {
            text += &self.word(OFFSETS[axis], center.0 - start.linear[axis].0)?;
        }
        Some(text)
    }

    /// The axes that every piece names, in the order X, Y, Z.
    fn axes(&self, rises: bool) -> impl Iterator<Item = usize> + use<> {
        let shape = self.shape;
        (0..3).filter(move |axis| match shape {
            WrittenShape::InPlane(plane) => rises || *axis != plane.axes().2,
            WrittenShape::Line(along) => *axis == along,
        })
    }

    fn coordinate(&self, axis: usize, start: &Pose, end: &Pose) -> Option<String> {
        let from = if self.modes.absolute { 0 } else { start.linear[axis].0 };
        self.word(AXES[axis], end.linear[axis].0 - from)
    }

    /// R of a piece: all of them turn by less than half a turn.
    fn radius(&self) -> Option<String> {
        Some(self.written(self.block.word(b'R')?).replace('-', ""))
    }

    fn written(&self, word: &Word) -> &'a str {
        let bytes = self.text.get(column(word)..column(word) + usize::from(word.len)).unwrap_or_default();
        core::str::from_utf8(bytes).unwrap_or_default()
    }

    /// A length word, with a decimal point or without as the block writes them; a zero says nothing of that.
    fn word(&self, letter: u8, nm: i64) -> Option<String> {
        let is_length =
            |word: &&Word| b"XYZIJKR".contains(&word.letter) && word.number.scaled(self.modes.unit.nm()) != 0;
        let mut lengths = self.block.words.iter().filter(is_length).peekable();
        let letter = char::from(letter);
        if lengths.peek().is_none() || lengths.any(|word| word.number.has_point()) {
            return decimal(nm, self.modes.unit).map(|number| format!("{letter}{number}"));
        }
        let increment = increment_nm(self.modes.unit);
        let is_whole = nm % increment == 0 && (nm / increment).abs() < 10_i64.pow(DIGITS_MAX as u32);
        is_whole.then(|| format!("{letter}{}", nm / increment))
    }
}

/// Offset of a word's letter.
fn column(word: &Word) -> usize {
    usize::from(word.column) - 1
}

/// A length with a point, without idle zeros: `12.5`, `-0.001`, `3.`; `None` if the digits of a control do not do.
fn decimal(nm: i64, unit: LengthUnit) -> Option<String> {
    let mut decimals = 0;
    // Beyond, a unit is no whole number of nanometres.
    let most = if unit == LengthUnit::Inch { 5 } else { 6 };
    while nm % (unit.nm() / 10_i64.pow(decimals)) != 0 {
        decimals += 1;
        if decimals > most {
            return None;
        }
    }
    let (whole, rest) = (nm.abs() / unit.nm(), nm.abs() % unit.nm());
    let fraction = rest / (unit.nm() / 10_i64.pow(decimals));
    let sign = if nm < 0 { "-" } else { "" };
    let width = decimals as usize;
    let fraction = if width > 0 { format!("{fraction:0width$}") } else { String::new() };
    let digits = format!("{whole}{fraction}");
    (digits.len() <= DIGITS_MAX).then(|| format!("{sign}{whole}.{fraction}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_written_exactly_or_not_at_all() {
        let mm = |nm| decimal(nm, LengthUnit::Mm);
        let written = [12_500_000, -1_000, 3_000_000, 0, -999_999].map(|nm| mm(nm).unwrap());
        assert_eq!(written, ["12.5", "-0.001", "3.", "0.", "-0.999999"]);
        assert_eq!(decimal(2_540, LengthUnit::Inch).as_deref(), Some("0.0001"));
        assert_eq!((decimal(1, LengthUnit::Inch), mm(123_456_789)), (None, None));
    }
}
