//! How the override reaches the control: lines, an analogue voltage; and what is told about it.
//!
//! [`parallel_lines`] drives *FV0 to *FV7 of a Fanuc-like control, [`port_lines`] the same where one write reaches all
//! eight, [`strobed`] through an external register, [`pwm`] an analogue override input; [`latched`] keeps any of them at 0 % after a fault. [`telemetry`] records what
//! was put out and why. Wiring and figures: docs/outputs.md.

pub mod line_code;

pub mod settling;

pub mod lines;

pub mod parallel_lines;

pub mod port_lines;

pub mod strobed;

pub mod pwm;

pub mod latched;

pub mod telemetry;

use crate::ramp::FeedOverride;

/// An output that the control reads its feed override from.
///
/// Both calls may block for what the wiring needs to settle (microseconds), never for the control.
pub trait OverrideOutput {
    /// What the hardware may refuse with.
    type Error;

    /// Puts the override out; what a control reads meanwhile is never more than the higher of the old and the new one.
    ///
    /// # Errors
    /// The hardware refused. What of it still obeys is released then, as by [`OverrideOutput::release`].
    fn put(&mut self, feed_override: FeedOverride) -> Result<(), Self::Error>;

    /// De-energises the output, as a loss of power would: the control reads 0 %, its axes stop.
    ///
    /// # Errors
    /// A part of the hardware refused; all others are released nonetheless.
    fn release(&mut self) -> Result<(), Self::Error>;
}

impl<O: OverrideOutput + ?Sized> OverrideOutput for &mut O {
    type Error = O::Error;

    fn put(&mut self, feed_override: FeedOverride) -> Result<(), O::Error> {
        O::put(self, feed_override)
    }

    fn release(&mut self) -> Result<(), O::Error> {
        O::release(self)
    }
}

#[cfg(test)]
pub(crate) mod bench;
