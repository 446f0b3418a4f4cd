//! One end of the link between host and board. Both ends are identical except for their role.
//!
//! `receive.rs` handles received frames, `transmit.rs` schedules frames to send; [`LinkState`] has the states and
//! transitions.

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
use arcfeed_units::{Micros, Span};

/// One end of the link between host and board, without input or output of its own. Up to `WINDOW` reliable messages
/// can be unacknowledged, and latest-wins values can be of up to `KINDS` kinds.
#[derive(Debug)]
pub struct Link<const WINDOW: usize = 16, const KINDS: usize = 8> {
    deframer: Deframer,
    end: End<WINDOW, KINDS>,
}

/// State of a link except the frame that is being received.
#[derive(Debug)]
struct End<const WINDOW: usize, const KINDS: usize> {
    settings: LinkSettings,
    session: u32,
    state: LinkState,
    counters: Counters,
    peer: Option<Peer>,
    /// Salt of the peer's frames in the previous session.
    salt_before: Option<u32>,
    /// Arrival of the latest valid frame, and its time stamp.
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

/// Not due.
const NEVER: Micros = Micros(u64::MAX);

/// Number of sequence numbers.
const SEQUENCES: usize = 1 << 16;

/// Frames to send.
#[derive(Clone, Copy, Debug)]
struct Due {
    hello: Micros,
    heartbeat: Micros,
    ack: Option<Micros>,
    nak: bool,
    bye: bool,
    /// Whether the next frame needs a leading delimiter, because the receiver may be out of step.
    delimiter: bool,
    /// Whether a reliable message is next, because the last frame carried a latest-wins value.
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
    /// A link that sends hellos to find the peer. `session` identifies this start of the program: a random number, or
    /// a count of starts; 0 would mean "no session" and is replaced by `u32::MAX`.
    ///
    /// # Errors
    /// The first invalid setting.
    pub fn new(settings: LinkSettings, session: u32) -> Result<Self, SettingsError> {
        const { assert!(WINDOW > 0 && WINDOW < SEQUENCES / 2) };
        settings.check()?;
        let end = End {
            settings,
            session: valid_session(session),
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

    /// Starts again with another session number: nothing of the old session is accepted or sent any more. If `session`
    /// is the current number, the next one is used. Counters continue.
    pub fn restart(&mut self, session: u32) {
        let end = &mut self.end;
        end.salt_before = end.peer.map(|peer| peer.salt_in).or(end.salt_before);
        end.session = if valid_session(session) == end.session {
            valid_session(session.wrapping_add(1))
        } else {
            valid_session(session)
        };
        end.state = LinkState::Greeting;
        end.due = Due::FIRST;
        end.forget_peer();
    }

    /// Processes bytes received from the line, and passes each message that they complete to `take`, in order.
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

    /// Writes the next frame to send into `out`, which must hold [`super::frame::ENCODED_MAX`] bytes, and returns its
    /// length; 0 if no frame is due. Call it until it returns 0.
    pub fn poll_transmit(&mut self, now: Micros, out: &mut [u8]) -> usize {
        self.end.watch(now);
        self.end.transmit(now, out)
    }

    /// Instant at which [`Self::poll_transmit`] has to be called next if nothing is received or sent before; not
    /// before `now`. `None` if never.
    pub fn poll_at(&self, now: Micros) -> Option<Micros> {
        self.end.poll_at().map(|at| at.max(now))
    }

    /// Queues a reliable message, which is delivered once and in order. `kind` is its number in the table of messages.
    ///
    /// # Errors
    /// The link is not up, too many messages are unacknowledged, or the payload is too long.
    pub fn send(&mut self, kind: u8, payload: &[u8]) -> Result<(), SendError> {
        self.end.require_up()?;
        self.end.outbox.push(kind, payload)
    }

    /// Queues a latest-wins value, of which only the newest of each kind is delivered. It expires `ttl` after `now`,
    /// and replaces a value of its kind that has not been sent.
    ///
    /// # Errors
    /// The link is not up, no slot is free for another kind, or the payload is too long.
    pub fn offer(&mut self, kind: u8, now: Micros, ttl: Span, payload: &[u8]) -> Result<(), SendError> {
        self.end.require_up()?;
        let is_replaced = self.end.offers.put(kind, deadline(now, ttl), payload)?;
        self.end.counters.replaced = self.end.counters.replaced.wrapping_add(u32::from(is_replaced));
        Ok(())
    }

    /// Sets whether this end accepts reliable messages (initially yes). While it does not, the peer holds them back;
    /// none is lost, and none is acknowledged unread.
    pub fn set_ready(&mut self, is_ready: bool) {
        if is_ready != self.end.is_ready {
            self.end.is_ready = is_ready;
            // Acknowledge at once: the frame carries the busy flag and the next expected message.
            self.end.due.ack = Some(Micros(0));
        }
    }

    /// Closes the link: the state becomes [`LinkState::Lost`], and one last frame says so to the peer.
    pub fn close(&mut self) {
        let was_up = self.end.state == LinkState::Up;
        self.end.end_link(Loss::Closed);
        self.end.due.bye = was_up;
    }

    /// Number of reliable messages that [`Self::send`] can accept at present.
    pub fn room(&self) -> usize {
        WINDOW.saturating_sub(self.end.outbox.len())
    }

    /// Number of reliable messages that are queued or sent, and not acknowledged yet.
    pub fn unacknowledged(&self) -> usize {
        self.end.outbox.len()
    }

    /// Whether the peer currently accepts no reliable messages.
    pub fn is_peer_busy(&self) -> bool {
        self.end.outbox.is_peer_busy()
    }

    /// State of the link, as found by the last call that was given a time.
    pub fn state(&self) -> LinkState {
        self.end.state
    }

    /// Session number of this end.
    pub fn session(&self) -> u32 {
        self.end.session
    }

    /// Session number of the peer; `None` before its first hello.
    pub fn peer_session(&self) -> Option<u32> {
        self.end.peer.map(|peer| peer.session)
    }

    /// Settings of the link.
    pub fn settings(&self) -> &LinkSettings {
        &self.end.settings
    }

    /// Counters of the link.
    pub fn counters(&self) -> &Counters {
        &self.end.counters
    }

    /// Estimate of the difference between the peer's clock and ours.
    pub fn clock(&self) -> &PeerClock {
        &self.end.clock
    }

    /// Time since the arrival of the peer's latest valid frame, late copies excluded; the longest [`Span`] if there
    /// was none.
    pub fn age(&self, now: Micros) -> Span {
        self.end.heard.map_or(Span(u32::MAX), |(at, _)| now.since(at).into())
    }
}

impl<const WINDOW: usize, const KINDS: usize> End<WINDOW, KINDS> {
    fn require_up(&self) -> Result<(), SendError> {
        if self.state == LinkState::Up { Ok(()) } else { Err(SendError::Down) }
    }

    /// Ends the link on silence or on missing acknowledgements.
    fn watch(&mut self, now: Micros) {
        if self.state != LinkState::Up {
            return;
        }
        let is_over = |since: Micros, limit: Span| now.since(since) >= Micros(u64::from(limit.0));
        if self.heard.is_none_or(|(at, _)| is_over(at, self.settings.lost_after)) {
            self.end_link(Loss::Silence);
        } else if self.outbox.waiting_since().is_some_and(|since| is_over(since, self.settings.unacknowledged_after)) {
            self.end_link(Loss::Unacknowledged);
        }
    }

    fn end_link(&mut self, loss: Loss) {
        if !matches!(self.state, LinkState::Lost(_)) {
            self.state = LinkState::Lost(loss);
        }
    }

    /// Resets the state of one peer and one session.
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

/// A valid session number: replaces 0, which means none.
const fn valid_session(session: u32) -> u32 {
    if session == 0 { u32::MAX } else { session }
}

#[cfg(test)]
mod tests;
