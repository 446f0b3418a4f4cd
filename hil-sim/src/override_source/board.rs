//! A feed board as the source of the override: it receives the machine's signals over a line and answers with the levels of *FV0 to *FV7.
//!
//! ```text
//! Sample { signals of the machine, bytes sent on the other lines so far } ->  board
//!          board:  reads exactly these bytes, ticks once              ->  Setpoint { lines, bytes sent so far }
//! ```
//!
//! In lockstep the machine waits for the answer and for exactly the bytes that it counts, so a run is the same every
//! time, however long the board takes in real time. Free running, each continues by itself: the machine takes the bytes
//! that have arrived.
//! Frames: docs/protocol.md, outside of any session.

use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::signals::Signals;
use arcfeed_link::frame::{ENCODED_MAX, OVERHEAD};
use arcfeed_link::message::Message;
use arcfeed_link::message::codes::{ModeCode, StateCode};
use arcfeed_link::message::fixed::Q40;
use arcfeed_link::message::table::{Sample, Setpoint};
use arcfeed_link::plain::PlainLine;
use arcfeed_nc::modal::Pose;
use arcfeed_units::Micros;

use super::{Decision, MachineSignals, OverrideSource};
use arcfeed_control::signals::FeedOverrideLines;

/// Length of a frame with a setpoint on the line.
const SETPOINT_BYTES: usize = OVERHEAD + 18;

/// Serial line of a feed board, named by the device at its other end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wire {
    /// Line to the host program.
    Link,
    /// Line to the simulated machine, for its signals and the override.
    Machine,
    /// Line to the sender of NC text, which the board taps.
    Sender,
    /// Line to the control.
    Control,
}

/// The simulator's ends of a feed board's serial lines.
pub trait Wires {
    /// Sends bytes to the board over one line.
    ///
    /// # Errors
    /// The line is broken.
    fn put(&mut self, wire: Wire, bytes: &[u8]) -> Result<(), BoardFailure>;

    /// Waits for bytes from the board on one line until `bytes` is full.
    ///
    /// # Errors
    /// The bytes do not come in time, or the line is closed.
    fn take(&mut self, wire: Wire, bytes: &mut [u8]) -> Result<(), BoardFailure>;

    /// Copies the bytes that have arrived from the board, at most as many as `bytes` has room for; returns their number.
    ///
    /// # Errors
    /// The line is broken.
    fn take_waiting(&mut self, wire: Wire, bytes: &mut [u8]) -> Result<usize, BoardFailure>;
}

/// Devices at the other ends of a board's lines to the host, the sender and the control.
pub trait AttachedDevices {
    /// Adds to `traffic` the bytes that the devices send in the period up to `at`, as far as the bit rates of their lines allow.
    fn send(&mut self, at: Micros, traffic: &mut Traffic);
    /// Receives bytes that the board has sent on a line.
    fn receive(&mut self, at: Micros, wire: Wire, bytes: &[u8]);
}

/// No device is attached.
impl AttachedDevices for () {
    fn send(&mut self, _at: Micros, _traffic: &mut Traffic) {}
    fn receive(&mut self, _at: Micros, _wire: Wire, _bytes: &[u8]) {}
}

/// Bytes on their way from the attached devices to the board.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Bytes from the host.
    pub link: Vec<u8>,
    /// Bytes from the sender.
    pub sender: Vec<u8>,
    /// Bytes from the control.
    pub control: Vec<u8>,
}

/// Reason why a board has stopped. Its override lines are then released, as by a loss of power, which means 0 %.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoardFailure {
    /// The serial line is closed.
    Closed(Wire),
    /// No bytes came in time on this serial line.
    Silent(Wire),
    /// The board sent something else than a setpoint on the machine line.
    NoSetpoint,
    /// The setpoint of the board answers the sample of this earlier time, not the last one.
    OutOfStep(Micros),
    /// The board, as a tap between sender and control, passed on this many bytes, but not all of those in the period.
    Tap(usize),
}

