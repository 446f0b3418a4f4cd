//! Time for the wiring to follow: couplers, relays, filters.

use embedded_hal::delay::DelayNs;

/// How long the lines take behind the pins, and what waits for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settling<D> {
    /// What waits.
    pub delay: D,
    /// The slowest line's release, nanoseconds; microseconds for optical couplers.
    pub settle_ns: u32,
}

/// No delay: the lines follow their pins at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct NoDelay;

impl DelayNs for NoDelay {
    fn delay_ns(&mut self, _ns: u32) {}
}

impl Settling<NoDelay> {
    /// No wait at all.
    pub const NONE: Self = Settling { delay: NoDelay, settle_ns: 0 };
}

impl<D: DelayNs> Settling<D> {
    /// Waits until what was written has reached the far end.
    pub fn wait(&mut self) {
        if self.settle_ns > 0 {
            self.delay.delay_ns(self.settle_ns);
        }
    }
}
