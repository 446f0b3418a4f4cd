//! A board in lockstep with a simulated machine: for each sample it reads exactly the number of bytes that the sample
//! states, runs one tick, and answers. Its behaviour depends only on the bytes and not on their timing, so a run is
//! reproducible on a chip, on an emulated chip, and in process.
//!
//! ```text
//!        sample                  its bytes are all here            answered
//! Idle ----------> Waiting ----------------------------------> main_loop, tick, front -----> Idle
//! ```

use arcfeed_link::frame::ENCODED_MAX;
use arcfeed_link::message::Message;
use arcfeed_link::message::codes::ModeCode;
use arcfeed_link::message::moves::pose;
use arcfeed_link::message::table::{Sample, Setpoint};
use arcfeed_link::plain::PlainLine;
use arcfeed_units::Micros;

use crate::main_loop::MainLoop;

/// One of the serial lines of a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoardLine {
    /// Line to the host program.
    Link,
    /// Line to the simulated machine.
    Machine,
    /// Line to the sender of the NC program, which the board taps.
    Sender,
    /// Line to the control, on which the tapped characters are passed on.
    Control,
}

/// Serial lines of a board, as the chip or the simulator implements them.
pub trait BoardLines {
    /// Number of bytes that have arrived on a line and were not taken yet.
    fn waiting(&self, line: BoardLine) -> usize;
    /// The next byte that has arrived on a line; `None` if there is none.
    fn receive(&mut self, line: BoardLine) -> Option<u8>;
    /// Sends bytes; returns the number of accepted bytes.
    fn send(&mut self, line: BoardLine, bytes: &[u8]) -> usize;
}

/// The board's end of the line to a simulated machine, with which it exchanges a sample and an answer each period.
#[derive(Debug, Default)]
pub struct Lockstep {
    line: PlainLine,
    waiting: Option<Sample>,
    taken: Counts,
    put: Counts,
    incomplete: u32,
}

/// Byte counts of link and tapped line; they wrap around.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Counts {
    link: u32,
    tap: u32,
}

impl Lockstep {
    /// State before the first sample.
    pub const fn new() -> Self {
        let none = Counts { link: 0, tap: 0 };
        Lockstep { line: PlainLine::new(), waiting: None, taken: none, put: none, incomplete: 0 }
    }

    /// Clock of the machine, as its first sample states it; `None` before that sample has arrived.
    pub fn mode(&mut self, lines: &mut impl BoardLines) -> Option<ModeCode> {
        self.sample(lines).map(|sample| sample.mode)
    }

    /// Runs one period if the machine's sample and all bytes that it announces have arrived; returns whether it did.
    /// `tick` must run one control tick with the sample and return the outputs; the byte counts that it returns are ignored.
    pub fn poll<const N: usize>(
        &mut self,
        main_loop: &mut MainLoop<'_, N>,
        lines: &mut impl BoardLines,
        tick: &mut dyn FnMut(Micros, &Sample) -> Setpoint,
    ) -> bool {
        let Some(sample) = self.sample(lines) else { return false };
        if !self.has_all_bytes(&sample, lines) {
            return false;
        }
        self.waiting = None;
        let now = Micros(sample.at);
        self.read_link(&sample, main_loop, lines);
        self.forward_tapped(&sample, main_loop, lines);
        main_loop.run(now);
        let position = sample.linear.and_then(|linear| pose(linear, sample.rotary).ok());
        if let Some(position) = position {
            main_loop.on_position(&position);
        }
        let setpoint = tick(now, &sample);
        main_loop.run(now);
        self.send_link(now, main_loop, lines);
        self.answer(now, &setpoint, lines);
        true
    }

    /// The waiting sample, or the next one received.
    fn sample(&mut self, lines: &mut impl BoardLines) -> Option<Sample> {
        while self.waiting.is_none() {
            let byte = lines.receive(BoardLine::Machine)?;
            if let Some(Message::Sample(sample)) = self.line.on_byte(byte) {
                self.waiting = Some(sample);
            }
        }
        self.waiting
    }

    fn has_all_bytes(&self, sample: &Sample, lines: &impl BoardLines) -> bool {
        let tapped = lines.waiting(BoardLine::Sender).saturating_add(lines.waiting(BoardLine::Control));
        lines.waiting(BoardLine::Link) >= distance(self.taken.link, sample.link_bytes)
            && tapped >= distance(self.taken.tap, sample.tap_bytes)
    }

    fn read_link<const N: usize>(
        &mut self,
        sample: &Sample,
        main_loop: &mut MainLoop<'_, N>,
        lines: &mut impl BoardLines,
    ) {
        for _ in 0..distance(self.taken.link, sample.link_bytes) {
            if let Some(byte) = lines.receive(BoardLine::Link) {
                main_loop.on_link_bytes(Micros(sample.at), &[byte]);
            }
        }
        self.taken.link = sample.link_bytes;
    }

    fn forward_tapped<const N: usize>(
        &mut self,
        sample: &Sample,
        main_loop: &mut MainLoop<'_, N>,
        lines: &mut impl BoardLines,
    ) {
        self.put.tap = self.put.tap.wrapping_add(forward(main_loop, lines, Micros(sample.at)));
        self.taken.tap = sample.tap_bytes;
    }

    /// Sends due frames; the link keeps its bit rate by the machine's time.
    fn send_link<const N: usize>(&mut self, now: Micros, main_loop: &mut MainLoop<'_, N>, lines: &mut impl BoardLines) {
        let mut frame = [0; ENCODED_MAX];
        loop {
            let length = main_loop.poll_link(now, &mut frame);
            let Some(frame) = frame.get(..length).filter(|frame| !frame.is_empty()) else { return };
            self.put.link = self.put.link.wrapping_add(lines.send(BoardLine::Link, frame) as u32);
        }
    }

    fn answer(&mut self, now: Micros, setpoint: &Setpoint, lines: &mut impl BoardLines) {
        let Counts { link, tap } = self.put;
        let message = Message::Setpoint(Setpoint { link_bytes: link, tap_bytes: tap, ..*setpoint });
        let mut frame = [0; ENCODED_MAX];
        let length = self.line.encode(now, &message, &mut frame);
        let sent = frame.get(..length).map_or(0, |frame| lines.send(BoardLine::Machine, frame));
        self.incomplete = self.incomplete.wrapping_add(u32::from(sent < length));
    }

    /// Numbers of invalid frames from the machine and of answers that could not be sent; they wrap around.
    pub fn faults(&self) -> [u32; 2] {
        [self.line.invalid(), self.incomplete]
    }
}

/// Passes the characters that have arrived on the tapped line on, in both directions; returns their number.
pub fn forward<const N: usize>(main_loop: &mut MainLoop<'_, N>, lines: &mut impl BoardLines, now: Micros) -> u32 {
    let mut passed = 0_u32;
    while let Some(byte) = lines.receive(BoardLine::Sender) {
        let byte = main_loop.from_sender(now, byte);
        passed = passed.wrapping_add(lines.send(BoardLine::Control, &[byte]) as u32);
    }
    while let Some(byte) = lines.receive(BoardLine::Control) {
        let byte = main_loop.from_control(now, byte);
        passed = passed.wrapping_add(lines.send(BoardLine::Sender, &[byte]) as u32);
    }
    passed
}

/// Difference of two byte counts.
fn distance(from: u32, to: u32) -> usize {
    to.wrapping_sub(from) as usize
}
