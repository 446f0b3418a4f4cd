//! Programs made at random, half grammar and half garbage: none may panic, all come to an end within their bounds.

use std::collections::BTreeMap;

use arcfeed_nc::block::Reading;
use arcfeed_nc::reader::Reader;
use arcfeed_nc_macro::interpreter::Interpreter;
use arcfeed_nc_macro::stack::Bounds;
use arcfeed_nc_macro::step::{MacroSettings, MacroStep};
use arcfeed_nc_macro::variables::Context;
use arcfeed_units::{LengthUnit, Micros};
use fastrand::Rng;

const PROGRAMS: u64 = 100_000;
/// Calls of `next` after which a program counts as one that goes on for ever with moves.
const STEPS_MAX: usize = 100;

const PIECES: [&str; 66] = [
    "#1", "#[", "#100", "#500", "#3000", "#3001", "#3006", "#4001", "#5001", "#34", "#0", "=", "=", "[", "]", "]", "+",
    "-", "*", "/", "MOD", "AND", "OR", "XOR", "EQ", "NE", "GT", "LE", "SIN[", "COS[", "TAN[", "ATAN[", "]/[", "SQRT[",
    "ABS[", "ROUND[", "FIX[", "LN[", "EXP[", "POW[", "BIN[", "BCD[", "IF[", "THEN", "GOTO", "WHILE[", "DO1", "DO2",
    "END1", "END2", "G65P2", "G66P3", "G67", "G66.1P2", "M98P2", "M99", "M99P1", "M30", "DPRNT[", "BPRNT[", "[53]",
    "(A)", "N1", "/", "G1", ",",
];
const WHOLE_LINES: [&str; 12] = [
    "WHILE[#1LT5]DO1",
    "END1",
    "#1=#1+1",
    "IF[#1GT3]GOTO1",
    "G1X#1F100.",
    "M98P2L3",
    "G65P3A1.B#1",
    "O2",
    "O3",
    "M99",
    "N1",
    "G66P2A1.",
];

fn line(rng: &mut Rng) -> String {
    match rng.u8(..10) {
        0..5 => (*rng.choice(&WHOLE_LINES).expect("lines")).to_owned(),
        5..9 => (0..rng.usize(1..9)).map(|_| piece(rng)).collect(),
        _ => (0..rng.usize(..20)).map(|_| char::from(rng.u8(..128))).collect(),
    }
}

fn piece(rng: &mut Rng) -> String {
    match rng.u8(..6) {
        0 => format!("{}", rng.i32(-20..200)),
        1 => format!("{:.2}", rng.f64() * 1e3 - 500.0),
        2 => format!("{}{}", rng.uppercase(), rng.u16(..100)),
        _ => (*rng.choice(&PIECES).expect("pieces")).to_owned(),
    }
}

/// Runs a program; whether it came to an end by itself.
fn ends(text: &str, library: BTreeMap<u32, Vec<u8>>) -> bool {
    let bounds = Bounds { steps: 500, slice: 50, memory: 1_000, ..Bounds::default() };
    let mut reader = Reader::new(LengthUnit::Mm, Reading::Lenient);
    let mut now = Micros(0);
    let settings = MacroSettings { bounds, ..MacroSettings::default() };
    let context = Context::new(reader.modal(), now);
    let mut interpreter = Interpreter::new(text.as_bytes(), Box::new(library), settings, &context);
    for _ in 0..STEPS_MAX {
        now = now.after(Micros(700));
        match interpreter.next(&Context::new(reader.modal(), now)) {
            Ok(MacroStep::Block(block)) => {
                if let Err(fault) = reader.read(&block.text) {
                    assert!(block.calls.len() <= 8 && block.in_source(fault).column <= 400);
                }
            }
            Ok(MacroStep::End(_) | MacroStep::Starved) => return true,
            Err(trouble) => {
                assert!(trouble.calls.len() <= 8, "{trouble:?}");
                let again = interpreter.next(&context);
                assert!(matches!(again, Ok(MacroStep::End(_))), "{again:?} after {trouble:?}");
                return true;
            }
            Ok(_) => {}
        }
    }
    false
}

#[test]
fn whatever_is_written_ends_within_its_bounds() {
    let mut ended = 0;
    for seed in 0..PROGRAMS {
        let mut rng = Rng::with_seed(seed);
        let mut text = |lines: usize| (0..lines).map(|_| line(&mut rng) + "\n").collect::<String>();
        let library = BTreeMap::from([(2, text(4).into_bytes()), (3, text(4).into_bytes())]);
        ended += u64::from(ends(&text(12), library));
    }
    println!("{ended} of {PROGRAMS} programs ended, the others went on moving");
    assert!(ended > PROGRAMS / 2);
}

#[test]
fn deep_brackets_and_long_lines_are_taken_apart_without_depth() {
    for text in [format!("#1={}1", "[".repeat(100_000)), "#1=".to_owned() + &"-".repeat(100_000), "#[".repeat(50_000)] {
        assert!(ends(&text, BTreeMap::new()));
    }
}
