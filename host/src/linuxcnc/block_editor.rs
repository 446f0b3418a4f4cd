//! Translation of the words of one block from a Fanuc's dialect to LinuxCNC's.

mod motion;

mod points;

mod tapping;

mod m_codes;

use std::collections::BTreeMap;

use arcfeed_nc::modal::{Modal, MotionKind, Plane};
use arcfeed_nc::number::Number;
use arcfeed_nc::reader::InterpretedLine;
use arcfeed_nc::settings::Decimals;
use arcfeed_nc::word::{CHAMFER, ROUNDING, Word};
use arcfeed_units::LengthUnit;

use super::codes::{CodeGroup, FeedSource, GRule, OFFSET_REMEDY, g_rule};

/// Tolerance of the path at corners, in millimetres and in inches.
const PATH_TOLERANCE: [&str; 2] = ["0.01", "0.0004"];
const NO_CORNER: &str = "LinuxCNC inserts no chamfer or rounded corner; write it as a block of its own";
const UNUSED: &str = "LinuxCNC has no use for this word here; remove it";

/// First of the coordinate systems of G54.1.
const EXTENDED: u16 = 6;

/// Word that LinuxCNC cannot execute: its column in the block, and the remedy.
pub type RefusedWord = (u16, &'static str);

/// LinuxCNC's G64 block with the tolerance at corners. Moves are not merged, so that each move keeps its line.
pub fn path_control(unit: LengthUnit) -> String {
    let [mm, inch] = PATH_TOLERANCE;
    format!("G64 P{} Q0", if unit == LengthUnit::Mm { mm } else { inch })
}

/// State of LinuxCNC while it executes the translated program, where it differs from that of the Fanuc control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinuxCncState {
    /// G code of the motion or canned cycle in force (1 for G1); `None`: none.
    pub motion: Option<i64>,
    /// M29 is in force: taps move in step with the spindle.
    pub taps_rigidly: bool,
    /// The spindle turns for taps.
    pub is_tapping: bool,
    /// G16, G51, G51.1 or G68 is in force, or no block since has named both axes of the plane.
    pub is_transformed: bool,
}

/// Editor of one Fanuc block: collects the changes that translate the block to LinuxCNC's dialect.
pub struct BlockEditor<'a> {
    line: &'a InterpretedLine,
    /// State of the control behind the block.
    modal: &'a Modal,
    decimals: Decimals,
    /// New text of each changed word, by its column; an empty text removes the word.
    pub edits: BTreeMap<u16, String>,
    /// Text to be inserted before the first word.
    pub insert: String,
    /// Blocks to be added after this one.
    pub behind: Vec<String>,
    /// Words that follow in a block of their own.
    later: String,
    /// G codes that stay, with their groups.
    codes: Vec<(Word, i64, CodeGroup)>,
    has_dropped: bool,
    /// A rotary axis turns before the hole of the block, which follows in a block of its own.
    turns: bool,
}

impl<'a> BlockEditor<'a> {
    /// Editor of a block that leaves the control in the state `modal`, and LinuxCNC in the state `theirs`.
    ///
    /// # Errors
    /// The first word that LinuxCNC does not read, or reads as something else.
    pub fn new(
        line: &'a InterpretedLine,
        modal: &'a Modal,
        decimals: Decimals,
        theirs: &mut LinuxCncState,
    ) -> Result<Self, RefusedWord> {
        let (edits, insert, later, codes) = (BTreeMap::new(), String::new(), String::new(), Vec::new());
        let behind = Vec::new();
        let (has_dropped, turns) = (false, false);
        let mut editor = BlockEditor { line, modal, decimals, edits, insert, behind, later, codes, has_dropped, turns };
        editor.edit_g_codes()?;
        editor.edit_one_shots()?;
        editor.write_offsets();
        let is_written = editor.edit_points(theirs)? || editor.edit_hole(theirs)?;
        if !editor.edit_tapping(theirs)? && !is_written {
            editor.set_motion(theirs)?;
            editor.edit_cycle()?;
        }
        for word in &line.parsed.block.words {
            editor.edit_word(word)?;
        }
        editor.edit_m_codes(theirs)?;
        Ok(editor)
    }

    /// Checks that LinuxCNC's component `arcfeed` can follow the block, if the component sets the feed.
    ///
    /// # Errors
    /// The word that it does not follow.
    pub fn check(&self, feed: FeedSource) -> Result<(), RefusedWord> {
        if feed == FeedSource::Words {
            return Ok(());
        }
        let shifts = self.codes.iter().find(|(_, code, _)| matches!(code, 100 | 520 | 920 | 921));
        if let Some((word, ..)) = shifts {
            return Err((
                word.column,
                "the component follows no shift within a program; use G54 to G59, set before it runs",
            ));
        }
        if let Some((word, _)) = self.code(CodeGroup::Transformation) {
            return Err((word.column, "the component follows no transformation; use rewrite-only for this program"));
        }
        if let Some((word, ..)) = self.codes.iter().find(|(_, code, _)| *code == 950) {
            return Err((word.column, "the component has feeds per minute; write G94"));
        }
        if self.tapping_cycle().is_some() {
            let column = self.words().first().map_or(1, |word| word.column);
            return Err((column, "the component does not tap; use rewrite-only for this program"));
        }
        let switches =
            self.words().iter().find(|word| word.letter == b'M' && matches!(word.number.as_whole(), Some(48 | 49)));
        match switches {
            Some(word) => {
                Err((word.column, "the component needs the feed override; remove the code, or use rewrite-only"))
            }
            None => Ok(()),
        }
    }

