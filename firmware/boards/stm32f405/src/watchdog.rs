//! The independent watchdog: runs from an oscillator of its own and cannot be stopped.
//!
//! When it fires it resets the chip: the pins float, the couplers let go, the control reads 0 %; the next start reports it. It is
//! fed by the main loop, and only after a tick, so both must live.

use stm32f4::stm32f405::IWDG;

/// The oscillator divided by 8: 4 kHz, of which this many are 25 ms. It lies between 17 and 47 kHz: 17 to 47 ms.
const STEPS: u16 = 100;
/// Reads of the flags until the settings are taken over: five periods of the oscillator at most.
const POLLS_MAX: u32 = 100_000;

/// The running watchdog.
#[derive(Debug)]
pub struct Watchdog(IWDG);

impl Watchdog {
    /// Starts it.
    pub fn start(iwdg: IWDG) -> Self {
        iwdg.kr().write(|w| w.key().start());
        iwdg.kr().write(|w| w.key().unlock());
        iwdg.pr().write(|w| w.pr().divide_by8());
        // SAFETY: the field takes any twelve bits.
        iwdg.rlr().write(|w| unsafe { w.rl().bits(STEPS) });
        // If they are not taken over, it fires later than wanted, but it fires.
        let _ = (0..POLLS_MAX).any(|_| iwdg.sr().read().bits() == 0);
        let mut watchdog = Watchdog(iwdg);
        watchdog.feed();
        watchdog
    }

    /// Lets it wait for another 25 ms.
    pub fn feed(&mut self) {
        self.0.kr().write(|w| w.key().feed());
    }
}
