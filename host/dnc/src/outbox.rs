//! Buffer for characters that the sender has handed out and the line has not accepted yet, with one pass of the loop
//! that serves both.

use arcfeed_port::{Port, PortError};
use arcfeed_units::Micros;

use super::sender::{CHUNK, Sender, State};

/// Failure of the line: the port is gone, or it accepts no characters.
#[derive(Debug, thiserror::Error)]
pub enum LineError {
    /// Reading from or writing to the port failed, for instance because an adapter was unplugged.
    #[error(transparent)]
    Port(#[from] PortError),
    /// The line has accepted no character for this time, which is the configured limit.
    #[error(
        "the line has taken no characters for {} s: check cable and flow control, or raise write_timeout in [serial]",
        .0.to_s()
    )]
    Stuck(Micros),
}

/// Buffer between sender and line, for characters that the line has not accepted yet: at most one chunk (ten
/// characters).
#[derive(Debug)]
pub struct Outbox {
    held: [u8; CHUNK],
    len: usize,
    /// Longest time in which the line may accept nothing.
    timeout: Option<Micros>,
    stuck_since: Option<Micros>,
}

impl Outbox {
    /// Empty buffer. `timeout` is the longest time for which the line may accept nothing; `None`: no limit.
    pub fn new(timeout: Option<Micros>) -> Self {
        Outbox { held: [0; CHUNK], len: 0, timeout, stuck_since: None }
    }

    /// One pass of the send loop, without waiting: passes received characters to the sender, and the sender's
    /// characters to the line. Returns true once all characters have arrived at the control, which is computed from the
    /// line's rate.
    ///
    /// # Errors
    /// The port is gone, or has accepted nothing for the time-out.
    pub fn turn(&mut self, port: &mut dyn Port, sender: &mut Sender) -> Result<bool, LineError> {
        let mut incoming = [0; 64];
        loop {
            let len = port.read(&mut incoming)?;
            sender.on_bytes(port.now(), &incoming[..len]);
            if len < incoming.len() {
                break;
            }
        }
        self.pump(port, sender)?;
        let is_out = sender.state() == State::Sent && self.len == 0 && port.out_waiting()? == 0;
        Ok(is_out && port.now() >= sender.arrived_at())
    }

    fn pump(&mut self, port: &mut dyn Port, sender: &mut Sender) -> Result<(), LineError> {
        if self.len == 0 {
            self.len = sender.poll_transmit(port.now(), &mut self.held);
        }
        if self.len == 0 {
            return Ok(());
        }
        let taken = port.write(&self.held[..self.len])?;
        self.held.copy_within(taken..self.len, 0);
        self.len -= taken;
        if taken > 0 {
            self.stuck_since = None;
            return Ok(());
        }
        let since = *self.stuck_since.get_or_insert(port.now());
        match self.timeout {
            Some(timeout) if port.now().since(since) >= timeout => Err(LineError::Stuck(timeout)),
            _ => Ok(()),
        }
    }

    /// Number of characters that the sender has handed out and the line has not accepted.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether the line has accepted all characters that the sender has handed out.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
}
