//! Rigid tapping: the holes of G74 and G84 under M29 by LinuxCNC's G33.1, which moves with the spindle and back.

use arcfeed_nc::modal::{Cycle, FeedMode, Plane};
use arcfeed_nc::series::{Drill, Series};

use super::motion::{hole_point, length, number};
use super::{BlockEditor, LinuxCncState, RefusedWord};
use crate::linuxcnc::codes::{CodeGroup, TAPPING};

/// Tapping with a left-hand thread.
const LEFT_HAND: u8 = 74;
/// Motion of LinuxCNC: G33.1.
const WITH_SPINDLE: i64 = 331;

impl BlockEditor<'_> {
    /// Cycle in force, if it taps.
    pub(super) fn tapping_cycle(&self) -> Option<Cycle> {
        self.modal.cycle.filter(|cycle| matches!(cycle.code, 74 | 84))
    }

    /// Writes the hole of a block under a tapping cycle in blocks behind the block, which keeps its other words. Returns whether
    /// such a cycle is in force.
    pub(super) fn edit_tapping(&mut self, theirs: &mut LinuxCncState) -> Result<bool, RefusedWord> {
        let Some(cycle) = self.tapping_cycle() else {
            self.end_tapping(theirs);
            return Ok(false);
        };
        let word = self.code(CodeGroup::Tapping).map(|(word, _)| word).or(self.words().first().copied());
        let column = word.map_or(1, |word| word.column);
        if !theirs.taps_rigidly {
            return Err((column, TAPPING));
        }
        if !self.modal.absolute || self.modal.plane != Plane::Xy {
            return Err((column, "taps are written for LinuxCNC under G90 and in G17 only; write the holes so"));
        }
        let words: Vec<_> = self.words().iter().filter(|word| b"XYZRPQKL".contains(&word.letter)).copied().collect();
        words
            .iter()
            .chain(self.code(CodeGroup::Tapping).map(|(word, _)| word).iter())
            .for_each(|word| self.drop_word(word));
        let Some(Series::Drill(drill)) = self.line.step.series else { return Ok(true) };
        if drill.holes > 1 {
            return Err((column, "write each tapped hole in a block of its own"));
        }
        let pitch =
            self.pitch().ok_or((column, "LinuxCNC taps with the pitch, F over S; write both before the cycle"))?;
        if !theirs.is_tapping {
            theirs.is_tapping = true;
            self.behind.push(if cycle.code == LEFT_HAND { "M4".into() } else { "M3".into() });
        }
        self.write_hole(&drill, pitch);
        theirs.motion = Some(if drill.returns_to_r { WITH_SPINDLE } else { 0 });
        Ok(true)
    }

    /// Stops the spindle behind the last hole, as a Fanuc does.
    fn end_tapping(&mut self, theirs: &mut LinuxCncState) {
        let is_over = theirs.is_tapping && self.words().iter().any(|word| word.letter == b'G');
        if !is_over {
            return;
        }
        theirs.is_tapping = false;
        theirs.taps_rigidly = false;
        let has_spindle = |number: Option<i64>| matches!(number, Some(3..=6 | 19));
        if !self.words().iter().any(|word| word.letter == b'M' && has_spindle(word.number.as_whole())) {
            self.insert = "M5 ".into();
        }
    }

    /// Pitch in the program's unit.
    fn pitch(&self) -> Option<f64> {
        let feed = self.modal.feed?.0 as f64 / self.modal.unit.nm() as f64;
        let spindle = self.modal.spindle.filter(|speed| *speed > 0)? as f64;
        match self.modal.feed_mode {
            FeedMode::PerMinute => Some(feed / spindle),
            FeedMode::PerRevolution => Some(feed),
            FeedMode::InverseTime => None,
        }
    }

    fn write_hole(&mut self, drill: &Drill, pitch: f64) {
        let unit = self.modal.unit;
        let [x, y, _] = hole_point(drill, 0).linear.map(|value| length(value, unit));
        let [initial, r, bottom] =
            [drill.levels.initial, drill.levels.r, drill.levels.bottom].map(|value| length(value, unit));
        self.behind.push(format!("G0 X{x} Y{y}"));
        self.behind.push(format!("G0 Z{r}"));
        self.behind.push(format!("G33.1 Z{bottom} K{}", number(pitch)));
        if !drill.returns_to_r {
            self.behind.push(format!("G0 Z{initial}"));
        }
    }
}
