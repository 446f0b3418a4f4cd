//! `REPAIR.toml` (docs/repair.md): a blade of a rotor, points measured on it, and what its repair is to leave.

use std::path::{Path, PathBuf};

use arcfeed_plan::geometry::edge_strip::BladeEdge;
use arcfeed_plan::geometry::flaws::BladeSide;
use arcfeed_plan::geometry::point_cloud;
use arcfeed_plan::repair::blade::RepairedPart;
use arcfeed_plan::repair::blend::BlendShape;
use arcfeed_plan::repair::evenness::DatumTolerance;
use arcfeed_plan::repair::passes::PassSettings;
use arcfeed_plan::repair::plan::RepairSettings;
use arcfeed_plan::repair::regions::RegionSettings;
use arcfeed_plan::repair::registration::DIRECTIONS;
use arcfeed_plan::vector::Point;
use arcfeed_units::LengthUnit;
use serde::Deserialize;
use toml::Spanned;

use super::PartError;
use super::finish::FinishPart;
use super::geometry::frame;
use super::geometry_files::{bytes, in_file, read, whole};
use super::schema::{PointUnit, RotorWord};
use crate::file_error::FileError;
use crate::job::{Complaint, Quantity, UnitWord, at, length_mm};
use crate::place::place;
use crate::toml_reader;
use crate::toml_values::with_key;

