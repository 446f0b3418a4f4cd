//! What a job adds to a program: tool, spindle, law, limits, cut rules. Read from `JOB.toml` in `host`.

use heapless::Vec;

use crate::cut::{CutRule, RULES_MAX};
use crate::knots::Knots;
use crate::machine::MachineLimits;
use crate::tool::Tool;
use crate::units::{LengthUnit, MmPerMin, MmPerTooth, Nm, RevPerMin};

/// Most tools in a job.
pub const TOOLS_MAX: usize = 8;

/// A job, validated.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// The unit the program starts in and reports speak.
    pub unit: LengthUnit,
    /// The tools that it governs, each with its law.
    pub tools: Tools,
    /// How the wanted feed reaches the control.
    pub policy: FeedPolicy,
    /// Bounds of the override.
    pub limits: OverrideLimits,
    /// What no governed feed exceeds.
    pub ceiling: FeedCeiling,
    /// What the machine can follow.
    pub machine: MachineLimits,
    /// Which arcs cut what.
    pub rules: Vec<CutRule, RULES_MAX>,
    /// The knots of all rules' tables.
    pub knots: Knots,
}

impl Job {
    /// The tool that a rule is for.
    pub fn tool_of(&self, rule: &CutRule) -> &ToolSetup {
        self.tools.get(usize::from(rule.tool)).unwrap_or(self.tools.first())
    }

    /// The wanted feed per tooth of a rule.
    pub fn feed_per_tooth_of(&self, rule: &CutRule) -> MmPerTooth {
        rule.feed_per_tooth.unwrap_or(self.tool_of(rule).feed_per_tooth)
    }
}

/// A tool of the job: how the program calls it, what turns it, and the law that feeds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolSetup {
    /// The cutter.
    pub tool: Tool,
    /// Its T number; without one it is the tool that the operator has loaded, up to the first M6. Of several tools each has one.
    pub number: Option<i64>,
    /// Its axis in the program's coordinates.
    pub axis: ToolAxis,
    /// Spindle speed: for plans and reports, and on the machine where the operator sets it.
    pub spindle: RevPerMin,
    /// Who sets the spindle's speed.
    pub speed_source: SpeedSource,
    /// The feed law.
    pub law: LawKind,
    /// a: wanted feed per tooth, where the law says (on the circumference, at the contour), or chip thickness.
    pub feed_per_tooth: MmPerTooth,
}

impl ToolSetup {
    /// A tool along Z, without a number, whose speed the program sets.
    pub const fn new(tool: Tool, spindle: RevPerMin, law: LawKind, feed_per_tooth: MmPerTooth) -> Self {
        let (number, axis, speed_source) = (None, ToolAxis::Z, SpeedSource::Program);
        ToolSetup { tool, number, axis, spindle, speed_source, law, feed_per_tooth }
    }
}

/// The tools of a job, in its order: at least one.
#[derive(Clone, Debug, PartialEq)]
pub struct Tools {
    first: ToolSetup,
    more: Vec<ToolSetup, { TOOLS_MAX - 1 }>,
}

impl Tools {
    /// One tool.
    pub const fn one(setup: ToolSetup) -> Self {
        Tools { first: setup, more: Vec::new() }
    }

    /// Adds a tool behind the others.
    ///
    /// # Errors
    /// The tool, where there are [`TOOLS_MAX`] of them.
    pub fn push(&mut self, setup: ToolSetup) -> Result<(), ToolSetup> {
        self.more.push(setup)
    }

    /// The tool in the first place.
    pub const fn first(&self) -> &ToolSetup {
        &self.first
    }

    /// The tool in the first place, to change.
    pub const fn first_mut(&mut self) -> &mut ToolSetup {
        &mut self.first
    }

    /// The tool in the last place, to change.
    pub fn last_mut(&mut self) -> &mut ToolSetup {
        self.more.last_mut().unwrap_or(&mut self.first)
    }

    /// The tool in a place, counted from 0.
    pub fn get(&self, index: usize) -> Option<&ToolSetup> {
        self.iter().nth(index)
    }

    /// How many there are; at least 1.
    #[allow(clippy::len_without_is_empty, reason = "it is never empty")]
    pub fn len(&self) -> usize {
        1 + self.more.len()
    }

