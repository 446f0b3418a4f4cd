//! Interpretation of tapped blocks as moves in workpiece coordinates, as far as the axes can be followed on them.
//!
//! A move can be followed if its path is the programmed one: no canned cycle, no return to a reference point, not
//! under G41, G42 or G43.4, and all axes known. Other moves are skipped, up to the next known position: the end of the
//! next plain move, or of a cycle. The offsets of the control are unknown here; positions are relative to the
//! workpiece's origin, where offsets have no effect.

use arcfeed_nc::alarm::{Alarm, Fault, NotModelled};
use arcfeed_nc::block::{Block, NoticeKind};
use arcfeed_nc::machining::Machining;
use arcfeed_nc::modal::{Feed, FeedMode, Pose, ProgramStop};
use arcfeed_nc::reader::{InterpretedLine, Reader};
use arcfeed_nc::segment::Segment;
use arcfeed_nc::series::{Drill, Series};
use arcfeed_nc::settings::{Settings, Tables};
use arcfeed_nc::word::{Token, Words};

use super::status::TapLossReason;

/// System variables that change the behaviour of the control (#3000 to #3999: alarms, clocks, ignored switches).
const BEHAVIOUR: core::ops::RangeInclusive<i64> = 3_000..=3_999;
/// Bits of X, Y and Z.
const LINEAR: u8 = 0b111;
/// Letters of the bits. Rotary axes are not part of the followed coordinates.
const AXES: [u8; 3] = *b"XYZ";
/// Codes that a program must state if it does not start in the power-on state: unit, plane, G90 or G91, feed mode.
const ALL_STATED: u8 = 0b1111;

/// Reads the blocks of a program in order.
#[derive(Debug)]
pub(super) struct Blocks {
    resets_codes: bool,
    reader: Reader,
    /// Buffer of the current line; reused, as it is large.
    line: InterpretedLine,
    /// Bits of the [`AXES`] with unknown positions.
    unknown: u8,
    /// Whether the axes are not at the end of the last followed block.
    is_detached: bool,
    is_tapping: bool,
    stated: u8,
    has_moved: bool,
}

/// Motion of a block, for following the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to box into, and there is one at a time")]
pub(super) enum BlockMotion {
    /// No motion, or a motion to an unknown position.
    Nothing,
    /// A move along its path, and whether a law may govern it.
    Along(Segment, bool),
    /// A motion on an unknown path, through one position to another.
    Passes {
        /// Intermediate position.
        via: Option<Pose>,
        /// End position.
        to: Pose,
    },
}

impl Blocks {
    /// Reader of a tapped program at power-on; `resets_codes`: each program begins in the modal state of power-on.
    pub fn new(settings: Settings, resets_codes: bool) -> Self {
        Blocks {
            reader: Reader::with(settings, Tables::default()),
            resets_codes,
            line: InterpretedLine::default(),
            unknown: LINEAR,
            is_detached: true,
            is_tapping: false,
            stated: 0,
            has_moved: false,
        }
    }

    /// Starts a program; `at` is the position of the axes at rest, if known.
    pub fn begin(&mut self, at: Option<Pose>) {
        self.reader.restart();
        (self.is_tapping, self.stated, self.has_moved) = (false, 0, false);
        (self.unknown, self.is_detached) = (if at.is_some() { 0 } else { LINEAR }, at.is_none());
        if let Some(at) = at {
            self.reader.set_position(at);
        }
    }

    /// Tool and spindle commanded so far.
    pub fn machining(&self) -> Machining {
        self.reader.modal().machining()
    }

    /// Reads the next block; returns its motion, and whether the program ends with it.
    ///
    /// # Errors
    /// The behaviour of the control is unknown from here on.
    pub fn read(&mut self, text: &[u8]) -> Result<(BlockMotion, bool), TapLossReason> {
        self.reader.read_into(text, &mut self.line).map_err(TapLossReason::NotUnderstood)?;
        // Controls skip or refuse small letters: what this one has read is not known.
        if let Some(notice) = self.line.parsed.notices.iter().find(|notice| notice.kind == NoticeKind::SmallLetter) {
            return Err(TapLossReason::NotUnderstood(Fault::alarm(Alarm::Character, notice.column)));
        }
        let block = &self.line.parsed.block;
        let is_other_program = block.program.is_some() && self.has_moved;
        if is_other_program || self.line.lacks_feed() || (block.assigns && changes_behaviour(text)) {
            return Err(TapLossReason::OutOfSight);
        }
        self.note_codes();
        let ends = self.line.step.stop == Some(ProgramStop::End);
        let motion = match self.line.segment {
            _ if self.line.step.series.is_some() => self.skip_series(),
            Some(segment) => self.follow_move(&segment),
            None if self.line.step.motion.is_some() => return Err(TapLossReason::OutOfSight),
            None => BlockMotion::Nothing,
        };
        self.has_moved |= motion != BlockMotion::Nothing;
        Ok((motion, ends))
    }

