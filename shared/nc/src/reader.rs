//! Reader of a program: interprets each line and carries the modal state from line to line.

use crate::alarm::{Alarm, Cause, Fault, NotModelled};
use crate::block::{Block, LineKind, Parsed, Reading};
use crate::interpret::set_data;
use crate::modal::{Modal, MotionKind, Pose, Step};
use crate::rollback::Rollback;
use crate::segment::{Path, Segment};
use crate::settings::{Preset, Scope, Settings, Tables};
use arcfeed_units::LengthUnit;

/// Reads a program line by line; holds the control's modal state and offsets after the lines read so far.
#[derive(Clone, Debug, PartialEq)]
pub struct Reader {
    modal: Modal,
    settings: Settings,
    tables: Tables,
    /// Axes whose position is unknown because a block that would have moved them was rejected.
    lost: [bool; 3],
    /// X and Y while the program has not stated them yet, so that the start of its first move is unknown.
    unstated: [bool; 2],
}

/// One line of a program, its words, and what they make the control do.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InterpretedLine {
    /// Words of the line, and deviations that lenient reading has accepted.
    pub parsed: Parsed,
    /// Effect of the line on the control; empty for marks, titles, and blocks that a block-delete switch skips.
    pub step: Step,
    /// The single move of the line, with its geometry checked; `None` if it has none, or several (they are in the
    /// step's series).
    pub segment: Option<Segment>,
    /// Whether the line has a cutting move whose start no line so far has stated. If that move is an arc, `segment` is
    /// `None`.
    pub starts_unknown: bool,
}

impl Reader {
    /// Reader in the state after power-on, with the standard settings of a Series 16i control; it rejects everything
    /// beyond plain moves (see [`Scope`]).
    pub fn new(unit: LengthUnit, reading: Reading) -> Self {
        Reader::with(Settings::preset(Preset::Fanuc16i, unit, reading), Tables::default())
    }

    /// Reader in the state after power-on, with these settings and offsets.
    pub fn with(settings: Settings, tables: Tables) -> Self {
        let mut modal = Modal { arc_centers: settings.arc_centers, ..Modal::at_power_on(settings.unit) };
        modal.update_frame(&tables);
        Reader { modal, settings, tables, lost: [false; 3], unstated: [false; 2] }
    }

    /// The same reader at an unknown position: X and Y of the tool are unknown until a block gives them.
    #[must_use]
    pub fn at_unknown_position(self) -> Self {
        Reader { unstated: [true; 2], ..self }
    }

    /// Whether another reader has the same modal state, offsets and knowledge of the position; settings are not
    /// compared.
    pub fn has_same_state(&self, other: &Reader) -> bool {
        let state = |reader: &Reader| (reader.lost, reader.unstated);
        self.modal == other.modal && self.tables == other.tables && state(self) == state(other)
    }

    /// Settings of the control.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Modal state after the lines read so far.
    pub fn modal(&self) -> &Modal {
        &self.modal
    }

    /// Offsets after the lines read so far.
    pub fn tables(&self) -> &Tables {
        &self.tables
    }

    /// Sets the block-delete switches: bit n is 1 if that of `/n` is on.
    pub fn set_delete_switches(&mut self, switches: u16) {
        self.settings.delete_switches = switches;
    }

    /// Turns each block-delete switch that is off on, and each that is on off.
    pub fn flip_delete_switches(&mut self) {
        self.settings.delete_switches = !self.settings.delete_switches;
    }

    /// Replaces the offsets, as a macro statement does; the position of the tool on the path stays.
    pub fn set_tables(&mut self, tables: &Tables) {
        self.tables = *tables;
        self.modal.update_frame(&self.tables);
    }

    /// Position of the axes in machine coordinates.
    pub fn machine(&self) -> Pose {
        self.modal.machine(&self.tables)
    }

    /// Whether X and Y of the tool are known: the lines so far have stated them, and no line that could not be read
    /// may have moved it since.
    pub fn is_position_known(&self) -> bool {
        self.unstated == [false; 2] && self.lost == [false; 3]
    }

    /// Resets the modal state to that of power-on; offsets and axis positions stay.
    pub fn restart(&mut self) {
        let position = self.modal.position;
        self.modal = Modal { arc_centers: self.settings.arc_centers, ..Modal::at_power_on(self.settings.unit) };
        self.modal.update_frame(&self.tables);
        self.set_position(position);
    }

