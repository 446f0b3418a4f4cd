//! F words: written where the feed to send differs from the one the control would have, every other byte kept.
//!
//! F is modal. A rewritten F would leak into the blocks behind it, so each of them gets its own programmed F back.

use arcfeed_shared::nc::block::Block;
use arcfeed_shared::nc::modal::Feed;
use arcfeed_shared::nc::series::Series;
use arcfeed_shared::nc::word::Word;
use arcfeed_shared::reader::Understood;
use arcfeed_shared::segment::Path;
use arcfeed_shared::units::{LengthUnit, Nm};

use super::modes::Modes;
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
    pub fn edit(&mut self, line: &ProgramLine, governed: Option<Nm>, modes: Modes) -> Option<Edit> {
        let meaning = line.meaning.as_ref()?;
        let block = &meaning.parsed.block;
        let edit = self.edit_block(block, cutting_feed(meaning), governed, modes);
        if block.delete.is_some() {
            self.forget();
        }
        edit
    }

    fn edit_block(&mut self, block: &Block, own: Option<Feed>, governed: Option<Nm>, modes: Modes) -> Option<Edit> {
        let Modes { unit, per_minute, .. } = modes;
        let word = block.word(b'F');
        let own = match own {
            Some(Feed::PerMinute(own)) if per_minute => own,
            None if per_minute => {
                // An F without a cutting move: it becomes modal as it stands.
                self.modal = word.map_or(self.modal, |word| Some(Nm(word.number.scaled(unit.nm()))));
                return None;
            }
            _ => {
                // Under G93 F is a time, under G95 a path; what a control makes of it under G94 is its own affair.
                self.modal = None;
                return None;
            }
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

    /// Whether the control has read what was written last, a switch says.
    pub fn forget(&mut self) {
        self.modal = None;
    }

    /// The F of a block that is added behind the line; nothing where the control has it already.
    pub fn added(&mut self, feed: Nm, unit: LengthUnit) -> String {
        let had = self.modal.replace(feed);
        if had == Some(feed) { String::new() } else { feed_word(feed, unit) }
    }
}

/// The feed of a block that cuts, with one move or several.
fn cutting_feed(meaning: &Understood) -> Option<Feed> {
    match (&meaning.segment, &meaning.step.series) {
        (Some(segment), _) => Some(segment.feed).filter(|_| segment.path != Path::Rapid),
        (None, Some(Series::Drill(drill))) => Some(drill.feed),
        (None, Some(Series::Reference(_)) | None) => None,
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
    use arcfeed_shared::nc::settings::Reading;
    use std::path::Path as FilePath;

    /// Rewrites a program; arcs are governed and sent with `governed` in/min.
    fn rewrite(program: &str, governed: f64) -> String {
        let unit = LengthUnit::Inch;
        let program = Program::parse(FilePath::new("t.nc"), program.as_bytes(), unit, Reading::Lenient);
        let (mut rewriter, mut modes) = (FeedRewriter::default(), Modes::at_power_on(unit));
        let lines = program.lines.iter().map(|line| {
            let segment = line.meaning.as_ref().and_then(|meaning| meaning.segment);
            let governed = segment.and_then(|segment| {
                segment.arc()?;
                Some(round_down(governed * unit.mm(), unit))
            });
            modes = modes.after(line);
            let mut text = apply(&line.text, rewriter.edit(line, governed, modes).as_slice());
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
    fn cycles_and_moves_under_offsets_get_their_own_feed_back() {
        let program = "G1X0F25.\nG2X1.I.5\nG81X2.R.1Z-1.\nX3.\nG80G2X4.I.5\nG83X5.R.1Z-1.Q.2F8.\nG80G3X4.I-.5\nX5.I.5\n\
                       G28Z0F9.\nG1X6.\nG41D1X7.\n";
        let sent = "G1X0F25.\nG2X1.I.5F41.23\nG81X2.R.1Z-1.F25.\nX3.\nG80G2X4.I.5F41.23\nG83X5.R.1Z-1.Q.2F8.\n\
                    G80G3X4.I-.5F41.23\nX5.I.5\nG28Z0F9.\nG1X6.\nG41D1X7.\n";
        assert_eq!(rewrite(program, 41.237), sent);
    }

    #[test]
    fn behind_a_block_that_a_switch_may_skip_the_feed_is_said_again() {
        assert_eq!(
            rewrite("G1X0F25.\nG2X1.I.5\n/G1X2.\nX3.\n", 41.2),
            "G1X0F25.\nG2X1.I.5F41.2\n/G1X2.F25.\nX3.F25.\n"
        );
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