    /// All of them, in order.
    pub fn iter(&self) -> impl Iterator<Item = &ToolSetup> {
        core::iter::once(&self.first).chain(&self.more)
    }
}

/// The axis of the program's coordinates that the tool turns about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ToolAxis {
    /// X: the plane is G19.
    X,
    /// Y: the plane is G18.
    Y,
    /// Z: the plane is G17.
    #[default]
    Z,
}

impl ToolAxis {
    /// 0 for X to 2 for Z.
    pub const fn index(self) -> usize {
        self as usize
    }
}

/// Who sets the spindle's speed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpeedSource {
    /// The program's S and M words.
    #[default]
    Program,
    /// The operator, to the job's speed, where the program does not.
    Operator,
}

/// What no governed feed exceeds: neither a written F nor F times the override.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedCeiling {
    /// Along the path.
    pub max_feed: Option<MmPerMin>,
    /// Over the programmed F.
    pub max_raise_ratio: f32,
}

impl FeedCeiling {
    /// Largest raise of a programmed feed where the job states none.
    pub const DEFAULT_RAISE_RATIO: f32 = 2.0;

    /// The fastest feed of a governed move with this programmed F; infinite without any bound.
    pub fn feed_mm_per_min(&self, programmed: Option<Nm>) -> f64 {
        let raised = programmed.map_or(f64::INFINITY, |feed| feed.to_mm() * f64::from(self.max_raise_ratio));
        raised.min(self.max_feed.map_or(f64::INFINITY, |feed| f64::from(feed.0)))
    }
}

impl Default for FeedCeiling {
    fn default() -> Self {
        FeedCeiling { max_feed: None, max_raise_ratio: FeedCeiling::DEFAULT_RAISE_RATIO }
    }
}

/// The feed laws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LawKind {
    /// Constant feed per tooth on a ring's circumference, at the contact with the stock line (Petean ch. 5).
    Circumference,
    /// The thickest chip over a ring's whole engaged arc.
    EngagedArc {
        /// Whether both circles of the ring are protected, or only the one that the cut rule names.
        both_edges: bool,
    },
    /// Constant feed per tooth at the finished contour.
    Contour {
        /// Whether outside arcs keep the feed instead of a raised one.
        inside_only: bool,
        /// Least part of the feed, however tight the arc.
        floor_ratio: f32,
    },
    /// Constant chip thickness of an end mill.
    Engagement,
    /// A feed per tooth at the centre computed beforehand, rule by rule.
    Table,
    /// The program's own feed.
    Programmed,
}

/// How the wanted feed reaches the control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FeedPolicy {
    /// Blocks are sent with the least feed the law wants; the override raises it. A lost override only thins chips.
    SafeBase,
    /// The program's own F stays; the override does it all, within its limits.
    OverrideOnly,
    /// The override stays at 100 %: arcs are sent in pieces, each with the least feed the law wants on it.
    RewriteOnly(PieceSettings),
}

/// How finely arcs are cut into pieces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PieceSettings {
    /// From one feed of an arc to the next, %: its feeds are its least one times powers of this.
    pub step_percent: f32,
    /// A rise of F by less than this is not made, %.
    pub hysteresis_percent: f32,
    /// No piece is shorter.
    pub least_length: Nm,
    /// No arc has more pieces.
    pub most: u16,
}

impl Default for PieceSettings {
    fn default() -> Self {
        PieceSettings { step_percent: 1.0, hysteresis_percent: 2.0, least_length: Nm(2_000_000), most: 24 }
    }
}

/// Bounds of the override.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverrideLimits {
    /// Least override, %.
    pub min_percent: u8,
    /// Largest override, %; a control takes 254 at most.
    pub max_percent: u8,
    /// The control's step, %.
    pub step_percent: u8,
    /// Fastest rise, % per second.
    pub slew_up_percent_per_s: f32,
    /// Fastest fall, % per second.
    pub slew_down_percent_per_s: f32,
}

impl Default for OverrideLimits {
    fn default() -> Self {
        OverrideLimits {
            min_percent: 10,
            max_percent: 200,
            step_percent: 1,
            slew_up_percent_per_s: 50.0,
            slew_down_percent_per_s: 200.0,
        }
    }
}
