//! Programs of macro statements, made at random: through the interpreter, and through the control from its memory.

use std::collections::BTreeMap;

use arcfeed_control::search::Search;
use arcfeed_control::{Control, Preset};
use arcfeed_nc::alarm::{Cause, Fault, NotModelled};
use arcfeed_nc::block::Reading;
use arcfeed_nc::reader::Reader;
use arcfeed_nc::settings::{Preset as NcPreset, Scope, Settings as NcSettings, Tables};
use arcfeed_nc::text::Lines;
use arcfeed_nc_macro::interpreter::Interpreter;
use arcfeed_nc_macro::stack::{Bounds, SourceLine};
use arcfeed_nc_macro::step::{MacroSettings, MacroStep};
use arcfeed_nc_macro::variables::Context;
use arcfeed_units::{LengthUnit, Micros};
use fastrand::Rng;

const STEP: Micros = Micros::from_ms(1);
/// Calls of the interpreter after which a program counts as one that goes on for ever with moves.
const CALLS_MAX: usize = 150;
/// Programs that can be called.
const LIBRARY: [u32; 3] = [9001, 9002, 9003];

const VARIABLES: [&str; 28] = [
    "#0",
    "#1",
    "#2",
    "#24",
    "#26",
    "#33",
    "#34",
    "#100",
    "#199",
    "#500",
    "#999",
    "#[#1]",
    "#[#1+100]",
    "#3000",
    "#3001",
    "#3002",
    "#3003",
    "#3004",
    "#3006",
    "#3011",
    "#3012",
    "#4001",
    "#4109",
    "#5001",
    "#5042",
    "#2001",
    "#5221",
    "#11001",
];
const OPERATORS: [&str; 15] = ["+", "-", "*", "/", "MOD", "AND", "OR", "XOR", "EQ", "NE", "GT", "GE", "LT", "LE", "+-"];
const FUNCTIONS: [&str; 18] = [
    "SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN", "SQRT", "ABS", "ROUND", "FIX", "FUP", "LN", "EXP", "BIN", "BCD", "SQ",
    "RO", "POW",
];
const BLOCKS: [&str; 30] = [
    "G0X",
    "G1F100.Y",
    "G91Z",
    "G2I1.X",
    "G3R2.Y",
    "G81R1.Z",
    "G80",
    "G52X",
    "G54",
    "G55",
    "G68R",
    "G69",
    "G92X",
    "G28Z",
    "G43H1Z",
    "G49",
    "G10L2P1X",
    "G10L10P1R",
    "G10L12P1R",
    "G10L20P1X",
    "G41D1X",
    "G40",
    "G4P5",
    "M8",
    "M0",
    "M1",
    "S",
    "T",
    "G20",
    "F",
];
const CALLS: [&str; 12] = [
    "M98P9001",
    "M98P9002L2",
    "M98P29003",
    "G65P9001A1.B#2",
    "G65P9002L2X#1",
    "G66P9003A1.",
    "G66.1P9001",
    "G67",
    "M99",
    "M99P2",
    "M96P2",
    "M198P1",
];

/// Writes one program.
struct Writer<'a> {
    random: Rng,
    input: &'a [u8],
    text: Vec<u8>,
    sequence: u32,
}

