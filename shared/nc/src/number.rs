//! Exact decimal numbers of NC words.
//!
//! `-3.6044` is `-36044 * 10^-4`. Digits may be missing before the point (`.0`) or after it (`25.`), not both.

use super::alarm::Alarm;

/// Maximum number of digits of a number; more are PS0003.
pub const DIGITS_MAX: usize = 8;

/// Powers of ten up to the maximum number of digits.
pub(super) const POWERS_OF_TEN: [i32; 9] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];

/// Most characters of a number with blanks: sign, digits, decimal point, and one more.
const SPACED_MAX: usize = DIGITS_MAX + 3;

/// Number of possible positions of the decimal point, including none.
pub(super) const PLACES_MAX: usize = DIGITS_MAX + 2;

/// A decimal number of at most [`DIGITS_MAX`] digits, `mantissa * 10^-(point - 1)`, or `mantissa` without a decimal point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Number {
    mantissa: i32,
    /// 0 without a decimal point, otherwise one more than the number of digits after it.
    point: u8,
}

impl Number {
    /// Whether the number is less than zero.
    pub const fn is_negative(self) -> bool {
        self.mantissa < 0
    }

    /// Whether the number was written with a decimal point. Without one, an axis word counts in least increments.
    pub const fn has_point(self) -> bool {
        self.point != 0
    }

    /// The number in units of which `units_per_one` make one, rounded half away from zero; a unit may be as small as
    /// 1e-10.
    pub fn scaled(self, units_per_one: i64) -> i64 {
        let (product, divisor) = (i64::from(self.mantissa) * units_per_one, i64::from(self.divisor()));
        // Rounds half away from zero: a remainder of at least half the divisor counts.
        let (whole, rest) = (product.checked_div(divisor).unwrap_or(0), product.checked_rem(divisor).unwrap_or(0));
        whole + i64::from(2 * rest >= divisor) - i64::from(2 * rest <= -divisor)
    }

    /// 0 without a decimal point, otherwise one more than the number of digits after it.
    #[inline]
    pub(super) const fn place(self) -> usize {
        self.point as usize
    }

    /// All digits without the decimal point.
    #[inline]
    pub(super) const fn mantissa(self) -> i64 {
        self.mantissa as i64
    }

    /// The number as an integer, as for `N`, `G` and `M` words; `None` if it has a fraction.
    #[inline]
    pub fn as_whole(self) -> Option<i64> {
        if self.point == 0 {
            return Some(i64::from(self.mantissa));
        }
        let divisor = self.divisor();
        let is_whole = self.mantissa.checked_rem(divisor) == Some(0);
        self.mantissa.checked_div(divisor).filter(|_| is_whole).map(i64::from)
    }

    /// The number in tenths, as for G codes (`G43.4` is 434 tenths); `None` if that is not whole.
    #[inline]
    pub fn as_tenths(self) -> Option<i64> {
        if self.point == 0 {
            return Some(i64::from(self.mantissa) * 10);
        }
        let (tenfold, divisor) = (i64::from(self.mantissa) * 10, i64::from(self.divisor()));
        tenfold.checked_div(divisor).filter(|_| tenfold.checked_rem(divisor) == Some(0))
    }

    /// The number as the nearest f64.
    pub fn to_f64(self) -> f64 {
        f64::from(self.mantissa) / f64::from(self.divisor())
    }

    /// The power of ten by which the mantissa is divided; never 0. The compiler cannot prove this, and no panic path
    /// is allowed on the chip; therefore divisions by it are checked.
    fn divisor(self) -> i32 {
        POWERS_OF_TEN.get(usize::from(self.point.saturating_sub(1))).copied().unwrap_or(1)
    }
}

/// Reads the number that begins at byte `from` of `line`. Returns it and the offset of the byte after it; `None` if
/// there is no valid number, for which [`number_fault`] gives the reason.
#[inline]
pub fn read(line: &[u8], from: usize) -> Option<(Number, usize)> {
    let sign = line.get(from).copied().unwrap_or_default();
    let first = from + usize::from(sign == b'-' || sign == b'+');
    let (mut mantissa, mut behind_point, mut end) = (0_i32, 0, first);
    while let Some(&byte) = line.get(end) {
        let digit = byte.wrapping_sub(b'0');
        if digit < 10 {
            mantissa = mantissa.wrapping_mul(10).wrapping_add(i32::from(digit));
        } else if byte != b'.' {
            break;
        } else if behind_point == 0 {
            behind_point = end + 1;
        } else {
            return None;
        }
        end += 1;
    }
    let (point, dots) = if behind_point == 0 { (0, 0) } else { (end + 1 - behind_point, 1) };
    let digits = end - first - dots;
    if digits.wrapping_sub(1) >= DIGITS_MAX {
        return None;
    }
    let mantissa = if sign == b'-' { -mantissa } else { mantissa };
    Some((Number { mantissa, point: point as u8 }, end))
}

