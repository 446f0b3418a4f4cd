//! `PART.toml` (docs/plan.md): a bladed rotor, its blank and its cutter; reading and checking. Every complaint names
//! its place in the file.

mod finish_table;

mod schema;

mod geometry_files;

mod gas_path;

mod geometry;

mod tool;

mod slot_kind;

pub mod plunge;

pub mod finish;

pub mod repair;

use std::path::{Path, PathBuf};

use arcfeed_plan::cup_mill::plan::{AxisChoice, Roughing};
use arcfeed_plan::cutter::CupMill;
use arcfeed_plan::geometry::blisk::{Blank, Blisk};
use arcfeed_plan::vector::Point;
use arcfeed_units::LengthUnit;
use toml::Spanned;

use crate::file_error::FileError;
use crate::job::{Complaint, Quantity, at, length_mm, machine, positive};
use crate::machine_file::MachineFile;
use crate::place::place;
use crate::toml_reader;
use crate::toml_values::with_key;
use schema::{
    AxisWord, BaselineTable, BlankTable, FixtureTable, LawWord, OutputTable, PartMachineTable, PartTable, RoughingTable,
};

/// Default of `interior_contact`, a fraction, and of `clearance`.
const INTERIOR_CONTACT: f64 = 0.1;
const CLEARANCE_MM: f64 = 5.0;
/// Most levels over the whole radius of a blank.
const LEVELS_MAX: f64 = 1_000.0;
/// Largest O number.
const NUMBER_MAX: u32 = 9_999;
/// Most passes through a slot.
pub const PASSES_MAX: u32 = 4;
/// Largest radius of a blank: a larger one is in another unit than its number.
const RADIUS_MAX_MM: f64 = 5_000.0;

/// Content of a part file for roughing with a cup mill, checked. Coordinates are those of the part, in mm.
#[derive(Clone, Debug)]
pub struct PartFile {
    /// Name in the part file, or else the file's own name.
    pub name: String,
    /// Unit of lengths in the file.
    pub unit: LengthUnit,
    /// Rotor: blades, hub and blank. Its first blade is that of the pressure side of the planned slot.
    pub blisk: Blisk,
    /// Kind of slot that is planned: 1 at the pressure side of the main blade, 2 at that of the splitter.
    pub slot: i32,
    /// Cup mill with its holder.
    pub cutter: CupMill,
    /// Requirements on the roughing path (allowance, distances, levels).
    pub roughing: Roughing,
    /// Direction of the tool's axis, if the file gives it; otherwise the planner chooses the one with the largest
    /// removed volume.
    pub axis: Option<AxisChoice>,
    /// Largest number of passes through a slot, at least 1.
    pub passes_max: usize,
    /// Spindle speed and feeds.
    pub feeds: Feeds,
    /// The job that is written uses the whole engaged arcs of both circles (law `engaged-arc`), not only the contact
    /// with the stock line.
    pub is_engaged_arc: bool,
    /// Fixtures as boxes: corners with the lowest and with the highest coordinates.
    pub fixtures: Vec<[Point; 2]>,
    /// Machine, if the file names one.
    pub machine: Option<MachineFile>,
    /// File or preset from which the machine was read; `None` without a machine.
    pub machine_source: Option<MachineSource>,
    /// Settings for the NC program that is written.
    pub output: Output,
    /// Flank milling with which the plan's time is compared, if the file describes it.
    pub baseline: Option<BaselineSettings>,
}

/// File or preset by which a part names its machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MachineSource {
    /// Path of the file, relative to the working directory.
    File(PathBuf),
    /// Preset, by its name.
    Preset(String),
}

/// Spindle speed and feeds of a part file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feeds {
    /// Spindle speed, rev/min.
    pub rev_per_min: f64,
    /// Feed per tooth on the cutting circumference, mm.
    pub per_tooth_mm: f64,
    /// Feed down to the first level, mm/min; `None`: the cutting feed.
    pub approach_mm_per_min: Option<f64>,
    /// Feed from level to level, mm/min; `None`: the cutting feed.
    pub axial_mm_per_min: Option<f64>,
}

