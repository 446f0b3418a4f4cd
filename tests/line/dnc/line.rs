//! A line to a simulated control, in steps as fine as wanted, corrupted by a schedule.

use std::collections::VecDeque;

use arcfeed::dnc::outbox::{LineError, Outbox};
use arcfeed::dnc::pace::Pace;
use arcfeed::dnc::sender::LineUse;
use arcfeed::dnc::{Sender, State};
use arcfeed::port::{Port, PortError};
use arcfeed_control::{Control, ControlSettings};
use arcfeed_units::Micros;

use crate::dnc::schedule::{Fault, Schedule};

/// A control that has had nothing to execute for this long gets nothing more.
const STARVED_MAX_MS: u64 = 3_000;
/// No run takes as long.
const RUN_MAX: Micros = Micros::from_ms(600_000);

/// The sender's end of a line to a control.
#[derive(Debug)]
pub struct Line {
    pub control: Control,
    pub now: Micros,
    step: Micros,
    /// From the control to the sender.
    latency: Micros,
    inbox: VecDeque<(Micros, u8)>,
    outbox: VecDeque<(Micros, u8)>,
    schedule: Schedule,
    written: usize,
    writes: usize,
    heard: usize,
    /// Bytes as they reached the control.
    pub arrived: Vec<u8>,
    /// Characters of the control, with their time and the number of characters that it had received then.
    pub said: Vec<(Micros, u8, u64)>,
    /// Blocks taken up, and how long the control had starved until the last of them.
    fed: (usize, u64),
}

/// End of a run.
#[derive(Debug)]
pub struct Outcome {
    pub state: State,
    pub error: Option<LineError>,
    pub line: Line,
}

impl Line {
    pub fn new(settings: ControlSettings, step: Micros, latency: Micros, schedule: &Schedule) -> Self {
        let garbage = schedule.0.iter().flat_map(|fault| match fault {
            Fault::Garbage(bytes) => bytes.clone(),
            _ => Vec::new(),
        });
        Line {
            control: Control::on_line(settings),
            now: Micros(0),
            step,
            latency,
            inbox: garbage.map(|byte| (Micros(0), byte)).collect(),
            outbox: VecDeque::new(),
            schedule: schedule.clone(),
            written: 0,
            writes: 0,
            heard: 0,
            arrived: Vec::new(),
            said: Vec::new(),
            fed: (0, 0),
        }
    }

    fn receive(&mut self) {
        while let Some(byte) = self.control.port().poll_transmit() {
            let at = self.heard;
            self.said.push((self.now, byte & 0x7F, self.control.line_counters().bytes));
            self.heard += 1;
            let mut copies = vec![byte];
            let mut late = Micros(0);
            for fault in &self.schedule.0 {
                match fault {
                    Fault::RxLost(n) if *n == at => copies.clear(),
                    Fault::RxTwice(n) if *n == at => copies.push(byte),
                    Fault::RxFlip(n, bit) if *n == at => copies.iter_mut().for_each(|copy| *copy ^= 1 << bit),
                    Fault::RxLate(n, ms) if *n == at => late = Micros::from_ms(*ms),
                    _ => {}
                }
            }
            let before = self.inbox.back().map_or(Micros(0), |(due, _)| *due);
            let due = self.now.after(self.latency).after(late).max(before);
            self.inbox.extend(copies.into_iter().map(|copy| (due, copy)));
        }
    }

    fn carry(&mut self, byte: u8) {
        let at = self.written;
        self.written += 1;
        let (mut frames, mut late) = (vec![byte], Micros(0));
        for fault in &self.schedule.0 {
            match fault {
                Fault::TxLost(n) if *n == at => frames.clear(),
                Fault::TxTwice(n) if *n == at => frames.push(byte),
                Fault::TxFlip(n, mask) if *n == at => frames.iter_mut().for_each(|frame| *frame ^= mask),
                Fault::TxLate(n, ms) if *n == at => late = Micros::from_ms(*ms),
                Fault::TxNoise(n, noise) if (*n..*n + noise.len()).contains(&at) => frames = vec![noise[at - n]],
                Fault::TxBreak(n) if *n == at => {
                    self.control.port().on_framing_error();
                    frames.clear();
                }
                _ => {}
            }
        }
        let before = self.outbox.back().map_or(Micros(0), |(due, _)| *due);
        let due = self.now.after(late).max(before);
        self.outbox.extend(frames.into_iter().map(|frame| (due, frame)));
        self.deliver();
    }