    /// Sets the position of the tool in path coordinates and makes it known, whatever the lines so far have commanded.
    pub fn set_position(&mut self, pose: Pose) {
        self.modal.set_position(pose);
        (self.lost, self.unstated) = ([false; 3], [false; 2]);
    }

    /// Interprets the next line, whose text must not contain its line end.
    ///
    /// # Errors
    /// The first fault of the line. A fault does not affect later blocks: after an arc with bad geometry the state is
    /// at its programmed end. After a block that could not be read, arcs are not checked until X and Y (and Z, if that
    /// block named it) are given again.
    pub fn read(&mut self, text: &[u8]) -> Result<InterpretedLine, Fault> {
        let mut line = InterpretedLine::default();
        self.read_into(text, &mut line)?;
        Ok(line)
    }

    /// [`Reader::read`] into an existing line. After a fault its contents are meaningless.
    ///
    /// # Errors
    /// As [`Reader::read`].
    pub fn read_into(&mut self, text: &[u8], line: &mut InterpretedLine) -> Result<(), Fault> {
        let result = self.interpret(text, line);
        // The block behind a corner is rejected once.
        self.modal.ends_in_corner &= result.is_ok();
        if let Err(Fault { cause, .. }) = result
            && !is_geometry(cause)
        {
            self.mark_unknown(text);
        }
        result
    }

    fn interpret(&mut self, text: &[u8], line: &mut InterpretedLine) -> Result<(), Fault> {
        let InterpretedLine { parsed, step, segment, starts_unknown } = line;
        *starts_unknown = false;
        parsed.read(text, self.settings.reading)?;
        let block = &mut parsed.block;
        if parsed.line != LineKind::Block {
            step.clear();
            *segment = None;
            return Ok(());
        }
        if let Some(switch) = block.delete
            && self.settings.deletes(switch)
        {
            block.words.truncate(block.delete_from);
            block.assigns = false;
        }
        if let Some(notice) = block.check_numbers(text, &self.settings)? {
            let _full = parsed.notices.push(notice);
        }
        let is_from_anywhere = self.unstated.contains(&true) && self.modal.polar.is_none();
        let executed = self.execute_into(&parsed.block, step, segment);
        if is_from_anywhere {
            *starts_unknown = self.handle_unknown_start(&parsed.block, step, segment);
            return executed
                .or_else(|fault| if *starts_unknown && is_geometry(fault.cause) { Ok(()) } else { Err(fault) });
        }
        executed
    }

    /// Handles a block before X and Y are both stated. Returns whether its move cuts from an unknown position; such an
    /// arc has no segment.
    fn handle_unknown_start(&mut self, block: &Block, step: &Step, segment: &mut Option<Segment>) -> bool {
        let is_cut = step.motion.is_some_and(|motion| motion.kind != MotionKind::Rapid);
        let is_arc = step.motion.is_some_and(|motion| matches!(motion.kind, MotionKind::Arc(_)));
        let is_unknown = self.modal.absolute && is_cut;
        if is_unknown && is_arc {
            *segment = None;
        }
        if self.modal.absolute && step.dwell.is_none() {
            for (unstated, axis) in self.unstated.iter_mut().zip(*b"XY") {
                *unstated &= block.word(axis).is_none();
            }
        }
        is_unknown
    }

    /// Executes a block and advances the state.
    ///
    /// # Errors
    /// As [`Reader::read`].
    pub fn execute(&mut self, block: &Block) -> Result<(Step, Option<Segment>), Fault> {
        let (mut step, mut segment) = (Step::default(), None);
        self.execute_into(block, &mut step, &mut segment)?;
        Ok((step, segment))
    }

    fn execute_into(&mut self, block: &Block, step: &mut Step, segment: &mut Option<Segment>) -> Result<(), Fault> {
        let mut rollback = Rollback::new(&self.modal, block);
        if let Err(fault) = self.modal.advance(block, (&self.settings, &self.tables), step, &mut rollback) {
            rollback.restore(&mut self.modal);
            return Err(fault);
        }
        if let (Some(what), Scope::PlainMoves) = (step.beyond_plain, self.settings.scope) {
            rollback.restore(&mut self.modal);
            return Err(Fault::not_modelled(what, 0));
        }
        if step.sets_data {
            set_data(&self.modal, block, &self.settings, &mut self.tables)?;
            self.modal.update_frame(&self.tables);
        }
        let is_unknown_axis = self.lost.contains(&true);
        *segment = None;
        if let Some(motion) = &step.motion {
            match Path::of(motion) {
                Ok(path) if !is_unknown_axis => *segment = Some(Segment::along(path, motion, block.sequence)),
                Err(fault) if !(is_unknown_axis && is_geometry(fault.cause)) => return Err(fault),
                Ok(_) | Err(_) => {}
            }
        }
        if is_unknown_axis && self.modal.absolute && step.dwell.is_none() {
            for (lost, axis) in self.lost.iter_mut().zip(b'X'..=b'Z') {
                *lost &= block.word(axis).is_none();
            }
        }
        Ok(())
    }

