//! The eight lines *FV0 to *FV7 of an emulated board without pins: a register in memory, which the machine line
//! reports.

use core::convert::Infallible;
use core::sync::atomic::{AtomicU8, Ordering};

use arcfeed_firmware::output::OverrideOutput;
use arcfeed_firmware::output::line_code::LineCode;
use arcfeed_firmware::ramp::FeedOverride;

/// Low lines, one bit each; all released at the start.
static LOW: AtomicU8 = AtomicU8::new(0);

/// Emulated *FV lines in memory, in place of pins: an override output with one user.
#[derive(Debug)]
pub struct Mirror(());

impl Mirror {
    /// The emulated lines.
    ///
    /// # Safety
    /// Called once.
    pub const unsafe fn new() -> Self {
        Mirror(())
    }
}

/// Emulated *FV lines that are low, bit i for line i.
pub fn low() -> u8 {
    LOW.load(Ordering::Relaxed)
}

/// Releases all lines, regardless of their user, after a failure.
pub fn release() {
    LOW.store(0, Ordering::Relaxed);
}

impl OverrideOutput for Mirror {
    type Error = Infallible;

    fn put(&mut self, feed_override: FeedOverride) -> Result<(), Infallible> {
        // One store changes all lines at once, without intermediate states.
        LOW.store(!LineCode::of(feed_override).levels(), Ordering::Relaxed);
        Ok(())
    }

    fn release(&mut self) -> Result<(), Infallible> {
        release();
        Ok(())
    }
}
