//! Feeds written back into a program with macro statements or calls: one F word that fits all executions of a line, or the pieces into
//! which its move is divided.
//!
//! A program is adapted at its blocks as executed. A line gets an F word if one of its executions needs one and all of
//! them cut with the same feed. A move in pieces is written as these if its line has no values of variables and all its
//! executions have the same pieces. A line for which that is impossible is refused by name. At the end the changed program is
//! interpreted again: each of its blocks must be that of the adapted blocks, with the same feed, whether the block-delete
//! switches are on or off.

use std::collections::BTreeMap;

use arcfeed_nc::modal::Feed;
use arcfeed_nc::reader::{InterpretedLine, Reader};
use arcfeed_nc::text::Lines;
use arcfeed_nc_macro::program::first_macro;
use arcfeed_nc_macro::stack::SourceLine;
use arcfeed_units::LengthUnit;

use super::Adapted;
use super::feed_place::put_feed;
use super::rewrite::{apply, feed_word};
use crate::program::{ExecutedPlaces, RunBounds, Source};

/// Most refused lines in a message.
const REFUSED_MAX: usize = 20;
const REMEDY: &str = "use --expand, which writes each execution as a block of its own";

/// An execution of a line.
#[derive(Clone, Copy, Debug)]
struct Execution {
    /// Line of the expanded program, counted from 1.
    line: usize,
    /// Number among the executions of its line, from 1.
    count: usize,
    feed: Option<Feed>,
    unit: LengthUnit,
}

/// Executions of a line of the source.
#[derive(Debug)]
struct Executions {
    first: Execution,
    /// The first one with another feed than the first.
    other: Option<Execution>,
    count: usize,
    /// F word that an execution needs; meaningless for several blocks.
    word: Option<String>,
    /// Text of the first execution as sent.
    sent: Vec<u8>,
    /// An execution is several blocks.
    has_pieces: bool,
    /// Another execution has another text than the first.
    differs: bool,
    /// All executions have the text of the line: no values of variables.
    is_literal: bool,
}

/// A program with macro statements, with the adapted feeds written into its text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrittenProgram {
    /// Text of the whole file.
    pub text: Vec<u8>,
    /// Offset in `text` at which the replacement of each original line ends.
    pub line_ends: Vec<usize>,
}

/// Writes the feeds of the adapted blocks into the program's own text. `source` are the blocks as executed; `text` is
/// their adapted text, with the end of each line.
///
/// # Errors
/// Lines that cannot get one feed for all executions, or a changed program that would not execute the same blocks: a text with the place
/// of each.
pub fn write_back(source: &Source, text: &[u8], line_ends: &[usize]) -> Result<WrittenProgram, String> {
    let sent = line_ends.iter().scan(0, |start, end| {
        let line = &text[std::mem::replace(start, *end)..*end];
        let len = line.iter().rposition(|byte| !b"\r\n".contains(byte)).map_or(0, |last| last + 1);
        Some(&line[..len])
    });
    let path = source.path.display().to_string();
    let Some(places) = &source.places else { return Err(format!("{path}: has no macro statements or calls")) };
    let lines = executions(source, places, sent.clone());
    let refused: Vec<String> =
        lines.iter().filter_map(|(place, line)| refusal(&path, places, *place, line)).take(REFUSED_MAX).collect();
    if !refused.is_empty() {
        return Err(refused.join("\n"));
    }
    let mut written = WrittenProgram { text: Vec::with_capacity(places.file.len()), line_ends: Vec::new() };
    for (number, line) in (1..).zip(Lines::new(&places.file)) {
        match lines.get(&SourceLine { library: None, line: number }) {
            Some(Executions { sent, has_pieces: true, .. }) => written.text.extend(sent),
            found => {
                let word = found.and_then(|line| line.word.as_ref());
                let edit = word.map(|word| put_feed(line.text, word));
                written.text.extend(apply(line.text, edit.as_slice()));
            }
        }
        written.text.extend(line.ending);
        written.line_ends.push(written.text.len());
    }
    compare(source, places, &written, sent)?;
    Ok(written)
}

