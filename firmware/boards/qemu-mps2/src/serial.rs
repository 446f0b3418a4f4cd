//! Lines with a ring of bytes either way, filled and emptied by interrupts.
//!
//! ```text
//! receiver -> UARTn_RX -> ring -> main program -> ring -> UARTn_TX -> transmitter
//! ```
//!
//! The tapped line, once the board runs free, is passed on by the receivers' handlers themselves, and heard by the main program later:
//!
//! ```text
//! receiver -> UARTn_RX -+-> ring of the other line -> its transmitter
//!                       +-> ring -> main program
//! ```
//!
//! Rings have one producer and one consumer and need no lock, so a line holds up nothing but its own bytes. What finds a
//! ring full is dropped and counted: the protocols above find it missing, and the count says where it went.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use arcfeed_firmware::lockstep;
use arcfeed_firmware::spsc::{Consumer, Producer, split};
use cortex_m::peripheral::NVIC;
use heapless::spsc::Queue;

use crate::clock::{InstructionCounter, steps};
use crate::handed::{Handed, Once};
use crate::interrupts::{Priority, enable};
use crate::uart::{Registers, UART0, UART1, UART2, UART3, Uart};

/// Bytes of each ring, less one. At 115 200 Bd it fills in 89 ms.
pub const RING: usize = 1024;

/// What there is once of each line.
struct Hardware {
    uart: Uart,
    handler: Handed<Handler>,
    rings: Once<[Queue<u8, RING>; 2]>,
    lost: AtomicU32,
    /// A byte was lost behind those that wait, and none is put behind them before the main program knows.
    has_gap: AtomicBool,
    /// Instructions in which a byte was passed on, where nothing held the handler up.
    passed_in: AtomicU32,
}

/// What the handlers of a line own.
struct Handler {
    registers: Registers,
    received: Producer<'static, u8>,
    to_send: Consumer<'static, u8>,
    /// Where bytes are passed on to: a line's ring, and its place among the lines.
    onward: Option<(Producer<'static, u8>, usize)>,
}

/// Places of the two ends of the tapped line.
const SENDER: usize = 2;
const CONTROL: usize = 3;

static LINES: [Hardware; 4] = [Hardware::of(UART0), Hardware::of(UART1), Hardware::of(UART2), Hardware::of(UART3)];

/// The main program's end of a line.
pub struct Line {
    received: Consumer<'static, u8>,
    /// `None` once another line's handler has it.
    to_send: Option<Producer<'static, u8>>,
    hardware: &'static Hardware,
}

/// The lines of the board, all running.
pub struct Lines {
    /// UART 0: the link to the host.
    pub link: Line,
    /// UART 1: the machine.
    pub machine: Line,
    /// UART 2: the sender, behind the tap.
    pub sender: Line,
    /// UART 3: the control, before the tap.
    pub control: Line,
}

impl Lines {
    /// Switches all lines on; `None` if they are on already.
    pub fn start() -> Option<Self> {
        let [link, machine, sender, control] = &LINES;
        Some(Lines {
            link: link.start()?,
            machine: machine.start()?,
            sender: sender.start()?,
            control: control.start()?,
        })
    }
}

impl Lines {
    /// Passes on from now on, in the receivers' handlers, what comes at one end of the tapped line; the main program only hears it.
    ///
    /// # Safety
    /// Interrupts are held back.
    pub unsafe fn bridge(&mut self) {
        let [.., sender, control] = &LINES;
        let ends = [(sender, self.control.to_send.take(), CONTROL), (control, self.sender.to_send.take(), SENDER)];
        for (from, into, place) in ends {
            // SAFETY: no handler runs, says the caller.
            if let (Some(handler), Some(into)) = (unsafe { from.handler.get() }, into) {
                handler.onward = Some((into, place));
            }
        }
    }

