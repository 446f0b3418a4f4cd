//! Settling time of the wiring: couplers, relays, filters.

use embedded_hal::delay::DelayNs;

/// Time that the lines need to follow the pins, and the delay source that waits for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settling<D> {
    /// Delay source.
    pub delay: D,
    /// Slowest release of a line, nanoseconds; with optical couplers this is some microseconds.
    pub settle_ns: u32,
}

/// Delay source that never waits, for lines that follow their pins at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct NoDelay;

impl DelayNs for NoDelay {
    fn delay_ns(&mut self, _ns: u32) {}
}

impl Settling<NoDelay> {
    /// No settling time.
    pub const NONE: Self = Settling { delay: NoDelay, settle_ns: 0 };
}

impl<D: DelayNs> Settling<D> {
    /// Waits until written levels have reached the control.
    pub fn wait(&mut self) {
        if self.settle_ns > 0 {
            self.delay.delay_ns(self.settle_ns);
        }
    }
}