impl From<&Adapted> for WrittenProgram {
    /// The adapted blocks themselves.
    fn from(adapted: &Adapted) -> Self {
        WrittenProgram { text: adapted.text.clone(), line_ends: adapted.line_ends.clone() }
    }
}

impl WrittenProgram {
    /// New text of each line of the original file, with its line end.
    pub fn lines(&self) -> impl Iterator<Item = &[u8]> {
        let begins = std::iter::once(0).chain(self.line_ends.iter().copied());
        begins.zip(&self.line_ends).map(|(begin, end)| &self.text[begin..*end])
    }

    /// Line of the original file, counted from 1, of each line of the text.
    fn origins(&self) -> Vec<usize> {
        let pieces = self.lines().map(|line| Lines::new(line).count());
        (1..).zip(pieces).flat_map(|(line, count)| std::iter::repeat_n(line, count)).collect()
    }
}

/// Executions of each line of the source.
fn executions<'a>(
    source: &Source,
    places: &ExecutedPlaces,
    sent: impl Iterator<Item = &'a [u8]>,
) -> BTreeMap<SourceLine, Executions> {
    let mut reader = source.reader().control().clone();
    let in_file: Vec<&[u8]> = Lines::new(&places.file).map(|line| line.text).collect();
    let mut lines: BTreeMap<SourceLine, Executions> = BTreeMap::new();
    for ((index, before), sent) in Lines::new(&source.bytes).enumerate().zip(sent) {
        let read = meaning(&mut reader, sent);
        let Some(place) = places.place(index + 1) else { continue };
        let feed = read.as_ref().and_then(|read| read.step.cutting_feed());
        let execution = Execution { line: index + 1, count: 1, feed, unit: reader.modal().unit };
        let line = lines.entry(place).or_insert_with(|| Executions::new(execution, sent));
        line.count += 1;
        line.has_pieces |= sent.contains(&b'\n');
        line.differs |= line.sent != sent;
        line.is_literal &= in_file.get(place.line as usize - 1).is_some_and(|text| *text == before.text);
        if line.other.is_none() && line.first.feed != feed {
            line.other = Some(Execution { count: line.count, ..execution });
        }
        if before.text != sent && line.word.is_none() {
            let word = read.as_ref().and_then(|read| read.parsed.block.word(b'F'));
            let word = word.map(|word| &sent[usize::from(word.column) - 1..][..usize::from(word.len)]);
            line.word = Some(String::from_utf8_lossy(word.unwrap_or_default()).into_owned());
        }
    }
    lines
}

impl Executions {
    fn new(first: Execution, sent: &[u8]) -> Self {
        let sent = sent.to_vec();
        Executions {
            first,
            other: None,
            count: 0,
            word: None,
            sent,
            has_pieces: false,
            differs: false,
            is_literal: true,
        }
    }
}

/// Meaning of a line as sent; of a move in pieces that of the last one.
fn meaning(reader: &mut Reader, sent: &[u8]) -> Option<InterpretedLine> {
    // The adapted blocks have no errors.
    sent.split(|byte| *byte == b'\n').filter_map(|line| reader.read(line).ok()).last()
}

/// Reason for which a line cannot get the feed that it needs.
fn refusal(path: &str, places: &ExecutedPlaces, place: SourceLine, line: &Executions) -> Option<String> {
    let word = line.word.as_ref()?;
    let in_file = places.line_in_file(line.first.line);
    let text = Lines::new(&places.file).nth(in_file - 1).map(|line| line.text).unwrap_or_default();
    let column = if place.library.is_some() { 1 } else { put_feed(text, word).at + 1 };
    let said = if place.library.is_some() {
        let (name, calls) = (places.name(line.first.line), places.called_from(line.first.line));
        format!("{name} needs {word}{calls}, and a file of the library is not changed")
    } else if line.has_pieces && !line.is_literal {
        "this move is sent in pieces, and their ends cannot be written where it has values of variables".to_owned()
    } else if line.has_pieces && line.differs {
        "its executions are sent in different pieces".to_owned()
    } else {
        let words = [line.first, line.other?].map(|execution| feed_of(places, execution));
        format!("its executions need different feeds: {}, but {}", words[0], words[1])
    };
    Some(format!("{path}:{in_file}:{column}: error: {said}: {REMEDY} (found `{}`)", text.escape_ascii()))
}

