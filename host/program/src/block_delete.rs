//! Second reading of a program, with the opposite setting of the block-delete switches.
//!
//! Both readings are followed from a block with a `/` until they agree again. Between these, a block's move, its tool,
//! its spindle speed, its unit or the F in force may depend on a switch that the program does not show. If two switches
//! act within one such section, two readings do not cover all cases: no later block counts as equal again.

use arcfeed_nc::reader::{InterpretedLine, Reader};
use memchr::memchr;

use super::ProgramLine;

/// Effect that the opposite setting of the block-delete switches has on a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockDeleteEffect {
    /// The switches affect only functions such as M8 here: no move and no F, and after the line the control is in the
    /// same state.
    pub is_harmless: bool,
}

/// Second reading; `None` while both agree.
#[derive(Debug, Default)]
pub(super) struct BlockDeleteReader {
    reader: Option<Reader>,
    /// Switch at which the readings diverge.
    switch: Option<u8>,
    /// Another switch has followed before the readings agreed.
    is_mixed: bool,
}

impl BlockDeleteReader {
    /// Starts the second reading at a line that may have a `/`, and ends it as soon as both readings agree; `before`
    /// is the control before that line.
    pub fn fork(&mut self, text: &[u8], before: &Reader) {
        if !self.is_mixed && self.reader.as_ref().is_some_and(|reader| reader.has_same_state(before)) {
            self.reader = None;
        }
        if self.reader.is_none() && memchr(b'/', text).is_some() {
            let mut reader = before.clone();
            reader.flip_delete_switches();
            (self.reader, self.switch) = (Some(reader), None);
        }
    }

    /// Reads a line with the opposite setting of the switches. `of` is the first reading of the line, `after` the
    /// control after it. Returns the effect of the switches; `None` if there is none.
    pub fn read(&mut self, text: &[u8], of: &ProgramLine, after: &Reader) -> Option<BlockDeleteEffect> {
        let reader = self.reader.as_mut()?;
        let understood = reader.read(text).ok();
        let readings = || of.meaning.iter().chain(&understood);
        if let Some(switch) = readings().find_map(|reading| reading.parsed.block.delete) {
            let slashes = text.iter().filter(|byte| **byte == b'/').count();
            self.is_mixed |= slashes > 1 || self.switch.is_some_and(|other| other != switch);
            self.switch = Some(switch);
        }
        if self.switch.is_none() {
            // A `/` in a comment, or a division.
            self.reader = None;
            return None;
        }
        let is_harmless = understood.is_some() && reader.has_same_state(after) && !readings().any(moves_or_feeds);
        Some(BlockDeleteEffect { is_harmless: is_harmless && !self.is_mixed })
    }
}

/// The line moves an axis or has an F.
fn moves_or_feeds(reading: &InterpretedLine) -> bool {
    let step = &reading.step;
    step.motion.is_some() || step.series.is_some() || reading.parsed.block.word(b'F').is_some()
}
