//! State machine that hands out the characters of a program under XON/XOFF; see the diagram in [`super`].
//!
//! A control sends only DC1 and DC3: a character damaged on the way to it is not noticed here, and a DC1 after a reset
//! looks like any other. A transmission that ends early ends at the end of a block if the control allows it: half a
//! block has no effect until an end of block comes, and the next transmission would bring one.

use std::fmt;

use arcfeed_units::Micros;

use super::pace::{AFTER_DC3_MAX, Pace};
use super::transmission::Transmission;

const DC1: u8 = 0x11;
const DC2: u8 = 0x12;
const DC3: u8 = 0x13;
const DC4: u8 = 0x14;
const PARITY: u8 = 0x80;
/// Largest number of characters that the sender hands out at once.
pub const CHUNK: usize = AFTER_DC3_MAX;
/// A DC1 this close behind noise counts once the line has been quiet for this long: it may be part of the noise.
const SETTLE: Micros = Micros::from_ms(50);
/// Longest wait of an abort for the control to accept the rest of a block.
const ABORT_MAX: Micros = Micros::from_ms(2_000);
/// Most characters of the control's text that are kept.
const HEARD_MAX: usize = 4_096;

/// Settings of the serial line that the sender needs.
#[derive(Clone, Debug)]
pub struct LineUse {
    /// Pace: the times at which characters may go out.
    pub pace: Pace,
    /// The control sends DC1 (XON) and DC3 (XOFF); without it the sender starts at once and never stops.
    pub xonxoff: bool,
    /// Characters from the control have a parity bit that the port does not check: they arrive as eight bits.
    pub eight_bits: bool,
    /// Longest wait for the control's first DC1; `None`: no limit.
    pub start_timeout: Option<Micros>,
    /// Longest wait for DC1 after a DC3; `None`: no limit.
    pub xoff_timeout: Option<Micros>,
}

/// Sender of a program to a control (DNC), without I/O: follows XON/XOFF and paces the characters.
#[derive(Debug)]
pub struct Sender {
    transmission: Transmission,
    line: LineUse,
    sent: usize,
    /// Permitted offset of each [`Gate`].
    permitted: [usize; GATES],
    flow: Flow,
    /// Time of the last change of the flow.
    since: Micros,
    intent: Intent,
    over: Option<State>,
    noise_until: Micros,
    is_asked: bool,
    heard: Vec<u8>,
    counters: Counters,
}

/// Recipient that must have its part of the program before the sender goes on (see [`Sender::permit`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gate {
    /// The journal on disk, which records how far characters may have been sent.
    Journal,
    /// The feed board, which needs the segments of the blocks before the control executes them.
    Board,
}

const GATES: usize = 2;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Flow {
    Silent,
    Go,
    Stop,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Intent {
    Send,
    Hold,
    Abort { since: Micros },
}

/// State of the sender, drawn in the crate's documentation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// The control has not sent its first DC1 yet.
    Waiting,
    /// The control accepts characters (last signal DC1).
    Sending,
    /// The control has stopped the sender (last signal DC3).
    Stopped,
    /// The user has paused the sender with [`Sender::hold`].
    Held,
    /// All characters have been handed out.
    Sent,
    /// Aborted by the user with [`Sender::abort`].
    Aborted,
    /// Ended because the control's signal did not come in time.
    Failed(FailureReason),
}

/// Reason why a transmission failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FailureReason {
    /// The control has not sent its first DC1 within this time.
    NoStart(Micros),
    /// The control has not sent DC1 within this time after its DC3.
    NoXon(Micros),
}

/// Numbers of signals and characters received from the control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Number of DC3 that stopped the sender.
    pub xoff_count: u32,
    /// Number of DC1 that arrived while sending: a DC3 was lost before it, or the control was started anew.
    pub repeated_xon: u32,
    /// Number of characters without a meaning to the sender, such as printed text or noise; DC2 and DC4 are not
    /// counted.
    pub ignored: u32,
}

impl Sender {
    /// Sender that waits for no gate (see [`Sender::permit`]).
    pub fn new(transmission: Transmission, line: LineUse) -> Self {
        Sender {
            flow: if line.xonxoff { Flow::Silent } else { Flow::Go },
            transmission,
            line,
            sent: 0,
            permitted: [usize::MAX; GATES],
            since: Micros(0),
            intent: Intent::Send,
            over: None,
            noise_until: Micros(0),
            is_asked: false,
            heard: Vec::new(),
            counters: Counters::default(),
        }
    }

