//! Tables of `JOB.toml` as serde reads them. The module above checks the values.

use core::fmt;

use arcfeed_units::LengthUnit;
use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use toml::Spanned;

use crate::control::{CenterConvention, Convention};

pub use super::cut_table::{CutTable, DirectionWord, MovesWord, RotationWord, SideWord, StockTable};
pub use super::cutting::CuttingTable;
pub use super::flexible::FlexibleTable;
pub use super::quantity::{Quantity, TargetFeed};

/// A whole job file as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JobTable {
    pub units: UnitWord,
    pub program: Spanned<String>,
    pub tool: ToolTables,
    pub workpiece: Option<Spanned<WorkpieceTable>>,
    pub cutting: Option<Spanned<CuttingTable>>,
    pub plunge: Option<Spanned<PlungeTable>>,
    pub spindle: Option<SpindleTable>,
    pub law: Option<LawTable>,
    #[serde(default)]
    pub limits: LimitsTable,
    #[serde(default)]
    pub r#override: OverrideTable,
    #[serde(default)]
    pub cut: Vec<Spanned<CutTable>>,
    #[serde(default)]
    pub control: ControlTable,
    #[serde(default)]
    pub machine: JobMachineTable,
    #[serde(default)]
    pub serial: SerialTable,
    #[serde(default)]
    pub dnc: DncTable,
}

/// `[plunge]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlungeTable {
    pub map: Spanned<String>,
    pub feed_per_tooth: Option<Spanned<Quantity>>,
    pub ramps: Option<bool>,
    pub indexed: Option<bool>,
}

/// Values of `units`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum UnitWord {
    Inch,
    Mm,
}

impl From<UnitWord> for LengthUnit {
    fn from(word: UnitWord) -> Self {
        match word {
            UnitWord::Inch => LengthUnit::Inch,
            UnitWord::Mm => LengthUnit::Mm,
        }
    }
}

/// One `[tool]`, or several `[[tool]]`.
#[derive(Debug)]
pub struct ToolTables(pub Vec<ToolTable>);

impl<'de> Deserialize<'de> for ToolTables {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ToolTablesVisitor)
    }
}

struct ToolTablesVisitor;

impl<'de> Visitor<'de> for ToolTablesVisitor {
    type Value = ToolTables;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table [tool], or several tables [[tool]]")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ToolTables, A::Error> {
        ToolTable::deserialize(MapAccessDeserializer::new(map)).map(|table| ToolTables(vec![table]))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, tables: A) -> Result<ToolTables, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(tables)).map(ToolTables)
    }
}

/// `[tool]`, or one `[[tool]]`, as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToolTable {
    pub kind: Spanned<String>,
    pub number: Option<Spanned<i64>>,
    pub axis: Option<Spanned<String>>,
    pub outer_radius: Option<Spanned<Quantity>>,
    pub inner_radius: Option<Spanned<Quantity>>,
    pub active_teeth: Option<Spanned<u16>>,
    pub diameter: Option<Spanned<Quantity>>,
    pub teeth: Option<Spanned<u16>>,
    pub corner_radius: Option<Spanned<Quantity>>,
    pub height: Option<Spanned<Quantity>>,
    pub spindle: Option<SpindleTable>,
    pub law: Option<LawTable>,
    #[serde(default)]
    pub cut: Vec<Spanned<CutTable>>,
}

/// `[workpiece]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorkpieceTable {
    pub block: Option<Spanned<BlockTable>>,
    pub round: Option<Spanned<RoundTable>>,
    pub stl: Option<Spanned<String>>,
    pub target: Option<Spanned<String>>,
    pub stl_units: Option<UnitWord>,
    pub material: Option<Spanned<String>>,
    pub step: Spanned<Quantity>,
    pub memory_mib: Option<Spanned<usize>>,
    pub flexible: Option<Spanned<FlexibleTable>>,
}

/// `block` of `[workpiece]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BlockTable {
    pub from: [Quantity; 3],
    pub to: [Quantity; 3],
}

/// `round` of `[workpiece]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoundTable {
    pub from: [Quantity; 3],
    pub to: [Quantity; 3],
    pub radius: Spanned<Quantity>,
    pub bore: Option<Spanned<Quantity>>,
}

/// `[spindle]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpindleTable {
    pub rev_per_min: Spanned<f64>,
    pub set_by: Option<Spanned<String>>,
    pub max_power: Option<Spanned<String>>,
    pub max_torque: Option<Spanned<String>>,
}

/// `[limits]` as serde reads it.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LimitsTable {
    pub max_feed: Option<Spanned<Quantity>>,
    pub max_raise: Option<Spanned<f64>>,
}

