//! Incremental encoder of an axis (A quad B), counted by a 16-bit timer.
//!
//! The timer wraps around. If it is sampled often enough, the change since the last sample is unambiguous: the signed
//! difference of the readings modulo 2^16,
//!
//! (1) change = (reading - last) mod 2^16, in -32768 .. 32767
//!
//! as long as no axis moves 32768 counts within a tick. A change beyond the axis's maximum speed is a fault: a jump.

use arcfeed_units::Nm;

/// Scale of an axis' incremental encoder, and the largest plausible change in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Encoder {
    nm_per_count: i32,
    most_counts: u16,
}

/// Position of an axis in counts from its zero, and the last reading of its timer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counter {
    last: u16,
    counts: i32,
}

/// The encoder's reading is one that the axis cannot have caused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EncoderFault {
    /// It differs from the previous one by more counts than the axis can move in a tick.
    Jump {
        /// Counts since the previous reading, positive or negative.
        counts: i16,
    },
    /// The position in counts exceeds 32 bits.
    Range,
}

impl Encoder {
    /// Encoder of an axis that moves at most `most_counts` counts in a tick. A negative `nm_per_count` reverses the
    /// sense. `None` if the scale is zero, or `most_counts` is zero or above 16 384, because jumps could then not be
    /// detected.
    pub const fn new(nm_per_count: i32, most_counts: u16) -> Option<Self> {
        if nm_per_count == 0 || most_counts == 0 || most_counts > 1 << 14 {
            return None;
        }
        Some(Encoder { nm_per_count, most_counts })
    }

    /// Processes the timer's reading of this tick; returns the position of the axis relative to its zero.
    ///
    /// # Errors
    /// The reading is impossible; `counter` then has no valid position until it is set to zero again.
    pub fn follow(&self, counter: &mut Counter, reading: u16) -> Result<Nm, EncoderFault> {
        let change = reading.wrapping_sub(counter.last) as i16; // (1)
        if change.unsigned_abs() > self.most_counts {
            return Err(EncoderFault::Jump { counts: change });
        }
        counter.last = reading;
        counter.counts = counter.counts.checked_add(i32::from(change)).ok_or(EncoderFault::Range)?;
        Ok(Nm(i64::from(counter.counts) * i64::from(self.nm_per_count)))
    }
}

impl Counter {
    /// Counter of an axis that stands at its zero while the timer reads `reading`.
    pub fn zero_at(reading: u16) -> Self {
        Counter { last: reading, counts: 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quarter micrometres, up to 600 counts a tick.
    const AXIS: Encoder = Encoder::new(250, 600).unwrap();

    #[test]
    fn a_way_of_many_wraps_is_counted_exactly() {
        // Truth: a position in 64 bits, of which the timer shows the low 16; forth and back over 20 wraps.
        let mut position: i64 = -3;
        let mut counter = Counter::zero_at(position as u16);
        let steps = (0..5_000).map(|tick| if tick < 3_000 { 600 - tick % 7 } else { -(599 - tick % 5) });
        for step in steps {
            position += step;
            assert_eq!(AXIS.follow(&mut counter, position as u16), Ok(Nm((position + 3) * 250)));
        }
        assert!(position > 500_000, "{position}");
    }

    #[test]
    fn the_sense_can_be_reversed() {
        let reversed = Encoder::new(-1_000, 10).unwrap();
        assert_eq!(reversed.follow(&mut Counter::zero_at(0xFFFF), 1), Ok(Nm(-2_000)));
    }

    #[test]
    fn a_jump_is_no_movement_in_either_sense() {
        for (reading, counts) in [(601_u16, 601), (0_u16.wrapping_sub(601), -601), (0x8000, i16::MIN)] {
            let mut counter = Counter::zero_at(0);
            assert_eq!(AXIS.follow(&mut counter, reading), Err(EncoderFault::Jump { counts }));
        }
        assert_eq!(AXIS.follow(&mut Counter::zero_at(0), 600), Ok(Nm(150_000)));
    }

    #[test]
    fn the_range_ends_at_32_bits() {
        let mut counter = Counter { last: 0, counts: i32::MAX };
        assert_eq!(AXIS.follow(&mut counter, 1), Err(EncoderFault::Range));
        let mut counter = Counter { last: 0, counts: i32::MIN + 600 };
        assert_eq!(AXIS.follow(&mut counter, 0_u16.wrapping_sub(600)), Ok(Nm(i64::from(i32::MIN) * 250)));
    }

    #[test]
    fn a_scale_or_a_limit_that_makes_no_sense_is_refused() {
        assert_eq!([(0, 1), (1, 0), (1, 16_385)].map(|(nm, most)| Encoder::new(nm, most)), [None; 3]);
        assert!(Encoder::new(i32::MIN, 16_384).is_some());
    }
}
