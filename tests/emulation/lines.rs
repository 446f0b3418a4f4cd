//! The sockets of an emulated board as the far ends of its lines.

use std::io::{ErrorKind, Read, Write};
use std::os::fd::AsRawFd;
use std::os::unix::net::UnixStream;

use arcfeed_hil_sim::override_source::board::{BoardFailure, Wire, Wires};

use nix::errno::Errno;
use nix::sys::socket::{MsgFlags, recv};

use super::qemu::Emulator;

impl Emulator {
    fn line(&self, wire: Wire) -> &UnixStream {
        let [link, machine, sender, control, _orders] = self.lines();
        match wire {
            Wire::Link => link,
            Wire::Machine => machine,
            Wire::Sender => sender,
            Wire::Control => control,
        }
    }
}

impl Emulator {
    /// Sends a command to an image that accepts commands, on the line that no other image listens to.
    ///
    /// # Panics
    /// The line is closed.
    pub fn order(&self, order: u8) {
        let [.., mut orders] = self.lines().each_ref();
        orders.write_all(&[order]).expect("the line of orders is open");
    }
}

impl Wires for Emulator {
    fn put(&mut self, wire: Wire, bytes: &[u8]) -> Result<(), BoardFailure> {
        self.line(wire).write_all(bytes).map_err(|_| BoardFailure::Closed(wire))
    }

    fn take(&mut self, wire: Wire, bytes: &mut [u8]) -> Result<(), BoardFailure> {
        let line = self.line(wire).as_raw_fd();
        let mut taken = 0;
        while taken < bytes.len() {
            // All at once: the emulator sends byte by byte, and a wake for each costs more than all the rest.
            match recv(line, &mut bytes[taken..], MsgFlags::MSG_WAITALL) {
                Ok(0) => return Err(BoardFailure::Closed(wire)),
                Ok(more) => taken += more,
                Err(Errno::EINTR) => {}
                Err(Errno::EAGAIN) => return Err(BoardFailure::Silent(wire)),
                Err(_) => return Err(BoardFailure::Closed(wire)),
            }
        }
        Ok(())
    }

    fn take_waiting(&mut self, wire: Wire, bytes: &mut [u8]) -> Result<usize, BoardFailure> {
        let mut line = self.line(wire);
        line.set_nonblocking(true).expect("a socket need not block");
        let taken = line.read(bytes);
        line.set_nonblocking(false).expect("a socket may block");
        match taken {
            Ok(0) if !bytes.is_empty() => Err(BoardFailure::Closed(wire)),
            Ok(length) => Ok(length),
            Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(0),
            Err(_) => Err(BoardFailure::Closed(wire)),
        }
    }
}