/// `[law]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LawTable {
    pub kind: Spanned<String>,
    pub feed_per_tooth: Spanned<TargetFeed>,
    pub edges: Option<Spanned<String>>,
    pub inside_only: Option<bool>,
    pub floor: Option<Spanned<f32>>,
}

/// `[override]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OverrideTable {
    pub mode: Spanned<String>,
    pub min: Spanned<u8>,
    pub max: Spanned<u8>,
    pub step: Spanned<u8>,
    pub slew_up: Spanned<f32>,
    pub slew_down: Spanned<f32>,
    pub piece_step: Option<Spanned<f32>>,
    pub piece_hysteresis: Option<Spanned<f32>>,
    pub piece_length: Option<Spanned<Quantity>>,
    pub pieces_max: Option<Spanned<u16>>,
}

impl Default for OverrideTable {
    fn default() -> Self {
        let limits = arcfeed_model::job::OverrideLimits::default();
        OverrideTable {
            mode: unplaced("safe-base".into()),
            min: unplaced(limits.min_percent),
            max: unplaced(limits.max_percent),
            step: unplaced(limits.step_percent),
            slew_up: unplaced(limits.slew_up_percent_per_s),
            slew_down: unplaced(limits.slew_down_percent_per_s),
            piece_step: None,
            piece_hysteresis: None,
            piece_length: None,
            pieces_max: None,
        }
    }
}

/// `[control]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControlTable {
    #[serde(default = "fanuc_16i")]
    pub preset: Spanned<String>,
    pub settings: Option<Spanned<String>>,
    pub library: Option<Spanned<String>>,
    pub decimals: Option<Convention>,
    pub arc_centers: Option<CenterConvention>,
    pub arc_clamp: Option<ArcClampTable>,
}

impl Default for ControlTable {
    fn default() -> Self {
        ControlTable {
            preset: fanuc_16i(),
            settings: None,
            library: None,
            decimals: None,
            arc_centers: None,
            arc_clamp: None,
        }
    }
}

fn fanuc_16i() -> Spanned<String> {
    unplaced("fanuc-16i".into())
}

/// `arc_clamp` of `[control]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArcClampTable {
    pub feed: Spanned<Quantity>,
    pub radius: Spanned<Quantity>,
    pub floor: Option<Spanned<Quantity>>,
}

/// `[machine]` as serde reads it.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JobMachineTable {
    pub file: Option<Spanned<String>>,
    pub preset: Option<Spanned<String>>,
    #[serde(default)]
    pub max_feed: MaxFeedTable,
}

/// `max_feed` of `[machine]` as serde reads it.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaxFeedTable {
    pub x: Option<Spanned<Quantity>>,
    pub y: Option<Spanned<Quantity>>,
    pub z: Option<Spanned<Quantity>>,
    pub a: Option<Spanned<f64>>,
    pub b: Option<Spanned<f64>>,
    pub c: Option<Spanned<f64>>,
}

/// `[serial]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SerialTable {
    pub baudrate: Spanned<u32>,
    pub bytesize: Spanned<u8>,
    pub parity: Spanned<String>,
    pub stopbits: Spanned<u8>,
    pub xonxoff: Option<bool>,
    pub rtscts: Spanned<bool>,
    pub dsrdtr: Spanned<bool>,
    pub timeout: Option<Spanned<f64>>,
    pub write_timeout: Option<Spanned<f64>>,
    pub inter_byte_timeout: Option<Spanned<f64>>,
    pub exclusive: Option<bool>,
}

/// `[dnc]` as serde reads it.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DncTable {
    pub code: Option<Spanned<String>>,
    pub tv_check: bool,
    /// Seconds.
    pub reaction: Option<Spanned<f64>>,
    /// Seconds.
    pub start_timeout: Option<Spanned<f64>>,
    /// Seconds.
    pub xoff_timeout: Option<Spanned<f64>>,
    /// Blocks.
    pub report_every: Option<Spanned<usize>>,
    /// Blocks.
    pub read_ahead: Option<usize>,
}

impl Default for SerialTable {
    /// pyserial's defaults, but for XON/XOFF: [`super::serial::build`] switches it on.
    fn default() -> Self {
        SerialTable {
            baudrate: unplaced(9_600),
            bytesize: unplaced(8),
            parity: unplaced("N".into()),
            stopbits: unplaced(1),
            xonxoff: None,
            rtscts: unplaced(false),
            dsrdtr: unplaced(false),
            timeout: None,
            write_timeout: None,
            inter_byte_timeout: None,
            exclusive: None,
        }
    }
}

/// Default value without a place in the file: complaints about it point at the file's start.
fn unplaced<T>(value: T) -> Spanned<T> {
    Spanned::new(0..0, value)
}
