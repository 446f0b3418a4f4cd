//! `[[cut]]`, the cut rules: the moves to which a law applies, and the stock there.

use arcfeed_model::cut::{ContourSide, CutRule, Moves, RULES_MAX, RotationCircle, Work};
use arcfeed_model::job::{LawKind, Tools};
use arcfeed_model::knots::Knots;
use arcfeed_model::stock::{EDGES_MAX, Stock, StockLine};
use arcfeed_model::tool::{Edge, Tool};
use arcfeed_nc::modal::Turn;
use arcfeed_units::{LengthUnit, MmPerTooth, Nm};
use toml::Spanned;

use super::schema::{CutTable, DirectionWord, JobTable, MovesWord, Quantity, RotationWord, SideWord, StockTable};
use super::{Complaint, RuleContext, at, length_mm, tables};

/// Largest sequence number: eight digits.
const SEQUENCE_MAX: i64 = 99_999_999;

/// Name of the engagement map in the job, if rules or the plunge law use one; fails if they name different ones.
pub fn map(job: &JobTable) -> Result<Option<&Spanned<String>>, Complaint> {
    let of_rules = tables(job).filter_map(|(_, cut)| cut.as_ref().stock.as_ref()?.as_ref().map.as_ref());
    let mut named = of_rules.chain(job.plunge.as_ref().map(|plunge| &plunge.as_ref().map));
    let Some(first) = named.next() else { return Ok(None) };
    match named.find(|other| other.as_ref() != first.as_ref()) {
        None => Ok(Some(first)),
        Some(other) => Err(at(other, &format!("one map is for all rules of a job: write \"{}\"", first.as_ref()))),
    }
}

/// Cut rules of a job with the index of their tool: first those of each tool, then those of the job, which belong to
/// its only tool.
pub fn tables(job: &JobTable) -> impl Iterator<Item = (u8, &Spanned<CutTable>)> {
    let of_tools = (0..).zip(&job.tool.0).flat_map(|(place, tool)| tool.cut.iter().map(move |cut| (place, cut)));
    of_tools.chain(job.cut.iter().map(|cut| (0, cut)))
}

/// Checks the cut rules of a job and converts them, in their order, with the knots of their tables; fails at the first
/// faulty value.
pub fn build(job: &JobTable, tools: &Tools) -> Result<(heapless::Vec<CutRule, RULES_MAX>, Knots), Complaint> {
    if let Some(cut) = job.cut.first().filter(|_| tools.len() > 1) {
        return Err(at(cut, "with several [[tool]]s each rule stands below its tool: write [[tool.cut]]"));
    }
    let (mut rules, mut knots) = (heapless::Vec::new(), Knots::default());
    for (place, cut) in tables(job) {
        let setup = tools.get(usize::from(place)).unwrap_or(tools.first());
        let around = &RuleContext { unit: job.units.into(), tool: &setup.tool, law: setup.law };
        let rule = match around.tool {
            Tool::CupMill(_) => ring_rule(cut, around)?,
            Tool::EndMill(_) => match around.law {
                LawKind::EngagedArc { .. } => circle_rule(cut, around)?,
                _ => mill_rule(cut, around)?,
            },
        };
        let table = tables::feeds(cut, around.unit, around.law, &mut knots)?;
        rules
            .push(CutRule { tool: place, table, ..rule })
            .map_err(|_| at(cut, &format!("more than {RULES_MAX} cut rules")))?;
    }
    Ok((rules, knots))
}

fn ring_rule(cut: &Spanned<CutTable>, around: &RuleContext<'_>) -> Result<CutRule, Complaint> {
    let table = cut.as_ref();
    let needs = "a cup-mill's rule has rotation, direction, side = \"outer\" or \"inner\", and stock";
    let CutTable { rotation: Some(rotation), direction: Some(direction), .. } = table else {
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
        RotationWord::Interior => RotationCircle::Interior,
        RotationWord::Exterior => RotationCircle::Exterior,
    };
    let moves = Moves::Rotations(rotation, turn(*direction));
    let stock = match (&table.stock, around.law) {
        (Some(stock), _) => build_stock(stock, edge, around)?,
        // The side of the rule needs no knots.
        (None, LawKind::Table) => Stock::everywhere(),
        (None, _) => return Err(at(cut, needs)),
    };
    restricted(moves, Work::Ring(edge, stock), table, around.unit)
}

