//! Override that the control applies during governed moves.

/// Override during one governed move: smallest and largest value, and number of changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MoveOverride {
    /// Smallest override, %.
    pub min_percent: u8,
    /// Largest override, %; 0 before the first period of the move.
    pub max_percent: u8,
    /// Number of times that the override changed.
    pub changes: u32,
    last_percent: u8,
}

impl MoveOverride {
    /// A move without a period.
    pub(crate) const NONE: Self = MoveOverride { min_percent: u8::MAX, max_percent: 0, changes: 0, last_percent: 0 };

    /// Adds the override of a period.
    pub(crate) fn record(&mut self, percent: u8) {
        self.changes += u32::from(self.max_percent > 0 && percent != self.last_percent);
        self.min_percent = self.min_percent.min(percent);
        self.max_percent = self.max_percent.max(percent);
        self.last_percent = percent;
    }
}

/// Override on each descent of a run.
#[derive(Debug, Default)]
pub(crate) struct DescentOverrides {
    moves: Vec<MoveOverride>,
    /// Number of the descent in execution; `None` on other moves.
    current: Option<u32>,
}

impl DescentOverrides {
    /// Begins the descent with this number; `None` begins another move.
    pub(crate) fn begin(&mut self, count: Option<u32>) {
        self.current = count;
        self.moves.extend(count.map(|_| MoveOverride::NONE));
    }

    /// The descent in execution, if it has this number.
    pub(crate) fn on(&mut self, count: u32) -> Option<&mut MoveOverride> {
        self.moves.last_mut().filter(|_| self.current == Some(count))
    }

    /// All descents, in order of execution.
    pub(crate) fn moves(&self) -> &[MoveOverride] {
        &self.moves
    }
}
