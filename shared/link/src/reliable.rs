//! Messages that are delivered once and in order (class reliable): go-back-N over a line that does not reorder.
//!
//! The sender keeps all unacknowledged messages and sends them again when its timer expires or the receiver reports a
//! gap. The receiver accepts only the next expected message, so it needs no buffer for reordering.

use heapless::{Deque, Vec};

use super::frame::PAYLOAD_MAX;
use super::state::SendError;
use arcfeed_units::{Micros, Span};

/// Maximum number of accepted naks until the next acknowledgement: more would only repeat messages that are on their
/// way.
const NAKS_MAX: u8 = 2;

/// A reliable message that the peer has not acknowledged yet.
#[derive(Clone, Debug)]
pub struct Outgoing {
    /// Kind of the message.
    pub kind: u8,
    /// Payload of the message.
    pub payload: Vec<u8, PAYLOAD_MAX>,
    sent_at: Micros,
    times_sent: u32,
}

/// Result of a received acknowledgement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acked {
    /// It acknowledges nothing new.
    Nothing,
    /// It acknowledges messages. With the time from sending the last of them to now, unless that one was sent more
    /// than once.
    Some(Option<Span>),
    /// It acknowledges messages that were never sent.
    Impossible,
}

/// Sender's side of reliable messages: those that the peer has not acknowledged.
#[derive(Clone, Debug)]
pub struct Outbox<const WINDOW: usize> {
    messages: Deque<Outgoing, WINDOW>,
    /// Sequence number of the first message.
    first: u16,
    /// Index of the next message to send.
    next: usize,
    timer: Option<Micros>,
    /// Time since which the first message waits: it was sent first, became the first, or could be sent again.
    waiting_since: Micros,
    naks: u8,
    nak_at: Micros,
    peer_is_busy: bool,
}

impl<const WINDOW: usize> Default for Outbox<WINDOW> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const WINDOW: usize> Outbox<WINDOW> {
    /// Empty outbox.
    pub const fn new() -> Self {
        Outbox {
            messages: Deque::new(),
            first: 0,
            next: 0,
            timer: None,
            waiting_since: Micros(0),
            naks: 0,
            nak_at: Micros(0),
            peer_is_busy: false,
        }
    }

    /// Adds a message to the queue.
    ///
    /// # Errors
    /// The queue is full of unacknowledged messages, or the payload is too long.
    pub fn push(&mut self, kind: u8, payload: &[u8]) -> Result<(), SendError> {
        let payload = Vec::from_slice(payload).map_err(|_| SendError::TooLong(payload.len()))?;
        let message = Outgoing { kind, payload, sent_at: Micros(0), times_sent: 0 };
        self.messages.push_back(message).map_err(|_| SendError::Full)
    }

    /// Number of messages in the queue that are not acknowledged yet, whether sent or not.
    pub fn len(&self) -> usize {
        self.messages.len()
    }

    /// Whether all messages are acknowledged.
    pub fn is_empty(&self) -> bool {
        self.messages.is_empty()
    }

    /// The message to be sent next, with its sequence number, and whether it was sent before; `None` if none is due or
    /// the peer is busy.
    pub fn next(&self) -> Option<(u16, &Outgoing, bool)> {
        let message = self.messages.iter().nth(self.next).filter(|_| !self.peer_is_busy)?;
        Some((self.first.wrapping_add(self.next as u16), message, message.times_sent > 0))
    }

    /// Records that the message of [`Self::next`] was sent now; `rto` is the time after which it is sent again.
    pub fn next_was_sent(&mut self, now: Micros, rto: Span) {
        let is_first_wait = self.on_the_line() == 0;
        let Some(message) = self.messages.iter_mut().nth(self.next) else { return };
        message.sent_at = now;
        message.times_sent = message.times_sent.saturating_add(1);
        self.next = self.next.saturating_add(1);
        if is_first_wait {
            self.waiting_since = now;
        }
        self.timer.get_or_insert(now.after(Micros(u64::from(rto.0))));
    }

