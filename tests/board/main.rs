//! The chip's figures, from the board images in the emulator: instructions, bits, budgets, and that nothing can panic.
//!
//! Builds the images of `firmware/boards/qemu-mps2` and runs them in QEMU, which counts instructions exactly: the figures
//! are the same on every machine. They are instructions, not cycles (docs/real-time.md). `stm32f405*` are about the image for
//! a real chip, of which QEMU has the core and some timers.

mod budgets;

mod c_interface;

mod defmt_log;

mod embassy;

mod elf;

mod figures;

mod free;

mod images;

mod load;

mod along;

mod lockstep;

mod passing;

mod reading;

mod recorded_runs;

mod restarts;

mod runs;

mod same_everywhere;

mod stm32f405;

mod stm32f405_logic;

mod tapped;

mod pyserial;

mod watchdog;
