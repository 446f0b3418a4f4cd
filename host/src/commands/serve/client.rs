//! Client of the TCP port: plain bytes, or RFC 2217 with a serial port of its own. Every queue is bounded, and the
//! control receives nothing from a client before it has begun a program.

use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use arcfeed_control::dnc_port::DncPort;
use arcfeed_units::{Micros, US_PER_MS, US_PER_S};

use super::program_start::{ByteHandling, ProgramStart};
use crate::job::SerialSettings;
use crate::port::rfc2217::server::{Flow, Server};

/// Most characters of a server on the line at once: as many as a control accepts after DC3.
const FIFO_MAX: usize = 10;
/// Number of held characters from which a server reads no more: its client waits.
const HELD_MAX: usize = 4_096;
/// Most characters on the line: a client may write a whole program at once before it can see DC3.
const WIRE_MAX: usize = 1 << 20;
/// Most characters for a client that reads none.
const UNSENT_MAX: usize = 1 << 16;
/// Number of unread answers from which a client is not read.
const ANSWERS_MAX: usize = 4_096;
/// Most bytes read at once from a client of RFC 2217.
const EXCHANGE_MAX: usize = 1_024;
/// Longest time in which a client of RFC 2217 must request its port.
const NEGOTIATION_MAX: Duration = Duration::from_secs(2);
/// Longest time before a client with the port begins a program, while another waits.
const BEGIN_MAX: Duration = Duration::from_secs(5);

/// Reason, in words, why a client is disconnected.
pub type Reason = String;

/// TCP connection of a client that sends a program.
pub struct TcpClient {
    /// Address of the client, for messages.
    pub name: String,
    stream: TcpStream,
    server: Option<Server>,
    program: ProgramStart,
    /// Bytes that the connection has not accepted yet.
    outgoing: Vec<u8>,
    /// Time at which it connected, was given the port, last accepted a character of the control or sent one of a
    /// program.
    active_at: Instant,
    /// The client has hung up; characters in its port still go out.
    is_over: bool,
}

impl TcpClient {
    /// Client that has just connected.
    ///
    /// # Errors
    /// The client is gone already.
    pub fn new(stream: TcpStream, name: String, serial: Option<&SerialSettings>) -> std::io::Result<Self> {
        stream.set_nonblocking(true)?;
        stream.set_nodelay(true)?;
        Ok(TcpClient {
            name,
            stream,
            server: serial.map(Server::new),
            program: ProgramStart::default(),
            outgoing: Vec::new(),
            active_at: Instant::now(),
            is_over: false,
        })
    }

    /// Whether the client can be given the control's line: with plain bytes at once, with RFC 2217 after its requests.
    pub fn is_ready(&self, now: Micros) -> bool {
        self.server.as_ref().is_none_or(|server| server.is_open(now))
    }

    /// Serves a client that waits for the port. `Err` if it will never be given the port: with a reason, or without
    /// one if it has hung up.
    pub fn check_waiting(&mut self, now: Micros) -> Result<(), Option<Reason>> {
        if self.server.is_some() {
            self.exchange(now);
        } else {
            let mut first = [0; 64];
            match self.stream.peek(&mut first) {
                Ok(len @ 1..) => self.program.clone().check(&first[..len])?,
                Err(error) if is_quiet(error.kind()) => {}
                Ok(_) | Err(_) => self.is_over = true,
            }
        }
        let Some(server) = &self.server else { return if self.is_over { Err(None) } else { Ok(()) } };
        match () {
            // A client that has hung up after a short program still has characters to be read.
            () if self.is_over && !(server.has_asked() && server.waiting() > 0) => Err(None),
            () if !server.has_asked() && server.waiting() > 0 => {
                Err(Some("no RFC 2217 client: it sends data first".into()))
            }
            () if !server.has_asked() && self.active_at.elapsed() > NEGOTIATION_MAX => {
                Err(Some(format!("no RFC 2217 client: nothing asked in {} s", NEGOTIATION_MAX.as_secs())))
            }
            () => Ok(()),
        }
    }

    /// Gives the client the control's line for its next program.
    pub fn begin(&mut self) {
        self.program.expect_next();
        self.active_at = Instant::now();
    }

    /// Whether the client has begun a program since it got the line.
    pub fn has_begun(&self) -> bool {
        self.program.has_begun()
    }

    /// Reason why this client must give the line to another one that waits; `None` if it may keep it.
    pub fn idle_reason(&self, control_waits: bool, idle_timeout: Duration) -> Option<Reason> {
        let idle = self.active_at.elapsed();
        if self.has_begun() {
            let message = || format!("no character in {} s (--idle-timeout), another client waits", idle.as_secs());
            return (control_waits && idle > idle_timeout).then(message);
        }
        (idle > BEGIN_MAX).then(|| format!("no program begun in {} s, another client waits", idle.as_secs()))
    }

