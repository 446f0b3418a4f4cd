//! CMSDK UART, transmitting only.

/// Data, state, control and baud rate divider.
const STATE: usize = 0x04;
const CONTROL: usize = 0x08;
const DIVIDER: usize = 0x10;
/// State: the transmitter holds a byte. Control: transmitter on.
const TX_FULL: u32 = 1;
const TX_ON: u32 = 1;
/// 25 MHz / 217 = 115 207 Bd.
const DIVISOR: u32 = 217;
/// UART 1 of the board.
pub const UART1: usize = 0x4000_5000;

/// A transmitter.
#[derive(Debug)]
pub struct Transmitter {
    base: usize,
}

impl Transmitter {
    /// Switches the transmitter on.
    ///
    /// # Safety
    /// `base` is that of a UART that nobody else uses.
    pub unsafe fn new(base: usize) -> Self {
        // SAFETY: as required of the caller.
        unsafe {
            ((base + DIVIDER) as *mut u32).write_volatile(DIVISOR);
            ((base + CONTROL) as *mut u32).write_volatile(TX_ON);
        }
        Transmitter { base }
    }

    /// Sends a byte, unless the one before is still under way.
    pub fn try_send(&mut self, byte: u8) -> bool {
        // SAFETY: registers of the UART that `new` was promised.
        unsafe {
            if ((self.base + STATE) as *const u32).read_volatile() & TX_FULL != 0 {
                return false;
            }
            (self.base as *mut u32).write_volatile(u32::from(byte));
        }
        true
    }
}
