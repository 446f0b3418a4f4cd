//! Clock of the emulated board, and counter of executed instructions.
//!
//! Under `-icount shift=7` QEMU advances the clock by exactly 2^7 ns for each instruction of the guest, accesses to
//! devices included. The board's timers count at 25 MHz, 40 ns a step: one instruction is 3.2 steps, so the count of
//! instructions between two readings is exact after rounding.

/// CMSDK dual timer, first counter: load, value, control.
const LOAD: *mut u32 = 0x4000_2000 as *mut u32;
const VALUE: *const u32 = 0x4000_2004 as *const u32;
const CONTROL: *mut u32 = 0x4000_2008 as *mut u32;
/// Enabled, 32 bits, free running, not divided.
const FREE_RUNNING: u32 = (1 << 7) | (1 << 1);
const NS_PER_STEP: u64 = 40;
/// Number of steps of the board's timers in a microsecond.
pub const STEPS_PER_US: u32 = 25;
/// As given to QEMU.
const ICOUNT_SHIFT: u32 = 7;

/// Counts the instructions that the emulated core executes, by the emulator's clock.
#[derive(Clone, Copy, Debug)]
pub struct InstructionCounter {
    /// Instructions for reading the timer twice.
    overhead: u32,
}

impl InstructionCounter {
    /// Starts the timer, which must have no other user.
    pub fn start() -> Self {
        // SAFETY: registers of the dual timer, which nothing else in the image touches.
        unsafe {
            CONTROL.write_volatile(0);
            LOAD.write_volatile(u32::MAX);
            CONTROL.write_volatile(FREE_RUNNING);
        }
        let mut counter = InstructionCounter { overhead: 0 };
        counter.overhead = counter.of(|| {}).0;
        counter
    }

    /// Runs `work`. Returns the number of instructions of it and its call, and its result.
    #[inline(never)]
    pub fn of<T>(&self, work: impl FnOnce() -> T) -> (u32, T) {
        let before = steps();
        let answer = work();
        let after = steps();
        (Self::of_steps(after.wrapping_sub(before)).saturating_sub(self.overhead), answer)
    }

    /// Number of instructions that take this many steps of the board's clock.
    pub fn of_steps(steps: u32) -> u32 {
        let ns = u64::from(steps) * NS_PER_STEP;
        ((ns + (1 << (ICOUNT_SHIFT - 1))) >> ICOUNT_SHIFT) as u32
    }
}

/// Present value of the timer in steps of the board's clock; it counts up and wraps around.
#[inline(always)]
pub fn steps() -> u32 {
    // SAFETY: reading the value has no effect on the timer.
    !unsafe { VALUE.read_volatile() }
}
