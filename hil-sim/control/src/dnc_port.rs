//! The control's serial (DNC) port: characters arrive at the rate of the line in a buffer; the port sends XON (DC1) and XOFF (DC3).
//!
//! ```text
//!         start        buffer fills
//! Silent -------> Reading ---------> Stopped       program end, reset, alarm: DC3
//!    ^     DC1      |  ^     DC3        |        any ---------------------------> Closed
//!    |              |  +----------------+                                           |
//!    |              |     DC1, drained                                              |
//!    +------------------------------------------------------------------------------+  start again
//! ```
//! After DC3 the port takes ten more characters; one more is alarm PS0087. A character with a wrong stop bit is PS0085.
//! A sender that becomes not ready during reading is PS0086. The port checks the buffer level once a step.

use std::collections::VecDeque;

use arcfeed_nc::alarm::{Alarm, Fault};
use arcfeed_nc_macro::print::Output;
use arcfeed_units::{Micros, US_PER_S};

use super::code::{DC1, DC3, TapeCode, with_even_parity, without_parity};
use super::line::{LineCounters, LineSettings};
use super::punch::Punch;
use super::tape::{ReceivedBlock, Tape};

/// Serial port of the simulated control, with the serial line to the sender and the buffer of received characters.
#[derive(Debug)]
pub struct DncPort {
    settings: Option<LineSettings>,
    wire: VecDeque<Arriving>,
    /// Line capacity not yet used, in millionths of a bit: towards the control, and from it.
    credit: [u64; 2],
    buffer: VecDeque<u8>,
    tape: Tape,
    blocks: usize,
    outgoing: VecDeque<u8>,
    punch: Punch,
    flow: Flow,
    is_ready: bool,
    /// DC1 came while the port read no program.
    is_requested: bool,
    counters: LineCounters,
}

#[derive(Clone, Copy, Debug)]
enum Arriving {
    Frame(u8),
    /// Character with wrong stop bits.
    Damaged,
}

#[derive(Debug)]
enum Flow {
    /// State before the first DC1.
    Silent,
    /// The host may send.
    Reading,
    /// DC3 is sent: count of characters since, and of characters exempt because they were under way.
    Stopped { since: u32, exempt: usize },
    /// The program is over; further characters are dropped.
    Closed,
}

impl DncPort {
    /// Port that reads a program from the serial line.
    pub fn on_line(settings: LineSettings) -> Self {
        DncPort::new(Some(settings), Tape::new(settings.tape), &[])
    }

    /// Port that has the whole program in its buffer, as for a program in the control's memory; the serial line is unused.
    pub fn from_memory(program: &[u8]) -> Self {
        DncPort::new(None, Tape::in_memory(), program)
    }

    fn new(settings: Option<LineSettings>, tape: Tape, program: &[u8]) -> Self {
        DncPort {
            settings,
            wire: VecDeque::new(),
            credit: [0; 2],
            blocks: program.iter().filter(|&&byte| byte == b'\n').count(),
            buffer: program.iter().copied().collect(),
            tape,
            outgoing: VecDeque::new(),
            punch: Punch::default(),
            flow: Flow::Silent,
            is_ready: true,
            is_requested: false,
            counters: LineCounters::default(),
        }
    }

    /// Accepts bytes that the sender puts on the serial line; they arrive at the rate of the line.
    pub fn on_bytes(&mut self, bytes: &[u8]) {
        let Some(settings) = self.settings else { return };
        if !matches!(self.flow, Flow::Closed) {
            self.wire.extend(bytes.iter().map(|byte| Arriving::Frame(settings.sender.frame(*byte))));
            return;
        }
        // While the port reads nothing, a sender's characters only start and stop the punch.
        for byte in bytes.iter().map(|byte| without_parity(settings.sender.frame(*byte))) {
            self.is_requested |= byte == DC1;
            self.punch.receive(byte);
        }
    }

    /// Puts a character without valid stop bits (noise, a break, another baud rate) on the line, after those already there.
    pub fn on_framing_error(&mut self) {
        self.wire.push_back(Arriving::Damaged);
    }

    /// Sets whether the sender's data set ready (DSR) line is on; it being off during reading is alarm PS0086.
    pub fn set_ready(&mut self, is_ready: bool) {
        self.is_ready = is_ready;
    }