/// Feed board, real or emulated, as the source of the override; it is reached over its serial lines.
#[derive(Debug)]
pub struct Board<W, A = ()> {
    wires: W,
    attached: A,
    mode: ModeCode,
    panel: Signals,
    machine: PlainLine,
    traffic: Traffic,
    /// Bytes of this period on their way to the control and to the sender.
    tapped: [usize; 2],
    sent: Counts,
    received: Counts,
    has_begun: bool,
    last: Option<Setpoint>,
    failure: Option<BoardFailure>,
}

/// Bytes on the link and on the tapped line so far; they wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Counts {
    link: u32,
    tap: u32,
}

impl<W: Wires, A: AttachedDevices> Board<W, A> {
    /// Board at `wires`, with devices attached to its other lines; `mode` says whether it runs in lockstep or free.
    pub fn new(wires: W, attached: A, mode: ModeCode) -> Self {
        Board {
            wires,
            attached,
            mode,
            panel: Signals::NONE,
            machine: PlainLine::new(),
            traffic: Traffic::default(),
            tapped: [0; 2],
            sent: Counts::default(),
            received: Counts::default(),
            has_begun: false,
            last: None,
            failure: None,
        }
    }

    /// Restarts the board; `restart` must do it at the board itself. Counters and bytes on the lines are discarded.
    pub fn restart(&mut self, restart: impl FnOnce(&mut W)) {
        restart(&mut self.wires);
        (self.machine, self.traffic, self.tapped) = (PlainLine::new(), Traffic::default(), [0; 2]);
        (self.sent, self.received) = (Counts::default(), Counts::default());
        (self.has_begun, self.last, self.failure) = (false, None, None);
    }

    /// Sets the board's inputs from the machine's panel, and other signals that do not come from the control.
    pub fn set_panel(&mut self, panel: Signals) {
        self.panel = panel;
    }

    /// The attached devices.
    pub fn attached(&self) -> &A {
        &self.attached
    }

    /// The attached devices, mutable.
    pub fn attached_mut(&mut self) -> &mut A {
        &mut self.attached
    }

    /// Returns the attached devices and drops the board.
    pub fn into_attached(self) -> A {
        self.attached
    }

    /// Returns the lines and the attached devices.
    pub fn into_parts(self) -> (W, A) {
        (self.wires, self.attached)
    }

    /// The simulator's ends of the lines.
    pub fn wires(&self) -> &W {
        &self.wires
    }

    /// State of the board's supervisor, as last reported; `None` before the first report.
    pub fn state(&self) -> Option<StateCode> {
        self.last.map(|setpoint| setpoint.state)
    }

    /// Reason why the board has stopped; `None` as long as it runs.
    pub fn failure(&self) -> Option<BoardFailure> {
        self.failure
    }

    fn exchange(&mut self, shown: &MachineSignals) -> Result<(), BoardFailure> {
        // The machine sends first; its sample gives the board the mode.
        if self.has_begun {
            self.attached.send(shown.at, &mut self.traffic);
        }
        self.has_begun = true;
        self.put_traffic()?;
        self.put_sample(shown)?;
        match self.mode {
            ModeCode::Lockstep => self.take_answer(shown.at),
            ModeCode::Free => self.take_what_came(shown.at),
        }
    }

    fn put_traffic(&mut self) -> Result<(), BoardFailure> {
        let Traffic { link, sender, control } = &mut self.traffic;
        self.tapped = [sender.len(), control.len()];
        self.sent.link = self.sent.link.wrapping_add(link.len() as u32);
        self.sent.tap = self.sent.tap.wrapping_add((sender.len() + control.len()) as u32);
        for (wire, bytes) in [(Wire::Link, link), (Wire::Sender, sender), (Wire::Control, control)] {
            if !bytes.is_empty() {
                self.wires.put(wire, bytes)?;
                bytes.clear();
            }
        }
        Ok(())
    }

