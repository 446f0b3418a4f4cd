//! Engaged arcs that the host sends before their segment; see docs/protocol.md.
//!
//! An incomplete table would give a wrong law: a segment has all of its arcs, or it is rejected.

use arcfeed_link::message::codes::RefusalCode;
use arcfeed_link::message::moves::decode_arcs;
use arcfeed_link::message::table::SegmentArcs;
use arcfeed_model::cut::CutRule;
use arcfeed_model::engaged::{EngagedError, EngagedTable};

/// Engaged arcs (directions in which the edges are in material) that the host has sent for the next segment.
#[derive(Debug)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to box into, and there is one of it")]
pub enum ReceivedArcs {
    /// None were sent.
    None,
    /// The arcs received so far, all of them valid.
    Received(EngagedTable),
    /// At least one knot of them was rejected, so the segment will be rejected too.
    Refused,
}

impl ReceivedArcs {
    /// Adds the arcs of the next knot along the segment.
    ///
    /// # Errors
    /// Reason why the knot is rejected. Only the first rejection of a segment is reported.
    pub fn add(&mut self, arcs: &SegmentArcs) -> Result<(), RefusalCode> {
        let taken = self.try_add(arcs);
        if taken.is_err() {
            *self = ReceivedArcs::Refused;
        }
        taken
    }

    fn try_add(&mut self, arcs: &SegmentArcs) -> Result<(), RefusalCode> {
        let SegmentArcs { travelled, outer, inner } = *arcs;
        let knot = || decode_arcs(travelled, [outer, inner]).map_err(|_| RefusalCode::Value);
        let added = match self {
            ReceivedArcs::None => EngagedTable::with_first(knot()?).map(|table| *self = ReceivedArcs::Received(table)),
            ReceivedArcs::Received(table) => table.push(knot()?),
            ReceivedArcs::Refused => Ok(()),
        };
        added.map_err(|error| match error {
            EngagedError::Count => RefusalCode::Full,
            EngagedError::Order(_) => RefusalCode::Order,
        })
    }

    /// Checks that a segment under this rule may have these arcs. It may also have none: no law governs it then, which
    /// is the host's decision.
    ///
    /// # Errors
    /// [`RefusalCode`] to be sent to the host.
    pub fn check_rule(&self, rule: Option<&CutRule>) -> Result<(), RefusalCode> {
        match self {
            ReceivedArcs::Refused => Err(RefusalCode::Incomplete),
            ReceivedArcs::Received(_) if !rule.is_some_and(CutRule::expects_engagement_per_move) => {
                Err(RefusalCode::Value)
            }
            ReceivedArcs::None | ReceivedArcs::Received(_) => Ok(()),
        }
    }

    /// The arcs of the segment; `None` if none were sent or some were rejected.
    pub fn table(&self) -> Option<&EngagedTable> {
        match self {
            ReceivedArcs::Received(table) => Some(table),
            ReceivedArcs::None | ReceivedArcs::Refused => None,
        }
    }
}
