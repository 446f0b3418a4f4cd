//! The side of the main loop: the link, and a clerk who obeys what comes over it.

use arcfeed_shared::units::{Micros, Span};
use arcfeed_shared::wire::link::{Link, LinkState, Loss, SendError};
use arcfeed_shared::wire::message::Message;
use arcfeed_shared::wire::message::field::{CHUNK_MAX, Chunk, PAYLOAD_MAX};
use arcfeed_shared::wire::message::table;
use arcfeed_shared::wire::settings::{LinkSettings, SettingsError};

use super::clerk::Clerk;

/// What ends a frame on the line.
const DELIMITER: u8 = 0;
/// How long a report is worth anything.
const REPORT_TTL: Span = Span::from_ms(300);
/// Answers go before the log: it leaves them so much room.
const LOG_LEAVES: usize = 4;

/// The board's end of the link; state.
pub struct Desk<'q, const WINDOW: usize = 16, const KINDS: usize = 8> {
    link: Link<WINDOW, KINDS>,
    clerk: Clerk<'q>,
    was_up: bool,
    report_due: Micros,
}

impl<'q, const WINDOW: usize, const KINDS: usize> Desk<'q, WINDOW, KINDS> {
    /// A desk that greets. `session` is one that no start of this board had before, and none has for the next 65 536 losses of its
    /// link: a count of starts in the upper half.
    ///
    /// # Errors
    /// Settings of the link that cannot work.
    pub fn new(settings: LinkSettings, session: u32, clerk: Clerk<'q>) -> Result<Self, SettingsError> {
        let link = Link::new(settings, session)?;
        Ok(Desk { link, clerk, was_up: false, report_due: Micros(0) })
    }

    /// Takes bytes off the link's line.
    pub fn on_link_bytes(&mut self, now: Micros, bytes: &[u8]) {
        // What the host asks for is judged by how things stand.
        self.clerk.listen();
        // Frame by frame: after each one the clerk may have enough, or another session may have begun.
        let mut rest = bytes;
        while !rest.is_empty() {
            let Desk { link, clerk, .. } = self;
            let end = rest.iter().position(|byte| *byte == DELIMITER).map_or(rest.len(), |at| at.saturating_add(1));
            // Not `split_inclusive`: the compiler cannot see that it never panics.
            let (part, others) = rest.split_at_checked(end).unwrap_or((rest, &[]));
            rest = others;
            link.set_ready(clerk.is_ready());
            link.on_bytes(now, part, &mut |received| clerk.take(received.kind, received.payload));
            self.watch();
        }
    }

    /// Puts the next frame for the link's line into `out`; its length, 0 if there is none. Call until it answers 0.
    pub fn poll_link(&mut self, now: Micros, out: &mut [u8]) -> usize {
        self.link.poll_transmit(now, out)
    }

    /// What is to be done now and then, best after each tick: hears the tick, answers, reports.
    pub fn run(&mut self, now: Micros) {
        self.clerk.run();
        self.watch();
        self.link.set_ready(self.clerk.is_ready());
        if !self.was_up {
            return;
        }
        self.clerk.heard(heard_at(now, self.link.age(now)));
        self.answer();
        if now >= self.report_due
            && let Some(report) = self.clerk.report()
        {
            let every = Micros(u64::from(self.clerk.knobs().report_every.0));
            self.report_due = now.after(every);
            let mut buffer = [0; PAYLOAD_MAX];
            let message = Message::from(report);
            let length = message.encode(&mut buffer).unwrap_or_default();
            let payload = buffer.get(..length).unwrap_or_default();
            // Refused only where the link is down.
            let _up = self.link.offer(message.kind(), now, REPORT_TTL, payload);
        }
    }

    /// Sends bytes of the log as far as they go beside everything else; how many.
    pub fn log(&mut self, bytes: &[u8]) -> usize {
        let mut sent = 0;
        for part in bytes.chunks(CHUNK_MAX) {
            let message = table::Log { bytes: Chunk::of(part) }.into();
            if self.link.room() <= LOG_LEAVES || send(&mut self.link, &message) != Ok(()) {
                break;
            }
            sent += part.len();
        }
        sent
    }

    /// The link: its state and counters.
    pub fn link(&self) -> &Link<WINDOW, KINDS> {
        &self.link
    }

    /// The clerk, for what does not come over the link: a tap's segments, parameters in flash.
    pub fn clerk_mut(&mut self) -> &mut Clerk<'q> {
        &mut self.clerk
    }

    /// The clerk.
    pub fn clerk(&self) -> &Clerk<'q> {
        &self.clerk
    }

    /// Sees the link come and go. It greets again at once, as another session.
    fn watch(&mut self) {
        match self.link.state() {
            LinkState::Up if !self.was_up => {
                self.clerk.welcome();
                self.was_up = true;
            }
            LinkState::Up => {}
            LinkState::Greeting | LinkState::Refused(_) => self.leave(Loss::PeerRestarted),
            LinkState::Lost(loss) => {
                self.leave(loss);
                self.link.restart(self.link.session().wrapping_add(1));
            }
        }
    }

    fn leave(&mut self, loss: Loss) {
        if !core::mem::take(&mut self.was_up) {
            return;
        }
        match loss {
            Loss::PeerRestarted | Loss::PeerClosed | Loss::Closed => self.clerk.see_host_off(),
            Loss::Silence | Loss::Unacknowledged | Loss::Garbled => self.clerk.lose_host(),
        }
    }

    fn answer(&mut self) {
        while let Some(reply) = self.clerk.reply() {
            if send(&mut self.link, &reply) == Err(SendError::Full) {
                return self.clerk.keep(reply);
            }
        }
    }
}

fn send<const WINDOW: usize, const KINDS: usize>(
    link: &mut Link<WINDOW, KINDS>,
    message: &Message,
) -> Result<(), SendError> {
    let mut buffer = [0; PAYLOAD_MAX];
    let length = message.encode(&mut buffer).unwrap_or_default();
    link.send(message.kind(), buffer.get(..length).unwrap_or_default())
}

/// When the peer was heard last.
fn heard_at(now: Micros, age: Span) -> Micros {
    now.since(Micros(u64::from(age.0)))
}
