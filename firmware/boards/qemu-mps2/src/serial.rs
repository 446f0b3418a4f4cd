//! Serial lines with a ring buffer in each direction, filled and emptied by interrupts.
//!
//! ```text
//! receiver -> UARTn_RX -> ring -> main program -> ring -> UARTn_TX -> transmitter
//! ```
//!
//! When the board runs free, the receivers' handlers forward the bytes of the tapped line themselves; the main program
//! reads them later:
//!
//! ```text
//! receiver -> UARTn_RX -+-> ring of the other line -> its transmitter
//!                       +-> ring -> main program
//! ```
//!
//! Rings have one producer and one consumer and need no lock, so a line delays only its own bytes. Bytes that find a
//! ring full are dropped and counted; the higher protocols detect the loss.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use arcfeed_board_app::lockstep;
use arcfeed_board_app::spsc::{Consumer, Producer, split};
use cortex_m::peripheral::NVIC;
use heapless::spsc::Queue;

use crate::clock::{InstructionCounter, steps};
use crate::handed::{Handed, Once};
use crate::interrupts::{Priority, enable};
use crate::uart::{Registers, UART0, UART1, UART2, UART3, Uart};

/// Size of each ring buffer, one more than the bytes that it holds. At 115 200 Bd it fills in 89 ms.
pub const RING: usize = 1024;

/// Hardware and shared state of a line.
struct Hardware {
    uart: Uart,
    handler: Handed<Handler>,
    rings: Once<[Queue<u8, RING>; 2]>,
    lost: AtomicU32,
    /// Whether a byte was lost after the waiting ones; no further byte is added until the main program has noticed.
    has_gap: AtomicBool,
    /// Instructions for forwarding a byte if the handler was not interrupted.
    passed_in: AtomicU32,
}

/// State of a line's handlers.
struct Handler {
    registers: Registers,
    received: Producer<'static, u8>,
    to_send: Consumer<'static, u8>,
    /// Destination of forwarded bytes: the ring of another line, and the index of that line.
    onward: Option<(Producer<'static, u8>, usize)>,
}

/// Indices of the two ends of the tapped line.
const SENDER: usize = 2;
const CONTROL: usize = 3;

static LINES: [Hardware; 4] = [Hardware::of(UART0), Hardware::of(UART1), Hardware::of(UART2), Hardware::of(UART3)];

/// The main program's end of one serial line.
pub struct Line {
    received: Consumer<'static, u8>,
    /// `None` after it was moved to another line's handler.
    to_send: Option<Producer<'static, u8>>,
    hardware: &'static Hardware,
}

/// The serial lines of the board, running.
pub struct Lines {
    /// UART 0: line to the host.
    pub link: Line,
    /// UART 1: line to the simulated machine.
    pub machine: Line,
    /// UART 2: line to the sender of the NC program.
    pub sender: Line,
    /// UART 3: line to the control.
    pub control: Line,
}

impl Lines {
    /// Starts all lines; `None` if they were started before.
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
    /// Makes the receivers' handlers forward the bytes of the tapped line from now on; the main program only reads
    /// them.
    ///
    /// # Safety
    /// Interrupts are disabled.
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

    /// Smallest number of instructions from the interrupt of a received byte until the byte is in the other line's
    /// transmitter; `None` if no byte was forwarded. A tick that preempts the handler lengthens it.
    pub fn passed_in(&self) -> Option<u32> {
        let [.., sender, control] = &LINES;
        let [sender, control] = [sender, control].map(|end| end.passed_in.load(Ordering::Relaxed));
        Some(sender.min(control)).filter(|instructions| *instructions < u32::MAX)
    }

    /// Number of bytes lost on all lines together since the start.
    pub fn lost(&self) -> u32 {
        let lines = [&self.link, &self.machine, &self.sender, &self.control];
        lines.into_iter().fold(0, |sum, line| sum.wrapping_add(line.lost()))
    }

    /// Sleeps until a byte arrives, unless one waits. Interrupts are disabled between the check and the sleep, so that
    /// no byte is missed. Only for use with a stopped timer, which would be delayed by that time.
    pub fn sleep(&self) {
        let lines = [&self.link, &self.machine, &self.sender, &self.control];
        cortex_m::interrupt::disable();
        if lines.into_iter().all(|line| line.waiting() == 0) {
            cortex_m::asm::wfi();
        }
        // SAFETY: no code here relies on disabled interrupts.
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
    /// The next received byte; `None` if none waits.
    pub fn receive(&mut self) -> Option<u8> {
        self.received.dequeue()
    }

    /// Number of received bytes that wait.
    pub fn waiting(&self) -> usize {
        self.received.len()
    }

    /// Number of bytes that [`Line::send`] accepts at present.
    pub fn room(&self) -> usize {
        self.to_send.as_ref().map_or(0, |ring| ring.capacity() - ring.len())
    }

    /// Queues as many of these bytes as fit into the buffer to be sent; returns their number.
    pub fn send(&mut self, bytes: &[u8]) -> usize {
        let Some(to_send) = &mut self.to_send else { return 0 };
        let taken = bytes.iter().take_while(|byte| to_send.enqueue(**byte).is_ok()).count();
        // Only the handler accesses the transmitter: this triggers it.
        NVIC::pend(self.hardware.uart.sent);
        taken
    }

    /// Number of bytes of this line that were lost because a buffer was full or the receiver was overrun.
    pub fn lost(&self) -> u32 {
        self.hardware.lost.load(Ordering::Relaxed)
    }

    /// Whether bytes of a tapped line are missing after those received so far; reads and clears the flag.
    pub fn take_gap(&mut self) -> bool {
        // In this order: while there is a gap, no byte is added after it.
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
        // SAFETY: the rings can be taken only once, so no other code uses the UART yet. The handler is not set, and its
        // interrupts, both of one priority, are still disabled.
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
        // SAFETY: called only by the lines' handlers, which have the same priority.
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
            // An overrun loses the byte after the one in the receiver.
            self.has_gap.store(true, Ordering::Release);
        }
    }

    /// Adds a byte for the main program. Returns false and sets the gap if there is no room.
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

/// To be called by the interrupt handler of the receiver of the line with this index (UART number).
pub fn on_received(line: usize) {
    LINES.get(line).into_iter().for_each(Hardware::on_received);
}

/// Number of bytes lost on the tapped line's end towards the sender.
pub fn lost_of_sender() -> u32 {
    let [.., sender, _] = &LINES;
    sender.lost.load(Ordering::Relaxed)
}

/// To be called by the interrupt handler of the transmitter of the line with this index (UART number).
pub fn on_sent(line: usize) {
    LINES.get(line).into_iter().for_each(Hardware::on_sent);
}

/// Defines the handlers of the lines' interrupts, for images with lines.
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
