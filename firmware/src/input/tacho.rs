//! Spindle speed from the time between two pulses.
//!
//! Each pulse captures and restarts a timer: it gives the last period T between two pulses and the time t since the
//! last pulse. With p pulses per revolution
//!
//! (1) n = 1 / (p max(T, t))
//!
//! so a spindle that slows down is detected before its next pulse. A speed above the spindle's maximum is noise; a
//! speed below its minimum counts as standstill. In both cases no speed is reported, and the feed stays as programmed.
//! Too high a speed would raise the feed too much.

use arcfeed_units::{RevPerMin, S_PER_MIN, US_PER_S};

/// Tacho of a spindle: the number of pulses per revolution, and the range of plausible speeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tacho {
    us_per_min_and_pulse: f32,
    shortest_us: u32,
    longest_us: u32,
}

/// Rotation of the spindle, as far as the tacho pulses show it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Turning {
    /// Standstill: no pulse for longer than the period at the lowest speed.
    #[default]
    Standing,
    /// One pulse after standstill, or after an implausible period: no speed yet.
    Begun,
    /// The last two pulses were this far apart.
    Timed {
        /// Time between the two pulses, microseconds.
        period_us: u32,
    },
}

/// Readings, at a tick, of the timer that each tacho pulse restarts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TachoSample {
    /// Time between the two newest pulses, microseconds; `None` if there was no pulse since the last tick.
    pub period_us: Option<u32>,
    /// Time since the newest pulse, microseconds.
    pub since_pulse_us: u32,
}

impl Tacho {
    /// Tacho of a spindle with this range of speeds. `None` unless 0 < `lowest` < `highest`, there is at least one
    /// pulse for each revolution, and the time between pulses is from 2 us to 30 s.
    pub fn new(pulses_per_rev: u16, lowest: RevPerMin, highest: RevPerMin) -> Option<Self> {
        let us_per_min_and_pulse = S_PER_MIN as f32 * US_PER_S as f32 / f32::from(pulses_per_rev);
        let period_us = |speed: RevPerMin| us_per_min_and_pulse / speed.0;
        let (shortest_us, longest_us) = (period_us(highest), period_us(lowest));
        // Also false for NaN.
        let makes_sense = shortest_us >= 2.0 && shortest_us < longest_us && longest_us <= 30.0 * US_PER_S as f32;
        makes_sense.then_some(Tacho {
            us_per_min_and_pulse,
            shortest_us: shortest_us as u32,
            longest_us: longest_us as u32,
        })
    }

    /// Processes the readings of this tick; returns the spindle speed, zero if the pulses give none.
    pub fn follow(&self, turning: &mut Turning, sample: TachoSample) -> RevPerMin {
        *turning = self.next(*turning, sample);
        match *turning {
            Turning::Standing | Turning::Begun => RevPerMin(0.0),
            Turning::Timed { period_us } => {
                RevPerMin(self.us_per_min_and_pulse / period_us.max(sample.since_pulse_us) as f32) // (1)
            }
        }
    }

    fn next(&self, turning: Turning, TachoSample { period_us, since_pulse_us }: TachoSample) -> Turning {
        if since_pulse_us > self.longest_us {
            return Turning::Standing;
        }
        match (turning, period_us) {
            (_, None) => turning,
            // The timer has no defined start: no period.
            (Turning::Standing, Some(_)) => Turning::Begun,
            (_, Some(period_us)) if (self.shortest_us..=self.longest_us).contains(&period_us) => {
                Turning::Timed { period_us }
            }
            (_, Some(_)) => Turning::Begun,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 60 to 6 000 rev/min: periods of 1 s to 10 ms.
    fn tacho() -> Tacho {
        Tacho::new(1, RevPerMin(60.0), RevPerMin(6_000.0)).unwrap()
    }

    fn speeds(samples: &[(Option<u32>, u32)]) -> Vec<f32> {
        let mut turning = Turning::default();
        let sample = |(period_us, since_pulse_us): &(Option<u32>, u32)| TachoSample {
            period_us: *period_us,
            since_pulse_us: *since_pulse_us,
        };
        samples.iter().map(|at| tacho().follow(&mut turning, sample(at)).0).collect()
    }

    #[test]
    fn the_first_pulse_tells_no_speed_and_the_second_does() {
        let speeds = speeds(&[(None, 0), (Some(60_000), 300), (None, 900), (Some(60_000), 100), (None, 59_000)]);
        assert_eq!(speeds, [0.0, 0.0, 0.0, 1_000.0, 1_000.0]);
    }

    #[test]
    fn a_spindle_that_slows_down_is_seen_to_and_in_the_end_stands() {
        let turning = [(Some(1), 0), (Some(50_000), 0), (None, 100_000), (None, 1_000_000), (None, 1_000_001)];
        assert_eq!(speeds(&turning), [0.0, 1_200.0, 600.0, 60.0, 0.0]);
    }

    #[test]
    fn after_standing_it_takes_two_pulses_again() {
        let begin = [(Some(9), 0), (Some(50_000), 0), (None, 2_000_000)];
        let again = [(Some(2_100_000), 10), (Some(50_000), 10)];
        assert_eq!(speeds(&[&begin[..], &again[..]].concat()), [0.0, 1_200.0, 0.0, 0.0, 1_200.0]);
    }

    #[test]
    fn pulses_closer_than_the_spindle_can_turn_are_no_speed() {
        let noisy = [(Some(9), 0), (Some(20_000), 0), (Some(9_999), 0), (Some(10_001), 0), (Some(10_000), 0)];
        assert_eq!(speeds(&noisy)[1..3], [3_000.0, 0.0]);
        assert_eq!(speeds(&noisy)[4], 6_000.0);
    }

    #[test]
    fn more_pulses_a_revolution_are_shorter_periods() {
        let mut turning = Turning::Begun;
        let tacho = Tacho::new(60, RevPerMin(100.0), RevPerMin(10_000.0)).unwrap();
        let sample = TachoSample { period_us: Some(1_000), since_pulse_us: 0 };
        assert_eq!(tacho.follow(&mut turning, sample), RevPerMin(1_000.0));
    }

    #[test]
    fn what_makes_no_sense_is_refused() {
        for (pulses, lowest, highest) in [
            (0, 60.0, 6_000.0),
            (1, 0.0, 6_000.0),
            (1, 60.0, 60.0),
            (1, 60.0, f32::NAN),
            (1, f32::NAN, 60.0),
            (1, -60.0, 60.0),
            (1, 60.0, f32::INFINITY),
            (10_000, 60.0, 6_000.0),
            (1, 1.0, 60.0),
        ] {
            assert_eq!(Tacho::new(pulses, RevPerMin(lowest), RevPerMin(highest)), None, "{pulses} {lowest} {highest}");
        }
    }
}
