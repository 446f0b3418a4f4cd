//! Clock tree: 168 MHz from a crystal of 8 MHz, supervised by the clock security system.
//!
//! ```text
//! HSE 8 MHz / 4 -> 2 MHz x 168 -> 336 MHz / 2 -> SYSCLK 168 MHz = AHB -> APB1 / 4: 42 MHz, its timers 84 MHz
//!                                                                     -> APB2 / 2: 84 MHz
//! ```
//!
//! Without the crystal the chip continues with its internal 16 MHz clock. It is accurate enough to hold 0 % and report
//! the fault, but not to time a cut: a board fault until the next start. All waits are bounded.

use core::sync::atomic::{AtomicBool, Ordering};

use stm32f4::stm32f405::{FLASH, PWR, RCC, rcc};

/// Frequencies of the core and of the timers.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    /// Frequency of the core, MHz.
    pub core_mhz: u32,
    /// Frequency of the timers on APB1, MHz.
    pub timer_mhz: u32,
}

const FROM_CRYSTAL: Clock = Clock { core_mhz: 168, timer_mhz: 84 };
const OWN: Clock = Clock { core_mhz: 16, timer_mhz: 16 };

/// Maximum number of reads of a flag: about 20 ms at 16 MHz; a crystal needs 2 ms.
const POLLS_MAX: u32 = 50_000;
/// Flash wait states at 168 MHz and 3.3 V.
const WAIT_STATES: u8 = 5;

static FAILED: AtomicBool = AtomicBool::new(false);

/// Whether the crystal has not started, or has stopped since.
pub fn has_failed() -> bool {
    FAILED.load(Ordering::Relaxed)
}

/// Switches the clocks of all used peripherals on; must be called before anything else.
pub fn supply(rcc: &RCC) {
    rcc.ahb1enr().modify(|_, w| w.gpioaen().enabled().gpioben().enabled().gpiocen().enabled());
    rcc.apb1enr().modify(|_, w| w.pwren().enabled().tim2en().enabled().tim3en().enabled());
    rcc.apb1enr().modify(|_, w| w.tim4en().enabled().tim5en().enabled());
    rcc.apb2enr().modify(|_, w| w.tim1en().enabled().adc1en().enabled());
    // A peripheral accepts no write in the first cycles of its clock (errata, "delay after an RCC peripheral clock
    // enabling"); reading back takes longer than that.
    let _ = (rcc.ahb1enr().read().bits(), rcc.apb1enr().read().bits(), rcc.apb2enr().read().bits());
}

/// Switches to the crystal and 168 MHz; without the crystal the chip keeps its internal clock, and [`has_failed`]
/// returns true. Returns the frequencies.
pub fn start(rcc: &RCC, flash: &FLASH, pwr: &PWR) -> Clock {
    if start_from_crystal(rcc, flash, pwr).is_some() {
        return FROM_CRYSTAL;
    }
    FAILED.store(true, Ordering::Relaxed);
    rcc.cfgr().modify(|_, w| w.sw().hsi().ppre1().div1().ppre2().div1());
    rcc.cr().modify(|_, w| w.pllon().off().hseon().off());
    OWN
}

/// Handles the stop of the crystal, in the NMI that the clock security system raises: the chip now runs on its
/// internal clock.
pub fn take_failure(rcc: &rcc::RegisterBlock) {
    FAILED.store(true, Ordering::Relaxed);
    rcc.cir().modify(|_, w| w.cssc().set_bit());
}

fn start_from_crystal(rcc: &RCC, flash: &FLASH, pwr: &PWR) -> Option<()> {
    pwr.cr().modify(|_, w| w.vos().scale1());
    rcc.cr().modify(|_, w| w.hseon().on());
    wait_until(|| rcc.cr().read().hserdy().bit_is_set())?;
    // SAFETY: 4, 168 and 7 are within what the fields may hold (RM0090, RCC_PLLCFGR).
    rcc.pllcfgr().write(|w| unsafe { w.pllsrc().hse().pllm().bits(4).plln().bits(168).pllp().div2().pllq().bits(7) });
    rcc.cr().modify(|_, w| w.pllon().on());
    wait_until(|| rcc.cr().read().pllrdy().bit_is_set())?;
    // SAFETY: any number of wait states up to 7 is valid; too few would not be, and the chip confirms these below.
    flash
        .acr()
        .write(|w| unsafe { w.latency().bits(WAIT_STATES).prften().set_bit().icen().set_bit().dcen().set_bit() });
    wait_until(|| flash.acr().read().latency().bits() == WAIT_STATES)?;
    rcc.cfgr().modify(|_, w| w.hpre().div1().ppre1().div4().ppre2().div2());
    rcc.cfgr().modify(|_, w| w.sw().pll());
    wait_until(|| rcc.cfgr().read().sws().is_pll())?;
    rcc.cr().modify(|_, w| w.csson().on());
    Some(())
}

fn wait_until(condition: impl Fn() -> bool) -> Option<()> {
    (0..POLLS_MAX).any(|_| condition()).then_some(())
}