impl Writer<'_> {
    fn pick<'t>(&mut self, from: &[&'t str]) -> &'t str {
        from[self.random.usize(..from.len())]
    }

    fn expression(&mut self, depth: u32) -> String {
        match self.random.u8(..if depth > 6 { 3 } else { 9 }) {
            0 => self.random.i32(-20..9_010).to_string(),
            1 => format!("{:.3}", self.random.f64() * 200.0 - 100.0),
            2..5 => self.pick(&VARIABLES).to_owned(),
            5 => format!("{}[{}]", self.pick(&FUNCTIONS), self.expression(depth + 1)),
            6 => format!("ATAN[{}]/[{}]", self.expression(depth + 1), self.expression(depth + 1)),
            7 => format!("[{}]", self.expression(depth + 1)),
            _ => format!("{}{}{}", self.expression(depth + 1), self.pick(&OPERATORS), self.expression(depth + 1)),
        }
    }

    fn statement(&mut self, depth: u32) -> String {
        let condition = |writer: &mut Self| {
            format!("{}{}{}", writer.expression(4), writer.pick(&OPERATORS[8..14]), writer.expression(5))
        };
        match self.random.u8(..16) {
            0..4 => format!("{}={}", self.pick(&VARIABLES), self.expression(0)),
            4 => format!("IF[{}]GOTO{}", condition(self), self.expression(7)),
            5 if depth < 9 => format!("IF[{}]THEN{}", condition(self), self.statement(depth + 1)),
            6 => format!("GOTO{}", self.random.u32(..6)),
            7..10 => format!("{}{}", self.pick(&BLOCKS), self.expression(5)),
            10 => format!("{}[{}]", self.pick(&BLOCKS), self.expression(3)),
            11 | 12 => self.pick(&CALLS).to_owned(),
            13 => format!(
                "{}[X{}[{}]Y*{}[{}]]",
                self.pick(&["DPRNT", "BPRNT"]),
                self.pick(&VARIABLES),
                self.random.u8(..60),
                self.pick(&VARIABLES),
                self.random.u8(..10)
            ),
            14 => self.pick(&["POPEN", "PCLOS", "M30", "M99", "N3", "%", "O9002", "(A"]).to_owned(),
            _ => {
                let from = self.random.usize(..=self.input.len());
                let to = (from + self.random.usize(..30)).min(self.input.len());
                String::from_utf8_lossy(&self.input[from..to]).into_owned()
            }
        }
    }

    fn line(&mut self, text: &str) {
        if self.random.u8(..4) == 0 {
            self.sequence += 1;
            self.text.extend(format!("N{}", self.sequence).bytes());
        }
        if self.random.u8(..20) == 0 {
            self.text.push(b'/');
        }
        self.text.extend(text.bytes());
        if self.random.u8(..30) == 0 && !self.text.is_empty() {
            let at = self.random.usize(..self.text.len());
            self.text[at] = self.random.u8(..);
        }
        self.text.push(b'\n');
    }

    fn body(&mut self, depth: u32) {
        for _ in 0..self.random.u32(1..6) {
            if depth < 4 && self.random.u8(..4) == 0 {
                let number = self.random.u32(1..4);
                let turns = self.random.u8(..6);
                self.line(&format!("#{number}=0"));
                self.line(&format!("WHILE[#{number}LT{turns}]DO{number}"));
                self.line(&format!("#{number}=#{number}+1"));
                self.body(depth + 1);
                self.line(&format!("END{number}"));
            } else {
                let text = self.statement(0);
                self.line(&text);
            }
        }
    }
}

/// A program, and the library it calls.
pub fn programs(input: &[u8], seed: u64) -> (Vec<u8>, BTreeMap<u32, Vec<u8>>) {
    let mut random = Rng::with_seed(seed);
    let mut write = |head: String, last: &str| {
        let mut writer = Writer { random: random.fork(), input, text: head.into_bytes(), sequence: 0 };
        writer.body(0);
        writer.line(last);
        writer.text
    };
    let main = write("O1\n".into(), "M30");
    (main, LIBRARY.map(|number| (number, write(format!("O{number}\n"), "M99"))).into())
}

/// The line at a place: the text has it, and the column lies in it or just behind.
fn assert_inside(place: SourceLine, fault: Fault, main: &[u8], library: &BTreeMap<u32, Vec<u8>>) {
    let text = place.library.map_or(main, |number| &library[&number]);
    let line = Lines::new(text).nth(place.line as usize - 1).unwrap_or_else(|| panic!("{place:?}: {fault:?}"));
    assert!(usize::from(fault.column) <= line.text.len() + 1, "{place:?}: {fault:?}");
}

