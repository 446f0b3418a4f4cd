//! The reliable class: go-back-N over a line that does not reorder.
//!
//! The sender keeps what is not acknowledged and sends all of it again when the timer runs out or the receiver says that
//! something is missing; the receiver takes what it expects next and nothing else, so it needs no buffer to keep the order.

use heapless::{Deque, Vec};

use super::frame::PAYLOAD_MAX;
use super::state::SendError;
use crate::units::{Micros, Span};

/// Requests to send again that are followed until something is acknowledged: more would only repeat what is on its way.
const NAKS_MAX: u8 = 2;

/// A message on its way.
#[derive(Clone, Debug)]
pub struct Outgoing {
    /// Of the message.
    pub kind: u8,
    /// Of the message.
    pub payload: Vec<u8, PAYLOAD_MAX>,
    sent_at: Micros,
    times_sent: u32,
}

/// What an acknowledgement brought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acked {
    /// Nothing that was not known.
    Nothing,
    /// Messages are done; a round trip, where it can be told which one.
    Some(Option<Span>),
    /// It acknowledges what was never sent.
    Impossible,
}

/// The sender's side.
#[derive(Clone, Debug)]
pub struct Outbox<const WINDOW: usize> {
    messages: Deque<Outgoing, WINDOW>,
    /// Sequence number of the first.
    first: u16,
    /// Index of the next to be put on the line.
    next: usize,
    timer: Option<Micros>,
    /// When the first was first sent, or became the first, or could be sent again.
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
    /// Empty.
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

    /// Takes a message.
    ///
    /// # Errors
    /// Full, or the payload is too long.
    pub fn push(&mut self, kind: u8, payload: &[u8]) -> Result<(), SendError> {
        let payload = Vec::from_slice(payload).map_err(|_| SendError::TooLong(payload.len()))?;
        let message = Outgoing { kind, payload, sent_at: Micros(0), times_sent: 0 };
        self.messages.push_back(message).map_err(|_| SendError::Full)
    }

    /// Messages not acknowledged.
    pub fn len(&self) -> usize {
        self.messages.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.messages.is_empty()
    }

    /// The message to put on the line next, with its sequence number, and whether it was sent before.
    pub fn next(&self) -> Option<(u16, &Outgoing, bool)> {
        let message = self.messages.iter().nth(self.next).filter(|_| !self.peer_is_busy)?;
        Some((self.first.wrapping_add(self.next as u16), message, message.times_sent > 0))
    }

    /// It was put on the line.
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

    /// The peer expects `ack` next.
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
        // Karn: of what was sent twice, nobody knows which one was received.
        let sample = newest.filter(|message| message.times_sent == 1).map(|message| now.since(message.sent_at).into());
        Acked::Some(sample)
    }

    /// The peer threw away what came behind `ack`; true if all of it is sent again. `round_trip` is how long a repetition
    /// takes to show.
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

    /// The peer takes messages, or does not at present: it throws them away then, and the timer stands still.
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

    /// What [`Self::on_busy`] was told last.
    pub const fn is_peer_busy(&self) -> bool {
        self.peer_is_busy
    }

    /// Whether the timer has run out: all of it is sent again then.
    pub fn on_time(&mut self, now: Micros) -> bool {
        let is_over = self.timer.is_some_and(|timer| timer <= now);
        if is_over {
            self.send_again();
        }
        is_over
    }

    /// When the timer runs out.
    pub const fn timer(&self) -> Option<Micros> {
        self.timer
    }

    /// Since when the first message has been waiting for its acknowledgement; `None` while nothing is, or the peer is busy.
    pub fn waiting_since(&self) -> Option<Micros> {
        (self.on_the_line() > 0 && !self.peer_is_busy).then_some(self.waiting_since)
    }

    fn send_again(&mut self) {
        self.next = 0;
        self.timer = None;
    }

    /// Messages sent at least once: those in front.
    fn on_the_line(&self) -> usize {
        self.messages.iter().take_while(|message| message.times_sent > 0).count()
    }
}

/// What the receiver does with a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// The one expected.
    Next,
    /// It was here before: its acknowledgement was lost.
    Again,
    /// One before it is missing.
    Gap,
}

/// The receiver's side.
#[derive(Clone, Copy, Debug, Default)]
pub struct Inbox {
    expected: u16,
}

impl Inbox {
    /// What message `seq` is.
    pub const fn judge(&self, seq: u16) -> Arrival {
        match seq.wrapping_sub(self.expected) {
            0 => Arrival::Next,
            ahead if ahead < u16::MAX / 2 => Arrival::Gap,
            _ => Arrival::Again,
        }
    }

    /// The expected one was handed over.
    pub fn taken(&mut self) {
        self.expected = self.expected.wrapping_add(1);
    }

    /// The next expected: what is acknowledged.
    pub const fn expected(&self) -> u16 {
        self.expected
    }
}

#[cfg(test)]
mod tests;