    /// Number of characters on the line that have not arrived yet.
    pub fn on_wire(&self) -> usize {
        self.wire.len()
    }

    /// Number of received characters in the buffer that have not been read as blocks.
    pub fn buffered(&self) -> usize {
        self.buffer.len()
    }

    /// Takes the next byte that the control sends, as the sender receives it; `None` if there is none.
    pub fn poll_transmit(&mut self) -> Option<u8> {
        let frame = self.outgoing.pop_front()?;
        Some(self.settings.map_or(frame, |settings| settings.sender.byte(frame)))
    }

    /// Whether [`DncPort::poll_transmit`] would return a byte.
    pub fn has_output(&self) -> bool {
        !self.outgoing.is_empty()
    }

    /// Exempts the characters that are now on the line from the limit of ten after DC3: for senders behind a pipe without a line
    /// rate, which have written their bytes before they could see the DC3. Acts only while DC3 is in force.
    pub fn exempt_bytes_on_wire(&mut self) {
        if let Flow::Stopped { exempt, .. } = &mut self.flow {
            *exempt = self.wire.len();
        }
    }

    /// Whether the sender has sent DC1 while the port was not reading a program; clears that mark.
    pub fn take_request(&mut self) -> bool {
        std::mem::take(&mut self.is_requested)
    }

    /// Queue of the control's output (DPRNT, BPRNT) to the sender.
    pub fn punch(&mut self) -> &mut Punch {
        &mut self.punch
    }

    /// Queues the output of a macro statement for the sender; a port without a serial line discards it.
    pub fn put(&mut self, output: &Output) {
        if self.settings.is_some() {
            let code = self.code();
            self.punch.put(output, code);
        }
    }

    /// Whether output waits to be sent and the sender has not stopped it.
    pub fn is_punching(&self) -> bool {
        self.punch.is_sending()
    }

    /// Character code of the line: that of the received program; ISO as long as it is not known.
    pub fn code(&self) -> TapeCode {
        self.tape.code().unwrap_or(TapeCode::Iso)
    }

    /// Counters of the line's traffic.
    pub fn counters(&self) -> LineCounters {
        self.counters
    }

    /// Simulates the line for the time `dt`; returns the alarm that arose (parity or framing, overrun, sender not ready), if any.
    pub fn step(&mut self, dt: Micros) -> Option<Fault> {
        let settings = self.settings?;
        let char_cost = u64::from(settings.bits_per_char) * US_PER_S;
        for credit in &mut self.credit {
            *credit += u64::from(settings.baudrate) * dt.0;
        }
        let mut fault = None;
        while self.credit[0] >= char_cost {
            let Some(arriving) = self.wire.pop_front() else { break };
            self.credit[0] -= char_cost;
            fault = fault.or(self.receive(arriving, &settings));
        }
        while self.credit[1] >= char_cost {
            let Some(frame) = self.punch.poll() else { break };
            self.credit[1] -= char_cost;
            self.outgoing.push_back(frame);
        }
        // An idle line accumulates no credit.
        self.credit = self.credit.map(|credit| credit.min(char_cost));
        self.steer(&settings);
        let is_reading = matches!(self.flow, Flow::Reading | Flow::Stopped { .. }) && !self.tape.has_ended();
        fault.or((is_reading && !self.is_ready).then_some(Fault::alarm(Alarm::NotReady, 0)))
    }

    /// Whether no further block can come: the program is in memory and its last block has been taken. Never true on a serial line.
    pub fn is_exhausted(&self) -> bool {
        self.settings.is_none() && self.blocks == 0
    }

    /// Takes the next complete block from the buffer; `None` if none has arrived completely.
    pub fn take_block(&mut self) -> Option<ReceivedBlock> {
        if self.blocks == 0 {
            return None;
        }
        let tape = &self.tape;
        let code = tape.code().unwrap_or(TapeCode::Ascii);
        let end = self.buffer.iter().position(|&frame| code.ends_block(frame))?;
        self.blocks -= 1;
        let frames: Vec<u8> = self.buffer.drain(..=end).collect();
        Some(self.tape.read(&frames))
    }

    /// Stops reading at the program's end or at an alarm: sends DC3. What the sender sends
    /// afterwards (DC1, DC3) only starts and stops the control's output.
    pub fn close(&mut self) {
        if !matches!(self.flow, Flow::Closed) {
            self.flow = Flow::Closed;
            self.wire.clear();
            if self.settings.is_some() {
                self.send(DC3);
            }
        }
    }

