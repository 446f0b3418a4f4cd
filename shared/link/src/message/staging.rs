//! Receiver of a job that arrives as a set of messages: the job takes effect only if the set is complete, has the
//! right checksum, and is valid.

use heapless::Vec;

use arcfeed_model::cut::{ContourSide, CutRule, Moves, RotationCircle, Work};
use arcfeed_model::engaged::{EngagedError, EngagedTable};
use arcfeed_model::job::{FeedCeiling, FeedPolicy, Job, LawKind, OverrideLimits, ToolSetup, Tools};
use arcfeed_model::knots::{KnotRange, Knots};
use arcfeed_model::machine::{self, MachineLimits};
use arcfeed_model::stock::{Stock, StockLine};
use arcfeed_model::tool::{Edge, EndMill, Tool};
use arcfeed_nc::modal::Turn;
use arcfeed_units::{DegPerMin, LengthUnit, Mm, MmPerMin, MmPerTooth, Nm, RevPerMin};

use super::codes::{MovesCode, PolicyCode, RefusalCode, StockCode, UnitCode, WorkCode};
use super::moves::decode_arcs;
use super::parameters::SetSum;
use super::table::{self, Message};
use super::tools;
use super::validation;

/// Bits of the messages that a complete set must contain besides its tools: basics, limits and ceiling.
const NEEDED: u8 = 0b00111;

/// Receiver of a job that arrives as a set of messages. The job takes effect only after the last of them, if it is
/// complete and valid.
#[derive(Clone, Debug)]
pub struct Staging {
    /// 0: none, or a rejected one.
    set: u32,
    job: Job,
    sum: SetSum,
    /// Received messages of the kinds that occur once, a bit each.
    seen: u8,
    /// Number of tools received.
    tools: u8,
    /// Whether the law of the last tool is still missing.
    awaits_law: bool,
    /// Description of the stock of the last rule, and the number of messages that are still missing.
    due: (StockCode, u8),
}

impl Default for Staging {
    fn default() -> Self {
        Staging::new()
    }
}

impl Staging {
    /// Receiver without a set.
    pub const fn new() -> Self {
        Staging {
            set: 0,
            job: empty_job(),
            sum: SetSum::NONE,
            seen: 0,
            tools: 0,
            awaits_law: false,
            due: (StockCode::None, 0),
        }
    }

    /// Number of the set that is being received; 0 for none.
    pub fn set(&self) -> u32 {
        self.set
    }

    /// Discards the set that is being received.
    pub fn forget(&mut self) {
        self.set = 0;
    }

    /// Begins to receive the set with this number; a set that is not complete is discarded.
    ///
    /// # Errors
    /// [`RefusalCode::Value`] for the number 0, which stands for no set.
    pub fn begin(&mut self, set: u32) -> Result<(), RefusalCode> {
        // In place: the job is too large for a second copy.
        self.job.rules.clear();
        self.job.knots = Knots::new();
        self.job.machine = MachineLimits::default();
        (self.set, self.sum, self.seen, self.due) = (set, SetSum::NONE, 0, (StockCode::None, 0));
        (self.tools, self.awaits_law) = (0, false);
        if set == 0 { Err(RefusalCode::Value) } else { Ok(()) }
    }

    /// Adds a message to the set. After an error, the set is discarded.
    ///
    /// # Errors
    /// Reason why the message cannot belong to a valid set.
    pub fn add(&mut self, message: &Message) -> Result<(), RefusalCode> {
        if self.set == 0 {
            return Err(RefusalCode::NoSet);
        }
        self.sum.add(message);
        let taken = self.part(message);
        if taken.is_err() {
            self.forget();
        }
        taken
    }

    /// Ends the set, and returns its job if it is complete and valid. After this call no set is being received.
    ///
    /// # Errors
    /// Reason why it is not a complete and valid set.
    pub fn commit(&mut self, commit: &table::Commit) -> Result<&Job, RefusalCode> {
        let set = core::mem::take(&mut self.set);
        if set == 0 || set != commit.set {
            Err(RefusalCode::NoSet)
        } else if self.sum.commit(set) != *commit {
            Err(RefusalCode::Checksum)
        } else if self.seen & NEEDED != NEEDED || self.tools == 0 || self.awaits_law || self.due.1 > 0 {
            Err(RefusalCode::Incomplete)
        } else if !validation::is_valid(&self.job) {
            Err(RefusalCode::Value)
        } else {
            Ok(&self.job)
        }
    }

    /// Exchanges the job of the last committed set with this one. A job is too large to be returned by value.
    pub fn swap_job(&mut self, job: &mut Job) {
        core::mem::swap(&mut self.job, job);
    }

