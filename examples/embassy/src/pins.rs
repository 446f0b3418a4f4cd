//! The eight override lines *FV0 to *FV7 on GPIO 0 of the board. On a chip these are the pins of its HAL.

use core::convert::Infallible;

use embedded_hal::digital::{ErrorType, OutputPin};

/// CMSDK GPIO 0: data output. QEMU accepts writes and drives nothing.
const DATA_OUT: *mut u32 = 0x4001_0004 as *mut u32;
/// CMSDK GPIO 0: output enable.
const ENABLE: *mut u32 = 0x4001_0010 as *mut u32;
/// CMSDK GPIO 0: the lower byte through a mask. Writing to `MASKED + 4 * mask` changes only the bits in the mask.
const MASKED: usize = 0x4001_0400;
const LINES: usize = 8;

/// One line. High releases it.
pub struct Pin {
    bit: usize,
}

impl ErrorType for Pin {
    type Error = Infallible;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.write(0);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.write(u32::MAX);
        Ok(())
    }
}

impl Pin {
    fn write(&mut self, level: u32) {
        let register = (MASKED + 4 * (1 << self.bit)) as *mut u32;
        // SAFETY: a register of GPIO 0 that changes this pin alone.
        unsafe { register.write_volatile(level) }
    }
}

/// *FV0 to *FV7.
pub fn override_lines() -> [Pin; LINES] {
    release_all();
    // SAFETY: a register of GPIO 0; the pins are released.
    unsafe { ENABLE.write_volatile(0xFF) }
    core::array::from_fn(|bit| Pin { bit })
}

/// Releases all lines: 0 %.
pub fn release_all() {
    // SAFETY: a register of GPIO 0, of which this program uses the eight lines only.
    unsafe { DATA_OUT.write_volatile(u32::MAX) }
}
