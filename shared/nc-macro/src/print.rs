//! Output of a program over the control's serial line: DPRNT and BPRNT.
//!
//! `DPRNT[text #v[wf]]`: letters, digits and `+ - /` unchanged, `*` as a blank; a variable with `w` digits before the
//! decimal point and `f` after it, the last one rounded (truncated if `f` is 0). `BPRNT[text #v[f]]`: letters in ISO
//! code with its parity bit; a variable times 10^f as four bytes, big-endian. Both end with a line feed; a vacant
//! variable is zero.
//!
//! Sources: Haas 96-8000 p. 116 (DPRNT), NCT 99M p. 193 (BPRNT). The sign column, the padding and the truncation of
//! digits beyond `w` are assumed for a Fanuc: `[m]` in docs/dialect.md.

use alloc::vec::Vec;

use super::code::CodeCursor;
use super::expression::Evaluator;
use arcfeed_nc::alarm::Fault;
use arcfeed_nc::macro_alarm::MacroAlarm;

/// DC2: switches the receiver of the output on.
pub const PUNCH_ON: u8 = 0x12;
/// DC4: switches the receiver of the output off.
pub const PUNCH_OFF: u8 = 0x14;
/// Maximum number of digits, before and after the decimal point together.
const DIGITS_MAX: u32 = 8;

/// Format in which DPRNT writes numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PrintStyle {
    /// A column for the sign, leading zeros as blanks, and digits beyond the field cut off (parameter 6001, bit 1 is
    /// 0).
    #[default]
    Padded,
    /// As [`Self::Padded`], without blanks (parameter 6001 bit 1 is 1).
    Tight,
    /// Haas format: no column for the sign; a number with more digits makes the field longer.
    Growing,
}

/// Output of a program over the control's serial line (POPEN, DPRNT, BPRNT, PCLOS).
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Output {
    /// POPEN: begins the output.
    Open,
    /// PCLOS: ends the output.
    Close,
    /// DPRNT: a line of text with its line feed.
    Text(Vec<u8>),
    /// BPRNT: ISO codes and numbers, eight bits each, with a line feed.
    Binary(Vec<u8>),
}

impl Output {
    /// Bytes that the control sends, in ASCII.
    pub fn bytes(&self) -> &[u8] {
        match self {
            Output::Open => &[PUNCH_ON],
            Output::Close => &[PUNCH_OFF],
            Output::Text(bytes) | Output::Binary(bytes) => bytes,
        }
    }
}

/// Executes POPEN, PCLOS, DPRNT or BPRNT; `None` for any other statement.
///
/// # Errors
/// PS0114 or PS0115 for invalid text, variable or format; PS0119 for a number that does not fit BPRNT's four bytes.
pub fn statement(
    cursor: &mut CodeCursor<'_>,
    evaluator: Evaluator<'_>,
    style: PrintStyle,
) -> Result<Option<Output>, Fault> {
    Ok(if cursor.accept_keyword(b"POPEN") {
        Some(Output::Open)
    } else if cursor.accept_keyword(b"PCLOS") {
        Some(Output::Close)
    } else if cursor.accept_keyword(b"DPRNT") {
        Some(Output::Text(decimal(cursor, evaluator, style)?))
    } else if cursor.accept_keyword(b"BPRNT") {
        Some(Output::Binary(binary(cursor, evaluator)?))
    } else {
        None
    })
}

/// Reads the brackets of a DPRNT and returns its output.
fn decimal(cursor: &mut CodeCursor<'_>, evaluator: Evaluator<'_>, style: PrintStyle) -> Result<Vec<u8>, Fault> {
    print(cursor, evaluator, &|byte| byte, &|format, value, out| {
        let (before, behind) = (format / 10, format % 10);
        let is_format = format < 100 && (1..=DIGITS_MAX).contains(&(before + behind));
        if is_format {
            field(value, before as usize, behind as usize, style, out);
        }
        is_format
    })
}

/// Reads the brackets of a BPRNT and returns its output.
fn binary(cursor: &mut CodeCursor<'_>, evaluator: Evaluator<'_>) -> Result<Vec<u8>, Fault> {
    print(cursor, evaluator, &with_parity, &|format, value, out| {
        let scaled = libm::round(value * libm::pow(10.0, f64::from(format)));
        let fits = format <= DIGITS_MAX && (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&scaled);
        if fits {
            out.extend((scaled as i32).to_be_bytes());
        }
        fits
    })
}

type WriteNumber<'w> = dyn Fn(u32, f64, &mut Vec<u8>) -> bool + 'w;

fn print(
    cursor: &mut CodeCursor<'_>,
    evaluator: Evaluator<'_>,
    character: &dyn Fn(u8) -> u8,
    number: &WriteNumber<'_>,
) -> Result<Vec<u8>, Fault> {
    let mut out = Vec::new();
    if !cursor.accept(b"[") {
        return Err(cursor.fault(MacroAlarm::ExpressionFormat));
    }
    loop {
        let column = cursor.column();
        match cursor.peek() {
            Some(b']') => break,
            Some(b'#') => {
                let value = evaluator.factor(cursor)?.unwrap_or(0.0);
                let place = cursor.column();
                let format = if cursor.accept(b"[") { cursor.digits()? } else { None };
                let format = format
                    .filter(|_| cursor.accept(b"]"))
                    .ok_or(Fault::in_macro(MacroAlarm::ExpressionFormat, place))?;
                if !number(format, value, &mut out) {
                    return Err(Fault::in_macro(MacroAlarm::IllegalArgument, column));
                }
                continue;
            }
            Some(b'*') => out.push(character(b' ')),
            Some(byte @ (b'A'..=b'Z' | b'0'..=b'9' | b'+' | b'-' | b'/' | b'.' | b',' | b'=')) => {
                out.push(character(byte))
            }
            _ => return Err(cursor.fault(MacroAlarm::ExpressionFormat)),
        }
        cursor.skip(1);
    }
    cursor.skip(1);
    out.push(b'\n');
    Ok(out)
}

