//! Tape codes of a control: ISO with an even-parity bit, EIA (RS-244) with odd parity, plain ASCII.
//!
//! A frame is the eight bits from the line's receiver. In ISO the eighth bit is the parity bit, in EIA the fifth; in
//! ASCII the eighth bit is ignored and nothing is checked. A frame that violates its code is a TH alarm.
//!
//! Sources: ISO 840 and EIA as in the tables of tape codes that controls print (Yasnac LX3, table 2.4: what is
//! disregarded, and the hole patterns 2-4-5 and 2-4-7 of the brackets). Fanuc B-63503EN p. 62: eight bits including parity.

/// DC1 (XON): the control asks the sender to send.
pub const DC1: u8 = 0x11;
/// DC2: the control switches the receiver of its output on.
pub const DC2: u8 = 0x12;
/// DC3 (XOFF): the control asks the sender to stop.
pub const DC3: u8 = 0x13;
/// DC4: the control switches the receiver of its output off.
pub const DC4: u8 = 0x14;

const PARITY: u8 = 0x80;
const LINE_FEED: u8 = b'\n';
const DELETE: u8 = 0x7F;
const BACKSPACE: u8 = 0x08;
const EIA_END_OF_BLOCK: u8 = 0x80;
const EIA_BACKSPACE: u8 = 0x2A;

/// Character code of a tape or a DNC line: ISO, EIA or ASCII.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TapeCode {
    /// ISO 840: seven bits and an even-parity bit.
    Iso,
    /// EIA RS-244: letters of one case, odd parity.
    Eia,
    /// ASCII: seven bits, the eighth is ignored and nothing is checked.
    Ascii,
}

/// Meaning of one received byte (a row of holes of a tape).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symbol {
    /// A character, as its ASCII code.
    Character(u8),
    /// The end of a block.
    EndOfBlock,
    /// Ignored by the control: NUL, CR, DEL and control codes in ISO, backspace and all holes in EIA.
    Ignored,
}

/// The byte is not in the tape code (wrong parity or undefined holes): alarm PS0001.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotInCode;

/// ASCII characters and their EIA frames.
const EIA: [(u8, u8); 47] = [
    (b'0', 0x20),
    (b'1', 0x01),
    (b'2', 0x02),
    (b'3', 0x13),
    (b'4', 0x04),
    (b'5', 0x15),
    (b'6', 0x16),
    (b'7', 0x07),
    (b'8', 0x08),
    (b'9', 0x19),
    (b'A', 0x61),
    (b'B', 0x62),
    (b'C', 0x73),
    (b'D', 0x64),
    (b'E', 0x75),
    (b'F', 0x76),
    (b'G', 0x67),
    (b'H', 0x68),
    (b'I', 0x79),
    (b'J', 0x51),
    (b'K', 0x52),
    (b'L', 0x43),
    (b'M', 0x54),
    (b'N', 0x45),
    (b'O', 0x46),
    (b'P', 0x57),
    (b'Q', 0x58),
    (b'R', 0x49),
    (b'S', 0x32),
    (b'T', 0x23),
    (b'U', 0x34),
    (b'V', 0x25),
    (b'W', 0x26),
    (b'X', 0x37),
    (b'Y', 0x38),
    (b'Z', 0x29),
    (b' ', 0x10),
    (b'\t', 0x3E),
    (b'%', 0x0B),
    (b'&', 0x0E),
    (b'(', 0x1A),
    (b')', 0x4A),
    (b'+', 0x70),
    (b',', 0x3B),
    (b'-', 0x40),
    (b'.', 0x6B),
    (b'/', 0x31),
];

impl TapeCode {
    /// Tape code that a program uses, from the first end of block: EIA or ISO; `None` if the byte is not an end of
    /// block.
    pub fn of_end_of_block(frame: u8) -> Option<Self> {
        match frame {
            EIA_END_OF_BLOCK => Some(TapeCode::Eia),
            _ if frame & !PARITY == LINE_FEED => Some(TapeCode::Iso),
            _ => None,
        }
    }

    /// Whether the byte ends a block. A wrong parity bit does not matter here: the block is then rejected, but not
    /// joined with the next one.
    pub fn ends_block(self, frame: u8) -> bool {
        match self {
            TapeCode::Iso | TapeCode::Ascii => frame & !PARITY == LINE_FEED,
            TapeCode::Eia => frame == EIA_END_OF_BLOCK,
        }
    }

    /// Symbol that one row of holes, a byte, stands for.
    ///
    /// # Errors
    /// Wrong parity, or an undefined combination of holes.
    pub fn decode(self, frame: u8) -> Result<Symbol, NotInCode> {
        match self {
            TapeCode::Ascii => Ok(ascii(frame & !PARITY)),
            TapeCode::Iso if frame.count_ones().is_multiple_of(2) => Ok(ascii(frame & !PARITY)),
            TapeCode::Iso => Err(NotInCode),
            TapeCode::Eia => match frame {
                EIA_END_OF_BLOCK => Ok(Symbol::EndOfBlock),
                EIA_BACKSPACE | DELETE => Ok(Symbol::Ignored),
                _ => {
                    let found = EIA.iter().find(|(_, eia)| *eia == frame);
                    found.map(|(byte, _)| Symbol::Character(*byte)).ok_or(NotInCode)
                }
            },
        }
    }

