//! Logger of `defmt`: writes each frame to the emulator by semihosting, and to a buffer from which the main loop sends
//! whole frames over the link as it has room. Frames that do not fit the buffer are dropped and counted.
//!
//! Only the main loop logs; the tick never does. `defmt-semihosting` is not used because its panic on reentry would
//! prevent linking; here a frame that does not fit is dropped.

use core::cell::UnsafeCell;

use cortex_m_semihosting::syscall;
use heapless::Vec;

/// Longest frame, encoded.
const FRAME_MAX: usize = 128;
/// Bytes that wait for the link.
const WAITING_MAX: usize = 512;
/// `:tt` opened for writing: the emulator's console.
const OPEN_TO_WRITE: usize = 4;

struct State {
    encoder: defmt::Encoder,
    frame: Vec<u8, FRAME_MAX>,
    fits: bool,
    console: Option<usize>,
    waiting: Vec<u8, WAITING_MAX>,
    dropped: u32,
}

struct Shared(UnsafeCell<State>);

// SAFETY: only the main loop logs (see above), so there is one user at a time.
unsafe impl Sync for Shared {}

static LOG: Shared = Shared(UnsafeCell::new(State {
    encoder: defmt::Encoder::new(),
    frame: Vec::new(),
    fits: true,
    console: None,
    waiting: Vec::new(),
    dropped: 0,
}));

/// Passes the bytes of the log that wait for the link to `send`, which returns how many of them it has accepted.
///
/// # Safety
/// Called by the main loop, and `send` does not log.
pub unsafe fn hand_on(send: impl FnOnce(&[u8]) -> usize) {
    // SAFETY: only the main loop logs; the caller guarantees that it does not log meanwhile.
    let State { waiting, .. } = unsafe { &mut *LOG.0.get() };
    if waiting.is_empty() {
        return;
    }
    let sent = send(waiting);
    if sent > 0 {
        *waiting = waiting.get(sent..).and_then(|rest| Vec::from_slice(rest).ok()).unwrap_or_default();
    }
}

/// Number of log frames that were dropped because the buffer was full.
///
/// # Safety
/// Called by the main loop.
pub unsafe fn dropped() -> u32 {
    // SAFETY: only the main loop logs.
    unsafe { (*LOG.0.get()).dropped }
}

#[defmt::global_logger]
struct Console;

impl State {
    fn push(frame: &mut Vec<u8, FRAME_MAX>, fits: &mut bool, bytes: &[u8]) {
        *fits &= frame.extend_from_slice(bytes).is_ok();
    }

    fn send(&mut self) {
        let name = b":tt\0";
        let console = *self.console.get_or_insert_with(|| {
            // SAFETY: name and length of a file, as the call wants them.
            unsafe { syscall!(OPEN, name.as_ptr() as usize, OPEN_TO_WRITE, name.len() - 1) }
        });
        if self.fits {
            // SAFETY: address and length of the frame.
            unsafe { syscall!(WRITE, console, self.frame.as_ptr() as usize, self.frame.len()) };
        }
        let is_taken = self.fits && self.waiting.extend_from_slice(&self.frame).is_ok();
        self.dropped = self.dropped.saturating_add(u32::from(!is_taken));
        self.frame.clear();
        self.fits = true;
    }
}

// SAFETY: acquire and release come in pairs from one place at a time, the main loop.
unsafe impl defmt::Logger for Console {
    fn acquire() {
        let State { encoder, frame, fits, .. } = unsafe { &mut *LOG.0.get() };
        encoder.start_frame(|bytes| State::push(frame, fits, bytes));
    }

    unsafe fn flush() {}

    unsafe fn release() {
        let state = unsafe { &mut *LOG.0.get() };
        let State { encoder, frame, fits, .. } = &mut *state;
        encoder.end_frame(|bytes| State::push(frame, fits, bytes));
        state.send();
    }

    unsafe fn write(bytes: &[u8]) {
        let State { encoder, frame, fits, .. } = unsafe { &mut *LOG.0.get() };
        encoder.write(bytes, |bytes| State::push(frame, fits, bytes));
    }
}