/// Writes a number with `before` digits before its decimal point and `behind` digits after it.
fn field(value: f64, before: usize, behind: usize, style: PrintStyle, out: &mut Vec<u8>) {
    let scale = libm::pow(10.0, behind as f64);
    let magnitude = libm::fabs(value) * scale;
    let digits = if behind > 0 { libm::round(magnitude) } else { libm::trunc(magnitude) };
    let mut left = digits as u64;
    let mut reversed = Vec::new();
    for _ in 0..behind {
        reversed.push(b'0' + (left % 10) as u8);
        left /= 10;
    }
    if behind > 0 {
        reversed.push(b'.');
    }
    let (mut places, cuts) = (0, style != PrintStyle::Growing);
    while (left > 0 || places == 0) && !(cuts && places == before) {
        reversed.push(b'0' + (left % 10) as u8);
        left /= 10;
        places += 1;
    }
    let sign = if value < 0.0 && digits > 0.0 { Some(b'-') } else { None };
    let blanks = before.saturating_sub(places);
    match style {
        PrintStyle::Padded => {
            out.push(sign.unwrap_or(b' '));
            out.extend(core::iter::repeat_n(b' ', blanks));
        }
        PrintStyle::Tight => out.extend(sign),
        PrintStyle::Growing => {
            out.extend(core::iter::repeat_n(b' ', blanks.saturating_sub(usize::from(sign.is_some()))));
            out.extend(sign);
        }
    }
    out.extend(reversed.iter().rev());
}

/// Sets the even-parity bit of the ISO code.
fn with_parity(byte: u8) -> u8 {
    if byte.count_ones().is_multiple_of(2) { byte } else { byte | 0x80 }
}

#[cfg(test)]
mod tests {
    use super::super::code::MacroCode;
    use super::super::function::AngleRange;
    use super::super::variables::{Context, Variables};
    use super::*;
    use arcfeed_nc::modal::Modal;
    use arcfeed_units::{LengthUnit, Micros};

    fn sent(text: &str, values: &[(u32, f64)], style: Option<PrintStyle>) -> Result<Vec<u8>, Fault> {
        let context = Context::new(&Modal::at_power_on(LengthUnit::Mm), Micros(0));
        let mut variables = Variables::new(context);
        for (number, value) in values {
            variables.write(*number, Some(*value)).unwrap();
        }
        let code = MacroCode::new(text.as_bytes());
        let evaluator = Evaluator::new(&variables, AngleRange::Positive);
        match style {
            Some(style) => decimal(&mut code.cursor(), evaluator, style),
            None => binary(&mut code.cursor(), evaluator),
        }
    }

    #[test]
    fn the_published_haas_examples() {
        let out = sent("[X#1[44]**Z#1[03]**T#1[40]]", &[(1, 1.5436)], Some(PrintStyle::Growing)).unwrap();
        // The columns of blanks are not legible in the source.
        let fields: Vec<String> =
            String::from_utf8(out).unwrap().split(['X', 'Z', 'T']).map(|field| field.trim().to_owned()).collect();
        assert_eq!(fields, ["", "1.5436", "1.544", "1"]);
    }

    #[test]
    fn the_published_nct_examples() {
        let out = sent("[C*#1[3]#2[3]#3[0]]", &[(1, 318.49362), (2, 0.723415), (3, 23.9)], None).unwrap();
        assert_eq!(out[1], 0xA0);
        assert_eq!(out[2..], [0x00, 0x04, 0xDC, 0x1E, 0x00, 0x00, 0x02, 0xD3, 0x00, 0x00, 0x00, 0x18, b'\n']);
    }

    #[test]
    fn a_padded_field_is_a_sign_and_its_digits_wide() {
        let values = [(2, 128.47398), (5, -91.2), (30, 123.456)];
        let out = |style| String::from_utf8(sent("[X#2[53]Y#5[53]T#30[20]]", &values, Some(style)).unwrap()).unwrap();
        assert_eq!(out(PrintStyle::Padded), "X   128.474Y-   91.200T 23\n");
        assert_eq!(out(PrintStyle::Tight), "X128.474Y-91.200T23\n");
    }

    #[test]
    fn what_is_no_format_is_an_alarm() {
        let alarm = |text| sent(text, &[], Some(PrintStyle::Padded)).unwrap_err();
        assert_eq!(alarm("[X#1]"), Fault::in_macro(MacroAlarm::ExpressionFormat, 5));
        assert_eq!(alarm("[X#1[54]]"), Fault::in_macro(MacroAlarm::IllegalArgument, 3));
        assert_eq!(alarm("[X"), Fault::in_macro(MacroAlarm::ExpressionFormat, 3));
    }
}
