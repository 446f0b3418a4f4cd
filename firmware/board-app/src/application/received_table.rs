//! Table along a segment that the host sends before it, engaged arcs or feeds; see docs/protocol.md.
//!
//! An incomplete table would give a wrong law: a segment has all of its table, or it is rejected.

use arcfeed_law::move_table::MoveTable;
use arcfeed_law::table::{Table, TableError};
use arcfeed_link::message::codes::RefusalCode;
use arcfeed_link::message::moves::{decode_arcs, decode_feed};
use arcfeed_link::message::table::{SegmentArcs, SegmentFeed};
use arcfeed_model::cut::CutRule;
use arcfeed_model::engaged::{EngagedError, EngagedTable};

/// Table that the host has sent for the next segment: directions in which the edges are in material, or feeds.
#[derive(Debug)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to box into, and there is one of it")]
pub enum ReceivedTable {
    /// None was sent.
    None,
    /// The knots received so far, all of them valid.
    Received(MoveTable),
    /// At least one knot was rejected, so the segment will be rejected too.
    Refused,
}

impl ReceivedTable {
    /// Adds the engaged arcs of the next knot along the segment.
    ///
    /// # Errors
    /// Reason why the knot is rejected. Only the first rejection of a segment is reported.
    pub fn add_arcs(&mut self, arcs: &SegmentArcs) -> Result<(), RefusalCode> {
        let added = self.try_add_arcs(arcs);
        self.refused_with(added)
    }

    /// Adds the feed at the next knot along the segment.
    ///
    /// # Errors
    /// As of [`Self::add_arcs`].
    pub fn add_feed(&mut self, feed: &SegmentFeed) -> Result<(), RefusalCode> {
        let added = self.try_add_feed(feed);
        self.refused_with(added)
    }

    fn refused_with(&mut self, added: Result<(), RefusalCode>) -> Result<(), RefusalCode> {
        if added.is_err() {
            *self = ReceivedTable::Refused;
        }
        added
    }

    fn try_add_arcs(&mut self, arcs: &SegmentArcs) -> Result<(), RefusalCode> {
        let SegmentArcs { travelled, outer, inner } = *arcs;
        let knot = || decode_arcs(travelled, [outer, inner]).map_err(|_| RefusalCode::Value);
        let added = match self {
            ReceivedTable::None => EngagedTable::with_first(knot()?).map(|table| self.begin(MoveTable::Engaged(table))),
            ReceivedTable::Received(MoveTable::Engaged(table)) => table.push(knot()?),
            ReceivedTable::Received(MoveTable::Feeds(_)) => return Err(RefusalCode::Order),
            ReceivedTable::Refused => Ok(()),
        };
        added.map_err(|error| match error {
            EngagedError::Count => RefusalCode::Full,
            EngagedError::Order(_) => RefusalCode::Order,
        })
    }

    fn try_add_feed(&mut self, feed: &SegmentFeed) -> Result<(), RefusalCode> {
        let knot = decode_feed(feed);
        let added = match self {
            ReceivedTable::None => Table::with_first(knot).map(|table| self.begin(MoveTable::Feeds(table))),
            ReceivedTable::Received(MoveTable::Feeds(table)) => table.push(knot),
            ReceivedTable::Received(MoveTable::Engaged(_)) => return Err(RefusalCode::Order),
            ReceivedTable::Refused => Ok(()),
        };
        added.map_err(|error| match error {
            TableError::Count => RefusalCode::Full,
            TableError::Order(_) => RefusalCode::Order,
            TableError::Feed(_) => RefusalCode::Value,
        })
    }

    fn begin(&mut self, table: MoveTable) {
        *self = ReceivedTable::Received(table);
    }

    /// Checks that a segment under this rule may have this table: engaged arcs only if the rule expects them with each
    /// move, feeds only without a rule. It may also have none: then no law governs it, which is the host's decision.
    ///
    /// # Errors
    /// [`RefusalCode`] to be sent to the host.
    pub fn check_rule(&self, rule: Option<&CutRule>) -> Result<(), RefusalCode> {
        let fits = match self {
            ReceivedTable::Refused => return Err(RefusalCode::Incomplete),
            ReceivedTable::Received(MoveTable::Engaged(_)) => rule.is_some_and(CutRule::expects_engagement_per_move),
            ReceivedTable::Received(MoveTable::Feeds(_)) => rule.is_none(),
            ReceivedTable::None => true,
        };
        fits.then_some(()).ok_or(RefusalCode::Value)
    }

    /// The table of the segment; `None` if none was sent or a knot was rejected.
    pub fn table(&self) -> Option<&MoveTable> {
        match self {
            ReceivedTable::Received(table) => Some(table),
            ReceivedTable::None | ReceivedTable::Refused => None,
        }
    }
}
