//! Bytes of a program to lines, every byte kept.
//!
//! In ISO code LF ends a block; CR beside it means nothing. Files carry LF, CR LF, or, as punched by a control, LF CR CR.
//! A file without a single LF is in the other code's manner: there CR ends a block.

/// A line's text, and the bytes that end it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawLine<'a> {
    /// What stands in it.
    pub text: &'a [u8],
    /// LF, CR LF, LF CR CR, CR, or nothing at the end of the file.
    pub ending: &'a [u8],
}

/// The lines of a program.
#[derive(Clone, Debug)]
pub struct Lines<'a> {
    rest: &'a [u8],
    end: u8,
}

impl<'a> Lines<'a> {
    /// Of a whole program.
    pub fn new(bytes: &'a [u8]) -> Self {
        let end = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
        Lines { rest: bytes, end }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = RawLine<'a>;

    fn next(&mut self) -> Option<RawLine<'a>> {
        if self.rest.is_empty() {
            return None;
        }
        let end = find(self.rest, self.end);
        let (line, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
        let is_return = |byte: &&u8| **byte == b'\r';
        let before = line.iter().rev().take_while(is_return).count();
        let after = end.map_or(0, |_| 1 + rest.iter().skip(1).take_while(is_return).count());
        let (taken, rest) = self.rest.split_at(line.len() + after);
        self.rest = rest;
        let (text, ending) = taken.split_at(line.len() - before);
        Some(RawLine { text, ending })
    }
}

/// Where a byte first stands.
fn find(bytes: &[u8], wanted: u8) -> Option<usize> {
    const ONES: u64 = u64::from_le_bytes([1; 8]);
    let (words, rest) = bytes.as_chunks::<8>();
    for (index, word) in words.iter().enumerate() {
        // Zero where the byte stands; the subtraction borrows into the sign of the first such byte and of none before it.
        let differing = u64::from_le_bytes(*word) ^ ONES * u64::from(wanted);
        let found = differing.wrapping_sub(ONES) & !differing & ONES << 7;
        if found != 0 {
            return Some(8 * index + found.trailing_zeros() as usize / 8);
        }
    }
    let at = rest.iter().position(|byte| *byte == wanted)?;
    Some(8 * words.len() + at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(bytes: &str) -> Vec<String> {
        Lines::new(bytes.as_bytes()).map(|line| String::from_utf8_lossy(line.text).into_owned()).collect()
    }

    #[test]
    fn every_kind_of_line_end_ends_one_line() {
        for end in ["\n", "\r\n", "\n\r\r", "\r"] {
            let bytes = ["%", "G1X1.", "", "M30", ""].join(end);
            let lines = texts(&bytes);
            let wanted: &[&str] = if end == "\r" { &["%", "G1X1.", "M30"] } else { &["%", "G1X1.", "", "M30"] };
            assert_eq!(lines, wanted, "{end:?}");
        }
        assert_eq!(texts("G0\nG1"), ["G0", "G1"]);
        assert!(texts("").is_empty());
    }

    #[test]
    fn texts_and_endings_are_the_file() {
        for bytes in ["a\r\nb\n\r\rc\n\n", "\n\r", "\r\r\n", "a\rb\r\rc", "x"] {
            let mut joined = Vec::new();
            for line in Lines::new(bytes.as_bytes()) {
                joined.extend_from_slice(line.text);
                joined.extend_from_slice(line.ending);
            }
            assert_eq!(joined, bytes.as_bytes());
        }
    }

    #[test]
    fn a_byte_is_found_where_it_first_stands() {
        for len in 0..40 {
            for at in 0..=len {
                let mut bytes = [0x0b, 0x09, 0x8a, 0xff, 0].repeat(8);
                bytes.truncate(len);
                bytes.iter_mut().skip(at).step_by(3).for_each(|byte| *byte = b'\n');
                assert_eq!(find(&bytes, b'\n'), (at < len).then_some(at), "{bytes:?}");
            }
        }
    }
}
