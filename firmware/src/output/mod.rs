//! Output of the override to the control by lines or an analogue voltage, and its telemetry.
//!
//! [`parallel_lines`] drives *FV0 to *FV7 of a Fanuc-like control, [`port_lines`] the same lines with one write for
//! all eight, [`strobed`] through an external register, [`pwm`] an analogue override input; [`latched`] keeps any of
//! them at 0 % after a fault. [`telemetry`] records each override and its reason. Wiring and figures: docs/outputs.md.

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

/// Output by which the control receives its feed override, such as eight lines or a PWM.
///
/// The functions may block for some microseconds, until the wiring has settled; they never wait for the control.
pub trait OverrideOutput {
    /// Error of the hardware.
    type Error;

    /// Sets the override. While the output changes, the control never reads more than the larger of the old and the
    /// new value.
    ///
    /// # Errors
    /// The hardware has failed. All parts that still work are then released, as by [`OverrideOutput::release`].
    fn put(&mut self, feed_override: FeedOverride) -> Result<(), Self::Error>;

    /// Switches the output off, as a loss of power would: the control reads 0 %, and its axes stop.
    ///
    /// # Errors
    /// A part of the hardware has failed; all others are released nonetheless.
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