/// Settings of a part file for the NC program that is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Output {
    /// Unit of the program: G20 (inch) or G21 (mm).
    pub unit: LengthUnit,
    /// Program number (O word).
    pub number: u32,
    /// Number of the tool, for T and H.
    pub tool: u32,
    /// The program switches coolant on and off (M8, M9).
    pub coolant: bool,
    /// The program has DPRNT blocks by which the control reports slots and levels.
    pub dprnt: bool,
}

/// Settings for the flank milling with a ball-end mill with which a plan's time is compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaselineSettings {
    /// Diameter of the ball-end mill, mm.
    pub diameter_mm: f64,
    /// Number of its teeth.
    pub teeth: u16,
    /// Feed along the passes, mm/min.
    pub feed_mm_per_min: f64,
    /// Largest distance of levels (axial depth), mm.
    pub axial_depth_mm: f64,
    /// Largest distance of neighbouring passes, mm.
    pub stepover_mm: f64,
}

/// Fault at a byte offset of the part file, or in another file.
enum PartError {
    Here(Complaint),
    There(FileError),
}

impl From<Complaint> for PartError {
    fn from(complaint: Complaint) -> Self {
        PartError::Here(complaint)
    }
}

impl PartFile {
    /// Reads and checks a part file and the files it names.
    ///
    /// # Errors
    /// See [`FileError`].
    pub fn load(path: &Path) -> Result<Self, FileError> {
        PartFile::parse(path, &read(path)?)
    }

    /// Checks a part given as text. `path` is used in messages and to locate the files that it names.
    ///
    /// # Errors
    /// See [`FileError`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, FileError> {
        parse(path, text, build)
    }
}

fn read(path: &Path) -> Result<String, FileError> {
    std::fs::read_to_string(path).map_err(|source| FileError::Read { path: path.into(), source })
}

/// Reads the tables of a part, and checks them by `build`, which takes the tables, the part file and its folder.
fn parse<T>(
    path: &Path,
    text: &str,
    build: impl Fn(&PartTable, &Path, &Path) -> Result<T, PartError>,
) -> Result<T, FileError> {
    let table = toml_reader::read::<PartTable>(text).map_err(|(offset, message)| {
        let is_iges = message.starts_with("unknown field `iges`");
        (offset, if is_iges { geometry_files::IGES.to_owned() } else { message })
    });
    let folder = path.parent().unwrap_or(Path::new(""));
    let built = table.map_err(PartError::Here).and_then(|table| build(&table, path, folder));
    built.map_err(|wrong| match wrong {
        PartError::There(error) => error,
        PartError::Here((offset, message)) => {
            let [line, column] = place(text, offset);
            FileError::Content { path: path.into(), line, column, message: with_key(text, offset, &message) }
        }
    })
}

fn build(table: &PartTable, path: &Path, folder: &Path) -> Result<PartFile, PartError> {
    let unit: LengthUnit = table.units.into();
    let blank = blank(&table.blank, unit)?;
    let cutter = table.cutter.as_ref().ok_or((0, "a cup mill's plan needs the table [cutter]".into()))?;
    let cutter = tool::build(cutter, unit)?;
    let (roughing, feeds) = roughing(&table.roughing, unit)?;
    let machine = machine::named(table.machine.file.as_ref(), table.machine.preset.as_ref(), folder, &[])?;
    check_speed(&table.roughing.rev_per_min, machine.as_ref())?;
    if let Some(entry) = &table.roughing.axial_depth_max {
        check_levels(entry, roughing.axial_depth_max_mm, &blank)?;
    }
    let fixtures = table.fixture.iter().map(|entry| fixture(entry, unit)).collect::<Result<_, _>>()?;
    let blisk = geometry::build(&table.geometry, unit, blank, folder)?;
    let slot = slot_kind::slot(table.roughing.slot.as_ref(), &blisk)?;
    let passes_max = passes_max(table.roughing.passes_max.as_ref())?;
    let output = output(&table.output, unit)?;
    check_numbers(&table.output, passes_max)?;
    Ok(PartFile {
        name: name(table, path),
        unit,
        cutter,
        roughing,
        axis: axis(table.roughing.axis),
        passes_max,
        is_engaged_arc: table.roughing.law == LawWord::EngagedArc,
        feeds,
        fixtures,
        machine,
        machine_source: machine_source(&table.machine, folder),
        output,
        baseline: table.baseline.as_ref().map(|entry| baseline(entry, unit)).transpose()?,
        blisk: if slot == 1 { blisk } else { blisk.from_blade(slot - 1) },
        slot,
    })
}

