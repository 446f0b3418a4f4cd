//! `[[cut]]`: which moves, and what they cut.

use arcfeed_shared::cut::{CutRule, Moves, RULES_MAX, Rotation, Side, Work};
use arcfeed_shared::nc::modal::Turn;
use arcfeed_shared::stock::{EDGES_MAX, Stock, StockLine};
use arcfeed_shared::tool::{Edge, Tool};
use arcfeed_shared::units::{LengthUnit, MmPerTooth, Nm};
use toml::Spanned;

use super::schema::{CutTable, DirectionWord, MovesWord, Quantity, RotationWord, SideWord, StockTable};
use super::{Complaint, at, length_mm};

/// Checks the rules of a job, in order.
pub fn build(
    cuts: &[Spanned<CutTable>],
    unit: LengthUnit,
    tool: &Tool,
) -> Result<heapless::Vec<CutRule, RULES_MAX>, Complaint> {
    let mut rules = heapless::Vec::new();
    for cut in cuts {
        let rule = match tool {
            Tool::CupMill(_) => ring_rule(cut, unit)?,
            Tool::EndMill(_) => mill_rule(cut, unit)?,
        };
        rules.push(rule).map_err(|_| at(cut, &format!("more than {RULES_MAX} cut rules")))?;
    }
    Ok(rules)
}

fn ring_rule(cut: &Spanned<CutTable>, unit: LengthUnit) -> Result<CutRule, Complaint> {
    let table = cut.as_ref();
    let needs = "a cup-mill's rule has rotation, direction, side = \"outer\" or \"inner\", and stock";
    let CutTable { rotation: Some(rotation), direction: Some(direction), stock: Some(stock), .. } = table else {
        return Err(at(cut, needs));
    };
    let edge = match table.side.as_ref() {
        SideWord::Outer => Edge::Outer,
        SideWord::Inner => Edge::Inner,
        SideWord::Inside | SideWord::Outside | SideWord::Slot => return Err(at(&table.side, needs)),
    };
    if table.moves.is_some() || table.radial_depth.is_some() {
        return Err(at(cut, needs));
    }
    let rotation = match rotation {
        RotationWord::Interior => Rotation::Interior,
        RotationWord::Exterior => Rotation::Exterior,
    };
    let moves = Moves::Rotations(rotation, turn(*direction));
    restricted(moves, Work::Ring(edge, build_stock(stock, unit)?), table, unit)
}

fn mill_rule(cut: &Spanned<CutTable>, unit: LengthUnit) -> Result<CutRule, Complaint> {
    let table = cut.as_ref();
    let needs = "an end-mill's rule has moves = \"arcs\" (with direction) or \"lines\", side = \"inside\", \"outside\" or \
                 \"slot\", and radial_depth (but for a slot)";
    let moves = match (table.moves, table.direction) {
        (Some(MovesWord::Arcs), Some(direction)) => Moves::Arcs(turn(direction)),
        (Some(MovesWord::Lines), None) => Moves::Lines,
        _ => return Err(at(cut, needs)),
    };
    if table.rotation.is_some() || table.stock.is_some() {
        return Err(at(cut, needs));
    }
    let (side, radial_depth) = match (table.side.as_ref(), &table.radial_depth) {
        (SideWord::Inside, Some(depth)) => (Side::Inside, Nm::from_mm(length_mm(depth, unit, "radial_depth")?)),
        (SideWord::Outside, Some(depth)) => (Side::Outside, Nm::from_mm(length_mm(depth, unit, "radial_depth")?)),
        (SideWord::Slot, None) => (Side::Slot, Nm(0)),
        _ => return Err(at(&table.side, needs)),
    };
    restricted(moves, Work::Mill { side, radial_depth }, table, unit)
}

fn restricted(moves: Moves, work: Work, table: &CutTable, unit: LengthUnit) -> Result<CutRule, Complaint> {
    let sequence = table.n.as_ref().map(|range| {
        let [first, last] = *range.as_ref();
        (first, last)
    });
    let level = match &table.z {
        None => None,
        Some(levels) => {
            let [low, high] = levels.as_ref().each_ref().map(|level| Nm::from_mm(level.to_mm(unit)));
            if low > high {
                return Err(at(levels, "the lower level comes first"));
            }
            Some((low, high))
        }
    };
    let feed_mm = table.feed_per_tooth.as_ref().map(|feed| length_mm(feed, unit, "feed_per_tooth")).transpose()?;
    Ok(CutRule { moves, work, feed_per_tooth: feed_mm.map(|mm| MmPerTooth(mm as f32)), sequence, level })
}

fn turn(direction: DirectionWord) -> Turn {
    match direction {
        DirectionWord::Cw => Turn::Cw,
        DirectionWord::Ccw => Turn::Ccw,
    }
}

fn build_stock(stock: &Spanned<StockTable>, unit: LengthUnit) -> Result<Stock, Complaint> {
    let mm = |quantity: &Quantity| quantity.to_mm(unit);
    match stock.as_ref() {
        StockTable {
            normal_deg: Some(normal_deg),
            offset: Some(offset),
            from: None,
            to: None,
            polygon: None,
            disc: None,
        } => Ok(Stock::half_plane(StockLine::from_angle(*normal_deg, mm(offset)))),
        StockTable { normal_deg: None, offset: None, from: Some(from), to: Some(to), polygon: None, disc: None } => {
            let line = line_through(from.each_ref().map(mm), to.each_ref().map(mm));
            line.map(Stock::half_plane).ok_or_else(|| at(stock, "`from` and `to` are the same point"))
        }
        StockTable { normal_deg: None, offset: None, from: None, to: None, polygon: Some(corners), disc: None } => {
            let corners: Vec<[f64; 2]> = corners.iter().map(|corner| corner.each_ref().map(mm)).collect();
            let message = format!("a stock polygon must be convex and have 3 to {EDGES_MAX} corners");
            Stock::polygon(&corners).ok_or_else(|| at(stock, &message))
        }
        StockTable { normal_deg: None, offset: None, from: None, to: None, polygon: None, disc: Some(disc) } => {
            let [x, y, radius_mm] = disc.each_ref().map(mm);
            let disc = Stock::Disc { center_mm: [x, y], radius_mm };
            if radius_mm > 0.0 { Ok(disc) } else { Err(at(stock, "a disc is [x, y, radius], its radius positive")) }
        }
        _ => Err(at(
            stock,
            "give the stock as { normal_deg, offset }, { from = [x, y], to = [x, y] }, { polygon = [[x, y], ...] } or \
             { disc = [x, y, radius] }",
        )),
    }
}

/// The line through two points, with the material on the left of the way from one to the other.
fn line_through([x, y]: [f64; 2], [to_x, to_y]: [f64; 2]) -> Option<StockLine> {
    let (dx, dy) = (to_x - x, to_y - y);
    let length = libm::hypot(dx, dy);
    let normal = [dy / length, -dx / length];
    (length > 0.0).then(|| StockLine { normal, offset_mm: normal[0] * x + normal[1] * y })
}