    fn part(&mut self, message: &Message) -> Result<(), RefusalCode> {
        match message {
            Message::StockLine(line) => return self.stock_line(line),
            Message::StockDisc(disc) => return self.stock_disc(disc),
            Message::EngagedArcs(arcs) => return self.engaged_arcs(arcs),
            _ if self.due.1 > 0 => return Err(RefusalCode::Incomplete),
            Message::Law(law) => return self.law(law),
            _ if self.awaits_law => return Err(RefusalCode::Incomplete),
            Message::Tool(tool) => return self.tool(tool),
            Message::Rule(rule) => return self.rule(rule),
            Message::Knot(knot) => {
                let knot = (Mm(knot.travelled.value()), MmPerTooth(knot.feed_per_tooth.value()));
                return self.job.knots.add(&[knot]).map(|_| ()).ok_or(RefusalCode::Full);
            }
            _ => {}
        }
        let place = match message {
            Message::Basics(basics) => self.basics(basics),
            Message::Limits(limits) => self.limits(limits),
            Message::Ceiling(ceiling) => self.ceiling(ceiling),
            Message::Axes(axes) => self.axes(axes),
            Message::ArcClamp(clamp) => self.arc_clamp(clamp),
            _ => return Err(RefusalCode::Message),
        };
        let bit = 1 << place;
        if self.seen & bit != 0 {
            return Err(RefusalCode::Incomplete);
        }
        self.seen |= bit;
        Ok(())
    }

    fn basics(&mut self, basics: &table::Basics) -> u8 {
        self.job.unit = match basics.unit {
            UnitCode::Inch => LengthUnit::Inch,
            UnitCode::Mm => LengthUnit::Mm,
        };
        self.job.policy = match basics.policy {
            PolicyCode::SafeBase => FeedPolicy::SafeBase,
            PolicyCode::OverrideOnly => FeedPolicy::OverrideOnly,
        };
        0
    }

    fn tool(&mut self, tool: &table::Tool) -> Result<(), RefusalCode> {
        let setup = tools::setup(tool);
        if self.tools == 0 {
            self.job.tools = Tools::one(setup);
        } else {
            self.job.tools.push(setup).map_err(|_| RefusalCode::Full)?;
        }
        self.tools += 1;
        self.awaits_law = true;
        Ok(())
    }

    fn law(&mut self, law: &table::Law) -> Result<(), RefusalCode> {
        if !core::mem::take(&mut self.awaits_law) {
            return Err(RefusalCode::Incomplete);
        }
        self.job.tools.last_mut().law = tools::law(law);
        Ok(())
    }

    fn limits(&mut self, limits: &table::Limits) -> u8 {
        self.job.limits = OverrideLimits {
            min_percent: limits.min_percent,
            max_percent: limits.max_percent,
            step_percent: limits.step_percent,
            slew_up_percent_per_s: limits.slew_up.value(),
            slew_down_percent_per_s: limits.slew_down.value(),
        };
        1
    }

    fn axes(&mut self, axes: &table::Axes) -> u8 {
        self.job.machine.linear = axes.linear.map(|limit| limit.map(|limit| MmPerMin(limit.value())));
        self.job.machine.rotary = axes.rotary.map(|limit| limit.map(|limit| DegPerMin(limit.value())));
        3
    }

    fn arc_clamp(&mut self, clamp: &table::ArcClamp) -> u8 {
        let table::ArcClamp { feed, radius, floor } = clamp;
        self.job.machine.arc_clamp = Some(machine::ArcClamp {
            feed: MmPerMin(feed.value()),
            radius: Mm(radius.value()),
            floor: MmPerMin(floor.value()),
        });
        4
    }

    fn ceiling(&mut self, ceiling: &table::Ceiling) -> u8 {
        self.job.ceiling = FeedCeiling {
            max_feed: ceiling.max_feed.map(|feed| MmPerMin(feed.value())),
            max_raise_ratio: ceiling.max_raise.value(),
        };
        2
    }

    fn rule(&mut self, rule: &table::Rule) -> Result<(), RefusalCode> {
        if usize::from(rule.index) != self.job.rules.len() {
            return Err(RefusalCode::Order);
        }
        let tool = self.tools.checked_sub(1).ok_or(RefusalCode::Order)?;
        let is_due = match rule.stock {
            StockCode::None | StockCode::Along => rule.stock_parts == 0,
            StockCode::Disc => rule.stock_parts == 1,
            StockCode::Convex => true,
            StockCode::Engaged => rule.stock_parts > 0,
        };
        if !is_due {
            return Err(RefusalCode::Value);
        }
        let cut = CutRule {
            tool,
            moves: moves(rule.moves),
            work: work(rule)?,
            feed_per_tooth: rule.feed_per_tooth.map(|feed| MmPerTooth(feed.value())),
            table: rule.table.map(|[first, count]| KnotRange::new(first, count)),
            sequence: rule.sequence.map(|[first, last]| (first, last)),
            level: rule.level.map(|[low, high]| (Nm(low), Nm(high))),
        };
        self.job.rules.push(cut).map_err(|_| RefusalCode::Full)?;
        self.due = (rule.stock, rule.stock_parts);
        Ok(())
    }

