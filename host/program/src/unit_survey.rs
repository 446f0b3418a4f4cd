//! Unit of a program's lengths: stated by G20 or G21, or inferred from its comments and decimals.

use arcfeed_nc::text::Lines;
use arcfeed_units::LengthUnit;

use super::{Diagnostic, Severity};

/// Words with as many decimals that show the unit of a program.
const LIKELY_WORDS: usize = 8;
const MM_WORDS: [&[u8]; 4] = [b"MM", b"METRIC", b"MILLIMETER", b"MILLIMETERS"];
const INCH_WORDS: [&[u8]; 2] = [b"INCH", b"INCHES"];

/// Unit in which a program without G20 and G21 is read, and the evidence for it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AssumedUnit {
    /// Unit that the program's text suggests; `None` if it suggests none.
    pub likely: Option<LengthUnit>,
    why: &'static str,
    /// Line and columns of the first length.
    place: [usize; 3],
    found: String,
}

impl AssumedUnit {
    /// Unit inferred from the text of a program; `None` if the program states its unit or has no length.
    pub fn of(program: &[u8]) -> Option<Self> {
        let mut survey = UnitSurvey::default();
        for (index, line) in Lines::new(program).enumerate() {
            if survey.add(index + 1, line.text) {
                return None;
            }
        }
        let (likely, why) = survey.unit();
        let (place, found) = survey.first?;
        Some(AssumedUnit { likely, why, place, found })
    }

    /// Text of the line with the first length.
    pub fn line_of<'p>(&self, program: &'p [u8]) -> &'p [u8] {
        Lines::new(program).nth(self.place[0] - 1).map_or(&b""[..], |line| line.text)
    }

    /// Warning with the unit and the reason for it; if the text has no evidence, the unit is that at power-on.
    pub fn warning(&self) -> Diagnostic {
        let unit = if self.likely == Some(LengthUnit::Mm) { "millimetres" } else { "inches" };
        let [line, column, end_column] = self.place;
        let message = format!(
            "no G20 or G21 in the program: its lengths are read as {unit}, {}; write G20 or G21 at its start, or give --units inch or \
             --units mm",
            self.why
        );
        let (severity, found) = (Severity::Warning, self.found.clone());
        Diagnostic { severity, line, column, end_column, alarm: None, message, found }
    }
}

#[derive(Default)]
struct UnitSurvey {
    has_mm: bool,
    has_inch: bool,
    /// Words with a third decimal at most, and with a fourth.
    third: usize,
    fourth: usize,
    first: Option<([usize; 3], String)>,
}

impl UnitSurvey {
    /// Adds a line; returns whether it has a G20 or G21.
    fn add(&mut self, line: usize, text: &[u8]) -> bool {
        let mut at = 0;
        while let Some(&byte) = text.get(at) {
            let begin = at;
            at += 1;
            match byte.to_ascii_uppercase() {
                b'(' => {
                    let rest = &text[at..];
                    let end = rest.iter().position(|byte| *byte == b')').unwrap_or(rest.len());
                    self.add_comment(&rest[..end]);
                    at += end;
                }
                b'G' => {
                    let number = Decimal::read(text, &mut at);
                    if number.is_some_and(|number| matches!(number.whole, 20 | 21) && number.decimals == 0) {
                        return true;
                    }
                }
                b'X' | b'Y' | b'Z' | b'I' | b'J' | b'K' | b'R' => {
                    let Some(number) = Decimal::read(text, &mut at) else { continue };
                    self.third += usize::from(number.decimals == 3);
                    self.fourth += usize::from(number.decimals == 4);
                    let found = || text[begin..at].escape_ascii().to_string();
                    self.first.get_or_insert_with(|| ([line, begin + 1, at + 1], found()));
                }
                _ => {}
            }
        }
        false
    }

    fn add_comment(&mut self, comment: &[u8]) {
        for word in comment.split(|byte| !byte.is_ascii_alphabetic()) {
            let is_one_of = |words: &[&[u8]]| words.iter().any(|known| known.eq_ignore_ascii_case(word));
            self.has_mm |= is_one_of(&MM_WORDS);
            self.has_inch |= is_one_of(&INCH_WORDS);
        }
    }

