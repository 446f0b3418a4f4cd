//! The moves of a program as our reader has them, in the terms of another interpreter.

use arcfeed_nc::alarm::Fault;
use arcfeed_nc::block::Reading;
use arcfeed_nc::modal::{Motion, MotionKind, ProgramStop};
use arcfeed_nc::reader::{InterpretedLine, Reader};
use arcfeed_nc::segment::Segment;
use arcfeed_nc::series::SeriesAction;
use arcfeed_nc::settings::{Decimals, Preset, Scope, Settings, Tables};
use arcfeed_nc::text::Lines;
use arcfeed_nc_macro::interpreter::Interpreter;
use arcfeed_nc_macro::program::first_macro;
use arcfeed_nc_macro::step as macros;
use arcfeed_nc_macro::variables::Context;
use arcfeed_units::{LengthUnit, Micros, Nm};

/// G83 of rs274 turns to feed 0.010 in above the last depth, and G73 goes back by as much.
pub const CLEARANCE: Nm = Nm(254_000);

/// Calls of the interpreter after which a program goes on for ever.
const CALLS_MAX: u64 = 1_000_000;

/// One move, on the path.
#[derive(Clone, Copy, Debug)]
pub struct Move {
    /// 0 rapid, 1 line, +-2 arc by its sense.
    pub kind: i8,
    /// X, Y, Z.
    pub end_mm: [f64; 3],
    /// On the axes of the arc's plane.
    pub center_mm: [f64; 2],
}

/// Moves of our reader, with macro statements evaluated. A missing M02 or M30 at the end does not matter here.
pub fn ours(text: &[u8], decimals: Decimals, unit: LengthUnit) -> Result<Vec<Move>, String> {
    let mut settings = Settings::preset(Preset::Fanuc31i, unit, Reading::Lenient);
    settings.scope = Scope::Everything;
    settings.decimals = decimals;
    (settings.peck_clearance, settings.peck_return) = (CLEARANCE, CLEARANCE);
    let mut reader = Reader::with(settings, Tables::default());
    let mut moves = Vec::new();
    if first_macro(text).is_some() {
        return interpreted(text, &mut reader);
    }
    for (index, line) in Lines::new(text).enumerate() {
        let understood = reader.read(line.text).map_err(|fault| message(index + 1, line.text, fault))?;
        add(&understood, &mut moves);
        if understood.step.stop == Some(ProgramStop::End) {
            break;
        }
    }
    Ok(moves)
}

/// With the macro interpreter.
fn interpreted(text: &[u8], reader: &mut Reader) -> Result<Vec<Move>, String> {
    let context = |reader: &Reader, ms| Context::with_length(reader.modal(), reader.machine(), Micros::from_ms(ms));
    let mut interpreter = Interpreter::new(text, Box::new(()), macros::MacroSettings::default(), &context(reader, 0));
    let mut moves = Vec::new();
    let line = |number: u32| Lines::new(text).nth(number as usize - 1).map_or(&[][..], |line| line.text);
    for ms in 0..CALLS_MAX {
        match interpreter.next(&context(reader, ms)) {
            Ok(macros::MacroStep::Block(block)) => {
                let number = block.place.line;
                let understood =
                    reader.read(&block.text).map_err(|fault| message(number as usize, line(number), fault))?;
                add(&understood, &mut moves);
                if understood.step.sets_data {
                    interpreter.set_tables(reader.tables());
                }
            }
            Ok(macros::MacroStep::Offset) => reader.set_tables(&interpreter.variables().tables),
            Ok(macros::MacroStep::End(_) | macros::MacroStep::Restart) => return Ok(moves),
            Ok(_) => {}
            Err(trouble) => return Err(message(trouble.place.line as usize, line(trouble.place.line), trouble.fault)),
        }
    }
    Err("no end".into())
}

fn message(number: usize, line: &[u8], fault: Fault) -> String {
    let found: String = line.iter().take(24).map(|byte| char::from(*byte)).collect();
    format!("line {number}: {} (`{found}`)", short(&fault.cause.to_string()))
}

fn add(understood: &InterpretedLine, moves: &mut Vec<Move>) {
    if let Some(segment) = understood.segment {
        moves.extend(understood.step.motion.map(|motion| of_motion(&motion, Some(&segment))));
    }
    let acts = understood.step.series.iter().flat_map(|series| series.actions());
    moves.extend(
        acts.filter_map(|act| if let SeriesAction::Move(motion) = act { Some(of_motion(&motion, None)) } else { None }),
    );
}

/// The cause without the advice.
fn short(cause: &str) -> &str {
    cause.split(';').next().unwrap_or(cause).split(" is not interpreted").next().unwrap_or(cause)
}

fn of_motion(motion: &Motion, segment: Option<&Segment>) -> Move {
    let kind = match motion.kind {
        MotionKind::Rapid => 0,
        MotionKind::Line => 1,
        MotionKind::Arc(turn) => 2 * turn.sign(),
    };
    let center = segment.and_then(Segment::arc).map_or([Nm(0); 2], |arc| arc.center);
    Move { kind, end_mm: motion.end.linear.map(Nm::to_mm), center_mm: center.map(Nm::to_mm) }
}

/// Moves that get anywhere.
pub fn moving(moves: &[Move]) -> Vec<Move> {
    let mut at = [0.0; 3];
    let mut kept = Vec::new();
    for step in moves {
        let stays = step.end_mm.iter().zip(at).all(|(to, from)| (to - from).abs() < 0.000_2 * 25.4);
        if !stays || step.kind.abs() == 2 {
            kept.push(*step);
        }
        at = step.end_mm;
    }
    kept
}

/// By how much two moves differ, mm.
pub fn off_mm(a: &Move, b: &Move) -> f64 {
    let pairs = a.end_mm.iter().zip(&b.end_mm).chain(a.center_mm.iter().zip(&b.center_mm));
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
