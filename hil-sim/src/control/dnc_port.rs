//! The control's serial line: characters at line rate into a buffer, XON/XOFF back.
//!
//! The control sends DC1 when it starts to read, DC3 when its buffer fills, DC1 again when it has drained. After DC3 it
//! takes ten more characters; one more is alarm PS0087. A carriage return is ignored, a line feed ends a block.
//!
//! Source: Fanuc connection manuals B-63503EN p. 62 (start-stop, 10 characters after DC3); buffer sizes are assumed.

use std::collections::VecDeque;

use arcfeed_shared::nc::alarm::{Alarm, Fault};
use arcfeed_shared::units::{Micros, US_PER_S};

/// XON: reader start.
pub const DC1: u8 = 0x11;
/// XOFF: reader stop.
pub const DC3: u8 = 0x13;
/// Characters a control takes after DC3.
pub const AFTER_DC3_MAX: u32 = 10;

/// The line as both ends are set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineSettings {
    /// Bits per second.
    pub baudrate: u32,
    /// Bits a character takes: start, data, parity, stop.
    pub bits_per_char: u32,
    /// Characters the buffer holds.
    pub buffer: usize,
    /// DC3 is sent when fewer characters than this are free.
    pub xoff_below: usize,
    /// DC1 is sent when more than this are free.
    pub xon_above: usize,
}

impl Default for LineSettings {
    /// 9600 baud, 7E2.
    fn default() -> Self {
        LineSettings { baudrate: 9_600, bits_per_char: 11, buffer: 1_024, xoff_below: 256, xon_above: 768 }
    }
}

/// What went over the line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineCounters {
    /// Characters received.
    pub bytes: u64,
    /// Times DC3 was sent.
    pub xoff_count: u32,
    /// Most characters that came after a DC3.
    pub max_bytes_after_xoff: u32,
}

/// The port's state.
#[derive(Debug)]
pub struct DncPort {
    settings: Option<LineSettings>,
    wire: VecDeque<u8>,
    /// Line capacity not yet used, in millionths of a bit.
    credit: u64,
    buffer: VecDeque<u8>,
    blocks: usize,
    outgoing: VecDeque<u8>,
    flow: Flow,
    counters: LineCounters,
}

#[derive(Debug)]
enum Flow {
    /// Before the first DC1.
    Silent,
    /// The host may send.
    Reading,
    /// DC3 is out: characters since, and how many were under way when it was sent.
    Stopped { since: u32, excused: usize },
    /// The program is over; what still comes is dropped.
    Closed,
}

impl DncPort {
    /// A port that reads from its line.
    pub fn on_line(settings: LineSettings) -> Self {
        DncPort::new(Some(settings), &[])
    }

    /// A port whose program is all there; its line is never used.
    pub fn from_memory(program: &[u8]) -> Self {
        DncPort::new(None, program)
    }

    fn new(settings: Option<LineSettings>, program: &[u8]) -> Self {
        DncPort {
            settings,
            wire: VecDeque::new(),
            credit: 0,
            blocks: program.iter().filter(|&&byte| byte == b'\n').count(),
            buffer: program.iter().copied().collect(),
            outgoing: VecDeque::new(),
            flow: Flow::Silent,
            counters: LineCounters::default(),
        }
    }

    /// The host puts bytes on the line; they arrive at line rate.
    pub fn on_bytes(&mut self, bytes: &[u8]) {
        if !matches!(self.flow, Flow::Closed) {
            self.wire.extend(bytes);
        }
    }

    /// Characters given to the line that have not arrived yet.
    pub fn on_wire(&self) -> usize {
        self.wire.len()
    }

    /// The next byte the control sends.
    pub fn poll_transmit(&mut self) -> Option<u8> {
        self.outgoing.pop_front()
    }

    /// Whether [`DncPort::poll_transmit`] has a byte.
    pub fn has_to_say(&self) -> bool {
        !self.outgoing.is_empty()
    }

    /// Does not count what is on the line now against the ten characters after DC3: for hosts behind a pipe without a
    /// line rate, whose bytes were written before they could see the DC3.
    pub fn excuse_what_is_on_the_wire(&mut self) {
        if let Flow::Stopped { excused, .. } = &mut self.flow {
            *excused = self.wire.len();
        }
    }

    /// What went over the line.
    pub fn counters(&self) -> LineCounters {
        self.counters
    }

    /// Lets time pass on the line.
    pub fn step(&mut self, dt: Micros) -> Option<Fault> {
        let settings = self.settings?;
        self.credit += u64::from(settings.baudrate) * dt.0;
        let char_cost = u64::from(settings.bits_per_char) * US_PER_S;
        let mut fault = None;
        while self.credit >= char_cost {
            let Some(byte) = self.wire.pop_front() else {
                // An idle line saves nothing up.
                self.credit = self.credit.min(char_cost);
                break;
            };
            self.credit -= char_cost;
            fault = fault.or(self.receive(byte));
        }
        self.steer(&settings);
        fault
    }

