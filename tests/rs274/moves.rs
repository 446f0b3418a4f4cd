//! The moves of a program as our reader has them, in the terms of another interpreter.

use arcfeed_shared::nc::block::Reading;
use arcfeed_shared::nc::modal::{Motion, MotionKind, Stop};
use arcfeed_shared::nc::series::Act;
use arcfeed_shared::nc::settings::{Decimals, Preset, Scope, Settings, Tables};
use arcfeed_shared::nc::text::Lines;
use arcfeed_shared::reader::Reader;
use arcfeed_shared::segment::Segment;
use arcfeed_shared::units::{LengthUnit, Nm};

/// G83 of rs274 turns to feed 0.010 in above the last depth, and G73 goes back by as much.
pub const CLEARANCE: Nm = Nm(254_000);

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

/// What our reader makes of it, macro statements worked out.
pub fn ours(text: &[u8]) -> Result<Vec<Move>, String> {
    let mut settings = Settings::preset(Preset::Fanuc31i, LengthUnit::Mm, Reading::Lenient);
    settings.scope = Scope::Everything;
    settings.decimals = Decimals::Calculator;
    (settings.peck_clearance, settings.peck_return) = (CLEARANCE, CLEARANCE);
    let mut reader = Reader::with(settings, Tables::default());
    let mut moves = Vec::new();
    for (index, line) in Lines::new(text).enumerate() {
        let understood = reader.read(line.text).map_err(|fault| {
            let found: String = line.text.iter().take(24).map(|byte| char::from(*byte)).collect();
            format!("line {}: {} (`{found}`)", index + 1, short(&fault.cause.to_string()))
        })?;
        if let Some(segment) = understood.segment {
            moves.extend(understood.step.motion.map(|motion| of_motion(&motion, Some(&segment))));
        }
        let acts = understood.step.series.iter().flat_map(|series| series.acts());
        moves.extend(
            acts.filter_map(|act| if let Act::Move(motion) = act { Some(of_motion(&motion, None)) } else { None }),
        );
        if understood.step.stop == Some(Stop::End) {
            break;
        }
    }
    Ok(moves)
}

/// What is wrong, without the advice.
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
