//! Eight pins written one after the other, and which one failed.

use embedded_hal::digital::{OutputPin, PinState};

use super::line_code::{LINES, LineCode};

/// A line that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Line {
    /// *FV of this number, 0 to 7.
    Fv(u8),
    /// The strobe of the external register.
    Strobe,
}

/// A pin refused; with several, the first one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LineError<E> {
    /// Which line.
    pub line: Line,
    /// What the pin said.
    pub source: E,
}

/// The pins of *FV0 to *FV7, in this order.
#[derive(Clone, Debug)]
pub struct Lines<P> {
    pins: [P; LINES],
}

impl<P: OutputPin> Lines<P> {
    /// Lines as their pins stand; nothing is written.
    pub fn new(pins: [P; LINES]) -> Self {
        Lines { pins }
    }

    /// Releases the lines that `code` wants high. None goes low.
    ///
    /// # Errors
    /// A pin refused; all lines are released then.
    pub fn reduce_to(&mut self, code: LineCode) -> Result<(), LineError<P::Error>> {
        self.drive(|line| !code.is_low(line), PinState::High)
    }

    /// Pulls the lines down that `code` wants low. None goes high.
    ///
    /// # Errors
    /// A pin refused; all lines are released then.
    pub fn raise_to(&mut self, code: LineCode) -> Result<(), LineError<P::Error>> {
        self.drive(|line| code.is_low(line), PinState::Low)
    }

    /// Releases all lines, also after one has refused.
    ///
    /// # Errors
    /// The first that refused.
    pub fn release(&mut self) -> Result<(), LineError<P::Error>> {
        let mut result = Ok(());
        for (line, pin) in (0..).zip(self.pins.iter_mut()) {
            let released = pin.set_high().map_err(|source| LineError { line: Line::Fv(line), source });
            result = result.and(released);
        }
        result
    }

    fn drive(&mut self, applies: impl Fn(u8) -> bool, level: PinState) -> Result<(), LineError<P::Error>> {
        for (line, pin) in (0..).zip(self.pins.iter_mut()).filter(|(line, _)| applies(*line)) {
            if let Err(source) = pin.set_state(level) {
                // The first failure is the one to report.
                let _ = self.release();
                return Err(LineError { line: Line::Fv(line), source });
            }
        }
        Ok(())
    }
}
