//! Runs of programs by an interpreter and a reader of the test's own.

use std::collections::BTreeMap;

use arcfeed::job::JobFile;
use arcfeed_control::{Control, ControlSettings};
use arcfeed_nc::modal::Feed;
use arcfeed_nc::reader::Reader;
use arcfeed_nc::segment::Segment;
use arcfeed_nc_macro::interpreter::Interpreter;
use arcfeed_nc_macro::stack::SourceLine;
use arcfeed_nc_macro::step::{MacroSettings, MacroStep};
use arcfeed_nc_macro::variables::Context;
use arcfeed_units::{LengthUnit, Micros, Nm};

/// Most steps of an interpreter.
const STEPS_MAX: usize = 1_000_000;
const STEP: Micros = Micros::from_ms(1);
/// Longest run of a control, ms.
const MS_MAX: usize = 10_000_000;

/// A move as executed.
#[derive(Clone, Debug, PartialEq)]
pub struct Executed {
    pub place: SourceLine,
    pub segment: Segment,
}

/// Programs of a library, by number.
pub fn by_number(library: &[(String, String)]) -> BTreeMap<u32, Vec<u8>> {
    let number = |name: &str| name.trim_matches(|letter: char| !letter.is_ascii_digit()).parse().expect("a number");
    library.iter().map(|(name, text)| (number(name), text.as_bytes().to_vec())).collect()
}

/// Moves of a program as a control with it in memory executes them.
pub fn run(text: &str, library: &[(String, String)], file: &JobFile) -> Vec<Executed> {
    let mut reader = Reader::with(file.nc, file.tables);
    let context = |reader: &Reader| Context::with_length(reader.modal(), reader.machine(), Micros(0));
    let library = Box::new(by_number(library));
    let mut interpreter = Interpreter::new(text.as_bytes(), library, MacroSettings::default(), &context(&reader));
    let mut moves = Vec::new();
    for _ in 0..STEPS_MAX {
        match interpreter.next(&context(&reader)) {
            Ok(MacroStep::Block(block)) => {
                let read = reader.read(&block.text).unwrap_or_else(|fault| panic!("{fault:?} {block:?}\n{text}"));
                moves.extend(read.segment.map(|segment| Executed { place: block.place, segment }));
                if read.step.sets_data {
                    interpreter.set_tables(reader.tables());
                }
            }
            Ok(MacroStep::Offset) => reader.set_tables(&interpreter.variables().tables),
            Ok(MacroStep::End(_)) => return moves,
            Ok(_) => {}
            Err(fault) => panic!("{fault:?}\n{text}"),
        }
    }
    panic!("a program without end\n{text}")
}

/// Moves of a plain program.
pub fn plain_moves(text: &str, file: &JobFile) -> Vec<Segment> {
    let mut reader = Reader::with(file.nc, file.tables);
    let read = |line: &str| reader.read(line.as_bytes()).unwrap_or_else(|fault| panic!("{fault:?} {line}\n{text}"));
    text.lines().map(read).filter_map(|read| read.segment).collect()
}

/// Feed of a move, if it cuts.
pub fn feed(segment: &Segment) -> Option<Nm> {
    match segment.feed {
        Feed::PerMinute(feed) => Some(feed),
        Feed::InverseTime(_) | Feed::Missing => None,
    }
}

/// Blocks that the simulated control executes from its memory, without their F words, and the feeds of its cutting
/// moves in the order begun.
pub fn on_the_control(text: &str, library: &[(String, String)]) -> (Vec<String>, Vec<Nm>) {
    let settings = ControlSettings::fanuc_16i(LengthUnit::Mm);
    let mut control = Control::from_memory(settings, text.as_bytes()).with_library(Box::new(by_number(library)));
    let (mut now, mut last, mut feeds) = (Micros(0), None, Vec::new());
    for _ in 0..MS_MAX {
        if control.has_ended() {
            assert!(control.alarm().is_none(), "{:?}\n{text}", control.alarm());
            let blocks = control.executed().iter().map(|block| without_feed(&String::from_utf8_lossy(block)));
            return (blocks.filter(|block| !block.is_empty()).collect(), feeds);
        }
        now = now.after(STEP);
        control.step(now, STEP, 100);
        if let Some((count, segment)) = control.active().filter(|(count, _)| last != Some(*count)) {
            last = Some(count);
            feeds.extend(feed(segment));
        }
    }
    panic!("a control without end\n{text}")
}

/// A block without comments, blanks, program number and F word.
pub fn without_feed(block: &str) -> String {
    let mut code = String::new();
    let (mut in_comment, mut in_feed) = (false, false);
    for letter in block.chars() {
        in_comment |= letter == '(';
        if !in_comment && letter.is_ascii_alphabetic() {
            in_feed = letter == 'F';
        }
        if !in_comment && !in_feed && !letter.is_whitespace() {
            code.push(letter);
        }
        in_comment &= letter != ')';
    }
    if code.starts_with(['O', '%', '#']) { String::new() } else { code }
}