    /// The byte for an ASCII character, with parity (a line feed stands for the end of a block); `None` if the tape
    /// code does not have the character.
    pub fn encode(self, byte: u8) -> Option<u8> {
        match (self, byte) {
            (TapeCode::Ascii, _) => Some(byte & !PARITY),
            (TapeCode::Iso, _) => Some(with_even_parity(byte)),
            (TapeCode::Eia, LINE_FEED) => Some(EIA_END_OF_BLOCK),
            (TapeCode::Eia, _) => {
                EIA.iter().find(|(ascii, _)| *ascii == byte.to_ascii_uppercase()).map(|(_, eia)| *eia)
            }
        }
    }
}

/// The seven low bits of the byte, with the parity bit that makes the number of ones even.
pub const fn with_even_parity(byte: u8) -> u8 {
    let low = byte & !PARITY;
    if low.count_ones().is_multiple_of(2) { low } else { low | PARITY }
}

/// The byte with its eighth bit cleared.
pub const fn without_parity(frame: u8) -> u8 {
    frame & !PARITY
}

fn ascii(byte: u8) -> Symbol {
    match byte {
        LINE_FEED => Symbol::EndOfBlock,
        0 | BACKSPACE | b'\r' | DC1..=DC4 | DELETE => Symbol::Ignored,
        _ => Symbol::Character(byte),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Character, EIA and ISO in hexadecimal, as a published table prints them ("EIA-ASCII-ISO encoding" of
    /// wiki.bastelbude.grade.de, after appendix F of the GrecoSystems CNC Minifile manual).
    const PRINTED: &str = "0 20 30, 1 01 B1, 2 02 B2, 3 13 33, 4 04 B4, 5 15 35, 6 16 36, 7 07 B7, 8 08 B8, 9 19 39, \
        A 61 41, B 62 42, C 73 C3, D 64 44, E 75 C5, F 76 C6, G 67 47, & 0E A6, ( 1A 28, ) 4A A9, + 70 2B, - 40 2D, \
        . 6B 2E, / 31 AF";

    #[test]
    fn the_codes_are_those_of_a_printed_table() {
        let hex = |text: &str| u8::from_str_radix(text, 16).unwrap();
        let mut rows = 0;
        for row in PRINTED.split(", ") {
            let [byte, eia, iso] = <[&str; 3]>::try_from(row.split(' ').collect::<Vec<_>>()).unwrap();
            let byte = byte.as_bytes()[0];
            assert_eq!(
                (TapeCode::Eia.encode(byte), TapeCode::Iso.encode(byte)),
                (Some(hex(eia)), Some(hex(iso))),
                "{row}"
            );
            assert_eq!(TapeCode::Eia.decode(hex(eia)), Ok(Symbol::Character(byte)), "{row}");
            assert_eq!(TapeCode::Iso.decode(hex(iso)), Ok(Symbol::Character(byte)), "{row}");
            rows += 1;
        }
        assert_eq!(rows, 24);
    }

    #[test]
    fn every_code_of_eia_is_odd_and_there_is_one_for_each_character() {
        for (index, (byte, eia)) in EIA.iter().enumerate() {
            assert!(!eia.count_ones().is_multiple_of(2), "{}", char::from(*byte));
            assert!(EIA[..index].iter().all(|(other, code)| other != byte && code != eia));
        }
        // Digits and letters count in the four lowest holes, as punched: 1 to 9 again in A to I, J to R and (2 to 9) S to Z.
        let low = |byte| TapeCode::Eia.encode(byte).unwrap() & 0x0F;
        for (first, from) in [(b'1', 1), (b'A', 1), (b'J', 1), (b'S', 2)] {
            for count in 0..=9 - from {
                assert_eq!(low(first + count), from + count, "{}", char::from(first + count));
            }
        }
    }

    #[test]
    fn one_wrong_hole_is_always_found() {
        for code in [TapeCode::Iso, TapeCode::Eia] {
            for byte in b"%O1234(DRILL)N10G1X-1.5Y+2,3/\n" {
                let frame = code.encode(*byte).unwrap();
                for hole in 0..8 {
                    let decoded = code.decode(frame ^ (1 << hole));
                    // In EIA all holes but one parity hole are a delete, which no character is one hole away from.
                    assert_eq!(decoded, Err(NotInCode), "{code:?} {} hole {hole}", char::from(*byte));
                }
            }
        }
    }

    #[test]
    fn dc3_has_a_parity_bit_in_iso() {
        assert_eq!([DC1, DC2, DC3, DC4].map(with_even_parity), [0x11, 0x12, 0x93, 0x14]);
    }

    #[test]
    fn cr_nul_and_del_mean_nothing_in_iso() {
        for byte in [0, b'\r', DELETE] {
            assert_eq!(TapeCode::Iso.decode(with_even_parity(byte)), Ok(Symbol::Ignored));
        }
        assert_eq!(TapeCode::Eia.decode(0), Err(NotInCode));
    }
}
