//! Instructions per line of the dialect: `cost [LINES]` runs itself under callgrind and prints them.
//!
//! The program, mixed G1 and G2 with N, feeds and comments here and there, is made line by line in one buffer; what making it
//! costs is measured alone and taken off. Memory is the reader's own size, however long the program.

use std::fmt::Write;
use std::hint::black_box;

use arcfeed_nc::block::Reading;
use arcfeed_nc::reader::{InterpretedLine, Reader};
use arcfeed_nc::word::Words;
use arcfeed_tests::valgrind::instructions;
use arcfeed_units::LengthUnit;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let lines = |text: &String| text.parse().unwrap_or(20_000);
    match arguments.as_slice() {
        [what, count] => println!("{}", read(what, lines(count))),
        others => measure(others.first().map_or(20_000, lines)),
    }
}

fn measure(lines: u64) {
    let own = std::env::current_exe().expect("this program");
    let run = |what| instructions(&own, &[what, &lines.to_string()]);
    let [made, lexed, interpreted] = ["make", "lex", "interpret"].map(run);
    let per_line = |total: u64| total.saturating_sub(made) / lines;
    println!(
        "{lines} lines: lexing {}, full interpretation {} instructions a line",
        per_line(lexed),
        per_line(interpreted)
    );
    println!("memory: {} bytes of reader, no heap", size_of::<Reader>());
}

/// Makes the program and reads it; the answer only keeps the work from being left out.
fn read(what: &str, lines: u64) -> u64 {
    let mut line = String::with_capacity(128);
    let mut reader = Reader::new(LengthUnit::Mm, Reading::Strict);
    let mut understood = InterpretedLine::default();
    let mut sum = 0;
    for index in 0..lines {
        line.clear();
        make(&mut line, index);
        sum += match what {
            "lex" => lex(line.as_bytes()),
            "interpret" => {
                let is_read = reader.read_into(line.as_bytes(), &mut understood).is_ok();
                u64::from(is_read && understood.segment.is_some())
            }
            _ => line.len() as u64,
        };
    }
    sum
}

/// Every token of a line, the words taken whole, as whoever uses them would.
fn lex(line: &[u8]) -> u64 {
    let (mut words, mut tokens) = (Words::new(line), 0);
    loop {
        while let Some(word) = words.next_word() {
            black_box(word);
            tokens += 1;
        }
        let Some(token) = words.next() else { return tokens };
        tokens += u64::from(black_box(token).is_ok());
    }
}

/// Four moves that close, again and again: a line there, half a turn, a line back, half a turn.
fn make(line: &mut String, index: u64) {
    let level = (index / 4) % 1_000;
    let number = index % 99_998 + 1;
    let written = match index % 4 {
        0 => write!(line, "N{number}G1X100.0005Y-25.1250Z-{}.{:03}F250.", level / 10, level),
        1 => write!(line, "N{number}G2X100.0005Y-75.1250I0.J-25."),
        2 => write!(line, "N{number}G1X-100.0005 (PASS)"),
        _ => write!(line, "N{number}G2X-100.0005Y-25.1250I0.J25.F400."),
    };
    written.expect("a string takes anything");
}