    /// Records G words that the reader does not store.
    fn note_codes(&mut self) {
        for word in self.line.parsed.block.words.iter().filter(|word| word.letter == b'G') {
            match word.number.as_whole() {
                Some(63) => self.is_tapping = true,
                Some(61 | 62 | 64) => self.is_tapping = false,
                Some(20 | 21) => self.stated |= 1,
                Some(17..=19) => self.stated |= 2,
                Some(90 | 91) => self.stated |= 4,
                Some(93..=95) => self.stated |= 8,
                _ => {}
            }
        }
    }

    fn skip_series(&mut self) -> BlockMotion {
        let Some(Series::Drill(drill)) = &self.line.step.series else {
            self.mark_named_unknown();
            return BlockMotion::Nothing;
        };
        if self.unknown != 0 {
            return BlockMotion::Nothing;
        }
        let to = self.in_workpiece(self.reader.modal().position);
        let via = Some(at_bottom(drill, to));
        self.is_detached = false;
        BlockMotion::Passes { via, to }
    }

    fn follow_move(&mut self, segment: &Segment) -> BlockMotion {
        let (beyond_plain, is_plain) = (self.line.step.beyond_plain, self.line.step.is_plain());
        if beyond_plain == Some(NotModelled::GCode(530)) {
            self.mark_named_unknown();
            return BlockMotion::Nothing;
        }
        self.mark_named_known();
        // The move behind G40 leads from the offset path to its programmed end.
        let is_cancel = beyond_plain == Some(NotModelled::MoveUnder(400));
        self.is_detached |= is_cancel;
        if !is_plain && !is_cancel && self.reader.modal().feed_mode != FeedMode::PerRevolution {
            self.is_detached = true;
            return BlockMotion::Nothing;
        }
        if self.unknown != 0 {
            return BlockMotion::Nothing;
        }
        let origin = self.reader.modal().work_origin();
        let segment = segment.shifted(Pose::ORIGIN.minus(origin));
        if core::mem::take(&mut self.is_detached) {
            return BlockMotion::Passes { via: None, to: segment.end };
        }
        let per_minute = self.reader.modal().feed_mode != FeedMode::PerRevolution;
        // A feed per revolution depends on the spindle; the override must not change it.
        let feed = if per_minute { segment.feed } else { Feed::Missing };
        let is_stated = self.resets_codes || self.stated == ALL_STATED;
        BlockMotion::Along(Segment { feed, ..segment }, per_minute && is_stated && !self.is_tapping)
    }

    /// Marks the named axes as unknown: the position is given in machine coordinates, which cannot be converted to
    /// workpiece coordinates.
    fn mark_named_unknown(&mut self) {
        self.unknown |= named(&self.line.parsed.block);
        self.is_detached = true;
    }

    /// Marks axes with an absolute coordinate as known.
    fn mark_named_known(&mut self) {
        let modal = self.reader.modal();
        if modal.absolute && modal.polar.is_none() {
            self.unknown &= !named(&self.line.parsed.block);
        }
    }

    fn in_workpiece(&self, position: Pose) -> Pose {
        position.minus(self.reader.modal().work_origin())
    }
}

/// Axes that a block names.
fn named(block: &Block) -> u8 {
    let bits = AXES.iter().enumerate().filter(|(_, letter)| block.word(**letter).is_some());
    bits.fold(0, |named, (bit, _)| named | 1 << bit)
}

/// Bottom of a cycle's last hole; the cycle ends at `end`.
fn at_bottom(drill: &Drill, end: Pose) -> Pose {
    let (.., normal) = drill.plane.axes();
    let level = |pose: &Pose| pose.linear.get(normal).map_or(0, |axis| axis.0);
    let down = drill.levels.bottom.0.saturating_sub(level(&drill.end()));
    let mut bottom = end;
    if let Some(axis) = bottom.linear.get_mut(normal) {
        axis.0 = axis.0.saturating_add(down);
    }
    bottom
}

fn changes_behaviour(text: &[u8]) -> bool {
    Words::new(text).any(|piece| match piece.map(|piece| piece.token) {
        Ok(Token::Assignment { variable, .. }) => BEHAVIOUR.contains(&variable),
        Ok(_) => false,
        Err(Fault { .. }) => true,
    })
}

#[cfg(test)]
mod tests;
