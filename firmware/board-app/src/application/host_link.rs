//! The board's end of the link to its host: receives and sends frames, and passes messages to the command handler.

use arcfeed_link::link::{Link, LinkState, Loss, SendError};
use arcfeed_link::message::Message;
use arcfeed_link::message::field::{CHUNK_MAX, Chunk, PAYLOAD_MAX};
use arcfeed_link::message::table;
use arcfeed_link::settings::{LinkSettings, SettingsError};
use arcfeed_units::{Micros, Span};

use super::command_handler::CommandHandler;

/// End of a frame on the line.
const DELIMITER: u8 = 0;
/// Time to live of a report.
const REPORT_TTL: Span = Span::from_ms(300);
/// Number of free slots of the link that the log leaves for answers.
const LOG_LEAVES: usize = 4;

/// The board's end of the link to its host: frames in and out, with the handler that executes the host's messages.
pub struct HostLink<'q, const WINDOW: usize = 16, const KINDS: usize = 8> {
    link: Link<WINDOW, KINDS>,
    handler: CommandHandler<'q>,
    was_up: bool,
    report_due: Micros,
}

impl<'q, const WINDOW: usize, const KINDS: usize> HostLink<'q, WINDOW, KINDS> {
    /// A link that sends hellos to find the host. `session` must not occur in any other start of this board, each of
    /// which uses up to 65 536 consecutive numbers: for example the count of starts in the upper half.
    ///
    /// # Errors
    /// Invalid settings of the link.
    pub fn new(settings: LinkSettings, session: u32, handler: CommandHandler<'q>) -> Result<Self, SettingsError> {
        let link = Link::new(settings, session)?;
        Ok(HostLink { link, handler, was_up: false, report_due: Micros(0) })
    }

    /// Processes bytes that have arrived on the link at the time `now`.
    pub fn on_link_bytes(&mut self, now: Micros, bytes: &[u8]) {
        // Requests of the host are checked against the current state.
        self.handler.read_status();
        // One frame at a time: after each frame the handler may be full, or another session may have started.
        let mut rest = bytes;
        while !rest.is_empty() {
            let HostLink { link, handler, .. } = self;
            let end = rest.iter().position(|byte| *byte == DELIMITER).map_or(rest.len(), |at| at.saturating_add(1));
            // Not `split_inclusive`: the compiler would add a panic path.
            let (part, others) = rest.split_at_checked(end).unwrap_or((rest, &[]));
            rest = others;
            link.set_ready(handler.is_ready());
            link.on_bytes(now, part, &mut |received| handler.handle(received.kind, received.payload));
            self.watch();
        }
    }

    /// Writes the next frame of the link into `out` and returns its length; 0 if there is none. Call it until it
    /// returns 0.
    pub fn poll_link(&mut self, now: Micros, out: &mut [u8]) -> usize {
        self.link.poll_transmit(now, out)
    }

    /// Reads the control task's status, and queues answers and reports for the host. Call it often, ideally after each
    /// tick.
    pub fn run(&mut self, now: Micros) {
        self.handler.run();
        self.watch();
        self.link.set_ready(self.handler.is_ready());
        if !self.was_up {
            return;
        }
        self.handler.host_alive(heard_at(now, self.link.age(now)));
        self.answer();
        if now >= self.report_due
            && let Some(report) = self.handler.report()
        {
            let every = Micros(u64::from(self.handler.settings().report_every.0));
            self.report_due = now.after(every);
            let mut buffer = [0; PAYLOAD_MAX];
            let message = Message::from(report);
            let length = message.encode(&mut buffer).unwrap_or_default();
            let payload = buffer.get(..length).unwrap_or_default();
            // Rejected only if the link is down.
            let _up = self.link.offer(message.kind(), now, REPORT_TTL, payload);
        }
    }

    /// Queues bytes of the log for the host, with lower priority than all other messages. Returns how many were
    /// accepted.
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

    /// The link, for its state and counters.
    pub fn link(&self) -> &Link<WINDOW, KINDS> {
        &self.link
    }

    /// The handler of the host's messages, for input that does not come over the link: segments of a tap, and a job in
    /// flash.
    pub fn handler_mut(&mut self) -> &mut CommandHandler<'q> {
        &mut self.handler
    }

    /// The handler of the host's messages.
    pub fn handler(&self) -> &CommandHandler<'q> {
        &self.handler
    }

    /// Follows the state of the link. A lost link restarts at once in another session.
    fn watch(&mut self) {
        match self.link.state() {
            LinkState::Up if !self.was_up => {
                self.handler.on_link_up();
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
            Loss::PeerRestarted | Loss::PeerClosed | Loss::Closed => self.handler.on_host_left(),
            Loss::Silence | Loss::Unacknowledged | Loss::Garbled => self.handler.on_host_lost(),
        }
    }

    fn answer(&mut self) {
        while let Some(reply) = self.handler.replies().pop() {
            if send(&mut self.link, &reply) == Err(SendError::Full) {
                return self.handler.replies().requeue(reply);
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

/// Time of the last frame of the peer.
fn heard_at(now: Micros, age: Span) -> Micros {
    now.since(Micros(u64::from(age.0)))
}
