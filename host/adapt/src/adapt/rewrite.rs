//! Rewriting of F words: an F is written where the feed to be sent differs from the one in force on the control; every
//! other byte is kept.
//!
//! F is modal. A rewritten F would leak into the blocks behind it, so each of them gets its own programmed F back.

use arcfeed_nc::modal::Feed;
use arcfeed_nc::reader::InterpretedLine;
use arcfeed_nc::word::Word;
use arcfeed_units::{LengthUnit, Nm};

use super::modes::Modes;
use crate::program::ProgramLine;

/// Decimals of an F word: 0.01 in/min, 0.1 mm/min.
const fn feed_decimals(unit: LengthUnit) -> u32 {
    match unit {
        LengthUnit::Inch => 2,
        LengthUnit::Mm => 1,
    }
}

/// Change of a line's text: some bytes are removed and others inserted in their place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edit {
    /// Offset in the line of the first byte that is removed, and where the new text is inserted.
    pub at: usize,
    /// Number of bytes removed.
    pub len: usize,
    /// Bytes inserted in their place.
    pub new: String,
}

impl Edit {
    /// Edit that replaces the word by `new`.
    pub fn replacing(word: &Word, new: String) -> Self {
        Edit { at: usize::from(word.column) - 1, len: usize::from(word.len), new }
    }
}

/// Text of the line after these edits, which must not overlap.
pub fn apply(text: &[u8], edits: &[Edit]) -> Vec<u8> {
    let mut edits: Vec<&Edit> = edits.iter().collect();
    // An insertion before a word comes before a replacement of that word.
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

/// Writer of F words, line by line. It keeps the F that is in force on the control after the text written so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct FeedRewriter {
    in_force: ModalFeed,
}

/// An F in force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct ModalFeed {
    /// `None`: the program's own, whatever it is.
    feed: Option<Nm>,
    /// `true` if a law has set the feed.
    is_governed: bool,
}

/// Feed that a line requires to be in force.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Required {
    /// Nothing: it does not cut.
    Nothing,
    /// This feed.
    Feed(Nm),
    /// Programmed feed of the line, if there is one. A feed that a law has set serves only if it is the same.
    Own(Option<Nm>),
}

impl ModalFeed {
    /// Whether a line without an F word runs with what it requires. A feed that no law has set is the program's.
    fn serves(self, required: Required) -> bool {
        match required {
            Required::Nothing => true,
            Required::Feed(feed) => self.feed == Some(feed),
            Required::Own(own) => !self.is_governed || (own.is_some() && self.feed == own),
        }
    }
}

impl Required {
    fn of(governed: Option<Nm>, own: Option<Nm>) -> Self {
        governed.map_or(Required::Own(own), Required::Feed)
    }

    fn feed(self) -> Option<Nm> {
        match self {
            Required::Nothing | Required::Own(None) => None,
            Required::Feed(feed) | Required::Own(Some(feed)) => Some(feed),
        }
    }
}

/// Error: a feed set by a law would stay in force for a line that needs another feed, or that a block-delete switch
/// may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leak;

/// Whether a feed set by a law can stay in force for this line: a block-delete switch may change the line, or the
/// program has not stated a feed.
pub fn may_leak(line: &ProgramLine) -> bool {
    line.skipping.is_some() || line.meaning.as_ref().is_some_and(InterpretedLine::lacks_feed)
}

impl FeedRewriter {
    /// Edit that gives the line the feed `governed` or, if that is `None`, its programmed feed; `None` if the text
    /// already does. Lines that a block-delete switch may change are never edited: for them the programmed F must be in
    /// force.
    ///
    /// # Errors
    /// A feed that a law has set on an earlier line would stay in force for this line. The writer's state is unchanged
    /// then.
    pub fn edit(&mut self, line: &ProgramLine, governed: Option<Nm>, modes: Modes) -> Result<Option<Edit>, Leak> {
        let Some(meaning) = &line.meaning else { return Ok(None) };
        match line.skipping {
            Some(skipping) if skipping.is_harmless => return Ok(None),
            Some(_) if self.in_force.is_governed => return Err(Leak),
            Some(_) => {
                self.in_force = ModalFeed::default();
                return Ok(None);
            }
            None => {}
        }
        let block = &meaning.parsed.block;
        let word = block.word(b'F');
        let cutting_feed = meaning.step.cutting_feed();
        if !modes.per_minute || matches!(cutting_feed, Some(Feed::InverseTime(_))) {
            // Under G93 F is a time, under G95 a path; what a control makes of it under G94 is its own affair.
            self.in_force = ModalFeed::default();
            return Ok(None);
        }
        let required = match cutting_feed {
            None => Required::Nothing,
            Some(Feed::PerMinute(own)) => Required::of(governed, Some(own)),
            Some(_) => Required::of(governed, None),
        };
        let written = word.map(|word| Nm(word.number.scaled(modes.unit.nm())));
        let edit = match (word, required) {
            (Some(word), Required::Feed(feed)) if written != Some(feed) => {
                Some((feed, Edit::replacing(word, feed_word(feed, modes.unit))))
            }
            (Some(_), _) => None,
            (None, required) if self.in_force.serves(required) => None,
            (None, required) => {
                let new = required.feed().ok_or(Leak)?;
                Some((new, Edit { at: block.code_len, len: 0, new: feed_word(new, modes.unit) }))
            }
        };
        if let Some(feed) = edit.as_ref().map(|(feed, _)| *feed).or(written) {
            self.in_force = ModalFeed { feed: Some(feed), is_governed: governed.is_some() };
        }
        Ok(edit.map(|(_, edit)| edit))
    }

