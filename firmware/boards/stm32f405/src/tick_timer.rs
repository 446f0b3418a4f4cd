//! TIM5: the interrupt of every millisecond that is the tick.

use stm32f4::stm32f405::{Interrupt, NVIC, TIM5};

/// Counts of 1 us in a tick.
const PERIOD_US: u32 = 1_000;

/// The timer, running.
#[derive(Debug)]
pub struct TickTimer(TIM5);

impl TickTimer {
    /// Starts the timer, which runs at `timer_mhz`; its interrupt waits for [`allow`].
    pub fn start(timer: TIM5, timer_mhz: u32) -> Self {
        // SAFETY: all values of prescaler and period are valid.
        unsafe {
            timer.psc().write(|w| w.bits(timer_mhz - 1));
            timer.arr().write(|w| w.bits(PERIOD_US - 1));
        }
        // Loads the prescaler, which sets the flag as an overflow would.
        timer.egr().write(|w| w.ug().set_bit());
        timer.sr().write(|w| w.uif().clear_bit());
        timer.dier().write(|w| w.uie().set_bit());
        timer.cr1().write(|w| w.cen().set_bit());
        TickTimer(timer)
    }

    /// Takes the interrupt back, from its handler.
    pub fn acknowledge(&mut self) {
        self.0.sr().write(|w| w.uif().clear_bit());
    }

    /// Whether the next tick is due already; asked at the end of one.
    pub fn is_late(&self) -> bool {
        self.0.sr().read().uif().bit_is_set()
    }
}

/// Lets the tick begin.
///
/// # Safety
/// The handler of `TIM5` is ready to run: what it uses is in place, and nobody else uses it.
pub unsafe fn allow() {
    // SAFETY: the handler is ready, says the caller.
    unsafe { NVIC::unmask(Interrupt::TIM5) };
}
