//! Moves by program line, and the one in execution.
//!
//! A line alone does not say that the control executes the prepared move: it may have been restarted in the middle of
//! it, or have other offsets. Therefore a move counts as begun only if the axes are near its start when its line
//! begins; otherwise no law governs it.

use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::supervisor::input::Work;
use arcfeed_link::message::codes::RefusalCode;
use arcfeed_nc::modal::Pose;
use arcfeed_units::{MicroDeg, Nm, RevPerMin};

/// Largest distance of a linear axis from the start of a move when its line begins: blending, and the distance of a tick.
const START_TOLERANCE: Nm = Nm(500_000);
/// The same of a rotary axis.
const START_TOLERANCE_ROTARY: MicroDeg = MicroDeg(100_000);

/// A prepared move, and the program line at which the control executes it.
#[derive(Clone, Debug, PartialEq)]
pub struct LineMove {
    /// Number of the line of its block, the first of the file being 1.
    pub line: u32,
    /// Start position.
    pub start: Pose,
    /// Commanded spindle speed.
    pub spindle: RevPerMin,
    /// The move.
    pub segment: ActiveSegment,
}

/// Slots in the caller's memory, each for one move.
pub type Slots = [Option<LineMove>];

/// The move in execution, found from the line that the control reports; the index is that of its slot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ExecutingLine {
    /// No line is in execution.
    #[default]
    Nothing,
    /// This line is in execution; it has no move, or the axes were not at the move's start when it began, so no law
    /// governs it.
    Ungoverned(u32),
    /// This line is in execution, and its move is in this slot; there was no position yet since it began.
    Awaited(u32, usize),
    /// This line is in execution, and its move, in this slot, was begun at its start.
    Begun(u32, usize),
}

/// Stores a move after the first `used` ones.
///
/// # Errors
/// Its line is not after that of the last one, or no slot is free.
pub fn push(slots: &mut Slots, used: usize, added: LineMove) -> Result<(), RefusalCode> {
    let last = used.checked_sub(1).and_then(|last| slots.get(last)).and_then(Option::as_ref);
    if added.line == 0 || last.is_some_and(|last| last.line >= added.line) {
        return Err(RefusalCode::Order);
    }
    *slots.get_mut(used).ok_or(RefusalCode::Full)? = Some(added);
    Ok(())
}

impl ExecutingLine {
    /// Processes the reported line and the position of a tick (`None` if it is not new); `moves` are the slots in use.
    pub fn update(self, line: Option<u32>, position: Option<&Pose>, moves: &Slots) -> ExecutingLine {
        let Some(line) = line else { return ExecutingLine::Nothing };
        let awaited = match self {
            ExecutingLine::Ungoverned(same) | ExecutingLine::Begun(same, _) if same == line => return self,
            ExecutingLine::Awaited(same, slot) if same == line => Some(slot),
            _ => moves.binary_search_by_key(&line, |slot| slot.as_ref().map_or(0, |found| found.line)).ok(),
        };
        let Some(slot) = awaited else { return ExecutingLine::Ungoverned(line) };
        let found = moves.get(slot).and_then(Option::as_ref);
        match (found, position) {
            (Some(found), Some(position)) if is_near(position, &found.start) => ExecutingLine::Begun(line, slot),
            (Some(_), None) => ExecutingLine::Awaited(line, slot),
            _ => ExecutingLine::Ungoverned(line),
        }
    }

    /// The move in execution, if it was begun at its start; otherwise `None`.
    pub fn begun(self, moves: &Slots) -> Option<&LineMove> {
        match self {
            ExecutingLine::Begun(_, slot) => moves.get(slot).and_then(Option::as_ref),
            ExecutingLine::Nothing | ExecutingLine::Ungoverned(_) | ExecutingLine::Awaited(..) => None,
        }
    }
}

impl LineMove {
    /// The move with its number, as the supervisor takes it.
    pub fn work(&self) -> Work<'_> {
        Some((self.line, &self.segment))
    }
}

fn is_near(position: &Pose, start: &Pose) -> bool {
    let mut linear = position.linear.iter().zip(&start.linear).map(|(at, from)| at.0.abs_diff(from.0));
    let mut rotary = position.rotary.iter().zip(&start.rotary).map(|(at, from)| at.0.abs_diff(from.0));
    linear.all(|distance| distance <= START_TOLERANCE.0.unsigned_abs())
        && rotary.all(|distance| distance <= START_TOLERANCE_ROTARY.0.unsigned_abs())
}
