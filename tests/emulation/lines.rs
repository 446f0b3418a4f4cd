//! The sockets of an emulated board as the far ends of its lines.

use std::os::fd::{AsRawFd, OwnedFd};

use arcfeed_hil_sim::override_source::board::{BoardFailure, Wire, Wires};

use nix::errno::Errno;
use nix::sys::socket::{MsgFlags, recv, send};

use super::qemu::Emulator;

/// Bytes sent at a time: fewer than the emulator takes of a datagram.
const PART: usize = 1_024;

impl Emulator {
    fn line(&self, wire: Wire) -> &OwnedFd {
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
        let [.., orders] = self.lines();
        send_all(orders, &[order]).expect("the line of orders is open");
    }
}

impl Wires for Emulator {
    fn put(&mut self, wire: Wire, bytes: &[u8]) -> Result<(), BoardFailure> {
        send_all(self.line(wire), bytes).map_err(|_| BoardFailure::Closed(wire))
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
        match recv(self.line(wire).as_raw_fd(), bytes, MsgFlags::MSG_DONTWAIT) {
            Ok(0) if !bytes.is_empty() => Err(BoardFailure::Closed(wire)),
            Ok(length) => Ok(length),
            Err(Errno::EAGAIN) => Ok(0),
            Err(_) => Err(BoardFailure::Closed(wire)),
        }
    }
}

/// Sends all bytes on a line, as soon as it takes them. A closed line is an error, no signal.
fn send_all(line: &OwnedFd, bytes: &[u8]) -> Result<(), Errno> {
    let mut rest = bytes;
    while !rest.is_empty() {
        match send(line.as_raw_fd(), &rest[..rest.len().min(PART)], MsgFlags::MSG_NOSIGNAL) {
            Ok(sent) => rest = &rest[sent..],
            Err(Errno::EINTR) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}
