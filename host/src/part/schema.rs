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
    pub splitter: Option<Spanned<String>>,
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
    /// Names or colours of the splitter's faces.
    pub splitter: Option<Vec<String>>,
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
    /// Outer radius of the blank, a ring about the rotor's axis.
    pub radius: Spanned<Quantity>,
    /// Lower end of the blank along the rotor's axis.
    pub from: Spanned<Quantity>,
    /// Upper end of the blank along the rotor's axis.
    pub to: Spanned<Quantity>,
}

/// `[cutter]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CutterTable {
    /// Outer radius of the ring of inserts.
    pub outer_radius: Spanned<Quantity>,
    /// Inner radius of the ring of inserts.
    pub inner_radius: Spanned<Quantity>,
    /// Corner radius of the inserts, on both sides.
    pub insert_radius: Spanned<Quantity>,
    /// Number of teeth that cut on one circle.
    pub active_teeth: Spanned<u16>,
    /// Depth of the hollow inside the cup.
    pub cavity_depth: Spanned<Quantity>,
    /// Height of the cup from its bottom to its back.
    pub height: Spanned<Quantity>,
    /// Cylinders behind the cup, from below: radius and length of each.
    #[serde(default)]
    pub holder: Vec<Spanned<[Quantity; 2]>>,
}

/// `[plunge]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartPlungeTable {
    /// Diameter of the mill.
    pub diameter: Spanned<Quantity>,
    /// Corner radius between its end and its side.
    pub corner_radius: Option<Spanned<Quantity>>,
    /// Radius about the axis within which the mill does not cut.
    pub core_radius: Option<Spanned<Quantity>>,
    /// Largest radial width of a cut.
    pub width_max: Option<Spanned<Quantity>>,
    /// Number of teeth.
    pub teeth: Spanned<u16>,
    /// Length of the part that has the diameter.
    pub length: Option<Spanned<Quantity>>,
    /// Cylinders behind the cutting part, from below: radius and length of each.
    #[serde(default)]
    pub neck: Vec<Spanned<[Quantity; 2]>>,
    /// Cylinders of the holder, from below: radius and length of each.
    #[serde(default)]
    pub holder: Vec<Spanned<[Quantity; 2]>>,
    /// Largest height of the cusps between neighbouring plunges on the blades.
    pub cusp: Option<Spanned<Quantity>>,
    /// Criterion by which the boundary axes are fitted to the blades.
    #[serde(default)]
    pub fit: FitWord,
    /// Height above all that turns at which the mill moves from plunge to plunge.
    pub clearance: Option<Spanned<Quantity>>,
    /// Step off the wall before the mill is withdrawn.
    pub relief: Option<Spanned<Quantity>>,
    /// Spindle speed, rev/min.
    pub rev_per_min: Option<Spanned<f64>>,
    /// Feed per tooth of the plunges.
    pub feed_per_tooth: Option<Spanned<Quantity>>,
    /// Feed of the approaches, per minute.
    pub approach_feed: Option<Spanned<Quantity>>,
    /// Limits for the plunge law in the job that is written.
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
    /// Thickness of the material that is left on blades and hub.
    pub allowance: Spanned<Quantity>,
    /// Largest distance of neighbouring levels.
    pub axial_depth_max: Option<Spanned<Quantity>>,
    /// Largest distance from the edge at which the slot begins to the place that the inner circle touches first, on the tip curve
    /// of the suction side, as a fraction of the curve.
    pub interior_contact: Option<Spanned<f64>>,
    /// Height of the lifted tool above everything that turns while the part is indexed.
    pub clearance: Option<Spanned<Quantity>>,
    /// Kind of slot that is planned, of a rotor with splitters.
    pub slot: Option<Spanned<i64>>,
    /// Choice of the direction of the tool's axis.
    #[serde(default)]
    pub axis: AxisWord,
    /// Largest number of passes through a slot.
    pub passes_max: Option<Spanned<u32>>,
    /// Feed law of the job that is written.
    #[serde(default)]
    pub law: LawWord,
    /// Spindle speed, rev/min.
    pub rev_per_min: Spanned<f64>,
    /// Feed per tooth on the cutting circumference.
    pub feed_per_tooth: Spanned<Quantity>,
    /// Feed down to the first level, per minute.
    pub approach_feed: Option<Spanned<Quantity>>,
    /// Feed from level to level, per minute.
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
    /// Corner of the box with the lowest coordinates.
    pub from: [Quantity; 3],
    /// Corner of the box with the highest coordinates.
    pub to: [Quantity; 3],
}

/// `[machine]` as serde reads it.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartMachineTable {
    /// Path of the machine's file, relative to the part file.
    pub file: Option<Spanned<String>>,
    /// Name of a built-in machine, in place of `file`.
    pub preset: Option<Spanned<String>>,
}

/// `[output]` as serde reads it.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutputTable {
    /// Unit of the NC program that is written.
    pub units: Option<UnitWord>,
    /// Program number (O word).
    pub number: Option<Spanned<u32>>,
    /// Number of the tool, for T and H.
    pub tool: Option<Spanned<u32>>,
    /// The program switches coolant on and off.
    pub coolant: Option<bool>,
    /// The program reports slots and levels by DPRNT.
    pub dprnt: Option<bool>,
}

/// `[baseline]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BaselineTable {
    /// Diameter of the ball-end mill.
    pub diameter: Spanned<Quantity>,
    /// Number of its teeth.
    pub teeth: Spanned<u16>,
    /// Feed along the passes, per minute.
    pub feed: Spanned<Quantity>,
    /// Largest distance of levels.
    pub axial_depth: Spanned<Quantity>,
    /// Largest distance of neighbouring passes.
    pub stepover: Spanned<Quantity>,
}
