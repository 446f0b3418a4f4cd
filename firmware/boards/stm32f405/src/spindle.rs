//! TIM2, 32 bits at 1 MHz: each pulse of the tacho captures the counter and restarts it.

use arcfeed_firmware::input::tacho::TachoSample;
use stm32f4::stm32f405::TIM2;

/// Input filter: eight samples 32 clocks apart must agree; pulses below 3 us are noise.
const FILTER: u8 = 0b1111;

/// Running timer that measures the pulses of the spindle's tacho.
#[derive(Debug)]
pub struct SpindleTimer(TIM2);

impl SpindleTimer {
    /// Starts the timer, whose clock has `timer_mhz`.
    pub fn start(timer: TIM2, timer_mhz: u32) -> Self {
        // SAFETY: all values of prescaler and period are valid, the filter takes any four bits.
        unsafe {
            timer.psc().write(|w| w.bits(timer_mhz - 1));
            timer.arr().write(|w| w.bits(u32::MAX));
            timer.ccmr1_input().write(|w| w.cc1s().ti1().ic1f().bits(FILTER));
        }
        // Falling edge: the steep edge, at which the coupler pulls the pin down.
        timer.ccer().write(|w| w.cc1p().set_bit().cc1e().set_bit());
        timer.smcr().write(|w| w.ts().ti1fp1().sms().reset_mode());
        timer.egr().write(|w| w.ug().set_bit());
        timer.cr1().write(|w| w.cen().set_bit());
        SpindleTimer(timer)
    }

    /// Period before the newest pulse, if there was a pulse since the previous call, and the time since the newest pulse.
    pub fn read(&mut self) -> TachoSample {
        let is_captured = self.0.sr().read().cc1if().bit_is_set();
        // Reading the capture clears the flag.
        let period_us = is_captured.then(|| self.0.ccr1().read().bits());
        TachoSample { period_us, since_pulse_us: self.0.cnt().read().bits() }
    }
}
