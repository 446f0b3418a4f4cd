//! *FV0 to *FV7 on one port whose eight pins are written at once.
//!
//! All lines change in the same cycle: at the pins there is the old code c, then the new one c', and nothing between. No
//! order is needed, and no memory of c: every update writes all eight lines.
//!
//! Wiring that lets go later than it takes hold corrupts that: a line released late adds its weight to c'. With a
//! [`Settling`] an update that releases lines *and* pulls others down passes through the weights they share:
//!
//! (1) c, then c AND c', a wait, then c'
//!
//! The first write only releases and the second only pulls down, so every intermediate code is at most max(c, c') as in
//! [`super::parallel_lines`], and the lowest is c AND c'.

use embedded_hal::delay::DelayNs;

use super::OverrideOutput;
use super::line_code::LineCode;
use super::settling::{NoDelay, Settling};
use crate::ramp::FeedOverride;

/// Eight pins that change together.
pub trait LinePort {
    /// What the hardware may refuse with.
    type Error;

    /// Writes all levels in one cycle: bit i for *FVi, 1 is high.
    ///
    /// # Errors
    /// The port does not take it, or is found not to hold what it was told before; it has tried to take it nonetheless.
    fn write(&mut self, levels: u8) -> Result<(), Self::Error>;
}

/// Eight lines on one port.
#[derive(Clone, Debug)]
pub struct PortLines<P, D = NoDelay> {
    port: P,
    settling: Settling<D>,
    /// What the lines hold; `None` after a failure.
    held: Option<LineCode>,
}

impl<P: LinePort> PortLines<P> {
    /// Takes a port whose wiring follows at once, and releases its lines.
    ///
    /// # Errors
    /// The port refused.
    pub fn new(port: P) -> Result<Self, P::Error> {
        Self::with_settling(port, Settling::NONE)
    }
}

impl<P: LinePort, D: DelayNs> PortLines<P, D> {
    /// Takes a port whose wiring needs time, and releases its lines. Updates must lie further apart than it settles.
    ///
    /// # Errors
    /// The port refused.
    pub fn with_settling(port: P, settling: Settling<D>) -> Result<Self, P::Error> {
        let mut output = PortLines { port, settling, held: None };
        output.release()?;
        Ok(output)
    }

    fn write(&mut self, code: LineCode) -> Result<(), P::Error> {
        self.held = None;
        self.port.write(code.levels())?;
        self.held = Some(code);
        Ok(())
    }

    /// Releases what must be high in the end, and waits for it, where the wiring could bring it late (1).
    fn give_way(&mut self, code: LineCode) -> Result<(), P::Error> {
        let shared = self.held.map_or(LineCode::RELEASED, |held| held.shared_with(code));
        let mixed = self.held.is_none_or(|held| held.has_more_than(code) && code.has_more_than(held));
        if self.settling.settle_ns > 0 && mixed {
            self.write(shared)?;
            self.settling.wait();
        }
        Ok(())
    }
}

impl<P: LinePort, D: DelayNs> OverrideOutput for PortLines<P, D> {
    type Error = P::Error;

    /// After an error the port was told to release all lines. If it does not obey it holds the old code, the one they
    /// share, or the new one.
    fn put(&mut self, feed_override: FeedOverride) -> Result<(), P::Error> {
        let code = LineCode::of(feed_override);
        let written = self.give_way(code).and_then(|()| self.write(code));
        if written.is_err() {
            // The first failure is the one to report.
            let _ = self.release();
        }
        written
    }

    fn release(&mut self) -> Result<(), P::Error> {
        self.write(LineCode::RELEASED)
    }
}

#[cfg(test)]
mod tests;
