//! Override lines *FV0 to *FV7 driven directly by eight pins, written one after the other.
//!
//! The control samples the lines at any time, also between two writes. Therefore every update first releases the lines
//! that are high in the new code c', then pulls down those that are low in it. The first phase passes through subsets
//! of the old code c, the second through subsets of c', and a code is the sum of its weights:
//!
//! (1) every intermediate code <= max(c, c')
//!
//! (2) the lowest intermediate code = c AND c', the common weights
//!
//! (1) is valid for any order within a phase and for any c. Therefore each update writes all eight lines and does not
//! depend on their old levels (except to save a wait): the next update corrects a line that was disturbed from
//! outside. By (1) the state with all lines low, which a control reads as 0 %, does not occur either: it would be 255.
//!
//! The lowest code (2) can be 0 %, a feed hold: 127 -> 128 has no common weight, and no order avoids it, because 128
//! can be reached only from a code of at most 127, and all of them except 0 lead above 128. Too low is the safe side:
//! the chip gets thinner. It lasts for the rest of the eight writes, and a control that samples then slows down until
//! its next scan. If this is not acceptable, use [`super::strobed`].
//!
//! A coupler that releases more slowly than it pulls changes the order of the lines at the control; [`Settling`]
//! between the phases, as long as the slowest release, restores (1) there.

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;

use super::OverrideOutput;
use super::line_code::{LINES, LineCode};
use super::lines::{LineError, OutputLines};
use super::settling::{NoDelay, Settling};
use crate::ramp::FeedOverride;

/// Override output on the eight lines *FV0 to *FV7, each driven by a pin of its own.
///
/// Pins of different types are passed as `&mut dyn OutputPin<Error = E>`.
#[derive(Clone, Debug)]
pub struct ParallelLines<P, D = NoDelay> {
    lines: OutputLines<P>,
    settling: Settling<D>,
    /// Current code of the lines; `None` after a failure.
    held: Option<LineCode>,
}

impl<P: OutputPin> ParallelLines<P> {
    /// Output on these pins of *FV0 to *FV7, whose wiring follows at once; sets all lines high (0 %).
    ///
    /// # Errors
    /// The first failed pin.
    pub fn new(pins: [P; LINES]) -> Result<Self, LineError<P::Error>> {
        Self::with_settling(pins, Settling::NONE)
    }
}

impl<P: OutputPin, D: DelayNs> ParallelLines<P, D> {
    /// Output on these pins of *FV0 to *FV7, whose wiring needs time to follow; sets all lines high (0 %). Updates
    /// must be further apart than the settling time.
    ///
    /// # Errors
    /// The first failed pin.
    pub fn with_settling(pins: [P; LINES], settling: Settling<D>) -> Result<Self, LineError<P::Error>> {
        let mut output = ParallelLines { lines: OutputLines::new(pins), settling, held: None };
        output.release()?;
        Ok(output)
    }
}

impl<P: OutputPin, D: DelayNs> OverrideOutput for ParallelLines<P, D> {
    type Error = LineError<P::Error>;

    /// After an error all working lines are released: the control reads the weights of the others, and (1) is valid.
    fn put(&mut self, feed_override: FeedOverride) -> Result<(), Self::Error> {
        let code = LineCode::of(feed_override);
        let held = self.held.take();
        self.lines.reduce_to(code)?;
        if held.is_none_or(|held| held.has_more_than(code) && code.has_more_than(held)) {
            self.settling.wait();
        }
        self.lines.raise_to(code)?;
        self.held = Some(code);
        Ok(())
    }

    fn release(&mut self) -> Result<(), Self::Error> {
        self.held = None;
        self.lines.release()?;
        self.held = Some(LineCode::RELEASED);
        Ok(())
    }
}

#[cfg(test)]
mod tests;