    /// Instructions from a receiver's interrupt to its byte in the other transmitter, the least; `None` if none was passed on so. It is more
    /// only by what goes before the handler: a tick.
    pub fn passed_in(&self) -> Option<u32> {
        let [.., sender, control] = &LINES;
        let [sender, control] = [sender, control].map(|end| end.passed_in.load(Ordering::Relaxed));
        Some(sender.min(control)).filter(|instructions| *instructions < u32::MAX)
    }

    /// Bytes received and lost so far, on all lines.
    pub fn lost(&self) -> u32 {
        let lines = [&self.link, &self.machine, &self.sender, &self.control];
        lines.into_iter().fold(0, |sum, line| sum.wrapping_add(line.lost()))
    }

    /// Sleeps until a byte comes, unless one waits. Interrupts are held back for the moment between looking and sleeping: one
    /// that came in it would be slept over. For when the timer stands only, as it would be late by that moment.
    pub fn sleep(&self) {
        let lines = [&self.link, &self.machine, &self.sender, &self.control];
        cortex_m::interrupt::disable();
        if lines.into_iter().all(|line| line.waiting() == 0) {
            cortex_m::asm::wfi();
        }
        // SAFETY: nothing here counts on interrupts being held back.
        unsafe { cortex_m::interrupt::enable() };
    }

    fn line(&mut self, line: lockstep::BoardLine) -> &mut Line {
        match line {
            lockstep::BoardLine::Link => &mut self.link,
            lockstep::BoardLine::Machine => &mut self.machine,
            lockstep::BoardLine::Sender => &mut self.sender,
            lockstep::BoardLine::Control => &mut self.control,
        }
    }
}

impl lockstep::BoardLines for Lines {
    fn waiting(&self, line: lockstep::BoardLine) -> usize {
        match line {
            lockstep::BoardLine::Link => self.link.waiting(),
            lockstep::BoardLine::Machine => self.machine.waiting(),
            lockstep::BoardLine::Sender => self.sender.waiting(),
            lockstep::BoardLine::Control => self.control.waiting(),
        }
    }

    fn receive(&mut self, line: lockstep::BoardLine) -> Option<u8> {
        self.line(line).receive()
    }

    fn send(&mut self, line: lockstep::BoardLine, bytes: &[u8]) -> usize {
        self.line(line).send(bytes)
    }
}

impl Line {
    /// The next byte received.
    pub fn receive(&mut self) -> Option<u8> {
        self.received.dequeue()
    }

    /// How many bytes wait.
    pub fn waiting(&self) -> usize {
        self.received.len()
    }

    /// How many bytes [`Line::send`] takes.
    pub fn room(&self) -> usize {
        self.to_send.as_ref().map_or(0, |ring| ring.capacity() - ring.len())
    }

    /// Sends bytes; as many as there is room for.
    pub fn send(&mut self, bytes: &[u8]) -> usize {
        let Some(to_send) = &mut self.to_send else { return 0 };
        let taken = bytes.iter().take_while(|byte| to_send.enqueue(**byte).is_ok()).count();
        // The handler alone touches the transmitter: it is called, and goes on by itself.
        NVIC::pend(self.hardware.uart.sent);
        taken
    }

    /// Bytes received and lost so far, as a ring was full or the receiver overrun.
    pub fn lost(&self) -> u32 {
        self.hardware.lost.load(Ordering::Relaxed)
    }

    /// Whether bytes of a tapped line are missing behind all that was received so far; asked once.
    pub fn take_gap(&mut self) -> bool {
        // In this order: while there is a gap, nothing is put behind it.
        let is_here = self.hardware.has_gap.load(Ordering::Acquire) && self.received.is_empty();
        if is_here {
            self.hardware.has_gap.store(false, Ordering::Release);
        }
        is_here
    }
}

impl Hardware {
    const fn of(uart: Uart) -> Self {
        let rings = Once::new([const { Queue::new() }; 2]);
        let (lost, passed_in) = (AtomicU32::new(0), AtomicU32::new(u32::MAX));
        Hardware { uart, handler: Handed::nothing(), rings, lost, has_gap: AtomicBool::new(false), passed_in }
    }

