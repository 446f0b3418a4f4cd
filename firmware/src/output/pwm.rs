//! An analogue override input, from a filtered PWM or a DAC.
//!
//! The control reads a per cent linear in the duty. With z and s its readings at duty 0 and at full duty d_max:
//!
//! (1) duty = floor((p - z) d_max / (s - z)), at most d_max
//!
//! Because of the rounding down, the control never reads more than p. Between two duties the filter is monotonic, so
//! no reading in between exceeds both. All numbers are whole: a calibration cannot be NaN, and host and chip compute
//! the same duty.

use core::num::NonZeroU64;

use arcfeed_units::MILLIPERCENT_PER_PERCENT;
use embedded_hal::pwm::SetDutyCycle;

use super::OverrideOutput;
use crate::ramp::FeedOverride;

/// Largest plausible reading, thousandths of a per cent: 1000 %.
const PLAUSIBLE: i32 = 1_000_000;

/// Override that the control reads at both ends of the PWM's duty, in thousandths of a per cent; to be measured on the
/// machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Calibration {
    /// Override at duty 0 on the straight line through the readings. Zero, or negative if the control reads 0 % up to some duty (live
    /// zero); it is then extrapolated. A positive value is rejected.
    pub at_zero_duty_millipercent: i32,
    /// Reading at full duty.
    pub at_full_duty_millipercent: i32,
}

/// Reason why a calibration of the analogue output is rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum CalibrationError {
    /// A reading exceeds 1000 %.
    Implausible,
    /// The reading at duty 0 is above 0 %, so neither a release of the output nor a dead board would stop the axes.
    NoStop,
    /// The reading at full duty is below the largest override that is needed.
    OutOfReach {
        /// Reading at full duty, whole per cent, rounded down.
        reached_percent: u8,
    },
    /// One step of the duty changes the override by more than 1 %.
    Coarse,
}

/// Override output by a filtered PWM on the control's analogue override input.
#[derive(Clone, Debug)]
pub struct PwmOverride<P> {
    pwm: P,
    max_duty: u16,
    /// Reading at duty 0 below 0 %.
    below_zero_millipercent: u64,
    span_millipercent: NonZeroU64,
}

impl<P: SetDutyCycle> PwmOverride<P> {
    /// Output on this PWM, which must already have its final frequency, because the range of the duty depends on it.
    /// Sets no duty yet.
    ///
    /// # Errors
    /// The calibration does not allow every override from 0 % to `highest` in steps of 1 %.
    pub fn new(pwm: P, calibration: Calibration, highest: FeedOverride) -> Result<Self, CalibrationError> {
        let Calibration { at_zero_duty_millipercent: zero, at_full_duty_millipercent: full } = calibration;
        let max_duty = pwm.max_duty_cycle();
        if zero < -PLAUSIBLE || full > PLAUSIBLE {
            return Err(CalibrationError::Implausible);
        }
        if zero > 0 {
            return Err(CalibrationError::NoStop);
        }
        // Reading above 0 % at full duty; zero if the input falls with the duty.
        let reached = u32::try_from(full).unwrap_or(0);
        if full < 0 || u64::from(reached) < millipercent(highest) {
            let reached_percent = u8::try_from(reached / MILLIPERCENT_PER_PERCENT).unwrap_or(u8::MAX);
            return Err(CalibrationError::OutOfReach { reached_percent });
        }
        let below_zero_millipercent = u64::from(zero.unsigned_abs());
        let span_millipercent = below_zero_millipercent + u64::from(reached);
        match NonZeroU64::new(span_millipercent) {
            Some(span) if span_millipercent <= u64::from(max_duty) * u64::from(MILLIPERCENT_PER_PERCENT) => {
                Ok(PwmOverride { pwm, max_duty, below_zero_millipercent, span_millipercent: span })
            }
            Some(_) => Err(CalibrationError::Coarse),
            None => Err(CalibrationError::OutOfReach { reached_percent: 0 }),
        }
    }

    /// Duty at which the control reads this override, rounded down.
    pub fn duty(&self, feed_override: FeedOverride) -> u16 {
        let above_zero_duty_millipercent = millipercent(feed_override) + self.below_zero_millipercent;
        let duty = above_zero_duty_millipercent * u64::from(self.max_duty) / self.span_millipercent; // (1)
        u16::try_from(duty).unwrap_or(self.max_duty).min(self.max_duty)
    }
}

/// An override in thousandths of a per cent.
fn millipercent(feed_override: FeedOverride) -> u64 {
    u64::from(feed_override.percent) * u64::from(MILLIPERCENT_PER_PERCENT)
}

impl<P: SetDutyCycle> OverrideOutput for PwmOverride<P> {
    type Error = P::Error;

    fn put(&mut self, feed_override: FeedOverride) -> Result<(), P::Error> {
        let duty = self.duty(feed_override);
        self.pwm.set_duty_cycle(duty).inspect_err(|_| {
            // The first failure is the one to report.
            let _ = self.pwm.set_duty_cycle_fully_off();
        })
    }