    /// Reset of the control: stops reading, and discards received characters and unsent output.
    pub fn reset(&mut self) {
        self.close();
        self.punch.reset();
        self.buffer.clear();
        self.blocks = 0;
    }

    /// Cycle start after a reset: the port waits for the next program.
    pub fn restart(&mut self) {
        if let (Some(settings), Flow::Closed) = (self.settings, &self.flow) {
            self.tape = Tape::new(settings.tape);
            self.flow = Flow::Silent;
        }
    }

    fn send(&mut self, control_code: u8) {
        let is_ascii = self.settings.is_some_and(|settings| settings.tape.code == Some(TapeCode::Ascii));
        self.outgoing.push_back(if is_ascii { control_code } else { with_even_parity(control_code) });
    }

    fn receive(&mut self, arriving: Arriving, settings: &LineSettings) -> Option<Fault> {
        let Arriving::Frame(frame) = arriving else { return Some(Fault::alarm(Alarm::LineError, 0)) };
        if self.punch.receive(without_parity(frame)) {
            return None;
        }
        self.counters.bytes += 1;
        self.blocks += usize::from(self.tape.watch(frame));
        self.buffer.push_back(frame);
        let Flow::Stopped { since, exempt } = &mut self.flow else { return None };
        if *exempt > 0 {
            *exempt -= 1;
            return None;
        }
        *since += 1;
        self.counters.max_bytes_after_xoff = self.counters.max_bytes_after_xoff.max(*since);
        (*since > settings.after_dc3_max).then_some(Fault::alarm(Alarm::BufferOverflow, 0))
    }

