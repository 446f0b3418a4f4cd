//! CL data computed from a machine's NC program.
//!
//! It reads the output of [`super::nc`] and similar programs: straight moves with absolute words in millimetres. A word
//! that would change the meaning of positions (inch, increments, arcs, cycles, offsets by G10, G52, G92, G68) is
//! rejected.

use arcfeed_kinematics::deviation::Mode;
use arcfeed_kinematics::forward::{Axes, Setup, ToolPose};
use arcfeed_kinematics::machine::Machine;
use arcfeed_kinematics::vector::{difference, length, unit};
use arcfeed_nc::text::{Lines, RawLine};
use arcfeed_nc::word::{Token, Words};

use super::cl::{Cl, ClPoint};

/// G codes in tenths that do not change the meaning of positions: motion, planes, units, compensations off, tool centre
/// point control, feeds.
const KNOWN: [i64; 24] =
    [0, 10, 40, 90, 170, 180, 190, 210, 400, 430, 434, 435, 490, 500, 540, 550, 560, 570, 580, 590, 690, 800, 900, 940];
/// G93: inverse time.
const INVERSE_TIME: i64 = 930;

/// Positions and feed in force.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    linear: [Option<f64>; 3],
    direction: [Option<f64>; 3],
    rotary: [Option<f64>; 2],
    is_rapid: bool,
    is_inverse_time: bool,
    feed: Option<f64>,
}

/// Whether a program gives the tool's direction by I, J, K (G43.5) rather than by the positions of the rotary axes.
pub fn is_by_direction(bytes: &[u8]) -> bool {
    let is_code = |token: Token<'_>| matches!(token, Token::Word(word) if word.letter == b'G' && word.number.as_tenths() == Some(435));
    let mut words = Lines::new(bytes).flat_map(|line| Words::tolerant(line.text, true)).flatten();
    words.any(|piece| is_code(piece.token))
}

/// Converts a program that was written in the given mode into CL data.
///
/// # Errors
/// Describes the fault as `line: message`.
pub fn read(bytes: &[u8], machine: &Machine, setup: &Setup, mode: Mode) -> Result<Cl, String> {
    let mut cl = Cl::default();
    let mut state = State { is_rapid: true, ..State::default() };
    for (index, RawLine { text, .. }) in Lines::new(bytes).enumerate() {
        let line = index + 1;
        let in_line = |what: String| format!("{line}: {what} (found `{}`)", text.escape_ascii());
        let moves = state.take(text, machine, &mut cl).map_err(in_line)?;
        if moves {
            let pose = state.pose(machine, setup, mode).map_err(in_line)?;
            let way_mm = cl.points.last().map(|last| length(difference(pose.tip_mm, last.pose.tip_mm)));
            let feed_mm_per_min = state.feed_mm_per_min(way_mm);
            cl.points.push(ClPoint { line, pose, feed_mm_per_min });
        }
    }
    if cl.points.is_empty() { Err("1: the program makes no moves".into()) } else { Ok(cl) }
}

impl State {
    /// Reads one block; returns true if it moves.
    fn take(&mut self, text: &[u8], machine: &Machine, cl: &mut Cl) -> Result<bool, String> {
        let mut moves = false;
        for piece in Words::tolerant(text, true) {
            let word = match piece.map_err(|fault| format!("no word at column {}", fault.column))?.token {
                Token::Word(word) => word,
                Token::Comment { text, .. } => {
                    let text = String::from_utf8_lossy(text).trim().to_owned();
                    cl.name = cl.name.take().or(Some(text).filter(|text| !text.is_empty()));
                    continue;
                }
                Token::ProgramMark => continue,
                Token::Assignment { .. } | Token::BlockDelete(_) => {
                    return Err("macros and optional blocks are not read".into());
                }
            };
            moves |= self.word(word.letter, word.number.to_f64(), word.number.as_tenths(), machine)?;
        }
        Ok(moves)
    }

    /// Reads one word; returns true if it moves.
    fn word(&mut self, letter: u8, value: f64, tenths: Option<i64>, machine: &Machine) -> Result<bool, String> {
        let slot = match letter {
            b'G' => return self.code(tenths).map(|()| false),
            b'F' => {
                self.feed = Some(value);
                return Ok(false);
            }
            b'X' | b'Y' | b'Z' => self.linear.get_mut(usize::from(letter - b'X')),
            b'I' | b'J' | b'K' => self.direction.get_mut(usize::from(letter - b'I')),
            b'A' | b'B' | b'C' => {
                let name = char::from(letter).to_string();
                let at = machine.rotary().iter().position(|axis| axis.letter.to_string() == name);
                self.rotary.get_mut(at.ok_or(format!("the machine has no axis {name}"))?)
            }
            b'N' | b'O' | b'M' | b'S' | b'T' | b'D' | b'H' => return Ok(false),
            _ => return Err(format!("the word {} is not read", char::from(letter))),
        };
        if let Some(slot) = slot {
            *slot = Some(value);
        }
        Ok(true)
    }

    fn code(&mut self, tenths: Option<i64>) -> Result<(), String> {
        match tenths {
            Some(0) => self.is_rapid = true,
            Some(10) => self.is_rapid = false,
            Some(INVERSE_TIME) => self.is_inverse_time = true,
            Some(940) => self.is_inverse_time = false,
            Some(code) if KNOWN.contains(&code) => {}
            _ => return Err("only straight moves in absolute millimetres are read back".into()),
        }
        Ok(())
    }

    /// Position of the tool, each word from this block or an earlier one.
    fn pose(&self, machine: &Machine, setup: &Setup, mode: Mode) -> Result<ToolPose, String> {
        let all = |words: [Option<f64>; 3], names: &str| match words {
            [Some(x), Some(y), Some(z)] => Ok([x, y, z]),
            _ => Err(format!("a first move needs all of {names}")),
        };
        let linear_mm = all(self.linear, "X, Y, Z")?;
        if mode == Mode::Tcp {
            let axis = unit(all(self.direction, "I, J, K")?).ok_or("I, J, K have no direction")?;
            return Ok(ToolPose { tip_mm: linear_mm, axis });
        }
        let [Some(first), Some(second)] = self.rotary else {
            return Err("a first move needs both rotary axes".into());
        };
        let rotary_deg = [first, second];
        Ok(match mode {
            Mode::Machine => machine.forward(&Axes { linear_mm, rotary_deg }, setup),
            Mode::PartRotary | Mode::Tcp => ToolPose { tip_mm: linear_mm, axis: machine.axis_at(rotary_deg) },
        })
    }

    /// Feed of the tip on a path; `None` for rapids.
    fn feed_mm_per_min(&self, way_mm: Option<f64>) -> Option<f64> {
        let feed = self.feed.filter(|_| !self.is_rapid)?;
        if !self.is_inverse_time {
            return Some(feed);
        }
        // A turn at a fixed tip was given the time of a millimetre.
        Some(feed * way_mm.filter(|way| *way > 0.0).unwrap_or(1.0))
    }
}
