//! Words of NC blocks with expressions: evaluation of the values, and the block written with plain numbers.
//!
//! A value from a variable counts as written with a decimal point. It is rounded half away from zero to the least
//! increment of its address: 0.001 mm, 0.0001 in, 0.001 deg; G codes to tenths, counts and numbers to whole ones. A
//! word whose variable is vacant is left out.

use alloc::vec::Vec;

use super::code::{CodeCursor, is_keyword};
use super::expression::Evaluator;
use arcfeed_nc::alarm::{Alarm, Fault};
use arcfeed_nc::macro_alarm::MacroAlarm;
use arcfeed_units::LengthUnit;

/// Largest value of a word: eight digits.
const DIGITS_MAX: f64 = 99_999_999.0;
/// Decimals of a feed, within its eight digits.
const FEED_DECIMALS: i32 = 4;

/// A word of a block with its value computed, and its column.
#[derive(Clone, Debug, PartialEq)]
pub struct MacroWord {
    /// Address letter. The comma of `,C` or `,R` is an entry of its own before that of the letter.
    pub letter: u8,
    /// Number as text without variables, for the reader of plain blocks.
    pub spelled: Vec<u8>,
    /// Value; without a decimal point, in the increments of its address.
    pub(super) value: f64,
    /// Whether it is written with a decimal point or comes from a variable.
    pub has_point: bool,
    /// Column of the address in the line, counted from 1.
    pub column: u16,
}

/// Reads the words of a block to its end.
///
/// # Errors
/// PS0127 if a macro statement follows, PS0114 and others in expressions, and the faults of plain words.
pub fn read(cursor: &mut CodeCursor<'_>, evaluator: Evaluator<'_>, unit: LengthUnit) -> Result<Vec<MacroWord>, Fault> {
    let mut words = Vec::new();
    while let Some(letter) = cursor.peek() {
        let column = cursor.column();
        match letter {
            b'A'..=b'Z' => {}
            b',' => {
                cursor.skip(1);
                words.push(MacroWord { letter, spelled: Vec::new(), value: 0.0, has_point: false, column });
                continue;
            }
            b'#' => return Err(cursor.fault(MacroAlarm::MixedStatements)),
            b'[' | b']' | b'=' => return Err(cursor.fault(MacroAlarm::ExpressionFormat)),
            b'0'..=b'9' | b'+' | b'-' | b'.' => return Err(Fault::alarm(Alarm::IllegalAddress, column)),
            _ => return Err(Fault::alarm(Alarm::Character, column)),
        }
        if is_keyword(cursor.letters()) {
            return Err(cursor.fault(MacroAlarm::MixedStatements));
        }
        cursor.skip(1);
        words.extend(word(letter, column, cursor, evaluator.rounding_to(decimals(letter, unit)))?);
    }
    Ok(words)
}

/// Reads a word after its address; `None` if its value is vacant.
fn word(
    letter: u8,
    column: u16,
    cursor: &mut CodeCursor<'_>,
    evaluator: Evaluator<'_>,
) -> Result<Option<MacroWord>, Fault> {
    let is_expression =
        matches!(cursor.rest(), [b'#' | b'[' | b'A'..=b'Z', ..] | [b'+' | b'-', b'#' | b'[' | b'A'..=b'Z', ..]);
    if !is_expression {
        let before = cursor.rest();
        let number = cursor.number()?;
        let len = before.len() - cursor.rest().len();
        let spelled = before.get(..len).unwrap_or_default().to_vec();
        return Ok(Some(MacroWord { letter, spelled, value: number.to_f64(), has_point: number.has_point(), column }));
    }
    if matches!(cursor.peek(), Some(b'A'..=b'Z')) && !cursor.rest().contains(&b'[') {
        return Err(Fault::alarm(Alarm::NoDataAfterAddress, cursor.column()));
    }
    let Some(value) = evaluator.factor(cursor)? else { return Ok(None) };
    let spelled = spell(value, evaluator.decimals_kept(), letter).ok_or(Fault::alarm(Alarm::TooManyDigits, column))?;
    Ok(Some(MacroWord { letter, spelled, value, has_point: true, column }))
}

/// Decimals of an address's least increment.
fn decimals(letter: u8, unit: LengthUnit) -> i32 {
    match letter {
        b'D' | b'H' | b'L'..=b'P' | b'S' | b'T' => 0,
        b'G' => 1,
        b'F' => FEED_DECIMALS,
        b'A'..=b'C' => 3,
        _ => match unit {
            LengthUnit::Mm => 3,
            LengthUnit::Inch => 4,
        },
    }
}

