//! Override lines *FV0 to *FV7 on one port, which writes all eight pins at the same instant.
//!
//! All lines change in the same cycle: the pins have the old code c, then the new code c', without an intermediate
//! code. Neither an order nor a memory of c is needed: every update writes all eight lines.
//!
//! Wiring that releases more slowly than it pulls breaks this: a line that is released late adds its weight to c'.
//! With a [`Settling`], an update that releases lines *and* pulls others down passes through the common weights:
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

/// Output port with eight pins that change at the same instant.
pub trait LinePort {
    /// Error of the hardware.
    type Error;

    /// Writes the levels of all pins in one cycle: bit i is the level of *FVi, 1 is high.
    ///
    /// # Errors
    /// The port has failed, or did not hold the previous levels; it has attempted the write nonetheless.
    fn write(&mut self, levels: u8) -> Result<(), Self::Error>;
}

/// Override output on the eight lines *FV0 to *FV7, which one port drives together.
#[derive(Clone, Debug)]
pub struct PortLines<P, D = NoDelay> {
    port: P,
    settling: Settling<D>,
    /// Current code of the lines; `None` after a failure.
    held: Option<LineCode>,
}

impl<P: LinePort> PortLines<P> {
    /// Output on this port, whose wiring follows at once; sets all lines high (0 %).
    ///
    /// # Errors
    /// The port has failed.
    pub fn new(port: P) -> Result<Self, P::Error> {
        Self::with_settling(port, Settling::NONE)
    }
}

impl<P: LinePort, D: DelayNs> PortLines<P, D> {
    /// Output on this port, whose wiring needs time to follow; sets all lines high (0 %). Updates must be further
    /// apart than the settling time.
    ///
    /// # Errors
    /// The port has failed.
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

    /// Releases the lines that are high in `code` and waits for the wiring, if other lines are pulled down. (1)
    fn release_first(&mut self, code: LineCode) -> Result<(), P::Error> {
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

    /// After an error the lines are released. If that fails too, the port holds the old code, the common one, or the
    /// new one.
    fn put(&mut self, feed_override: FeedOverride) -> Result<(), P::Error> {
        let code = LineCode::of(feed_override);
        let written = self.release_first(code).and_then(|()| self.write(code));
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
