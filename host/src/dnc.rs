//! The DNC sender: a program onto a line with XON/XOFF, as a state machine without I/O.
//!
//! ```text
//!            DC1                 DC3
//! Waiting ---------> Sending ---------> Stopped
//!                      |  ^     DC1        |
//!                      |  +----------------+
//!                      | last byte
//!                      v
//!                     Sent
//! ```
//! Without XON/XOFF it starts in Sending. It hands out a few characters at a time and not before the line has had time
//! to carry the ones before, so that what is still to be sent when DC3 comes fits the ten characters a control takes.

use arcfeed_shared::units::{Micros, US_PER_S};

/// XON.
const DC1: u8 = 0x11;
/// XOFF.
const DC3: u8 = 0x13;
/// Most characters of the control's text that are kept.
const HEARD_MAX: usize = 4_096;
/// Most characters handed out at once: with as many again on their way, still below ten.
pub const CHUNK: usize = 4;

/// A program on its way; bytes, not blocks: the line ends are the program's own.
#[derive(Debug)]
pub struct Sender {
    program: Vec<u8>,
    sent: usize,
    state: State,
    xonxoff: bool,
    char_us: u64,
    line_free_at: Micros,
    heard: Vec<u8>,
    counters: Counters,
}

/// Where the sender stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// The control has not asked yet.
    Waiting,
    /// The control takes characters.
    Sending,
    /// The control takes none.
    Stopped,
    /// All of it is out.
    Sent,
}

/// What happened on the line, as the sender saw it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Times the control stopped us.
    pub xoff_count: u32,
    /// Characters from the control that mean nothing here.
    pub ignored: u32,
}

impl Sender {
    /// A sender for a line that takes `bits_per_char` bits a character.
    pub fn new(mut program: Vec<u8>, baudrate: u32, bits_per_char: u32, xonxoff: bool) -> Self {
        // A control takes a block at its end: a last line without one would never be executed.
        if program.last().is_some_and(|&byte| byte != b'\n') {
            program.push(b'\n');
        }
        let char_us = (u64::from(bits_per_char) * US_PER_S).div_ceil(u64::from(baudrate));
        let state = if xonxoff { State::Waiting } else { State::Sending };
        Sender {
            program,
            sent: 0,
            state,
            xonxoff,
            char_us,
            line_free_at: Micros(0),
            heard: Vec::new(),
            counters: Counters::default(),
        }
    }

    /// Takes what came from the control.
    pub fn on_bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.state = match (byte, self.state) {
                (DC1, State::Waiting | State::Stopped) if self.xonxoff => State::Sending,
                (DC3, State::Sending) if self.xonxoff => {
                    self.counters.xoff_count += 1;
                    State::Stopped
                }
                (DC1 | DC3, state) if self.xonxoff => state,
                (_, state) => {
                    self.counters.ignored += 1;
                    if self.heard.len() < HEARD_MAX {
                        self.heard.push(byte);
                    }
                    state
                }
            };
        }
    }

    /// Puts the next characters into `out`; answers how many.
    pub fn poll_transmit(&mut self, now: Micros, out: &mut [u8; CHUNK]) -> usize {
        if self.state != State::Sending || now < self.line_free_at {
            return 0;
        }
        let rest = &self.program[self.sent..];
        let len = rest.len().min(CHUNK);
        out[..len].copy_from_slice(&rest[..len]);
        self.sent += len;
        self.line_free_at = now.after(Micros(self.char_us * len as u64));
        if self.sent == self.program.len() {
            self.state = State::Sent;
        }
        len
    }

    /// When it has something to send, unless the control says otherwise before.
    pub fn poll_at(&self) -> Option<Micros> {
        (self.state == State::Sending).then_some(self.line_free_at)
    }

    /// Where it stands.
    pub fn state(&self) -> State {
        self.state
    }

    /// Characters sent and in all.
    pub fn progress(&self) -> (usize, usize) {
        (self.sent, self.program.len())
    }

    /// Blocks whose line end went out, `%` and empty lines not counted.
    pub fn blocks_sent(&self) -> usize {
        let sent = &self.program[..self.sent];
        let lines = sent.split_inclusive(|&byte| byte == b'\n').filter(|line| line.ends_with(b"\n"));
        lines.filter(|line| !matches!(line.trim_ascii(), [] | [b'%', ..])).count()
    }

    /// What the control has printed since the last call: DC2, text, DC4.
    pub fn take_heard(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.heard)
    }

    /// What happened on the line.
    pub fn counters(&self) -> Counters {
        self.counters
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHAR: Micros = Micros(1_146);

    fn sender() -> Sender {
        Sender::new(b"%\nG0X1.\n\nM30\n%\n".to_vec(), 9_600, 11, true)
    }

    /// Polls every character time; answers what goes out.
    fn run(sender: &mut Sender, start: Micros, chars: u64) -> Vec<u8> {
        let mut out = [0; CHUNK];
        (0..chars)
            .flat_map(|char| {
                let len = sender.poll_transmit(Micros(start.0 + char * CHAR.0), &mut out);
                out[..len].to_vec()
            })
            .collect()
    }

    #[test]
    fn nothing_goes_out_before_the_control_asks() {
        let mut sender = sender();
        assert_eq!(run(&mut sender, Micros(0), 20), b"");
        sender.on_bytes(&[DC1]);
        assert_eq!(run(&mut sender, Micros(0), 20), b"%\nG0X1.\n\nM30\n%\n");
        assert_eq!((sender.state(), sender.blocks_sent()), (State::Sent, 2));
    }

    #[test]
    fn xoff_stops_it_within_what_is_already_out_and_xon_resumes() {
        let mut sender = sender();
        sender.on_bytes(&[DC1]);
        assert_eq!(run(&mut sender, Micros(0), 4), b"%\nG0");
        sender.on_bytes(&[DC3]);
        assert_eq!((run(&mut sender, Micros(10_000), 20), sender.poll_at()), (vec![], None));
        sender.on_bytes(&[DC1]);
        assert_eq!(run(&mut sender, Micros(100_000), 20), b"X1.\n\nM30\n%\n");
        assert_eq!(sender.counters().xoff_count, 1);
    }

    #[test]
    fn it_is_never_ahead_of_the_line_by_more_than_a_chunk() {
        let mut sender = Sender::new(vec![b'X'; 400], 9_600, 11, false);
        let mut out = [0; CHUNK];
        let mut sent = 0;
        for us in (0..400 * CHAR.0).step_by(100) {
            sent += sender.poll_transmit(Micros(us), &mut out) as u64;
            assert!(sent <= us / CHAR.0 + CHUNK as u64, "{sent} at {us} us");
        }
    }

    #[test]
    fn without_xonxoff_control_codes_are_only_noise() {
        let mut sender = Sender::new(b"G0\n".to_vec(), 9_600, 11, false);
        sender.on_bytes(&[DC3]);
        assert_eq!(run(&mut sender, Micros(0), 4), b"G0\n");
        assert_eq!(sender.counters().ignored, 1);
    }
}
