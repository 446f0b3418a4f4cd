//! *FV0 to *FV7 through an external register (74HC574 and the like) that takes the data lines when its strobe rises.
//!
//! The register's outputs change together: there are no intermediate codes. What it costs: the register holds the last
//! code when the chip dies, so its output enable belongs to a watchdog, with pull-ups that make the lines high. Couplers
//! stand between the chip and the register, not behind it, where each would change at a time of its own.

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;

use super::OverrideOutput;
use super::line_code::{LINES, LineCode};
use super::lines::{Line, LineError, Lines};
use super::settling::{NoDelay, Settling};
use crate::ramp::FeedOverride;

/// Eight data lines and a strobe.
#[derive(Clone, Debug)]
pub struct Strobed<P, S, D = NoDelay> {
    lines: Lines<P>,
    strobe: S,
    settling: Settling<D>,
}

impl<P: OutputPin, S: OutputPin<Error = P::Error>> Strobed<P, S> {
    /// Takes *FV0 to *FV7 and the strobe, whose wiring follows at once, and has the register release all lines.
    ///
    /// # Errors
    /// The first pin that refused.
    pub fn new(pins: [P; LINES], strobe: S) -> Result<Self, LineError<P::Error>> {
        Self::with_settling(pins, strobe, Settling::NONE)
    }
}

impl<P: OutputPin, S: OutputPin<Error = P::Error>, D: DelayNs> Strobed<P, S, D> {
    /// The same for wiring that needs time: before the strobe rises, and as long as it stays high.
    ///
    /// # Errors
    /// The first pin that refused.
    pub fn with_settling(pins: [P; LINES], strobe: S, settling: Settling<D>) -> Result<Self, LineError<P::Error>> {
        let mut output = Strobed { lines: Lines::new(pins), strobe, settling };
        output.strobe.set_low().map_err(strobe_error)?;
        output.release()?;
        Ok(output)
    }

    /// Has the register take the data lines; the strobe ends low, ready to rise again.
    fn latch(&mut self) -> Result<(), LineError<P::Error>> {
        self.settling.wait();
        let risen = self.strobe.set_high();
        self.settling.wait();
        let fallen = self.strobe.set_low();
        risen.and(fallen).map_err(strobe_error)
    }
}

fn strobe_error<E>(source: E) -> LineError<E> {
    LineError { line: Line::Strobe, source }
}

impl<P: OutputPin, S: OutputPin<Error = P::Error>, D: DelayNs> OverrideOutput for Strobed<P, S, D> {
    type Error = LineError<P::Error>;

    /// After a data line has failed the register holds the weights of those that do not obey, no more than before or
    /// wanted. After the strobe has failed it holds the old code or the new one.
    fn put(&mut self, feed_override: FeedOverride) -> Result<(), Self::Error> {
        let code = LineCode::of(feed_override);
        let written = self.lines.reduce_to(code).and_then(|()| self.lines.raise_to(code));
        let latched = self.latch();
        if latched.is_err() {
            // The strobe is what to report.
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
