//! *FV0 to *FV7 on port C: eight pins in one write, read back before the next.

use arcfeed_firmware::output::port_lines::LinePort;
use embedded_hal::delay::DelayNs;
use stm32f4::stm32f405::GPIOC;

use crate::pins::{HEARTBEAT, LINES, READY};

/// The port, with the two signals beside the lines.
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
        set(&self.port, LINES & u32::from(levels), LINES & !u32::from(levels));
        self.told = Some(levels);
        if pins == 0 { Ok(()) } else { Err(PinsDiffer { pins }) }
    }
}

impl DelayNs for CycleDelay {
    fn delay_ns(&mut self, ns: u32) {
        // Rounded up; up to 25 ms at 168 MHz before the product saturates.
        cortex_m::asm::delay(ns.saturating_mul(self.core_mhz).div_ceil(NS_PER_US));
    }
}

const NS_PER_US: u32 = 1_000;

/// The signals beside the lines, on the same port.
#[derive(Debug)]
pub struct Signals(());

impl Signals {
    /// The signals of the port that `lines` owns.
    pub fn beside(_lines: &FvPort) -> Self {
        Signals(())
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
        // SAFETY: a write that reaches one pin, which is ours alone; the register has no state to lose.
        let port = unsafe { &*GPIOC::ptr() };
        port.bsrr().write(|w| unsafe { w.bits(if low { pin << 16 } else { pin }) });
    }
}

/// Releases all lines and says "not ready", from wherever: for the handlers of what must not happen.
pub fn let_go() {
    // SAFETY: as above; high is the safe level of these pins whoever else writes them.
    let port = unsafe { &*GPIOC::ptr() };
    port.bsrr().write(|w| unsafe { w.bits(LINES | READY) });
}

/// Sets and resets pins in one write.
fn set(port: &GPIOC, high: u32, low: u32) {
    // SAFETY: every combination is valid.
    port.bsrr().write(|w| unsafe { w.bits(high | low << 16) });
}
