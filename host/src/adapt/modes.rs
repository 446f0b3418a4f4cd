//! The modes that words are written in, followed from line to line.

use arcfeed_units::LengthUnit;

use crate::program::ProgramLine;

/// Modal states that determine how words must be written: unit, absolute or incremental, feed mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Modes {
    /// G20, G21.
    pub unit: LengthUnit,
    /// G90.
    pub absolute: bool,
    /// G94.
    pub per_minute: bool,
    /// G63: the feed is a thread's.
    pub taps: bool,
}

impl Modes {
    /// Modes at power-on.
    pub const fn at_power_on(unit: LengthUnit) -> Self {
        Modes { unit, absolute: true, per_minute: true, taps: false }
    }

    /// Modes after the G words of a line.
    #[must_use]
    pub fn after(self, line: &ProgramLine) -> Self {
        let Some(meaning) = &line.meaning else { return self };
        let codes = meaning.parsed.block.words.iter().filter(|word| word.letter == b'G');
        codes.fold(self, |modes, word| match word.number.as_whole() {
            Some(20) => Modes { unit: LengthUnit::Inch, ..modes },
            Some(21) => Modes { unit: LengthUnit::Mm, ..modes },
            Some(90) => Modes { absolute: true, ..modes },
            Some(91) => Modes { absolute: false, ..modes },
            Some(code @ (61..=64)) => Modes { taps: code == 63, ..modes },
            Some(code @ (93..=95)) => Modes { per_minute: code == 94, ..modes },
            _ => modes,
        })
    }
}