/// Rejects a depth that makes more levels than a program can have.
fn check_levels(entry: &Spanned<Quantity>, depth_mm: f64, blank: &Blank) -> Result<(), Complaint> {
    let least_mm = blank.radius_mm / LEVELS_MAX;
    if depth_mm >= least_mm {
        return Ok(());
    }
    let message = format!(
        "with levels of {depth_mm:.4} mm a blank of {:.3} mm radius takes thousands of them; {least_mm:.3} mm at least",
        blank.radius_mm
    );
    Err(at(entry, &message))
}

/// Rejects an O number from which on there are not enough for all passes.
fn check_numbers(entry: &OutputTable, passes_max: usize) -> Result<(), Complaint> {
    match &entry.number {
        Some(number) if *number.as_ref() as usize + passes_max > NUMBER_MAX as usize + 1 => Err(at(
            number,
            &format!(
                "{passes_max} passes need {passes_max} O numbers, this one and those after it, up to {NUMBER_MAX}"
            ),
        )),
        _ => Ok(()),
    }
}

/// Rejects a speed that the machine's spindle does not have.
fn check_speed(entry: &Spanned<f64>, machine: Option<&MachineFile>) -> Result<(), Complaint> {
    let Some([low, high]) = machine.and_then(|machine| machine.spindle_range_rev_per_min) else { return Ok(()) };
    if (low..=high).contains(entry.as_ref()) {
        return Ok(());
    }
    Err(at(entry, &format!("the machine's spindle turns at {low} to {high} rev/min (`spindle_range` of its file)")))
}

/// Name of the part, or else that of the file.
fn name(table: &PartTable, path: &Path) -> String {
    let own_name = || path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    table.name.clone().unwrap_or_else(own_name)
}

fn machine_source(entry: &PartMachineTable, folder: &Path) -> Option<MachineSource> {
    let file = entry.file.as_ref().map(|file| MachineSource::File(folder.join(file.as_ref())));
    file.or_else(|| entry.preset.as_ref().map(|preset| MachineSource::Preset(preset.as_ref().clone())))
}

fn axis(entry: AxisWord) -> Option<AxisChoice> {
    match entry {
        AxisWord::Auto => None,
        AxisWord::Blade => Some(AxisChoice::Blade),
        AxisWord::Roomiest => Some(AxisChoice::Roomiest),
    }
}

fn blank(entry: &BlankTable, unit: LengthUnit) -> Result<Blank, Complaint> {
    let faces_mm = [&entry.from, &entry.to].map(|face| face.as_ref().to_mm(unit));
    if faces_mm[0].is_nan() || faces_mm[1].is_nan() || faces_mm[0] >= faces_mm[1] {
        return Err(at(&entry.to, "`to` must lie above `from`, along the rotor's axis"));
    }
    let radius_mm = length_mm(&entry.radius, unit, "radius")?;
    if radius_mm > RADIUS_MAX_MM {
        let message =
            format!("a blank's radius is {RADIUS_MAX_MM} mm at most; this one is {radius_mm} mm: check `units`");
        return Err(at(&entry.radius, &message));
    }
    if faces_mm.iter().any(|face| face.abs() > RADIUS_MAX_MM) {
        let message = format!("a blank's face lies {RADIUS_MAX_MM} mm from zero at most: check `units`");
        return Err(at(&entry.from, &message));
    }
    Ok(Blank { radius_mm, faces_mm })
}