/// Default of `uncertainty`.
const UNCERTAINTY_MM: f64 = 0.005;
/// Default of `spacing`.
const SPACING_MM: f64 = 0.5;
/// Greatest distance of contact points, among which those of the path are chosen.
const DENSE_MM: f64 = 0.1;
/// Largest motion that a datum's tolerance allows.
const SHIFT_MAX_MM: f64 = 2.0;
const TURN_MAX_DEG: f64 = 2.0;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RepairFileTable {
    units: UnitWord,
    name: Option<String>,
    nominal: NominalTable,
    measured: MeasuredTable,
    #[serde(default)]
    datum: DatumTable,
    repair: RepairTable,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct NominalTable {
    part: Spanned<String>,
    blade: Option<Spanned<u32>>,
    side: SideWord,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum SideWord {
    Pressure,
    Suction,
    Leading,
    Trailing,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct MeasuredTable {
    points: Spanned<String>,
    units: Option<PointUnit>,
    #[serde(default)]
    axis: RotorWord,
    stylus_radius: Option<Spanned<Quantity>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct DatumTable {
    #[serde(default)]
    free: Vec<Spanned<String>>,
    uncertainty: Option<Spanned<Quantity>>,
    shift: Option<Spanned<Quantity>>,
    turn_deg: Option<Spanned<f64>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RepairTable {
    threshold: Spanned<Quantity>,
    width: Spanned<Quantity>,
    least: Spanned<Quantity>,
    #[serde(default)]
    blend: BlendWord,
    rough: Spanned<Quantity>,
    depth: Spanned<Quantity>,
    spacing: Option<Spanned<Quantity>>,
    hole: Option<Spanned<Quantity>>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum BlendWord {
    Linear,
    #[default]
    Cubic,
    Quintic,
}

/// Content of a repair file, checked. Coordinates are those of the part, in mm.
#[derive(Clone, Debug)]
pub struct RepairFile {
    /// Name in the file, or else the file's own name.
    pub name: String,
    /// Paths of the files that it names: the part file and the measured points.
    pub inputs: Vec<PathBuf>,
    /// Part with its finishing mill, machine and feeds.
    pub part: FinishPart,
    /// Number of the repaired blade, counted from 1.
    pub blade: u32,
    /// Side that is repaired, or edge over which the repair runs.
    pub repaired: RepairedPart,
    /// Measured points.
    pub points: Vec<Point>,
    /// Radius of the stylus, if the points are centres of its ball; 0 if they are points on the surface. In mm.
    pub stylus_mm: f64,
    /// Directions of motion (three rotations, three shifts) that the measured points determine in the registration.
    pub free: [bool; 6],
    /// Uncertainty of a measured point, mm.
    pub uncertainty_mm: f64,
    /// Motion within the datum's tolerances that may be used to make the allowance even; `None`: no motion.
    pub tolerance: Option<DatumTolerance>,
    /// Requirements on the finished blade and on the path.
    pub settings: RepairSettings,
}

impl RepairFile {
    /// Reads and checks a repair file and the files it names.
    ///
    /// # Errors
    /// See [`FileError`].
    pub fn load(path: &Path) -> Result<Self, FileError> {
        RepairFile::parse(path, &super::read(path)?)
    }

    /// Checks a repair given as text. `path` is used in messages and to locate the files that it names.
    ///
    /// # Errors
    /// See [`FileError`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, FileError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let table = toml_reader::read::<RepairFileTable>(text);
        table.map_err(PartError::Here).and_then(|table| build(&table, path, folder)).map_err(|wrong| match wrong {
            PartError::There(error) => error,
            PartError::Here((offset, message)) => {
                let [line, column] = place(text, offset);
                FileError::Content { path: path.into(), line, column, message: with_key(text, offset, &message) }
            }
        })
    }
}

fn build(table: &RepairFileTable, path: &Path, folder: &Path) -> Result<RepairFile, PartError> {
    let unit: LengthUnit = table.units.into();
    let (text, part) = (read(&table.nominal.part, folder)?, folder.join(table.nominal.part.as_ref()));
    let part = FinishPart::parse(&part, &text).map_err(PartError::There)?;
    let own_name = || path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let (uncertainty_mm, free, tolerance) = datum(&table.datum, unit)?;
    let stylus = table.measured.stylus_radius.as_ref();
    Ok(RepairFile {
        name: table.name.clone().unwrap_or_else(own_name),
        inputs: [&table.nominal.part, &table.measured.points].map(|file| folder.join(file.as_ref())).to_vec(),
        blade: blade(table.nominal.blade.as_ref(), part.blisk.blades)?,
        repaired: match table.nominal.side {
            SideWord::Pressure => RepairedPart::Side(BladeSide::Pressure),
            SideWord::Suction => RepairedPart::Side(BladeSide::Suction),
            SideWord::Leading => RepairedPart::Edge(BladeEdge::Leading),
            SideWord::Trailing => RepairedPart::Edge(BladeEdge::Trailing),
        },
        stylus_mm: stylus.map_or(Ok(0.0), |given| length_mm(given, unit, "stylus_radius"))?,
        settings: settings(table, &part, unit)?,
        points: points(&table.measured, unit, folder)?,
        uncertainty_mm,
        free,
        tolerance,
        part,
    })
}

fn blade(entry: Option<&Spanned<u32>>, blades: u32) -> Result<u32, Complaint> {
    match entry {
        Some(number) if !(1..=blades).contains(number.as_ref()) => {
            Err(at(number, &format!("the rotor has blades 1 to {blades}")))
        }
        given => Ok(given.map_or(1, |number| *number.as_ref())),
    }
}

fn points(entry: &MeasuredTable, unit: LengthUnit, folder: &Path) -> Result<Vec<Point>, PartError> {
    let frame = frame(entry.axis, entry.units, unit);
    let file = &entry.points;
    let ending = Path::new(file.as_ref()).extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let cloud = |points: std::io::Result<Vec<Point>>, kind: &str| {
        points.map_err(|error| {
            let message = format!("this is no complete {kind} file ({error}); export it anew");
            whole(file, folder, &message)
        })
    };
    match ending.as_deref() {
        Some("stl") => cloud(point_cloud::from_stl(&bytes(file, folder)?, &frame), "STL"),
        Some("ply") => cloud(point_cloud::from_ply(&bytes(file, folder)?, &frame), "PLY"),
        _ => {
            let text = read(file, folder)?;
            point_cloud::from_table(&text, &frame).map_err(|error| in_file(file, folder, &error))
        }
    }
}

type Datum = (f64, [bool; 6], Option<DatumTolerance>);

fn datum(entry: &DatumTable, unit: LengthUnit) -> Result<Datum, Complaint> {
    let mut free = [false; 6];
    for name in &entry.free {
        let known = DIRECTIONS.iter().position(|direction| direction == name.as_ref());
        let wrong =
            || at(name, &format!("`free` takes directions that the points determine: {}", DIRECTIONS.join(", ")));
        free[known.ok_or_else(wrong)?] = true;
    }
    let length = |given: &Option<Spanned<Quantity>>, name: &str, unless: f64| match given {
        Some(given) if given.as_ref().to_mm(unit) == 0.0 => Ok(0.0),
        given => given.as_ref().map_or(Ok(unless), |given| length_mm(given, unit, name)),
    };
    let shift_mm = length(&entry.shift, "shift", 0.0)?;
    if let Some(given) = entry.shift.as_ref().filter(|_| shift_mm > SHIFT_MAX_MM) {
        return Err(at(given, &format!("a datum's tolerance is {SHIFT_MAX_MM} mm at most")));
    }
    let turn_deg = entry.turn_deg.as_ref().map_or(0.0, |given| *given.as_ref());
    if let Some(given) = entry.turn_deg.as_ref().filter(|_| !(0.0..=TURN_MAX_DEG).contains(&turn_deg)) {
        return Err(at(given, &format!("turn_deg is 0 to {TURN_MAX_DEG} degrees")));
    }
    let tolerance = DatumTolerance { shift_mm, turn_rad: turn_deg.to_radians() };
    let is_held = shift_mm == 0.0 && turn_deg == 0.0;
    let uncertainty_mm = length(&entry.uncertainty, "uncertainty", UNCERTAINTY_MM)?;
    Ok((uncertainty_mm, free, (!is_held).then_some(tolerance)))
}

fn settings(table: &RepairFileTable, part: &FinishPart, unit: LengthUnit) -> Result<RepairSettings, Complaint> {
    let RepairTable { threshold, width, least, rough, depth, spacing, hole, blend } = &table.repair;
    let least_mm = match least.as_ref().to_mm(unit) {
        0.0 => 0.0,
        _ => length_mm(least, unit, "least")?,
    };
    let rough_mm = length_mm(rough, unit, "rough")?;
    if rough_mm <= least_mm {
        return Err(at(
            rough,
            &format!("`rough` must be more than `least`, {least_mm} mm: finishing takes the difference"),
        ));
    }
    if !part.mill.is_ball() {
        let message = "repairs are finished by a ball: in the part file's [finish] leave `corner_radius` out";
        return Err(at(&table.nominal.part, message));
    }
    let (ball_mm, cusp_mm) = (part.mill.corner_radius_mm, part.needs.scallop_mm);
    if cusp_mm >= ball_mm {
        return Err(at(&table.nominal.part, "`scallop` of its [finish] must be less than the ball's radius"));
    }
    // One half is for the chords between contact points, the other for those between the chosen ones.
    let chord_mm = part.needs.sampling.tolerance_mm / 2.0;
    Ok(RepairSettings {
        regions: RegionSettings {
            threshold_mm: length_mm(threshold, unit, "threshold")?,
            width_mm: length_mm(width, unit, "width")?,
            least_mm,
            shape: match blend {
                BlendWord::Linear => BlendShape::Linear,
                BlendWord::Cubic => BlendShape::Cubic,
                BlendWord::Quintic => BlendShape::Quintic,
            },
        },
        passes: PassSettings { ball_mm, cusp_mm, chord_mm, step_mm: DENSE_MM },
        spacing_mm: spacing.as_ref().map_or(Ok(SPACING_MM), |given| length_mm(given, unit, "spacing"))?,
        hole_mm: hole.as_ref().map(|given| length_mm(given, unit, "hole")).transpose()?,
        rough_mm,
        depth_mm: length_mm(depth, unit, "depth")?,
    })
}
