//! Functions and operators of macro expressions, angles in degrees.
//!
//! Source: operation lists of Fanuc's custom macro B. ROUND rounds half away from zero, FIX towards zero, FUP away
//! from it. MOD rounds both operands to whole numbers first; its result has the sign of the first. AND, OR and XOR
//! work on 32 bits. ATAN with two arguments and ASIN return 0 to 360 degrees, or -180 to 180 with [`AngleRange::Signed`]
//! (parameter 6004 bit 0).

use core::f64::consts::PI;

use arcfeed_nc::macro_alarm::MacroAlarm;

/// Largest absolute value of a result.
const RESULT_MAX: f64 = 1e47;
/// Half a turn, in degrees.
const HALF_TURN_DEG: f64 = 180.0;
/// A full turn, in degrees.
const TURN_DEG: f64 = 360.0;
/// Largest argument of BIN and BCD: eight digits.
const BCD_MAX: f64 = 99_999_999.0;

/// Range of the angles that ASIN and ATAN with two arguments return (parameter 6004, bit 0).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AngleRange {
    /// 0 to 360 degrees; for ASIN 270 to 360 and 0 to 90.
    #[default]
    Positive,
    /// -180 to 180 degrees; ASIN -90 to 90.
    Signed,
}

/// Function of macro expressions, such as `SIN` or `ROUND`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// `SIN`: argument in degrees.
    Sin,
    /// `COS`: argument in degrees.
    Cos,
    /// `TAN`: argument in degrees.
    Tan,
    /// `ASIN`: result in degrees.
    Asin,
    /// `ACOS`: result in degrees.
    Acos,
    /// `ATAN`: result in degrees; with two arguments, the angle of the point whose x is the second and whose y is the
    /// first.
    Atan,
    /// Square root.
    Sqrt,
    /// Absolute value.
    Abs,
    /// Rounds half away from zero.
    Round,
    /// Rounds towards zero.
    Fix,
    /// Rounds away from zero.
    Fup,
    /// Natural logarithm.
    Ln,
    /// Exponential function.
    Exp,
    /// `POW[base, exponent]`.
    Pow,
    /// `BIN`: converts a binary-coded decimal number to the number.
    Bin,
    /// `BCD`: converts a number to binary-coded decimal.
    Bcd,
}

const NAMES: [(&[u8], Function); 17] = [
    (b"SIN", Function::Sin),
    (b"COS", Function::Cos),
    (b"TAN", Function::Tan),
    (b"ASIN", Function::Asin),
    (b"ACOS", Function::Acos),
    (b"ATAN", Function::Atan),
    (b"SQRT", Function::Sqrt),
    (b"SQR", Function::Sqrt),
    (b"ABS", Function::Abs),
    (b"ROUND", Function::Round),
    (b"FIX", Function::Fix),
    (b"FUP", Function::Fup),
    (b"LN", Function::Ln),
    (b"EXP", Function::Exp),
    (b"POW", Function::Pow),
    (b"BIN", Function::Bin),
    (b"BCD", Function::Bcd),
];

impl Function {
    /// The function of this name, which may be shortened to its first two letters or more.
    pub fn named(name: &[u8]) -> Option<Self> {
        let is_name = |full: &[u8]| full == name || (name.len() >= 2 && full.starts_with(name));
        NAMES.iter().find(|(full, _)| is_name(full)).map(|(_, function)| *function)
    }