    fn steer(&mut self, settings: &LineSettings) {
        let free = settings.buffer.saturating_sub(self.buffer.len());
        match self.flow {
            Flow::Silent => {
                self.send(DC1);
                self.flow = Flow::Reading;
            }
            Flow::Reading if free < settings.xoff_below => {
                self.send(DC3);
                self.counters.xoff_count += 1;
                self.flow = Flow::Stopped { since: 0, exempt: 0 };
            }
            Flow::Stopped { .. } if free > settings.xon_above => {
                self.send(DC1);
                self.flow = Flow::Reading;
            }
            Flow::Reading | Flow::Stopped { .. } | Flow::Closed => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::code::DC4;
    use crate::line::SenderParity;
    use crate::tape::TapeSettings;

    const MS: Micros = Micros(1_000);

    fn settings() -> LineSettings {
        LineSettings { buffer: 64, xoff_below: 16, xon_above: 48, ..LineSettings::default() }
    }

    fn sent(port: &mut DncPort) -> Vec<u8> {
        std::iter::from_fn(|| port.poll_transmit()).collect()
    }

    /// Lets all characters arrive; returns the faults.
    fn arrive(port: &mut DncPort) -> Vec<Fault> {
        std::iter::from_fn(|| (port.on_wire() > 0).then(|| port.step(MS))).flatten().collect()
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
    fn dc1_dc3_and_dc1_follow_the_buffer_level() {
        let mut port = DncPort::on_line(settings());
        port.step(MS);
        assert_eq!(sent(&mut port), [DC1]);
        port.on_bytes(b"G1X1.\nG1X2.\nG1X3.\nG1X4.\nG1X5.\nG1X6.\nG1X7.\nG1X8.\nG");
        assert_eq!(arrive(&mut port), []);
        assert_eq!(sent(&mut port), [DC3]);
        while port.take_block().is_some() {}
        port.step(MS);
        assert_eq!(sent(&mut port), [DC1]);
    }

    #[test]
    fn ten_characters_after_dc3_are_taken_and_the_eleventh_is_an_alarm() {
        let mut port = DncPort::on_line(settings());
        port.on_bytes(&[b'X'; 49]);
        arrive(&mut port);
        assert!(sent(&mut port).contains(&DC3));
        port.on_bytes(&[b'X'; 11]);
        assert_eq!(arrive(&mut port), [Fault::alarm(Alarm::BufferOverflow, 0)]);
        assert_eq!(port.counters().max_bytes_after_xoff, 11);
    }

    #[test]
    fn the_tenth_character_after_dc3_arrives_when_the_baud_rate_says() {
        // Ten characters of 11 bits: 22.9, 11.5, 5.7, 2.9 and 0.95 ms.
        for (baudrate, budget_us) in
            [(4_800, 22_917), (9_600, 11_458), (19_200, 5_729), (38_400, 2_865), (115_200, 955)]
        {
            let step = Micros(10);
            let mut port = DncPort::on_line(LineSettings { baudrate, ..settings() });
            port.on_bytes(&[b'X'; 60]);
            let (mut now, mut dc3_at) = (0, None);
            let tenth_at = loop {
                assert_eq!(port.step(step), None);
                now += step.0;
                if sent(&mut port).contains(&DC3) {
                    dc3_at = Some(now);
                }
                if port.counters().max_bytes_after_xoff == 10 {
                    break now;
                }
            };
            let budget = tenth_at - dc3_at.expect("the buffer filled before");
            assert!(u64::abs_diff(budget, budget_us) <= step.0, "{baudrate}: {budget} us");
        }
    }

    #[test]
    fn a_sender_without_parity_sees_dc3_with_its_parity_bit() {
        let mut port = DncPort::on_line(LineSettings { sender: SenderParity::None, ..settings() });
        port.step(MS);
        port.close();
        assert_eq!(sent(&mut port), [0x11, 0x93]);
    }

    #[test]
    fn noise_is_alarm_85_and_a_sender_that_goes_away_86() {
        let mut port = DncPort::on_line(settings());
        port.on_bytes(b"%\nG1");
        port.on_framing_error();
        assert_eq!(arrive(&mut port), [Fault::alarm(Alarm::LineError, 0)]);
        port.set_ready(false);
        assert_eq!(port.step(MS), Some(Fault::alarm(Alarm::NotReady, 0)));
        port.close();
        assert_eq!(port.step(MS), None);
    }

    #[test]
    fn a_sender_may_become_not_ready_after_its_program() {
        let mut port = DncPort::on_line(settings());
        port.on_bytes(b"%\nM30\n%");
        arrive(&mut port);
        port.set_ready(false);
        assert_eq!(port.step(MS), None);
    }

    #[test]
    fn after_a_reset_the_next_program_is_read_from_its_label() {
        let mut port = DncPort::on_line(settings());
        port.on_bytes(b"%\nG1X1.\nG1");
        arrive(&mut port);
        port.reset();
        port.on_bytes(b"X2.\n");
        assert_eq!((port.take_block(), port.on_wire()), (None, 0));
        port.restart();
        port.step(MS);
        assert_eq!(sent(&mut port), [DC1, DC3, DC1]);
        port.on_bytes(b"%\nG0\n");
        arrive(&mut port);
        assert_eq!(port.take_block(), Some(ReceivedBlock::Label { has_mark: true }));
        assert_eq!(port.take_block(), Some(ReceivedBlock::Block(b"G0".into())));
    }

    #[test]
    fn output_of_the_control_is_sent_at_line_rate() {
        let mut port = DncPort::on_line(settings());
        port.step(MS);
        sent(&mut port);
        let code = port.code();
        port.punch().open();
        port.punch().print(b"X1.5", code);
        port.punch().close();
        // 9.6 bits a step and 11 a character: six characters in eight steps (one was idle), seven in nine.
        assert!((0..7).all(|_| port.step(MS).is_none()));
        assert_eq!(sent(&mut port), b"\x12X1.5\n");
        port.step(MS);
        assert_eq!(sent(&mut port), [DC4]);
    }

    #[test]
    fn a_program_in_memory_needs_no_label_and_no_parity() {
        let mut port = DncPort::from_memory(b"%\r\nN10 G1\n\nM30");
        let block = |text: &str| Some(ReceivedBlock::Block(text.into()));
        assert_eq!((port.take_block(), port.take_block(), port.take_block()), (block("%"), block("N10 G1"), block("")));
        assert_eq!(port.take_block(), None);
        let unlabelled = TapeSettings { label_skip: false, ..TapeSettings::default() };
        let mut port = DncPort::on_line(LineSettings { tape: unlabelled, ..settings() });
        port.on_bytes(b"G0\n");
        arrive(&mut port);
        assert_eq!(port.take_block(), block("G0"));
    }
}
