//! `[geometry]`: the rotor, from numbers or from files in the folder of the part file.

use std::path::Path;

use arcfeed_plan::geometry::blade::{RotorAxis, Sections};
use arcfeed_plan::geometry::blisk::Blade;
use arcfeed_plan::geometry::blisk::{Blank, Blisk, Revolution};
use arcfeed_plan::geometry::curves::{self, CurveFile, Texts};
use arcfeed_plan::geometry::generator::{Hand, POINTS, Rotor, SECTIONS};
use arcfeed_plan::geometry::point_file::PointFileFrame;
use arcfeed_plan::geometry::step_file::StepFile;
use arcfeed_plan::geometry::{sections, solid};
use arcfeed_units::{LengthUnit, MM_PER_M};
use toml::Spanned;

use super::PartError;
use super::gas_path::{GasPathEntry, cylinder, gas_path};
use super::geometry_files::{FileContext, in_file, read, read_mesh, whole};
use super::schema::{
    CurvesTable, GenerateTable, GeometryTable, HandWord, PointUnit, RotorWord, SectionsTable, StepTable, StlTable,
};
use crate::job::{Complaint, at};

/// Most blades of a rotor.
const BLADES_MAX: i64 = 1_000;

/// Number of main blades, hub, and the sections of the main blade and of the splitter if there is one.
type RotorParts = (u32, Revolution, Vec<Sections>);

/// Builds a rotor in its blank, for a command that plans blades of one kind only.
pub(super) fn build_alike(
    entry: &Spanned<GeometryTable>,
    unit: LengthUnit,
    blank: Blank,
    folder: &Path,
) -> Result<Blisk, PartError> {
    let blisk = build(entry, unit, blank, folder)?;
    if blisk.further_blades.is_empty() {
        return Ok(blisk);
    }
    let message = "this rotor has splitter blades, and only `plan cup-mill` plans rotors with splitters";
    Err(at(entry, message).into())
}

/// Builds the rotor in its blank, with its main blade as the first one.
pub(super) fn build(
    entry: &Spanned<GeometryTable>,
    unit: LengthUnit,
    blank: Blank,
    folder: &Path,
) -> Result<Blisk, PartError> {
    let GeometryTable { generate, curves, sections, stl, step } = entry.as_ref();
    let context = FileContext { unit, blank: &blank, folder };
    let (blades, hub, kinds) = match (generate, curves, sections, stl, step) {
        (Some(numbers), None, None, None, None) => generated(numbers, unit, &blank)?,
        (None, Some(files), None, None, None) => from_curves(files.as_ref(), &context)?,
        (None, None, Some(file), None, None) => from_sections(file, &context)?,
        (None, None, None, Some(files), None) => from_stl(files, &context)?,
        (None, None, None, None, Some(file)) => from_step(file, &context)?,
        _ => {
            let message = "give the rotor as exactly one of `generate`, `curves`, `sections`, `stl` or `step`";
            return Err(at(entry, message).into());
        }
    };
    let faces = |blade: &Sections| {
        let [pressure, suction] = blade.faces().map_err(|error| at(entry, &error.to_string()))?;
        Ok::<_, Complaint>(Blade { pressure, suction })
    };
    let Blade { pressure, suction } = faces(&kinds[0])?;
    let blisk = Blisk { blades, pressure, suction, further_blades: Vec::new(), hub, blank };
    match kinds.get(1) {
        Some(splitter) => {
            blisk.with_splitter(&faces(splitter)?).map_err(|crossing| at(entry, &crossing.to_string()).into())
        }
        None => Ok(blisk),
    }
}

fn generated(entry: &Spanned<GenerateTable>, unit: LengthUnit, blank: &Blank) -> Result<RotorParts, Complaint> {
    let numbers = entry.as_ref();
    let rotor = Rotor {
        blades: blades(&numbers.blades)?,
        hub_radius_mm: numbers.hub_radius.to_mm(unit),
        tip_radius_mm: numbers.tip_radius.to_mm(unit),
        chord_mm: numbers.chord.map(|chord| chord.to_mm(unit)),
        stagger_deg: numbers.stagger_deg,
        camber_deg: numbers.camber_deg,
        thickness_ratio: numbers.thickness_ratio,
        edge_mm: numbers.edge.map_or(0.0, |edge| edge.to_mm(unit)),
        lean_deg: numbers.lean_deg,
        hand: match numbers.hand {
            HandWord::Right => Hand::Right,
            HandWord::Left => Hand::Left,
        },
    };
    if rotor.chord_mm.iter().any(|chord_mm| *chord_mm > 2.0 * rotor.tip_radius_mm) {
        return Err(at(entry, "chord must be less than the rotor's diameter"));
    }
    let blade = rotor.sections(SECTIONS, POINTS).map_err(|error| at(entry, &error.to_string()))?;
    Ok((rotor.blades, cylinder(rotor.hub_radius_mm, blank), vec![blade]))
}

fn from_curves(files: &CurvesTable, context: &FileContext<'_>) -> Result<RotorParts, PartError> {
    let blades = blades(&files.blades)?;
    let [hub, shroud, profile] = [&files.hub, &files.shroud, &files.profile].map(|file| read(file, context.folder));
    let (hub, shroud, profile) = (hub?, shroud?, profile?);
    let texts = Texts { hub: &hub, shroud: &shroud, profile: &profile };
    let found = curves::read(&texts, &frame(files.axis, files.units, context.unit)).map_err(|(which, error)| {
        let file = match which {
            CurveFile::Hub => &files.hub,
            CurveFile::Shroud => &files.shroud,
            CurveFile::Profile => &files.profile,
        };
        in_file(file, context.folder, &error)
    })?;
    Ok((blades, Revolution { profile_mm: found.hub.between(context.blank.faces_mm) }, found.blades))
}

