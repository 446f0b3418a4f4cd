#![doc = include_str!("../README.md")]
//!
//! Serial ports by pyserial's URLs.
//!
//! [`Port`] is the interface; the port owns the clock: wall time for real ports, simulated time for simulated ones.
//! [`url`] parses a URL, [`open::open`] opens its port, [`list::ports`] lists the native ports, [`rfc2217::server`] offers a
//! port to clients.

mod log;

pub mod settings;

pub mod clock;

pub mod pattern;

pub mod url;

pub mod list;

#[cfg(any(unix, windows))]
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
use arcfeed_units::Micros;

/// State of the machine behind a port, where the port can report it; all `None` over a plain DNC line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Machine {
    /// Feed override in effect, %.
    pub override_percent: Option<u8>,
    /// Thickest chip of the last tooth divided by its target.
    pub chip_ratio: Option<f64>,
    /// Alarm or other cause for which the machine has stopped, in words.
    pub alarm: Option<String>,
    /// X, Y, Z of the tool's tip in the workpiece's coordinates, mm.
    pub position_mm: Option<[f64; 3]>,
    /// Tool on the part, if the kinematics of the machine are known.
    pub on_part: Option<ToolOnPart>,
    /// Feed along the path at present, mm/min.
    pub feed_mm_per_min: Option<f64>,
}

/// Position of the tool on the part as it was at its first cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolOnPart {
    /// X, Y, Z of the tip in the workpiece's coordinates, mm.
    pub tip_mm: [f64; 3],
    /// Unit vector from the tip to the holder.
    pub axis: [f64; 3],
}

/// Byte line to a control: a serial port, a socket, or a simulated one. The port also has the clock for everything that is timed on the
/// line.
pub trait Port {
    /// Time since the port was opened.
    fn now(&self) -> Micros;

    /// Reads the bytes that have arrived; returns 0 if there are none.
    ///
    /// # Errors
    /// The port can no longer be used, for instance because an adapter was unplugged or a connection closed.
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError>;

    /// Writes bytes to the line; returns the number accepted, 0 if the line accepts none now.
    ///
    /// # Errors
    /// The port can no longer be used.
    fn write(&mut self, bytes: &[u8]) -> Result<usize, PortError>;

    /// Number of accepted bytes that have not left yet, as far as the port can know.
    ///
    /// # Errors
    /// The port can no longer be used.
    fn out_waiting(&mut self) -> Result<usize, PortError> {
        Ok(0)
    }

    /// Waits until the time `deadline` (since the port was opened); a simulated port returns earlier if its control sends.
    fn wait(&mut self, deadline: Micros);

    /// Counts of damaged characters received since the port was opened; `None` if the port does not report them.
    fn line_errors(&self) -> Option<Counts> {
        None
    }

    /// Date and time at which the port was opened; `None` if the port has simulated time.
    fn opened(&self) -> Option<SystemTime> {
        None
    }

    /// Whether the control has executed the program to its end; `None` if the port cannot know.
    fn control_is_done(&self) -> Option<bool> {
        None
    }

    /// Number of blocks that the control has started; `None` if the port cannot know.
    fn blocks_executed(&self) -> Option<usize> {
        None
    }

    /// State of the machine behind the port; fields that the port cannot know are `None`.
    fn machine(&self) -> Machine {
        Machine::default()
    }

    /// Requests feed hold from the machine, if the port has one; returns true once the axes are at rest. Ports without a machine return
    /// false.
    fn feed_hold(&mut self) -> bool {
        false
    }
}

/// Shared port: the owner still sees the port behind it.
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

/// Failure of a port: its name, and a message that says the cause in words.
#[derive(Debug, thiserror::Error)]
#[error("{name}: {source}")]
pub struct PortError {
    /// Name of the port, as in its URL.
    pub name: String,
    /// Error of the operating system, or one made from a message of arcfeed.
    pub source: std::io::Error,
}

impl PortError {
    /// Failure of the port `name` with the given message, which names the cause and the remedy.
    pub fn in_words(name: &str, message: impl Into<String>) -> Self {
        PortError { name: name.to_owned(), source: std::io::Error::other(message.into()) }
    }
}
