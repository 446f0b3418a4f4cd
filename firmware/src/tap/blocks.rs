//! Interpretation of tapped blocks as moves in workpiece coordinates, as far as the axes can be followed on them.
//!
//! A move can be followed if its path is the programmed one: no canned cycle, no return to a reference point, not
//! under G41, G42 or G43.4, and all axes known. Other moves are skipped, up to the next known position: the end of the
//! next plain move, or of a cycle. The offsets of the control are unknown here; positions are relative to the
//! workpiece's origin, where offsets have no effect.

use arcfeed_shared::nc::alarm::{Fault, NotModelled};
use arcfeed_shared::nc::block::Block;
use arcfeed_shared::nc::machining::Machining;
use arcfeed_shared::nc::modal::{Feed, FeedMode, Pose, Stop};
use arcfeed_shared::nc::series::{Drill, Series};
use arcfeed_shared::nc::settings::{Settings, Tables};
use arcfeed_shared::nc::word::{Token, Words};
use arcfeed_shared::reader::{Reader, Understood};
use arcfeed_shared::segment::Segment;

use super::status::Why;

/// System variables that change the behaviour of the control (#3000 to #3999: alarms, clocks, ignored switches).
const BEHAVIOUR: core::ops::RangeInclusive<i64> = 3_000..=3_999;
/// Bits of X, Y and Z.
const LINEAR: u8 = 0b111;
/// Letters of the bits. Rotary axes are not part of the followed coordinates.
const AXES: [u8; 3] = *b"XYZ";
/// Codes that a program must state if it does not start in the power-on state: unit, plane, G90 or G91, feed mode.
const ALL_SAID: u8 = 0b1111;

/// Reads the blocks of a program in order.
#[derive(Debug)]
pub(super) struct Blocks {
    begins_afresh: bool,
    reader: Reader,
    /// Buffer of the current line; reused, as it is large.
    understood: Understood,
    /// Bits of the [`AXES`] with unknown positions.
    unknown: u8,
    /// Whether the axes are not at the end of the last followed block.
    is_apart: bool,
    is_tapping: bool,
    said: u8,
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
    pub fn new(settings: Settings, begins_afresh: bool) -> Self {
        Blocks {
            reader: Reader::with(settings, Tables::default()),
            begins_afresh,
            understood: Understood::default(),
            unknown: LINEAR,
            is_apart: true,
            is_tapping: false,
            said: 0,
            has_moved: false,
        }
    }

    /// Starts a program; `at` is the position of the axes at rest, if known.
    pub fn begin(&mut self, at: Option<Pose>) {
        self.reader.restart();
        (self.is_tapping, self.said, self.has_moved) = (false, 0, false);
        (self.unknown, self.is_apart) = (if at.is_some() { 0 } else { LINEAR }, at.is_none());
        if let Some(at) = at {
            self.reader.stand_at(at);
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
    pub fn read(&mut self, text: &[u8]) -> Result<(BlockMotion, bool), Why> {
        self.reader.read_into(text, &mut self.understood).map_err(Why::NotUnderstood)?;
        let block = &self.understood.parsed.block;
        let is_other_program = block.program.is_some() && self.has_moved;
        if is_other_program || self.understood.lacks_feed() || (block.assigns && changes_behaviour(text)) {
            return Err(Why::OutOfSight);
        }
        self.note_codes();
        let ends = self.understood.step.stop == Some(Stop::End);
        let motion = match self.understood.segment {
            _ if self.understood.step.series.is_some() => self.pass(),
            Some(segment) => self.go(&segment),
            None if self.understood.step.motion.is_some() => return Err(Why::OutOfSight),
            None => BlockMotion::Nothing,
        };
        self.has_moved |= motion != BlockMotion::Nothing;
        Ok((motion, ends))
    }

    /// Records G words that the reader does not store.
    fn note_codes(&mut self) {
        for word in self.understood.parsed.block.words.iter().filter(|word| word.letter == b'G') {
            match word.number.as_whole() {
                Some(63) => self.is_tapping = true,
                Some(61 | 62 | 64) => self.is_tapping = false,
                Some(20 | 21) => self.said |= 1,
                Some(17..=19) => self.said |= 2,
                Some(90 | 91) => self.said |= 4,
                Some(93..=95) => self.said |= 8,
                _ => {}
            }
        }
    }

    fn pass(&mut self) -> BlockMotion {
        let Some(Series::Drill(drill)) = &self.understood.step.series else {
            self.forget_named();
            return BlockMotion::Nothing;
        };
        if self.unknown != 0 {
            return BlockMotion::Nothing;
        }
        let to = self.in_workpiece(self.reader.modal().position);
        let via = Some(at_bottom(drill, to));
        self.is_apart = false;
        BlockMotion::Passes { via, to }
    }

    fn go(&mut self, segment: &Segment) -> BlockMotion {
        let step = &self.understood.step;
        if step.beyond_plain == Some(NotModelled::GCode(530)) {
            self.forget_named();
            return BlockMotion::Nothing;
        }
        self.know_named();
        if !self.understood.step.is_plain() && self.reader.modal().feed_mode != FeedMode::PerRevolution {
            self.is_apart = true;
            return BlockMotion::Nothing;
        }
        if self.unknown != 0 {
            return BlockMotion::Nothing;
        }
        let origin = self.reader.modal().work_origin(self.reader.tables());
        let segment = segment.shifted(Pose::ORIGIN.minus(origin));
        if core::mem::take(&mut self.is_apart) {
            return BlockMotion::Passes { via: None, to: segment.end };
        }
        let per_minute = self.reader.modal().feed_mode != FeedMode::PerRevolution;
        // A feed per revolution depends on the spindle; the override must not change it.
        let feed = if per_minute { segment.feed } else { Feed::Missing };
        let is_said = self.begins_afresh || self.said == ALL_SAID;
        BlockMotion::Along(Segment { feed, ..segment }, per_minute && is_said && !self.is_tapping)
    }

    /// Marks the named axes as unknown: the position is given in machine coordinates, which cannot be converted to
    /// workpiece coordinates.
    fn forget_named(&mut self) {
        self.unknown |= named(&self.understood.parsed.block);
        self.is_apart = true;
    }

    /// Marks axes with an absolute coordinate as known.
    fn know_named(&mut self) {
        let modal = self.reader.modal();
        if modal.absolute && modal.polar.is_none() {
            self.unknown &= !named(&self.understood.parsed.block);
        }
    }

    fn in_workpiece(&self, position: Pose) -> Pose {
        position.minus(self.reader.modal().work_origin(self.reader.tables()))
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
