//! What outlasts a loss of power: a file beside the emulator, in place of a page of flash.

use cortex_m_semihosting::syscall;

/// Four bytes: how often the board started.
const NAME: &[u8] = b"feedboard.flash\0";
/// Modes of `fopen`: "rb" and "wb".
const TO_READ: usize = 1;
const TO_WRITE: usize = 5;
/// What `OPEN` answers if it cannot.
const REFUSED: usize = usize::MAX;

/// Counts a start; how many there were, this one among them. Without a file, the first.
pub fn count_start() -> u32 {
    let starts = read().unwrap_or(0).wrapping_add(1);
    write(starts);
    starts
}

fn read() -> Option<u32> {
    let mut bytes = [0; 4];
    let file = open(TO_READ)?;
    // SAFETY: address and length of the buffer; the file is open.
    let left = unsafe { syscall!(READ, file, bytes.as_mut_ptr() as usize, bytes.len()) };
    close(file);
    (left == 0).then_some(u32::from_le_bytes(bytes))
}

fn write(starts: u32) {
    let bytes = starts.to_le_bytes();
    if let Some(file) = open(TO_WRITE) {
        // SAFETY: address and length of the buffer; the file is open.
        unsafe { syscall!(WRITE, file, bytes.as_ptr() as usize, bytes.len()) };
        close(file);
    }
}

fn open(mode: usize) -> Option<usize> {
    // SAFETY: address and length of a name that ends in a zero, as the call wants them.
    let file = unsafe { syscall!(OPEN, NAME.as_ptr() as usize, mode, NAME.len() - 1) };
    (file != REFUSED).then_some(file)
}

fn close(file: usize) {
    // SAFETY: the file is open.
    unsafe { syscall!(CLOSE, file) };
}