/// Whether the character is ignored between words: blank, in ISO code NUL, BS, HT, CR and DEL, and the end mark of DOS
/// files, which no sender transmits.
#[inline]
pub(super) const fn is_ignored(byte: u8) -> bool {
    matches!(byte, b' ' | 0 | 8 | b'\t' | b'\r' | 0x1a | 0x7f)
}

/// [`read`] with blanks before and among the characters of the number, which the control ignores. Returns the number, the
/// offset after it, and whether blanks are among its characters.
#[cold]
pub(super) fn read_spaced(line: &[u8], from: usize) -> Option<(Number, usize, bool)> {
    let (mut packed, mut len, mut start, mut end) = ([0; SPACED_MAX], 0, from, from);
    for (at, &byte) in line.iter().enumerate().skip(from) {
        match byte {
            b'0'..=b'9' | b'.' => {}
            b'+' | b'-' if len == 0 => {}
            _ if is_ignored(byte) => continue,
            _ => break,
        }
        *packed.get_mut(len)? = byte;
        start = if len == 0 { at } else { start };
        (len, end) = (len + 1, at + 1);
    }
    let (number, used) = read(packed.get(..len)?, 0)?;
    (used == len).then_some((number, end, end - start > len))
}

/// Reason why no number can be read at byte `from`, and the offset of the fault: PS0003 for more than [`DIGITS_MAX`]
/// digits, PS0005 for no digit, PS0007 for a second decimal point.
#[cold]
pub fn number_fault(line: &[u8], from: usize) -> (Alarm, usize) {
    let first = from + usize::from(matches!(line.get(from), Some(b'-' | b'+')));
    let (mut digits, mut points, mut at) = (0, 0, first);
    while let Some(byte @ (b'0'..=b'9' | b'.')) = line.get(at) {
        match byte {
            b'.' if points == 1 => return (Alarm::DecimalPoint, at),
            b'.' => points = 1,
            _ if digits == DIGITS_MAX => return (Alarm::TooManyDigits, at),
            _ => digits += 1,
        }
        at += 1;
    }
    (Alarm::NoDataAfterAddress, at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> f64 {
        read(text.as_bytes(), 0).unwrap().0.to_f64()
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
        let (number, len) = read(b"-3.6044Y10", 0).unwrap();
        assert_eq!((number.scaled(25_400_000), len), (-91_551_760, 7));
    }

    #[test]
    fn halves_round_away_from_zero() {
        assert_eq!(read(b"0.5", 0).unwrap().0.scaled(1), 1);
        assert_eq!(read(b"-0.5", 0).unwrap().0.scaled(1), -1);
    }

    #[test]
    fn what_is_not_a_number_names_its_alarm_and_place() {
        assert_eq!(number_fault(b"123456789", 0), (Alarm::TooManyDigits, 8));
        assert_eq!(number_fault(b"-1234.56789", 0), (Alarm::TooManyDigits, 10));
        assert_eq!(number_fault(b"123456789.1.1", 0), (Alarm::TooManyDigits, 8));
        assert_eq!(number_fault(b"12345678.1.1", 0), (Alarm::TooManyDigits, 9));
        assert_eq!(number_fault(&[b'1'; 100], 0), (Alarm::TooManyDigits, 8));
        assert_eq!(number_fault(b"-X", 0), (Alarm::NoDataAfterAddress, 1));
        assert_eq!(number_fault(b".", 0), (Alarm::NoDataAfterAddress, 1));
        assert_eq!(number_fault(b"1.2.3", 0), (Alarm::DecimalPoint, 3));
    }

    #[test]
    fn blanks_among_the_digits_do_not_count() {
        let spaced =
            |text: &str| read_spaced(text.as_bytes(), 0).map(|(number, end, blank)| (number.to_f64(), end, blank));
        assert_eq!(spaced(" 10 G"), Some((10.0, 3, false)));
        assert_eq!(spaced("1 0.5Y"), Some((10.5, 5, true)));
        assert_eq!(spaced("- 3 . 2 5"), Some((-3.25, 9, true)));
        assert_eq!(spaced("1. 10."), None);
        assert_eq!(spaced("1 2 3 4 5 6 7 8 9"), None);
        assert_eq!(spaced(" - Y"), None);
    }

    #[test]
    fn tenths_name_g_codes_with_a_decimal() {
        assert_eq!(read(b"43.4", 0).unwrap().0.as_tenths(), Some(434));
        assert_eq!(read(b"02", 0).unwrap().0.as_tenths(), Some(20));
        assert_eq!(read(b"1.25", 0).unwrap().0.as_tenths(), None);
    }

    #[test]
    fn whole_units_and_broken_ones_are_scaled_alike() {
        for (text, units, scaled) in [
            ("1.2345", 25_400_000, 31_356_300),
            ("-0.000001", 25_400_000, -25),
            ("1.2345678", 25_400_000, 31_358_022),
            ("-99999999", 25_400_000, -2_539_999_974_600_000),
            ("3.1415926", 1_000_000, 3_141_593),
            ("1.5", 10_000_000_000, 15_000_000_000),
        ] {
            assert_eq!(read(text.as_bytes(), 0).unwrap().0.scaled(units), scaled, "{text}");
        }
    }
}
