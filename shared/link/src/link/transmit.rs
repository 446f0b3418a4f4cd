//! Scheduling of frames to send.
//!
//! Priority: bye, hello, heartbeat, then latest-wins values and reliable messages alternately, then an acknowledgement
//! that no other frame has carried. Therefore each class waits for at most one frame of the other.

use super::{End, LinkState, NEVER};
use crate::frame::{ENCODED_MAX, FrameClass, Header, NO_SALT, encode};
use crate::session::{Echo, Hello};
use arcfeed_units::{Micros, Span};

impl<const WINDOW: usize, const KINDS: usize> End<WINDOW, KINDS> {
    /// Writes the next frame into `out`.
    pub(super) fn transmit(&mut self, now: Micros, out: &mut [u8]) -> usize {
        // A buffer that is too short for the longest frame is rejected: otherwise a long frame could wait forever
        // while short ones are sent.
        if out.len() < ENCODED_MAX || self.pace.ready_at() > now {
            return 0;
        }
        match self.state {
            LinkState::Lost(_) => self.transmit_bye(now, out),
            LinkState::Greeting | LinkState::Refused(_) => self.transmit_hello(now, out),
            LinkState::Up => self.transmit_up(now, out),
        }
    }

    /// Time at which [`Self::transmit`] or [`Self::watch`] has something to do.
    pub(super) fn poll_at(&self) -> Option<Micros> {
        let when_free = |at: Micros| at.max(self.pace.ready_at());
        match self.state {
            LinkState::Lost(_) => self.due.bye.then(|| self.pace.ready_at()),
            LinkState::Greeting | LinkState::Refused(_) => Some(when_free(self.due.hello)),
            LinkState::Up => {
                let settings = &self.settings;
                let silence = self.heard.map(|(at, _)| later(at, settings.lost_after));
                let given_up = self.outbox.waiting_since().map(|since| later(since, settings.unacknowledged_after));
                let is_waiting = self.due.nak || self.offers.any() || self.outbox.next().is_some();
                let sooner = [self.due.ack, self.outbox.timer(), is_waiting.then_some(Micros(0))];
                let frame = sooner.into_iter().flatten().fold(self.due.heartbeat.min(self.due.hello), Micros::min);
                [silence, given_up, Some(when_free(frame))].into_iter().flatten().min()
            }
        }
    }

    fn transmit_bye(&mut self, now: Micros, out: &mut [u8]) -> usize {
        if !self.due.bye {
            return 0;
        }
        self.due.bye = false;
        self.put(now, (FrameClass::Bye, 0, 0), [&[], &[]], out)
    }

    fn transmit_hello(&mut self, now: Micros, out: &mut [u8]) -> usize {
        if self.due.hello > now {
            return 0;
        }
        let is_up = self.state == LinkState::Up;
        self.due.hello = if is_up { NEVER } else { later(now, self.settings.hello_every()) };
        let peer_session = self.peer.map_or(0, |peer| peer.session);
        let hello = Hello::new(&self.settings, self.session, peer_session, self.echo(now));
        // Bytes on the line before a hello are not ours.
        self.due.delimiter = true;
        self.put(now, (FrameClass::Hello, 0, 0), [&hello.encode(), &[]], out)
    }

    fn transmit_up(&mut self, now: Micros, out: &mut [u8]) -> usize {
        self.counters.expired_out = self.counters.expired_out.wrapping_add(self.offers.expire(now));
        if self.outbox.on_time(now) {
            self.rto.back_off();
            self.counters.timeouts = self.counters.timeouts.wrapping_add(1);
            self.counters.rto = self.rto.rto();
            self.due.delimiter = true;
        }
        if self.due.hello <= now {
            return self.transmit_hello(now, out);
        }
        if self.due.heartbeat <= now {
            self.due.heartbeat = later(now, self.settings.heartbeat);
            let echo = self.echo(now).encode();
            return self.put(now, (FrameClass::Heartbeat, 0, 0), [&echo, &[]], out);
        }
        if self.due.nak {
            return self.put(now, (FrameClass::Nak, 0, 0), [&[], &[]], out);
        }
        let is_reliable_waiting = self.outbox.next().is_some();
        if self.offers.any() && !(self.due.reliable && is_reliable_waiting) {
            self.transmit_latest(now, out)
        } else if is_reliable_waiting {
            self.transmit_reliable(now, out)
        } else if self.due.ack.is_some_and(|due| due <= now) {
            self.put(now, (FrameClass::Ack, 0, 0), [&[], &[]], out)
        } else {
            0
        }
    }

    fn transmit_latest(&mut self, now: Micros, out: &mut [u8]) -> usize {
        let Some((offer, left_ms)) = self.offers.next(now) else { return 0 };
        let (kind, payload, seq) = (offer.kind, offer.payload.clone(), self.due.latest_seq);
        self.offers.sent(kind);
        self.due.latest_seq = seq.wrapping_add(1);
        self.due.reliable = true;
        self.put(now, (FrameClass::Latest, kind, seq), [&left_ms.to_le_bytes(), &payload], out)
    }

    fn transmit_reliable(&mut self, now: Micros, out: &mut [u8]) -> usize {
        let Some((seq, message, is_again)) = self.outbox.next() else { return 0 };
        let (kind, payload) = (message.kind, message.payload.clone());
        self.outbox.next_was_sent(now, self.rto.rto());
        self.counters.retransmissions = self.counters.retransmissions.wrapping_add(u32::from(is_again));
        self.due.reliable = false;
        self.put(now, (FrameClass::Reliable, kind, seq), [&payload, &[]], out)
    }

    /// Echo of the peer's last time stamp and its age.
    fn echo(&self, now: Micros) -> Echo {
        self.heard.map_or(Echo::default(), |(at, t_us)| Echo { t_us, held_us: Span::from(now.since(at)).0 })
    }

    /// Writes a frame; each one carries the acknowledgement.
    fn put(
        &mut self,
        now: Micros,
        (class, kind, seq): (FrameClass, u8, u16),
        payload: [&[u8]; 2],
        out: &mut [u8],
    ) -> usize {
        let ack = self.inbox.expected();
        let header = Header { class, is_busy: !self.is_ready, kind, seq, ack, t_us: now.0 as u32 };
        let salt = self.peer.filter(|_| class != FrameClass::Hello).map_or(NO_SALT, |peer| peer.salt_out);
        let first = usize::from(self.due.delimiter);
        let Some((before, rest)) = out.split_at_mut_checked(first) else { return 0 };
        before.fill(0);
        let Some(len) = encode(&header, payload, salt, rest) else { return 0 };
        let len = len.saturating_add(first);
        (self.due.delimiter, self.due.ack) = (false, None);
        self.due.nak &= class != FrameClass::Nak;
        self.counters.frames_out = self.counters.frames_out.wrapping_add(1);
        self.counters.bytes_out = self.counters.bytes_out.wrapping_add(len as u32);
        self.pace.sent(now, len);
        len
    }
}

fn later(at: Micros, span: Span) -> Micros {
    at.after(Micros(u64::from(span.0)))
}