    /// Processes characters received from the control at the time `now`.
    pub fn on_bytes(&mut self, now: Micros, bytes: &[u8]) {
        for &byte in bytes {
            self.on_byte(now, byte);
        }
    }

    fn on_byte(&mut self, now: Micros, byte: u8) {
        // DC3 has three ones: with an even-parity bit it is 0x93.
        let byte = if self.line.eight_bits && byte == DC3 | PARITY { DC3 } else { byte };
        match byte {
            DC1 | DC3 if !self.line.xonxoff => self.counters.ignored += 1,
            DC1 => match self.flow {
                Flow::Silent => self.is_asked = true,
                Flow::Stop => self.turn(now, Flow::Go),
                Flow::Go => self.counters.repeated_xon += 1,
            },
            DC3 if self.flow == Flow::Go => {
                self.counters.xoff_count += 1;
                self.turn(now, Flow::Stop);
            }
            // The end of the program before, or the same again.
            DC3 => {}
            _ => {
                self.counters.ignored += u32::from(!matches!(byte, DC2 | DC4));
                self.noise_until = now.after(SETTLE);
                self.is_asked = false;
                if self.heard.len() < HEARD_MAX {
                    self.heard.push(byte & !PARITY);
                }
            }
        }
        self.start_if_asked(now);
    }

    fn start_if_asked(&mut self, now: Micros) {
        if self.is_asked && self.flow == Flow::Silent && now >= self.noise_until {
            self.turn(now, Flow::Go);
        }
    }

    fn turn(&mut self, now: Micros, flow: Flow) {
        (self.flow, self.since) = (flow, now);
    }

    /// Writes the characters that may go out at the time `now` into `out` and counts them as sent; returns their
    /// number, which is 0 if none may.
    pub fn poll_transmit(&mut self, now: Micros, out: &mut [u8; CHUNK]) -> usize {
        self.start_if_asked(now);
        self.check_timeouts(now);
        if self.over.is_some() || self.flow != Flow::Go || self.intent == Intent::Hold {
            return 0;
        }
        let until = match self.intent {
            Intent::Abort { .. } => self.block_end(),
            Intent::Send | Intent::Hold => self.transmission.frames().len(),
        };
        let rest = &self.transmission.frames()[self.sent..until.min(self.permitted()).max(self.sent)];
        let len = rest.len().min(CHUNK).min(self.line.pace.room(now));
        out[..len].copy_from_slice(&rest[..len]);
        self.line.pace.take(now, len);
        self.sent += len;
        self.check_timeouts(now);
        len
    }

    /// Checks the time-outs.
    fn check_timeouts(&mut self, now: Micros) {
        if self.over.is_some() {
            return;
        }
        let waited = now.since(self.since);
        let is_late = |limit: Option<Micros>| limit.filter(|limit| waited >= *limit);
        self.over = match (self.intent, self.flow) {
            _ if self.sent == self.transmission.frames().len() => Some(State::Sent),
            (Intent::Abort { since }, _) => {
                (!self.is_within_block() || now.since(since) >= ABORT_MAX).then_some(State::Aborted)
            }
            (_, Flow::Silent) => {
                is_late(self.line.start_timeout).map(|limit| State::Failed(FailureReason::NoStart(limit)))
            }
            (_, Flow::Stop) => is_late(self.line.xoff_timeout).map(|limit| State::Failed(FailureReason::NoXon(limit))),
            (_, Flow::Go) => None,
        };
    }

    /// Time at which [`Sender::poll_transmit`] must be called next, unless the control sends something before; `None`
    /// if there is nothing to do until then.
    pub fn poll_at(&self) -> Option<Micros> {
        if self.over.is_some() {
            return None;
        }
        match (self.intent, self.flow) {
            (Intent::Hold, Flow::Go) => None,
            (_, Flow::Go) => (self.sent < self.permitted()).then(|| self.line.pace.free_at()),
            (Intent::Abort { since }, _) => Some(since.after(ABORT_MAX)),
            (_, Flow::Silent) if self.is_asked => Some(self.noise_until),
            (_, Flow::Silent) => self.line.start_timeout.map(|limit| self.since.after(limit)),
            (_, Flow::Stop) => self.line.xoff_timeout.map(|limit| self.since.after(limit)),
        }
    }

