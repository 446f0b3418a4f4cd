//! Arm MPS2 with the AN386 image, a Cortex-M4F, as QEMU emulates it.
//!
//! Common code of this board's images. `tick-cost` and `trace-hash` produce figures and may panic. `feedboard` is the
//! board, and `example-run` its controller alone; they do not link if a panic is reachable.
#![no_std]

pub mod interrupts;

pub mod handed;

pub mod clock;

pub mod stack;

pub mod timer;

pub mod uart;

pub mod serial;

pub mod mirror;

pub mod flash;

pub mod tick;

pub mod reset_cause;

pub mod watchdog;

pub mod last_act;

pub mod main_loop;

pub mod log;

pub mod figures;

pub mod example;

pub mod tapped;

pub mod baseline;

use cortex_m_semihosting::debug::{self, ExitStatus};

/// Ends the emulation with this exit status.
pub fn leave(status: ExitStatus) -> ! {
    loop {
        debug::exit(status);
    }
}
