//! Why the board started: a note in memory that a reset leaves alone, in place of a chip's reset flags.
//!
//! The note is made when the watchdog starts, and only a loss of power takes it back: whatever resets the board while the watchdog
//! runs counts as a reset by it, also if it had no time to say so. A word and its complement, so that what power-on finds there is
//! not taken for a note (1 in 2^64).

/// The note that the watchdog runs.
const GUARDED: u32 = 0x6A4D_ED01;
/// In place of a number: nobody counted.
const UNKNOWN: u32 = u32::MAX;

/// Notes that the watchdog runs from now on.
pub fn note_guarded() {
    write([GUARDED, !GUARDED, UNKNOWN]);
}

/// Notes that it bit, and how many ticks ago it was fed. The first word counts.
pub fn note_watchdog(ticks_since_fed: u32) {
    if taken(read()) == Some(UNKNOWN) {
        write([GUARDED, !GUARDED, ticks_since_fed]);
    }
}

/// Whether this start is the watchdog's, and if so for how many ticks it had not been fed, all ones if nobody counted. The next start
/// tells its own.
pub fn take_watchdog() -> Option<u32> {
    let found = read();
    write([0; 3]);
    taken(found)
}

fn taken([guarded, complement, ticks_since_fed]: [u32; 3]) -> Option<u32> {
    (guarded == GUARDED && complement == !GUARDED).then_some(ticks_since_fed)
}

fn read() -> [u32; 3] {
    // SAFETY: three words of RAM that the linker gives to nobody else.
    unsafe { kept().read_volatile() }
}

fn write(words: [u32; 3]) {
    // SAFETY: as in `read`; the main program is done with them when the NMI, which never returns, may come.
    unsafe { kept().write_volatile(words) }
}

fn kept() -> *mut [u32; 3] {
    unsafe extern "C" {
        static mut _kept: [u32; 3];
    }
    &raw mut _kept
}
