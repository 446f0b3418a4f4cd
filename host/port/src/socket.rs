//! `socket://`: plain bytes over TCP to a port server, which sets its serial line itself.

use std::time::SystemTime;

use arcfeed_units::Micros;

use super::clock::WallClock;
use super::log::{Level, Log};
use super::tcp::Tcp;
use super::url::Address;
use super::{Port, PortError};

/// Open TCP connection to a port server with plain bytes (`socket://`).
pub struct Socket {
    tcp: Tcp,
    clock: WallClock,
}

impl Socket {
    /// Connects to the server. `logging` is the level from which messages are printed; `None`: no messages.
    ///
    /// # Errors
    /// No server answers at this address.
    pub fn open(address: &Address, logging: Option<Level>) -> Result<Self, PortError> {
        let name = format!("socket://{}:{}", address.host, address.port);
        let tcp = Tcp::connect(address, &name)?;
        Log::new("socket", logging).say(Level::Info, format_args!("connected; line settings are the server's own"));
        Ok(Socket { tcp, clock: WallClock::start() })
    }
}

impl Port for Socket {
    fn now(&self) -> Micros {
        self.clock.now()
    }

    fn opened(&self) -> Option<SystemTime> {
        Some(self.clock.started())
    }

    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        self.tcp.read(buffer)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<usize, PortError> {
        self.tcp.write(bytes)
    }

    fn wait(&mut self, deadline: Micros) {
        self.clock.wait(deadline);
    }
}
