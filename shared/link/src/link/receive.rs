//! Handling of received frames.

use super::{End, LinkState, Loss, NEVER, Received, Refusal};
use crate::frame::{Frame, FrameClass, NO_SALT, VERSION};
use crate::latest::expiry;
use crate::reliable::{Acked, Arrival};
use crate::session::{Echo, Hello, Peer};
use crate::state::Delivery;
use arcfeed_units::Micros;

impl<const WINDOW: usize, const KINDS: usize> End<WINDOW, KINDS> {
    /// Handles a complete frame from any sender.
    pub(super) fn on_frame(&mut self, now: Micros, frame: &Frame<'_>, take: &mut dyn FnMut(Received<'_>)) {
        if matches!(self.state, LinkState::Lost(_)) {
            return;
        }
        if frame.salt == NO_SALT && frame.header.class == FrameClass::Hello {
            self.on_hello(now, frame);
        } else if self.peer.is_some_and(|peer| frame.salt == peer.salt_in) && frame.version == VERSION {
            self.on_frame_of_peer(now, frame, take);
        } else if self.salt_before == Some(frame.salt) {
            count(&mut self.counters.stale_sessions);
            self.on_bad_frame();
        } else {
            count(&mut self.counters.crc_errors);
            self.on_bad_frame();
        }
    }

    /// Handles bytes between two delimiters that are not a frame.
    pub(super) fn on_framing_error(&mut self) {
        if !matches!(self.state, LinkState::Lost(_)) {
            count(&mut self.counters.framing_errors);
            self.on_bad_frame();
        }
    }

    fn on_bad_frame(&mut self) {
        count(&mut self.bad_in_a_row);
        if self.state == LinkState::Up && self.bad_in_a_row >= self.settings.bad_frames_max {
            self.end_link(Loss::Garbled);
        }
    }

    /// Handles a hello.
    fn on_hello(&mut self, now: Micros, frame: &Frame<'_>) {
        if frame.version != VERSION {
            return self.refuse(Refusal::Version(frame.version));
        }
        let Some(hello) = Hello::decode(frame.payload) else {
            count(&mut self.counters.framing_errors);
            return self.on_bad_frame();
        };
        if let Some(refusal) = hello.refusal(&self.settings) {
            return self.refuse(refusal);
        }
        let knows_me = hello.peer_session == self.session;
        if self.peer.is_none_or(|peer| peer.session != hello.session) {
            if self.state == LinkState::Up {
                return self.end_link(Loss::PeerRestarted);
            }
            self.forget_peer();
            self.peer = Some(Peer::new(&self.settings, self.session, hello.session));
        }
        if self.state != LinkState::Up {
            self.state = LinkState::Greeting;
        }
        if !self.register_frame(now, frame) {
            return;
        }
        if !knows_me {
            self.due.hello = now;
            return;
        }
        self.on_echo(now, frame, hello.echo);
        self.come_up(now);
        // The peer may not know yet that we know its session.
        self.due.heartbeat = now;
    }

    /// Rejects a hello. On a link that is up, an echo of our own hello counts only as an invalid frame.
    fn refuse(&mut self, refusal: Refusal) {
        match (self.state, refusal) {
            (LinkState::Up, Refusal::Role(role)) if role == self.settings.role as u8 => self.on_bad_frame(),
            (LinkState::Up, _) => self.end_link(Loss::PeerRestarted),
            _ => self.state = LinkState::Refused(refusal),
        }
    }

    fn come_up(&mut self, now: Micros) {
        if self.state != LinkState::Up {
            self.state = LinkState::Up;
            self.due.heartbeat = now;
            self.due.hello = NEVER;
        }
    }

    /// Registers a valid frame as a sign of life if its time stamp is later than all earlier ones. Returns whether to
    /// use it. A line keeps the order of frames and a retransmission has a new time stamp, so a frame with an earlier
    /// one is a copy.
    fn register_frame(&mut self, now: Micros, frame: &Frame<'_>) -> bool {
        count(&mut self.counters.frames_in);
        let t_us = frame.header.t_us;
        let last_us = self.heard.filter(|_| self.state == LinkState::Up).map(|(_, last_us)| last_us);
        let later_us = last_us.map_or(1, |last_us| t_us.wrapping_sub(last_us).cast_signed());
        if later_us < 0 {
            count(&mut self.counters.copies);
            return false;
        }
        // Frames of the same microsecond are not copies, but a copy of the last frame must not keep the link up.
        if later_us > 0 {
            self.heard = Some((now, t_us));
        }
        self.bad_in_a_row = 0;
        true
    }

    /// Handles a valid frame of the current pair of sessions.
    fn on_frame_of_peer(&mut self, now: Micros, frame: &Frame<'_>, take: &mut dyn FnMut(Received<'_>)) {
        let is_up = self.state == LinkState::Up;
        // The first frame must give a round trip: without one, the age of messages is unknown.
        if !is_up && frame.header.class != FrameClass::Heartbeat {
            return;
        }
        if !self.register_frame(now, frame) {
            return;
        }
        if let Some(echo) = Some(frame.payload).filter(|_| frame.header.class == FrameClass::Heartbeat) {
            let Ok(echo) = echo.try_into() else { return count(&mut self.counters.framing_errors) };
            self.on_echo(now, frame, Echo::decode(echo));
            self.come_up(now);
        }
        self.on_acknowledgement(now, frame);
        match frame.header.class {
            FrameClass::Reliable => self.on_reliable(now, frame, take),
            FrameClass::Latest => self.on_latest(now, frame, take),
            FrameClass::Bye => self.end_link(Loss::PeerClosed),
            FrameClass::Hello | FrameClass::Heartbeat | FrameClass::Ack | FrameClass::Nak | FrameClass::Plain => {}
        }
    }

    /// Uses a round trip for the clock estimate and the retransmission timer. The acknowledgement of a message may be
    /// delayed by `ack_delay`.
    fn on_echo(&mut self, now: Micros, frame: &Frame<'_>, echo: Echo) {
        if let Some(round_trip) = self.clock.on_echo(now, frame.header.t_us, echo) {
            self.rto.sample(round_trip.longer_by(self.settings.ack_delay));
        }
        self.counters.clock_steps = self.clock.steps();
    }

    /// Handles the acknowledgement and the busy flag of a frame.
    fn on_acknowledgement(&mut self, now: Micros, frame: &Frame<'_>) {
        match self.outbox.on_ack(now, frame.header.ack, self.rto.rto()) {
            Acked::Nothing => {}
            Acked::Some(sample) => {
                if let Some(sample) = sample {
                    self.rto.sample(sample);
                }
            }
            Acked::Impossible => count(&mut self.counters.bad_acks),
        }
        self.outbox.on_busy(now, frame.header.is_busy);
        if frame.header.class == FrameClass::Nak && self.outbox.on_nak(now, frame.header.ack, self.rto.srtt()) {
            count(&mut self.counters.naks);
            self.due.delimiter = true;
        }
        (self.counters.srtt, self.counters.rto) = (self.rto.srtt(), self.rto.rto());
    }

    fn on_reliable(&mut self, now: Micros, frame: &Frame<'_>, take: &mut dyn FnMut(Received<'_>)) {
        match self.inbox.classify(frame.header.seq) {
            Arrival::Next if self.is_ready => {
                self.inbox.delivered();
                self.due.nak = false;
                let by = now.after(Micros(u64::from(self.settings.ack_delay.0)));
                self.due.ack = Some(self.due.ack.map_or(by, |due| due.min(by)));
                take(Received { kind: frame.header.kind, payload: frame.payload, delivery: Delivery::Reliable });
            }
            Arrival::Next => {
                count(&mut self.counters.refused);
                self.due.ack = Some(now);
            }
            Arrival::Again => {
                count(&mut self.counters.duplicates);
                self.due.ack = Some(now);
            }
            Arrival::Gap => {
                count(&mut self.counters.gaps);
                self.due.nak = true;
            }
        }
    }

    fn on_latest(&mut self, now: Micros, frame: &Frame<'_>, take: &mut dyn FnMut(Received<'_>)) {
        if !self.newest.accept_newer(frame.header.seq) {
            return count(&mut self.counters.outdated);
        }
        let Some((left_ms, payload)) = frame.payload.split_first_chunk::<2>() else {
            return count(&mut self.counters.framing_errors);
        };
        let sent = self.clock.earliest(now, frame.header.t_us).unwrap_or(Micros(0));
        let expires = expiry(sent, u16::from_le_bytes(*left_ms));
        if expires <= now {
            return count(&mut self.counters.expired_in);
        }
        take(Received { kind: frame.header.kind, payload, delivery: Delivery::Latest { expires } });
    }
}

fn count(counter: &mut u32) {
    *counter = counter.wrapping_add(1);
}
