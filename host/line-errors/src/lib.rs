#![doc = include_str!("../README.md")]
//!
//! Counts of damaged characters at a serial port, from the operating system: Linux, `TIOCGICOUNT` (tty_ioctl(4)).
//!
//! The driver counts the damaged characters of all it has received since it was loaded. A pseudo-terminal has no such counters, nor have
//! some drivers of adapters. The call is `unsafe` and no safe crate offers it, so it has a crate of its own: the only place in the host
//! with `unsafe` code.

/// Serial port as the operating system opens it (Unix).
#[cfg(unix)]
pub type NativePort = serialport::TTYPort;
/// Serial port as the operating system opens it (Windows).
#[cfg(windows)]
pub type NativePort = serialport::COMPort;

/// Numbers of damaged and lost characters at a serial port.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Characters whose stop bit was missing (framing errors).
    pub frame: u32,
    /// Characters lost in the UART, because the driver did not read them in time.
    pub overrun: u32,
    /// Characters with wrong parity.
    pub parity: u32,
    /// Break conditions received.
    pub breaks: u32,
    /// Characters lost in the driver, because its buffer was full.
    pub buffer_overrun: u32,
}

impl Counts {
    /// Counts since the earlier reading `before`. The counters overflow, which is taken into account.
    #[must_use]
    pub fn since(&self, before: &Counts) -> Counts {
        Counts {
            frame: self.frame.wrapping_sub(before.frame),
            overrun: self.overrun.wrapping_sub(before.overrun),
            parity: self.parity.wrapping_sub(before.parity),
            breaks: self.breaks.wrapping_sub(before.breaks),
            buffer_overrun: self.buffer_overrun.wrapping_sub(before.buffer_overrun),
        }
    }

    /// Sum of all counts.
    pub fn total(&self) -> u64 {
        [self.frame, self.overrun, self.parity, self.breaks, self.buffer_overrun].into_iter().map(u64::from).sum()
    }
}

/// Present counters of the port; `None` if its driver has none or the system does not answer.
#[cfg(target_os = "linux")]
pub fn counts(port: &NativePort) -> Option<Counts> {
    use std::os::fd::{AsRawFd, BorrowedFd};

    use rustix::ioctl::{Getter, Opcode, ioctl};

    /// `asm-generic/ioctls.h`; MIPS has numbers of its own.
    const TIOCGICOUNT: Opcode = if cfg!(any(target_arch = "mips", target_arch = "mips64")) { 0x5492 } else { 0x545D };
    /// `struct serial_icounter_struct` of `linux/serial.h`: cts, dsr, rng, dcd, rx, tx, frame, overrun, parity, brk,
    /// buf_overrun, and nine kept free.
    type Counters = [i32; 20];

    // SAFETY: `port` keeps its descriptor open as long as it is borrowed, which is longer than this call. TIOCGICOUNT only
    // writes, on success, one `struct serial_icounter_struct`: twenty `int`s, as long and aligned as the array that
    // `Getter` gives it, for which all bits are values.
    #[allow(unsafe_code, reason = "no safe crate offers this call")]
    let counted: Counters = unsafe {
        let descriptor = BorrowedFd::borrow_raw(port.as_raw_fd());
        ioctl(descriptor, Getter::<TIOCGICOUNT, Counters>::new())
    }
    .ok()?;
    let [_, _, _, _, _, _, errors @ .., _, _, _, _, _, _, _, _, _] = counted;
    let [frame, overrun, parity, breaks, buffer_overrun] = errors.map(i32::cast_unsigned);
    Some(Counts { frame, overrun, parity, breaks, buffer_overrun })
}

/// Always `None`: this operating system has no such counters.
#[cfg(all(any(unix, windows), not(target_os = "linux")))]
pub fn counts(_port: &NativePort) -> Option<Counts> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counters_that_wrap_are_counted_on() {
        let before = Counts { frame: u32::MAX, parity: 3, ..Counts::default() };
        let now = Counts { frame: 1, parity: 3, breaks: 2, ..Counts::default() };
        let since = now.since(&before);
        assert_eq!((since, since.total()), (Counts { frame: 2, breaks: 2, ..Counts::default() }, 4));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_pseudo_terminal_counts_nothing_and_says_so() {
        let (ours, theirs) = NativePort::pair().expect("a pseudo-terminal");
        assert_eq!((counts(&ours), counts(&theirs)), (None, None));
    }
}
