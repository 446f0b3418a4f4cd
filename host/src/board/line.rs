//! Link to a feed board over a port: sends and receives messages.

use std::hash::{BuildHasher, RandomState};

use arcfeed_link::frame::ENCODED_MAX;
use arcfeed_link::link::{Link, LinkState, SendError};
use arcfeed_link::message::field::PAYLOAD_MAX;
use arcfeed_link::message::{Message, link_settings};
use arcfeed_link::settings::{LinkSettings, Role};
use arcfeed_units::{Micros, Span};

use crate::job::{Parity, SerialSettings};
use crate::port::open::open;
use crate::port::url::{Base, PortUrl};
use crate::port::{Port, PortError};

/// Default baud rate of a board link.
pub const BAUDRATE: u32 = 115_200;

/// Longest permitted time between two calls of [`BoardLine::turn`].
pub const TURN_MAX: Micros = Micros::from_ms(20);

/// Host's end of the link to a feed board, with its port.
pub struct BoardLine<'p> {
    port: Box<dyn Port + 'p>,
    link: Link,
    /// Frame that the port has accepted only in part, and how many bytes of it.
    frame: [u8; ENCODED_MAX],
    taken: usize,
    len: usize,
    /// Count of messages with an unknown kind.
    unknown: u32,
}

/// Port settings of a board link. Frames contain every byte value, so XON/XOFF must be off.
fn settings(baudrate: u32) -> SerialSettings {
    SerialSettings {
        baudrate,
        bytesize: 8,
        parity: Parity::None,
        stopbits: 1,
        xonxoff: false,
        rtscts: false,
        write_timeout: None,
        exclusive: true,
    }
}

impl BoardLine<'static> {
    /// Opens a port of this computer and starts the handshake with the board.
    ///
    /// # Errors
    /// The port cannot be opened.
    pub fn open(url: &PortUrl, baudrate: u32) -> Result<Self, PortError> {
        let is_paced = matches!(url.base, Base::Native(_) | Base::Hwgrep(_) | Base::Rfc2217(..));
        BoardLine::new(open(url, &settings(baudrate))?, if is_paced { baudrate } else { 0 })
    }
}

impl<'p> BoardLine<'p> {
    /// Starts the handshake with the board on an open port. `bits_per_s` is the rate of the port, 0 if nothing limits
    /// it.
    ///
    /// # Errors
    /// The rate of the port is too low for the link.
    pub fn new(port: Box<dyn Port + 'p>, bits_per_s: u32) -> Result<Self, PortError> {
        // A new session number at each start.
        BoardLine::of_session(port, bits_per_s, RandomState::new().hash_one(std::process::id()) as u32)
    }

    /// Link to a board with this session number: for a simulated board, whose runs are to be repeatable to the byte.
    ///
    /// # Errors
    /// As [`BoardLine::new`].
    pub fn of_session(port: Box<dyn Port + 'p>, bits_per_s: u32, session: u32) -> Result<Self, PortError> {
        let ahead = Span::from(TURN_MAX);
        let settings = LinkSettings { bits_per_s, ahead, ..link_settings(Role::Host) };
        let link = Link::new(settings, session).map_err(|error| {
            PortError::in_words("board link", format!("{bits_per_s} bit/s is too slow for a board: {error:?}"))
        })?;
        Ok(BoardLine { port, link, frame: [0; ENCODED_MAX], taken: 0, len: 0, unknown: 0 })
    }

    /// Receives the messages that have arrived, calls `take` with each, then sends the frames that are due. Does not
    /// wait; must be called at least every [`TURN_MAX`].
    ///
    /// # Errors
    /// The port can no longer be used.
    pub fn turn(&mut self, take: &mut dyn FnMut(Message)) -> Result<(), PortError> {
        let mut incoming = [0; 256];
        loop {
            let len = self.port.read(&mut incoming)?;
            let now = self.port.now();
            let unknown = &mut self.unknown;
            self.link.on_bytes(now, &incoming[..len], &mut |received| match Message::decode(
                received.kind,
                received.payload,
            ) {
                Ok(message) => take(message),
                Err(_) => *unknown += 1,
            });
            if len < incoming.len() {
                break;
            }
        }
        self.send_due()
    }

    /// Sends the frames that are due now.
    ///
    /// # Errors
    /// The port can no longer be used.
    pub fn send_due(&mut self) -> Result<(), PortError> {
        loop {
            if self.taken == self.len {
                (self.taken, self.len) = (0, self.link.poll_transmit(self.port.now(), &mut self.frame));
            }
            if self.len == 0 {
                return Ok(());
            }
            let taken = self.port.write(&self.frame[self.taken..self.len])?;
            self.taken += taken;
            if taken == 0 {
                return Ok(());
            }
        }
    }

    /// Queues a message, which the link delivers once and in order.
    ///
    /// # Errors
    /// The queue is full, or the link is down.
    pub fn send(&mut self, message: &Message) -> Result<(), SendError> {
        let mut payload = [0; PAYLOAD_MAX];
        let len = message.encode(&mut payload).unwrap_or_else(|_| unreachable!("every message fits"));
        self.link.send(message.kind(), &payload[..len])
    }

    /// Waits until the link must be served again.
    pub fn wait(&mut self) {
        let now = self.port.now();
        let latest = now.after(TURN_MAX);
        let due = self.link.poll_at(now).filter(|_| self.taken == self.len);
        self.port.wait(due.map_or(latest, |at| at.min(latest)));
    }

    /// Closes the link.
    ///
    /// # Errors
    /// The port can no longer be used.
    pub fn close(mut self) -> Result<(), PortError> {
        self.link.close();
        self.send_due()
    }

    /// State machine of the link.
    pub fn link(&self) -> &Link {
        &self.link
    }

    /// Whether the handshake has succeeded and the link has not been lost.
    pub fn is_up(&self) -> bool {
        self.link.state() == LinkState::Up
    }

    /// Present time of the port's clock.
    pub fn now(&self) -> Micros {
        self.port.now()
    }

    /// Number of received messages of a kind that this host does not know.
    pub fn unknown(&self) -> u32 {
        self.unknown
    }
}
