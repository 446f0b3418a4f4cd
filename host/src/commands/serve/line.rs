//! Control's end of its line: a pseudo-terminal, or a TCP port to which senders connect.

use std::time::{Duration, Instant};

use arcfeed_control::code::{DC3, without_parity};
use arcfeed_control::dnc_port::DncPort;

use super::super::outcome::Failure;
use super::pty::Pty;
use super::tcp_line::{ClientLimits, TcpLine};
use crate::job::SerialSettings;

/// Silence after which a sender counts as stopped.
const QUIET: Duration = Duration::from_secs(1);
/// Longest wait for that silence.
const QUIET_WAIT_MAX: Duration = Duration::from_secs(10);

/// The emulated control's end of its line: a pseudo-terminal or a TCP port.
pub struct ControlLine {
    name: String,
    end: End,
}

enum End {
    Pty(Pty),
    Tcp(Box<TcpLine>),
}

impl ControlLine {
    /// Line over a new pseudo-terminal.
    ///
    /// # Errors
    /// The system has none.
    pub fn pty() -> Result<Self, Failure> {
        let (pty, name) = Pty::open().map_err(|error| Failure::Machine(format!("pseudo-terminal: {error}")))?;
        Ok(ControlLine { name, end: End::Pty(pty) })
    }

    /// TCP port for senders, with plain bytes or, if the line's settings are given, through RFC 2217.
    ///
    /// # Errors
    /// The address is none of this machine's, or in use, or open to other machines without permission.
    pub fn tcp(address: &str, serial: Option<SerialSettings>, limits: ClientLimits) -> Result<Self, Failure> {
        let tcp = TcpLine::listen_on(address, serial, limits)?;
        Ok(ControlLine { name: tcp.name().to_owned(), end: End::Tcp(Box::new(tcp)) })
    }

    /// Name that a sender opens.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Gives the line to a sender for its next program; returns true if there is one.
    pub fn begin(&mut self) -> bool {
        match &mut self.end {
            End::Pty(_) => true,
            End::Tcp(tcp) => tcp.begin(),
        }
    }

    /// Whether there may be a sender at the other end.
    pub fn has_sender(&self) -> bool {
        match &self.end {
            End::Pty(_) => true,
            End::Tcp(tcp) => tcp.has_sender(),
        }
    }

    /// Whether the sender is gone and had not begun a program.
    pub fn is_abandoned(&self) -> bool {
        match &self.end {
            End::Pty(_) => false,
            End::Tcp(tcp) => tcp.is_abandoned(),
        }
    }

    /// Ends a connection, so that the next sender finds a fresh control; returns true if the line has connections.
    pub fn hang_up(&mut self) -> bool {
        match &mut self.end {
            End::Pty(_) => false,
            End::Tcp(tcp) => {
                tcp.hang_up();
                true
            }
        }
    }

    /// Passes the bytes on the line to the control, and reports to the control whether the sender is still connected;
    /// `control_waits` for characters, with nothing to execute.
    ///
    /// # Errors
    /// The line is gone.
    pub fn feed_control(&mut self, port: &mut DncPort, control_waits: bool) -> Result<(), Failure> {
        match &mut self.end {
            End::Pty(_) => {
                let mut buffer = [0; 256];
                while let len @ 1.. = self.read(&mut buffer)? {
                    port.on_bytes(&buffer[..len]);
                }
            }
            End::Tcp(tcp) => tcp.feed(port, control_waits),
        }
        port.set_ready(self.has_sender());
        Ok(())
    }

    /// Sends the output of the control.
    ///
    /// # Errors
    /// The line is gone.
    pub fn answer(&mut self, port: &mut DncPort) -> Result<(), Failure> {
        while let Some(byte) = port.poll_transmit() {
            if without_parity(byte) == DC3 && self.is_far() {
                self.feed_control(port, false)?;
                port.exempt_bytes_on_wire();
            }
            self.write(byte)?;
        }
        Ok(())
    }

    /// Reads and drops characters until the sender has been silent for a while, or `gives_up` returns true.
    ///
    /// # Errors
    /// The line is gone.
    pub fn wait_for_silence(&mut self, gives_up: impl Fn() -> bool) -> Result<(), Failure> {
        let (mut buffer, started, mut heard) = ([0; 256], Instant::now(), Instant::now());
        while heard.elapsed() < QUIET && started.elapsed() < QUIET_WAIT_MAX && !gives_up() {
            if self.read(&mut buffer)? > 0 {
                heard = Instant::now();
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        Ok(())
    }

    /// DC3 takes time to reach the sender.
    fn is_far(&self) -> bool {
        match &self.end {
            End::Pty(_) => true,
            End::Tcp(tcp) => tcp.is_far(),
        }
    }

    /// Reads what is there, of a TCP port only the number of bytes; returns 0 if there is nothing.
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Failure> {
        match &mut self.end {
            End::Pty(pty) => pty.read(buffer).map_err(|error| Failure::Machine(format!("{}: {error}", self.name))),
            End::Tcp(tcp) => Ok(tcp.discard()),
        }
    }

    fn write(&mut self, byte: u8) -> Result<(), Failure> {
        match &mut self.end {
            End::Pty(pty) => pty.write(byte).map_err(|error| Failure::Machine(format!("{}: {error}", self.name))),
            End::Tcp(tcp) => {
                tcp.write(byte);
                Ok(())
            }
        }
    }
}
