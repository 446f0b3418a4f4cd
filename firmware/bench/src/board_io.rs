//! The board of a measurement: what goes in is put there, what comes out is kept.

use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::board::Board;
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::input::{Input, Work};

/// Inputs, the segment in work, and the override put out.
#[derive(Clone, Debug)]
pub struct BoardIo {
    /// The segment in work and its running count.
    pub segment: Option<(u32, ActiveSegment)>,
    /// What is measured.
    pub input: Input,
    /// The override put out last.
    pub output: FeedOverride,
}

impl Board for BoardIo {
    fn measure(&mut self) {}

    fn input(&self) -> &Input {
        &self.input
    }

    fn work(&self) -> Work<'_> {
        self.segment.as_ref().map(|(count, segment)| (*count, segment))
    }

    fn set_override(&mut self, feed_override: FeedOverride) {
        self.output = feed_override;
    }
}
