//! Non-volatile memory: files of the emulator's host in place of pages of flash.

use cortex_m_semihosting::syscall;

/// File with the number of starts, four bytes.
const STARTS: &[u8] = b"feedboard.flash\0";
/// File written by `arcfeed parameters`.
const PARAMETERS: &[u8] = b"parameters.flash\0";
/// Modes of `fopen`: "rb" and "wb".
const TO_READ: usize = 1;
const TO_WRITE: usize = 5;
/// Result of a failed `OPEN`.
const REFUSED: usize = usize::MAX;

/// Adds one to the number of starts in the board's memory and returns it, this start included; 1 if there is no file.
pub fn count_start() -> u32 {
    let mut bytes = [0; 4];
    let before = match read(STARTS, &mut bytes) {
        4 => u32::from_le_bytes(bytes),
        _ => 0,
    };
    let starts = before.wrapping_add(1);
    write(STARTS, &starts.to_le_bytes());
    starts
}

/// Reads the flash page with the job of a tapped board into `place`, at most as much as fits; empty if there is none.
pub fn parameters(place: &mut [u8]) -> &[u8] {
    let length = read(PARAMETERS, place);
    place.get(..length).unwrap_or_default()
}

/// Reads a file; returns the number of bytes.
fn read(name: &[u8], into: &mut [u8]) -> usize {
    let Some(file) = open(name, TO_READ) else { return 0 };
    // SAFETY: address and length of the buffer; the file is open.
    let left = unsafe { syscall!(READ, file, into.as_mut_ptr() as usize, into.len()) };
    close(file);
    into.len().saturating_sub(left)
}

fn write(name: &[u8], bytes: &[u8]) {
    if let Some(file) = open(name, TO_WRITE) {
        // SAFETY: address and length of the buffer; the file is open.
        unsafe { syscall!(WRITE, file, bytes.as_ptr() as usize, bytes.len()) };
        close(file);
    }
}

fn open(name: &[u8], mode: usize) -> Option<usize> {
    // SAFETY: address and length of a name that ends in a zero, as the call wants them.
    let file = unsafe { syscall!(OPEN, name.as_ptr() as usize, mode, name.len() - 1) };
    (file != REFUSED).then_some(file)
}

fn close(file: usize) {
    // SAFETY: the file is open.
    unsafe { syscall!(CLOSE, file) };
}