    fn words(&self) -> &'a [Word] {
        &self.line.parsed.block.words
    }

    fn word(&self, letter: u8) -> Option<&'a Word> {
        self.line.parsed.block.word(letter)
    }

    fn code(&self, of: CodeGroup) -> Option<(Word, i64)> {
        self.codes.iter().find(|(.., group)| *group == of).map(|(word, code, _)| (*word, *code))
    }

    fn drop_word(&mut self, word: &Word) {
        self.edits.insert(word.column, String::new());
    }

    fn has_axis(&self) -> bool {
        self.words().iter().any(|word| b"XYZABC".contains(&word.letter))
    }

    /// Sorts the G codes; the last one of a group counts.
    fn edit_g_codes(&mut self) -> Result<(), RefusedWord> {
        for word in self.words().iter().rev().filter(|word| word.letter == b'G') {
            let tenths = word.number.as_tenths().unwrap_or(-1);
            match g_rule(tenths) {
                GRule::Refuse(remedy) => return Err((word.column, remedy)),
                GRule::DropAlone if self.has_axis() => return Err((word.column, UNUSED)),
                GRule::Drop | GRule::DropAlone => {
                    self.has_dropped = true;
                    self.drop_word(word);
                }
                GRule::Keep(group) if self.code(group).is_some() => self.drop_word(word),
                GRule::Keep(CodeGroup::Path) if tenths != 610 => {
                    self.edits.insert(word.column, path_control(self.modal.unit));
                    self.codes.push((*word, tenths, CodeGroup::Path));
                }
                GRule::Keep(group) => {
                    if group == CodeGroup::State(4) {
                        self.set_system(word)?;
                    }
                    self.codes.push((*word, tenths, group));
                }
            }
        }
        if let (Some((motion, _)), Some(_)) = (self.code(CodeGroup::Motion), self.code(CodeGroup::Cycle)) {
            return Err((motion.column, "LinuxCNC has G0 to G3 and the cycles in one group; write them in two blocks"));
        }
        Ok(())
    }

    /// Writes G54.1 P1 to P3 as G59.1 to G59.3.
    fn set_system(&mut self, word: &Word) -> Result<(), RefusedWord> {
        match self.modal.system.checked_sub(EXTENDED) {
            None => {}
            Some(number @ 0..=2) => drop(self.edits.insert(word.column, format!("G59.{}", number + 1))),
            Some(_) => return Err((word.column, "write G54 to G59.3, LinuxCNC's nine coordinate systems")),
        }
        Ok(())
    }

    fn edit_one_shots(&mut self) -> Result<(), RefusedWord> {
        let Some((word, code)) = self.code(CodeGroup::OneShot) else { return Ok(()) };
        if let Some((motion, _)) = self.code(CodeGroup::Motion) {
            self.drop_word(&motion);
        }
        let whole = |word: Option<&Word>| word.and_then(|word| word.number.as_whole());
        match code {
            40 => {
                let seconds = self.line.step.dwell.map_or(0.0, |dwell| dwell.to_s());
                let place = self.words().iter().find(|word| b"XPU".contains(&word.letter));
                if let Some(place) = place {
                    self.edits.insert(place.column, format!("P{seconds}"));
                }
            }
            100 => {
                let is_work = whole(self.word(b'L')) == Some(2) && self.modal.absolute;
                if !is_work || !whole(self.word(b'P')).is_some_and(|number| (1..=6).contains(&number)) {
                    return Err((word.column, OFFSET_REMEDY));
                }
            }
            300 if !matches!(whole(self.word(b'P')), None | Some(2)) => {
                return Err((word.column, "LinuxCNC has two reference points; write G28 or G30"));
            }
            300 => self.word(b'P').into_iter().for_each(|word| self.drop_word(word)),
            520 | 920 if self.modal.local != Default::default() && self.modal.preset != Default::default() => {
                return Err((word.column, "LinuxCNC keeps G52 and G92 in one register; use one of them"));
            }
            _ => {}
        }
        Ok(())
    }

    /// Writes the numbers H and D of G43, G41 and G42, which LinuxCNC does not keep from earlier blocks.
    fn write_offsets(&mut self) {
        let Modal { length_offset, radius_offset, .. } = *self.modal;
        let codes = [(3, b'H', length_offset), (2, b'D', radius_offset)];
        for (group, letter, number) in codes {
            let Some((word, code)) = self.code(CodeGroup::State(group)) else { continue };
            if matches!(code, 410 | 420 | 430) && self.word(letter).is_none() {
                self.edits.insert(word.column, format!("G{} {}{number}", code / 10, char::from(letter)));
            }
        }
    }

    fn edit_word(&mut self, word: &Word) -> Result<(), RefusedWord> {
        let is_last = self.word(word.letter).is_some_and(|last| last.column == word.column);
        if self.edits.contains_key(&word.column) || matches!(word.letter, b'G' | b'M') {
            return Ok(());
        }
        let is_stored = self.is_stored() && b"XYZRPQKL".contains(&word.letter);
        if !is_last || is_stored || (self.has_dropped && matches!(word.letter, b'P' | b'Q')) {
            self.drop_word(word);
            return Ok(());
        }
        let cycle = self.modal.cycle.filter(|_| self.code(CodeGroup::OneShot).is_none()).map(|cycle| cycle.code);
        let is_arc = matches!(self.modal.motion, MotionKind::Arc(_)) && cycle.is_none();
        let is_table = self.code(CodeGroup::OneShot).is_some_and(|(_, code)| code == 100);
        let state = |group: u8| self.code(CodeGroup::State(group)).map(|(_, code)| code);
        match (word.letter, cycle) {
            (b'A' | b'B' | b'C', Some(_)) if self.turns => self.spell(word),
            (b'A' | b'B' | b'C', Some(_)) => {
                return Err((word.column, "LinuxCNC turns no axis in a cycle; write the word in a block before it"));
            }
            (b'X' | b'Y' | b'Z' | b'A' | b'B' | b'C', _) | (b'R', Some(_)) => self.spell(word),
            (b'F', _) if state(7).is_none() && self.feed_counts_otherwise(word.number) => {
                return Err((word.column, "a feed per revolution without a decimal point; write the point"));
            }
            (b'S' | b'T' | b'F', _) => {}
            (b'P', Some(82 | 86 | 89)) => self.in_seconds(word)?,
            (b'Q', Some(73 | 83)) => self.spell(word),
            (b'P' | b'Q', Some(_)) => self.drop_word(word),
            (b'K' | b'L', Some(_)) => match word.number.as_whole() {
                Some(count) if count > 0 => drop(self.edits.insert(word.column, format!("L{count}"))),
                _ => self.drop_word(word),
            },
            (b'P', None) if self.modal.system >= EXTENDED => self.drop_word(word),
            (b'L' | b'P', None) if is_table => {}
            (b'I' | b'J' | b'K', None) if is_arc => self.edit_center(word),
            (b'R', None) if is_arc || is_table => self.spell(word),
            (b'H', _) if state(3) == Some(430) => {}
            (b'H', _) if state(3) == Some(490) || self.modal.length_sign == 0 => self.drop_word(word),
            (b'D', _) if matches!(state(2), Some(410 | 420)) => {}
            (b'D', _) if self.modal.compensation.is_none() => self.drop_word(word),
            (CHAMFER | ROUNDING, _) => return Err((word.column, NO_CORNER)),
            _ => return Err((word.column, UNUSED)),
        }
        Ok(())
    }

    fn feed_counts_otherwise(&self, number: Number) -> bool {
        self.modal.feed_mode == arcfeed_nc::modal::FeedMode::PerRevolution && !number.has_point()
    }

    /// A word of an arc's centre: R counts before it, and LinuxCNC refuses the one across the plane.
    fn edit_center(&mut self, word: &Word) {
        let across = match self.modal.plane {
            Plane::Xy => b'K',
            Plane::Zx => b'J',
            Plane::Yz => b'I',
        };
        if word.letter == across || self.word(b'R').is_some() {
            self.drop_word(word);
        } else {
            self.spell(word);
        }
    }

    /// Writes a number in least increments with its decimal point.
    fn spell(&mut self, word: &Word) {
        if self.decimals == Decimals::Calculator || word.number.has_point() {
            return;
        }
        let is_inch = self.modal.unit == LengthUnit::Inch && !b"ABC".contains(&word.letter);
        let places = if is_inch { 4 } else { 3 };
        let value = word.number.as_whole().unwrap_or_default();
        let (sign, digits) = (if value < 0 { "-" } else { "" }, format!("{:0width$}", value.abs(), width = places + 1));
        let (whole, fraction) = digits.split_at(digits.len() - places);
        let letter = char::from(word.letter);
        self.edits.insert(word.column, format!("{letter}{sign}{whole}.{}", fraction.trim_end_matches('0')));
    }

    /// Writes milliseconds as seconds.
    fn in_seconds(&mut self, word: &Word) -> Result<(), RefusedWord> {
        let ms = word.number.as_whole().filter(|_| !word.number.has_point());
        let ms = ms.ok_or((word.column, "a dwell P is in milliseconds, without a decimal point; write it so"))?;
        self.edits.insert(word.column, format!("P{}", ms as f64 / 1e3));
        Ok(())
    }
}
