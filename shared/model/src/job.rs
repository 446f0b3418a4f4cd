//! Job: tools, spindle speeds, laws, limits and cut rules that belong to a program. `host` reads it from `JOB.toml`.

use heapless::Vec;

use crate::cut::{CutRule, RULES_MAX};
use crate::knots::Knots;
use crate::machine::MachineLimits;
use crate::tool::Tool;
use arcfeed_units::{LengthUnit, MmPerMin, MmPerTooth, Nm, RevPerMin};

/// Most tools in a job.
pub const TOOLS_MAX: usize = 8;

/// A job, validated.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// Unit in which the program starts and in which reports are written.
    pub unit: LengthUnit,
    /// Tools of the job, each with its law.
    pub tools: Tools,
    /// Way in which the target feed reaches the control.
    pub policy: FeedPolicy,
    /// Bounds of the override.
    pub limits: OverrideLimits,
    /// Upper limit of governed feeds.
    pub ceiling: FeedCeiling,
    /// Feed limits of the machine.
    pub machine: MachineLimits,
    /// Cut rules.
    pub rules: Vec<CutRule, RULES_MAX>,
    /// The knots of all rules' tables.
    pub knots: Knots,
}

impl Job {
    /// The tool of a rule.
    pub fn tool_of(&self, rule: &CutRule) -> &ToolSetup {
        self.tools.get(usize::from(rule.tool)).unwrap_or(self.tools.first())
    }

    /// The target feed per tooth of a rule.
    pub fn feed_per_tooth_of(&self, rule: &CutRule) -> MmPerTooth {
        rule.feed_per_tooth.unwrap_or(self.tool_of(rule).feed_per_tooth)
    }
}

/// A tool of the job: its T number, axis, spindle speed and feed law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolSetup {
    /// The cutter.
    pub tool: Tool,
    /// T number. `None` means the tool that the operator has loaded, until the first M6; a job with several tools
    /// numbers each.
    pub number: Option<i64>,
    /// Tool axis in the program's coordinates.
    pub axis: ToolAxis,
    /// Spindle speed for plans and reports; also the speed on the machine if the operator sets it.
    pub spindle: RevPerMin,
    /// Source of the spindle speed.
    pub speed_source: SpeedSource,
    /// The feed law.
    pub law: LawKind,
    /// a: target feed per tooth at the point that the law defines (on the circumference, at the contour), or target
    /// chip thickness.
    pub feed_per_tooth: MmPerTooth,
    /// The target is the programmed F of each block instead, at the point that the law defines. Only for
    /// [`FeedPolicy::RewriteOnly`]: a board knows the sent F, not the programmed one.
    pub follows_program: bool,
}

impl ToolSetup {
    /// Target feed per tooth where the programmed feed is the target, if it is positive.
    pub fn target_of(&self, programmed: Nm, spindle: RevPerMin) -> Option<MmPerTooth> {
        let teeth_per_min = f64::from(spindle.0) * f64::from(self.tool.active_teeth());
        let target = programmed.to_mm() / teeth_per_min;
        (target > 0.0 && target.is_finite()).then_some(MmPerTooth(target as f32))
    }

    /// A tool along Z without a number; the program sets its speed.
    pub const fn new(tool: Tool, spindle: RevPerMin, law: LawKind, feed_per_tooth: MmPerTooth) -> Self {
        let (number, axis, speed_source) = (None, ToolAxis::Z, SpeedSource::Program);
        ToolSetup { tool, number, axis, spindle, speed_source, law, feed_per_tooth, follows_program: false }
    }
}

/// The tools of a job, in its order: at least one.
#[derive(Clone, Debug, PartialEq)]
pub struct Tools {
    first: ToolSetup,
    more: Vec<ToolSetup, { TOOLS_MAX - 1 }>,
}

impl Tools {
    /// A job's only tool.
    pub const fn one(setup: ToolSetup) -> Self {
        Tools { first: setup, more: Vec::new() }
    }

    /// Appends a tool to the job.
    ///
    /// # Errors
    /// Returns the tool if there are already [`TOOLS_MAX`].
    pub fn push(&mut self, setup: ToolSetup) -> Result<(), ToolSetup> {
        self.more.push(setup)
    }

    /// The first tool of the job.
    pub const fn first(&self) -> &ToolSetup {
        &self.first
    }

    /// The first tool, mutable.
    pub const fn first_mut(&mut self) -> &mut ToolSetup {
        &mut self.first
    }

    /// The last tool, mutable.
    pub fn last_mut(&mut self) -> &mut ToolSetup {
        self.more.last_mut().unwrap_or(&mut self.first)
    }

    /// The tool with this index, from 0.
    pub fn get(&self, index: usize) -> Option<&ToolSetup> {
        self.iter().nth(index)
    }

    /// Number of tools; at least 1.
    #[allow(clippy::len_without_is_empty, reason = "it is never empty")]
    pub fn len(&self) -> usize {
        1 + self.more.len()
    }

    /// All tools, in order.
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

/// Source of the spindle speed: program or operator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpeedSource {
    /// The program's S and M words.
    #[default]
    Program,
    /// The operator sets the job's speed where the program commands none.
    Operator,
}

/// Upper limit of governed feeds: both of the sent F and of F times the override.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedCeiling {
    /// Largest feed along the path.
    pub max_feed: Option<MmPerMin>,
    /// Largest feed relative to the programmed F.
    pub max_raise_ratio: f32,
}

impl FeedCeiling {
    /// Largest raise of a programmed feed where the job states none.
    pub const DEFAULT_RAISE_RATIO: f32 = 2.0;

    /// Largest feed of a governed move with this programmed F; infinite without any limit.
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

/// Feed law that a job selects, with its settings.
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
        /// Lower limit of the feed as a fraction, for tight arcs.
        floor_ratio: f32,
    },
    /// Constant chip thickness of an end mill.
    Engagement,
    /// Feed per tooth at the centre from a table of the cut rule.
    Table,
    /// The program's own feed.
    Programmed,
}

/// Feed mode of a job: how the wanted feed reaches the control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FeedPolicy {
    /// Blocks are sent with the smallest feed that the law demands; the override raises it. If the override is lost,
    /// chips only get thinner.
    SafeBase,
    /// The programmed F stays; the override alone varies the feed, within its limits.
    OverrideOnly,
    /// The override stays at 100 %: arcs are sent in pieces, each with the smallest feed that the law demands on it.
    RewriteOnly(PieceSettings),
}

/// Rules for dividing arcs into pieces with an F each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PieceSettings {
    /// Step between feeds of an arc, %: the feeds are the smallest one times powers of this step.
    pub step_percent: f32,
    /// Smallest rise of F, %; smaller rises are left out.
    pub hysteresis_percent: f32,
    /// Minimum length of a piece.
    pub least_length: Nm,
    /// Maximum number of pieces of an arc.
    pub most: u16,
}

impl Default for PieceSettings {
    fn default() -> Self {
        PieceSettings { step_percent: 1.0, hysteresis_percent: 2.0, least_length: Nm(2_000_000), most: 24 }
    }
}

/// Bounds, step and slew rates of the override.
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