    /// Unit by the words of comments, or by the decimals of coordinates: posts write four in inches and three in
    /// millimetres. None if comments name both, or too few words have as many decimals.
    fn unit(&self) -> (Option<LengthUnit>, &'static str) {
        match (self.has_mm, self.has_inch) {
            (true, false) => return (Some(LengthUnit::Mm), "the unit in its comments"),
            (false, true) => return (Some(LengthUnit::Inch), "the unit in its comments"),
            _ => {}
        }
        match () {
            () if self.fourth >= LIKELY_WORDS => (Some(LengthUnit::Inch), "because coordinates have four decimals"),
            () if self.third >= LIKELY_WORDS && self.fourth == 0 => {
                (Some(LengthUnit::Mm), "because coordinates have three decimals and none has four")
            }
            () => (None, "the unit at power-on"),
        }
    }
}

/// Number of a word.
#[derive(Clone, Copy)]
struct Decimal {
    whole: u64,
    /// Decimals that are needed, up to four.
    decimals: usize,
}

impl Decimal {
    /// Reads a number with blanks and a sign before it; leaves `at` behind it.
    fn read(text: &[u8], at: &mut usize) -> Option<Self> {
        let is_between = |byte: &u8| matches!(byte, b' ' | b'\t' | b'+' | b'-');
        let mut place = *at + text.get(*at..)?.iter().take_while(|byte| is_between(byte)).count();
        let (begin, mut number) = (place, Decimal { whole: 0, decimals: 0 });
        while let Some(digit) = text.get(place).filter(|byte| byte.is_ascii_digit()) {
            number.whole = number.whole.saturating_mul(10).saturating_add(u64::from(digit - b'0'));
            place += 1;
        }
        if text.get(place) == Some(&b'.') {
            place += 1;
            let decimals = text[place..].iter().take_while(|byte| byte.is_ascii_digit()).count();
            let needed = text[place..place + decimals.min(4)].iter().rposition(|digit| *digit != b'0');
            number.decimals = needed.map_or(0, |index| index + 1);
            place += decimals;
        }
        let is_number = place > begin;
        *at = if is_number { place } else { *at };
        is_number.then_some(number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn likely(program: &str) -> Option<Option<LengthUnit>> {
        AssumedUnit::of(program.as_bytes()).map(|assumed| assumed.likely)
    }

    #[test]
    fn a_stated_unit_is_found_and_one_in_a_comment_is_not_stated() {
        for stated in ["G21\nX1.\n", "N1 g 20G0X1.\n", "X1.\nG00G021X2.\n", "(NOTHING)\nM30\n", ""] {
            assert_eq!(likely(stated), None, "{stated}");
        }
        for open in ["(G21)\nX1.\n", "G20.1X1.\n", "G200X1.\n", "G2X1.\n"] {
            assert_eq!(likely(open), Some(None), "{open}");
        }
    }

    #[test]
    fn comments_and_decimals_betray_the_unit() {
        let words = |word: &str| format!("{}\n", word.repeat(8));
        assert_eq!(likely(&words("G1X1.123")), Some(Some(LengthUnit::Mm)));
        assert_eq!(likely(&words("G1X-.1234")), Some(Some(LengthUnit::Inch)));
        assert_eq!(likely(&words("G1X1.5000")), Some(None));
        assert_eq!(likely("(10MM ENDMILL)\nG1X1.\n"), Some(Some(LengthUnit::Mm)));
        assert_eq!(likely("(UNITS: Inches)\nG1X1.\n"), Some(Some(LengthUnit::Inch)));
        assert_eq!(likely("(INCH AND MM)\nG1X1.\n"), Some(None));
    }

    #[test]
    fn the_warning_stands_at_the_first_length() {
        let warning = AssumedUnit::of(b"%\nG0 X10. Y2.\n").unwrap().warning();
        assert_eq!((warning.line, warning.column, warning.end_column, &*warning.found), (2, 4, 8, "X10."));
        assert!(warning.message.contains("inches, the unit at power-on"), "{}", warning.message);
    }
}
