//! Encoding of a job as messages to the board: `Begin`, one message for each part, `Commit` with a checksum over them.

use arcfeed_model::cut::{ContourSide, CutRule, Moves, RotationCircle, Work};
use arcfeed_model::engaged::EngagedKnot;
use arcfeed_model::job::{FeedPolicy, Job, LawKind, SpeedSource, ToolAxis, ToolSetup};
use arcfeed_model::stock::{Stock, StockLine};
use arcfeed_model::tool::{Edge, Tool};
use arcfeed_nc::modal::Turn;
use arcfeed_units::{LengthUnit, Nm};

use super::codes::{AxisCode, LawCode, MovesCode, PolicyCode, StockCode, ToolCode, UnitCode, WorkCode};
use super::field::PAYLOAD_MAX;
use super::fixed::{Q40, Q46, Q62};
use super::table::{self, Message};

/// Reason why a job cannot be sent to a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParametersError {
    /// The job's feed mode is `rewrite-only`, for which no board is needed.
    Policy,
    /// A number of the job is NaN or too large.
    Number,
    /// The job does not fit into a page of flash.
    Large,
    /// The cut rule with this index expects its engaged arcs with each segment, which a board that only reads a serial
    /// line along does not get.
    EngagementPerMove(usize),
}

/// Running checksum of the messages of a job: CRC-32C over kind and payload of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SetSum {
    remainder: u32,
    messages: u16,
}

impl SetSum {
    /// Checksum before the first message.
    pub const NONE: SetSum = SetSum { remainder: u32::MAX, messages: 0 };

    /// Includes the next message in the checksum.
    pub fn add(&mut self, message: &Message) {
        let mut buffer = [0; PAYLOAD_MAX];
        let length = message.encode(&mut buffer).unwrap_or_default();
        self.byte(message.kind());
        buffer.iter().take(length).for_each(|byte| self.byte(*byte));
        self.messages = self.messages.saturating_add(1);
    }

    /// The message `Commit`, which ends the set of messages with this number.
    pub fn commit(&self, set: u32) -> table::Commit {
        table::Commit { set, messages: self.messages, checksum: !self.remainder }
    }

    /// Computed bit by bit without a table: a set has about a kilobyte and is sent once per job.
    fn byte(&mut self, byte: u8) {
        self.remainder ^= u32::from(byte);
        for _ in 0..u8::BITS {
            let carry = self.remainder & 1;
            self.remainder = (self.remainder >> 1) ^ (0x82F6_3B78 * carry);
        }
    }
}

/// Passes the messages that carry a job to `emit`, from `Begin` to `Commit`. `set` is their common number, chosen by
/// the caller: not 0, and not that of the previous set.
///
/// # Errors
/// See [`ParametersError`]; messages passed before an error are not a complete set.
pub fn messages(job: &Job, set: u32, emit: &mut dyn FnMut(Message)) -> Result<(), ParametersError> {
    emit(table::Begin { set }.into());
    let mut sum = SetSum::NONE;
    let mut part = |message: Message| {
        sum.add(&message);
        emit(message);
    };
    part(basics(job)?.into());
    part(limits(job)?.into());
    part(ceiling(job)?.into());
    machine(job, &mut part)?;
    for (travelled, feed) in job.knots.all() {
        part(table::Knot { travelled: q40(travelled.0)?, feed_per_tooth: q40(feed.0)? }.into());
    }
    let mut count = 0;
    for (index, setup) in (0..).zip(job.tools.iter()) {
        part(tool(setup)?.into());
        part(law(setup.law)?.into());
        for rule in job.rules.iter().filter(|rule| rule.tool == index) {
            cut_rule(count, rule, &mut part)?;
            count += 1;
        }
    }
    emit(sum.commit(set).into());
    Ok(())
}