    /// Marks the axes as unknown that a block which could not be read may have moved: X and Y if it names any axis, Z
    /// if it names Z.
    fn mark_unknown(&mut self, text: &[u8]) {
        let code = text.split(|&byte| byte == b'(').next().unwrap_or_default();
        let has = |axis: u8| code.contains(&axis) || code.contains(&axis.to_ascii_lowercase());
        let [x, y, z] = self.lost;
        let moves = has(b'X') || has(b'Y') || has(b'Z');
        self.lost = [x || moves, y || moves, z || has(b'Z')];
    }
}

/// Whether a fault concerns the geometry of a move, not the text of the block.
fn is_geometry(cause: Cause) -> bool {
    matches!(
        cause,
        Cause::Alarm(Alarm::RadiusTolerance | Alarm::NoRadius)
            | Cause::NotModelled(NotModelled::RotaryArc | NotModelled::ArcWithoutAngle)
    )
}

impl InterpretedLine {
    /// Whether this is a cutting move for which the program has given no feed (PS0011).
    pub fn lacks_feed(&self) -> bool {
        self.step.lacks_feed()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_units::Nm;

    #[test]
    fn one_bad_arc_is_one_fault() {
        let mut reader = Reader::new(LengthUnit::Mm, Reading::Lenient);
        for line in ["G0X10.", "G1F100.X10."] {
            assert!(reader.read(line.as_bytes()).is_ok());
        }
        let bad = reader.read(b"G3X0.Y11.I-10.");
        assert_eq!(bad, Err(Fault::alarm(Alarm::RadiusTolerance, 0)));
        let next = reader.read(b"G1Y0.").unwrap().segment.unwrap();
        assert!((next.length_mm() - 11.0).abs() < 1e-12);
    }

    #[test]
    fn the_move_that_cancels_an_offset_is_not_plain() {
        let settings = Settings::preset(Preset::Fanuc16i, LengthUnit::Mm, Reading::Lenient);
        let mut reader = Reader::with(Settings { scope: Scope::Everything, ..settings }, Tables::default());
        let mut is_plain = |line: &str| reader.read(line.as_bytes()).unwrap().step.is_plain();
        assert!(is_plain("G40G1X0Y0F100."));
        assert_eq!(["G41D1X10.", "Y10.", "G40X20.", "X30."].map(&mut is_plain), [false, false, false, true]);
    }

    #[test]
    fn an_arc_behind_a_refused_block_is_not_judged() {
        let mut reader = Reader::new(LengthUnit::Mm, Reading::Lenient);
        assert!(reader.read(b"G1X10.Y0F100.").is_ok());
        assert!(reader.read(b"X2O.Y5.").is_err());
        assert_eq!(reader.read(b"G3X0Y10.I-10.").unwrap().segment, None);
        assert!(reader.read(b"G3X-10.Y0J-10.").unwrap().segment.is_some());
        assert!(reader.read(b"G3X0Y11.I10.").is_err());
    }

    #[test]
    fn in_every_plane_an_arc_waits_for_the_axes_that_were_lost() {
        let mut reader = Reader::new(LengthUnit::Mm, Reading::Lenient);
        assert!(reader.read(b"G18G1X0Y0Z10.F100.").is_ok());
        assert!(reader.read(b"X5.Z2O.").is_err());
        assert_eq!(reader.read(b"X0Y0").unwrap().segment, None);
        assert_eq!(reader.read(b"G3X10.Z0K-10.").unwrap().segment, None);
        let helix = reader.read(b"G3X0Z-10.Y3.I-10.").unwrap().segment.unwrap();
        assert_eq!(helix.rise(), Nm(3_000_000));
    }

    #[test]
    fn only_cutting_moves_need_a_feed() {
        let mut reader = Reader::new(LengthUnit::Mm, Reading::Lenient);
        assert!(!reader.read(b"G0X1.").unwrap().lacks_feed());
        assert!(reader.read(b"G1X2.").unwrap().lacks_feed());
        assert!(!reader.read(b"X3.F100").unwrap().lacks_feed());
    }
}
