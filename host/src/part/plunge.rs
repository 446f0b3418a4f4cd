//! `[plunge]` of a part file: the mill that plunges, and its requirements. Without `[cutter]` the part is planned for plunging only.

use std::path::Path;

use arcfeed_plan::geometry::blisk::Blisk;
use arcfeed_plan::output::end_mill_job::PlungeLimits;
use arcfeed_plan::plunge::line::Fit;
use arcfeed_plan::plunge::mill::PlungeMill;
use arcfeed_plan::plunge::passage::PlungeRequirements;
use arcfeed_plan::vector::Point;
use arcfeed_units::LengthUnit;
use toml::Spanned;

use super::schema::{FitWord, PartPlungeLawTable, PartPlungeTable, PartTable};
use super::{BaselineSettings, CLEARANCE_MM, Feeds, MachineSource, Output, PartError, PartFile};
use crate::file_error::FileError;
use crate::job::{Complaint, Quantity, at, length_mm, machine, positive, spindle};
use crate::machine_file::MachineFile;

/// Default of `relief`.
const RELIEF_MM: f64 = 0.2;
/// Default of `cusp`, as a share of the allowance.
const CUSP_RATIO: f64 = 0.25;
/// Length of a mill without neck and holder, whose shank is as thick as its end, in diameters.
const SHANK_DIAMETERS: f64 = 20.0;

/// Content of a part file for plunge milling, checked. Coordinates are those of the part, in mm.
#[derive(Clone, Debug)]
pub struct PlungePart {
    /// Name in the part file, or else the file's own name.
    pub name: String,
    /// Rotor: blades, hub and blank.
    pub blisk: Blisk,
    /// Plunging mill with its holder.
    pub mill: PlungeMill,
    /// Requirements on the plunges (allowance, distances).
    pub needs: PlungeRequirements,
    /// Spindle speed and feeds.
    pub feeds: Feeds,
    /// Limits for the plunge law in the job that is written; `None`: the plunges keep their programmed feed.
    pub law: Option<PlungeLimits>,
    /// Fixtures as boxes: corners with the lowest and with the highest coordinates.
    pub fixtures: Vec<[Point; 2]>,
    /// Machine, if the file names one.
    pub machine: Option<MachineFile>,
    /// File or preset from which the machine was read; `None` without a machine.
    pub machine_source: Option<MachineSource>,
    /// Settings for the NC program that is written.
    pub output: Output,
    /// Flank milling of the same passages, for comparison.
    pub baseline: Option<BaselineSettings>,
    /// The same part for its cup mill, for comparison, if it names one; or what its tables lack for that.
    pub cup_mill: Option<Result<Box<PartFile>, String>>,
}

impl PlungePart {
    /// Reads and checks a part file and the files it names.
    ///
    /// # Errors
    /// See [`FileError`].
    pub fn load(path: &Path) -> Result<Self, FileError> {
        PlungePart::parse(path, &super::read(path)?)
    }

    /// Checks a part given as text. `path` is used in messages and to locate the files that it names.
    ///
    /// # Errors
    /// See [`FileError`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, FileError> {
        super::parse(path, text, build)
    }
}

fn build(table: &PartTable, path: &Path, folder: &Path) -> Result<PlungePart, PartError> {
    let unit: LengthUnit = table.units.into();
    let entry =
        table.plunge.as_ref().ok_or((0, "plunging needs the table [plunge]: diameter and teeth at least".into()))?;
    let blank = super::blank(&table.blank, unit)?;
    let mill = mill(entry.as_ref(), unit)?;
    let allowance_mm = length_mm(&table.roughing.allowance, unit, "allowance")?;
    let fixtures = table.fixture.iter().map(|entry| super::fixture(entry, unit)).collect::<Result<_, _>>()?;
    Ok(PlungePart {
        name: super::name(table, path),
        needs: needs(entry.as_ref(), &mill, allowance_mm, unit)?,
        mill,
        feeds: feeds(entry.as_ref(), table, unit)?,
        law: entry.as_ref().law.as_ref().map(law).transpose()?,
        fixtures,
        machine: machine::named(table.machine.file.as_ref(), table.machine.preset.as_ref(), folder, &[])?,
        machine_source: super::machine_source(&table.machine, folder),
        output: super::output(&table.output, unit)?,
        baseline: table.baseline.as_ref().map(|entry| super::baseline(entry, unit)).transpose()?,
        cup_mill: table.cutter.as_ref().map(|_| cup_mill(table, path, folder)),
        blisk: super::geometry::build_alike(&table.geometry, unit, blank, folder)?,
    })
}

fn cup_mill(table: &PartTable, path: &Path, folder: &Path) -> Result<Box<PartFile>, String> {
    super::build(table, path, folder).map(Box::new).map_err(|error| match error {
        PartError::Here((_, message)) => message,
        PartError::There(error) => error.to_string(),
    })
}

