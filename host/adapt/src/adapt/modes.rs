//! Modal states that decide how the words of a line are written and read.

use arcfeed_units::LengthUnit;

use crate::program::ProgramLine;

/// Modal states that determine how words must be written: unit, absolute or incremental positions, kind of feed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Modes {
    /// Unit of lengths: G20 (inch) or G21 (mm).
    pub unit: LengthUnit,
    /// Positions are absolute (G90); otherwise incremental (G91).
    pub absolute: bool,
    /// F is a feed per minute (G94).
    pub per_minute: bool,
    /// Tapping mode (G63) is in force: the feed belongs to a thread and must not be changed.
    pub taps: bool,
}

impl Modes {
    /// Modes after power-on, with this unit.
    pub const fn at_power_on(unit: LengthUnit) -> Self {
        Modes { unit, absolute: true, per_minute: true, taps: false }
    }

    /// Modes in force after the G words of the line.
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
