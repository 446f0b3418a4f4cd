//! CMSDK APB watchdog: counts down, raises the NMI at the first time-out, and resets the board at the second.
//!
//! The main loop feeds it, and only after a tick, so both must be alive. The tick does not feed it, since interrupts
//! continue while the main loop hangs.

use core::sync::atomic::{AtomicU32, Ordering};

use arcfeed_units::Span;

use crate::clock::STEPS_PER_US;
use crate::reset_cause;

const LOAD: *mut u32 = 0x4000_8000 as *mut u32;
const CONTROL: *mut u32 = 0x4000_8008 as *mut u32;
/// A write clears the interrupt and restarts the counter.
const CLEAR: *mut u32 = 0x4000_800C as *mut u32;
const LOCK: *mut u32 = 0x4000_8C00 as *mut u32;
/// Value that unlocks the other registers.
const UNLOCKED: u32 = 0x1ACC_E551;
const LOCKED: u32 = 0;
/// Control: counting with interrupt; reset by the second time-out.
const RUNNING: u32 = 0b11;

/// Time from the last feeding to the interrupt, and again from there to the reset. A third of the time after which a
/// silent host counts as lost.
pub const TIMEOUT: Span = Span::from_ms(100);

/// Count of the tick after which it was fed last.
static FED_AT: AtomicU32 = AtomicU32::new(0);

/// The running watchdog, which resets the board unless the main loop feeds it in time.
#[derive(Debug)]
pub struct Watchdog(());

/// Number of ticks at the time of the last feeding.
pub fn fed_at() -> u32 {
    FED_AT.load(Ordering::Relaxed)
}

impl Watchdog {
    /// Starts the watchdog; it cannot be stopped.
    ///
    /// # Safety
    /// The handler of the NMI is ready to run.
    pub unsafe fn start() -> Self {
        reset_cause::note_guarded();
        // SAFETY: registers of the watchdog, which no other code uses; the caller guarantees that the handler is
        // ready.
        unsafe {
            LOCK.write_volatile(UNLOCKED);
            LOAD.write_volatile(TIMEOUT.0 * STEPS_PER_US);
            CONTROL.write_volatile(RUNNING);
            LOCK.write_volatile(LOCKED);
        }
        Watchdog(())
    }

    /// Feeds the watchdog if there was a tick since the last feeding; `ticks` is the number of ticks so far. To be
    /// called in each iteration of the main loop.
    pub fn feed_after_tick(&mut self, ticks: u32) {
        if ticks == fed_at() {
            return;
        }
        FED_AT.store(ticks, Ordering::Relaxed);
        // SAFETY: as in `start`.
        unsafe {
            LOCK.write_volatile(UNLOCKED);
            CLEAR.write_volatile(1);
            LOCK.write_volatile(LOCKED);
        }
    }
}
