//! CMSDK timer 0: interrupt of the tick.

use crate::clock::STEPS_PER_US;
use crate::interrupts::{Interrupt, Priority, enable};

const CONTROL: *mut u32 = 0x4000_0000 as *mut u32;
const VALUE: *mut u32 = 0x4000_0004 as *mut u32;
const RELOAD: *mut u32 = 0x4000_0008 as *mut u32;
const CLEAR: *mut u32 = 0x4000_000C as *mut u32;
/// Counting, with interrupt.
const RUNNING: u32 = 1 | (1 << 3);

/// Starts the timer of the control tick with this period, microseconds.
///
/// # Safety
/// `TIMER0` is ready to run: its data are initialised.
pub unsafe fn start(period_us: u32) {
    // SAFETY: registers of timer 0, which no other code uses; the caller guarantees that the handler is ready.
    unsafe {
        RELOAD.write_volatile(period_us * STEPS_PER_US - 1);
        VALUE.write_volatile(period_us * STEPS_PER_US - 1);
        CONTROL.write_volatile(RUNNING);
        enable(Interrupt::Timer0, Priority::First);
    }
}

/// Number of clock steps since the tick was due, while its handler runs; `None` if the timer is stopped.
pub fn late_steps() -> Option<u32> {
    // SAFETY: reading has no effect on the timer.
    let (control, value, reload) = unsafe { (CONTROL.read_volatile(), VALUE.read_volatile(), RELOAD.read_volatile()) };
    (control == RUNNING).then(|| reload.wrapping_sub(value))
}

/// Stops the timer, so that no further tick comes from it.
pub fn stop() {
    // SAFETY: registers of timer 0.
    unsafe { CONTROL.write_volatile(0) };
}

/// Acknowledges the timer's interrupt; to be called by its handler.
pub fn acknowledge() {
    // SAFETY: registers of timer 0.
    unsafe { CLEAR.write_volatile(1) };
}
