//! The operator's dial: a potentiometer between two resistors, read by a converter.
//!
//! The resistors keep the wiper away from both rails. Therefore a reading near a rail means an open or shorted wire; a
//! missing reading counts the same. Both must last for some ticks; until then the last reading is kept.
//!
//! Noise must not change the value. The held value follows the reading down at once and up with a backlash b:
//!
//! (1) held = min(reading, max(held, reading - b))
//!
//! so it is at most b below the reading and never above it.

/// Readings of the converter at both ends of the operator's override dial, and the range of readings that an intact
/// wire gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DialInput {
    lowest: u16,
    span: u16,
    plausible: (u16, u16),
    highest_percent: u8,
}

/// Last reading of the dial, and the number of ticks without a plausible one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DialState {
    held: u16,
    implausible_ticks: u8,
}

/// The dial's wire is open or shorted, or its converter gives no reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DialBroken;

/// Backlash against noise, counts.
const BACKLASH: u16 = 16;
/// Allowed reading beyond the ends of the dial, counts, for the tolerances of the resistors.
const MARGIN: u16 = 64;
/// Number of consecutive ticks without a plausible reading at which the dial is faulty.
const IMPLAUSIBLE_TICKS_MAX: u8 = 5;

impl DialInput {
    /// Dial that reads `lowest` counts at 0 % and `highest` counts at `highest_percent`, on a converter whose largest
    /// count is `full_scale`. `None` if the ends are too near the rails for a broken wire to be detected, or too near
    /// each other.
    pub const fn new(lowest: u16, highest: u16, full_scale: u16, highest_percent: u8) -> Option<Self> {
        let far_from_rails = lowest > 2 * MARGIN && highest.saturating_add(2 * MARGIN) < full_scale;
        let (low, high) = (lowest.saturating_add(BACKLASH), highest.saturating_sub(BACKLASH));
        // A step of 1 % must exceed the backlash.
        if !far_from_rails || high.saturating_sub(low) / BACKLASH < highest_percent as u16 {
            return None;
        }
        let plausible = (lowest - MARGIN, highest + MARGIN);
        Some(DialInput { lowest: low, span: high.saturating_sub(low), plausible, highest_percent })
    }

    /// Processes the reading of this tick, in counts (`None`: no reading). Returns the dial's position in per cent,
    /// rounded down; zero before the first plausible reading. Implausible readings are ignored until they last.
    ///
    /// # Errors
    /// No plausible reading for five consecutive ticks.
    pub fn follow(&self, knob: &mut DialState, reading: Option<u16>) -> Result<u8, DialBroken> {
        let (low, high) = self.plausible;
        match reading.filter(|reading| (low..=high).contains(reading)) {
            Some(reading) => {
                knob.held = reading.min(knob.held.max(reading.saturating_sub(BACKLASH))); // (1)
                knob.implausible_ticks = 0;
            }
            None => knob.implausible_ticks = knob.implausible_ticks.saturating_add(1),
        }
        if knob.implausible_ticks < IMPLAUSIBLE_TICKS_MAX { Ok(self.percent(knob.held)) } else { Err(DialBroken) }
    }

    fn percent(&self, held: u16) -> u8 {
        let above = u32::from(held.saturating_sub(self.lowest).min(self.span));
        let percent = (above * u32::from(self.highest_percent)).checked_div(u32::from(self.span));
        percent.and_then(|percent| u8::try_from(percent).ok()).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0 to 150 % on 12 bits.
    const DIAL: DialInput = DialInput::new(400, 3_700, 4_095, 150).unwrap();

    fn last(readings: &[Option<u16>]) -> Result<u8, DialBroken> {
        let mut knob = DialState::default();
        readings.iter().map(|reading| DIAL.follow(&mut knob, *reading)).last().unwrap()
    }

    #[test]
    fn its_ends_are_0_and_all_and_its_middle_is_half() {
        for (reading, percent) in [(336, 0), (400, 0), (2_066, 75), (3_700, 150), (3_764, 150)] {
            assert_eq!(last(&[Some(reading)]), Ok(percent), "{reading}");
        }
    }

    #[test]
    fn dial_reads_at_most_the_straight_line_and_less_by_at_most_step_plus_backlash() {
        let mut knob = DialState::default();
        let up_and_down = (400..=3_700).chain((400..=3_700).rev());
        for reading in up_and_down {
            let percent = f64::from(DIAL.follow(&mut knob, Some(reading)).unwrap());
            let line = (f64::from(reading) - 400.0) / 3_300.0 * 150.0;
            assert!(percent <= line + 0.75 && percent > line - 2.5, "{reading}: {percent} for {line}");
        }
    }

    #[test]
    fn noise_within_the_backlash_does_not_turn_it() {
        for middle in 450..3_650 {
            let mut knob = DialState::default();
            let noise = [8, -8, 3, 7, -5, 8, -8, 0];
            let percents = noise.map(|off| DIAL.follow(&mut knob, Some((middle + off) as u16)).unwrap());
            assert!(percents[1..].iter().all(|percent| *percent == percents[1]), "{middle}: {percents:?}");
        }
    }

    #[test]
    fn turning_down_takes_effect_with_the_first_reading() {
        assert_eq!(last(&[Some(3_700), Some(2_066)]), last(&[Some(2_066)]));
    }

    #[test]
    fn open_shorted_or_silent_it_is_broken_at_the_fifth_tick_and_holds_until_then() {
        for bad in [Some(0), Some(335), Some(3_765), Some(4_095), None] {
            let mut readings = vec![Some(2_100)];
            readings.extend([bad; 4]);
            assert_eq!(last(&readings), last(&[Some(2_100)]), "{bad:?}");
            readings.push(bad);
            assert_eq!(last(&readings), Err(DialBroken), "{bad:?}");
            readings.push(Some(2_100));
            assert_eq!(last(&readings), last(&[Some(2_100)]), "{bad:?}");
        }
    }

    #[test]
    fn before_the_first_reading_it_is_at_0() {
        assert_eq!(last(&[None]), Ok(0));
    }

    #[test]
    fn ends_that_hide_a_broken_wire_are_refused() {
        for (lowest, highest, percent) in
            [(128, 3_700, 150), (400, 3_967, 150), (400, 2_000, 150), (2_000, 400, 150), (0, 4_095, 100)]
        {
            assert_eq!(DialInput::new(lowest, highest, 4_095, percent), None, "{lowest} {highest}");
        }
    }
}
