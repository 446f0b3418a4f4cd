//! The program as a control reads it whose block-delete switches stand the other way, beside the one that the settings describe.
//!
//! Both readings are followed from a block with a `/` until they agree again: between these, a block's move, its tool, its
//! spindle speed, its unit or the F in force may depend on a switch that no program shows. Where two switches act on one such
//! stretch, two readings do not show all that can come of it: nothing behind it counts as the same again.

use arcfeed_shared::reader::{Reader, Understood};

use super::ProgramLine;

/// A line that a block-delete switch may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Skipping {
    /// Whether the switch only decides on functions such as M8: no move, no F, and the control stands alike behind the line.
    pub is_harmless: bool,
}

/// The second reading; none while both agree.
#[derive(Debug, Default)]
pub(super) struct SkippingReader {
    reader: Option<Reader>,
    /// The switch on which the readings part.
    switch: Option<u8>,
    /// Another switch has followed before they agreed.
    is_mixed: bool,
}

impl SkippingReader {
    /// Begins where a line may have a `/`, and ends where both readings agree; `before` is the control before that line.
    pub fn fork(&mut self, text: &[u8], before: &Reader) {
        if !self.is_mixed && self.reader.as_ref().is_some_and(|reader| reader.stands_like(before)) {
            self.reader = None;
        }
        if self.reader.is_none() && text.contains(&b'/') {
            let mut reader = before.clone();
            reader.flip_delete_switches();
            (self.reader, self.switch) = (Some(reader), None);
        }
    }

    /// Reads the same line; `of` is the first reading of it, and `after` the control behind that.
    pub fn read(&mut self, text: &[u8], of: &ProgramLine, after: &Reader) -> Option<Skipping> {
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
        let is_harmless = understood.is_some() && reader.stands_like(after) && !readings().any(moves_or_feeds);
        Some(Skipping { is_harmless: is_harmless && !self.is_mixed })
    }
}

/// Whether a line moves an axis or has an F.
fn moves_or_feeds(reading: &Understood) -> bool {
    let step = &reading.step;
    step.motion.is_some() || step.series.is_some() || reading.parsed.block.word(b'F').is_some()
}
