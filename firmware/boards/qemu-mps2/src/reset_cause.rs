//! Cause of the start: a note in memory that survives a reset, in place of a chip's reset flags.
//!
//! The note is written when the watchdog starts, and only a loss of power removes it: any reset while the watchdog
//! runs counts as a watchdog reset, even if it could not be recorded. The note is a word and its complement, so that
//! random memory at power-on is not taken for a note (1 in 2^64).

/// The note that the watchdog runs.
const GUARDED: u32 = 0x6A4D_ED01;
/// Code of an unknown number.
const UNKNOWN: u32 = u32::MAX;

/// Records, so that it survives a reset, that the watchdog runs from now on.
pub fn note_guarded() {
    write([GUARDED, !GUARDED, UNKNOWN]);
}

/// Records, so that it survives a reset, that the watchdog has expired, and how many ticks after its last restart.
/// Only the first record counts.
pub fn note_watchdog(ticks_since_fed: u32) {
    if taken(read()) == Some(UNKNOWN) {
        write([GUARDED, !GUARDED, ticks_since_fed]);
    }
}

/// Number of ticks from the watchdog's last restart to its expiry if it caused this start (all ones if unknown);
/// `None` if it did not. Clears the record.
pub fn take_watchdog() -> Option<u32> {
    let found = read();
    write([0; 3]);
    taken(found)
}

fn taken([guarded, complement, ticks_since_fed]: [u32; 3]) -> Option<u32> {
    (guarded == GUARDED && complement == !GUARDED).then_some(ticks_since_fed)
}

fn read() -> [u32; 3] {
    // SAFETY: three words of RAM that the linker reserves for this module.
    unsafe { kept().read_volatile() }
}

fn write(words: [u32; 3]) {
    // SAFETY: as in `read`; the main program no longer uses them when the NMI, which never returns, can occur.
    unsafe { kept().write_volatile(words) }
}

fn kept() -> *mut [u32; 3] {
    unsafe extern "C" {
        static mut _kept: [u32; 3];
    }
    &raw mut _kept
}
