//! Pseudo-terminal as the control's line; Windows has none.

#[cfg(not(unix))]
use std::io;

#[cfg(unix)]
pub use unix::Pty;

#[cfg(unix)]
mod unix {
    use std::fs::File;
    use std::io::{self, Read, Write};

    use serialport::{SerialPort, TTYPort};

    use super::super::client::is_quiet;

    /// Control's end of a pseudo-terminal.
    pub struct Pty {
        ours: TTYPort,
        /// Sender's end, held open so that the line outlives the sender.
        _theirs: File,
    }

    impl Pty {
        /// New pseudo-terminal, and the name that a sender opens.
        ///
        /// # Errors
        /// The system has none.
        pub fn open() -> io::Result<(Self, String)> {
            let (ours, theirs) = TTYPort::pair()?;
            let name = theirs.name().unwrap_or_default();
            // Opened as a plain file: a serial port is locked, and the sender must be able to lock it.
            let _theirs = File::options().read(true).write(true).open(&name)?;
            Ok((Pty { ours, _theirs }, name))
        }

        /// Reads what is there; returns 0 if there is nothing.
        ///
        /// # Errors
        /// The line is gone.
        pub fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let read = match self.ours.bytes_to_read() {
                Ok(0) => return Ok(0),
                Ok(_) => self.ours.read(buffer),
                Err(error) => Err(error.into()),
            };
            match read {
                Err(error) if is_quiet(error.kind()) => Ok(0),
                read => read,
            }
        }

        /// Writes one character.
        ///
        /// # Errors
        /// The line is gone.
        pub fn write(&mut self, byte: u8) -> io::Result<()> {
            self.ours.write_all(&[byte])
        }
    }
}

/// Stand-in for a system without pseudo-terminals.
#[cfg(not(unix))]
pub enum Pty {}

#[cfg(not(unix))]
impl Pty {
    /// Always fails.
    ///
    /// # Errors
    /// Always.
    pub fn open() -> io::Result<(Self, String)> {
        Err(io::Error::other("this system has none; serve on --tcp or --rfc2217"))
    }

    /// Reads nothing.
    pub fn read(&mut self, _buffer: &mut [u8]) -> io::Result<usize> {
        match *self {}
    }

    /// Writes nothing.
    pub fn write(&mut self, _byte: u8) -> io::Result<()> {
        match *self {}
    }
}
