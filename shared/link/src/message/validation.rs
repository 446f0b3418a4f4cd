//! Validation of a job that was received instead of read from a file.

use arcfeed_model::cut::{CutRule, Work};
use arcfeed_model::job::{Job, LawKind, ToolSetup};
use arcfeed_model::knots::{Knot, TABLE_KNOTS_MAX};
use arcfeed_model::stock::{Stock, StockLine};
use arcfeed_model::tool::{Edge, Tool};
use arcfeed_units::{Mm, MmPerTooth, Nm};

/// Largest deviation of a unit normal's length from one.
const NORMAL_TOLERANCE: f64 = 1e-9;
/// Largest radius of a tool, nm: 10 m.
const RADIUS_MAX: i64 = 10_000_000_000;

/// Whether every number of a job is in the range that a job file allows. Range, step and slew rates of the override
/// are not checked here, but when the override's ramp is built from them.
pub fn is_valid(job: &Job) -> bool {
    job.tools.iter().all(|setup| is_valid_setup(setup) && (job.tools.len() == 1 || setup.number.is_some()))
        && has_valid_limits(job)
        && job.rules.iter().all(|rule| is_valid_rule(rule, job))
}

fn is_valid_setup(setup: &ToolSetup) -> bool {
    let law = match setup.law {
        LawKind::Contour { floor_ratio, .. } => (0.0..=1.0).contains(&floor_ratio),
        LawKind::Circumference => matches!(setup.tool, Tool::CupMill(_)),
        LawKind::EngagedArc { .. } | LawKind::Engagement | LawKind::Table | LawKind::Programmed => true,
    };
    law && is_positive(setup.spindle.0) && is_positive(setup.feed_per_tooth.0) && is_valid_tool(&setup.tool)
}

fn is_positive(number: f32) -> bool {
    number > 0.0 && number.is_finite()
}

fn is_valid_tool(tool: &Tool) -> bool {
    let is_radius = |radius: Nm| (1..=RADIUS_MAX).contains(&radius.0);
    let radii = match tool {
        Tool::CupMill(mill) => {
            is_radius(mill.inner_radius) && is_radius(mill.outer_radius) && mill.inner_radius < mill.outer_radius
        }
        Tool::EndMill(mill) => is_radius(mill.radius),
    };
    radii && tool.active_teeth() > 0
}

fn has_valid_limits(job: &Job) -> bool {
    let linear = job.machine.linear.iter().flatten().all(|limit| is_positive(limit.0));
    let rotary = job.machine.rotary.iter().flatten().all(|limit| is_positive(limit.0));
    let clamp = job
        .machine
        .arc_clamp
        .is_none_or(|clamp| is_positive(clamp.feed.0) && is_positive(clamp.radius.0) && clamp.floor.0 >= 0.0);
    let ceiling = job.ceiling.max_feed.is_none_or(|feed| is_positive(feed.0)) && job.ceiling.max_raise_ratio >= 1.0;
    linear && rotary && clamp && ceiling
}

fn is_valid_rule(rule: &CutRule, job: &Job) -> bool {
    let setup = job.tool_of(rule);
    let feed = rule.feed_per_tooth.is_none_or(|feed| is_positive(feed.0));
    let in_order =
        rule.sequence.is_none_or(|(first, last)| first <= last) && rule.level.is_none_or(|(low, high)| low <= high);
    let work = match (&rule.work, &setup.tool) {
        (Work::Ring(_, stock), Tool::CupMill(_)) | (Work::Ring(Edge::Outer, stock), Tool::EndMill(_)) => {
            is_valid_stock(stock)
        }
        (Work::Mill { radial_depth, .. }, Tool::EndMill(mill)) => {
            (0..=mill.radius.0.saturating_mul(2)).contains(&radial_depth.0)
        }
        (Work::Ring(Edge::Inner, _), Tool::EndMill(_)) | (Work::Mill { .. }, Tool::CupMill(_)) => false,
    };
    let table = rule.table.is_none_or(|range| {
        let knots = job.knots.table(range);
        let [_, count] = range.bounds();
        knots.len() == usize::from(count) && is_valid_table(knots)
    });
    feed && in_order && work && table && (setup.law != LawKind::Table || rule.table.is_some())
}

fn is_valid_stock(stock: &Stock) -> bool {
    match stock {
        Stock::Convex(lines) => lines.iter().all(|StockLine { normal: [x, y], .. }| {
            let excess = libm::hypot(*x, *y) - 1.0;
            libm::fabs(excess) <= NORMAL_TOLERANCE
        }),
        Stock::Disc { radius_mm, .. } => *radius_mm > 0.0,
        // Engagement tables are checked when they are created.
        Stock::Engaged(_) | Stock::PerMove => true,
    }
}

fn is_valid_table(knots: &[Knot]) -> bool {
    let feeds = knots.iter().all(|(_, MmPerTooth(feed))| is_positive(*feed));
    let paths = knots.is_sorted_by(|(Mm(before), _), (Mm(after), _)| before < after);
    feeds && paths && (1..=TABLE_KNOTS_MAX).contains(&knots.len())
}