    /// F word for a block that is added after the line; empty if this F is already in force.
    pub fn added(&mut self, feed: Nm, unit: LengthUnit) -> String {
        let had = std::mem::replace(&mut self.in_force, ModalFeed { feed: Some(feed), is_governed: true });
        if had.feed == Some(feed) { String::new() } else { feed_word(feed, unit) }
    }
}

/// Largest feed per minute that an F word can express in this unit and that is not above `feed_mm_per_min`.
pub fn round_down(feed_mm_per_min: f64, unit: LengthUnit) -> Nm {
    let step_nm = unit.nm() / 10_i64.pow(feed_decimals(unit));
    Nm(Nm::from_mm(feed_mm_per_min).0.div_euclid(step_nm) * step_nm)
}

/// `F74.59`, `F25.`: always with a point, without idle zeros.
pub(super) fn feed_word(feed: Nm, unit: LengthUnit) -> String {
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

/// Whether the text of a block, comments excluded, has an F word.
pub fn has_feed(text: &[u8]) -> bool {
    let mut in_comment = false;
    text.iter().any(|&byte| {
        in_comment = (in_comment || byte == b'(') && byte != b')';
        !in_comment && byte.eq_ignore_ascii_case(&b'F')
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::Program;
    use arcfeed_nc::settings::Reading;
    use std::path::Path as FilePath;

    /// Rewrites a program; arcs are governed and sent with `governed` in/min.
    fn rewrite(program: &str, governed: f64) -> String {
        let unit = LengthUnit::Inch;
        let start = "G0X0Y0\n";
        let program = &format!("{start}{program}");
        let program = Program::parse(FilePath::new("t.nc"), program.as_bytes(), unit, Reading::Lenient);
        let (mut rewriter, mut modes) = (FeedRewriter::default(), Modes::at_power_on(unit));
        let lines = program.lines().map(|line| {
            let segment = line.meaning.as_ref().and_then(|meaning| meaning.segment);
            let governed = segment.and_then(|segment| {
                segment.arc()?;
                Some(round_down(governed * unit.mm(), unit))
            });
            modes = modes.after(&line);
            let mut text = apply(&line.text, rewriter.edit(&line, governed, modes).unwrap().as_slice());
            text.extend(&line.ending);
            String::from_utf8(text).unwrap()
        });
        let text: String = lines.collect();
        text[start.len()..].to_owned()
    }

    #[test]
    fn a_rewritten_feed_never_leaks_into_the_next_block() {
        let program = "G1X0Y0F25.\nG2X1.I.5\nG1X2.\nX3.\nG2X4.I.5 (LAST)\r\n";
        assert_eq!(rewrite(program, 41.237), "G1X0Y0F25.\nG2X1.I.5F41.23\nG1X2.F25.\nX3.\nG2X4.I.5F41.23 (LAST)\r\n");
    }

    #[test]
    fn cycles_and_moves_under_offsets_get_their_own_feed_back() {
        let program = "G1X0F25.\nG2X1.I.5\nG81X2.R.1Z-1.\nX3.\nG80G2X4.I.5\nG83X5.R.1Z-1.Q.2F8.\nG80G3X4.I-.5\nX5.I.5\n\
                       G28Z0F9.\nG1X6.\nG41D1X7.\n";
        let sent = "G1X0F25.\nG2X1.I.5F41.23\nG81X2.R.1Z-1.F25.\nX3.\nG80G2X4.I.5F41.23\nG83X5.R.1Z-1.Q.2F8.\n\
                    G80G3X4.I-.5F41.23\nX5.I.5\nG28Z0F9.\nG1X6.\nG41D1X7.\n";
        assert_eq!(rewrite(program, 41.237), sent);
    }

    #[test]
    fn governed_feed_does_not_leak_into_blocks_that_block_delete_may_change() {
        let leaks = |program: &str| std::panic::catch_unwind(|| rewrite(program, 41.2)).is_err();
        for skipped in ["/G1X2.", "/F9.", "/G21", "/G95", "/S9", "G1X2./F9.", "/2G1X2.\n/3G1X2."] {
            assert!(leaks(&format!("G1X0F25.\nG2X1.I.5\n{skipped}\nX3.\n")), "{skipped}");
        }
        let with_own = "G1X0F25.\nG2X1.I.5F41.2\nX1.1F25.\n/G1X2.\nX3.Y0\nG2X4.I.5F41.2\n";
        assert_eq!(
            rewrite(&with_own.replace("F41.2", "").replace("X1.1F25.", "G1X1.1"), 41.2),
            with_own.replace("X1.1F25.", "G1X1.1F25.")
        );
        assert_eq!(rewrite("G1X0F25.\nG2X1.I.5\n/M8\nX2.I.5\n", 41.2), "G1X0F25.\nG2X1.I.5F41.2\n/M8\nX2.I.5\n");
    }

    #[test]
    fn a_feed_per_revolution_is_left_alone() {
        let program = "G1X0F25.S100\nG2X1.I.5\nG95G1X2.F.05\nX3.\nG94X4.F25.\n";
        assert_eq!(rewrite(program, 41.2), program.replace("I.5", "I.5F41.2"));
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
