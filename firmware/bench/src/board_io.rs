//! Board for measurements: its inputs are set directly, its last output is stored.

use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::board::Board;
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::input::{Input, Work};

/// Board for measurements: given inputs, a given segment, and the override put out.
#[derive(Clone, Debug)]
pub struct BoardIo {
    /// The segment in execution and its count.
    pub segment: Option<(u32, ActiveSegment)>,
    /// Measured inputs.
    pub input: Input,
    /// Last override.
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
