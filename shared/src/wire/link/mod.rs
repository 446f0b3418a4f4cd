//! One end of the link. Both ends are the same; only the role differs.
//!
//! `receive.rs` is what a frame does, `transmit.rs` is what goes out and when; states and their arrows are in
//! [`LinkState`].

mod receive;

mod transmit;

use super::clock::PeerClock;
use super::counters::Counters;
use super::deframer::Deframer;
use super::latest::{Newest, Offers, deadline};
use super::pace::Pace;
use super::reliable::{Inbox, Outbox};
use super::rto::Rto;
use super::session::Peer;
use super::settings::{LinkSettings, SettingsError};
pub use super::state::{Delivery, LinkState, Loss, Received, Refusal, SendError};
use crate::units::{Micros, Span};

/// One end of a link: `WINDOW` reliable messages on their way at most, `KINDS` kinds of latest-wins values.
#[derive(Debug)]
pub struct Link<const WINDOW: usize = 16, const KINDS: usize = 8> {
    deframer: Deframer,
    end: End<WINDOW, KINDS>,
}

/// All of a link but the frame that is coming in.
#[derive(Debug)]
struct End<const WINDOW: usize, const KINDS: usize> {
    settings: LinkSettings,
    session: u32,
    state: LinkState,
    counters: Counters,
    peer: Option<Peer>,
    /// The salt of the peer's frames in the session that is over.
    salt_before: Option<u32>,
    /// When the latest valid frame came in, by its time stamp, and that.
    heard: Option<(Micros, u32)>,
    bad_in_a_row: u32,
    clock: PeerClock,
    rto: Rto,
    pace: Pace,
    outbox: Outbox<WINDOW>,
    inbox: Inbox,
    offers: Offers<KINDS>,
    newest: Newest,
    due: Due,
    is_ready: bool,
}

/// Not due until something happens.
const NEVER: Micros = Micros(u64::MAX);

/// How many sequence numbers there are.
const SEQUENCES: usize = 1 << 16;

/// What is to go out.
#[derive(Clone, Copy, Debug)]
struct Due {
    hello: Micros,
    heartbeat: Micros,
    ack: Option<Micros>,
    nak: bool,
    bye: bool,
    /// A delimiter before the next frame: what came before it may be in pieces.
    delimiter: bool,
    /// It is a reliable message's turn, the last frame having carried a latest-wins value.
    reliable: bool,
    latest_seq: u16,
}

impl Due {
    const FIRST: Due = Due {
        hello: Micros(0),
        heartbeat: Micros(0),
        ack: None,
        nak: false,
        bye: false,
        delimiter: true,
        reliable: false,
        latest_seq: 0,
    };
}

impl<const WINDOW: usize, const KINDS: usize> Link<WINDOW, KINDS> {
    /// An end that greets. `session` tells this start from every other one: random, or a count of starts. 0 stands for no
    /// session, and `u32::MAX` is taken in its place.
    ///
    /// # Errors
    /// Settings that cannot work.
    pub fn new(settings: LinkSettings, session: u32) -> Result<Self, SettingsError> {
        const { assert!(WINDOW > 0 && WINDOW < SEQUENCES / 2) };
        settings.check()?;
        let end = End {
            settings,
            session: named(session),
            state: LinkState::Greeting,
            counters: Counters::default(),
            peer: None,
            salt_before: None,
            heard: None,
            bad_in_a_row: 0,
            clock: PeerClock::new(settings.drift_max_ppm),
            rto: new_rto(&settings),
            pace: Pace::new(settings.bits_per_s, settings.ahead),
            outbox: Outbox::new(),
            inbox: Inbox::default(),
            offers: Offers::new(),
            newest: Newest::default(),
            due: Due::FIRST,
            is_ready: true,
        };
        Ok(Link { deframer: Deframer::new(), end })
    }

    /// Begins anew under another session: nothing of the old one is accepted or sent any more. The same one again becomes
    /// the one after it. Counters go on.
    pub fn restart(&mut self, session: u32) {
        let end = &mut self.end;
        end.salt_before = end.peer.map(|peer| peer.salt_in).or(end.salt_before);
        end.session = if named(session) == end.session { named(session.wrapping_add(1)) } else { named(session) };
        end.state = LinkState::Greeting;
        end.due = Due::FIRST;
        end.forget_peer();
    }

