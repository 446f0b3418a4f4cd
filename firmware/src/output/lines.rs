//! The eight output pins of the override lines *FV0 to *FV7, written one after the other.

use embedded_hal::digital::{OutputPin, PinState};

use super::line_code::{LINES, LineCode};

/// Output line whose pin has failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum OutputLine {
    /// *FV of this number, 0 to 7.
    Fv(u8),
    /// The strobe of the external register.
    Strobe,
}

/// Failure of an output pin; if several fail, of the first one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LineError<E> {
    /// Failed line.
    pub line: OutputLine,
    /// Error of the pin.
    pub source: E,
}

/// The eight output pins of *FV0 to *FV7, in this order.
#[derive(Clone, Debug)]
pub struct OutputLines<P> {
    pins: [P; LINES],
}

impl<P: OutputPin> OutputLines<P> {
    /// Takes the pins as they are, without writing any.
    pub fn new(pins: [P; LINES]) -> Self {
        OutputLines { pins }
    }

    /// Sets those pins high whose line is high in `code`, and leaves the others.
    ///
    /// # Errors
    /// A pin has failed; all lines are then released.
    pub fn reduce_to(&mut self, code: LineCode) -> Result<(), LineError<P::Error>> {
        self.drive(code.levels(), PinState::High)
    }

    /// Sets those pins low whose line is low in `code`, and leaves the others.
    ///
    /// # Errors
    /// A pin has failed; all lines are then released.
    pub fn raise_to(&mut self, code: LineCode) -> Result<(), LineError<P::Error>> {
        self.drive(!code.levels(), PinState::Low)
    }

    /// Sets all pins high, which the control reads as 0 %; also if one of them fails.
    ///
    /// # Errors
    /// The first failed line.
    pub fn release(&mut self) -> Result<(), LineError<P::Error>> {
        let mut result = Ok(());
        for (line, pin) in (0..).zip(self.pins.iter_mut()) {
            let released = pin.set_high().map_err(|source| LineError { line: OutputLine::Fv(line), source });
            result = result.and(released);
        }
        result
    }

    /// Writes the lines whose bit in `which` is 1.
    fn drive(&mut self, mut which: u8, level: PinState) -> Result<(), LineError<P::Error>> {
        for (line, pin) in (0..).zip(self.pins.iter_mut()) {
            let written = if which & 1 == 1 { pin.set_state(level) } else { Ok(()) };
            if let Err(source) = written {
                // The first failure is the one to report.
                let _ = self.release();
                return Err(LineError { line: OutputLine::Fv(line), source });
            }
            which >>= 1;
        }
        Ok(())
    }
}
