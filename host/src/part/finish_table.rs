//! Table `[finish]` of `PART.toml` as serde reads it.

use serde::Deserialize;
use toml::Spanned;

use crate::job::Quantity;

/// `[finish]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FinishTable {
    /// Diameter of the mill.
    pub diameter: Spanned<Quantity>,
    /// Corner radius of its end; without it a ball.
    pub corner_radius: Option<Spanned<Quantity>>,
    /// Number of teeth.
    pub teeth: Spanned<u16>,
    /// Height above the tip up to which the mill has its diameter.
    pub length: Spanned<Quantity>,
    /// Cylinders behind the cutting part, from below: radius and length of each.
    #[serde(default)]
    pub neck: Vec<Spanned<[Quantity; 2]>>,
    /// Cylinders of the holder, from below: radius and length of each.
    #[serde(default)]
    pub holder: Vec<Spanned<[Quantity; 2]>>,
    /// Height of the ridges (scallops) between neighbouring passes.
    pub scallop: Spanned<Quantity>,
    /// Largest deviation of a straight move between two points from the surface.
    pub tolerance: Spanned<Quantity>,
    /// Largest distance of neighbouring contact points.
    pub step: Option<Spanned<Quantity>>,
    /// Largest rotation of the tool axis between neighbouring points, degrees.
    pub step_deg: Option<Spanned<f64>>,
    /// Distance to be kept from everything except the finished blade.
    pub safety: Option<Spanned<Quantity>>,
    /// Height above the blank at which the mill enters and leaves.
    pub clearance: Option<Spanned<Quantity>>,
    /// Lowest pass, as a place between hub (0) and tip (1).
    pub from: Option<Spanned<f64>>,
    /// Highest pass, as a place between hub (0) and tip (1).
    pub to: Option<Spanned<f64>>,
    /// Distribution of the passes.
    #[serde(default)]
    pub spacing: SpacingWord,
    /// Order of the passes: a spiral round the blade, or passes of one side.
    #[serde(default)]
    pub course: CourseWord,
    /// Climb or conventional milling, for a spindle that turns clockwise.
    #[serde(default)]
    pub milling: MillingWord,
    /// Smallest and largest angle between tool axis and normal in the search for the axes, degrees.
    pub tilt_deg: Option<Spanned<[f64; 2]>>,
    /// Place along each pass (0 to 1), tilt and yaw in degrees, in place of the search.
    #[serde(default)]
    pub stations: Vec<Spanned<[f64; 3]>>,
    /// Quantity that is interpolated between stations.
    #[serde(default)]
    pub interpolate: InterpolateWord,
    /// Length of the tool from the gauge line to the tip.
    pub tool_length: Option<Spanned<Quantity>>,
    /// Zero of the part in the machine.
    pub part_zero: Option<[Quantity; 3]>,
    /// Largest path of the cutting end per tooth, as a multiple of the feed per tooth.
    pub max_raise: Option<Spanned<f64>>,
    /// Spindle speed, rev/min.
    pub rev_per_min: Option<Spanned<f64>>,
    /// Feed per tooth at the contact with the surface.
    pub feed_per_tooth: Option<Spanned<Quantity>>,
    /// Feed of approaches and links, per minute.
    pub approach_feed: Option<Spanned<Quantity>>,
}

/// Values of `spacing` in `[finish]`.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum SpacingWord {
    #[default]
    IsoParametric,
    IsoStepover,
}

/// Values of `course` in `[finish]`.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum CourseWord {
    #[default]
    Spiral,
    Pressure,
    Suction,
}

/// Values of `milling` in `[finish]`.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum MillingWord {
    #[default]
    Climb,
    Conventional,
}

/// Values of `interpolate` in `[finish]`.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum InterpolateWord {
    #[default]
    Angles,
    Positions,
}