    /// Takes bytes off the line; hands each message to `take`, in order.
    pub fn on_bytes(&mut self, now: Micros, bytes: &[u8], take: &mut dyn FnMut(Received<'_>)) {
        let counters = &mut self.end.counters;
        counters.bytes_in = counters.bytes_in.wrapping_add(bytes.len() as u32);
        for byte in bytes {
            match self.deframer.push(*byte) {
                Some(Ok(frame)) => self.end.on_frame(now, &frame, take),
                Some(Err(_)) => self.end.on_framing_error(),
                None => {}
            }
        }
        self.end.watch(now);
    }

    /// The next frame to put on the line, if one is due: its length in `out`, which must hold
    /// [`super::frame::ENCODED_MAX`] bytes; 0 if there is none. Call until it answers 0.
    pub fn poll_transmit(&mut self, now: Micros, out: &mut [u8]) -> usize {
        self.end.watch(now);
        self.end.transmit(now, out)
    }

    /// When to call [`Self::poll_transmit`] next, if nothing comes in and nothing is sent before; `None` if never. Not before `now`.
    pub fn poll_at(&self, now: Micros) -> Option<Micros> {
        self.end.poll_at().map(|at| at.max(now))
    }

    /// Sends a message once and in order.
    ///
    /// # Errors
    /// Not taken, and why.
    pub fn send(&mut self, kind: u8, payload: &[u8]) -> Result<(), SendError> {
        self.end.must_be_up()?;
        self.end.outbox.push(kind, payload)
    }

    /// Sends a value that is worth nothing once `ttl` is over; it replaces the one of its kind that has not gone out.
    ///
    /// # Errors
    /// Not taken, and why.
    pub fn offer(&mut self, kind: u8, now: Micros, ttl: Span, payload: &[u8]) -> Result<(), SendError> {
        self.end.must_be_up()?;
        let is_replaced = self.end.offers.put(kind, deadline(now, ttl), payload)?;
        self.end.counters.replaced = self.end.counters.replaced.wrapping_add(u32::from(is_replaced));
        Ok(())
    }

    /// Whether reliable messages are taken (from the start, yes): while not, the peer holds them back. None is lost and none acknowledged
    /// unread.
    pub fn set_ready(&mut self, is_ready: bool) {
        if is_ready != self.end.is_ready {
            self.end.is_ready = is_ready;
            // Said at once: with what is expected next, where it takes up again.
            self.end.due.ack = Some(Micros(0));
        }
    }

    /// Says goodbye: one last frame, then nothing.
    pub fn close(&mut self) {
        let was_up = self.end.state == LinkState::Up;
        self.end.lose(Loss::Closed);
        self.end.due.bye = was_up;
    }

    /// How many more reliable messages [`Self::send`] takes now.
    pub fn room(&self) -> usize {
        WINDOW.saturating_sub(self.end.outbox.len())
    }

    /// How many reliable messages the peer has not acknowledged.
    pub fn unacknowledged(&self) -> usize {
        self.end.outbox.len()
    }

    /// Whether the peer takes no reliable messages at present.
    pub fn is_peer_busy(&self) -> bool {
        self.end.outbox.is_peer_busy()
    }

    /// Where it stands, as of the last call that told the time.
    pub fn state(&self) -> LinkState {
        self.end.state
    }

    /// This end's session.
    pub fn session(&self) -> u32 {
        self.end.session
    }

    /// The peer's session, once it has greeted.
    pub fn peer_session(&self) -> Option<u32> {
        self.end.peer.map(|peer| peer.session)
    }

    /// What it is told.
    pub fn settings(&self) -> &LinkSettings {
        &self.end.settings
    }

    /// What it has seen and done.
    pub fn counters(&self) -> &Counters {
        &self.end.counters
    }

    /// The peer's clock.
    pub fn clock(&self) -> &PeerClock {
        &self.end.clock
    }

    /// Time since the latest valid frame of the peer, copies not counted; the longest there is if there was none.
    pub fn age(&self, now: Micros) -> Span {
        self.end.heard.map_or(Span(u32::MAX), |(at, _)| now.since(at).into())
    }
}

impl<const WINDOW: usize, const KINDS: usize> End<WINDOW, KINDS> {
    fn must_be_up(&self) -> Result<(), SendError> {
        if self.state == LinkState::Up { Ok(()) } else { Err(SendError::Down) }
    }

    /// Whether what must not happen has: silence, or nothing acknowledged.
    fn watch(&mut self, now: Micros) {
        if self.state != LinkState::Up {
            return;
        }
        let is_over = |since: Micros, limit: Span| now.since(since) >= Micros(u64::from(limit.0));
        if self.heard.is_none_or(|(at, _)| is_over(at, self.settings.lost_after)) {
            self.lose(Loss::Silence);
        } else if self.outbox.waiting_since().is_some_and(|since| is_over(since, self.settings.unacknowledged_after)) {
            self.lose(Loss::Unacknowledged);
        }
    }

    fn lose(&mut self, loss: Loss) {
        if !matches!(self.state, LinkState::Lost(_)) {
            self.state = LinkState::Lost(loss);
        }
    }

    /// All that belongs to one peer and one session.
    fn forget_peer(&mut self) {
        self.peer = None;
        self.heard = None;
        self.bad_in_a_row = 0;
        self.clock = PeerClock::new(self.settings.drift_max_ppm);
        self.rto = new_rto(&self.settings);
        self.outbox = Outbox::new();
        self.inbox = Inbox::default();
        self.offers = Offers::new();
        self.newest = Newest::default();
    }
}

fn new_rto(settings: &LinkSettings) -> Rto {
    let frame = settings.longest_frame();
    Rto::new(settings.rto_floor, settings.rto_ceiling, frame.longer_by(frame))
}

/// A session that is not the one that stands for none.
const fn named(session: u32) -> u32 {
    if session == 0 { u32::MAX } else { session }
}

#[cfg(test)]
mod tests;
