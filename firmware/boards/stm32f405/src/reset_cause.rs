//! Cause of the start from the flags of RCC_CSR, and the resulting fault.

use arcfeed_firmware::supervisor::signals::BoardFault;

/// RCC_CSR: brown-out (set at power-on too), power-on, independent and window watchdog.
const BROWN_OUT: u32 = 1 << 25;
const POWER_ON: u32 = 1 << 27;
const INDEPENDENT_WATCHDOG: u32 = 1 << 29;
const WINDOW_WATCHDOG: u32 = 1 << 30;

/// Fault that the cause of the last reset stands for, from the value of register RCC_CSR; to be reported at the first
/// tick. `None` for a start by power, pin, software or debugger.
pub fn fault(rcc_csr: u32) -> Option<BoardFault> {
    if rcc_csr & (INDEPENDENT_WATCHDOG | WINDOW_WATCHDOG) != 0 {
        Some(BoardFault::Watchdog)
    } else if rcc_csr & BROWN_OUT != 0 && rcc_csr & POWER_ON == 0 {
        Some(BoardFault::Hardware)
    } else {
        None
    }
}
