//! What a job adds to a program: tool, spindle, law, limits, cut rules. Read from `JOB.toml` in `host`.

use heapless::Vec;

use crate::cut::{CutRule, RULES_MAX};
use crate::knots::Knots;
use crate::machine::MachineLimits;
use crate::tool::Tool;
use crate::units::{LengthUnit, MmPerMin, MmPerTooth, Nm, RevPerMin};

/// A job, validated.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// The unit the program starts in and reports speak.
    pub unit: LengthUnit,
    /// The cutter.
    pub tool: Tool,
    /// What the tool must agree with in the program.
    pub setup: Setup,
    /// Spindle speed: for plans and reports, and on the machine where the operator sets it.
    pub spindle: RevPerMin,
    /// The feed law.
    pub law: LawKind,
    /// a: wanted feed per tooth, where the law says (on the circumference, at the contour), or chip thickness.
    pub feed_per_tooth: MmPerTooth,
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
    /// The wanted feed per tooth of a rule.
    pub fn feed_per_tooth_of(&self, rule: &CutRule) -> MmPerTooth {
        rule.feed_per_tooth.unwrap_or(self.feed_per_tooth)
    }
}

/// The tool in the program, and who sets its speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setup {
    /// Its T number; without one it is the tool that the operator has loaded, up to the first M6.
    pub tool_number: Option<i64>,
    /// Its axis in the program's coordinates.
    pub axis: ToolAxis,
    /// Who sets the spindle's speed.
    pub speed_source: SpeedSource,
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