    /// The stock to which a message belongs; counts the message.
    fn stock(&mut self, code: StockCode) -> Result<&mut Stock, RefusalCode> {
        let (due, parts) = &mut self.due;
        *parts = if *due == code { parts.checked_sub(1).ok_or(RefusalCode::Order)? } else { 0 };
        match self.job.rules.last_mut().map(|rule| &mut rule.work) {
            Some(Work::Ring(_, stock)) if *due == code => Ok(stock),
            _ => Err(RefusalCode::Order),
        }
    }

    fn stock_line(&mut self, line: &table::StockLine) -> Result<(), RefusalCode> {
        let line = StockLine {
            normal: line.normal.map(|part| part.value()),
            offset_mm: line.offset.value(),
            rise_ratio: line.rise.value(),
        };
        match self.stock(StockCode::Convex)? {
            Stock::Convex(lines) => lines.push(line).map_err(|_| RefusalCode::Full),
            Stock::Disc { .. } | Stock::Engaged(_) | Stock::PerMove => Err(RefusalCode::Order),
        }
    }

    fn stock_disc(&mut self, disc: &table::StockDisc) -> Result<(), RefusalCode> {
        let (center_mm, radius_mm) = (disc.center.map(|at| at.value()), disc.radius.value());
        *self.stock(StockCode::Disc)? = Stock::Disc { center_mm, radius_mm };
        Ok(())
    }

    fn engaged_arcs(&mut self, arcs: &table::EngagedArcs) -> Result<(), RefusalCode> {
        let table::EngagedArcs { travelled, outer, inner } = *arcs;
        let knot = decode_arcs(travelled, [outer, inner]).map_err(|_| RefusalCode::Value)?;
        let taken = match self.stock(StockCode::Engaged)? {
            Stock::Engaged(table) => table.push(knot),
            stock => EngagedTable::with_first(knot).map(|table| *stock = Stock::Engaged(table)),
        };
        taken.map_err(|error| match error {
            EngagedError::Count => RefusalCode::Full,
            EngagedError::Order(_) => RefusalCode::Value,
        })
    }
}

fn work(rule: &table::Rule) -> Result<Work, RefusalCode> {
    let mill = |side| Work::Mill { side, radial_depth: Nm(rule.radial_depth) };
    let ring = |edge| Work::Ring(edge, Stock::everywhere());
    match (rule.work, rule.stock) {
        (WorkCode::MillInside, StockCode::None) => Ok(mill(ContourSide::Inside)),
        (WorkCode::MillOutside, StockCode::None) => Ok(mill(ContourSide::Outside)),
        (WorkCode::MillSlot, StockCode::None) => Ok(mill(ContourSide::Slot)),
        (WorkCode::RingOuter, StockCode::Along) => Ok(Work::Ring(Edge::Outer, Stock::PerMove)),
        (WorkCode::RingInner, StockCode::Along) => Ok(Work::Ring(Edge::Inner, Stock::PerMove)),
        (WorkCode::RingOuter, StockCode::Convex | StockCode::Disc | StockCode::Engaged) => Ok(ring(Edge::Outer)),
        (WorkCode::RingInner, StockCode::Convex | StockCode::Disc | StockCode::Engaged) => Ok(ring(Edge::Inner)),
        _ => Err(RefusalCode::Value),
    }
}

const fn moves(code: MovesCode) -> Moves {
    match code {
        MovesCode::InteriorCw => Moves::Rotations(RotationCircle::Interior, Turn::Cw),
        MovesCode::InteriorCcw => Moves::Rotations(RotationCircle::Interior, Turn::Ccw),
        MovesCode::ExteriorCw => Moves::Rotations(RotationCircle::Exterior, Turn::Cw),
        MovesCode::ExteriorCcw => Moves::Rotations(RotationCircle::Exterior, Turn::Ccw),
        MovesCode::ArcsCw => Moves::Arcs(Turn::Cw),
        MovesCode::ArcsCcw => Moves::Arcs(Turn::Ccw),
        MovesCode::Lines => Moves::Lines,
    }
}

/// An initial job that governs nothing.
pub const fn empty_job() -> Job {
    Job {
        unit: LengthUnit::Mm,
        tools: Tools::one(ToolSetup::new(
            Tool::EndMill(EndMill { radius: Nm(0), teeth: 0 }),
            RevPerMin(0.0),
            LawKind::Programmed,
            MmPerTooth(0.0),
        )),
        policy: FeedPolicy::SafeBase,
        limits: OverrideLimits {
            min_percent: 10,
            max_percent: 200,
            step_percent: 1,
            slew_up_percent_per_s: 50.0,
            slew_down_percent_per_s: 200.0,
        },
        ceiling: FeedCeiling { max_feed: None, max_raise_ratio: FeedCeiling::DEFAULT_RAISE_RATIO },
        machine: MachineLimits { linear: [None; 3], rotary: [None; 3], arc_clamp: None },
        rules: Vec::new(),
        knots: Knots::new(),
    }
}

#[cfg(test)]
mod tests;
