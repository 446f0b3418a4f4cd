//! The seam between the sender and whatever it sends to. It owns the clock: wall time for real ports, simulated time
//! for simulated ones.

mod log;

pub mod clock;

pub mod pattern;

pub mod url;

pub mod list;

pub mod serial;

pub mod loopback;

mod tcp;

pub mod socket;

pub mod rfc2217;

pub mod spy;

pub mod fault;

pub mod reaction;

pub mod open;

use std::cell::RefCell;
use std::rc::Rc;
use std::time::SystemTime;

use arcfeed_line_errors::Counts;
use arcfeed_shared::units::Micros;

/// What a machine says of itself; nothing over a plain DNC line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Machine {
    /// The override in effect, %.
    pub override_percent: Option<u8>,
    /// Chip of the last tooth, relative to its target.
    pub chip_ratio: Option<f64>,
    /// What stopped it, in words.
    pub alarm: Option<String>,
}

/// A line to a control.
pub trait Port {
    /// Time since the port was opened.
    fn now(&self) -> Micros;

    /// Reads what has arrived; zero if nothing has.
    ///
    /// # Errors
    /// The line is gone.
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError>;

    /// Puts bytes on the line; answers how many of them it took, zero if it takes none now.
    ///
    /// # Errors
    /// The line is gone.
    fn write(&mut self, bytes: &[u8]) -> Result<usize, PortError>;

    /// Bytes it took that have not left yet, as far as the port can know.
    ///
    /// # Errors
    /// The line is gone.
    fn out_waiting(&mut self) -> Result<usize, PortError> {
        Ok(0)
    }

    /// Lets time pass, until `deadline` at the latest.
    fn wait(&mut self, deadline: Micros);

    /// Characters from the other end that came in damaged since the port was opened, where the port can say.
    fn line_errors(&self) -> Option<Counts> {
        None
    }

    /// The day and time at which the port was opened, where its time is that of the wall.
    fn opened(&self) -> Option<SystemTime> {
        None
    }

    /// Whether the control is done with the program, where the port can know.
    fn control_is_done(&self) -> Option<bool> {
        None
    }

    /// Blocks that the control has taken up, where the port can know.
    fn blocks_executed(&self) -> Option<usize> {
        None
    }

    /// What the machine says of itself, where the port can know.
    fn machine(&self) -> Machine {
        Machine::default()
    }

    /// Asks for feed hold, where the port can; answers whether the axes rest.
    fn feed_hold(&mut self) -> bool {
        false
    }
}

/// A shared port: who made it still sees what is behind it.
impl<P: Port> Port for Rc<RefCell<P>> {
    fn now(&self) -> Micros {
        self.as_ref().borrow().now()
    }

    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        self.as_ref().borrow_mut().read(buffer)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<usize, PortError> {
        self.as_ref().borrow_mut().write(bytes)
    }

    fn out_waiting(&mut self) -> Result<usize, PortError> {
        self.as_ref().borrow_mut().out_waiting()
    }

    fn wait(&mut self, deadline: Micros) {
        self.as_ref().borrow_mut().wait(deadline);
    }

    fn line_errors(&self) -> Option<Counts> {
        self.as_ref().borrow().line_errors()
    }

    fn opened(&self) -> Option<SystemTime> {
        self.as_ref().borrow().opened()
    }

    fn control_is_done(&self) -> Option<bool> {
        self.as_ref().borrow().control_is_done()
    }

    fn blocks_executed(&self) -> Option<usize> {
        self.as_ref().borrow().blocks_executed()
    }

    fn machine(&self) -> Machine {
        self.as_ref().borrow().machine()
    }

    fn feed_hold(&mut self) -> bool {
        self.as_ref().borrow_mut().feed_hold()
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

impl PortError {
    /// A failure in words, which say what to do.
    pub fn in_words(name: &str, message: impl Into<String>) -> Self {
        PortError { name: name.to_owned(), source: std::io::Error::other(message.into()) }
    }
}