    /// Whether nothing can come any more: a program in memory, read to its last line.
    pub fn is_exhausted(&self) -> bool {
        self.settings.is_none() && self.blocks == 0
    }

    /// The next complete line, without its line end.
    pub fn take_line(&mut self) -> Option<Vec<u8>> {
        if self.blocks == 0 {
            return None;
        }
        self.blocks -= 1;
        let end = self.buffer.iter().position(|&byte| byte == b'\n')?;
        let mut line: Vec<u8> = self.buffer.drain(..=end).collect();
        line.pop();
        line.retain(|&byte| byte != b'\r');
        Some(line)
    }

    /// Stops reading for good.
    pub fn close(&mut self) {
        if !matches!(self.flow, Flow::Closed) {
            self.flow = Flow::Closed;
            self.wire.clear();
            if self.settings.is_some() {
                self.outgoing.push_back(DC3);
            }
        }
    }

    fn receive(&mut self, byte: u8) -> Option<Fault> {
        self.counters.bytes += 1;
        self.blocks += usize::from(byte == b'\n');
        self.buffer.push_back(byte);
        if let Flow::Stopped { since, excused } = &mut self.flow {
            if *excused > 0 {
                *excused -= 1;
            } else {
                *since += 1;
                self.counters.max_bytes_after_xoff = self.counters.max_bytes_after_xoff.max(*since);
                return (*since > AFTER_DC3_MAX).then_some(Fault::alarm(Alarm::BufferOverflow, 0));
            }
        }
        None
    }

    fn steer(&mut self, settings: &LineSettings) {
        let free = settings.buffer.saturating_sub(self.buffer.len());
        match self.flow {
            Flow::Silent => {
                self.outgoing.push_back(DC1);
                self.flow = Flow::Reading;
            }
            Flow::Reading if free < settings.xoff_below => {
                self.outgoing.push_back(DC3);
                self.counters.xoff_count += 1;
                self.flow = Flow::Stopped { since: 0, excused: 0 };
            }
            Flow::Stopped { .. } if free > settings.xon_above => {
                self.outgoing.push_back(DC1);
                self.flow = Flow::Reading;
            }
            Flow::Reading | Flow::Stopped { .. } | Flow::Closed => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Micros = Micros(1_000);

    fn port() -> DncPort {
        DncPort::on_line(LineSettings { buffer: 64, xoff_below: 16, xon_above: 48, ..LineSettings::default() })
    }

    fn sent(port: &mut DncPort) -> Vec<u8> {
        std::iter::from_fn(|| port.poll_transmit()).collect()
    }

    #[test]
    fn characters_arrive_at_line_rate() {
        let mut port = DncPort::on_line(LineSettings::default());
        port.on_bytes(&[b'X'; 2_000]);
        for _ in 0..1_000 {
            port.step(MS);
        }
        // 9600 bits/s in characters of 11 bits.
        assert_eq!(port.counters().bytes, 872);
    }

    #[test]
    fn it_asks_stops_and_asks_again() {
        let mut port = port();
        port.step(MS);
        assert_eq!(sent(&mut port), [DC1]);
        port.on_bytes(b"G1X1.\nG1X2.\nG1X3.\nG1X4.\nG1X5.\nG1X6.\nG1X7.\nG1X8.\nG");
        while port.on_wire() > 0 {
            assert_eq!(port.step(MS), None);
        }
        assert_eq!(sent(&mut port), [DC3]);
        while port.take_line().is_some() {}
        port.step(MS);
        assert_eq!(sent(&mut port), [DC1]);
    }

    #[test]
    fn ten_characters_after_dc3_are_taken_and_the_eleventh_is_an_alarm() {
        let mut port = port();
        port.on_bytes(&[b'X'; 49]);
        while port.on_wire() > 0 {
            port.step(MS);
        }
        assert!(sent(&mut port).contains(&DC3));
        port.on_bytes(&[b'X'; 11]);
        let faults: Vec<Fault> = std::iter::from_fn(|| (port.on_wire() > 0).then(|| port.step(MS))).flatten().collect();
        assert_eq!(faults, [Fault::alarm(Alarm::BufferOverflow, 0)]);
        assert_eq!(port.counters().max_bytes_after_xoff, 11);
    }

    #[test]
    fn lines_lose_their_ends_and_nothing_else() {
        let mut port = DncPort::from_memory(b"%\r\nN10 G1\n\nM30");
        assert_eq!(port.take_line().as_deref(), Some(b"%".as_slice()));
        assert_eq!(port.take_line().as_deref(), Some(b"N10 G1".as_slice()));
        assert_eq!(port.take_line().as_deref(), Some(b"".as_slice()));
        assert_eq!(port.take_line(), None);
    }
}
