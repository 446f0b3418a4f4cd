//! The engaged arcs that a host tells ahead of the segment that they belong to, docs/protocol.md.
//!
//! Half a table would be a wrong law: what was told of a segment counts as a whole or refuses the segment.

use arcfeed_shared::cut::CutRule;
use arcfeed_shared::engaged::{EngagedError, EngagedTable};
use arcfeed_shared::wire::message::codes::RefusalCode;
use arcfeed_shared::wire::message::moves::decode_arcs;
use arcfeed_shared::wire::message::table::SegmentArcs;

/// What was told of the segment that comes next; state.
#[derive(Debug)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to box into, and there is one of it")]
pub enum Arcs {
    /// Nothing.
    None,
    /// These, so far.
    Told(EngagedTable),
    /// Some that were refused.
    Refused,
}

impl Arcs {
    /// Takes the arcs at the next place.
    ///
    /// # Errors
    /// Why there can be no such place; of one segment only the first is answered.
    pub fn take(&mut self, arcs: &SegmentArcs) -> Result<(), RefusalCode> {
        let taken = self.add(arcs);
        if taken.is_err() {
            *self = Arcs::Refused;
        }
        taken
    }

    fn add(&mut self, arcs: &SegmentArcs) -> Result<(), RefusalCode> {
        let SegmentArcs { travelled, outer, inner } = *arcs;
        let knot = || decode_arcs(travelled, [outer, inner]).map_err(|_| RefusalCode::Value);
        let added = match self {
            Arcs::None => EngagedTable::beginning(knot()?).map(|table| *self = Arcs::Told(table)),
            Arcs::Told(table) => table.push(knot()?),
            Arcs::Refused => Ok(()),
        };
        added.map_err(|error| match error {
            EngagedError::Count => RefusalCode::Full,
            EngagedError::Order(_) => RefusalCode::Order,
        })
    }

    /// Whether they can belong to a segment of this rule. Without any the segment has no law: that is for the host to say.
    ///
    /// # Errors
    /// Why not.
    pub fn suit(&self, rule: Option<&CutRule>) -> Result<(), RefusalCode> {
        match self {
            Arcs::Refused => Err(RefusalCode::Incomplete),
            Arcs::Told(_) if !rule.is_some_and(CutRule::is_told_along) => Err(RefusalCode::Value),
            Arcs::None | Arcs::Told(_) => Ok(()),
        }
    }

    /// The whole table, if there is one.
    pub fn table(&self) -> Option<&EngagedTable> {
        match self {
            Arcs::Told(table) => Some(table),
            Arcs::None | Arcs::Refused => None,
        }
    }
}
