//! Lines of a program, read again one by one.

use arcfeed_nc::block::{Parsed, Reading, parse_line};
use arcfeed_nc::reader::InterpretedLine;
use arcfeed_nc::text::{Lines, RawLine};
use memchr::memchr;

use super::lines::LineReader;
use super::{Diagnostic, Program, ProgramLine};

/// Lines of a program, each with its meaning.
pub struct ProgramLines<'a> {
    rest: Lines<'a>,
    order: ReadingOrder,
}

enum ReadingOrder {
    /// One after the other, as a control reads a program without macro statements.
    Sequential(Box<LineReader>, Vec<Diagnostic>),
    /// Each by itself: up to so many lines, those without code have a meaning.
    Alone(Reading, usize),
}

impl Program {
    /// Lines of the program, in order. For an interpreted program only lines without code have a meaning.
    pub fn lines(&self) -> ProgramLines<'_> {
        let settings = *self.control.settings();
        let order = match self.lines_alone {
            Some(count) => ReadingOrder::Alone(settings.reading, count),
            None => {
                let reader = LineReader::new(settings, *self.control.tables());
                let reader = reader.with_slashes(memchr(b'/', &self.bytes).is_some());
                ReadingOrder::Sequential(Box::new(reader), Vec::new())
            }
        };
        ProgramLines { rest: Lines::new(&self.bytes), order }
    }
}

impl Iterator for ProgramLines<'_> {
    type Item = ProgramLine;

    fn next(&mut self) -> Option<ProgramLine> {
        let raw = self.rest.next()?;
        let mut line = ProgramLine::default();
        match &mut self.order {
            ReadingOrder::Sequential(reader, found) => {
                reader.read_into(raw, &mut line, found);
                found.clear();
            }
            ReadingOrder::Alone(reading, left) => {
                let RawLine { text, ending } = raw;
                (line.text, line.ending) = (text.to_vec(), ending.to_vec());
                let parsed = parse_line(text, *reading).ok().filter(|_| *left > 0);
                line.meaning = parsed.filter(|parsed| parsed.block.is_empty()).map(without_code);
                *left = left.saturating_sub(1);
            }
        }
        Some(line)
    }
}

fn without_code(parsed: Parsed) -> InterpretedLine {
    InterpretedLine { parsed, ..InterpretedLine::default() }
}
