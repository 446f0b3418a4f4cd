//! NC words: numbers in whole steps of the control's resolution, and blocks without the modal words that stay the same.
//!
//! Places are stored as written, so that relative words refer to the control's place.

use std::fmt::Write;

use arcfeed_units::{LengthUnit, MICRODEG_PER_DEG, NM_PER_INCH, Nm};

/// Difference between the sequence numbers of successive blocks.
const NUMBER_STEP: u32 = 2;

/// Decimals of rotary axes: a thousandth of a degree.
const DEGREE_DECIMALS: usize = 3;

/// Characters allowed in a comment: those of the ISO code except brackets.
const COMMENT_MARKS: &str = " .,-+/=*:#";

/// Format of lengths in an NC program: resolution and number of decimals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Format {
    /// Unit: inches with four decimals, millimetres with three.
    pub unit: LengthUnit,
}

impl Format {
    /// Length of one unit of the last decimal.
    pub fn step(self) -> Nm {
        match self.unit {
            LengthUnit::Inch => Nm(NM_PER_INCH / 10_000),
            LengthUnit::Mm => Nm(1_000),
        }
    }

    /// Number of decimals.
    pub fn decimals(self) -> usize {
        match self.unit {
            LengthUnit::Inch => 4,
            LengthUnit::Mm => 3,
        }
    }

    /// Length in units of the last decimal, rounded.
    pub fn steps(self, length_mm: f64) -> i64 {
        libm::round(length_mm / self.step().to_mm()) as i64
    }

    /// NC number with a decimal point, for a length of `steps` units of the last decimal.
    pub fn number(self, steps: i64) -> String {
        decimal(steps, self.decimals())
    }
}

/// NC number with a decimal point, for an angle in degrees.
pub fn degrees(angle_deg: f64) -> String {
    decimal(libm::round(angle_deg * 1e3) as i64, DEGREE_DECIMALS)
}

/// Angle in whole microdegrees, as a control reads the number that is written for it.
pub fn microdegrees(angle_deg: f64) -> i64 {
    let step = MICRODEG_PER_DEG / 1_000;
    libm::round(angle_deg * 1e3) as i64 * step
}

/// Number without trailing zeros and without a leading one, but with at least one digit: `-3.6`, `.25`, `25.`, `.0`.
fn decimal(value: i64, decimals: usize) -> String {
    if value == 0 {
        return ".0".into();
    }
    let digits = format!("{:0>width$}", value.unsigned_abs(), width = decimals + 1);
    let (whole, part) = digits.split_at(digits.len() - decimals);
    let sign = if value < 0 { "-" } else { "" };
    format!("{sign}{}.{}", whole.trim_start_matches('0'), part.trim_end_matches('0'))
}

/// Text of an NC program in the making, with the control's modal state, so that words in force are not repeated.
#[derive(Clone, Debug)]
pub struct Sheet {
    format: Format,
    text: String,
    number: u32,
    motion: &'static str,
    feed_mode: &'static str,
    feed: String,
}

impl Sheet {
    /// Empty program.
    pub fn new(format: Format) -> Self {
        Sheet { format, text: String::new(), number: 0, motion: "", feed_mode: "G94", feed: String::new() }
    }

    /// Text of the whole program.
    pub fn into_text(self) -> String {
        self.text
    }

    /// Writes a line without a number.
    pub fn line(&mut self, line: &str) {
        let _ = writeln!(self.text, "{line}");
    }

    /// Writes a comment, in characters that every control accepts.
    pub fn comment(&mut self, comment: &str) {
        let plain = |c: char| if c.is_ascii_alphanumeric() || COMMENT_MARKS.contains(c) { c } else { ' ' };
        let text: String = comment.to_uppercase().chars().map(plain).collect();
        self.line(&format!("({text})"));
    }

    /// Writes a numbered block.
    pub fn block(&mut self, words: &str) {
        self.number += NUMBER_STEP;
        let number = self.number;
        self.line(&format!("N{number}{words}"));
    }

    /// Writes a numbered block with a motion: `motion` is G0 to G3, `feed` is the feed mode and F. Codes that are in
    /// force already are left out.
    pub fn motion(&mut self, motion: &'static str, words: &str, feed: Option<(&'static str, f64)>) {
        let (mut codes, mut tail) = (String::new(), String::new());
        if let Some((mode, value)) = feed {
            let value = decimal(libm::round(value * 1e4) as i64, 4);
            if self.feed_mode != mode {
                codes += mode;
                // F has another meaning now.
                (self.feed_mode, self.feed) = (mode, String::new());
            }
            // Under G93 every block has its own F.
            if mode == "G93" || self.feed != value {
                tail = format!("F{value}");
            }
            self.feed = value;
        }
        if self.motion != motion {
            codes += motion;
            self.motion = motion;
        }
        self.block(&format!("{codes}{words}{tail}"));
    }

    /// NC word: a letter with a length of `steps` units of the last decimal.
    pub fn word(&self, letter: char, steps: i64) -> String {
        format!("{letter}{}", self.format.number(steps))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_short_as_the_published_ones() {
        let inch = Format { unit: LengthUnit::Inch };
        let cases = [(-36_044, "-3.6044"), (114_910, "11.491"), (250_000, "25."), (0, ".0"), (-5, "-.0005")];
        for (steps, text) in cases {
            assert_eq!(inch.number(steps), text);
        }
        assert_eq!(Format { unit: LengthUnit::Mm }.number(-12_340), "-12.34");
        assert_eq!(degrees(122.893_7), "122.894");
    }

    #[test]
    fn only_what_changes_is_written() {
        let mut sheet = Sheet::new(Format { unit: LengthUnit::Mm });
        sheet.motion("G1", "X1.", Some(("G94", 25.0)));
        sheet.motion("G1", "X2.", Some(("G94", 25.0)));
        sheet.motion("G1", "X3.", Some(("G93", 50.0)));
        sheet.motion("G1", "X4.", Some(("G93", 50.0)));
        sheet.motion("G2", "X5.", Some(("G94", 25.0)));
        sheet.motion("G0", "X6.", None);
        let lines = "N2G1X1.F25.\nN4X2.\nN6G93X3.F50.\nN8X4.F50.\nN10G94G2X5.F25.\nN12G0X6.\n";
        assert_eq!(sheet.into_text(), lines);
    }

    #[test]
    fn a_comment_has_no_brackets_of_its_own() {
        let mut sheet = Sheet::new(Format { unit: LengthUnit::Mm });
        sheet.comment("slot (1) – é");
        assert_eq!(sheet.into_text(), "(SLOT  1     )\n");
    }
}
