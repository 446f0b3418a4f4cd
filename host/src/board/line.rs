//! A link on a port: messages in, messages out.

use std::hash::{BuildHasher, RandomState};

use arcfeed_shared::units::{Micros, Span};
use arcfeed_shared::wire::frame::ENCODED_MAX;
use arcfeed_shared::wire::link::{Link, LinkState, SendError};
use arcfeed_shared::wire::message::field::PAYLOAD_MAX;
use arcfeed_shared::wire::message::{Message, link_settings};
use arcfeed_shared::wire::settings::{LinkSettings, Role};

use crate::job::{Parity, SerialSettings};
use crate::port::open::open;
use crate::port::url::{Base, PortUrl};
use crate::port::{Port, PortError};

/// Of a board link, unless told otherwise.
pub const BAUDRATE: u32 = 115_200;

/// Longest time between two turns.
pub const TURN_MAX: Micros = Micros::from_ms(20);

/// The host's end of a link to a board.
pub struct Line<'p> {
    port: Box<dyn Port + 'p>,
    link: Link,
    /// A frame that the port has taken only in part, and how far.
    frame: [u8; ENCODED_MAX],
    taken: usize,
    len: usize,
    /// Messages of the board that are none of ours.
    unknown: u32,
}

/// How a port is worked for a board link: frames hold every byte there is, so nobody may take some for XON and XOFF.
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

impl Line<'static> {
    /// An end that greets on a port of this machine.
    ///
    /// # Errors
    /// The port cannot be opened.
    pub fn open(url: &PortUrl, baudrate: u32) -> Result<Self, PortError> {
        let is_paced = matches!(url.base, Base::Native(_) | Base::Hwgrep(_) | Base::Rfc2217(..));
        Line::new(open(url, &settings(baudrate))?, if is_paced { baudrate } else { 0 })
    }
}

impl<'p> Line<'p> {
    /// An end that greets. `bits_per_s` is what the port carries, 0 where nothing paces it.
    ///
    /// # Errors
    /// So slow a line that no link can work on it.
    pub fn new(port: Box<dyn Port + 'p>, bits_per_s: u32) -> Result<Self, PortError> {
        let ahead = Span::from(TURN_MAX);
        let settings = LinkSettings { bits_per_s, ahead, ..link_settings(Role::Host) };
        // Another one with each start.
        let session = RandomState::new().hash_one(std::process::id()) as u32;
        let link = Link::new(settings, session).map_err(|error| {
            PortError::in_words("board link", format!("{bits_per_s} bit/s is too slow for a board: {error:?}"))
        })?;
        Ok(Line { port, link, frame: [0; ENCODED_MAX], taken: 0, len: 0, unknown: 0 })
    }

    /// Takes what has come, and puts out what is due.
    ///
    /// # Errors
    /// The port is gone.
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
        self.put_out()
    }

    /// Puts out what is due.
    ///
    /// # Errors
    /// The port is gone.
    pub fn put_out(&mut self) -> Result<(), PortError> {
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

    /// Sends a message, each once and in order.
    ///
    /// # Errors
    /// No room, or no link.
    pub fn send(&mut self, message: &Message) -> Result<(), SendError> {
        let mut payload = [0; PAYLOAD_MAX];
        let len = message.encode(&mut payload).unwrap_or_else(|_| unreachable!("every message fits"));
        self.link.send(message.kind(), &payload[..len])
    }

    /// Lets time pass until the next turn.
    pub fn wait(&mut self) {
        let now = self.port.now();
        let latest = now.after(TURN_MAX);
        let due = self.link.poll_at(now).filter(|_| self.taken == self.len);
        self.port.wait(due.map_or(latest, |at| at.min(latest)));
    }

    /// Says goodbye.
    ///
    /// # Errors
    /// The port is gone.
    pub fn close(mut self) -> Result<(), PortError> {
        self.link.close();
        self.put_out()
    }

    /// The link.
    pub fn link(&self) -> &Link {
        &self.link
    }

    /// Whether both ends have found each other.
    pub fn is_up(&self) -> bool {
        self.link.state() == LinkState::Up
    }

    /// By the port's clock.
    pub fn now(&self) -> Micros {
        self.port.now()
    }

    /// Messages of the board that are none of ours.
    pub fn unknown(&self) -> u32 {
        self.unknown
    }
}
