//! `rfc2217://`: a serial port at a server on the network, whose settings the client makes through Telnet's
//! COM-PORT-OPTION (RFC 2217).

pub mod telnet;

mod com_port;

pub mod client;

pub mod server;

use std::time::{Duration, SystemTime};

use arcfeed_units::Micros;

use super::clock::WallClock;
use super::log::{Level, Log};
use super::tcp::Tcp;
use super::url::{Address, Rfc2217Options};
use super::{Port, PortError};
use crate::settings::SerialSettings;
use client::{RequestedLine, Rfc2217Client};

/// Polling period of the connection during the negotiation.
const PERIOD: Duration = Duration::from_millis(2);

/// Serial port of an RFC 2217 server, opened over the network.
pub struct Rfc2217 {
    tcp: Tcp,
    name: String,
    client: Rfc2217Client,
    clock: WallClock,
    log: Log,
    modem_state: Option<u8>,
    /// Encoded bytes that the connection has not accepted yet.
    outgoing: Vec<u8>,
}

impl Rfc2217 {
    /// Connects, and negotiates the settings of the line with the server.
    ///
    /// # Errors
    /// No server answers there, or it does not speak RFC 2217, is too slow, or refuses a setting.
    pub fn open(address: &Address, options: &Rfc2217Options, settings: &SerialSettings) -> Result<Self, PortError> {
        let name = format!("rfc2217://{}:{}", address.host, address.port);
        let tcp = Tcp::connect(address, &name)?;
        let clock = WallClock::start();
        let client = Rfc2217Client::new(&RequestedLine::new(settings), options, clock.now());
        let log = Log::new("rfc2217", options.logging);
        let mut port = Rfc2217 { tcp, name, client, clock, log, modem_state: None, outgoing: Vec::new() };
        while !port.client.is_open() {
            port.exchange()?;
            std::thread::sleep(PERIOD);
        }
        port.log.say(Level::Info, format_args!("settings agreed on after {} ms", port.now().to_s() * 1e3));
        Ok(port)
    }

    /// Receives and sends what is due.
    fn exchange(&mut self) -> Result<(), PortError> {
        let mut arrived = [0; 1_024];
        loop {
            let len = self.tcp.read(&mut arrived)?;
            self.client.on_bytes(self.clock.now(), &arrived[..len]);
            if len < arrived.len() {
                break;
            }
        }
        let checked = self.client.check(self.clock.now());
        checked.map_err(|refusal| PortError::in_words(&self.name, refusal.to_string()))?;
        self.client.poll_transmit(&mut self.outgoing);
        self.send()?;
        if self.client.modem_state() != self.modem_state {
            self.modem_state = self.client.modem_state();
            self.log.say(Level::Info, format_args!("modem lines: {:02x}", self.modem_state.unwrap_or_default()));
        }
        Ok(())
    }

    fn send(&mut self) -> Result<(), PortError> {
        while !self.outgoing.is_empty() {
            match self.tcp.write(&self.outgoing)? {
                0 => break,
                len => drop(self.outgoing.drain(..len)),
            }
        }
        Ok(())
    }
}

impl Port for Rfc2217 {
    fn now(&self) -> Micros {
        self.clock.now()
    }

    fn opened(&self) -> Option<SystemTime> {
        Some(self.clock.started())
    }

    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        self.exchange()?;
        Ok(self.client.take_data(buffer))
    }

    fn write(&mut self, bytes: &[u8]) -> Result<usize, PortError> {
        self.exchange()?;
        // The queue must not grow: the sender relies on the line to hold it back.
        if self.client.is_suspended() || !self.outgoing.is_empty() {
            return Ok(0);
        }
        telnet::escape(bytes, &mut self.outgoing);
        self.send()?;
        Ok(bytes.len())
    }

    fn out_waiting(&mut self) -> Result<usize, PortError> {
        self.exchange()?;
        Ok(self.outgoing.len())
    }

    fn wait(&mut self, deadline: Micros) {
        self.clock.wait(deadline);
    }
}

/// Line of the tests: 9600 7E2.
#[cfg(test)]
fn seven_even() -> SerialSettings {
    use crate::settings::Parity;
    SerialSettings {
        baudrate: 9_600,
        bytesize: 7,
        parity: Parity::Even,
        stopbits: 2,
        xonxoff: true,
        rtscts: false,
        write_timeout: None,
        exclusive: true,
    }
}