    /// Pauses the transmission until [`Sender::resume`].
    pub fn hold(&mut self) {
        if self.intent == Intent::Send {
            self.intent = Intent::Hold;
        }
    }

    /// Continues after [`Sender::hold`], if the control still accepts characters.
    pub fn resume(&mut self) {
        if self.intent == Intent::Hold {
            self.intent = Intent::Send;
        }
    }

    /// Ends the transmission after the current block, or within it if the control accepts nothing more for two seconds.
    pub fn abort(&mut self, now: Micros) {
        if !matches!(self.intent, Intent::Abort { .. }) {
            self.intent = Intent::Abort { since: now };
        }
        self.check_timeouts(now);
    }

    /// Sends only characters before the offset `until` in the transmission, until the same gate permits more.
    pub fn permit(&mut self, gate: Gate, until: usize) {
        self.permitted[gate as usize] = until;
    }

    /// Whether the sender has sent everything that this gate permits and waits for more.
    pub fn wants_permit(&self, gate: Gate) -> bool {
        self.over.is_none() && self.sent >= self.permitted[gate as usize]
    }

    fn permitted(&self) -> usize {
        let [journal, board] = self.permitted;
        journal.min(board)
    }

    /// Present state of the sender.
    pub fn state(&self) -> State {
        match (self.over, self.intent, self.flow) {
            (Some(over), ..) => over,
            (None, _, Flow::Silent) => State::Waiting,
            (None, Intent::Hold, _) => State::Held,
            (None, _, Flow::Go) => State::Sending,
            (None, _, Flow::Stop) => State::Stopped,
        }
    }

    /// Whether the control accepts characters, by its last DC1 (true) or DC3 (false); `None` before its first DC1.
    pub fn is_taken(&self) -> Option<bool> {
        match self.flow {
            Flow::Silent => None,
            Flow::Go => Some(true),
            Flow::Stop => Some(false),
        }
    }

    /// Number of characters sent so far, and in all.
    pub fn progress(&self) -> (usize, usize) {
        (self.sent, self.transmission.frames().len())
    }

    /// The transmission that is being sent.
    pub fn transmission(&self) -> &Transmission {
        &self.transmission
    }

    /// Index in the transmission of the line of the next character to send.
    pub fn line(&self) -> usize {
        self.transmission.line_at(self.sent)
    }

    /// Number of blocks sent with their line end; `%` and empty lines do not count.
    pub fn blocks_sent(&self) -> usize {
        self.transmission.blocks_before(self.line())
    }

    /// Characters already sent of a block that is not complete yet; `None` at the end of a block.
    pub fn half_block(&self) -> Option<&[u8]> {
        let half = &self.transmission.text()[self.transmission.start_of(self.line())..self.sent];
        (!half.is_empty()).then_some(half)
    }

    fn is_within_block(&self) -> bool {
        self.half_block().is_some()
    }

    fn block_end(&self) -> usize {
        if self.is_within_block() { self.transmission.start_of(self.line() + 1) } else { self.sent }
    }

    /// Characters that the control has sent since the last call, without DC1 and DC3 and without the eighth bit: text
    /// that it prints, between DC2 and DC4. At most 4096 are kept between two calls.
    pub fn take_printed(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.heard)
    }

    /// Numbers of signals and characters received so far.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// Time at which the last character sent has arrived at the control. A port closed before that raises alarm PS0086
    /// there.
    pub fn arrived_at(&self) -> Micros {
        self.line.pace.empty_at()
    }

    /// Fraction of the line's rate that can be used, at most 1, if no more than ten characters may arrive after a DC3
    /// (see [`Pace::share`]).
    pub fn share(&self) -> f64 {
        self.line.pace.share()
    }
}

impl fmt::Display for FailureReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FailureReason::NoStart(waited) => write!(
                f,
                "the control has not asked for the program for {} s (no DC1); nothing was sent. Start DNC operation after \
                 this command, not before: DC1 comes once. Then check channel, baud rate, parity and that the cable's \
                 transmit and receive lines are crossed",
                waited.to_s()
            ),
            FailureReason::NoXon(waited) => write!(
                f,
                "the control has taken nothing since its DC3 {} s ago. It executes a long block, waits at M00 or feed hold, \
                 is in alarm, or its DC1 was lost on the line. Nothing is sent without it; look at the control, press RESET \
                 there, and take the program up again with --resume (xoff_timeout in [dnc] waits longer)",
                waited.to_s()
            ),
        }
    }
}

#[cfg(test)]
mod tests;
