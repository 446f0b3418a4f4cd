//! Tables of a cut rule that are given over the path along a move: engaged arcs and feeds per tooth.

use arcfeed_law::table::{Table, TableError};
use arcfeed_model::engaged::{ENGAGED_KNOTS_MAX, EngagedError, EngagedInterval, EngagedKnot, EngagedTable};
use arcfeed_model::job::LawKind;
use arcfeed_model::knots::{JOB_KNOTS_MAX, Knot, KnotRange, Knots, TABLE_KNOTS_MAX};
use arcfeed_model::stock::Stock;
use arcfeed_model::tool::Edge;
use arcfeed_units::{LengthUnit, Mm, MmPerTooth};
use toml::Spanned;

use super::schema::{CutTable, Quantity};
use super::{Complaint, at};

const GROWS: &str = "the path must grow from knot to knot";

/// Stock of a rule that gives the engaged arcs themselves; `edge` is the cutting circle of the rule's `side`. Fails at
/// the first faulty row.
pub fn engaged(
    rows: &Spanned<Vec<Spanned<Vec<Quantity>>>>,
    edge: Edge,
    unit: LengthUnit,
    law: LawKind,
) -> Result<Stock, Complaint> {
    let LawKind::EngagedArc { both_edges } = law else {
        return Err(at(rows, "`engaged` is for the engaged-arc law; give this law a line"));
    };
    let mut knots = Vec::new();
    for row in rows.as_ref() {
        knots.push(engaged_knot(row, edge, unit, both_edges)?);
    }
    EngagedTable::new(&knots).map(Stock::Engaged).map_err(|error| match error {
        EngagedError::Count => at(rows, &format!("a table of engaged arcs has 1 to {ENGAGED_KNOTS_MAX} knots")),
        EngagedError::Order(index) => at_row(rows, index, GROWS),
    })
}

fn engaged_knot(
    row: &Spanned<Vec<Quantity>>,
    edge: Edge,
    unit: LengthUnit,
    both_edges: bool,
) -> Result<EngagedKnot, Complaint> {
    let interval = |from: &Quantity, to: &Quantity| {
        let degrees = from.bare().zip(to.bare());
        degrees.and_then(|(from, to)| EngagedInterval::from_degrees(from, to)).ok_or_else(|| {
            at(row, "from and to are degrees between -360 and 360, without a unit, `to` at most 360 above `from`")
        })
    };
    let (path, own, other) = match row.as_ref().as_slice() {
        [path, from, to, other_from, other_to] => (path, interval(from, to)?, interval(other_from, other_to)?),
        [path, from, to] if !both_edges => (path, interval(from, to)?, EngagedInterval::EMPTY),
        _ if both_edges => {
            return Err(at(
                row,
                "a knot is [path, from, to, from, to]: where the circle of this rule's side is engaged, then the other \
                 one; or [path, from, to] with [law] edges = \"side\"",
            ));
        }
        _ => return Err(at(row, "a knot is [path, from, to]: where the circle of this rule's side is engaged")),
    };
    let travelled = Mm(path.to_mm(unit) as f32);
    Ok(match edge {
        Edge::Outer => EngagedKnot { travelled, outer: own, inner: other },
        Edge::Inner => EngagedKnot { travelled, outer: other, inner: own },
    })
}

/// Feeds per tooth that a rule gives as a table, added to the knots of the job; `None` if the law needs no table.
pub fn feeds(
    cut: &Spanned<CutTable>,
    unit: LengthUnit,
    law: LawKind,
    knots: &mut Knots,
) -> Result<Option<KnotRange>, Complaint> {
    let rows = match (&cut.as_ref().table, law) {
        (None, LawKind::Table) => {
            return Err(at(cut, "the table law needs table = [[path, feed_per_tooth], ...] in every rule"));
        }
        (None, _) => return Ok(None),
        (Some(rows), LawKind::Table) => rows,
        (Some(rows), _) => return Err(at(rows, "`table` is for the table law; remove it, or write kind = \"table\"")),
    };
    let mm = |quantity: &Quantity| quantity.to_mm(unit) as f32;
    let table = rows.as_ref().iter().map(|row| {
        let [path, feed] = row.as_ref();
        (Mm(mm(path)), MmPerTooth(mm(feed)))
    });
    let table: Vec<Knot> = table.collect();
    Table::new(&table).map_err(|error| match error {
        TableError::Count => at(rows, &format!("a table has 1 to {TABLE_KNOTS_MAX} knots")),
        TableError::Order(index) => at_row(rows, index, GROWS),
        TableError::Feed(index) => at_row(rows, index, "the feed per tooth must be positive"),
    })?;
    let room = knots.add(&table).map(Some);
    room.ok_or_else(|| at(rows, &format!("all tables of a job together have at most {JOB_KNOTS_MAX} knots")))
}

fn at_row<T>(rows: &Spanned<Vec<Spanned<T>>>, index: usize, message: &str) -> Complaint {
    rows.as_ref().get(index).map_or_else(|| at(rows, message), |row| at(row, message))
}
