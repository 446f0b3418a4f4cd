//! Modal information (#4001 to #4130): codes and words in effect, from the blocks executed so far.

use super::code::CodeCursor;
use arcfeed_units::LengthUnit;

/// G codes in tenths, by group.
const GROUPS: [(usize, &[i64]); 19] = [
    (1, &[0, 10, 20, 30, 330]),
    (2, &[170, 180, 190]),
    (3, &[900, 910]),
    (4, &[220, 230]),
    (5, &[930, 940, 950]),
    (6, &[200, 210]),
    (7, &[400, 410, 420]),
    (8, &[430, 434, 435, 440, 490]),
    (9, &[730, 740, 760, 800, 810, 820, 830, 840, 850, 860, 870, 880, 890]),
    (10, &[980, 990]),
    (11, &[500, 510]),
    (12, &[660, 661, 670]),
    (13, &[960, 970]),
    (14, &[540, 541, 550, 560, 570, 580, 590]),
    (15, &[610, 620, 630, 640]),
    (16, &[680, 682, 690]),
    (17, &[150, 160]),
    (18, &[401, 411, 421]),
    (22, &[501, 511]),
];

/// G codes and other words in force, as the system variables #4001 to #4130 show them.
#[derive(Clone, Debug)]
pub struct Codes {
    groups: [i64; 23],
    /// B, D, E, F, H, M, N, O, S, T, P.
    words: [Option<f64>; 11],
}

/// Kind of a block, as far as the interpreter of macros must know it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BlockKind {
    /// The block moves an axis.
    pub moves: bool,
    /// The block is a dwell (G4).
    pub dwells: bool,
    /// The block ends the program (M2, M30).
    pub ends: bool,
}

/// Codes whose axis words are not moves: dwell, data, zones, coordinate systems.
const NO_MOVES: [i64; 8] = [40, 100, 110, 220, 510, 520, 680, 920];

/// Letters whose last value can be read, with the offset of their variable from 4100.
const WORDS: [(u8, u32); 11] = [
    (b'B', 2),
    (b'D', 7),
    (b'E', 8),
    (b'F', 9),
    (b'H', 11),
    (b'M', 13),
    (b'N', 14),
    (b'O', 15),
    (b'S', 19),
    (b'T', 20),
    (b'P', 30),
];

impl Codes {
    /// State at power-on.
    pub fn new(unit: LengthUnit) -> Self {
        let mut codes = Codes { groups: [0; 23], words: [None; 11] };
        for tenths in [0, 170, 900, 220, 940, 400, 490, 800, 980, 500, 670, 970, 540, 640, 690, 150, 401, 501] {
            codes.apply_g(tenths);
        }
        codes.apply_g(if unit == LengthUnit::Inch { 200 } else { 210 });
        codes
    }

    fn apply_g(&mut self, tenths: i64) {
        let group = GROUPS.iter().find(|(_, codes)| codes.contains(&tenths));
        if let Some(place) = group.and_then(|(group, _)| self.groups.get_mut(*group)) {
            *place = tenths;
        }
    }

    /// Applies the words of an executed block, which has only plain numbers.
    pub fn apply_block(&mut self, mut cursor: CodeCursor<'_>) -> BlockKind {
        let (mut kind, mut is_no_move) = (BlockKind::default(), false);
        while let Some(letter) = cursor.peek() {
            cursor.skip(1);
            if !letter.is_ascii_uppercase() {
                continue;
            }
            let Ok(number) = cursor.number() else { continue };
            match (letter, number.as_tenths()) {
                (b'G', Some(tenths)) => {
                    self.apply_g(tenths);
                    kind.dwells |= tenths == 40;
                    is_no_move |= NO_MOVES.contains(&tenths);
                }
                (b'M', Some(20 | 300)) => kind.ends = true,
                (b'A'..=b'C' | b'I'..=b'K' | b'X'..=b'Z', _) => kind.moves = true,
                _ => {}
            }
            let place = WORDS.iter().position(|(word, _)| *word == letter);
            if let Some(word) = place.and_then(|place| self.words.get_mut(place)) {
                *word = Some(number.to_f64());
            }
        }
        kind.moves &= !is_no_move;
        kind
    }

    /// Value of a system variable from #4001 to #4130: the G code of a group, or the last value of a letter, vacant if
    /// there was none. The outer `None` means that no such variable exists.
    pub fn value(&self, variable: u32) -> Option<Option<f64>> {
        let number = variable.checked_sub(4_000)?;
        if let Some(letter) = number.checked_sub(100) {
            let place = WORDS.iter().position(|(_, word)| *word == letter)?;
            return self.words.get(place).copied();
        }
        let group = usize::try_from(number).ok()?;
        let is_group = matches!(group, 1..=18 | 22);
        self.groups.get(group).filter(|_| is_group).map(|tenths| Some(*tenths as f64 / 10.0))
    }
}

#[cfg(test)]
mod tests {
    use super::super::code::MacroCode;
    use super::*;

    #[test]
    fn the_last_code_of_a_group_counts() {
        let mut codes = Codes::new(LengthUnit::Mm);
        codes.apply_block(MacroCode::new(b"N7G91G2X1.I5.F25.M8").cursor());
        codes.apply_block(MacroCode::new(b"G43.4H3T12").cursor());
        let values = [4001, 4002, 4003, 4006, 4008, 4109, 4111, 4114, 4120].map(|number| codes.value(number).unwrap());
        assert_eq!(values, [2.0, 17.0, 91.0, 21.0, 43.4, 25.0, 3.0, 7.0, 12.0].map(Some));
        assert_eq!((codes.value(4119), codes.value(4200), codes.value(4000)), (Some(None), None, None));
    }
}
