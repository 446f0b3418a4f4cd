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
    /// Unit of all lengths in the file, and the unit in force when the program starts.
    pub units: UnitWord,
    /// Path of the NC program, relative to the job file.
    pub program: Spanned<String>,
    /// The tool, or several tools.
    pub tool: ToolTables,
    /// Stock that is cut in the simulation.
    pub workpiece: Option<Spanned<WorkpieceTable>>,
    /// Cutting edges, forces and modes for the simulation.
    pub cutting: Option<Spanned<CuttingTable>>,
    /// Law for moves that descend into material.
    pub plunge: Option<Spanned<PlungeTable>>,
    /// Spindle of tools without a `[spindle]` of their own.
    pub spindle: Option<SpindleTable>,
    /// Feed law of tools without a `[law]` of their own.
    pub law: Option<LawTable>,
    /// Upper limits of governed feeds.
    #[serde(default)]
    pub limits: LimitsTable,
    /// Feed mode, and bounds of the override.
    #[serde(default)]
    pub r#override: OverrideTable,
    /// Cut rules of a job with one tool.
    #[serde(default)]
    pub cut: Vec<Spanned<CutTable>>,
    /// Control on which the program runs.
    #[serde(default)]
    pub control: ControlTable,
    /// Machine and its axis limits.
    #[serde(default)]
    pub machine: JobMachineTable,
    /// Serial line to the control.
    #[serde(default)]
    pub serial: SerialTable,
    /// Transmission on that line.
    #[serde(default)]
    pub dnc: DncTable,
}

/// `[plunge]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlungeTable {
    /// Path of the engagement map, relative to the job file.
    pub map: Spanned<String>,
    /// Largest chip thickness; without it that of `[law]`.
    pub feed_per_tooth: Option<Spanned<Quantity>>,
    /// The law also governs moves that descend at an angle.
    pub ramps: Option<bool>,
}

/// Values of `units`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum UnitWord {
    /// `"inch"`.
    Inch,
    /// `"mm"`.
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
    /// `"cup-mill"` or `"end-mill"`.
    pub kind: Spanned<String>,
    /// T number.
    pub number: Option<Spanned<i64>>,
    /// Axis about which the tool rotates: `"x"`, `"y"` or `"z"`.
    pub axis: Option<Spanned<String>>,
    /// Cup mill: radius of the outer cutting circle.
    pub outer_radius: Option<Spanned<Quantity>>,
    /// Cup mill: radius of the inner cutting circle.
    pub inner_radius: Option<Spanned<Quantity>>,
    /// Cup mill: number of teeth that cut on one circle.
    pub active_teeth: Option<Spanned<u16>>,
    /// End mill: diameter.
    pub diameter: Option<Spanned<Quantity>>,
    /// End mill: number of teeth.
    pub teeth: Option<Spanned<u16>>,
    /// Corner radius of the inserts or of the end, for the simulation.
    pub corner_radius: Option<Spanned<Quantity>>,
    /// Height of the cutting part above the tip, for the simulation.
    pub height: Option<Spanned<Quantity>>,
    /// Spindle of this tool, in place of that of the job.
    pub spindle: Option<SpindleTable>,
    /// Feed law of this tool, in place of that of the job.
    pub law: Option<LawTable>,
    /// Cut rules of this tool.
    #[serde(default)]
    pub cut: Vec<Spanned<CutTable>>,
}

/// `[workpiece]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorkpieceTable {
    /// Stock as a block.
    pub block: Option<Spanned<BlockTable>>,
    /// Stock as a bar or tube.
    pub round: Option<Spanned<RoundTable>>,
    /// Stock as a closed mesh: path of an STL file, relative to the job file.
    pub stl: Option<Spanned<String>>,
    /// Finished part: path of an STL file.
    pub target: Option<Spanned<String>>,
    /// Unit of all STL files.
    pub stl_units: Option<UnitWord>,
    /// Name of the material.
    pub material: Option<Spanned<String>>,
    /// Distance of neighbouring dexel rays.
    pub step: Spanned<Quantity>,
    /// Largest memory of the stock model, MiB.
    pub memory_mib: Option<Spanned<usize>>,
    /// The stock is that of the whole part, at all positions of the rotary axes.
    pub indexed: Option<Spanned<bool>>,
    /// Part of the workpiece that bends under the cutting forces.
    pub flexible: Option<Spanned<FlexibleTable>>,
}

/// `block` of `[workpiece]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BlockTable {
    /// Corner with the lowest coordinates.
    pub from: [Quantity; 3],
    /// Corner with the highest coordinates.
    pub to: [Quantity; 3],
}

/// `round` of `[workpiece]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoundTable {
    /// Centre of one end face.
    pub from: [Quantity; 3],
    /// Centre of the other end face.
    pub to: [Quantity; 3],
    /// Outer radius.
    pub radius: Spanned<Quantity>,
    /// Inner radius of a tube.
    pub bore: Option<Spanned<Quantity>>,
}