fn roughing(entry: &RoughingTable, unit: LengthUnit) -> Result<(Roughing, Feeds), Complaint> {
    let feed = |given: &Option<Spanned<Quantity>>, name: &str| {
        given.as_ref().map(|given| length_mm(given, unit, name)).transpose()
    };
    let interior_contact = match &entry.interior_contact {
        Some(share) if !(*share.as_ref() > 0.0 && *share.as_ref() < 1.0) => {
            return Err(at(share, "interior_contact is a share of the suction side's tip curve, between 0 and 1"));
        }
        given => given.as_ref().map_or(INTERIOR_CONTACT, |share| *share.as_ref()),
    };
    let needed = "a cup mill's plan needs `axial_depth_max` in [roughing]";
    let axial_depth_max = entry.axial_depth_max.as_ref().ok_or_else(|| at(&entry.allowance, needed))?;
    let roughing = Roughing {
        allowance_mm: length_mm(&entry.allowance, unit, "allowance")?,
        axial_depth_max_mm: length_mm(axial_depth_max, unit, "axial_depth_max")?,
        interior_contact,
        clearance_mm: feed(&entry.clearance, "clearance")?.unwrap_or(CLEARANCE_MM),
        axis: axis(entry.axis).unwrap_or_default(),
    };
    let feeds = Feeds {
        rev_per_min: positive(&entry.rev_per_min, "rev_per_min")?,
        per_tooth_mm: length_mm(&entry.feed_per_tooth, unit, "feed_per_tooth")?,
        approach_mm_per_min: feed(&entry.approach_feed, "approach_feed")?,
        axial_mm_per_min: feed(&entry.axial_feed, "axial_feed")?,
    };
    Ok((roughing, feeds))
}

fn passes_max(entry: Option<&Spanned<u32>>) -> Result<usize, Complaint> {
    match entry {
        Some(given) if !(1..=PASSES_MAX).contains(given.as_ref()) => {
            Err(at(given, &format!("passes_max must be 1 to {PASSES_MAX}")))
        }
        given => Ok(given.map_or(1, |given| *given.as_ref() as usize)),
    }
}

fn fixture(entry: &Spanned<FixtureTable>, unit: LengthUnit) -> Result<[Point; 2], Complaint> {
    let FixtureTable { from, to } = entry.as_ref();
    let [low, high] = [from, to].map(|corner| Point::from(corner.map(|value| value.to_mm(unit))));
    let is_box = (0..3).all(|axis| low[axis] < high[axis]);
    if is_box {
        Ok([low, high])
    } else {
        Err(at(entry, "a fixture's `to` must lie above its `from`, along x, y and z"))
    }
}

fn output(entry: &OutputTable, unit: LengthUnit) -> Result<Output, Complaint> {
    let within = |given: &Option<Spanned<u32>>, name: &str, most: u32, unless: u32| match given {
        Some(number) if !(1..=most).contains(number.as_ref()) => {
            Err(at(number, &format!("{name} must be 1 to {most}")))
        }
        given => Ok(given.as_ref().map_or(unless, |number| *number.as_ref())),
    };
    Ok(Output {
        unit: entry.units.map_or(unit, Into::into),
        number: within(&entry.number, "number", NUMBER_MAX, 1)?,
        tool: within(&entry.tool, "tool", 9999, 1)?,
        coolant: entry.coolant.unwrap_or(true),
        dprnt: entry.dprnt.unwrap_or(false),
    })
}

fn baseline(entry: &BaselineTable, unit: LengthUnit) -> Result<BaselineSettings, Complaint> {
    Ok(BaselineSettings {
        diameter_mm: length_mm(&entry.diameter, unit, "diameter")?,
        teeth: tool::teeth(&entry.teeth)?,
        feed_mm_per_min: length_mm(&entry.feed, unit, "feed")?,
        axial_depth_mm: length_mm(&entry.axial_depth, unit, "axial_depth")?,
        stepover_mm: length_mm(&entry.stepover, unit, "stepover")?,
    })
}

#[cfg(test)]
mod tests;