    /// Handles an acknowledgement: the peer expects sequence number `ack` next, so all before it have arrived.
    pub fn on_ack(&mut self, now: Micros, ack: u16, rto: Span) -> Acked {
        let done = usize::from(ack.wrapping_sub(self.first));
        if done == 0 {
            return Acked::Nothing;
        }
        if done > self.on_the_line() {
            return Acked::Impossible;
        }
        let mut newest = None;
        for _ in 0..done {
            newest = self.messages.pop_front();
        }
        self.first = ack;
        self.next = self.next.saturating_sub(done);
        self.naks = 0;
        self.waiting_since = now;
        self.timer = (self.on_the_line() > 0).then(|| now.after(Micros(u64::from(rto.0))));
        // Karn's rule: for a retransmitted message it is unknown which copy was acknowledged.
        let sample = newest.filter(|message| message.times_sent == 1).map(|message| now.since(message.sent_at).into());
        Acked::Some(sample)
    }

    /// Handles a nak: the peer has discarded all messages from `ack` on. Returns whether they will be sent again; they
    /// are not if naks for the same gap come within a `round_trip` or too often.
    pub fn on_nak(&mut self, now: Micros, ack: u16, round_trip: Span) -> bool {
        let is_answered = self.naks > 0 && Span::from(now.since(self.nak_at)) < round_trip;
        let is_on_its_way = self.next < self.on_the_line();
        if ack != self.first || self.on_the_line() == 0 || self.naks >= NAKS_MAX || is_answered || is_on_its_way {
            return false;
        }
        self.naks = self.naks.saturating_add(1);
        self.nak_at = now;
        self.send_again();
        true
    }

    /// Handles the busy flag of a frame of the peer. A busy peer discards messages, so the timer for repetitions is
    /// stopped.
    pub fn on_busy(&mut self, now: Micros, is_busy: bool) {
        if is_busy {
            self.timer = None;
            self.waiting_since = now;
        } else if self.peer_is_busy {
            self.waiting_since = now;
            self.send_again();
        }
        self.peer_is_busy = is_busy;
    }

    /// Whether the peer was busy according to its last frame.
    pub const fn is_peer_busy(&self) -> bool {
        self.peer_is_busy
    }

    /// If the timer has expired, marks all messages to be sent again. Returns whether it had expired.
    pub fn on_time(&mut self, now: Micros) -> bool {
        let is_over = self.timer.is_some_and(|timer| timer <= now);
        if is_over {
            self.send_again();
        }
        is_over
    }

    /// Instant at which unacknowledged messages are sent again; `None` if none is on its way.
    pub const fn timer(&self) -> Option<Micros> {
        self.timer
    }

    /// Instant since which the oldest message waits for its acknowledgement; `None` if none waits or the peer is busy.
    pub fn waiting_since(&self) -> Option<Micros> {
        (self.on_the_line() > 0 && !self.peer_is_busy).then_some(self.waiting_since)
    }

    fn send_again(&mut self) {
        self.next = 0;
        self.timer = None;
    }

    /// Number of messages that were sent at least once: the first ones.
    fn on_the_line(&self) -> usize {
        self.messages.iter().take_while(|message| message.times_sent > 0).count()
    }
}

/// Relation of a received reliable message to the one that is expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// It is the expected message.
    Next,
    /// It was received before: its acknowledgement was lost.
    Again,
    /// A message before it is missing.
    Gap,
}

/// Receiver's side of reliable messages: sequence number of the message expected next.
#[derive(Clone, Copy, Debug, Default)]
pub struct Inbox {
    expected: u16,
}

impl Inbox {
    /// Compares a received sequence number with the expected one.
    pub const fn classify(&self, seq: u16) -> Arrival {
        match seq.wrapping_sub(self.expected) {
            0 => Arrival::Next,
            ahead if ahead < u16::MAX / 2 => Arrival::Gap,
            _ => Arrival::Again,
        }
    }

    /// Records that the expected message was delivered.
    pub fn delivered(&mut self) {
        self.expected = self.expected.wrapping_add(1);
    }

    /// Sequence number of the message expected next; it is sent to the peer as the acknowledgement.
    pub const fn expected(&self) -> u16 {
        self.expected
    }
}

#[cfg(test)]
mod tests;
