//! Arm MPS2 with the AN386 image, a Cortex-M4F, as QEMU emulates it.
//!
//! What the images of this board share. `tick-cost` and `trace-hash` produce figures and may fail loudly; `feedboard` is
//! the controller and may not fail at all: a panic that it could reach keeps it from linking.
#![no_std]

pub mod interrupts;

pub mod clock;

pub mod stack;

pub mod timer;

pub mod uart;

pub mod log;

pub mod figures;

pub mod example;

pub mod baseline;

use cortex_m_semihosting::debug::{self, ExitStatus};

/// Ends the emulation.
pub fn leave(status: ExitStatus) -> ! {
    loop {
        debug::exit(status);
    }
}