    pub(super) fn apply(self, x: f64, angles: AngleRange) -> Result<f64, MacroAlarm> {
        let in_range = |is_defined: bool| if is_defined { Ok(()) } else { Err(MacroAlarm::IllegalArgument) };
        let result = match self {
            Function::Sin => sin_deg(x),
            Function::Cos => sin_deg(x + 90.0),
            Function::Tan => {
                let cos = sin_deg(x + 90.0);
                in_range(cos != 0.0)?;
                sin_deg(x) / cos
            }
            Function::Asin => {
                in_range(libm::fabs(x) <= 1.0)?;
                turned(to_deg(libm::asin(x)), angles)
            }
            Function::Acos => {
                in_range(libm::fabs(x) <= 1.0)?;
                to_deg(libm::acos(x))
            }
            Function::Atan => to_deg(libm::atan(x)),
            Function::Sqrt => {
                in_range(x >= 0.0)?;
                libm::sqrt(x)
            }
            Function::Abs => libm::fabs(x),
            Function::Round => libm::round(x),
            Function::Fix => libm::trunc(x),
            Function::Fup => libm::copysign(libm::ceil(libm::fabs(x)), x),
            Function::Ln => {
                in_range(x > 0.0)?;
                libm::log(x)
            }
            Function::Exp => libm::exp(x),
            Function::Bin => digits(x, 16, 10)?,
            Function::Bcd => digits(x, 10, 16)?,
            Function::Pow => return Err(MacroAlarm::ExpressionFormat),
        };
        checked(result)
    }

    /// Evaluates a function with two arguments.
    pub(super) fn apply_two(self, x: f64, y: f64, angles: AngleRange) -> Result<f64, MacroAlarm> {
        match self {
            Function::Atan => checked(turned(to_deg(libm::atan2(x, y)), angles)),
            Function::Pow => {
                let result = libm::pow(x, y);
                if result.is_nan() || (x == 0.0 && y < 0.0) {
                    Err(MacroAlarm::IllegalArgument)
                } else {
                    checked(result)
                }
            }
            _ => Err(MacroAlarm::ExpressionFormat),
        }
    }
}

/// Binary operator of macro expressions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// `+`.
    Add,
    /// `-`.
    Subtract,
    /// `*`.
    Multiply,
    /// `/`.
    Divide,
    /// `MOD`.
    Modulo,
    /// `AND`.
    And,
    /// `OR`.
    Or,
    /// `XOR`.
    Xor,
}

impl Operator {
    pub(super) fn apply(self, x: f64, y: f64) -> Result<f64, MacroAlarm> {
        let bits = |join: fn(i64, i64) -> i64| Ok(join(whole(x)?, whole(y)?) as f64);
        match self {
            Operator::Add => checked(x + y),
            Operator::Subtract => checked(x - y),
            Operator::Multiply => checked(x * y),
            Operator::Divide if y == 0.0 => Err(MacroAlarm::DivisionByZero),
            Operator::Divide => checked(x / y),
            Operator::Modulo => {
                let divisor = libm::round(y);
                if divisor == 0.0 {
                    Err(MacroAlarm::DivisionByZero)
                } else {
                    checked(libm::fmod(libm::round(x), divisor))
                }
            }
            Operator::And => bits(|a, b| a & b),
            Operator::Or => bits(|a, b| a | b),
            Operator::Xor => bits(|a, b| a ^ b),
        }
    }
}

/// Checks a result against the range of a variable.
fn checked(x: f64) -> Result<f64, MacroAlarm> {
    if libm::fabs(x) <= RESULT_MAX { Ok(x) } else { Err(MacroAlarm::Overflow) }
}

/// Operand of a bit operator: a whole number of 32 bits.
fn whole(x: f64) -> Result<i64, MacroAlarm> {
    let rounded = libm::round(x);
    let fits = rounded >= f64::from(i32::MIN) && rounded <= f64::from(u32::MAX);
    if fits { Ok(rounded as i64) } else { Err(MacroAlarm::IllegalArgument) }
}

/// Sine of an angle in degrees; exact at multiples of 90 degrees.
fn sin_deg(deg: f64) -> f64 {
    let in_turn = libm::fmod(deg, TURN_DEG);
    match libm::fabs(in_turn) {
        0.0 | HALF_TURN_DEG => 0.0,
        90.0 => libm::copysign(1.0, in_turn),
        270.0 => libm::copysign(1.0, -in_turn),
        _ => libm::sin(in_turn / HALF_TURN_DEG * PI),
    }
}

fn to_deg(rad: f64) -> f64 {
    rad / PI * HALF_TURN_DEG
}

