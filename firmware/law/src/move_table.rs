//! Table that is computed beforehand for one move, from the material that earlier moves have left, and sent with it.
//!
//! Source: own; docs/laws.md#plunge for feeds, docs/laws.md#engaged-arc for arcs.

use arcfeed_model::engaged::EngagedTable;

use crate::table::Table;

/// Table for one move: its law's input over the path travelled.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to box into, and few are held at a time")]
pub enum MoveTable {
    /// Engaged arcs, for a rule that expects them with each move.
    Engaged(EngagedTable),
    /// Feeds per tooth, the law of a move that no rule governs: of a plunge, for example.
    Feeds(Table),
}

impl MoveTable {
    /// The engaged arcs; `None` if the table has feeds.
    pub fn engaged(&self) -> Option<&EngagedTable> {
        match self {
            MoveTable::Engaged(table) => Some(table),
            MoveTable::Feeds(_) => None,
        }
    }

    /// The feeds per tooth; `None` if the table has engaged arcs.
    pub fn feeds(&self) -> Option<&Table> {
        match self {
            MoveTable::Engaged(_) => None,
            MoveTable::Feeds(table) => Some(table),
        }
    }
}
