//! Fast test for plain lines, which most lines pass: numbers after single letters, comments after numbers, and none of G6,
//! M9 and M1, with which the codes of calls begin, with any blanks and zeros between.
//!
//! A table has the next state for each state and kind of byte, so that a byte costs two loads.

/// State at the begin of a word.
const OUTSIDE: u8 = 0x00;
/// Letter whose number is still missing: any but G and M, G, M.
const LETTER: u8 = 0x10;
const LETTER_G: u8 = 0x20;
const LETTER_M: u8 = 0x30;
/// The same behind zeros.
const ZEROS: u8 = 0x40;
const ZEROS_G: u8 = 0x50;
const ZEROS_M: u8 = 0x60;
const COMMENT: u8 = 0x70;
/// Not plain, whatever follows.
const OTHER: u8 = 0x80;

/// Kinds of bytes.
const ZERO: u8 = 0;
const ONE: u8 = 1;
const SIX: u8 = 2;
const NINE: u8 = 3;
const DIGIT: u8 = 4;
const BLANK: u8 = 5;
const G: u8 = 6;
const M: u8 = 7;
const ADDRESS: u8 = 8;
const OPEN: u8 = 9;
const CLOSE: u8 = 10;
const MACRO: u8 = 11;
const MARK: u8 = 12;
const LINE_END: u8 = 13;

const KINDS: [u8; 256] = kinds();
const NEXT: [u8; 256] = next_states();

/// Bytes that are read before the state is looked at.
const AT_ONCE: usize = 16;

/// Whether a line certainly needs no macro interpreter: it has only words with plain numbers, and comments. False for
/// some plain lines too.
pub fn has_plain_bytes(line: &[u8]) -> bool {
    first_odd_byte(line).is_none()
}

/// Index of the byte with which the first line of a text that is not certainly plain stops being so; `None` if all lines
/// are. Lines end with LF.
pub fn first_odd_byte(text: &[u8]) -> Option<usize> {
    let (mut state, mut passed) = (OUTSIDE, 0);
    for bytes in text.as_chunks::<AT_ONCE>().0 {
        let after = bytes.iter().fold(state, next);
        if after == OTHER {
            break;
        }
        (state, passed) = (after, passed + AT_ONCE);
    }
    let is_odd = |byte| {
        state = next(state, byte);
        state == OTHER
    };
    text.iter().skip(passed).position(is_odd).map(|index| passed + index)
}

#[inline]
fn next(state: u8, byte: &u8) -> u8 {
    let kind = KINDS.get(usize::from(*byte)).copied().unwrap_or(MACRO);
    NEXT.get(usize::from(state | kind)).copied().unwrap_or(OTHER)
}

const fn kinds() -> [u8; 256] {
    let (mut kinds, mut byte) = ([MARK; 256], 0_u8);
    let mut rest = kinds.as_mut_slice();
    while let Some((kind, more)) = rest.split_first_mut() {
        *kind = kind_of(byte);
        (rest, byte) = (more, byte.wrapping_add(1));
    }
    kinds
}

const fn kind_of(byte: u8) -> u8 {
    match byte {
        b'0' => ZERO,
        b'1' => ONE,
        b'6' => SIX,
        b'9' => NINE,
        b'2'..=b'8' => DIGIT,
        b' ' | b'\t' | b'\r' => BLANK,
        b'\n' => LINE_END,
        b'G' | b'g' => G,
        b'M' | b'm' => M,
        b'A'..=b'Z' | b'a'..=b'z' => ADDRESS,
        b'(' => OPEN,
        b')' => CLOSE,
        b'#' | b'[' | b']' | b'=' => MACRO,
        _ => MARK,
    }
}

/// Next states, by state and kind in one byte.
const fn next_states() -> [u8; 256] {
    let (mut states, mut index) = ([OTHER; 256], 0_u8);
    let mut rest = states.as_mut_slice();
    while let Some((state, more)) = rest.split_first_mut() {
        *state = next_state(index & 0xF0, index & 0x0F);
        (rest, index) = (more, index.wrapping_add(1));
    }
    states
}

const fn next_state(state: u8, kind: u8) -> u8 {
    match (state, kind) {
        (OTHER.., _) => OTHER,
        (_, LINE_END) => OUTSIDE,
        (COMMENT, CLOSE) => OUTSIDE,
        (COMMENT, _) => COMMENT,
        (LETTER_G | ZEROS_G, SIX) | (LETTER_M | ZEROS_M, ONE | NINE) => OTHER,
        (_, ONE | SIX | NINE | DIGIT) => OUTSIDE,
        (LETTER, ZERO) => ZEROS,
        (LETTER_G, ZERO) => ZEROS_G,
        (LETTER_M, ZERO) => ZEROS_M,
        (_, ZERO | BLANK) => state,
        (LETTER | LETTER_G | LETTER_M, G | M | ADDRESS) => OTHER,
        (_, G) => LETTER_G,
        (_, M) => LETTER_M,
        (_, ADDRESS) => LETTER,
        (OUTSIDE, OPEN) => COMMENT,
        (_, OPEN | MACRO) => OTHER,
        _ => OUTSIDE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same rules, byte by byte: a letter whose number is missing (in lower case behind zeros), `(`, or 0.
    fn is_plain(line: &[u8]) -> bool {
        let mut before = 0;
        line.iter().all(|&byte| {
            match byte {
                _ if before == b'(' => before = if byte == b')' { 0 } else { before },
                b'1'..=b'9' => match (before, byte) {
                    (b'G' | b'g', b'6') | (b'M' | b'm', b'1' | b'9') => return false,
                    _ => before = 0,
                },
                b'0' => before = before.to_ascii_lowercase(),
                b' ' | b'\t' | b'\r' => {}
                b'A'..=b'Z' | b'a'..=b'z' if before.is_ascii_uppercase() => return false,
                b'A'..=b'Z' | b'a'..=b'z' => before = byte.to_ascii_uppercase(),
                b'(' if before != 0 => return false,
                b'(' => before = byte,
                b'#' | b'[' | b']' | b'=' => return false,
                _ => before = 0,
            }
            true
        })
    }

    #[test]
    fn the_table_has_the_rules_for_every_short_line_of_their_kinds() {
        let bytes = b"01692 GMXgx()#.-\xff";
        let mut counts = [0, 0];
        for length in 0..=5 {
            for number in 0..bytes.len().pow(length) {
                let mut rest = number;
                let line: Vec<u8> = (0..length)
                    .map(|_| {
                        let byte = bytes[rest % bytes.len()];
                        rest /= bytes.len();
                        byte
                    })
                    .collect();
                assert_eq!(has_plain_bytes(&line), is_plain(&line), "{:?}", line.escape_ascii());
                counts[usize::from(is_plain(&line))] += 1;
            }
        }
        assert!(counts[0] > 100_000 && counts[1] > 100_000, "{counts:?}");
    }
    #[test]
    fn the_first_line_that_is_not_plain_is_found_in_a_text_of_any_length() {
        let plain = "N1G2X-2.5752Y11.5549 (OPEN\r\n";
        for count in 0..7 {
            for begin in ["G", "M0", "N1X5 "] {
                let before = plain.repeat(count) + begin;
                assert_eq!(first_odd_byte((before.clone() + "#1\n" + plain).as_bytes()), Some(before.len()));
            }
        }
        assert_eq!(first_odd_byte(plain.repeat(9).as_bytes()), None);
        // The comment that stays open ends with its line.
        assert_eq!(first_odd_byte(b"(OPEN\nG65"), Some(7));
    }
}