fn turned(deg: f64, angles: AngleRange) -> f64 {
    if angles == AngleRange::Positive && deg < 0.0 { deg + TURN_DEG } else { deg }
}

/// Converts the digits of a number from one base to another.
fn digits(x: f64, from: u64, to: u64) -> Result<f64, MacroAlarm> {
    let rounded = libm::round(x);
    let max = if from == 16 { f64::from(u32::MAX) } else { BCD_MAX };
    if !(0.0..=max).contains(&rounded) {
        return Err(MacroAlarm::IllegalArgument);
    }
    let (mut left, mut result, mut weight) = (rounded as u64, 0, 1);
    while left > 0 {
        let digit = left % from;
        if digit > 9 {
            return Err(MacroAlarm::IllegalArgument);
        }
        result += digit * weight;
        weight *= to;
        left /= from;
    }
    Ok(result as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(name: &[u8], x: f64) -> Result<f64, MacroAlarm> {
        Function::named(name).unwrap().apply(x, AngleRange::Positive)
    }

    #[test]
    fn names_may_be_cut_down_to_two_letters() {
        assert_eq!(Function::named(b"RO"), Some(Function::Round));
        assert_eq!(Function::named(b"AT"), Some(Function::Atan));
        assert_eq!(Function::named(b"SQ"), Some(Function::Sqrt));
        assert_eq!((Function::named(b"S"), Function::named(b"FOO")), (None, None));
    }

    #[test]
    fn quarters_are_exact() {
        for (deg, sin, cos) in
            [(0.0, 0.0, 1.0), (90.0, 1.0, 0.0), (180.0, 0.0, -1.0), (270.0, -1.0, 0.0), (-90.0, -1.0, 0.0)]
        {
            assert_eq!((of(b"SIN", deg), of(b"COS", deg)), (Ok(sin), Ok(cos)), "{deg}");
        }
        assert_eq!(of(b"TAN", 90.0), Err(MacroAlarm::IllegalArgument));
    }

    #[test]
    fn all_four_quadrants_are_distinguished() {
        for (y, x, positive, signed) in
            [(1.0, 1.0, 45.0, 45.0), (1.0, -1.0, 135.0, 135.0), (-1.0, -1.0, 225.0, -135.0), (-1.0, 1.0, 315.0, -45.0)]
        {
            assert_eq!(Function::Atan.apply_two(y, x, AngleRange::Positive), Ok(positive));
            assert_eq!(Function::Atan.apply_two(y, x, AngleRange::Signed), Ok(signed));
        }
    }

    #[test]
    fn rounding_is_away_from_zero_at_halves() {
        for (name, wanted) in [(&b"ROUND"[..], [1.0, -1.0, 2.0]), (b"FIX", [0.0, 0.0, 1.0]), (b"FUP", [1.0, -1.0, 2.0])]
        {
            assert_eq!([0.5, -0.5, 1.5].map(|x| of(name, x).unwrap()), wanted, "{name:?}");
        }
    }

    #[test]
    fn decimal_digits_in_four_bits() {
        assert_eq!((of(b"BCD", 1234.0), of(b"BIN", f64::from(0x1234))), (Ok(f64::from(0x1234)), Ok(1234.0)));
        assert_eq!(of(b"BIN", 10.0), Err(MacroAlarm::IllegalArgument));
        assert_eq!(of(b"BCD", -1.0), Err(MacroAlarm::IllegalArgument));
    }

    #[test]
    fn what_has_no_result_is_an_alarm() {
        for (name, x) in [(&b"SQRT"[..], -1.0), (b"LN", 0.0), (b"ASIN", 1.1), (b"ACOS", -1.1)] {
            assert_eq!(of(name, x), Err(MacroAlarm::IllegalArgument), "{name:?}");
        }
        assert_eq!(of(b"EXP", 1e6), Err(MacroAlarm::Overflow));
        assert_eq!(Operator::Divide.apply(1.0, 0.0), Err(MacroAlarm::DivisionByZero));
        assert_eq!(Operator::Modulo.apply(-7.0, 3.0), Ok(-1.0));
    }
}