    /// Passes the client's bytes to the control: plain bytes as they arrive, RFC 2217 data at the rate of the
    /// client's port.
    pub fn feed(&mut self, serial: Option<&SerialSettings>, port: &mut DncPort) -> Result<(), Reason> {
        if let Some(serial) = serial {
            return self.feed_from_server(serial, port);
        }
        let (mut buffer, mut taken) = ([0; 256], 0);
        while port.on_wire() < WIRE_MAX && taken < WIRE_MAX {
            let len = self.receive(&mut buffer);
            if len == 0 {
                break;
            }
            taken += len;
            for byte in &buffer[..len] {
                match self.program.on_byte(*byte) {
                    ByteHandling::Pass => port.on_bytes(&[*byte]),
                    ByteHandling::Discard => {}
                    ByteHandling::Refuse(reason) => return Err(reason),
                }
            }
        }
        Ok(())
    }

    fn feed_from_server(&mut self, serial: &SerialSettings, port: &mut DncPort) -> Result<(), Reason> {
        let Some(server) = &mut self.server else { return Ok(()) };
        let breaks = server.take_breaks();
        if self.program.has_begun() {
            (0..breaks).for_each(|_| port.on_framing_error());
        }
        let chars_per_ms = u64::from(serial.baudrate) / u64::from(serial.bits_per_char()) / (US_PER_S / US_PER_MS);
        let fifo =
            if server.settings().flow == Flow::None { WIRE_MAX } else { FIFO_MAX.min(2 + chars_per_ms as usize) };
        let is_understood = server.settings().is_understood_by(serial);
        while port.on_wire() < fifo {
            let Some(byte) = server.next_for_line() else { break };
            match self.program.on_byte(byte) {
                ByteHandling::Pass if is_understood => port.on_bytes(&[byte]),
                ByteHandling::Pass => port.on_framing_error(),
                ByteHandling::Discard => {}
                ByteHandling::Refuse(reason) => return Err(reason),
            }
        }
        Ok(())
    }

    /// Whether the control's DC3 must be sent to the client: it has no serial port here (RFC 2217) that would stop in
    /// its place.
    pub fn is_far(&self) -> bool {
        self.server.as_ref().is_none_or(|server| server.settings().flow != Flow::XonXoff)
    }

    /// Sends a character of the control; `Err` if the client reads none.
    pub fn write(&mut self, byte: u8) -> Result<(), Reason> {
        match &mut self.server {
            Some(server) => server.on_line(byte),
            None => self.outgoing.push(byte),
        }
        self.send();
        let unsent = self.unsent();
        if unsent == 0 {
            self.active_at = Instant::now();
        }
        (unsent <= UNSENT_MAX).then_some(()).ok_or_else(|| format!("it reads nothing: {unsent} characters wait for it"))
    }

    /// Whether the client has hung up and all its characters have been used; `on_wire` of them are still on the
    /// simulated line.
    pub fn is_gone(&self, on_wire: usize) -> bool {
        self.is_over && on_wire == 0 && self.server.as_ref().is_none_or(|server| server.waiting() == 0)
    }

    /// Reads and drops further bytes of a client; returns their number.
    pub fn discard(&mut self) -> usize {
        let mut buffer = [0; 256];
        self.receive(&mut buffer)
    }

    /// Handles the RFC 2217 requests of a client, and sends what is due.
    pub fn exchange(&mut self, now: Micros) {
        let (mut buffer, mut taken) = ([0; 256], 0);
        while self.server.as_ref().is_some_and(|server| server.waiting() < HELD_MAX)
            && self.unsent() < ANSWERS_MAX
            && taken < EXCHANGE_MAX
        {
            let len = self.receive(&mut buffer);
            let Some(server) = self.server.as_mut().filter(|_| len > 0) else { break };
            server.on_bytes(now, &buffer[..len]);
            taken += len;
        }
        self.send();
    }

    fn unsent(&self) -> usize {
        self.outgoing.len() + self.server.as_ref().map_or(0, Server::unsent)
    }

    /// Reads from the connection; returns 0 if there is nothing.
    fn receive(&mut self, buffer: &mut [u8]) -> usize {
        match self.stream.read(buffer) {
            Ok(len @ 1..) => {
                if self.has_begun() {
                    self.active_at = Instant::now();
                }
                return len;
            }
            Err(error) if is_quiet(error.kind()) => {}
            Ok(_) | Err(_) => self.is_over = true,
        }
        0
    }

    fn send(&mut self) {
        if let Some(server) = &mut self.server {
            server.poll_transmit(&mut self.outgoing);
        }
        if self.outgoing.is_empty() {
            return;
        }
        match self.stream.write(&self.outgoing) {
            Ok(len) => drop(self.outgoing.drain(..len)),
            Err(error) if is_quiet(error.kind()) => {}
            Err(_) => self.is_over = true,
        }
    }
}

/// Whether the error only means that no data are there at present.
pub fn is_quiet(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}