    fn release(&mut self) -> Result<(), P::Error> {
        self.pwm.set_duty_cycle_fully_off()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_hal_mock::eh1::MockError;
    use embedded_hal_mock::eh1::pwm::{Mock, Transaction};
    use std::io::ErrorKind;

    const TO_200: Calibration = Calibration { at_zero_duty_millipercent: 0, at_full_duty_millipercent: 200_000 };

    fn to(percent: u8) -> FeedOverride {
        FeedOverride { percent }
    }

    fn calibrated(max_duty: u16, zero: i32, full: i32, highest: u8) -> Result<PwmOverride<Mock>, CalibrationError> {
        let mut pwm = Mock::new(&[Transaction::max_duty_cycle(max_duty)]);
        let calibration = Calibration { at_zero_duty_millipercent: zero, at_full_duty_millipercent: full };
        let output = PwmOverride::new(pwm.clone(), calibration, to(highest));
        pwm.done();
        output
    }

    #[test]
    fn the_duty_is_put_out_and_a_release_is_fully_off() {
        let mut pwm = Mock::new(&[
            Transaction::max_duty_cycle(1_000),
            Transaction::set_duty_cycle(500),
            Transaction::set_duty_cycle(585),
            Transaction::set_duty_cycle(1_000),
            Transaction::set_duty_cycle(0),
        ]);
        let mut output = PwmOverride::new(pwm.clone(), TO_200, to(200)).unwrap();
        for percent in [100, 117, 254] {
            output.put(to(percent)).unwrap();
        }
        output.release().unwrap();
        pwm.done();
    }

    #[test]
    fn a_duty_that_is_refused_is_reported_and_switched_off() {
        let broken = MockError::Io(ErrorKind::NotConnected);
        let mut pwm = Mock::new(&[
            Transaction::max_duty_cycle(1_000),
            Transaction::set_duty_cycle(500).with_error(broken.clone()),
            Transaction::set_duty_cycle(0),
        ]);
        let mut output = PwmOverride::new(pwm.clone(), TO_200, to(200)).unwrap();
        assert_eq!(output.put(to(100)), Err(broken));
        pwm.done();
    }

    #[test]
    fn the_control_never_reads_more_than_wanted_and_less_by_under_a_step_of_the_duty() {
        for max_duty in [255, 1_000, 4_095, 65_535] {
            for (zero, full) in [(0, 200_000), (0, 254_000), (-800, 203_700), (-50_000, 204_321)] {
                let output = calibrated(max_duty, zero, full, 200).unwrap();
                let step = f64::from(full - zero) / f64::from(max_duty);
                let mut least_below = f64::INFINITY;
                for percent in 0..=200 {
                    let reading = f64::from(zero) + step * f64::from(output.duty(to(percent)));
                    let below = f64::from(percent) * 1e3 - reading;
                    assert!(below > -1e-6 && below < step, "{percent} % of {max_duty}, {zero} .. {full}: {below}");
                    assert!(percent == 0 || output.duty(to(percent)) > output.duty(to(percent - 1)));
                    least_below = least_below.min(below);
                }
                println!("{max_duty} steps, {zero} .. {full}: a step is {step:.1}, least below {least_below:.3}");
            }
        }
    }

    #[test]
    fn beyond_full_duty_is_full_duty() {
        let output = calibrated(65_535, 0, 203_700, 203).unwrap();
        assert_eq!((output.duty(to(204)), output.duty(to(255))), (65_535, 65_535));
    }

    #[test]
    fn a_calibration_that_cannot_do_it_is_refused() {
        use CalibrationError::{Coarse, Implausible, NoStop, OutOfReach};
        for (max_duty, zero, full, error) in [
            (65_535, 1, 200_000, NoStop),
            (65_535, 0, 199_999, OutOfReach { reached_percent: 199 }),
            (65_535, 0, 0, OutOfReach { reached_percent: 0 }),
            (65_535, 0, -200_000, OutOfReach { reached_percent: 0 }),
            (65_535, -1_000_001, 200_000, Implausible),
            (65_535, 0, 1_000_001, Implausible),
            (65_535, i32::MIN, i32::MAX, Implausible),
            (199, 0, 200_000, Coarse),
            (0, 0, 200_000, Coarse),
        ] {
            assert_eq!(calibrated(max_duty, zero, full, 200).err(), Some(error), "{max_duty}, {zero} .. {full}");
        }
        assert!(calibrated(200, 0, 200_000, 200).is_ok());
    }

    #[test]
    fn a_falling_input_is_refused_even_where_nothing_is_wanted_of_it() {
        assert_eq!(calibrated(65_535, 0, -1, 0).err(), Some(CalibrationError::OutOfReach { reached_percent: 0 }));
    }
}