/// Rule of an end mill, seen as one cutting circle.
fn circle_rule(cut: &Spanned<CutTable>, around: &RuleContext<'_>) -> Result<CutRule, Complaint> {
    let table = cut.as_ref();
    let needs = "an end-mill's rule under engaged-arc has moves = \"arcs\" (with direction) or \"lines\", side = \"outer\", \
                 and stock";
    let moves = mill_moves(table).ok_or_else(|| at(cut, needs))?;
    let Some(stock) = &table.stock else { return Err(at(cut, needs)) };
    if table.rotation.is_some() || table.radial_depth.is_some() || !matches!(table.side.as_ref(), SideWord::Outer) {
        return Err(at(cut, needs));
    }
    let work = Work::Ring(Edge::Outer, build_stock(stock, Edge::Outer, around)?);
    restricted(moves, work, table, around.unit)
}

fn mill_moves(table: &CutTable) -> Option<Moves> {
    match (table.moves, table.direction) {
        (Some(MovesWord::Arcs), Some(direction)) => Some(Moves::Arcs(turn(direction))),
        (Some(MovesWord::Lines), None) => Some(Moves::Lines),
        _ => None,
    }
}

fn mill_rule(cut: &Spanned<CutTable>, around: &RuleContext<'_>) -> Result<CutRule, Complaint> {
    let (table, unit) = (cut.as_ref(), around.unit);
    let needs = "an end-mill's rule has moves = \"arcs\" (with direction) or \"lines\", side = \"inside\", \"outside\" or \
                 \"slot\", and radial_depth (but for a slot, and for the contour law)";
    let is_contour = matches!(around.law, LawKind::Contour { .. });
    let moves = mill_moves(table).ok_or_else(|| at(cut, needs))?;
    if table.rotation.is_some() || table.stock.is_some() {
        return Err(at(cut, needs));
    }
    let (side, radial_depth) = match (table.side.as_ref(), &table.radial_depth) {
        (SideWord::Inside, Some(depth)) => (ContourSide::Inside, Nm::from_mm(length_mm(depth, unit, "radial_depth")?)),
        (SideWord::Outside, Some(depth)) => {
            (ContourSide::Outside, Nm::from_mm(length_mm(depth, unit, "radial_depth")?))
        }
        (SideWord::Slot, None) => (ContourSide::Slot, Nm(0)),
        (SideWord::Inside, None) if is_contour => (ContourSide::Inside, Nm(0)),
        (SideWord::Outside, None) if is_contour => (ContourSide::Outside, Nm(0)),
        _ => return Err(at(&table.side, needs)),
    };
    restricted(moves, Work::Mill { side, radial_depth }, table, unit)
}

fn restricted(moves: Moves, work: Work, table: &CutTable, unit: LengthUnit) -> Result<CutRule, Complaint> {
    let sequence = match table.n.as_ref().map(|range| (range, *range.as_ref())) {
        Some((range, [first, last])) if !(0 <= first && first <= last && last <= SEQUENCE_MAX) => {
            let message = format!(
                "n is the first and the last sequence number, from 0 to {SEQUENCE_MAX}: the lower one comes first"
            );
            return Err(at(range, &message));
        }
        given => given.map(|(_, [first, last])| (first, last)),
    };
    let level = match &table.z {
        None => None,
        Some(levels) => {
            let [low, high] = levels.as_ref().each_ref().map(|level| Nm::from_mm(level.to_mm(unit)));
            if low > high {
                return Err(at(levels, "z is the lowest and the highest level: the lower one comes first"));
            }
            Some((low, high))
        }
    };
    let feed_mm = table.feed_per_tooth.as_ref().map(|feed| length_mm(feed, unit, "feed_per_tooth")).transpose()?;
    let feed_per_tooth = feed_mm.map(|mm| MmPerTooth(mm as f32));
    Ok(CutRule { tool: 0, moves, work, feed_per_tooth, table: None, sequence, level })
}