    fn deliver(&mut self) {
        while let Some((_, frame)) = self.outbox.pop_front_if(|(due, _)| *due <= self.now) {
            self.arrived.push(frame);
            self.control.port().on_bytes(&[frame]);
        }
    }

    /// Takes the unread characters from the control.
    pub fn take_inbox(&mut self) -> Vec<u8> {
        self.inbox.drain(..).map(|(_, byte)| byte).collect()
    }

    fn is_cut(&self) -> bool {
        self.schedule.0.iter().any(|fault| matches!(fault, Fault::Cut(n) if self.written >= *n))
    }

    /// The control goes on without a sender.
    pub fn run_out(&mut self) {
        while !self.is_over() && self.now < RUN_MAX {
            self.tick();
        }
    }

    fn is_over(&self) -> bool {
        self.control.is_over() || self.control.starved_ms() - self.fed.1 > STARVED_MAX_MS
    }

    pub fn tick(&mut self) {
        self.now = self.now.after(self.step);
        self.deliver();
        self.control.step(self.now, self.step, 100);
        if self.fed.0 != self.control.executed().len() {
            self.fed = (self.control.executed().len(), self.control.starved_ms());
        }
        self.receive();
    }
}

impl Port for Line {
    fn now(&self) -> Micros {
        self.now
    }

    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        if self.is_cut() {
            return Err(PortError::in_words("line", "cut"));
        }
        let mut len = 0;
        while len < buffer.len() && self.inbox.front().is_some_and(|(due, _)| *due <= self.now) {
            buffer[len] = self.inbox.pop_front().map_or(0, |(_, byte)| byte);
            len += 1;
        }
        Ok(len)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<usize, PortError> {
        self.writes += 1;
        let is_short = self.schedule.0.iter().any(|fault| matches!(fault, Fault::Short(n) if *n == self.writes));
        let len = if is_short { bytes.len() / 2 } else { bytes.len() };
        for byte in &bytes[..len] {
            if self.is_cut() {
                return Err(PortError::in_words("line", "cut"));
            }
            self.carry(*byte);
        }
        Ok(len)
    }

    fn wait(&mut self, deadline: Micros) {
        loop {
            self.tick();
            let is_due = self.inbox.front().is_some_and(|(due, _)| *due <= self.now);
            if self.now >= deadline || is_due || self.is_over() {
                return;
            }
        }
    }

    fn control_is_done(&self) -> Option<bool> {
        Some(self.is_over())
    }

    fn blocks_executed(&self) -> Option<usize> {
        Some(self.control.executed().len())
    }
}

/// Use of the line by a sender with these settings.
pub fn line_use(settings: &ControlSettings, reaction: Micros) -> LineUse {
    LineUse {
        pace: Pace::new(settings.line.bits_per_char, settings.line.baudrate, Some(reaction)),
        xonxoff: true,
        eight_bits: true,
        start_timeout: Some(Micros::from_ms(10_000)),
        xoff_timeout: Some(Micros::from_ms(10_000)),
    }
}

/// Sends until all is over on both sides, or `stop` says so after a turn of the loop.
pub fn send(mut line: Line, sender: &mut Sender, mut stop: impl FnMut(&Line, &mut Sender) -> bool) -> Outcome {
    let mut outbox = Outbox::new(Some(Micros::from_ms(5_000)));
    let mut error = None;
    while error.is_none() && !stop(&line, sender) {
        if let Err(failed) = outbox.turn(&mut line, sender) {
            error = Some(failed);
        }
        if matches!(sender.state(), State::Aborted | State::Failed(_)) || line.is_over() {
            break;
        }
        let latest = line.now.after(Micros::from_ms(20));
        line.wait(sender.poll_at().map_or(latest, |at| at.min(latest)));
        assert!(line.now < RUN_MAX, "no end in sight: {:?}", sender.state());
    }
    Outcome { state: sender.state(), error, line }
}
