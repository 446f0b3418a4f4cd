//! Test bench: nine wires with a clock, the reading of a control, and failing pins.

use core::cell::{Cell, RefCell};
use core::convert::Infallible;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{Error, ErrorKind, ErrorType, OutputPin};

use super::port_lines::LinePort;

/// Duration of a pin's write.
const WRITE_NS: u64 = 10;

/// The ninth wire.
pub const STROBE: u8 = 8;

/// Index of the port of all eight lines.
pub const PORT: u8 = 9;

/// A write of a wire: time, wire, level.
pub type WireEvent = (u64, u8, bool);

/// The wires; initially all high except the strobe.
#[derive(Default)]
pub struct Bench {
    now_ns: Cell<u64>,
    events: RefCell<Vec<WireEvent>>,
    /// A wire, or the port, that fails, and whether it changes its level nonetheless.
    pub refuses: Cell<Option<(u8, bool)>>,
}

/// Delays of a coupler.
#[derive(Clone, Copy)]
pub struct Coupler {
    /// Time to pull its line low.
    pub take_ns: u64,
    /// Time to release it.
    pub let_go_ns: u64,
}

impl Coupler {
    /// A plain wire.
    pub const NONE: Coupler = Coupler { take_ns: 0, let_go_ns: 0 };
}

/// Error of a pin that refuses to be written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refused;

impl Error for Refused {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

/// A pin of the bench.
pub struct Pin<'b> {
    bench: &'b Bench,
    wire: u8,
}

/// Lines 0 to 7 of the bench, written together.
pub struct Port<'b>(&'b Bench);

impl LinePort for Port<'_> {
    type Error = Refused;

    fn write(&mut self, levels: u8) -> Result<(), Refused> {
        let wires: [(u8, bool); 8] = core::array::from_fn(|line| (line as u8, levels & (1 << line) != 0));
        self.0.write(PORT, &wires)
    }
}

impl ErrorType for Pin<'_> {
    type Error = Refused;
}

impl OutputPin for Pin<'_> {
    fn set_low(&mut self) -> Result<(), Refused> {
        self.bench.write(self.wire, &[(self.wire, false)])
    }

    fn set_high(&mut self) -> Result<(), Refused> {
        self.bench.write(self.wire, &[(self.wire, true)])
    }
}

impl DelayNs for &Bench {
    fn delay_ns(&mut self, ns: u32) {
        self.now_ns.set(self.now_ns.get() + u64::from(ns));
    }
}

impl Bench {
    /// The pins of lines 0 to 7.
    pub fn pins(&self) -> [Pin<'_>; 8] {
        core::array::from_fn(|line| self.pin(line as u8))
    }

    /// The pin of a wire.
    pub fn pin(&self, wire: u8) -> Pin<'_> {
        Pin { bench: self, wire }
    }

    /// The port of lines 0 to 7.
    pub fn port(&self) -> Port<'_> {
        Port(self)
    }

    /// A write by a pin or the port to all `wires` at once.
    fn write(&self, by: u8, wires: &[(u8, bool)]) -> Result<(), Refused> {
        self.now_ns.set(self.now_ns.get() + WRITE_NS);
        let refusal = self.refuses.get().filter(|(refusing, _)| *refusing == by);
        if refusal.is_none_or(|(_, obeys)| obeys) {
            let now_ns = self.now_ns.get();
            self.events.borrow_mut().extend(wires.iter().map(|(wire, high)| (now_ns, *wire, *high)));
        }
        if refusal.is_some() { Err(Refused) } else { Ok(()) }
    }

    /// Writes since the last call of `clear`, as wire and level.
    pub fn written(&self) -> Vec<(u8, bool)> {
        self.events.borrow().iter().map(|(_, wire, high)| (*wire, *high)).collect()
    }

    /// Clears the recorded writes.
    pub fn clear(&self) {
        self.events.borrow_mut().clear();
    }

    /// All values that a control behind couplers could read during the recorded writes, starting from `percent`.
    pub fn readings(&self, percent: u8, coupler: Coupler) -> Vec<u8> {
        let late = |(at_ns, wire, high): &WireEvent| {
            (at_ns + if *high { coupler.let_go_ns } else { coupler.take_ns }, *wire, *high)
        };
        let mut arriving: Vec<WireEvent> = self.events.borrow().iter().map(late).collect();
        arriving.sort_by_key(|(at_ns, ..)| *at_ns);
        let mut wires = wires_at(percent);
        let instants = arriving.chunk_by(|(a_ns, ..), (b_ns, ..)| a_ns == b_ns);
        instants
            .map(|together| {
                together.iter().for_each(|(_, wire, high)| wires[usize::from(*wire)] = *high);
                control_reads(&wires)
            })
            .collect()
    }

    /// All values that a control could read behind a register that latches the data at the rising strobe.
    pub fn register_readings(&self) -> Vec<u8> {
        let mut wires = wires_at(0);
        let mut readings = Vec::new();
        for (wire, high) in self.written() {
            if wire == STROBE && high && !wires[usize::from(STROBE)] {
                readings.push(control_reads(&wires));
            }
            wires[usize::from(wire)] = high;
        }
        readings
    }
}

fn wires_at(percent: u8) -> [bool; 9] {
    core::array::from_fn(|wire| wire < 8 && percent & (1 << wire) == 0)
}

/// Reading of the control by its manual: the sum of the weights of low lines; 0 if all are low or all are high.
fn control_reads(wires: &[bool; 9]) -> u8 {
    let lines = &wires[..8];
    if lines.iter().all(|high| !high) {
        return 0;
    }
    lines.iter().zip([1, 2, 4, 8, 16, 32, 64, 128]).filter(|(high, _)| !**high).map(|(_, weight)| weight).sum()
}

/// A pin that cannot fail, with an error type of its own.
pub struct PlainPin(pub bool);

impl ErrorType for PlainPin {
    type Error = Infallible;
}

impl OutputPin for PlainPin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0 = false;
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0 = true;
        Ok(())
    }
}