fn turn(direction: DirectionWord) -> Turn {
    match direction {
        DirectionWord::Cw => Turn::Cw,
        DirectionWord::Ccw => Turn::Ccw,
    }
}

fn build_stock(stock: &Spanned<StockTable>, edge: Edge, around: &RuleContext<'_>) -> Result<Stock, Complaint> {
    let mm = |quantity: &Quantity| quantity.to_mm(around.unit);
    let StockTable { normal_deg, offset, from, to, rise, lines, polygon, disc, engaged, map } = stock.as_ref();
    let half_plane = |line| Stock::half_plane(StockLine { rise_ratio: rise.unwrap_or(0.0), ..line });
    let is_line = normal_deg.is_some() || from.is_some();
    if rise.is_some() && !is_line {
        return Err(at(
            stock,
            "`rise` is how much the offset of a line grows per unit of height, and goes with a line only",
        ));
    }
    match (normal_deg, offset, from, to, lines, polygon, disc, engaged, map) {
        (Some(normal_deg), Some(offset), None, None, None, None, None, None, None) => {
            Ok(half_plane(StockLine::from_angle(*normal_deg, mm(offset))))
        }
        (None, None, Some(from), Some(to), None, None, None, None, None) => {
            let line = line_through(from.each_ref().map(mm), to.each_ref().map(mm));
            line.map(half_plane).ok_or_else(|| at(stock, "`from` and `to` are the same point"))
        }
        (None, None, None, None, Some(lines), None, None, None, None) => {
            let line = |(normal_deg, offset, rise): &(f64, Quantity, f64)| StockLine {
                rise_ratio: *rise,
                ..StockLine::from_angle(*normal_deg, mm(offset))
            };
            let message =
                format!("`lines` are 1 to {EDGES_MAX} of [normal_deg, offset, rise]; the stock is inside of all");
            if !(1..=EDGES_MAX).contains(&lines.len()) {
                return Err(at(stock, &message));
            }
            Ok(Stock::Convex(lines.iter().map(line).collect()))
        }
        (None, None, None, None, None, Some(corners), None, None, None) => {
            let corners: Vec<[f64; 2]> = corners.iter().map(|corner| corner.each_ref().map(mm)).collect();
            let message = format!("a stock polygon must be convex and have 3 to {EDGES_MAX} corners");
            Stock::polygon(&corners).ok_or_else(|| at(stock, &message))
        }
        (None, None, None, None, None, None, Some(disc), None, None) => {
            let [x, y, radius_mm] = disc.each_ref().map(mm);
            let disc = Stock::Disc { center_mm: [x, y], radius_mm };
            if radius_mm > 0.0 { Ok(disc) } else { Err(at(stock, "a disc is [x, y, radius], its radius positive")) }
        }
        (None, None, None, None, None, None, None, Some(rows), None) => {
            tables::engaged(rows, edge, around.unit, around.law)
        }
        (None, None, None, None, None, None, None, None, Some(map)) => match around.law {
            LawKind::EngagedArc { .. } => Ok(Stock::PerMove),
            _ => Err(at(map, "`map` is for the engaged-arc law; give this law a line")),
        },
        _ => Err(at(
            stock,
            "give the stock as { normal_deg, offset } or { from = [x, y], to = [x, y] } (both may have a rise), { lines = [[normal_deg, offset, rise], ...] }, \
             { polygon = [[x, y], ...] }, \
             { disc = [x, y, radius] }, { engaged = [[path, from_deg, to_deg], ...] } or { map = FILE }",
        )),
    }
}

/// Line through two points, with the material on its left.
fn line_through([x, y]: [f64; 2], [to_x, to_y]: [f64; 2]) -> Option<StockLine> {
    let (dx, dy) = (to_x - x, to_y - y);
    let length = libm::hypot(dx, dy);
    let normal = [dy / length, -dx / length];
    (length > 0.0).then(|| StockLine { normal, offset_mm: normal[0] * x + normal[1] * y, rise_ratio: 0.0 })
}