    fn start(&'static self) -> Option<Line> {
        let [receiving, sending] = self.rings.take()?;
        let ((into, received), (to_send, from)) = (split(receiving), split(sending));
        // SAFETY: the rings were given out for the first time: nobody uses the UART yet, the handler is not there, and its
        // interrupts, both of one priority, are not let through.
        unsafe {
            let registers = Registers::start(self.uart);
            self.handler.put(Handler { registers, received: into, to_send: from, onward: None });
            enable(self.uart.received, Priority::Second);
            enable(self.uart.sent, Priority::Second);
        }
        Some(Line { received, to_send: Some(to_send), hardware: self })
    }

    fn on_received(&self) {
        let mut began = steps();
        // SAFETY: called by the lines' handlers alone, which are of one priority.
        let Some(Handler { registers, received, onward, .. }) = (unsafe { self.handler.get() }) else { return };
        registers.acknowledge_received();
        let is_overrun = registers.take_overrun();
        let mut lost = u32::from(is_overrun);
        while let Some(byte) = registers.receive() {
            let Some((into, place)) = onward else {
                lost += u32::from(received.enqueue(byte).is_err());
                continue;
            };
            lost += u32::from(into.enqueue(byte).is_err());
            on_sent(*place);
            let passed = steps();
            let cost = InstructionCounter::of_steps(passed.wrapping_sub(began));
            self.passed_in.store(self.passed_in.load(Ordering::Relaxed).min(cost), Ordering::Relaxed);
            began = passed;
            lost += u32::from(!self.put_behind(received, byte));
        }
        if lost > 0 {
            self.lost.store(self.lost.load(Ordering::Relaxed).wrapping_add(lost), Ordering::Relaxed);
        }
        if is_overrun && onward.is_some() {
            // What the receiver lost, it lost behind the byte that it held.
            self.has_gap.store(true, Ordering::Release);
        }
    }

    /// Puts a byte behind those that wait for the main program; false, and a gap, where it has no place.
    fn put_behind(&self, received: &mut Producer<'static, u8>, byte: u8) -> bool {
        let has_place = !self.has_gap.load(Ordering::Acquire) && received.enqueue(byte).is_ok();
        if !has_place {
            self.has_gap.store(true, Ordering::Release);
        }
        has_place
    }

    fn on_sent(&self) {
        // SAFETY: as in `on_received`.
        let Some(Handler { registers, to_send, .. }) = (unsafe { self.handler.get() }) else { return };
        registers.acknowledge_sent();
        while registers.has_room() {
            let Some(byte) = to_send.dequeue() else { return };
            let _sent = registers.try_send(byte);
        }
    }
}

/// Bytes came on a line: what its receiver's handler does.
pub fn on_received(line: usize) {
    LINES.get(line).into_iter().for_each(Hardware::on_received);
}

/// Bytes received and lost so far on the sender's end of the tapped line.
pub fn lost_of_sender() -> u32 {
    let [.., sender, _] = &LINES;
    sender.lost.load(Ordering::Relaxed)
}

/// A line takes more bytes, or is asked to: what its transmitter's handler does.
pub fn on_sent(line: usize) {
    LINES.get(line).into_iter().for_each(Hardware::on_sent);
}

/// The handlers of the lines' interrupts, for images that have lines.
#[macro_export]
macro_rules! line_handlers {
    ($($line:literal $receiver:ident $transmitter:ident)+) => {
        $(
            #[unsafe(no_mangle)]
            extern "C" fn $receiver() {
                $crate::serial::on_received($line);
            }

            #[unsafe(no_mangle)]
            extern "C" fn $transmitter() {
                $crate::serial::on_sent($line);
            }
        )+
    };
    () => {
        $crate::line_handlers! { 0 UART0_RX UART0_TX 1 UART1_RX UART1_TX 2 UART2_RX UART2_TX 3 UART3_RX UART3_TX }
    };
}
