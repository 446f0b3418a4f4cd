//! Board for measurements: its inputs are set directly, its last output is stored.

use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::board::Board;
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::input::{Input, Work};

/// Board for measurements, without hardware: the caller sets the inputs and the segment, and reads the last override.
#[derive(Clone, Debug)]
pub struct BoardIo {
    /// The segment in execution, with its number; `None` if none is in execution.
    pub segment: Option<(u32, ActiveSegment)>,
    /// Inputs that the controller reads at the next tick.
    pub input: Input,
    /// Override that the controller has set last.
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