fn mill(entry: &PartPlungeTable, unit: LengthUnit) -> Result<PlungeMill, Complaint> {
    let radius_mm = length_mm(&entry.diameter, unit, "diameter")? / 2.0;
    let below_radius = |given: &Option<Spanned<Quantity>>, name: &str| match given {
        None => Ok(0.0),
        Some(given) => {
            let given_mm = given.as_ref().to_mm(unit);
            let message = format!("{name} must be 0 or more, and below the mill's radius of {radius_mm:.3} mm");
            if (0.0..radius_mm).contains(&given_mm) { Ok(given_mm) } else { Err(at(given, &message)) }
        }
    };
    let cylinders = |given: &[Spanned<[Quantity; 2]>], name: &str| {
        let one = |cylinder: &Spanned<[Quantity; 2]>| {
            let of_mm = cylinder.as_ref().map(|value| value.to_mm(unit));
            let is_one = of_mm.iter().all(|value| *value > 0.0 && *value < 1e5);
            let message = format!("a cylinder of the {name} is [radius, length], both positive");
            if is_one { Ok(of_mm) } else { Err(at(cylinder, &message)) }
        };
        given.iter().map(one).collect::<Result<Vec<_>, _>>()
    };
    let corner_radius_mm = below_radius(&entry.corner_radius, "corner_radius")?;
    let core_radius_mm = below_radius(&entry.core_radius, "core_radius")?;
    let (neck_mm, holder_mm) = (cylinders(&entry.neck, "neck")?, cylinders(&entry.holder, "holder")?);
    let is_bare = neck_mm.is_empty() && holder_mm.is_empty();
    let default_mm = if is_bare { 2.0 * radius_mm * SHANK_DIAMETERS } else { 2.0 * radius_mm };
    let length_mm_or = |given: &Option<Spanned<Quantity>>, name: &str, default_mm: f64| {
        given.as_ref().map_or(Ok(default_mm), |given| length_mm(given, unit, name))
    };
    let length = length_mm_or(&entry.length, "length", default_mm)?;
    if let Some(given) = entry.length.as_ref().filter(|_| length <= corner_radius_mm) {
        return Err(at(given, "length must be more than corner_radius"));
    }
    Ok(PlungeMill {
        radius_mm,
        corner_radius_mm,
        core_radius_mm,
        width_max_mm: length_mm_or(&entry.width_max, "width_max", radius_mm - core_radius_mm)?,
        length_mm: length,
        neck_mm,
        holder_mm,
        teeth: super::tool::teeth(&entry.teeth)?,
    })
}

fn needs(
    entry: &PartPlungeTable,
    mill: &PlungeMill,
    allowance_mm: f64,
    unit: LengthUnit,
) -> Result<PlungeRequirements, Complaint> {
    let length = |given: &Option<Spanned<Quantity>>, name: &str, default_mm: f64| {
        given.as_ref().map_or(Ok(default_mm), |given| length_mm(given, unit, name))
    };
    let cusp_mm = length(&entry.cusp, "cusp", CUSP_RATIO * allowance_mm)?;
    if let Some(given) = entry.cusp.as_ref().filter(|_| cusp_mm >= mill.radius_mm.min(allowance_mm)) {
        return Err(at(given, "cusp must be less than the allowance and than the mill's radius"));
    }
    let relief_mm = match &entry.relief {
        Some(given) if given.as_ref().to_mm(unit) == 0.0 => 0.0,
        given => length(given, "relief", RELIEF_MM)?,
    };
    Ok(PlungeRequirements {
        allowance_mm,
        cusp_mm,
        fit: match entry.fit {
            FitWord::Gap => Fit::Gap,
            FitWord::Area => Fit::Area,
        },
        clearance_mm: length(&entry.clearance, "clearance", CLEARANCE_MM)?,
        relief_mm,
    })
}

/// Limits of the plunge law. The material's name is checked where its coefficients are.
fn law(entry: &Spanned<PartPlungeLawTable>) -> Result<PlungeLimits, Complaint> {
    let PartPlungeLawTable { material, radial, axial, max_power, max_torque } = entry.as_ref();
    let [radial, axial] = [(radial, "radial"), (axial, "axial")].map(|(given, name)| {
        let message = format!("{name} is the {name} force over the tangential one, from 0 to 2");
        if (0.0..=2.0).contains(given.as_ref()) { Ok(*given.as_ref()) } else { Err(at(given, &message)) }
    });
    if max_power.is_none() && max_torque.is_none() {
        return Err(at(entry, "the law needs max_power or max_torque: they bound the feed of a plunge"));
    }
    Ok(PlungeLimits {
        material: material.clone(),
        force_ratios: [radial?, axial?],
        power_w: spindle::power_w(max_power.as_ref())?,
        torque_n_m: spindle::torque_n_m(max_torque.as_ref())?,
    })
}

/// Feeds of `[plunge]`, or else those of `[roughing]`.
fn feeds(entry: &PartPlungeTable, table: &PartTable, unit: LengthUnit) -> Result<Feeds, Complaint> {
    let speed = entry.rev_per_min.as_ref().unwrap_or(&table.roughing.rev_per_min);
    let chip = entry.feed_per_tooth.as_ref().unwrap_or(&table.roughing.feed_per_tooth);
    let approach = entry.approach_feed.as_ref().or(table.roughing.approach_feed.as_ref());
    Ok(Feeds {
        rev_per_min: positive(speed, "rev_per_min")?,
        per_tooth_mm: length_mm(chip, unit, "feed_per_tooth")?,
        approach_mm_per_min: approach.map(|given| length_mm(given, unit, "approach_feed")).transpose()?,
        axial_mm_per_min: None,
    })
}