/// The interpreter by itself: it ends within its bounds, its places lie in the text, and its blocks have no statements left.
pub fn interpreter(input: &[u8], seed: u64) {
    let (main, library) = programs(input, seed);
    let bounds = Bounds { steps: 500, slice: 50, memory: 20_000, ..Bounds::default() };
    let settings =
        MacroSettings { bounds, block_delete: u16::from(seed.is_multiple_of(3)) * 2, ..MacroSettings::default() };
    let mut settings_of_control = NcSettings::preset(NcPreset::Fanuc16i, LengthUnit::Mm, Reading::Lenient);
    settings_of_control.scope = Scope::Everything;
    let mut reader = Reader::with(settings_of_control, Tables::default());
    let context =
        |reader: &Reader, ms: usize| Context::with_length(reader.modal(), reader.machine(), Micros::from_ms(ms as u64));
    let mut interpreter = Interpreter::new(&main, Box::new(library.clone()), settings, &context(&reader, 0));
    for call in 0..CALLS_MAX {
        match interpreter.next(&context(&reader, call)) {
            Ok(MacroStep::Block(block)) => {
                block
                    .calls
                    .iter()
                    .for_each(|call| assert_inside(*call, Fault::not_modelled(NotModelled::Macro, 1), &main, &library));
                let read = reader.read(&block.text);
                if read.as_ref().is_ok_and(|understood| understood.step.sets_data) {
                    interpreter.set_tables(reader.tables());
                }
                if let Err(fault) = read {
                    assert_ne!(fault.cause, Cause::NotModelled(NotModelled::Macro), "{}", block.text.escape_ascii());
                    assert_inside(block.place, block.in_source(fault), &main, &library);
                }
            }
            Ok(MacroStep::Offset) => reader.set_tables(&interpreter.variables().tables),
            Ok(MacroStep::End(_) | MacroStep::Starved) => return,
            Err(trouble) => {
                assert!(trouble.calls.len() <= 8, "{trouble:?}");
                assert_inside(trouble.place, trouble.fault, &main, &library);
                let again = interpreter.next(&context(&reader, call));
                assert!(matches!(again, Ok(MacroStep::End(_))), "{again:?} after {trouble:?}");
                return;
            }
            Ok(_) => {}
        }
    }
}

/// The control with the program in its memory: it moves, waits, ends or stops with an alarm in the program's text.
pub fn memory(input: &[u8], seed: u64) {
    let (main, library) = programs(input, seed);
    let mut random = Rng::with_seed(seed);
    let preset = [Preset::Fanuc16i, Preset::Fanuc0i, Preset::Fanuc31i][random.usize(..3)];
    let mut settings = preset.settings(LengthUnit::Mm);
    settings.switches.single_block = random.bool();
    settings.switches.block_delete = random.u16(..4);
    settings.operator_restart = Some(STEP);
    let mut control = Control::from_memory(settings, &main).with_library(Box::new(library));
    for ms in 1..60 {
        control.step(Micros::from_ms(ms), STEP, random.u8(..));
        if random.u8(..20) == 0 {
            control.hold();
            control.cycle_start();
        }
    }
    if let Some(alarm) = control.alarm() {
        assert!(alarm.line as usize <= Lines::new(&main).count(), "{alarm:?}");
    }
}

/// The control with the program on its DNC line and the library in its memory; reset, restarted and searched in between.
pub fn over_the_line(input: &[u8], seed: u64) {
    let (main, library) = programs(input, seed);
    let mut random = Rng::with_seed(seed);
    let preset = [Preset::Fanuc16i, Preset::Fanuc0i, Preset::Fanuc31i][random.usize(..3)];
    let mut settings = preset.settings(LengthUnit::Mm);
    settings.line.baudrate = 1_000_000;
    settings.switches.single_block = random.u8(..4) == 0;
    settings.switches.block_delete = random.u16(..4);
    settings.operator_restart = Some(STEP);
    let mut control = Control::on_line(settings).with_library(Box::new(library));
    match random.u8(..8) {
        0 => control.search(Search::Restart(2)),
        1 => control.search(Search::Sequence(2)),
        _ => {}
    }
    let mut left = &main[..];
    control.port().on_bytes(b"%\n");
    for ms in 1..60 {
        let (burst, rest) = left.split_at(random.usize(..=left.len().min(120)));
        control.port().on_bytes(burst);
        left = rest;
        control.step(Micros::from_ms(ms), STEP, random.u8(..));
        while random.u8(..9) > 0 && control.port().poll_transmit().is_some() {}
        if random.u8(..60) == 0 {
            control.reset();
        }
        if random.u8(..10) == 0 {
            control.cycle_start();
        }
    }
    if let Some(alarm) = control.alarm() {
        // With a bit too much a line feed is one all the same, and 0x80 ends a block in EIA.
        let ends = main.iter().filter(|byte| matches!(*byte & 0x7F, b'\n' | 0)).count();
        assert!(alarm.line as usize <= ends + 1, "{alarm:?}");
    }
}
