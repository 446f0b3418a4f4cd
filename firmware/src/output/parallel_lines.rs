//! *FV0 to *FV7 straight from eight pins, written one after the other.
//!
//! The control samples the lines whenever its ladder comes by, also between two writes. So every update first releases
//! the lines that the new code c' wants high, then pulls down those it wants low. From the old code c the first phase
//! passes through subsets of c, the second through subsets of c', and the code is the sum of its weights:
//!
//! (1) every intermediate code <= max(c, c')
//!
//! (2) the lowest intermediate code = c AND c', the weights they share
//!
//! (1) holds for any order within a phase and whatever c was, so all eight lines are written each time and nothing is
//! remembered of what they were (but to save a wait): a line disturbed from outside is put right by the next update.
//! By (1) all lines low, which a control reads as 0 %, does not come up either: it would be 255.
//!
//! The lowest code (2) can be 0 %, a feed hold: 127 -> 128 has no weight in common, and no order avoids it, for 128
//! is only reached from a code of 127 at most, and all but 0 lead above 128. Too low is the safe side, the chip gets
//! thinner; it lasts for the rest of the eight writes, and a control that happens to look then slows down until its next
//! scan. Who cannot have that uses [`super::strobed`].
//!
//! A coupler that lets go later than it takes hold brings the lines out of order behind the pins; [`Settling`] between
//! the phases, as long as the slowest release, restores (1) at the control.

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;

use super::OverrideOutput;
use super::line_code::{LINES, LineCode};
use super::lines::{LineError, Lines};
use super::settling::{NoDelay, Settling};
use crate::ramp::FeedOverride;

/// Eight lines without a register.
///
/// Pins of different types go in as `&mut dyn OutputPin<Error = E>`.
#[derive(Clone, Debug)]
pub struct ParallelLines<P, D = NoDelay> {
    lines: Lines<P>,
    settling: Settling<D>,
    /// What the lines hold; `None` after a failure.
    held: Option<LineCode>,
}

impl<P: OutputPin> ParallelLines<P> {
    /// Takes *FV0 to *FV7, whose wiring follows at once, and releases them.
    ///
    /// # Errors
    /// The first pin that refused.
    pub fn new(pins: [P; LINES]) -> Result<Self, LineError<P::Error>> {
        Self::with_settling(pins, Settling::NONE)
    }
}

impl<P: OutputPin, D: DelayNs> ParallelLines<P, D> {
    /// Takes *FV0 to *FV7, whose wiring needs time, and releases them. Updates must lie further apart than it settles.
    ///
    /// # Errors
    /// The first pin that refused.
    pub fn with_settling(pins: [P; LINES], settling: Settling<D>) -> Result<Self, LineError<P::Error>> {
        let mut output = ParallelLines { lines: Lines::new(pins), settling, held: None };
        output.release()?;
        Ok(output)
    }
}

impl<P: OutputPin, D: DelayNs> OverrideOutput for ParallelLines<P, D> {
    type Error = LineError<P::Error>;

    /// After an error all lines that obey are released: the control reads the weights of those that don't, (1) holds.
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
