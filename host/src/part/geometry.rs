//! `[geometry]`: the rotor, from numbers or from files in the folder of the part file.

use std::path::Path;

use arcfeed_plan::geometry::blade::{RotorAxis, Sections};
use arcfeed_plan::geometry::blisk::{Blank, Blisk, Revolution};
use arcfeed_plan::geometry::curves::{self, CurveFile, Texts};
use arcfeed_plan::geometry::generator::{Hand, POINTS, Rotor, SECTIONS};
use arcfeed_plan::geometry::point_file::{PointFileFrame, ReadError};
use arcfeed_plan::geometry::sections;
use arcfeed_units::LengthUnit;
use toml::Spanned;

use super::PartError;
use super::schema::{CurvesTable, GenerateTable, GeometryTable, HandWord, PointUnit, RotorWord, SectionsTable};
use crate::file_error::FileError;
use crate::job::{Complaint, at, length_mm};

/// Builds the rotor in its blank.
pub(super) fn build(
    entry: &Spanned<GeometryTable>,
    unit: LengthUnit,
    blank: Blank,
    folder: &Path,
) -> Result<Blisk, PartError> {
    let GeometryTable { generate, curves, sections } = entry.as_ref();
    let (blades, hub, blade) = match (generate, curves, sections) {
        (Some(numbers), None, None) => generated(numbers, unit, &blank)?,
        (None, Some(files), None) => from_curves(files, unit, &blank, folder)?,
        (None, None, Some(file)) => from_sections(file, unit, &blank, folder)?,
        _ => {
            let message = "give the rotor as exactly one of `generate`, `curves` or `sections`";
            return Err(at(entry, message).into());
        }
    };
    let [pressure, suction] = blade.faces().map_err(|error| at(entry, &error.to_string()))?;
    Ok(Blisk { blades, pressure, suction, hub, blank })
}

/// Cylinder through the blank.
fn cylinder(radius_mm: f64, blank: &Blank) -> Revolution {
    Revolution { profile_mm: blank.faces_mm.map(|z| [z, radius_mm]).to_vec() }
}

fn generated(
    entry: &Spanned<GenerateTable>,
    unit: LengthUnit,
    blank: &Blank,
) -> Result<(u32, Revolution, Sections), Complaint> {
    let numbers = entry.as_ref();
    let rotor = Rotor {
        blades: numbers.blades,
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
    let blade = rotor.sections(SECTIONS, POINTS).map_err(|error| at(entry, &error.to_string()))?;
    Ok((rotor.blades, cylinder(rotor.hub_radius_mm, blank), blade))
}

fn from_curves(
    entry: &Spanned<CurvesTable>,
    unit: LengthUnit,
    blank: &Blank,
    folder: &Path,
) -> Result<(u32, Revolution, Sections), PartError> {
    let files = entry.as_ref();
    let blades = blades(&files.blades)?;
    let [hub, shroud, profile] = [&files.hub, &files.shroud, &files.profile].map(|file| read(file, folder));
    let (hub, shroud, profile) = (hub?, shroud?, profile?);
    let texts = Texts { hub: &hub, shroud: &shroud, profile: &profile };
    let found = curves::read(&texts, &frame(files.axis, files.units, unit)).map_err(|(which, error)| {
        let file = match which {
            CurveFile::Hub => &files.hub,
            CurveFile::Shroud => &files.shroud,
            CurveFile::Profile => &files.profile,
        };
        in_file(file, folder, &error)
    })?;
    Ok((blades, Revolution { profile_mm: found.hub.between(blank.faces_mm) }, found.blade))
}

fn from_sections(
    entry: &Spanned<SectionsTable>,
    unit: LengthUnit,
    blank: &Blank,
    folder: &Path,
) -> Result<(u32, Revolution, Sections), PartError> {
    let table = entry.as_ref();
    let blades = blades(&table.blades)?;
    let hub = cylinder(length_mm(&table.hub_radius, unit, "hub_radius")?, blank);
    let text = read(&table.file, folder)?;
    let blade = sections::read(&text, &frame(table.axis, table.units, unit), &hub)
        .map_err(|error| in_file(&table.file, folder, &error))?;
    Ok((blades, hub, blade))
}

fn blades(entry: &Spanned<u32>) -> Result<u32, Complaint> {
    match *entry.as_ref() {
        0 | 1 => Err(at(entry, "a rotor has 2 blades at least")),
        blades => Ok(blades),
    }
}

/// Interpretation of the points of a file; they are in the part's units unless `units` is given.
fn frame(axis: RotorWord, units: Option<PointUnit>, unit: LengthUnit) -> PointFileFrame {
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
        Some(PointUnit::M) => 1000.0,
    };
    PointFileFrame { axis, unit_mm }
}

fn read(file: &Spanned<String>, folder: &Path) -> Result<String, Complaint> {
    let path = folder.join(file.as_ref());
    std::fs::read_to_string(&path).map_err(|error| at(file, &format!("{}: {error}", path.display())))
}

fn in_file(file: &Spanned<String>, folder: &Path, error: &ReadError) -> PartError {
    let ReadError { line, column, fault } = error;
    let path = folder.join(file.as_ref());
    PartError::There(FileError::Content { path, line: *line, column: *column, message: fault.to_string() })
}
