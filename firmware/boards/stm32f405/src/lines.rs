//! *FV0 to *FV7 on port C: eight pins in one write, read back before the next.

use arcfeed_firmware::output::port_lines::LinePort;
use embedded_hal::delay::DelayNs;
use stm32f4::stm32f405::GPIOC;

use crate::pins::{HEARTBEAT, LINES, READY};

const NS_PER_US: u32 = 1_000;

/// The port.
#[derive(Debug)]
pub struct FvPort {
    port: GPIOC,
    told: Option<u8>,
}

/// Pins that are not as they were told: shorted, or overloaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PinsDiffer {
    /// Bit i for *FVi.
    pub pins: u8,
}

/// Waits by counting cycles.
#[derive(Clone, Copy, Debug)]
pub struct CycleDelay {
    /// Of the core.
    pub core_mhz: u32,
}

impl FvPort {
    /// The port, set up by [`crate::pins`].
    pub fn new(port: GPIOC) -> Self {
        FvPort { port, told: None }
    }
}

impl LinePort for FvPort {
    type Error = PinsDiffer;

    fn write(&mut self, levels: u8) -> Result<(), PinsDiffer> {
        let held = self.port.idr().read().bits() as u8;
        let pins = self.told.map_or(0, |told| told ^ held);
        // SAFETY: the lines are this port's.
        unsafe { write(LINES & u32::from(levels), LINES & !u32::from(levels)) };
        self.told = Some(levels);
        if pins == 0 { Ok(()) } else { Err(PinsDiffer { pins }) }
    }
}

impl DelayNs for CycleDelay {
    /// Rounded up, and at most 25 ms at 168 MHz: there the product saturates.
    fn delay_ns(&mut self, ns: u32) {
        cortex_m::asm::delay(ns.saturating_mul(self.core_mhz).div_ceil(NS_PER_US));
    }
}

/// Ready and heartbeat, beside the lines on the same port.
#[derive(Debug)]
pub struct StatusPins(());

impl StatusPins {
    /// The status pins of the port that `lines` owns.
    pub fn beside(_lines: &FvPort) -> Self {
        StatusPins(())
    }

    /// Says whether no fault is latched.
    pub fn set_ready(&mut self, ready: bool) {
        Self::pull(READY, ready);
    }

    /// Says that the tick runs.
    pub fn set_heartbeat(&mut self, low: bool) {
        Self::pull(HEARTBEAT, low);
    }

    fn pull(pin: u32, low: bool) {
        let (set, reset) = if low { (0, pin) } else { (pin, 0) };
        // SAFETY: the write reaches one pin, which is ours alone.
        unsafe { write(set, reset) };
    }
}

/// Releases all lines and says "not ready", from wherever: for the handlers of what must not happen.
pub fn let_go() {
    // SAFETY: high is the safe level of these pins, whoever else writes them.
    unsafe { write(LINES | READY, 0) };
}

/// Sets pins of the port and resets others, in one write; the rest stays.
///
/// # Safety
/// The pins are the caller's, or go to a level that suits their owner.
unsafe fn write(set: u32, reset: u32) {
    // SAFETY: the register has no state to lose: a write reaches the pins it names and no others, and these are allowed,
    // says the caller.
    unsafe { (*GPIOC::ptr()).bsrr().write(|w| w.bits(set | (reset << 16))) };
}
