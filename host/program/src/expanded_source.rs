//! Expansion of a program into its executed blocks, which are a program without macro statements and calls.
//!
//! The blocks follow from program, library and settings alone: whatever else a control could know is refused. Lines keep
//! their end, N words and the comments of plain blocks; only the main program keeps its number.

use std::path::Path;
use std::sync::Arc;

use arcfeed_nc::block::LineKind;
use arcfeed_nc::reader::InterpretedLine;
use arcfeed_nc::settings::{Settings, Tables};
use arcfeed_nc::text::Lines;
use arcfeed_nc_macro::interpreter::Interpreter;
use arcfeed_nc_macro::stack::SourceLine;
use arcfeed_nc_macro::step::PlainBlock;
use arcfeed_nc_macro::variables::OutsideValues;

use super::expansion::ExecutedStep;
use super::source::{LINES_MAX, Source};
use super::{Diagnostic, ExecutedPlaces, Expansion, Program, RunBounds, Severity};

impl Source {
    /// The blocks of this program as executed, without macro statements and calls; a program without those is
    /// returned as it is.
    ///
    /// # Errors
    /// Faults of the run; a value from outside the program; more than [`LINES_MAX`] blocks.
    pub fn expanded(self, library: Option<&Path>, bounds: RunBounds) -> Result<Self, Vec<Diagnostic>> {
        let Some(macro_line) = self.macro_line else { return Ok(self) };
        let outside = OutsideValues::Refused { offsets_known: self.tables != Tables::default() };
        let (settings, tables) = (self.settings, self.tables);
        let expansion = Expansion { settings, tables, library, keeps_moves: false, bounds, outside };
        let mut text = ExpandedText::new(&self);
        let end = expansion.run(&self.bytes, |step, interpreter| text.add(&step, interpreter));
        let mut found = end.found;
        found.retain(|found| found.severity == Severity::Error);
        if found.is_empty() && text.blocks > LINES_MAX {
            let line = Lines::new(&self.bytes).nth(macro_line - 1).map(|line| line.text).unwrap_or_default();
            let message = format!(
                "{} blocks as executed, and at most {LINES_MAX} of a program with macro statements or calls are kept in \
                 memory (docs/dialect.md#long-programs); split the program between two operations",
                text.blocks
            );
            found.push(Diagnostic { severity: Severity::Error, ..Diagnostic::of_line(macro_line, line, &message) });
        }
        if !found.is_empty() {
            return Err(found);
        }
        let (bytes, mut places) = text.end();
        (places.file, places.library) = (self.bytes, library.map(Path::to_owned));
        Ok(Source { bytes, macro_line: None, places: Some(Arc::new(places)), ..self })
    }
}

impl Program {
    /// Reads the blocks of a program as executed on a control with these settings. If the program cannot be executed,
    /// the result is the program as it stands, with the faults of its run.
    pub fn executed(path: &Path, bytes: &[u8], (settings, tables): (Settings, Tables), library: Option<&Path>) -> Self {
        let parsed = Program::parse_with(path, bytes, settings, tables);
        let Some(_) = parsed.macro_line else { return parsed };
        let (path, bytes) = (path.to_owned(), bytes.to_vec());
        let source = Source { path, bytes, settings, tables, macro_line: parsed.macro_line, places: None };
        match source.expanded(library, RunBounds::default()) {
            Ok(source) => source.program(),
            Err(diagnostics) => Program { diagnostics, ..parsed },
        }
    }
}

/// Text of the blocks so far.
struct ExpandedText {
    bytes: Vec<u8>,
    places: ExecutedPlaces,
    line_end: Vec<u8>,
    has_marks: bool,
    /// First comment, until it is written.
    comment: Option<Vec<u8>>,
    blocks: usize,
}

impl ExpandedText {
    fn new(source: &Source) -> Self {
        let first = Lines::new(&source.bytes).next();
        let line_end = first.map(|line| line.ending).filter(|end| !end.is_empty()).unwrap_or(b"\n").to_vec();
        let mut lines = Lines::new(&source.bytes).map(|line| line.text.trim_ascii_start());
        let has_marks = lines.find(|text| !text.is_empty()).is_some_and(|text| text.starts_with(b"%"));
        let name = source.path.file_name().unwrap_or_default().to_string_lossy().to_ascii_uppercase();
        let is_carried = |letter: char| letter.is_ascii_alphanumeric() || ".-".contains(letter);
        let name: String = name.chars().map(|letter| if is_carried(letter) { letter } else { '-' }).collect();
        let comment = Some(format!("(EXPANDED FROM {name})").into_bytes());
        let places = ExecutedPlaces::default();
        let mut text = ExpandedText { bytes: Vec::new(), places, line_end, has_marks, comment, blocks: 0 };
        if has_marks {
            text.own_line(b"%");
        }
        text
    }

    /// The text and the places of its lines.
    fn end(mut self) -> (Vec<u8>, ExecutedPlaces) {
        if self.has_marks {
            self.own_line(b"%");
        }
        (self.bytes, self.places)
    }

    fn add(&mut self, step: &ExecutedStep<'_>, interpreter: &Interpreter) {
        match step {
            ExecutedStep::Block(block, understood, _) => self.add_block(block, *understood),
            ExecutedStep::Message(message) => {
                let (place, calls) = interpreter.place();
                self.add_comment();
                self.add_line((place, &calls, &[]), &[b"M0(", *message, b")"].concat());
            }
            ExecutedStep::Output => self.places.outputs += 1,
            ExecutedStep::Ignored(ignored) => {
                let place = self.places.ignores_feed.unwrap_or(interpreter.place().0);
                self.places.ignores_feed = (ignored.feed > 0 || self.places.ignores_feed.is_some()).then_some(place);
            }
        }
    }

    fn add_block(&mut self, block: &PlainBlock, understood: Option<&InterpretedLine>) {
        let Some(understood) = understood else { return };
        let (parsed, is_called) = (&understood.parsed, block.place.library.is_some() || !block.calls.is_empty());
        let has_number = parsed.block.program.is_some() || parsed.line == LineKind::Title;
        let text = if has_number && is_called { without_number(&block.text, parsed.line) } else { block.text.clone() };
        if text.trim_ascii().is_empty() {
            return;
        }
        // The program's number comes first.
        if !has_number {
            self.add_comment();
        }
        self.add_line((block.place, &block.calls, block.columns()), &text);
    }

    fn add_line(&mut self, (place, calls, columns): (SourceLine, &[SourceLine], &[u16]), text: &[u8]) {
        self.blocks += 1;
        if self.blocks <= LINES_MAX {
            self.places.add(place, calls, columns);
            self.write(text);
        }
    }

    fn add_comment(&mut self) {
        if let Some(comment) = self.comment.take() {
            self.own_line(&comment);
        }
    }

    fn own_line(&mut self, text: &[u8]) {
        self.places.add_own();
        self.write(text);
    }

    fn write(&mut self, text: &[u8]) {
        self.bytes.extend_from_slice(text);
        self.bytes.extend_from_slice(&self.line_end);
    }
}

/// Text of a block without its O word; nothing of a title.
fn without_number(text: &[u8], kind: LineKind) -> Vec<u8> {
    let Some(at) = text.iter().position(|byte| matches!(byte, b'O' | b':')).filter(|_| kind == LineKind::Block) else {
        return Vec::new();
    };
    let number = text[at + 1..].iter().take_while(|byte| byte.is_ascii_digit() || matches!(byte, b' ' | b'\t')).count();
    [&text[..at], &text[at + 1 + number..]].concat()
}
