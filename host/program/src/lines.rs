//! Reads a program line by line, as a control does: only the control's state is kept after a line.

use arcfeed_nc::block::{LineKind, Parsed, Reading, is_title};
use arcfeed_nc::reader::{InterpretedLine, Reader};
use arcfeed_nc::settings::{Settings, Tables};
use arcfeed_nc::text::{Lines, RawLine};
use arcfeed_nc::word::is_mark;

use super::advice::is_flow_word;
use super::block_delete::BlockDeleteReader;
use super::diagnostic::{START_UNKNOWN, is_blank};
use super::{Diagnostic, ProgramLine};

/// Reader of a program, line by line, with the state of the control.
pub struct LineReader {
    reader: Reader,
    reading: Reading,
    skipping: BlockDeleteReader,
    has_slashes: bool,
    count: usize,
    has_begun: bool,
    has_ended: bool,
    /// Lines after the closing `%` have been reported.
    has_trailer: bool,
}

/// Text of a program with capital letters in its code, as it is sent to a control; comments stay.
pub fn in_capitals(program: &[u8]) -> Vec<u8> {
    let mut capitals = Vec::with_capacity(program.len());
    for RawLine { text, ending } in Lines::new(program) {
        let mut in_comment = is_title(text) || is_mark(text);
        capitals.extend(text.iter().map(|&byte| {
            in_comment = (in_comment || byte == b'(') && byte != b')';
            if in_comment { byte } else { byte.to_ascii_uppercase() }
        }));
        capitals.extend_from_slice(ending);
    }
    capitals
}

/// Number of lines up to the closing `%`: what follows them is not read.
pub(super) fn lines_read(program: &[u8]) -> usize {
    let mut has_begun = false;
    for (index, RawLine { text, .. }) in Lines::new(program).enumerate() {
        if has_begun && is_mark(text) {
            return index + 1;
        }
        has_begun |= !is_blank(text);
    }
    usize::MAX
}

impl LineReader {
    /// A control with these settings, before the first line.
    pub fn new(settings: Settings, tables: Tables) -> Self {
        LineReader {
            reader: Reader::with(settings, tables).at_unknown_position(),
            reading: settings.reading,
            skipping: BlockDeleteReader::default(),
            has_slashes: true,
            count: 0,
            has_begun: false,
            has_ended: false,
            has_trailer: false,
        }
    }

    /// The same control for a program that has, or has not, a `/` anywhere.
    #[must_use]
    pub fn with_slashes(self, has_slashes: bool) -> Self {
        LineReader { has_slashes, ..self }
    }

    /// State of the control after the last line read.
    pub fn control(&self) -> &Reader {
        &self.reader
    }

    /// Reads the next line into `line`, whose memory is reused, and adds its faults to `found`.
    pub fn read_into(
        &mut self,
        RawLine { text, ending }: RawLine<'_>,
        line: &mut ProgramLine,
        found: &mut Vec<Diagnostic>,
    ) {
        self.count += 1;
        line.text.clear();
        line.text.extend_from_slice(text);
        line.ending.clear();
        line.ending.extend_from_slice(ending);
        if self.has_ended {
            return self.pass_over(line, found);
        }
        let had_begun = self.has_begun;
        self.has_begun |= !is_blank(text);
        if is_flow_word(text) {
            found.push(Diagnostic::of_flow_word(self.count, text));
            (line.meaning, line.skipping) = (None, None);
            return line.set_state(&self.reader);
        }
        if self.has_slashes {
            self.skipping.fork(text, &self.reader);
        }
        let understood = line.meaning.get_or_insert_default();
        let has_mark = match self.reader.read_into(text, understood) {
            Ok(()) => {
                self.note(text, understood, found);
                understood.parsed.line == LineKind::ProgramMark
            }
            Err(fault) => {
                found.push(Diagnostic::of_fault(self.count, text, fault));
                line.meaning = None;
                is_mark(text)
            }
        };
        self.has_ended = had_begun && has_mark;
        line.set_state(&self.reader);
        line.skipping = self.skipping.read(text, line, &self.reader);
    }

    /// Keeps a line after the closing `%`, which no control reads.
    fn pass_over(&mut self, line: &mut ProgramLine, found: &mut Vec<Diagnostic>) {
        let text = std::mem::take(&mut line.text);
        if !self.has_trailer && !is_blank(&text) && !is_mark(&text) {
            self.has_trailer = true;
            found.push(Diagnostic::of_text_behind_the_end(self.count, &text));
        }
        let parsed = Parsed { line: LineKind::ProgramMark, ..Parsed::default() };
        let (ending, meaning) =
            (std::mem::take(&mut line.ending), Some(InterpretedLine { parsed, ..InterpretedLine::default() }));
        *line = ProgramLine { text, ending, meaning, ..ProgramLine::default() };
    }

    fn note(&self, text: &[u8], understood: &InterpretedLine, found: &mut Vec<Diagnostic>) {
        let line = self.count;
        for notice in &understood.parsed.notices {
            found.push(Diagnostic::of_notice(line, text, *notice));
        }
        if understood.starts_unknown && understood.segment.is_none() {
            found.push(Diagnostic::of_line(line, text, START_UNKNOWN));
        }
        if understood.lacks_feed() {
            found.push(Diagnostic::of_missing_feed(line, text, self.reading));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_code_becomes_capital() {
        let program = b"%leader\r\noTitle\r\no1 (Part)g1x1.f5 (a\r\nm30";
        assert_eq!(in_capitals(program), b"%leader\r\noTitle\r\nO1 (Part)G1X1.F5 (a\r\nM30");
    }
}
