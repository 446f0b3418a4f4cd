//! Motion and canned cycle of a block: written where LinuxCNC has another one in force.

use arcfeed_nc::modal::{Cycle, MotionKind, Plane, Pose, Turn};
use arcfeed_nc::series::{Drill, Series};
use arcfeed_nc::word::Word;
use arcfeed_units::{LengthUnit, Nm};

use super::{BlockEditor, LinuxCncState, RefusedWord};
use crate::linuxcnc::codes::CodeGroup;

/// Decimals of a length that is written anew; in inches all that a Fanuc's least increment has.
const DECIMALS: usize = 6;
/// Most holes of a block that are listed.
const HOLES_MAX: u32 = 1_000;
const INHERITED: &str = "LinuxCNC keeps no R, Z and Q from one cycle to the next; write them here, under G90";

impl BlockEditor<'_> {
    /// Writes the motion of a block that inherits it, where LinuxCNC has another one in force.
    pub(super) fn set_motion(&mut self, theirs: &mut LinuxCncState) -> Result<(), RefusedWord> {
        if self.is_stored() {
            // The next block with a hole calls the cycle.
            theirs.motion = None;
            return Ok(());
        }
        let is_one_shot = self.code(CodeGroup::OneShot).is_some();
        let moves = !is_one_shot && self.words().iter().any(|word| b"XYZABCIJK".contains(&word.letter));
        if let Some((end, _)) = self.code(CodeGroup::CycleEnd) {
            if moves || self.code(CodeGroup::Motion).is_some() {
                self.drop_word(&end);
            } else {
                theirs.motion = None;
            }
        }
        let explicit = self.code(CodeGroup::Motion).filter(|_| !is_one_shot).or(self.code(CodeGroup::Cycle));
        if let Some((_, code)) = explicit {
            theirs.motion = Some(code / 10);
        }
        if let Some((machine, _)) = self.code(CodeGroup::Machine) {
            if !self.modal.absolute {
                return Err((machine.column, "LinuxCNC has no G53 under G91; write G90 before it"));
            }
            if explicit.is_some() && theirs.motion != Some(0) {
                return Err((machine.column, "a Fanuc moves in rapid under G53, LinuxCNC at F; write G0"));
            }
            if theirs.motion != Some(0) {
                self.insert += "G0 ";
                theirs.motion = Some(0);
            }
            return Ok(());
        }
        let wanted = self.wanted_motion();
        if moves && theirs.motion != Some(wanted) {
            let column = self.words().first().map_or(1, |word| word.column);
            let words = self.modal.cycle.map_or(Ok(String::new()), |cycle| self.inherited_words(&cycle, column))?;
            self.insert += &format!("G{wanted} {words}");
            theirs.motion = Some(wanted);
        }
        Ok(())
    }

    /// Writes three kinds of holes in blocks of their own. One to which rotary axes turn: behind a rapid in all axes, as a Fanuc does
    /// it in one block. Those under G91 that inherit R or Z: under G90, as LinuxCNC counts inherited words from where the tool is.
    /// Those under G91, and repeated ones, under G16 or G68: at their points along LinuxCNC's axes.
    /// Returns whether the block is written so.
    ///
    /// # Errors
    /// Such holes to which rotary axes turn, and more than a thousand of them.
    pub(super) fn edit_hole(&mut self, theirs: &mut LinuxCncState) -> Result<bool, RefusedWord> {
        let (Some(cycle), Some(Series::Drill(drill))) = (self.modal.cycle, self.line.step.series) else {
            return Ok(false);
        };
        let is_single = self.modal.absolute && drill.holes == 1;
        if drill.plane != Plane::Xy || self.tapping_cycle().is_some() || theirs.is_transformed && is_single {
            return Ok(false);
        }
        let turns = self.words().iter().any(|word| b"ABC".contains(&word.letter));
        let is_turned = turns && is_single && !drill.returns_to_r;
        let inherits = !self.modal.absolute && [b'R', b'Z'].iter().any(|letter| self.word(*letter).is_none());
        let is_listed = inherits || theirs.is_transformed;
        if is_listed && (turns || drill.holes > HOLES_MAX) {
            return Err((self.words().first().map_or(1, |word| word.column), INHERITED));
        }
        if !is_turned && !is_listed {
            return Ok(false);
        }
        self.turns = turns;
        let removed: &[u8] = if is_listed { b"XYZRPQKL" } else { b"ZRPQKL" };
        let hole: Vec<Word> = self.words().iter().filter(|word| removed.contains(&word.letter)).copied().collect();
        hole.iter()
            .chain(self.code(CodeGroup::Cycle).map(|(word, _)| word).iter())
            .for_each(|word| self.drop_word(word));
        self.insert += if turns { "G0 " } else { "" };
        for hole in 0..drill.holes {
            self.behind.push(self.hole_text(&cycle, &drill, hole));
        }
        self.behind.extend((!self.modal.absolute).then(|| "G91".to_owned()));
        theirs.motion = Some(i64::from(cycle.code));
        Ok(true)
    }

    /// Block with a whole hole, under G90.
    fn hole_text(&self, cycle: &Cycle, drill: &Drill, hole: u32) -> String {
        let unit = self.modal.unit;
        let [x, y, _] = hole_point(drill, hole).linear.map(|value| length(value, unit));
        let [bottom, r] = [drill.levels.bottom, drill.levels.r].map(|value| length(value, unit));
        let mut text = format!("G90 G{} X{x} Y{y} Z{bottom} R{r}", cycle.code);
        if matches!(cycle.code, 73 | 83) {
            text += &format!(" Q{}", length(cycle.q, unit));
        }
        if matches!(cycle.code, 82 | 86 | 89) {
            text += &format!(" P{}", cycle.dwell.to_s());
        }
        text
    }

    /// Motion or cycle in force on the Fanuc.
    fn wanted_motion(&self) -> i64 {
        match (self.modal.cycle, self.modal.motion) {
            (Some(cycle), _) => i64::from(cycle.code),
            (None, MotionKind::Rapid) => 0,
            (None, MotionKind::Line) => 1,
            (None, MotionKind::Arc(Turn::Cw)) => 2,
            (None, MotionKind::Arc(Turn::Ccw)) => 3,
        }
    }

    /// Whether the block stores a cycle without a hole (K0).
    pub(super) fn is_stored(&self) -> bool {
        let count = self.word(b'K').or(self.word(b'L')).and_then(|word| word.number.as_whole());
        self.modal.cycle.is_some() && count == Some(0)
    }

    /// Writes the words of a cycle that the block inherits; LinuxCNC keeps none from one cycle to the next.
    pub(super) fn edit_cycle(&mut self) -> Result<(), RefusedWord> {
        let Some(((word, code), cycle)) = self.code(CodeGroup::Cycle).zip(self.modal.cycle) else { return Ok(()) };
        if self.is_stored() {
            self.drop_word(&word);
            return Ok(());
        }
        let words = self.inherited_words(&cycle, word.column)?;
        if !words.is_empty() {
            self.edits.insert(word.column, format!("G{} {}", code / 10, words.trim_end()));
        }
        Ok(())
    }

    /// Words of a cycle in force that are not in the block, each with a blank behind it.
    fn inherited_words(&self, cycle: &Cycle, column: u16) -> Result<String, RefusedWord> {
        let Cycle { code, r, bottom, q, dwell, .. } = *cycle;
        let lengths = [(b'Z', bottom, true), (b'R', r, true), (b'Q', Some(q), matches!(code, 73 | 83))];
        let mut words = String::new();
        for (letter, value, _) in
            lengths.into_iter().filter(|(letter, _, is_used)| *is_used && self.word(*letter).is_none())
        {
            let value = value.filter(|_| self.modal.absolute);
            let value = value.ok_or((column, INHERITED))?;
            words += &format!("{}{} ", char::from(letter), length(value, self.modal.unit));
        }
        if matches!(code, 82 | 86 | 89) && self.word(b'P').is_none() {
            words += &format!("P{} ", dwell.to_s());
        }
        Ok(words)
    }
}

/// Point of a hole, counted from 0, along LinuxCNC's axes: the path without the shift of `shared/nc/src/frame.rs`.
pub(super) fn hole_point(drill: &Drill, hole: u32) -> Pose {
    let up_to = Drill { holes: hole + 1, ..*drill };
    drill.frame.to_path(up_to.end()).minus(drill.frame.shift())
}

/// Length in the program's unit.
pub(super) fn length(value: Nm, unit: LengthUnit) -> String {
    number(value.0 as f64 / unit.nm() as f64)
}

/// Number with a decimal point, without zeros at its end.
pub(super) fn number(value: f64) -> String {
    format!("{value:.DECIMALS$}").trim_end_matches('0').to_owned()
}
