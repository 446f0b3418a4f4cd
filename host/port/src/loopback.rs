//! `loop://`: a queue in memory; bytes written to the port can be read from it again, in order.

use std::collections::VecDeque;
use std::time::SystemTime;

use arcfeed_units::Micros;

use super::clock::WallClock;
use super::log::{Level, Log};
use super::{Port, PortError};

/// Capacity of the queue in bytes, the same as pyserial's.
pub const CAPACITY: usize = 4_096;

/// Port that receives what it sends (`loop://`).
#[derive(Debug)]
pub struct Loopback {
    held: VecDeque<u8>,
    clock: WallClock,
}

impl Loopback {
    /// Port with an empty queue. `logging` is the level from which messages are printed; `None`: no messages.
    pub fn open(logging: Option<Level>) -> Self {
        Log::new("loop", logging).say(Level::Debug, format_args!("enabled logging"));
        Loopback { held: VecDeque::with_capacity(CAPACITY), clock: WallClock::start() }
    }
}

impl Port for Loopback {
    fn now(&self) -> Micros {
        self.clock.now()
    }

    fn opened(&self) -> Option<SystemTime> {
        Some(self.clock.started())
    }

    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        let len = buffer.len().min(self.held.len());
        for (slot, byte) in buffer.iter_mut().zip(self.held.drain(..len)) {
            *slot = byte;
        }
        Ok(len)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<usize, PortError> {
        let len = bytes.len().min(CAPACITY - self.held.len());
        self.held.extend(&bytes[..len]);
        Ok(len)
    }

    fn wait(&mut self, deadline: Micros) {
        self.clock.wait(deadline);
    }
}
