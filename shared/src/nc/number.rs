//! NC numbers as exact decimals.
//!
//! `-3.6044` is `-36044 * 10^-4`. Digits may be missing before the point (`.0`) or after it (`25.`), not both.

use super::alarm::Alarm;

/// Most digits a control accepts in one number (beyond: PS0003).
pub const DIGITS_MAX: u8 = 8;

const POWERS_OF_TEN: [i64; 9] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];

/// A decimal number, `mantissa * 10^-decimals`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Number {
    mantissa: i64,
    decimals: u8,
    /// Whether a decimal point was written: without it, an axis word counts in least increments.
    pub has_point: bool,
}

impl Number {
    /// A whole number, as if written without a point.
    pub const fn whole(value: i64) -> Self {
        Number { mantissa: value, decimals: 0, has_point: false }
    }

    /// Whether it is less than zero.
    pub const fn is_negative(self) -> bool {
        self.mantissa < 0
    }

    /// `self * units_per_one`, rounded half away from zero to a whole number of units.
    pub fn scaled(self, units_per_one: i64) -> i64 {
        if let Some(product) = self.mantissa.checked_mul(units_per_one)
            && let Some(&divisor) = POWERS_OF_TEN.get(usize::from(self.decimals))
        {
            // Away from zero: what is cut off counts from half the divisor on.
            let (whole, rest) = (product / divisor, product % divisor);
            return whole + i64::from(2 * rest >= divisor) - i64::from(2 * rest <= -divisor);
        }
        self.scaled_wide(units_per_one)
    }

    /// For numbers longer than a control's.
    fn scaled_wide(self, units_per_one: i64) -> i64 {
        let product = i128::from(self.mantissa) * i128::from(units_per_one);
        let divisor = 10_i128.pow(u32::from(self.decimals));
        let half = divisor / 2;
        let rounded = if product < 0 { (product - half) / divisor } else { (product + half) / divisor };
        i64::try_from(rounded).unwrap_or(if rounded < 0 { i64::MIN } else { i64::MAX })
    }

    /// The value if it has no fraction, as for `N`, `G` and `M` words.
    pub fn as_whole(self) -> Option<i64> {
        if self.decimals == 0 {
            return Some(self.mantissa);
        }
        let divisor = 10_i64.pow(u32::from(self.decimals));
        (self.mantissa % divisor == 0).then_some(self.mantissa / divisor)
    }

    /// Tenths, if that is exact: `G43.4` is 434 tenths.
    pub fn as_tenths(self) -> Option<i64> {
        if self.decimals == 0 {
            return self.mantissa.checked_mul(10);
        }
        let divisor = 10_i64.pow(u32::from(self.decimals));
        let tenfold = self.mantissa * 10;
        (tenfold % divisor == 0).then_some(tenfold / divisor)
    }

    /// The nearest f64.
    pub fn to_f64(self) -> f64 {
        self.mantissa as f64 / 10_i64.pow(u32::from(self.decimals)) as f64
    }
}

/// Reads a number at the start of `text`: the number and the bytes it takes.
///
/// # Errors
/// PS0003 more than [`DIGITS_MAX`] digits, PS0005 no digit at all, PS0007 a second point; each with the offset of the
/// offending byte.
#[inline]
pub fn read(text: &[u8]) -> Result<(Number, usize), (Alarm, usize)> {
    let mut at = 0;
    let negative = match text.first() {
        Some(b'-') => {
            at = 1;
            true
        }
        Some(b'+') => {
            at = 1;
            false
        }
        _ => false,
    };
    let (mut mantissa, mut digits, mut decimals, mut has_point) = (0_i64, 0_u8, 0_u8, false);
    for &byte in text.get(at..).unwrap_or_default() {
        let digit = byte.wrapping_sub(b'0');
        if digit < 10 {
            if digits == DIGITS_MAX {
                return Err((Alarm::TooManyDigits, at));
            }
            mantissa = mantissa * 10 + i64::from(digit);
            digits += 1;
            decimals += u8::from(has_point);
        } else if byte == b'.' {
            if has_point {
                return Err((Alarm::DecimalPoint, at));
            }
            has_point = true;
        } else {
            break;
        }
        at += 1;
    }
    if digits == 0 {
        return Err((Alarm::NoDataAfterAddress, at));
    }
    let number = Number { mantissa: if negative { -mantissa } else { mantissa }, decimals, has_point };
    Ok((number, at))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> f64 {
        read(text.as_bytes()).unwrap().0.to_f64()
    }

    #[test]
    fn digits_may_be_missing_on_either_side_of_the_point() {
        assert_eq!(value(".0"), 0.0);
        assert_eq!(value("25."), 25.0);
        assert_eq!(value("-.5"), -0.5);
        assert_eq!(value("+1.25"), 1.25);
    }

    #[test]
    fn a_published_coordinate_is_exact_in_nanometres() {
        let (number, len) = read(b"-3.6044Y10").unwrap();
        assert_eq!((number.scaled(25_400_000), len), (-91_551_760, 7));
    }

    #[test]
    fn halves_round_away_from_zero() {
        assert_eq!(read(b"0.5").unwrap().0.scaled(1), 1);
        assert_eq!(read(b"-0.5").unwrap().0.scaled(1), -1);
    }

    #[test]
    fn what_is_not_a_number_names_its_alarm_and_place() {
        assert_eq!(read(b"123456789"), Err((Alarm::TooManyDigits, 8)));
        assert_eq!(read(b"-X"), Err((Alarm::NoDataAfterAddress, 1)));
        assert_eq!(read(b"."), Err((Alarm::NoDataAfterAddress, 1)));
        assert_eq!(read(b"1.2.3"), Err((Alarm::DecimalPoint, 3)));
    }

    #[test]
    fn tenths_name_g_codes_with_a_decimal() {
        assert_eq!(read(b"43.4").unwrap().0.as_tenths(), Some(434));
        assert_eq!(read(b"02").unwrap().0.as_tenths(), Some(20));
        assert_eq!(read(b"1.25").unwrap().0.as_tenths(), None);
    }
}
