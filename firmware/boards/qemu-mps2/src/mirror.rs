//! The eight lines *FV0 to *FV7 of an emulated board without pins: a register in memory, which the machine line
//! reports.

use core::convert::Infallible;
use core::sync::atomic::{AtomicU8, Ordering};

use arcfeed_firmware::output::OverrideOutput;
use arcfeed_firmware::output::line_code::LineCode;
use arcfeed_firmware::ramp::FeedOverride;

/// Low lines, one bit each; all released at the start.
static LOW: AtomicU8 = AtomicU8::new(0);

/// Emulated override lines *FV0 to *FV7: a register in memory in place of pins.
#[derive(Debug)]
pub struct Mirror(());

impl Mirror {
    /// The emulated lines, for their only user.
    ///
    /// # Safety
    /// Called once.
    pub const unsafe fn new() -> Self {
        Mirror(())
    }
}

/// Lines that are low: bit i is 1 if *FVi is low.
pub fn low() -> u8 {
    LOW.load(Ordering::Relaxed)
}

/// Sets all lines high (0 %), regardless of their user; for the handlers of failures.
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
