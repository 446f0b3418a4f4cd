//! Pacing of the line: bytes are sent no faster than the line carries them, so that they do not age in a driver's
//! buffer.

use super::settings::BITS_PER_BYTE;
use arcfeed_units::{Micros, Span, US_PER_S};

const NS_PER_US: u64 = 1_000;

/// Computes when the next frame may be passed to a serial line, so that bytes do not wait in the driver's buffer.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    ns_per_byte: u64,
    ahead: Span,
    free_at_ns: u64,
}

impl Pace {
    /// Pace of a line of `bits_per_s` (0: unlimited). Bytes may be passed up to the time `ahead` before the line can
    /// send them.
    pub fn new(bits_per_s: u32, ahead: Span) -> Self {
        let ns_per_byte = (BITS_PER_BYTE * US_PER_S * NS_PER_US).checked_div(u64::from(bits_per_s)).unwrap_or(0);
        Pace { ns_per_byte, ahead, free_at_ns: 0 }
    }

    /// Instant from which the next frame may be sent.
    pub fn ready_at(&self) -> Micros {
        Micros(self.free_at_ns.div_ceil(NS_PER_US).saturating_sub(u64::from(self.ahead.0)))
    }

    /// Records that this number of bytes is passed to the line now.
    pub fn sent(&mut self, now: Micros, bytes: usize) {
        let from = self.free_at_ns.max(now.0.saturating_mul(NS_PER_US));
        self.free_at_ns = from.saturating_add(self.ns_per_byte.saturating_mul(bytes as u64));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_never_idles_and_is_never_more_than_that_far_behind() {
        // 10 000 bytes a second: 100 us each.
        let mut pace = Pace::new(100_000, Span(2_000));
        let (mut sent, mut now) = (0_u64, Micros(5_000));
        while now < Micros(1_005_000) {
            while pace.ready_at() <= now {
                pace.sent(now, 16);
                sent += 16;
            }
            let carried = (now.0 - 5_000) / 100;
            assert!(carried <= sent && sent <= carried + 20 + 16, "{carried} of {sent} at {now:?}");
            now = now.after(Micros(500));
        }
    }

    #[test]
    fn without_a_bit_rate_everything_goes_at_once() {
        let mut pace = Pace::new(0, Span(0));
        pace.sent(Micros(7), 1_000_000);
        assert_eq!(pace.ready_at(), Micros(7));
    }
}
