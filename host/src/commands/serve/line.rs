//! The control's end of a line without a line rate: a pseudo-terminal or a TCP connection.

use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::{Duration, Instant};

use arcfeed_hil_sim::control::code::{DC3, without_parity};
use arcfeed_hil_sim::rig::Rig;
use serialport::{SerialPort, TTYPort};

use super::super::outcome::Failure;

/// A sender that has said nothing for this long has stopped.
const QUIET: Duration = Duration::from_secs(1);

/// The control's end.
pub struct Line {
    name: String,
    end: End,
}

enum End {
    Pty {
        ours: TTYPort,
        /// The sender's end, held open so that the line outlives the sender.
        _theirs: File,
    },
    Tcp {
        listener: TcpListener,
        sender: Option<TcpStream>,
    },
}

impl Line {
    /// A new pseudo-terminal.
    ///
    /// # Errors
    /// The system has none.
    pub fn pty() -> Result<Self, Failure> {
        let failed = |error: serialport::Error| Failure::Machine(format!("pseudo-terminal: {error}"));
        let (ours, theirs) = TTYPort::pair().map_err(failed)?;
        let name = theirs.name().unwrap_or_default();
        // As a plain file: a serial port is locked, and the sender must be able to lock it.
        let held = File::options().read(true).write(true).open(&name);
        let held = held.map_err(|error| Failure::Machine(format!("{name}: {error}")))?;
        drop(theirs);
        Ok(Line { name, end: End::Pty { ours, _theirs: held } })
    }

    /// Listens on an address and port.
    ///
    /// # Errors
    /// The address is none of this machine's, or taken.
    pub fn tcp(address: &str) -> Result<Self, Failure> {
        let listen = || {
            let listener = TcpListener::bind(address)?;
            listener.set_nonblocking(true)?;
            Ok((listener.local_addr()?, listener))
        };
        let (bound, listener) = listen().map_err(|error: std::io::Error| {
            Failure::Machine(format!("{address}: {error}; give an address of this machine and a free port"))
        })?;
        Ok(Line { name: format!("socket://{bound}"), end: End::Tcp { listener, sender: None } })
    }

    /// What a sender opens.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether somebody can be at the other end; takes in who calls.
    ///
    /// # Errors
    /// The line is gone.
    pub fn has_sender(&mut self) -> Result<bool, Failure> {
        let End::Tcp { listener, sender } = &mut self.end else { return Ok(true) };
        if sender.is_none() {
            match listener.accept() {
                Ok((stream, _)) => {
                    let ready = stream.set_nonblocking(true).and_then(|()| stream.set_nodelay(true));
                    ready.map_err(|error| Failure::Machine(format!("{}: {error}", self.name)))?;
                    *sender = Some(stream);
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                Err(error) => return Err(Failure::Machine(format!("{}: {error}", self.name))),
            }
        }
        Ok(sender.is_some())
    }

    /// Gives the control everything that has been written to the line, and tells it when the sender is gone.
    ///
    /// # Errors
    /// The line is gone.
    pub fn listen(&mut self, rig: &mut Rig) -> Result<(), Failure> {
        let mut buffer = [0; 256];
        loop {
            let len = self.read(&mut buffer)?;
            rig.control_mut().port().on_bytes(&buffer[..len]);
            if len == 0 {
                let is_there = self.has_sender()?;
                rig.control_mut().port().set_ready(is_there);
                return Ok(());
            }
        }
    }

    /// Sends what the control has to say.
    ///
    /// # Errors
    /// The line is gone.
    pub fn answer(&mut self, rig: &mut Rig) -> Result<(), Failure> {
        while let Some(byte) = rig.control_mut().port().poll_transmit() {
            if without_parity(byte) == DC3 {
                self.listen(rig)?;
                rig.control_mut().port().excuse_what_is_on_the_wire();
            }
            self.write(byte)?;
        }
        Ok(())
    }

    /// Takes what still comes, until the sender is silent.
    ///
    /// # Errors
    /// The line is gone.
    pub fn wait_for_silence(&mut self, gives_up: impl Fn() -> bool) -> Result<(), Failure> {
        let (mut buffer, mut heard) = ([0; 256], Instant::now());
        while heard.elapsed() < QUIET && !gives_up() {
            if self.read(&mut buffer)? > 0 {
                heard = Instant::now();
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        Ok(())
    }

    /// Reads what is there; zero if nothing is.
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Failure> {
        let read = match &mut self.end {
            End::Pty { ours, .. } => match ours.bytes_to_read() {
                Ok(0) => return Ok(0),
                Ok(_) => ours.read(buffer),
                Err(error) => Err(error.into()),
            },
            End::Tcp { sender: None, .. } => return Ok(0),
            End::Tcp { sender: Some(stream), .. } => stream.read(buffer),
        };
        let is_quiet = |kind| matches!(kind, ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted);
        match (read, &mut self.end) {
            (Err(error), _) if is_quiet(error.kind()) => Ok(0),
            (Ok(len), _) if len > 0 => Ok(len),
            (_, End::Tcp { sender, .. }) => {
                *sender = None;
                Ok(0)
            }
            (Ok(len), End::Pty { .. }) => Ok(len),
            (Err(error), End::Pty { .. }) => Err(Failure::Machine(format!("{}: {error}", self.name))),
        }
    }

    fn write(&mut self, byte: u8) -> Result<(), Failure> {
        match &mut self.end {
            End::Pty { ours, .. } => {
                ours.write_all(&[byte]).map_err(|error| Failure::Machine(format!("{}: {error}", self.name)))
            }
            End::Tcp { sender, .. } => {
                if sender.as_mut().is_some_and(|stream| stream.write_all(&[byte]).is_err()) {
                    *sender = None;
                }
                Ok(())
            }
        }
    }
}
