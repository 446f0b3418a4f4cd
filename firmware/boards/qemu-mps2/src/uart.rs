//! Registers of a CMSDK APB UART.
//!
//! It has a buffer of one byte in each direction. In QEMU a byte is sent as soon as it is written, and the peer waits
//! while the receiver is full. The chip does neither, and this code does not rely on it.

use crate::interrupts::Interrupt;

/// Register offsets: state, control, interrupts, baud rate divider.
const STATE: usize = 0x04;
const CONTROL: usize = 0x08;
const INTERRUPTS: usize = 0x0C;
const DIVIDER: usize = 0x10;
/// State bits: transmitter full, receiver full, receiver overrun.
const TX_FULL: u32 = 1;
const RX_FULL: u32 = 1 << 1;
const RX_OVERRUN: u32 = 1 << 3;
/// Control bits: transmitter and receiver on, with their interrupts.
const BOTH_ON: u32 = 0b1111;
const TX_ON: u32 = 1;
/// Interrupt bits, written to acknowledge.
const TX_SENT: u32 = 1;
const RX_RECEIVED: u32 = 1 << 1;
/// 25 MHz / 217 = 115 207 Bd.
const DIVISOR: u32 = 217;

/// A UART of the board: address of its registers, and its interrupts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Uart {
    base: usize,
    /// Interrupt of a received byte.
    pub received: Interrupt,
    /// Interrupt of the transmitter, which can take a byte again.
    pub sent: Interrupt,
}

/// UART 0.
pub const UART0: Uart = Uart { base: 0x4000_4000, received: Interrupt::Uart0Rx, sent: Interrupt::Uart0Tx };
/// UART 1.
pub const UART1: Uart = Uart { base: 0x4000_5000, received: Interrupt::Uart1Rx, sent: Interrupt::Uart1Tx };
/// UART 2.
pub const UART2: Uart = Uart { base: 0x4000_6000, received: Interrupt::Uart2Rx, sent: Interrupt::Uart2Tx };
/// UART 3.
pub const UART3: Uart = Uart { base: 0x4000_7000, received: Interrupt::Uart3Rx, sent: Interrupt::Uart3Tx };
/// UART 4, for which no productive image has a handler.
pub const UART4: Uart = Uart { base: 0x4000_9000, received: Interrupt::Uart4Rx, sent: Interrupt::Uart4Tx };

/// The registers of a UART, for its only user.
#[derive(Debug)]
pub struct Registers {
    base: usize,
}

impl Registers {
    /// Starts transmitter and receiver with their interrupts.
    ///
    /// # Safety
    /// No other code uses this UART.
    pub unsafe fn start(uart: Uart) -> Self {
        let registers = Registers { base: uart.base };
        registers.write(DIVIDER, DIVISOR);
        registers.write(CONTROL, BOTH_ON);
        registers
    }

    /// Starts the transmitter without interrupts.
    ///
    /// # Safety
    /// No other code uses this UART.
    pub unsafe fn start_transmitter(uart: Uart) -> Self {
        let registers = Registers { base: uart.base };
        registers.write(DIVIDER, DIVISOR);
        registers.write(CONTROL, TX_ON);
        registers
    }

    /// The registers of a UART that is already running, for a new user such as a fault handler.
    ///
    /// # Safety
    /// No other code uses this UART any more.
    pub unsafe fn seize(uart: Uart) -> Self {
        Registers { base: uart.base }
    }

    /// Sends a byte unless the transmitter is full; returns whether it was sent.
    pub fn try_send(&mut self, byte: u8) -> bool {
        let has_room = self.has_room();
        if has_room {
            self.write(0, u32::from(byte));
        }
        has_room
    }

    /// Whether the transmitter accepts a byte.
    pub fn has_room(&self) -> bool {
        self.read(STATE) & TX_FULL == 0
    }

    /// The byte received, if there is one.
    pub fn receive(&mut self) -> Option<u8> {
        (self.read(STATE) & RX_FULL != 0).then(|| self.read(0) as u8)
    }

    /// Whether the receiver was overrun since the last call.
    pub fn take_overrun(&mut self) -> bool {
        let is_overrun = self.read(STATE) & RX_OVERRUN != 0;
        if is_overrun {
            self.write(STATE, RX_OVERRUN);
        }
        is_overrun
    }

    /// Acknowledges the receiver's interrupt.
    pub fn acknowledge_received(&mut self) {
        self.write(INTERRUPTS, RX_RECEIVED);
    }

    /// Acknowledges the transmitter's interrupt.
    pub fn acknowledge_sent(&mut self) {
        self.write(INTERRUPTS, TX_SENT);
    }

    fn read(&self, register: usize) -> u32 {
        // SAFETY: a register of the UART whose only user this is.
        unsafe { ((self.base + register) as *const u32).read_volatile() }
    }

    fn write(&self, register: usize, value: u32) {
        // SAFETY: a register of the UART whose only user this is.
        unsafe { ((self.base + register) as *mut u32).write_volatile(value) }
    }
}