fn from_sections(entry: &Spanned<SectionsTable>, context: &FileContext<'_>) -> Result<RotorParts, PartError> {
    let table = entry.as_ref();
    let blades = blades(&table.blades)?;
    let frame = frame(table.axis, table.units, context.unit);
    let hub = GasPathEntry { names: ["hub", "hub_radius"], file: &table.hub, radius: &table.hub_radius };
    let (hub, _) = gas_path(&hub, &frame, context)?.ok_or_else(|| hub.missing(entry))?;
    let text = read(&table.file, context.folder)?;
    let kinds = sections::read(&text, &frame, &hub).map_err(|error| in_file(&table.file, context.folder, &error))?;
    Ok((blades, hub, kinds))
}

fn from_stl(entry: &Spanned<StlTable>, context: &FileContext<'_>) -> Result<RotorParts, PartError> {
    let files = entry.as_ref();
    let blades = blades(&files.blades)?;
    let frame = frame(files.axis, files.units, context.unit);
    let hub = GasPathEntry { names: ["hub", "hub_radius"], file: &files.hub, radius: &files.hub_radius };
    let (hub, from_low_z) = gas_path(&hub, &frame, context)?.ok_or_else(|| hub.missing(entry))?;
    let tip = GasPathEntry { names: ["shroud", "tip_radius"], file: &files.shroud, radius: &files.tip_radius };
    let tip = gas_path(&tip, &frame, context)?.map(|(tip, _)| tip);
    let sections = |file: &Spanned<String>| {
        let mesh = read_mesh(file, &frame, context.folder)?;
        solid::sections(&mesh, &hub, tip.as_ref(), from_low_z)
            .map_err(|fault| whole(file, context.folder, &fault.to_string()))
    };
    let main = sections(&files.blade)?;
    let splitter = files.splitter.as_ref().map(sections).transpose()?;
    Ok((blades, hub, kinds(main, splitter)))
}

fn from_step(entry: &Spanned<StepTable>, context: &FileContext<'_>) -> Result<RotorParts, PartError> {
    let table = entry.as_ref();
    let blades = blades(&table.blades)?;
    let frame = frame(table.axis, None, context.unit);
    let text = read(&table.file, context.folder)?;
    let wrong = |message: String| whole(&table.file, context.folder, &message);
    let file = StepFile::read(&text, frame.axis).map_err(|fault| wrong(fault.to_string()))?;
    let hub = GasPathEntry { names: ["hub", "hub_radius"], file: &table.hub, radius: &table.hub_radius };
    let (hub, from_low_z) = match (&table.hub_faces, gas_path(&hub, &frame, context)?) {
        (Some(_), Some(_)) => {
            let message = "give one of `hub_faces`, `hub` and `hub_radius`";
            return Err(at(entry, message).into());
        }
        (Some(names), None) => {
            let found = file.hub(names.as_ref()).map_err(|fault| wrong(fault.to_string()))?;
            (Revolution { profile_mm: found.between(context.blank.faces_mm) }, true)
        }
        (None, given) => given.ok_or_else(|| hub.missing(entry))?,
    };
    let tip = GasPathEntry { names: ["shroud", "tip_radius"], file: &table.shroud, radius: &table.tip_radius };
    let tip = gas_path(&tip, &frame, context)?.map(|(tip, _)| tip);
    let sections = |names: &Vec<String>| {
        let mesh = file.mesh(names).map_err(|fault| wrong(fault.to_string()))?;
        solid::sections(&mesh, &hub, tip.as_ref(), from_low_z).map_err(|fault| wrong(fault.to_string()))
    };
    let main = sections(&table.blade)?;
    let splitter = table.splitter.as_ref().map(sections).transpose()?;
    Ok((blades, hub, kinds(main, splitter)))
}

/// Main blade and splitter, whose sides surfaces do not name.
fn kinds(main: Sections, splitter: Option<Sections>) -> Vec<Sections> {
    let splitter = splitter.map(|blade| blade.named_as(&main));
    std::iter::once(main).chain(splitter).collect()
}

fn blades(entry: &Spanned<i64>) -> Result<u32, Complaint> {
    match *entry.as_ref() {
        count @ 2..=BLADES_MAX => Ok(count.unsigned_abs() as u32),
        _ => Err(at(entry, &format!("a rotor has 2 to {BLADES_MAX} blades"))),
    }
}

/// Interpretation of the points of a file; they are in the part's units unless `units` is given.
pub(super) fn frame(axis: RotorWord, units: Option<PointUnit>, unit: LengthUnit) -> PointFileFrame {
    let axis = match axis {
        RotorWord::X => RotorAxis::X,
        RotorWord::Y => RotorAxis::Y,
        RotorWord::Z => RotorAxis::Z,
    };
    let unit_mm = match units {
        None => unit.mm(),
        Some(PointUnit::Inch) => LengthUnit::Inch.mm(),
        Some(PointUnit::Mm) => 1.0,
        Some(PointUnit::Cm) => 10.0,
        Some(PointUnit::M) => MM_PER_M,
    };
    PointFileFrame { axis, unit_mm }
}
