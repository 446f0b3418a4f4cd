//! Division of a program's bytes into lines; every byte is kept.
//!
//! In ISO code LF ends a block and CR is ignored. Files have LF, CR LF or, as punched by a control, LF CR CR. In a
//! file without any LF, CR ends a block.

use memchr::memchr;

/// One line of a program: its text, and the bytes that end it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawLine<'a> {
    /// Text without the line end.
    pub text: &'a [u8],
    /// The bytes that end the line: LF, CR LF, LF CR CR or CR; empty at the end of the file.
    pub ending: &'a [u8],
}

/// Iterator over the lines of a program.
#[derive(Clone, Debug)]
pub struct Lines<'a> {
    rest: &'a [u8],
    end: u8,
}

impl<'a> Lines<'a> {
    /// Lines of a whole program.
    pub fn new(bytes: &'a [u8]) -> Self {
        let end = if memchr(b'\n', bytes).is_some() { b'\n' } else { b'\r' };
        Lines { rest: bytes, end }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = RawLine<'a>;

    fn next(&mut self) -> Option<RawLine<'a>> {
        if self.rest.is_empty() {
            return None;
        }
        let end = memchr(self.end, self.rest);
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
}
