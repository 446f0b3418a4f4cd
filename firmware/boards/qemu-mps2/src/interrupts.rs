//! Interrupts of the board that an image may use; the others call `DefaultHandler`.
//!
//! The tick has the highest priority and is never delayed: no image masks interrupts, and it preempts the lines'
//! handlers ([`crate::serial`]).

use cortex_m::peripheral::NVIC;

/// Interrupt numbers. A UART's transmitter has the number after its receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Interrupt {
    /// Receiver of UART 0.
    Uart0Rx = 0,
    /// Transmitter of UART 0.
    Uart0Tx = 1,
    /// Receiver of UART 1.
    Uart1Rx = 2,
    /// Transmitter of UART 1.
    Uart1Tx = 3,
    /// Receiver of UART 2.
    Uart2Rx = 4,
    /// Transmitter of UART 2.
    Uart2Tx = 5,
    /// CMSDK timer 0.
    Timer0 = 8,
    /// Receiver of UART 3.
    Uart3Rx = 18,
    /// Transmitter of UART 3.
    Uart3Tx = 19,
    /// Receiver of UART 4.
    Uart4Rx = 20,
    /// Transmitter of UART 4.
    Uart4Tx = 21,
}

/// Priorities of interrupts that this board's images use; the chip has more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Priority {
    /// Highest: the control tick.
    First = 0,
    /// The lines' bytes; the tick preempts them.
    Second = 0x40,
    /// Lowest: handlers that interrupt only the main program.
    Third = 0x80,
}

// SAFETY: the numbers are those of the board's vector table, and no two are the same.
unsafe impl cortex_m::interrupt::InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self as u16
    }
}

/// Enables an interrupt with this priority.
///
/// # Safety
/// The interrupt's handler is ready to run: its data are initialised.
pub unsafe fn enable(interrupt: Interrupt, priority: Priority) {
    let index = usize::from(interrupt as u16);
    // SAFETY: writes one byte of this interrupt in the NVIC; the caller guarantees that the handler is ready. No other
    // code writes the byte, so that no reference to the whole NVIC is needed.
    unsafe {
        let nvic = &*NVIC::PTR;
        if let Some(level) = nvic.ipr.get(index) {
            level.write(priority as u8);
        }
        NVIC::unmask(interrupt);
    }
}

/// An entry of the vector table.
#[derive(Clone, Copy)]
pub union Vector {
    handler: unsafe extern "C" fn(),
    _reserved: usize,
}

unsafe extern "C" {
    fn UART0_RX();
    fn UART0_TX();
    fn UART1_RX();
    fn UART1_TX();
    fn UART2_RX();
    fn UART2_TX();
    fn UART3_RX();
    fn UART3_TX();
    fn UART4_RX();
    fn TIMER0();
    fn DefaultHandler();
}

/// Interrupts 0 to 31; the board has more, which are never enabled.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
pub static __INTERRUPTS: [Vector; 32] = {
    let mut table = [Vector { handler: DefaultHandler }; 32];
    table[Interrupt::Uart0Rx as usize] = Vector { handler: UART0_RX };
    table[Interrupt::Uart0Tx as usize] = Vector { handler: UART0_TX };
    table[Interrupt::Uart1Rx as usize] = Vector { handler: UART1_RX };
    table[Interrupt::Uart1Tx as usize] = Vector { handler: UART1_TX };
    table[Interrupt::Uart2Rx as usize] = Vector { handler: UART2_RX };
    table[Interrupt::Uart2Tx as usize] = Vector { handler: UART2_TX };
    table[Interrupt::Uart3Rx as usize] = Vector { handler: UART3_RX };
    table[Interrupt::Uart3Tx as usize] = Vector { handler: UART3_TX };
    table[Interrupt::Uart4Rx as usize] = Vector { handler: UART4_RX };
    table[Interrupt::Timer0 as usize] = Vector { handler: TIMER0 };
    table
};
