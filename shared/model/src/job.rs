//! Job: tools, spindle speeds, laws, limits and cut rules that belong to a program. `host` reads it from `JOB.toml`.

use heapless::Vec;

use crate::cut::{CutRule, RULES_MAX};
use crate::knots::Knots;
use crate::machine::MachineLimits;
use crate::tool::Tool;
use arcfeed_units::{LengthUnit, MmPerMin, MmPerTooth, Nm, RevPerMin};

/// Largest number of tools in a job.
pub const TOOLS_MAX: usize = 8;

/// Everything about a milling job that the feed laws need, checked: tools, stock, limits, and the moves to which a law
/// applies.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// Unit in which the program starts and in which reports are written.
    pub unit: LengthUnit,
    /// Tools of the job, each with its law.
    pub tools: Tools,
    /// Whether the target feed reaches the control by F words, by the override, or both.
    pub policy: FeedPolicy,
    /// Range, step and slew rates of the feed override.
    pub limits: OverrideLimits,
    /// Upper limit, set by the job, of the feed on moves that a law governs.
    pub ceiling: FeedCeiling,
    /// Feed limits of the machine's axes, and the control's clamp on arcs.
    pub machine: MachineLimits,
    /// Cut rules (moves to which a law applies, and the stock there), in the order in which they are tried.
    pub rules: Vec<CutRule, RULES_MAX>,
    /// Tables of feeds per tooth over the path, for the table law: the knots of all rules together.
    pub knots: Knots,
}

impl Job {
    /// The tool to which a rule belongs, with its settings.
    pub fn tool_of(&self, rule: &CutRule) -> &ToolSetup {
        self.tools.get(usize::from(rule.tool)).unwrap_or(self.tools.first())
    }

    /// The target feed per tooth of a rule: its own, or that of its tool.
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
    /// Spindle speed for plans and reports. Also the speed on the machine, if [`Self::speed_source`] is the operator
    /// and the program states none.
    pub spindle: RevPerMin,
    /// Whether the program or the operator sets the spindle speed.
    pub speed_source: SpeedSource,
    /// The feed law for this tool, with the law's settings.
    pub law: LawKind,
    /// a: target feed per tooth at the point that the law defines (on the circumference, at the contour), or target
    /// chip thickness.
    pub feed_per_tooth: MmPerTooth,
    /// Whether the target is not `feed_per_tooth` but the programmed F of each block, at the point that the law
    /// defines. Only with [`FeedPolicy::RewriteOnly`], because a board knows the sent F, not the programmed one.
    pub follows_program: bool,
}

impl ToolSetup {
    /// Target feed per tooth that corresponds to a programmed feed (nm/min): F / (spindle speed times teeth that cut).
    /// `None` if this is not positive and finite.
    pub fn target_of(&self, programmed: Nm, spindle: RevPerMin) -> Option<MmPerTooth> {
        let teeth_per_min = f64::from(spindle.0) * f64::from(self.tool.active_teeth());
        let target = programmed.to_mm() / teeth_per_min;
        (target > 0.0 && target.is_finite()).then_some(MmPerTooth(target as f32))
    }

    /// Settings of a tool with its axis along Z and without a T number, whose speed the program sets.
    pub const fn new(tool: Tool, spindle: RevPerMin, law: LawKind, feed_per_tooth: MmPerTooth) -> Self {
        let (number, axis, speed_source) = (None, ToolAxis::Z, SpeedSource::Program);
        ToolSetup { tool, number, axis, spindle, speed_source, law, feed_per_tooth, follows_program: false }
    }
}

/// The tools of a job in the order of the job file; at least one.
#[derive(Clone, Debug, PartialEq)]
pub struct Tools {
    first: ToolSetup,
    more: Vec<ToolSetup, { TOOLS_MAX - 1 }>,
}

impl Tools {
    /// List of a single tool.
    pub const fn one(setup: ToolSetup) -> Self {
        Tools { first: setup, more: Vec::new() }
    }

    /// Appends a tool to the list.
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

    /// The tool with this index, counted from 0; `None` beyond the last.
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

/// Axis of the program's coordinates that is parallel to the tool.
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
    /// Index of the axis among X, Y, Z: 0 for X, 1 for Y, 2 for Z.
    pub const fn index(self) -> usize {
        self as usize
    }
}

/// Source of the spindle speed: the program or the operator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpeedSource {
    /// The program's S and M words; without them the speed is unknown, and no law governs.
    #[default]
    Program,
    /// The operator: the job's speed counts wherever the program commands none.
    Operator,
}

/// Upper limit, set by the job, of the feed on moves that a law governs. It limits both the F that is sent and the
/// product of F and override.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedCeiling {
    /// Largest feed along the path; `None`: no such limit.
    pub max_feed: Option<MmPerMin>,
    /// Largest feed as a multiple of the programmed F.
    pub max_raise_ratio: f32,
}

impl FeedCeiling {
    /// Value of [`Self::max_raise_ratio`] if the job states none.
    pub const DEFAULT_RAISE_RATIO: f32 = 2.0;

    /// Largest feed of a governed move, mm/min; `programmed` is its programmed F, nm/min. Infinite if neither limit
    /// applies.
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
    /// Constant feed per tooth on the circumference of a cup mill (a ring-shaped cutter), at the contact of its
    /// cutting circle with the stock line (Petean ch. 5).
    Circumference,
    /// The thickest chip anywhere on the engaged arc of a cup mill is kept at the target.
    EngagedArc {
        /// Whether both cutting circles count, or only the one that the cut rule names.
        both_edges: bool,
    },
    /// Constant feed per tooth along the finished contour instead of along the path of the tool's centre.
    Contour {
        /// Whether arcs outside a contour have the target feed at the centre instead of a higher one.
        inside_only: bool,
        /// Lower limit of the centre's feed, as a fraction of the feed at the contour; it acts on tight inside arcs.
        floor_ratio: f32,
    },
    /// Constant chip thickness of an end mill: the feed depends on the radial depth of cut.
    Engagement,
    /// Feed per tooth at the tool's centre from a table over the path, which the cut rule contains.
    Table,
    /// No law: the program's own feed.
    Programmed,
}

/// Feed mode of a job: how the wanted feed reaches the control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FeedPolicy {
    /// Blocks are sent with the smallest feed that the law demands anywhere on them, and the override raises it from
    /// there. If the override is lost, chips can therefore only get thinner.
    SafeBase,
    /// Blocks are sent with their programmed F; only the override varies the feed.
    OverrideOnly,
    /// The override stays at 100 %. Arcs are sent in pieces, each with an F of its own: the smallest feed that the law
    /// demands on the piece.
    RewriteOnly(PieceSettings),
}

/// Rules by which an arc is divided into pieces with an F of their own, for [`FeedPolicy::RewriteOnly`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PieceSettings {
    /// Step between feeds of an arc, %: the feeds are the smallest one times powers of this step.
    pub step_percent: f32,
    /// Smallest rise of F from one piece to the next, %; a smaller rise is left out, so that both have the lower F.
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

/// Range, resolution and slew rates of the feed override.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverrideLimits {
    /// Smallest override that a law may set, %.
    pub min_percent: u8,
    /// Largest override that a law may set, %; a control takes at most 254 %.
    pub max_percent: u8,
    /// Step in which the control accepts the override, %.
    pub step_percent: u8,
    /// Fastest rise, percentage points of override per second.
    pub slew_up_percent_per_s: f32,
    /// Fastest fall, percentage points of override per second.
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
