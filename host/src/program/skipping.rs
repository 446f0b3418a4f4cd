//! The program as a control reads it whose block-delete switches are all on, beside the one whose switches are off.
//!
//! Both readings are followed from the first `/` until they agree again: where they differ, a block's move, its tool, its
//! spindle speed or the F in force depends on a switch that no program shows.

use arcfeed_shared::nc::modal::{Feed, Pose};
use arcfeed_shared::reader::{Reader, Understood};

use super::ProgramLine;

/// A line as a control reads it whose block-delete switches are on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Skipping {
    /// Whether any of its words are left.
    pub is_read: bool,
    /// Whether an F word is.
    pub has_feed: bool,
    /// The feed of its cutting move, if it makes one.
    pub cutting_feed: Option<Feed>,
    /// Whether move, tool and spindle are those of the other state of the switches.
    pub is_same: bool,
}

/// The second reading; none while both agree.
#[derive(Debug, Default)]
pub(super) struct SkippingReader {
    reader: Option<Reader>,
}

impl SkippingReader {
    /// Begins where a line may have a `/`; `before` is the control before that line.
    pub fn fork(&mut self, text: &[u8], before: &Reader) {
        if self.reader.is_none() && text.contains(&b'/') {
            let mut reader = before.clone();
            reader.set_delete_switches(u16::MAX);
            self.reader = Some(reader);
        }
    }

    /// Reads the same line; `of` is the first reading of it, and `after` the control behind that.
    pub fn read(&mut self, text: &[u8], of: &ProgramLine, after: &Reader) -> Option<Skipping> {
        let reader = self.reader.as_mut()?;
        let understood = reader.read(text).ok();
        let skipping = Skipping::new(understood.as_ref(), of, reader);
        let agrees = skipping.is_same && reader.stands_like(after);
        if agrees {
            self.reader = None;
        }
        Some(skipping)
    }
}

impl Skipping {
    fn new(understood: Option<&Understood>, of: &ProgramLine, reader: &Reader) -> Self {
        // Where a control stops in this state, the other one decides.
        let understood = understood.or(of.meaning.as_ref());
        let block = understood.map(|understood| &understood.parsed.block);
        let origin = reader.modal().work_origin(reader.tables());
        let segment = understood.and_then(|understood| understood.segment);
        let segment = segment.map(|segment| segment.shifted(Pose::ORIGIN.minus(origin)));
        let is_same = segment == of.segment()
            && reader.modal().machining() == of.machining
            && block.is_none_or(|block| block.delete.is_none());
        Skipping {
            is_read: block.is_some_and(|block| !block.is_empty()),
            has_feed: block.is_some_and(|block| block.word(b'F').is_some()),
            cutting_feed: understood.and_then(|understood| understood.step.cutting_feed()),
            is_same,
        }
    }
}
