//! Lines with a ring of bytes either way, filled and emptied by interrupts.
//!
//! ```text
//! receiver -> UARTn_RX -> ring -> main program -> ring -> UARTn_TX -> transmitter
//! ```
//!
//! Rings have one producer and one consumer and need no lock, so a line holds up nothing but its own bytes. What finds a
//! ring full is dropped and counted: the protocols above find it missing, and the count says where it went.

use core::sync::atomic::{AtomicU32, Ordering};

use arcfeed_firmware::lockstep;
use arcfeed_firmware::spsc::{Consumer, Producer, split};
use cortex_m::peripheral::NVIC;
use heapless::spsc::Queue;

use crate::handed::{Handed, Once};
use crate::interrupts::{Interrupt, Priority, enable};
use crate::uart::{Registers, UART0, UART1, UART2, UART3, Uart};

/// Bytes of each ring, less one. At 115 200 Bd it fills in 89 ms.
pub const RING: usize = 1024;

/// What there is once of each line.
struct Hardware {
    uart: Uart,
    handler: Handed<Handler>,
    rings: Once<[Queue<u8, RING>; 2]>,
    lost: AtomicU32,
}

/// What the handlers of a line own.
struct Handler {
    registers: Registers,
    received: Producer<'static, u8>,
    to_send: Consumer<'static, u8>,
}

static LINES: [Hardware; 4] = [Hardware::of(UART0), Hardware::of(UART1), Hardware::of(UART2), Hardware::of(UART3)];

/// The main program's end of a line.
pub struct Line {
    received: Consumer<'static, u8>,
    to_send: Producer<'static, u8>,
    sent: Interrupt,
    lost: &'static AtomicU32,
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

    fn line(&mut self, line: lockstep::Line) -> &mut Line {
        match line {
            lockstep::Line::Link => &mut self.link,
            lockstep::Line::Machine => &mut self.machine,
            lockstep::Line::Sender => &mut self.sender,
            lockstep::Line::Control => &mut self.control,
        }
    }
}

impl lockstep::Lines for Lines {
    fn waiting(&self, line: lockstep::Line) -> usize {
        match line {
            lockstep::Line::Link => self.link.waiting(),
            lockstep::Line::Machine => self.machine.waiting(),
            lockstep::Line::Sender => self.sender.waiting(),
            lockstep::Line::Control => self.control.waiting(),
        }
    }

    fn receive(&mut self, line: lockstep::Line) -> Option<u8> {
        self.line(line).receive()
    }

    fn send(&mut self, line: lockstep::Line, bytes: &[u8]) -> usize {
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
        self.to_send.capacity() - self.to_send.len()
    }

    /// Sends bytes; as many as there is room for.
    pub fn send(&mut self, bytes: &[u8]) -> usize {
        let taken = bytes.iter().take_while(|byte| self.to_send.enqueue(**byte).is_ok()).count();
        // The handler alone touches the transmitter: it is called, and goes on by itself.
        NVIC::pend(self.sent);
        taken
    }

    /// Bytes received and lost so far, as the ring was full or the receiver overrun.
    pub fn lost(&self) -> u32 {
        self.lost.load(Ordering::Relaxed)
    }
}

impl Hardware {
    const fn of(uart: Uart) -> Self {
        let rings = Once::new([const { Queue::new() }; 2]);
        Hardware { uart, handler: Handed::nothing(), rings, lost: AtomicU32::new(0) }
    }

    fn start(&'static self) -> Option<Line> {
        let [receiving, sending] = self.rings.take()?;
        let ((into, received), (to_send, from)) = (split(receiving), split(sending));
        // SAFETY: the rings were given out for the first time: nobody uses the UART yet, the handler is not there, and its
        // interrupts, both of one priority, are not let through.
        unsafe {
            let registers = Registers::start(self.uart);
            self.handler.put(Handler { registers, received: into, to_send: from });
            enable(self.uart.received, Priority::Second);
            enable(self.uart.sent, Priority::Second);
        }
        Some(Line { received, to_send, sent: self.uart.sent, lost: &self.lost })
    }

    fn on_received(&self) {
        // SAFETY: called by this line's handlers alone, which are of one priority.
        let Some(Handler { registers, received, .. }) = (unsafe { self.handler.get() }) else { return };
        registers.acknowledge_received();
        let mut lost = u32::from(registers.take_overrun());
        while let Some(byte) = registers.receive() {
            lost += u32::from(received.enqueue(byte).is_err());
        }
        if lost > 0 {
            self.lost.store(self.lost.load(Ordering::Relaxed).wrapping_add(lost), Ordering::Relaxed);
        }
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