/// `[spindle]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpindleTable {
    /// Spindle speed, rev/min.
    pub rev_per_min: Spanned<f64>,
    /// `"program"` or `"operator"`: who sets the speed on the machine.
    pub set_by: Option<Spanned<String>>,
    /// Largest power, as text with a unit.
    pub max_power: Option<Spanned<String>>,
    /// Largest torque, as text with a unit.
    pub max_torque: Option<Spanned<String>>,
}

/// `[limits]` as serde reads it.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LimitsTable {
    /// Largest governed feed along the path, per minute.
    pub max_feed: Option<Spanned<Quantity>>,
    /// Largest governed feed, as a multiple of the programmed F.
    pub max_raise: Option<Spanned<f64>>,
}

/// `[law]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LawTable {
    /// Name of the law, such as `"contour"`.
    pub kind: Spanned<String>,
    /// Target feed per tooth or chip load.
    pub feed_per_tooth: Spanned<TargetFeed>,
    /// Law `engaged-arc` of a cup mill: `"both"` circles count, or only that of the rule's `"side"`.
    pub edges: Option<Spanned<String>>,
    /// Law `contour`: outside arcs keep their feed.
    pub inside_only: Option<bool>,
    /// Law `contour`: smallest feed, % of the target.
    pub floor: Option<Spanned<f32>>,
}

/// `[override]` as serde reads it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OverrideTable {
    /// Feed mode: `"safe-base"`, `"override-only"` or `"rewrite-only"`.
    pub mode: Spanned<String>,
    /// Smallest override, %.
    pub min: Spanned<u8>,
    /// Largest override, %.
    pub max: Spanned<u8>,
    /// Step of the override, %.
    pub step: Spanned<u8>,
    /// Fastest rise of the override, % per second.
    pub slew_up: Spanned<f32>,
    /// Fastest fall of the override, % per second.
    pub slew_down: Spanned<f32>,
    /// Mode `rewrite-only`: step of the feed between pieces, %.
    pub piece_step: Option<Spanned<f32>>,
    /// Mode `rewrite-only`: smallest rise of the feed from one piece to the next, %.
    pub piece_hysteresis: Option<Spanned<f32>>,
    /// Mode `rewrite-only`: length of the shortest piece.
    pub piece_length: Option<Spanned<Quantity>>,
    /// Mode `rewrite-only`: largest number of pieces of an arc.
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
    /// Kind of the control, such as `"fanuc-16i"`.
    #[serde(default = "fanuc_16i")]
    pub preset: Spanned<String>,
    /// Path of the file with the settings of this control.
    pub settings: Option<Spanned<String>>,
    /// Folder of called programs that are not in the program's file.
    pub library: Option<Spanned<String>>,
    /// Meaning of numbers without a decimal point.
    pub decimals: Option<Convention>,
    /// Point from which I, J, K are counted at power-on, for a control with G90.1 and G91.1.
    pub arc_centers: Option<CenterConvention>,
    /// The control's own limit of the feed on arcs.
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
    /// Largest feed per minute on an arc of `radius`; it varies with the root of the radius.
    pub feed: Spanned<Quantity>,
    /// Radius to which `feed` belongs.
    pub radius: Spanned<Quantity>,
    /// Feed per minute below which the control does not limit it.
    pub floor: Option<Spanned<Quantity>>,
}

/// `[machine]` as serde reads it.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JobMachineTable {
    /// Path of the machine's file, relative to the job file.
    pub file: Option<Spanned<String>>,
    /// Name of a built-in machine, in place of `file`.
    pub preset: Option<Spanned<String>>,
    /// Largest cutting feeds of the axes.
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
    /// Bits per second.
    pub baudrate: Spanned<u32>,
    /// Number of data bits per character.
    pub bytesize: Spanned<u8>,
    /// Parity: `"N"`, `"E"` or `"O"`.
    pub parity: Spanned<String>,
    /// Number of stop bits per character.
    pub stopbits: Spanned<u8>,
    /// The control sends XON/XOFF.
    pub xonxoff: Option<bool>,
    /// RTS/CTS flow control.
    pub rtscts: Spanned<bool>,
    pub dsrdtr: Spanned<bool>,
    pub timeout: Option<Spanned<f64>>,
    /// Longest time for which the line may accept no character, s.
    pub write_timeout: Option<Spanned<f64>>,
    pub inter_byte_timeout: Option<Spanned<f64>>,
    /// The port is locked, so that no other program can open it.
    pub exclusive: Option<bool>,
}

/// `[dnc]` as serde reads it.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DncTable {
    /// Character code that the sender itself produces: `"iso"`, `"eia"` or `"ascii"`.
    pub code: Option<Spanned<String>>,
    /// The TV check of the control is on.
    pub tv_check: bool,
    /// Longest time from the arrival of a DC3 until the sender stops, s.
    pub reaction: Option<Spanned<f64>>,
    /// Longest wait for the control's first DC1, s.
    pub start_timeout: Option<Spanned<f64>>,
    /// Longest wait for DC1 after a DC3, s.
    pub xoff_timeout: Option<Spanned<f64>>,
    /// Number of blocks after which the control reports its position.
    pub report_every: Option<Spanned<usize>>,
    /// Largest number of blocks that the control reads ahead.
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
