//! Tables of `PART.toml` as serde reads them. The modules beside check the values.

use serde::Deserialize;
use toml::Spanned;

use super::finish_table::FinishTable;
use crate::job::{Quantity, UnitWord};

/// A whole part file as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartTable {
    pub units: UnitWord,
    pub name: Option<String>,
    pub geometry: Spanned<GeometryTable>,
    pub blank: BlankTable,
    pub cutter: Option<CutterTable>,
    pub plunge: Option<Spanned<PartPlungeTable>>,
    pub finish: Option<Spanned<FinishTable>>,
    pub roughing: RoughingTable,
    #[serde(default)]
    pub fixture: Vec<Spanned<FixtureTable>>,
    #[serde(default)]
    pub machine: PartMachineTable,
    #[serde(default)]
    pub output: OutputTable,
    pub baseline: Option<BaselineTable>,
}

/// `[geometry]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GeometryTable {
    pub generate: Option<Spanned<GenerateTable>>,
    pub curves: Option<Spanned<CurvesTable>>,
    pub sections: Option<Spanned<SectionsTable>>,
    pub stl: Option<Spanned<StlTable>>,
    pub step: Option<Spanned<StepTable>>,
}

/// `generate` of `[geometry]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GenerateTable {
    pub blades: Spanned<i64>,
    pub hub_radius: Quantity,
    pub tip_radius: Quantity,
    pub chord: [Quantity; 2],
    pub stagger_deg: [f64; 2],
    pub camber_deg: [f64; 2],
    pub thickness_ratio: [f64; 2],
    pub edge: Option<Quantity>,
    #[serde(default)]
    pub lean_deg: f64,
    #[serde(default)]
    pub hand: HandWord,
}

/// Values of `hand` in `generate`.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum HandWord {
    #[default]
    Right,
    Left,
}

/// `curves` of `[geometry]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CurvesTable {
    pub hub: Spanned<String>,
    pub shroud: Spanned<String>,
    pub profile: Spanned<String>,
    pub blades: Spanned<i64>,
    #[serde(default)]
    pub axis: RotorWord,
    pub units: Option<PointUnit>,
}

/// `sections` of `[geometry]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SectionsTable {
    pub file: Spanned<String>,
    pub blades: Spanned<i64>,
    #[serde(default)]
    pub axis: RotorWord,
    pub units: Option<PointUnit>,
    pub hub: Option<Spanned<String>>,
    pub hub_radius: Option<Spanned<Quantity>>,
}

/// `stl` of `[geometry]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StlTable {
    pub blade: Spanned<String>,
    pub blades: Spanned<i64>,
    #[serde(default)]
    pub axis: RotorWord,
    pub units: Option<PointUnit>,
    pub hub: Option<Spanned<String>>,
    pub hub_radius: Option<Spanned<Quantity>>,
    pub shroud: Option<Spanned<String>>,
    pub tip_radius: Option<Spanned<Quantity>>,
}

/// `step` of `[geometry]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepTable {
    pub file: Spanned<String>,
    /// Names or colours of the blade's faces.
    pub blade: Vec<String>,
    pub blades: Spanned<i64>,
    #[serde(default)]
    pub axis: RotorWord,
    /// Names or colours of the hub's faces.
    pub hub_faces: Option<Spanned<Vec<String>>>,
    pub hub: Option<Spanned<String>>,
    pub hub_radius: Option<Spanned<Quantity>>,
    pub shroud: Option<Spanned<String>>,
    pub tip_radius: Option<Spanned<Quantity>>,
}

/// Values of `axis` in `[geometry]`.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RotorWord {
    X,
    Y,
    #[default]
    Z,
}

/// Units of point files.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PointUnit {
    Mm,
    Cm,
    M,
    Inch,
}

/// `[blank]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BlankTable {
    pub radius: Spanned<Quantity>,
    pub from: Spanned<Quantity>,
    pub to: Spanned<Quantity>,
}

/// `[cutter]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CutterTable {
    pub outer_radius: Spanned<Quantity>,
    pub inner_radius: Spanned<Quantity>,
    pub insert_radius: Spanned<Quantity>,
    pub active_teeth: Spanned<u16>,
    pub cavity_depth: Spanned<Quantity>,
    pub height: Spanned<Quantity>,
    #[serde(default)]
    pub holder: Vec<Spanned<[Quantity; 2]>>,
}

/// `[plunge]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartPlungeTable {
    pub diameter: Spanned<Quantity>,
    pub corner_radius: Option<Spanned<Quantity>>,
    pub core_radius: Option<Spanned<Quantity>>,
    pub width_max: Option<Spanned<Quantity>>,
    pub teeth: Spanned<u16>,
    pub length: Option<Spanned<Quantity>>,
    #[serde(default)]
    pub neck: Vec<Spanned<[Quantity; 2]>>,
    #[serde(default)]
    pub holder: Vec<Spanned<[Quantity; 2]>>,
    pub cusp: Option<Spanned<Quantity>>,
    #[serde(default)]
    pub fit: FitWord,
    pub clearance: Option<Spanned<Quantity>>,
    pub relief: Option<Spanned<Quantity>>,
    pub rev_per_min: Option<Spanned<f64>>,
    pub feed_per_tooth: Option<Spanned<Quantity>>,
    pub approach_feed: Option<Spanned<Quantity>>,
    pub law: Option<Spanned<PartPlungeLawTable>>,
}

/// `law` of `[plunge]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartPlungeLawTable {
    pub material: String,
    pub radial: Spanned<f64>,
    pub axial: Spanned<f64>,
    pub max_power: Option<Spanned<String>>,
    pub max_torque: Option<Spanned<String>>,
}

/// Values of `fit` in `[plunge]`.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum FitWord {
    #[default]
    Gap,
    Area,
}

/// `[roughing]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoughingTable {
    pub allowance: Spanned<Quantity>,
    pub axial_depth_max: Option<Spanned<Quantity>>,
    pub interior_contact: Option<Spanned<f64>>,
    pub clearance: Option<Spanned<Quantity>>,
    #[serde(default)]
    pub axis: AxisWord,
    #[serde(default)]
    pub law: LawWord,
    pub rev_per_min: Spanned<f64>,
    pub feed_per_tooth: Spanned<Quantity>,
    pub approach_feed: Option<Spanned<Quantity>>,
    pub axial_feed: Option<Spanned<Quantity>>,
}

/// Values of `law` in `[roughing]`.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum LawWord {
    Circumference,
    #[default]
    EngagedArc,
}

/// Values of `axis` in `[roughing]`.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AxisWord {
    #[default]
    Auto,
    Blade,
    Roomiest,
}

/// `[[fixture]]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FixtureTable {
    pub from: [Quantity; 3],
    pub to: [Quantity; 3],
}

/// `[machine]` as serde reads it.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartMachineTable {
    pub file: Option<Spanned<String>>,
    pub preset: Option<Spanned<String>>,
}

/// `[output]` as serde reads it.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutputTable {
    pub units: Option<UnitWord>,
    pub number: Option<Spanned<u32>>,
    pub tool: Option<Spanned<u32>>,
    pub coolant: Option<bool>,
    pub dprnt: Option<bool>,
}

/// `[baseline]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BaselineTable {
    pub diameter: Spanned<Quantity>,
    pub teeth: Spanned<u16>,
    pub feed: Spanned<Quantity>,
    pub axial_depth: Spanned<Quantity>,
    pub stepover: Spanned<Quantity>,
}
