//! *FV0 to *FV7 on port C: eight pins in one write, read back before the next.

use arcfeed_firmware::output::port_lines::LinePort;
use embedded_hal::delay::DelayNs;
use stm32f4::stm32f405::GPIOC;

use crate::pins::{HEARTBEAT, LINES, READY};

const NS_PER_US: u32 = 1_000;

/// Port C with the override lines *FV0 to *FV7, written together and read back.
#[derive(Debug)]
pub struct FvPort {
    port: GPIOC,
    written: Option<u8>,
}

/// Error: pins did not have the levels that were written before, so a line is shorted or overloaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PinsDiffer {
    /// The differing pins: bit i for *FVi.
    pub pins: u8,
}

/// Delay that counts cycles of the core.
#[derive(Clone, Copy, Debug)]
pub struct CycleDelay {
    /// Frequency of the core, MHz.
    pub core_mhz: u32,
}

impl FvPort {
    /// The port, whose pins [`crate::pins`] has configured.
    pub fn new(port: GPIOC) -> Self {
        FvPort { port, written: None }
    }
}

impl LinePort for FvPort {
    type Error = PinsDiffer;

    fn write(&mut self, levels: u8) -> Result<(), PinsDiffer> {
        let held = self.port.idr().read().bits() as u8;
        let pins = self.written.map_or(0, |written| written ^ held);
        // SAFETY: the lines are this port's.
        unsafe { write(LINES & u32::from(levels), LINES & !u32::from(levels)) };
        self.written = Some(levels);
        if pins == 0 { Ok(()) } else { Err(PinsDiffer { pins }) }
    }
}

impl DelayNs for CycleDelay {
    /// Rounded up; at most 25 ms at 168 MHz, where the product saturates.
    fn delay_ns(&mut self, ns: u32) {
        cortex_m::asm::delay(ns.saturating_mul(self.core_mhz).div_ceil(NS_PER_US));
    }
}

/// Output pins ready and heartbeat, on the same port as the lines.
#[derive(Debug)]
pub struct StatusPins(());

impl StatusPins {
    /// The status pins on the port that `lines` owns.
    pub fn beside(_lines: &FvPort) -> Self {
        StatusPins(())
    }

    /// Sets the output ready: true while no alarm is latched (fault of the board, loss of the position).
    pub fn set_ready(&mut self, ready: bool) {
        Self::pull(READY, ready);
    }

    /// Sets the output heartbeat low or high.
    pub fn set_heartbeat(&mut self, low: bool) {
        Self::pull(HEARTBEAT, low);
    }

    fn pull(pin: u32, low: bool) {
        let (set, reset) = if low { (0, pin) } else { (pin, 0) };
        // SAFETY: the write reaches one pin, which is ours alone.
        unsafe { write(set, reset) };
    }
}

/// Releases all override lines (0 %) and sets "not ready"; for fault handlers.
pub fn let_go() {
    // SAFETY: high is the safe level of these pins, whatever other code writes them.
    unsafe { write(LINES | READY, 0) };
}

/// Sets pins of the port and resets others in one write; all other pins are unchanged.
///
/// # Safety
/// The pins are the caller's, or go to a level that suits their owner.
unsafe fn write(set: u32, reset: u32) {
    // SAFETY: the register has no state: a write affects only the named pins, which the caller guarantees to be
    // allowed.
    unsafe { (*GPIOC::ptr()).bsrr().write(|w| w.bits(set | (reset << 16))) };
}
