//! *FV0 to *FV7 through an external register (such as the 74HC574) that latches the data lines at the rising strobe.
//!
//! The register's outputs change together: there are no intermediate codes. The disadvantage: the register holds the
//! last code if the chip fails. Therefore a watchdog must control its output enable, with pull-ups on the lines.
//! Couplers must be between the chip and the register, not after it, where they would change at different times.

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;

use super::OverrideOutput;
use super::line_code::{LINES, LineCode};
use super::lines::{LineError, OutputLine, OutputLines};
use super::settling::{NoDelay, Settling};
use crate::ramp::FeedOverride;

/// Override output on eight data lines and a strobe to an external register, which drives *FV0 to *FV7.
#[derive(Clone, Debug)]
pub struct Strobed<P, S, D = NoDelay> {
    lines: OutputLines<P>,
    strobe: S,
    settling: Settling<D>,
}

impl<P: OutputPin, S: OutputPin<Error = P::Error>> Strobed<P, S> {
    /// Output on these data and strobe pins, whose wiring follows at once; sets all lines of the register high (0 %).
    ///
    /// # Errors
    /// The first failed pin.
    pub fn new(pins: [P; LINES], strobe: S) -> Result<Self, LineError<P::Error>> {
        Self::with_settling(pins, strobe, Settling::NONE)
    }
}

impl<P: OutputPin, S: OutputPin<Error = P::Error>, D: DelayNs> Strobed<P, S, D> {
    /// Output on these data and strobe pins, whose wiring needs time to follow: it waits before the strobe rises, and
    /// while the strobe is high.
    ///
    /// # Errors
    /// The first failed pin.
    pub fn with_settling(pins: [P; LINES], strobe: S, settling: Settling<D>) -> Result<Self, LineError<P::Error>> {
        let mut output = Strobed { lines: OutputLines::new(pins), strobe, settling };
        output.strobe.set_low().map_err(strobe_error)?;
        output.release()?;
        Ok(output)
    }

    /// Latches the data lines into the register; the strobe returns to low.
    fn latch(&mut self) -> Result<(), LineError<P::Error>> {
        self.settling.wait();
        let risen = self.strobe.set_high();
        self.settling.wait();
        let fallen = self.strobe.set_low();
        risen.and(fallen).map_err(strobe_error)
    }
}

fn strobe_error<E>(source: E) -> LineError<E> {
    LineError { line: OutputLine::Strobe, source }
}

impl<P: OutputPin, S: OutputPin<Error = P::Error>, D: DelayNs> OverrideOutput for Strobed<P, S, D> {
    type Error = LineError<P::Error>;

    /// After a failure of a data line the register holds the weights of the failed lines, at most those of the old or
    /// the new code. After a failure of the strobe it holds the old code or the new one.
    fn put(&mut self, feed_override: FeedOverride) -> Result<(), Self::Error> {
        let code = LineCode::of(feed_override);
        let written = self.lines.reduce_to(code).and_then(|()| self.lines.raise_to(code));
        let latched = self.latch();
        if latched.is_err() {
            // The strobe's error is the one to report.
            let _ = self.lines.release();
        }
        written.and(latched)
    }

    fn release(&mut self) -> Result<(), Self::Error> {
        let released = self.lines.release();
        let latched = self.latch();
        released.and(latched)
    }
}

#[cfg(test)]
mod tests;