fn basics(job: &Job) -> Result<table::Basics, ParametersError> {
    let policy = match job.policy {
        FeedPolicy::SafeBase => PolicyCode::SafeBase,
        FeedPolicy::OverrideOnly => PolicyCode::OverrideOnly,
        FeedPolicy::RewriteOnly(_) => return Err(ParametersError::Policy),
    };
    let unit = match job.unit {
        LengthUnit::Inch => UnitCode::Inch,
        LengthUnit::Mm => UnitCode::Mm,
    };
    Ok(table::Basics { unit, policy })
}

fn tool(setup: &ToolSetup) -> Result<table::Tool, ParametersError> {
    let (shape, outer_radius, inner_radius) = match &setup.tool {
        Tool::CupMill(mill) => (ToolCode::CupMill, mill.outer_radius, mill.inner_radius),
        Tool::EndMill(mill) => (ToolCode::EndMill, mill.radius, Nm(0)),
    };
    Ok(table::Tool {
        number: setup.number.map(|number| u32::try_from(number).map_err(|_| ParametersError::Number)).transpose()?,
        axis: match setup.axis {
            ToolAxis::X => AxisCode::X,
            ToolAxis::Y => AxisCode::Y,
            ToolAxis::Z => AxisCode::Z,
        },
        spindle: q40(setup.spindle.0)?,
        operator_speed: setup.speed_source == SpeedSource::Operator,
        feed_per_tooth: q40(setup.feed_per_tooth.0)?,
        shape,
        outer_radius: outer_radius.0,
        inner_radius: inner_radius.0,
        teeth: setup.tool.active_teeth(),
    })
}

fn law(law: LawKind) -> Result<table::Law, ParametersError> {
    let plain = |law| table::Law { law, option: false, floor: Q40(0) };
    Ok(match law {
        LawKind::Circumference => plain(LawCode::Circumference),
        LawKind::EngagedArc { both_edges } => table::Law { option: both_edges, ..plain(LawCode::EngagedArc) },
        LawKind::Contour { inside_only, floor_ratio } => {
            table::Law { law: LawCode::Contour, option: inside_only, floor: q40(floor_ratio)? }
        }
        LawKind::Engagement => plain(LawCode::Engagement),
        LawKind::Table => plain(LawCode::Table),
        LawKind::Programmed => plain(LawCode::Programmed),
    })
}

fn limits(job: &Job) -> Result<table::Limits, ParametersError> {
    let limits = &job.limits;
    Ok(table::Limits {
        min_percent: limits.min_percent,
        max_percent: limits.max_percent,
        step_percent: limits.step_percent,
        slew_up: q40(limits.slew_up_percent_per_s)?,
        slew_down: q40(limits.slew_down_percent_per_s)?,
    })
}

fn ceiling(job: &Job) -> Result<table::Ceiling, ParametersError> {
    Ok(table::Ceiling {
        max_feed: job.ceiling.max_feed.map(|feed| q40(feed.0)).transpose()?,
        max_raise: q40(job.ceiling.max_raise_ratio)?,
    })
}

fn machine(job: &Job, part: &mut dyn FnMut(Message)) -> Result<(), ParametersError> {
    let linear = job.machine.linear.map(|limit| limit.map(|limit| limit.0));
    let rotary = job.machine.rotary.map(|limit| limit.map(|limit| limit.0));
    if linear != [None; 3] || rotary != [None; 3] {
        part(table::Axes { linear: each(linear)?, rotary: each(rotary)? }.into());
    }
    if let Some(clamp) = job.machine.arc_clamp {
        let [feed, radius, floor] = [clamp.feed.0, clamp.radius.0, clamp.floor.0].map(q40);
        part(table::ArcClamp { feed: feed?, radius: radius?, floor: floor? }.into());
    }
    Ok(())
}

fn each(limits: [Option<f32>; 3]) -> Result<[Option<Q40>; 3], ParametersError> {
    let [a, b, c] = limits.map(|limit| limit.map(q40).transpose());
    Ok([a?, b?, c?])
}

