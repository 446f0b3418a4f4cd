//! A sender that calls over TCP, one at a time: with bare bytes, or through RFC 2217 with a serial port of its own.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};

use arcfeed_hil_sim::control::dnc_port::DncPort;
use arcfeed_shared::units::{US_PER_MS, US_PER_S};

use super::super::outcome::Failure;
use crate::job::SerialSettings;
use crate::port::clock::WallClock;
use crate::port::rfc2217::server::{Flow, Server};

/// Most characters of a server on the line at once: as many as a control takes behind DC3.
const FIFO_MAX: usize = 10;
/// A server that holds as much reads no more: its client waits.
const HELD_MAX: usize = 4_096;

/// Where senders call.
pub struct Caller {
    name: String,
    listener: TcpListener,
    /// Of the control's line, for a port of RFC 2217.
    serial: Option<SerialSettings>,
    clock: WallClock,
    connection: Option<Connection>,
    /// Characters on the line, as last seen.
    on_wire: usize,
}

struct Connection {
    stream: TcpStream,
    server: Option<Server>,
    /// Not yet taken by the connection.
    outgoing: Vec<u8>,
    /// The client has hung up; what its port holds goes out all the same.
    is_over: bool,
}

impl Caller {
    /// Listens on an address and port: for bare bytes, or with `serial` for clients of RFC 2217.
    ///
    /// # Errors
    /// The address is none of this machine's, or taken.
    pub fn listen_on(address: &str, serial: Option<SerialSettings>) -> Result<Self, Failure> {
        let listen = || {
            let listener = TcpListener::bind(address)?;
            listener.set_nonblocking(true)?;
            Ok((listener.local_addr()?, listener))
        };
        let (bound, listener) = listen().map_err(|error: std::io::Error| {
            Failure::Machine(format!("{address}: {error}; give an address of this machine and a free port"))
        })?;
        let scheme = if serial.is_some() { "rfc2217" } else { "socket" };
        let name = format!("{scheme}://{bound}");
        Ok(Caller { name, listener, serial, clock: WallClock::start(), connection: None, on_wire: 0 })
    }

    /// What a sender opens.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether somebody is there who is ready to send; takes in who calls.
    ///
    /// # Errors
    /// The line is gone.
    pub fn has_sender(&mut self) -> Result<bool, Failure> {
        let failed = |error: std::io::Error| Failure::Machine(format!("{}: {error}", self.name));
        if self.connection.is_none() {
            match self.listener.accept() {
                Ok((stream, _)) => {
                    stream.set_nonblocking(true).and_then(|()| stream.set_nodelay(true)).map_err(failed)?;
                    let server = self.serial.as_ref().map(Server::new);
                    self.connection = Some(Connection { stream, server, outgoing: Vec::new(), is_over: false });
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                Err(error) => return Err(failed(error)),
            }
        }
        self.exchange();
        let now = self.clock.now();
        Ok(self
            .connection
            .as_ref()
            .is_some_and(|caller| caller.server.as_ref().is_none_or(|server| server.is_open(now))))
    }

    /// Gives the control what has been written: bare bytes all at once, those of a server as its port sends them.
    pub fn feed(&mut self, port: &mut DncPort) {
        self.exchange();
        match &self.serial {
            Some(serial) => self.feed_from_server(&serial.clone(), port),
            None => {
                let mut buffer = [0; 256];
                while let len @ 1.. = self.read(&mut buffer) {
                    port.on_bytes(&buffer[..len]);
                }
            }
        }
        self.on_wire = port.on_wire();
    }

    fn feed_from_server(&mut self, serial: &SerialSettings, port: &mut DncPort) {
        let Some(server) = self.connection.as_mut().and_then(|connection| connection.server.as_mut()) else { return };
        (0..server.take_breaks()).for_each(|_| port.on_framing_error());
        let chars_per_ms = u64::from(serial.baudrate) / u64::from(serial.bits_per_char()) / (US_PER_S / US_PER_MS);
        let fifo = FIFO_MAX.min(2 + chars_per_ms as usize);
        let is_understood = server.settings().is_understood_by(serial);
        while server.settings().flow == Flow::None || port.on_wire() < fifo {
            match server.next_for_line() {
                Some(byte) if is_understood => port.on_bytes(&[byte]),
                Some(_) => port.on_framing_error(),
                None => break,
            }
        }
    }

    /// Whether the sender, not a port of its own, has to obey DC3.
    pub fn is_far(&self) -> bool {
        let server = self.connection.as_ref().and_then(|caller| caller.server.as_ref());
        server.is_none_or(|server| server.settings().flow != Flow::XonXoff)
    }

    /// Takes a character of the control.
    pub fn write(&mut self, byte: u8) {
        let Some(connection) = &mut self.connection else { return };
        match &mut connection.server {
            Some(server) => server.on_line(byte),
            None => connection.outgoing.push(byte),
        }
        self.exchange();
    }

    /// Reads data; zero if none is there.
    pub fn read(&mut self, buffer: &mut [u8]) -> usize {
        match &mut self.connection {
            Some(Connection { server: Some(server), .. }) => {
                let mut len = 0;
                for (slot, byte) in buffer.iter_mut().zip(std::iter::from_fn(|| server.next_for_line())) {
                    *slot = byte;
                    len += 1;
                }
                len
            }
            Some(connection) => connection.receive(buffer),
            None => 0,
        }
    }

    /// Hears what the client of a server wants, and sends what is to be sent.
    fn exchange(&mut self) {
        let now = self.clock.now();
        let Some(connection) = &mut self.connection else { return };
        let mut buffer = [0; 256];
        while connection.server.as_ref().is_some_and(|server| server.waiting() < HELD_MAX) {
            let len = connection.receive(&mut buffer);
            let Some(server) = connection.server.as_mut().filter(|_| len > 0) else { break };
            server.on_bytes(now, &buffer[..len]);
        }
        connection.send();
        let has_sent_all = connection.server.as_ref().is_none_or(|server| server.waiting() == 0) && self.on_wire == 0;
        if connection.is_over && has_sent_all {
            self.connection = None;
        }
    }
}

impl Connection {
    /// What the connection has; zero if it has nothing.
    fn receive(&mut self, buffer: &mut [u8]) -> usize {
        match self.stream.read(buffer) {
            Ok(len @ 1..) => return len,
            Err(error) if is_quiet(error.kind()) => {}
            Ok(_) | Err(_) => self.is_over = true,
        }
        0
    }

    fn send(&mut self) {
        if let Some(server) = &mut self.server {
            server.poll_transmit(&mut self.outgoing);
        }
        match self.stream.write(&self.outgoing) {
            Ok(len) => drop(self.outgoing.drain(..len)),
            Err(error) if is_quiet(error.kind()) => {}
            Err(_) => self.is_over = true,
        }
    }
}

/// Nothing there now, and no fault.
pub fn is_quiet(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}
