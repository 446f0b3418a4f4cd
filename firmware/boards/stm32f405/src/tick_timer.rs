//! TIM5: interrupt of the tick, every millisecond.

use stm32f4::stm32f405::{Interrupt, NVIC, TIM5};

/// Period of the tick in counts of 1 us.
const PERIOD_US: u32 = 1_000;

/// Running timer that starts the control tick every millisecond.
#[derive(Debug)]
pub struct TickTimer(TIM5);

impl TickTimer {
    /// Starts the timer, whose clock has `timer_mhz`; its interrupt is enabled by [`allow`].
    pub fn start(timer: TIM5, timer_mhz: u32) -> Self {
        // SAFETY: all values of prescaler and period are valid.
        unsafe {
            timer.psc().write(|w| w.bits(timer_mhz - 1));
            timer.arr().write(|w| w.bits(PERIOD_US - 1));
        }
        // Loads the prescaler; this sets the flag like an overflow.
        timer.egr().write(|w| w.ug().set_bit());
        timer.sr().write(|w| w.uif().clear_bit());
        timer.dier().write(|w| w.uie().set_bit());
        timer.cr1().write(|w| w.cen().set_bit());
        TickTimer(timer)
    }

    /// Acknowledges the timer's interrupt; to be called by its handler.
    pub fn acknowledge(&mut self) {
        self.0.sr().write(|w| w.uif().clear_bit());
    }

    /// Whether the next tick is already due; to be asked at the end of a tick.
    pub fn is_late(&self) -> bool {
        self.0.sr().read().uif().bit_is_set()
    }
}

/// Enables the interrupt of the tick timer.
///
/// # Safety
/// The handler of `TIM5` is ready to run: its data are initialised and have no other user.
pub unsafe fn allow() {
    // SAFETY: the caller guarantees that the handler is ready.
    unsafe { NVIC::unmask(Interrupt::TIM5) };
}