fn cut_rule(index: u8, rule: &CutRule, part: &mut dyn FnMut(Message)) -> Result<(), ParametersError> {
    let (work, radial_depth, stock) = match &rule.work {
        Work::Ring(Edge::Outer, stock) => (WorkCode::RingOuter, Nm(0), Some(stock)),
        Work::Ring(Edge::Inner, stock) => (WorkCode::RingInner, Nm(0), Some(stock)),
        Work::Mill { side, radial_depth } => (mill_code(*side), *radial_depth, None),
    };
    let (code, stock_parts) = match stock {
        None => (StockCode::None, 0),
        Some(Stock::Convex(lines)) => (StockCode::Convex, lines.len() as u8),
        Some(Stock::Disc { .. }) => (StockCode::Disc, 1),
        Some(Stock::Engaged(engaged)) => (StockCode::Engaged, engaged.knots().len() as u8),
        Some(Stock::PerMove) => (StockCode::Along, 0),
    };
    let feed_per_tooth = rule.feed_per_tooth.map(|feed| q40(feed.0)).transpose()?;
    part(
        table::Rule {
            index,
            moves: moves_code(rule.moves),
            work,
            radial_depth: radial_depth.0,
            stock: code,
            stock_parts,
            feed_per_tooth,
            table: rule.table.map(|range| range.bounds()),
            sequence: rule.sequence.map(|(first, last)| [first, last]),
            level: rule.level.map(|(low, high)| [low.0, high.0]),
        }
        .into(),
    );
    stock.map_or(Ok(()), |stock| stock_of(stock, part))
}

fn stock_of(stock: &Stock, part: &mut dyn FnMut(Message)) -> Result<(), ParametersError> {
    match stock {
        Stock::Convex(lines) => lines.iter().try_for_each(|StockLine { normal: [x, y], offset_mm, rise_ratio }| {
            let normal = [q62(*x)?, q62(*y)?];
            part(table::StockLine { normal, offset: q46(*offset_mm)?, rise: q46(*rise_ratio)? }.into());
            Ok(())
        }),
        Stock::Disc { center_mm: [x, y], radius_mm } => {
            part(table::StockDisc { center: [q46(*x)?, q46(*y)?], radius: q46(*radius_mm)? }.into());
            Ok(())
        }
        Stock::Engaged(engaged) => engaged.knots().iter().try_for_each(|EngagedKnot { travelled, outer, inner }| {
            let travelled = q40(travelled.0)?;
            part(table::EngagedArcs { travelled, outer: outer.units(), inner: inner.units() }.into());
            Ok(())
        }),
        Stock::PerMove => Ok(()),
    }
}

const fn moves_code(moves: Moves) -> MovesCode {
    match moves {
        Moves::Rotations(RotationCircle::Interior, Turn::Cw) => MovesCode::InteriorCw,
        Moves::Rotations(RotationCircle::Interior, Turn::Ccw) => MovesCode::InteriorCcw,
        Moves::Rotations(RotationCircle::Exterior, Turn::Cw) => MovesCode::ExteriorCw,
        Moves::Rotations(RotationCircle::Exterior, Turn::Ccw) => MovesCode::ExteriorCcw,
        Moves::Arcs(Turn::Cw) => MovesCode::ArcsCw,
        Moves::Arcs(Turn::Ccw) => MovesCode::ArcsCcw,
        Moves::Lines => MovesCode::Lines,
    }
}

const fn mill_code(side: ContourSide) -> WorkCode {
    match side {
        ContourSide::Inside => WorkCode::MillInside,
        ContourSide::Outside => WorkCode::MillOutside,
        ContourSide::Slot => WorkCode::MillSlot,
    }
}

fn q40(value: f32) -> Result<Q40, ParametersError> {
    Q40::of(value).ok_or(ParametersError::Number)
}

fn q46(value: f64) -> Result<Q46, ParametersError> {
    Q46::of(value).ok_or(ParametersError::Number)
}

fn q62(value: f64) -> Result<Q62, ParametersError> {
    Q62::of(value).ok_or(ParametersError::Number)
}