    fn put_sample(&mut self, shown: &MachineSignals) -> Result<(), BoardFailure> {
        let Pose { linear, rotary } = shown.position;
        let rotary = rotary.map(|angle| angle.0);
        let sample = Sample {
            at: shown.at.0,
            mode: self.mode,
            linear: Some(linear.map(|axis| axis.0)),
            rotary: (rotary != [0; 3]).then_some(rotary),
            spindle: Q40::of(shown.spindle.0).unwrap_or_default(),
            operator_percent: shown.operator_percent,
            signals: shown.signals.with(self.panel).bits(),
            link_bytes: self.sent.link,
            tap_bytes: self.sent.tap,
        };
        let mut frame = [0; ENCODED_MAX];
        let length = self.machine.encode(shown.at, &Message::Sample(sample), &mut frame);
        self.wires.put(Wire::Machine, &frame[..length])
    }

    /// Waits for the setpoint that answers the sample of this time, then for the bytes that it counts.
    fn take_answer(&mut self, at: Micros) -> Result<(), BoardFailure> {
        let mut frame = [0; SETPOINT_BYTES];
        self.wires.take(Wire::Machine, &mut frame)?;
        let setpoint = frame.iter().find_map(|byte| self.machine.on_byte(*byte));
        let Some(Message::Setpoint(setpoint)) = setpoint else { return Err(BoardFailure::NoSetpoint) };
        if setpoint.at != at.0 {
            return Err(BoardFailure::OutOfStep(Micros(setpoint.at)));
        }
        self.last = Some(setpoint);
        let mut bytes = vec![0; setpoint.link_bytes.wrapping_sub(self.received.link) as usize];
        self.wires.take(Wire::Link, &mut bytes)?;
        self.received.link = setpoint.link_bytes;
        self.attached.receive(at, Wire::Link, &bytes);
        self.take_tapped(at, setpoint.tap_bytes)
    }

    /// A tap passes on every byte in the period in which it arrived.
    fn take_tapped(&mut self, at: Micros, until: u32) -> Result<(), BoardFailure> {
        let [to_control, to_sender] = core::mem::take(&mut self.tapped);
        let count = until.wrapping_sub(self.received.tap) as usize;
        if count == 0 {
            return Ok(());
        }
        if count != to_control + to_sender {
            return Err(BoardFailure::Tap(count));
        }
        self.received.tap = until;
        for (wire, length) in [(Wire::Control, to_control), (Wire::Sender, to_sender)] {
            let mut bytes = vec![0; length];
            self.wires.take(wire, &mut bytes)?;
            self.attached.receive(at, wire, &bytes);
        }
        Ok(())
    }

    fn take_what_came(&mut self, at: Micros) -> Result<(), BoardFailure> {
        for wire in [Wire::Machine, Wire::Link, Wire::Sender, Wire::Control] {
            loop {
                let mut bytes = [0; ENCODED_MAX];
                let length = self.wires.take_waiting(wire, &mut bytes)?;
                match (wire, length) {
                    (_, 0) => break,
                    (Wire::Machine, _) => {
                        let messages = bytes[..length].iter().filter_map(|byte| self.machine.on_byte(*byte));
                        for message in messages {
                            let Message::Setpoint(setpoint) = message else { return Err(BoardFailure::NoSetpoint) };
                            self.last = Some(setpoint);
                        }
                    }
                    _ => self.attached.receive(at, wire, &bytes[..length]),
                }
            }
        }
        Ok(())
    }
}

impl<W: Wires, A: AttachedDevices> OverrideSource for Board<W, A> {
    fn decide(&mut self, shown: &MachineSignals) -> FeedOverride {
        if self.failure.is_none() {
            self.failure = self.exchange(shown).err();
        }
        let low = self.last.filter(|_| self.failure.is_none()).map_or(0, |setpoint| setpoint.lines);
        FeedOverride { percent: FeedOverrideLines(!low).percent() }
    }

    fn decision(&self) -> Option<Decision> {
        let state = self.state().filter(|_| self.failure.is_none())?;
        Some(Decision { state, reason: None })
    }
}

#[cfg(test)]
mod tests;
