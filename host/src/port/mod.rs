//! The seam between the sender and whatever it sends to. It owns the clock: wall time for real ports, simulated time
//! for simulated ones.

pub mod serial;

use arcfeed_shared::units::Micros;

/// A line to a control.
pub trait Port {
    /// Time since the port was opened.
    fn now(&self) -> Micros;

    /// Reads what has arrived; zero if nothing has.
    ///
    /// # Errors
    /// The line is gone.
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError>;

    /// Puts bytes on the line, all of them.
    ///
    /// # Errors
    /// The line is gone or does not take them.
    fn write(&mut self, bytes: &[u8]) -> Result<(), PortError>;

    /// Lets time pass, until `deadline` at the latest.
    fn wait(&mut self, deadline: Micros);

    /// Whether the control is done with the program, where the port can know.
    fn control_is_done(&self) -> Option<bool> {
        None
    }

    /// Asks for feed hold, where the port can; answers whether the axes rest.
    fn feed_hold(&mut self) -> bool {
        false
    }
}

/// The line failed.
#[derive(Debug, thiserror::Error)]
#[error("{name}: {source}")]
pub struct PortError {
    /// The port.
    pub name: String,
    /// Why.
    pub source: std::io::Error,
}
