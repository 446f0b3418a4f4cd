//! Conversion of numbers to whole units, without a division if the units are small enough.
//!
//! A length word becomes a number of nanometres: with a decimal point its mantissa times the unit divided by a power
//! of ten, without one its mantissa times the least increment. The factor depends only on the position of the decimal
//! point.

use super::number::{Number, PLACES_MAX};
use super::settings::Decimals;
use arcfeed_units::{LengthUnit, MICRODEG_PER_DEG};

/// Least increments of a rotary axis in a degree (0.001 deg).
const INCREMENTS_PER_DEG: i64 = 1_000;

/// Conversion factors for one kind of number; configuration.
#[derive(Debug)]
pub struct Scale {
    units_per_one: i64,
    /// Factors by the position of the decimal point, as in [`Number::place`]; 0 if the factor is not whole.
    factors: [i64; PLACES_MAX],
}

static ROTARY: Scale = Scale::new(MICRODEG_PER_DEG, INCREMENTS_PER_DEG);
static ROTARY_WHOLE: Scale = Scale::new(MICRODEG_PER_DEG, 1);
static MM: Scale = Scale::new(LengthUnit::Mm.nm(), increments_per_unit(LengthUnit::Mm));
static MM_WHOLE: Scale = Scale::new(LengthUnit::Mm.nm(), 1);
static INCH: Scale = Scale::new(LengthUnit::Inch.nm(), increments_per_unit(LengthUnit::Inch));
static INCH_WHOLE: Scale = Scale::new(LengthUnit::Inch.nm(), 1);

/// Least increments in one unit of length: 0.001 mm, 0.0001 in.
const fn increments_per_unit(unit: LengthUnit) -> i64 {
    match unit {
        LengthUnit::Mm => 1_000,
        LengthUnit::Inch => 10_000,
    }
}

/// A unit divided by a power of ten; 0 if the quotient is not whole.
const fn part(units_per_one: i64, digits: u32) -> i64 {
    let divisor = 10_i64.pow(digits);
    if units_per_one % divisor == 0 { units_per_one / divisor } else { 0 }
}

impl Scale {
    /// A scale of `units_per_one` for numbers with a decimal point and `units_per_one / increments_per_one` for
    /// numbers without.
    const fn new(units_per_one: i64, increments_per_one: i64) -> Self {
        let u = units_per_one;
        let factors = [
            u / increments_per_one,
            part(u, 0),
            part(u, 1),
            part(u, 2),
            part(u, 3),
            part(u, 4),
            part(u, 5),
            part(u, 6),
            part(u, 7),
            part(u, 8),
        ];
        Scale { units_per_one: u, factors }
    }

    /// Scale of lengths, nm.
    #[inline]
    pub fn of_lengths(unit: LengthUnit, decimals: Decimals) -> &'static Scale {
        match (unit, decimals) {
            (LengthUnit::Mm, Decimals::LeastIncrement) => &MM,
            (LengthUnit::Mm, Decimals::Calculator) => &MM_WHOLE,
            (LengthUnit::Inch, Decimals::LeastIncrement) => &INCH,
            (LengthUnit::Inch, Decimals::Calculator) => &INCH_WHOLE,
        }
    }

    /// Scale of angles, microdegrees.
    #[inline]
    pub fn of_angles(decimals: Decimals) -> &'static Scale {
        match decimals {
            Decimals::LeastIncrement => &ROTARY,
            Decimals::Calculator => &ROTARY_WHOLE,
        }
    }

    /// The number in units of the scale, rounded half away from zero.
    #[inline]
    pub fn of(&self, number: Number) -> i64 {
        match self.factors.get(number.place()) {
            Some(&factor) if factor != 0 => number.mantissa() * factor,
            _ => number.scaled(self.units_per_one),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number;

    #[test]
    fn every_scale_agrees_with_the_division_it_saves() {
        for unit in [LengthUnit::Mm, LengthUnit::Inch] {
            for text in ["1.", "-.5", "0.00005", "-3.6044", "1.2345678", "-.00000015", "99999999.", ".12345678"] {
                let (number, _) = number::read(text.as_bytes(), 0).unwrap();
                let counted = Scale::of_lengths(unit, Decimals::LeastIncrement).of(number);
                assert_eq!(counted, number.scaled(unit.nm()), "{text}");
                assert_eq!(
                    Scale::of_angles(Decimals::Calculator).of(number),
                    number.scaled(MICRODEG_PER_DEG),
                    "{text}"
                );
            }
        }
    }

    #[test]
    fn without_a_point_a_number_counts_least_increments_or_whole_units() {
        let (number, _) = number::read(b"-25", 0).unwrap();
        let lengths = |unit, decimals| Scale::of_lengths(unit, decimals).of(number);
        assert_eq!(lengths(LengthUnit::Mm, Decimals::LeastIncrement), -25_000);
        assert_eq!(lengths(LengthUnit::Inch, Decimals::LeastIncrement), -63_500);
        assert_eq!(lengths(LengthUnit::Inch, Decimals::Calculator), -25 * 25_400_000);
        assert_eq!(Scale::of_angles(Decimals::LeastIncrement).of(number), -25_000);
    }
}
