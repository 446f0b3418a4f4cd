//! Settling time of the wiring between output pins and control: couplers, relays, filters.

use embedded_hal::delay::DelayNs;

/// Time that the wiring between pins and control needs to follow, and the delay function that waits for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settling<D> {
    /// Function that waits.
    pub delay: D,
    /// Longest time, nanoseconds, from setting a pin high until the control reads it; with optical couplers some
    /// microseconds.
    pub settle_ns: u32,
}

/// Delay that never waits, for wiring that follows at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct NoDelay;

impl DelayNs for NoDelay {
    fn delay_ns(&mut self, _ns: u32) {}
}

impl Settling<NoDelay> {
    /// Wiring that follows at once.
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
