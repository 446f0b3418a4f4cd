//! The independent watchdog, with its own oscillator; it cannot be stopped.
//!
//! It resets the chip: the pins float, the couplers release, the control reads 0 %, and the next start reports it. The
//! main loop feeds it, and only after a tick, so both must be alive.

use stm32f4::stm32f405::IWDG;

/// Steps of the oscillator divided by 8 (4 kHz): 25 ms. The oscillator is between 17 and 47 kHz: 17 to 47 ms.
const STEPS: u16 = 100;
/// Maximum number of reads of the flags until the settings are applied, which takes at most five periods of the
/// oscillator.
const POLLS_MAX: u32 = 100_000;

/// The running watchdog, which resets the chip if it is not fed for 25 ms.
#[derive(Debug)]
pub struct Watchdog(IWDG);

impl Watchdog {
    /// Starts the watchdog, which cannot be stopped afterwards.
    pub fn start(iwdg: IWDG) -> Self {
        iwdg.kr().write(|w| w.key().start());
        iwdg.kr().write(|w| w.key().unlock());
        iwdg.pr().write(|w| w.pr().divide_by8());
        // SAFETY: the field takes any twelve bits.
        iwdg.rlr().write(|w| unsafe { w.rl().bits(STEPS) });
        // If they are not applied, the time-out is longer, but the watchdog works.
        let _ = (0..POLLS_MAX).any(|_| iwdg.sr().read().bits() == 0);
        let mut watchdog = Watchdog(iwdg);
        watchdog.feed();
        watchdog
    }

    /// Restarts the time-out of 25 ms.
    pub fn feed(&mut self) {
        self.0.kr().write(|w| w.key().feed());
    }
}
