//! TCP port to which senders connect: one has the control's line, others wait for it.
//!
//! A client that has begun a program keeps the line until its end, an alarm, or too long a silence while another waits.
//! A client that begins none loses it after seconds.

use std::collections::VecDeque;
use std::net::{SocketAddr, TcpListener, ToSocketAddrs};
use std::time::{Duration, Instant};

use arcfeed_control::dnc_port::DncPort;

use super::super::outcome::Failure;
use super::PERIOD;
use super::client::{Reason, TcpClient, is_quiet};
use crate::console::note;
use crate::job::SerialSettings;
use crate::port::clock::WallClock;

/// Most dropped clients in the log; a flood of them would fill it.
const REPORTS_MAX: usize = 20;

/// Limits of the port's clients.
#[derive(Clone, Copy, Debug)]
pub struct ClientLimits {
    /// Largest number of simultaneous connections.
    pub clients: usize,
    /// Longest silence within a program while another client waits for the line.
    pub idle_timeout: Duration,
    /// Other computers may connect.
    pub allow_remote: bool,
}

/// TCP port of the emulated control, with its clients.
pub struct TcpLine {
    name: String,
    listener: TcpListener,
    /// Settings of the control's line, for a port of RFC 2217.
    serial: Option<SerialSettings>,
    limits: ClientLimits,
    clock: WallClock,
    active: Option<TcpClient>,
    waiting: VecDeque<TcpClient>,
    /// The active client, or the one before it, has begun a program for the present control.
    has_begun: bool,
    /// Characters on the line at the last check.
    on_wire: usize,
    checked_at: Instant,
    reports: usize,
}

impl TcpLine {
    /// Listens on an address and port: for plain bytes, or with `serial` for clients of RFC 2217.
    ///
    /// # Errors
    /// The address is none of this machine's, or in use, or open to other machines without permission.
    pub fn listen_on(address: &str, serial: Option<SerialSettings>, limits: ClientLimits) -> Result<Self, Failure> {
        let failed = |error: std::io::Error| {
            Failure::Machine(format!("{address}: {error}; give an address of this machine and a free port"))
        };
        let places: Vec<SocketAddr> = address.to_socket_addrs().map_err(failed)?.collect();
        if let Some(place) = places.iter().find(|place| !limits.allow_remote && !place.ip().is_loopback()) {
            return Err(Failure::Usage(format!(
                "{address}: other machines can connect to {}, and nothing asks them who they are; listen on 127.0.0.1, or \
                 add --allow-remote",
                place.ip()
            )));
        }
        let listen = || {
            let listener = TcpListener::bind(&places[..])?;
            listener.set_nonblocking(true)?;
            Ok((listener.local_addr()?, listener))
        };
        let (bound, listener) = listen().map_err(failed)?;
        let scheme = if serial.is_some() { "rfc2217" } else { "socket" };
        Ok(TcpLine {
            name: format!("{scheme}://{bound}"),
            listener,
            serial,
            limits,
            clock: WallClock::start(),
            active: None,
            waiting: VecDeque::new(),
            has_begun: false,
            on_wire: 0,
            checked_at: Instant::now(),
            reports: 0,
        })
    }

    /// Name that a sender opens.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Gives the line to a client for its next program; returns true if there is one.
    pub fn begin(&mut self) -> bool {
        self.has_begun = false;
        self.on_wire = 0;
        self.check_clients(true);
        if self.active.is_none() {
            let now = self.clock.now();
            let ready = self.waiting.iter().position(|client| client.is_ready(now));
            self.active = ready.and_then(|at| self.waiting.remove(at));
        }
        if let Some(client) = &mut self.active {
            client.begin();
        }
        self.active.is_some()
    }

    /// Whether a client has the line.
    pub fn has_sender(&self) -> bool {
        self.active.is_some()
    }

    /// Whether the client is gone and no program had begun.
    pub fn is_abandoned(&self) -> bool {
        self.active.is_none() && !self.has_begun
    }

    /// Passes the client's bytes to the control; `control_waits` if the control needs more characters.
    pub fn feed(&mut self, port: &mut DncPort, control_waits: bool) {
        self.check_clients(control_waits);
        if let Some(client) = &mut self.active {
            let fed = client.feed(self.serial.as_ref(), port);
            self.has_begun |= client.has_begun();
            if let Err(reason) = fed {
                self.drop_active(&reason);
            }
        }
        self.on_wire = port.on_wire();
    }

    /// Whether a DC3 must reach the client itself, because the client has no serial port here that would stop at it.
    pub fn is_far(&self) -> bool {
        self.active.as_ref().is_none_or(TcpClient::is_far)
    }

    /// Sends a character of the control.
    pub fn write(&mut self, byte: u8) {
        if let Some(Err(reason)) = self.active.as_mut().map(|client| client.write(byte)) {
            self.drop_active(&reason);
        }
    }

    /// Reads and drops further bytes of the active client; returns their number.
    pub fn discard(&mut self) -> usize {
        self.active.as_mut().map_or(0, TcpClient::discard)
    }

    /// Closes the active connection: its program is over, though its sender may not know.
    pub fn hang_up(&mut self) {
        self.active = None;
    }

    /// Serves all clients, as often as the line is polled.
    fn check_clients(&mut self, control_waits: bool) {
        let now = self.clock.now();
        if let Some(client) = &mut self.active {
            client.exchange(now);
            if client.is_gone(self.on_wire) {
                self.active = None;
            }
        }
        if self.checked_at.elapsed() < PERIOD {
            return;
        }
        self.checked_at = Instant::now();
        self.accept();
        for _ in 0..self.waiting.len() {
            let Some(mut client) = self.waiting.pop_front() else { break };
            match client.check_waiting(now) {
                Ok(()) => self.waiting.push_back(client),
                Err(None) => {}
                Err(Some(reason)) => self.report(&client.name, &reason),
            }
        }
        let is_wanted = self.waiting.iter().any(|client| client.is_ready(now));
        let idle = self.active.as_ref().filter(|_| is_wanted);
        if let Some(reason) = idle.and_then(|client| client.idle_reason(control_waits, self.limits.idle_timeout)) {
            self.drop_active(&reason);
        }
    }

    /// Accepts new clients as long as there is room; the others wait in the system's queue. A failure to accept a
    /// client is no fault of the port.
    fn accept(&mut self) {
        while self.waiting.len() + usize::from(self.active.is_some()) < self.limits.clients {
            let client = match self.listener.accept() {
                Ok((stream, place)) => TcpClient::new(stream, place.to_string(), self.serial.as_ref()),
                Err(error) => Err(error),
            };
            match client {
                Ok(client) => self.waiting.push_back(client),
                Err(error) if is_quiet(error.kind()) => return,
                Err(error) => return self.report("a client", &error.to_string()),
            }
        }
    }

    fn drop_active(&mut self, reason: &Reason) {
        if let Some(client) = self.active.take() {
            self.report(&client.name, reason);
        }
    }

    fn report(&mut self, client: &str, reason: &str) {
        self.reports += 1;
        match self.reports {
            ..REPORTS_MAX => note(format_args!("{client} dropped: {reason}")),
            REPORTS_MAX => {
                note(format_args!("{client} dropped: {reason}; further clients are dropped without a message"));
            }
            _ => {}
        }
    }
}
