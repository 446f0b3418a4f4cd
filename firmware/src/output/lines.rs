//! Eight pins that are written one after the other.

use embedded_hal::digital::{OutputPin, PinState};

use super::line_code::{LINES, LineCode};

/// Output line that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum OutputLine {
    /// *FV of this number, 0 to 7.
    Fv(u8),
    /// The strobe of the external register.
    Strobe,
}

/// Failure of a pin; if several fail, the first one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LineError<E> {
    /// Failed line.
    pub line: OutputLine,
    /// Error of the pin.
    pub source: E,
}

/// The pins of *FV0 to *FV7, in this order.
#[derive(Clone, Debug)]
pub struct OutputLines<P> {
    pins: [P; LINES],
}

impl<P: OutputPin> OutputLines<P> {
    /// The lines at the current levels of their pins; writes nothing.
    pub fn new(pins: [P; LINES]) -> Self {
        OutputLines { pins }
    }

    /// Releases the lines that are high in `code`. None goes low.
    ///
    /// # Errors
    /// A pin has failed; all lines are then released.
    pub fn reduce_to(&mut self, code: LineCode) -> Result<(), LineError<P::Error>> {
        self.drive(code.levels(), PinState::High)
    }

    /// Pulls down the lines that are low in `code`. None goes high.
    ///
    /// # Errors
    /// A pin has failed; all lines are then released.
    pub fn raise_to(&mut self, code: LineCode) -> Result<(), LineError<P::Error>> {
        self.drive(!code.levels(), PinState::Low)
    }

    /// Releases all lines, even if one fails.
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