fn feed_of(places: &ExecutedPlaces, execution: Execution) -> String {
    let feed = match execution.feed {
        Some(Feed::PerMinute(feed)) => feed_word(feed, execution.unit),
        Some(Feed::InverseTime(_)) => "the time of G93".to_owned(),
        Some(Feed::Missing) | None => "no feed".to_owned(),
    };
    format!("{feed} in execution {}{}", execution.count, places.called_from(execution.line))
}

/// Interprets the changed program, and compares its blocks with those as adapted.
fn compare<'a>(
    source: &Source,
    places: &ExecutedPlaces,
    written: &WrittenProgram,
    sent: impl Iterator<Item = &'a [u8]> + Clone,
) -> Result<(), String> {
    let path = source.path.display();
    let (bytes, macro_line) = (written.text.clone(), first_macro(&written.text));
    let changed = Source { bytes, macro_line, places: None, ..source.clone() };
    let again = changed.expanded(places.library.as_deref(), RunBounds::default()).map_err(|found| {
        let first = found.first().map_or(String::new(), |found| format!(": {path}:{found}"));
        format!("{path}: with the feeds written back the program stops{first}: {REMEDY}; nothing is written")
    })?;
    let differs = |line: usize| {
        let (line, place, calls) = (places.line_in_file(line), places.name(line), places.called_from(line));
        Err(format!(
            "{path}:{line}:1: error: with the feeds written back the program executes other blocks, from {place}{calls} on (a \
             macro may read F, #4109): {REMEDY}; nothing is written"
        ))
    };
    let known = again.places.as_ref().map_or(0, |places| places.len());
    let origins = written.origins();
    let origin = |place: SourceLine| match place.library {
        None => SourceLine { line: origins.get(place.line as usize - 1).map_or(0, |line| *line as u32), ..place },
        Some(_) => place,
    };
    // Pieces are blocks of their own in the changed program.
    let pieces =
        sent.enumerate().flat_map(|(index, sent)| sent.split(|byte| *byte == b'\n').map(move |of| (index, of)));
    // With the block-delete switches as they are set, and the other way.
    for is_flipped in [false, true] {
        let mut readers = [source.reader().control().clone(), source.reader().control().clone()];
        if is_flipped {
            readers.iter_mut().for_each(Reader::flip_delete_switches);
        }
        let [one, other] = &mut readers;
        for (number, ((index, sent), line)) in (1..).zip(pieces.clone().zip(Lines::new(&again.bytes))) {
            let place = again.places.as_ref().and_then(|places| places.place(number)).map(origin);
            let read = [meaning(one, sent), meaning(other, line.text)];
            let [Some(sent), Some(line)] = read else { return differs(index + 1) };
            if place != places.place(index + 1) || !is_same(&sent, &line) {
                return differs(index + 1);
            }
        }
    }
    let (wanted, lines) = (pieces.count(), places.len());
    if known == wanted { Ok(()) } else { differs(lines.min(known)) }
}

/// Both blocks have the same effect, with the same feed; their F words may differ if the feed in force is the same.
fn is_same(one: &InterpretedLine, other: &InterpretedLine) -> bool {
    let cuts = one.step.cutting_feed().is_some();
    let words = |line: &InterpretedLine| {
        let words = line.parsed.block.words.iter().filter(|word| !(cuts && word.letter == b'F'));
        words.map(|word| (word.letter, word.number)).collect::<Vec<_>>()
    };
    let block = |line: &InterpretedLine| (line.parsed.block.sequence, line.parsed.block.program, line.parsed.line);
    let step = |line: &InterpretedLine| {
        let step = &line.step;
        (step.motion, step.dwell, step.stop, step.spindle.map(|(speed, _)| speed), step.sets_data)
    };
    block(one) == block(other)
        && words(one) == words(other)
        && step(one) == step(other)
        && one.step.series == other.step.series
        && one.step.beyond_plain == other.step.beyond_plain
        && one.segment == other.segment
}
