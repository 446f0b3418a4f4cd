//! Characters that the sender has handed out and the line has not taken yet.

use arcfeed_shared::units::Micros;

use super::super::outcome::Failure;
use crate::dnc::{CHUNK, Sender};
use crate::port::Port;

/// At most one chunk.
pub struct Outbox {
    held: [u8; CHUNK],
    len: usize,
    /// How long the line may take nothing.
    patience: Option<Micros>,
    stuck_since: Option<Micros>,
}

impl Outbox {
    /// An empty one.
    pub fn new(patience: Option<Micros>) -> Self {
        Outbox { held: [0; CHUNK], len: 0, patience, stuck_since: None }
    }

    /// Gets characters from the sender where it holds none, and puts them on the line.
    ///
    /// # Errors
    /// The line is gone, or has taken nothing for too long.
    pub fn pump(&mut self, port: &mut dyn Port, sender: &mut Sender) -> Result<(), Failure> {
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
        match self.patience {
            Some(patience) if port.now().since(since) >= patience => Err(Failure::Machine(format!(
                "the line has taken no characters for {} s: check cable and flow control, or raise write_timeout in \
                 [serial]",
                patience.to_s()
            ))),
            _ => Ok(()),
        }
    }

    /// Whether all is on the line.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
}
