//! F words: written where the feed to send differs from the one the control would have, every other byte kept.
//!
//! F is modal. A rewritten F would leak into the blocks behind it, so each of them gets its own programmed F back.

use arcfeed_shared::nc::modal::Feed;
use arcfeed_shared::nc::word::Word;
use arcfeed_shared::segment::{Path, Segment};
use arcfeed_shared::units::{LengthUnit, Nm};

use crate::program::ProgramLine;

/// Decimals of an F word: 0.01 in/min, 0.1 mm/min.
const fn feed_decimals(unit: LengthUnit) -> u32 {
    match unit {
        LengthUnit::Inch => 2,
        LengthUnit::Mm => 1,
    }
}

/// A change to a line's text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edit {
    /// Offset of the bytes that go.
    pub at: usize,
    /// How many go.
    pub len: usize,
    /// What comes in their place.
    pub new: String,
}

impl Edit {
    /// Another word in place of one.
    pub fn replacing(word: &Word, new: String) -> Self {
        Edit { at: usize::from(word.column) - 1, len: usize::from(word.len), new }
    }
}

/// A text with its changes, which must not overlap.
pub fn apply(text: &[u8], edits: &[Edit]) -> Vec<u8> {
    let mut edits: Vec<&Edit> = edits.iter().collect();
    // What is inserted before a word comes before what replaces it.
    edits.sort_by_key(|edit| (edit.at, edit.len));
    let (mut changed, mut done) = (Vec::with_capacity(text.len()), 0);
    for edit in edits {
        changed.extend(&text[done..edit.at]);
        changed.extend(edit.new.bytes());
        done = edit.at + edit.len;
    }
    changed.extend(&text[done..]);
    changed
}

/// The F that the control has after what was written so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct FeedRewriter {
    modal: Option<Nm>,
}

impl FeedRewriter {
    /// What makes the line be sent with `governed` as its feed, or with its own.
    pub fn edit(
        &mut self,
        line: &ProgramLine,
        segment: Option<Segment>,
        governed: Option<Nm>,
        unit: LengthUnit,
    ) -> Option<Edit> {
        let block = &line.meaning.as_ref()?.parsed.block;
        let word = block.word(b'F');
        let Some(segment) = segment.filter(|segment| segment.path != Path::Rapid) else {
            // An F without a cutting move: it becomes modal as it stands.
            if let Some(word) = word {
                self.modal = Some(Nm(word.number.scaled(unit.nm())));
            }
            return None;
        };
        let Feed::PerMinute(own) = segment.feed else {
            // Under G93 F is a time, and what a control makes of it under G94 is its own affair.
            self.modal = None;
            return None;
        };
        let wanted = governed.unwrap_or(own);
        let (had, written) = (self.modal, word.map(|word| Nm(word.number.scaled(unit.nm()))));
        self.modal = Some(wanted);
        match word {
            Some(_) if written == Some(wanted) => None,
            Some(word) => Some(Edit::replacing(word, feed_word(wanted, unit))),
            None if had == Some(wanted) => None,
            None => Some(Edit { at: block.code_len, len: 0, new: feed_word(wanted, unit) }),
        }
    }

    /// The F of a block that is added behind the line; nothing where the control has it already.
    pub fn added(&mut self, feed: Nm, unit: LengthUnit) -> String {
        let had = self.modal.replace(feed);
        if had == Some(feed) { String::new() } else { feed_word(feed, unit) }
    }
}

/// The largest feed an F word can express that does not exceed `feed`.
pub fn round_down(feed_mm_per_min: f64, unit: LengthUnit) -> Nm {
    let step_nm = unit.nm() / 10_i64.pow(feed_decimals(unit));
    Nm(Nm::from_mm(feed_mm_per_min).0.div_euclid(step_nm) * step_nm)
}

/// `F74.59`, `F25.`: always with a point, without idle zeros.
fn feed_word(feed: Nm, unit: LengthUnit) -> String {
    let mut decimals = feed_decimals(unit);
    let scale = |decimals: u32| unit.nm() / 10_i64.pow(decimals);
    // A program's own feed may be finer than what we write.
    while feed.0 % scale(decimals) != 0 && decimals < 5 {
        decimals += 1;
    }
    let units = feed.0 / unit.nm();
    let fraction = feed.0 % unit.nm() / scale(decimals);
    let width = decimals as usize;
    let digits = format!("{fraction:0width$}");
    format!("F{units}.{}", digits.trim_end_matches('0'))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::Program;
    use arcfeed_shared::nc::block::Reading;
    use std::path::Path as FilePath;

    /// Rewrites a program; arcs are governed and sent with `governed` in/min.
    fn rewrite(program: &str, governed: f64) -> String {
        let unit = LengthUnit::Inch;
        let program = Program::parse(FilePath::new("t.nc"), program.as_bytes(), unit, Reading::Lenient);
        let mut rewriter = FeedRewriter::default();
        let lines = program.lines.iter().map(|line| {
            let segment = line.meaning.as_ref().and_then(|meaning| meaning.segment);
            let governed = segment.and_then(|segment| {
                segment.arc()?;
                Some(round_down(governed * unit.mm(), unit))
            });
            let mut text = apply(&line.text, rewriter.edit(line, segment, governed, unit).as_slice());
            text.extend(&line.ending);
            String::from_utf8(text).unwrap()
        });
        lines.collect()
    }

    #[test]
    fn a_rewritten_feed_never_leaks_into_the_next_block() {
        let program = "G1X0Y0F25.\nG2X1.I.5\nG1X2.\nX3.\nG2X4.I.5 (LAST)\r\n";
        assert_eq!(rewrite(program, 41.237), "G1X0Y0F25.\nG2X1.I.5F41.23\nG1X2.F25.\nX3.\nG2X4.I.5F41.23 (LAST)\r\n");
    }

    #[test]
    fn an_f_word_is_replaced_in_place() {
        assert_eq!(rewrite("G94G2F25.X1.I.5\n", 60.5), "G94G2F60.5X1.I.5\n");
    }

    #[test]
    fn what_already_fits_is_left_alone() {
        let program = "G1X0F40\nG2X1.I.5\nG3X0.I-.5F40.\n";
        assert_eq!(rewrite(program, 40.0), program);
    }

    #[test]
    fn inverse_time_is_left_alone_and_asks_for_a_fresh_feed() {
        let program = "G94G1X1.F25.\nG93X2.F50.\nG94G2X3.I.5F25.\nG1X4.\n";
        assert_eq!(rewrite(program, 30.0), "G94G1X1.F25.\nG93X2.F50.\nG94G2X3.I.5F30.\nG1X4.F25.\n");
    }

    #[test]
    fn a_feed_on_its_own_stays_and_counts() {
        let program = "F30.\nG2X1.I.5\nG1X2.\n";
        assert_eq!(rewrite(program, 30.0), program);
    }

    #[test]
    fn feeds_round_to_the_thin_side_in_the_programs_unit() {
        let word = |mm_per_min: f64, unit| feed_word(round_down(mm_per_min, unit), unit);
        assert_eq!(word(1_894.99, LengthUnit::Inch), "F74.6");
        assert_eq!(word(1_894.83, LengthUnit::Inch), "F74.59");
        assert_eq!(word(635.0, LengthUnit::Inch), "F25.");
        assert_eq!(word(635.19, LengthUnit::Mm), "F635.1");
    }
}
