//! Table `[finish]` of `PART.toml` as serde reads it.

use serde::Deserialize;
use toml::Spanned;

use crate::job::Quantity;

/// `[finish]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FinishTable {
    pub diameter: Spanned<Quantity>,
    pub corner_radius: Option<Spanned<Quantity>>,
    pub teeth: Spanned<u16>,
    pub length: Spanned<Quantity>,
    #[serde(default)]
    pub neck: Vec<Spanned<[Quantity; 2]>>,
    #[serde(default)]
    pub holder: Vec<Spanned<[Quantity; 2]>>,
    pub scallop: Spanned<Quantity>,
    pub tolerance: Spanned<Quantity>,
    pub step: Option<Spanned<Quantity>>,
    pub step_deg: Option<Spanned<f64>>,
    pub safety: Option<Spanned<Quantity>>,
    pub clearance: Option<Spanned<Quantity>>,
    pub from: Option<Spanned<f64>>,
    pub to: Option<Spanned<f64>>,
    #[serde(default)]
    pub spacing: SpacingWord,
    #[serde(default)]
    pub course: CourseWord,
    #[serde(default)]
    pub milling: MillingWord,
    pub tilt_deg: Option<Spanned<[f64; 2]>>,
    #[serde(default)]
    pub stations: Vec<Spanned<[f64; 3]>>,
    #[serde(default)]
    pub interpolate: InterpolateWord,
    pub tool_length: Option<Spanned<Quantity>>,
    pub part_zero: Option<[Quantity; 3]>,
    pub max_raise: Option<Spanned<f64>>,
    pub rev_per_min: Option<Spanned<f64>>,
    pub feed_per_tooth: Option<Spanned<Quantity>>,
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
