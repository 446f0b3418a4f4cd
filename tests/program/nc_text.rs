//! Text to blocks and back, and words as another parser reads them, on seeded random programs.

use std::path::Path;

use arcfeed::program::Program;
use arcfeed_nc::block::{LineKind, Parsed, Reading, parse_line};
use arcfeed_units::LengthUnit;
use fastrand::Rng;
use gcode::{Argument, Code, Value};

const PROGRAMS: u64 = 400;
/// Pieces that random programs are put together from: what the dialect has, and what it refuses.
const PIECES: [&str; 34] = [
    "N10", "G1", "G02", "G43.4", "X-3.6044", "Y+.5", "Z12.", "I0", "J-7.25", "R10", "F250", "S1000", "M30", "T12",
    "H3", "D5", "(NOTE)", "(OPEN", "/", "/3", "%", "O1234", ":77", "#5204=0", "X", "1.5", "G1..2", "x1", " ", "\t",
    ")", "'", "P500", "L2",
];
const ENDS: [&str; 5] = ["\n", "\r\n", "\n\r\r", "\n\n", ""];

fn random_program(rng: &mut Rng) -> String {
    let mut text = String::new();
    for _ in 0..rng.usize(1..30) {
        for _ in 0..rng.usize(0..8) {
            text += PIECES[rng.usize(..PIECES.len())];
        }
        text += ENDS[rng.usize(..ENDS.len())];
    }
    text
}

#[test]
fn a_program_is_its_bytes_whatever_stands_in_it() {
    let mut rng = Rng::with_seed(41);
    for _ in 0..PROGRAMS {
        let text = random_program(&mut rng);
        let noise: Vec<u8> = (0..rng.usize(0..300)).map(|_| rng.u8(..)).collect();
        for bytes in [text.as_bytes(), &noise] {
            for reading in [Reading::Lenient, Reading::Strict] {
                let program = Program::parse(Path::new("random.nc"), bytes, LengthUnit::Mm, reading);
                assert_eq!(program.bytes(), bytes);
            }
        }
    }
}

#[test]
fn the_words_of_a_block_are_its_text_each_in_its_place() {
    let (mut rng, mut words) = (Rng::with_seed(42), 0);
    for _ in 0..PROGRAMS {
        for line in random_program(&mut rng).lines() {
            let Ok(Parsed { line: LineKind::Block, block, .. }) = parse_line(line.as_bytes(), Reading::Lenient) else {
                continue;
            };
            // Written back where they stood, and nothing but what is no word left between them.
            let mut rest = line.as_bytes().to_vec();
            for word in &block.words {
                let (start, len) = (usize::from(word.column) - 1, usize::from(word.len));
                let text = &line[start..start + len];
                assert_eq!(text.as_bytes()[0].to_ascii_uppercase(), word.letter, "{line}");
                let digits = text[1..].replace([' ', '\t'], "");
                assert_eq!(digits.parse::<f64>().ok(), Some(word.number.to_f64()), "{line}");
                rest[start..start + len].fill(b' ');
                words += 1;
            }
            let code = rest[..block.code_len].split(|byte| *byte == b'(').next().unwrap_or_default();
            let left = String::from_utf8_lossy(code).replace("#5204=0", "");
            let strange = left.chars().find(|c| c.is_ascii_alphabetic() && !matches!(c, 'N' | 'O'));
            assert!(block.code_len <= line.len() && strange.is_none(), "{line}: {left}");
        }
    }
    println!("{words} words");
    assert!(words > 1_000, "{words}");
}

/// Letters and numbers of a line, N and comments apart.
type Letters = Vec<(char, f32)>;

fn of_arguments(letter: char, number: &gcode::core::Number, arguments: &[Argument]) -> Letters {
    let code = format!("{number}").parse().expect("a number");
    let value = |argument: &Argument| match &argument.value {
        Value::Literal(value) => *value,
        other => panic!("{other:?}"),
    };
    let rest = arguments.iter().map(|argument| (argument.letter, value(argument)));
    std::iter::once((letter, code)).chain(rest).collect()
}

fn theirs(line: &str) -> (Option<u32>, Letters) {
    let program = gcode::parse(line).unwrap_or_else(|error| panic!("{line}: {error:?}"));
    let block = program.blocks.first().expect("a block");
    let words = block.codes.iter().flat_map(|code| match code {
        Code::General(code) => of_arguments('G', &code.number, &code.args),
        Code::Miscellaneous(code) => of_arguments('M', &code.number, &code.args),
        Code::ToolChange(code) => of_arguments('T', &code.number, &code.args),
        other => panic!("{other:?}"),
    });
    (block.line_number, words.collect())
}

#[test]
fn another_parser_reads_the_same_words_where_both_support_them() {
    let (mut rng, mut words) = (Rng::with_seed(43), 0);
    for _ in 0..4_000 {
        let mut line = format!("N{}", rng.u32(1..99_999));
        let blank = if rng.bool() { " " } else { "" };
        for _ in 0..rng.usize(1..4) {
            line += &format!("{blank}{}", ["G0", "G01", "G2", "G54", "G43.4", "M8", "M30", "T7"][rng.usize(..8)]);
            for _ in 0..rng.usize(0..4) {
                let letter = char::from(b"XYZIJKRF"[rng.usize(..8)]);
                let value = f64::from(rng.i32(-9_999_999..9_999_999)) / 1e4;
                line += &format!("{blank}{letter}{value:.*}", rng.usize(0..5));
            }
        }
        line += ["", "(NOTE)", " (A B)"][rng.usize(..3)];
        let (sequence, theirs) = theirs(&line);
        let block = parse_line(line.as_bytes(), Reading::Lenient).expect(&line).block;
        let ours: Letters =
            block.words.iter().map(|word| (char::from(word.letter), word.number.to_f64() as f32)).collect();
        assert_eq!((block.sequence, &ours), (sequence.map(i64::from), &theirs), "{line}");
        words += ours.len();
    }
    println!("{words} words, all alike");
}