/// Writes a value with at most `decimals` decimals, without trailing zeros; `None` if it needs more than eight digits.
fn spell(value: f64, decimals: i32, letter: u8) -> Option<Vec<u8>> {
    let mut decimals = decimals;
    let scaled = |decimals: i32| libm::round(value * libm::pow(10.0, f64::from(decimals)));
    while letter == b'F' && decimals > 0 && libm::fabs(scaled(decimals)) > DIGITS_MAX {
        decimals -= 1;
    }
    let whole = scaled(decimals);
    if libm::fabs(whole) > DIGITS_MAX {
        return None;
    }
    let mut left = libm::fabs(whole) as u64;
    let mut reversed = Vec::new();
    for place in 0..decimals {
        let digit = b'0' + (left % 10) as u8;
        if digit != b'0' || !reversed.is_empty() {
            reversed.push(digit);
        }
        left /= 10;
        if place + 1 == decimals && (letter != b'G' || !reversed.is_empty()) {
            reversed.push(b'.');
        }
    }
    reversed.push(b'0' + (left % 10) as u8);
    left /= 10;
    while left > 0 {
        reversed.push(b'0' + (left % 10) as u8);
        left /= 10;
    }
    if whole < 0.0 {
        reversed.push(b'-');
    }
    reversed.reverse();
    Some(reversed)
}

/// Text of consecutive words, and the column of its word for each byte.
pub fn spell_block<'w>(words: impl Iterator<Item = &'w MacroWord>) -> (Vec<u8>, Vec<u16>) {
    let (mut text, mut columns) = (Vec::new(), Vec::new());
    for word in words {
        text.push(word.letter);
        text.extend(&word.spelled);
        columns.resize(text.len(), word.column);
    }
    (text, columns)
}

#[cfg(test)]
mod tests {
    use super::super::code::MacroCode;
    use super::super::function::AngleRange;
    use super::super::variables::{Context, Variables};
    use super::*;
    use arcfeed_nc::modal::Modal;
    use arcfeed_units::Micros;

    fn spelled(text: &str, unit: LengthUnit) -> Result<String, Fault> {
        let context = Context::new(&Modal::at_power_on(unit), Micros(0));
        let mut variables = Variables::new(context);
        for (number, value) in [(1, 12.345_6), (2, -0.000_05), (3, 1.0), (4, 54.1)] {
            variables.write(number, Some(value)).unwrap();
        }
        let code = MacroCode::new(text.as_bytes());
        let words = read(&mut code.cursor(), Evaluator::new(&variables, AngleRange::Positive), unit)?;
        Ok(String::from_utf8(spell_block(words.iter()).0).unwrap())
    }

    #[test]
    fn values_are_rounded_to_the_increment_of_their_address() {
        for (text, mm, inch) in [
            ("X#1", "X12.346", "X12.3456"),
            ("X-#1", "X-12.346", "X-12.3456"),
            ("X#2", "X0.", "X-0.0001"),
            ("G#3M[#3+2]", "G1M3", "G1M3"),
            ("G#4", "G54.1", "G54.1"),
            ("B#1", "B12.346", "B12.346"),
            ("G1X100Y#9Z1.5", "G1X100Z1.5", "G1X100Z1.5"),
            ("F[12000]", "F12000.", "F12000."),
            ("X[ROUND[#1]*2]", "X24.692", "X24.6912"),
            (",C#3", ",C1.", ",C1."),
        ] {
            assert_eq!(spelled(text, LengthUnit::Mm).as_deref(), Ok(mm), "{text}");
            assert_eq!(spelled(text, LengthUnit::Inch).as_deref(), Ok(inch), "{text}");
        }
    }

    #[test]
    fn what_is_no_word_is_an_alarm() {
        for (text, fault) in [
            ("G1#1=2", Fault::in_macro(MacroAlarm::MixedStatements, 3)),
            ("X1.GOTO5", Fault::in_macro(MacroAlarm::MixedStatements, 4)),
            ("X[1", Fault::in_macro(MacroAlarm::ExpressionFormat, 4)),
            ("X[99999999]", Fault::alarm(Alarm::TooManyDigits, 1)),
            ("XY#1", Fault::alarm(Alarm::NoDataAfterAddress, 2)),
            ("X1?", Fault::alarm(Alarm::Character, 3)),
        ] {
            assert_eq!(spelled(text, LengthUnit::Mm), Err(fault), "{text}");
        }
    }
}
