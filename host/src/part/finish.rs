//! `[finish]` of a part file: the finishing mill, its passes, tool axes and feeds.

use std::path::Path;

use arcfeed_kinematics::forward::Setup;
use arcfeed_plan::finish::axis::{AxisProgram, Station};
use arcfeed_plan::finish::contact::Orientation;
use arcfeed_plan::finish::mill::FinishMill;
use arcfeed_plan::finish::needs::FinishNeeds;
use arcfeed_plan::finish::passes::{Course, Sampling};
use arcfeed_plan::finish::reach::Margins;
use arcfeed_plan::finish::rows::Spacing;
use arcfeed_plan::geometry::blisk::Blisk;
use arcfeed_plan::geometry::flaws::BladeSide;
use arcfeed_plan::vector::Point;
use arcfeed_units::LengthUnit;
use toml::Spanned;

use super::finish_table::{CourseWord, FinishTable, InterpolateWord, MillingWord, SpacingWord};
use super::schema::PartTable;
use super::{CLEARANCE_MM, MachineSource, Output, PartError};
use crate::file_error::FileError;
use crate::job::{Complaint, Quantity, at, length_mm, machine, positive};
use crate::machine_file::MachineFile;

/// Default of `safety`, of `step`, of `step_deg`, of `tilt_deg`, and of `max_raise`.
const SAFETY_MM: f64 = 0.5;
const STEP_MM: f64 = 1.0;
const STEP_DEG: f64 = 1.0;
const TILT_DEG: [f64; 2] = [10.0, 80.0];
const MAX_RAISE: f64 = 2.0;
/// Depth of a gouge that the proof accepts beyond the tolerance: the precision of its bodies and bounds.
const SLACK_MM: f64 = 0.01;

/// Content of a part file for finishing, checked. Coordinates are those of the part, in mm.
#[derive(Clone, Debug)]
pub struct FinishPart {
    /// Name in the part file, or else the file's own name.
    pub name: String,
    /// Rotor: blades, hub and blank.
    pub blisk: Blisk,
    /// Finishing mill with its holder.
    pub mill: FinishMill,
    /// Requirements on the finishing path (scallop height, tolerance, distances).
    pub needs: FinishNeeds,
    /// Thickness of the material that finishing removes, mm.
    pub allowance_mm: f64,
    /// Feeds.
    pub feeds: FinishFeeds,
    /// Fixtures as boxes: corners with the lowest and with the highest coordinates.
    pub fixtures: Vec<[Point; 2]>,
    /// Machine.
    pub machine: MachineFile,
    /// File or preset by which the part names the machine.
    pub machine_source: Option<MachineSource>,
    /// Placement of part and tool on the machine.
    pub setup: Setup,
    /// Settings for the NC program that is written.
    pub output: Output,
}

/// Spindle speed and feeds of finishing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FinishFeeds {
    /// Spindle speed, rev/min.
    pub rev_per_min: f64,
    /// Feed per tooth at the contact with the surface, mm.
    pub per_tooth_mm: f64,
    /// Feed of approaches and links, mm/min.
    pub approach_mm_per_min: f64,
    /// Largest path of the cutting end per tooth, divided by the feed per tooth at the contact.
    pub max_raise_ratio: f64,
}

impl FinishPart {
    /// Reads and checks a part file and the files it names.
    ///
    /// # Errors
    /// See [`FileError`].
    pub fn load(path: &Path) -> Result<Self, FileError> {
        FinishPart::parse(path, &super::read(path)?)
    }

    /// Checks a part given as text. `path` is used in messages and to locate the files that it names.
    ///
    /// # Errors
    /// See [`FileError`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, FileError> {
        super::parse(path, text, build)
    }
}

fn build(table: &PartTable, path: &Path, folder: &Path) -> Result<FinishPart, PartError> {
    let unit: LengthUnit = table.units.into();
    let entry = table.finish.as_ref();
    let entry =
        entry.ok_or((0, "finishing needs the table [finish]: diameter, teeth, length, scallop, tolerance".into()))?;
    let named = machine::named(table.machine.file.as_ref(), table.machine.preset.as_ref(), folder, &[])?;
    let machine =
        named.ok_or_else(|| at(entry, "finishing needs the table [machine]: the name of a preset, or a file"))?;
    let entry = entry.as_ref();
    let blank = super::blank(&table.blank, unit)?;
    let mill = mill(entry, unit)?;
    let fixtures = table.fixture.iter().map(|entry| super::fixture(entry, unit)).collect::<Result<_, _>>()?;
    let tool_length_mm = match &entry.tool_length {
        Some(given) => length_mm(given, unit, "tool_length")?,
        None => mill.height_mm(),
    };
    let part_zero_mm = entry.part_zero.map_or([0.0; 3], |given| given.map(|value| value.to_mm(unit)));
    Ok(FinishPart {
        name: super::name(table, path),
        needs: needs(entry, unit)?,
        mill,
        allowance_mm: length_mm(&table.roughing.allowance, unit, "allowance")?,
        feeds: feeds(entry, table, unit)?,
        fixtures,
        machine,
        machine_source: super::machine_source(&table.machine, folder),
        setup: Setup { part_zero_mm, tool_length_mm },
        output: super::output(&table.output, unit)?,
        blisk: super::geometry::build_alike(&table.geometry, unit, blank, folder)?,
    })
}

fn mill(entry: &FinishTable, unit: LengthUnit) -> Result<FinishMill, Complaint> {
    let radius_mm = length_mm(&entry.diameter, unit, "diameter")? / 2.0;
    let corner_radius_mm = match &entry.corner_radius {
        None => radius_mm,
        Some(given) => length_mm(given, unit, "corner_radius")?,
    };
    if let Some(given) = entry.corner_radius.as_ref().filter(|_| corner_radius_mm > radius_mm) {
        return Err(at(
            given,
            &format!("corner_radius is at most the mill's radius of {radius_mm:.3} mm, which is that of a ball"),
        ));
    }
    let cylinders = |given: &[Spanned<[Quantity; 2]>], name: &str| {
        let one = |cylinder: &Spanned<[Quantity; 2]>| {
            let of_mm = cylinder.as_ref().map(|value| value.to_mm(unit));
            let is_one = of_mm.iter().all(|value| *value > 0.0 && *value < 1e5);
            let message = format!("a cylinder of the {name} is [radius, length], both positive");
            if is_one { Ok(of_mm) } else { Err(at(cylinder, &message)) }
        };
        given.iter().map(one).collect::<Result<Vec<_>, _>>()
    };
    let flutes_mm = length_mm(&entry.length, unit, "length")?;
    if flutes_mm <= corner_radius_mm {
        return Err(at(&entry.length, "length must be more than corner_radius"));
    }
    Ok(FinishMill {
        radius_mm,
        corner_radius_mm,
        length_mm: flutes_mm,
        neck_mm: cylinders(&entry.neck, "neck")?,
        holder_mm: cylinders(&entry.holder, "holder")?,
        teeth: super::tool::teeth(&entry.teeth)?,
    })
}

fn needs(entry: &FinishTable, unit: LengthUnit) -> Result<FinishNeeds, Complaint> {
    let length = |given: &Option<Spanned<Quantity>>, name: &str, default_mm: f64| {
        given.as_ref().map_or(Ok(default_mm), |given| length_mm(given, unit, name))
    };
    let place = |given: &Option<Spanned<f64>>, name: &str| match given {
        Some(share) if !(0.0..=1.0).contains(share.as_ref()) => {
            Err(at(share, &format!("{name} is a place between hub (0) and tip (1)")))
        }
        given => Ok(given.as_ref().map(|share| *share.as_ref())),
    };
    let step_deg = entry.step_deg.as_ref().map_or(Ok(STEP_DEG), |given| positive(given, "step_deg"))?;
    let tolerance_mm = length_mm(&entry.tolerance, unit, "tolerance")?;
    let tilt_deg = entry.tilt_deg.as_ref().map_or(TILT_DEG, |given| *given.as_ref());
    if let Some(given) =
        entry.tilt_deg.as_ref().filter(|_| !(0.0 <= tilt_deg[0] && tilt_deg[0] < tilt_deg[1] && tilt_deg[1] <= 90.0))
    {
        return Err(at(given, "tilt_deg is [least, greatest] angle from the normal, within 0 and 90"));
    }
    let spacing = match entry.spacing {
        SpacingWord::IsoParametric => Spacing::IsoParametric,
        SpacingWord::IsoStepover => Spacing::IsoStepover,
    };
    let course = match entry.course {
        CourseWord::Spiral => Course::Spiral,
        CourseWord::Pressure => Course::OneWay(BladeSide::Pressure),
        CourseWord::Suction => Course::OneWay(BladeSide::Suction),
    };
    Ok(FinishNeeds {
        margins: Margins { safety_mm: length(&entry.safety, "safety", SAFETY_MM)?, gouge_mm: tolerance_mm + SLACK_MM },
        sampling: Sampling {
            tolerance_mm,
            step_mm: length(&entry.step, "step", STEP_MM)?,
            angle_rad: step_deg.to_radians(),
        },
        scallop_mm: length_mm(&entry.scallop, unit, "scallop")?,
        span: [place(&entry.from, "from")?, place(&entry.to, "to")?],
        spacing,
        course,
        is_climb: entry.milling == MillingWord::Climb,
        clearance_mm: length(&entry.clearance, "clearance", CLEARANCE_MM)?,
        axes: program(entry)?,
        tilt_rad: tilt_deg.map(f64::to_radians),
    })
}

/// Axis program of the stations; `None` if there are none.
fn program(entry: &FinishTable) -> Result<Option<AxisProgram>, Complaint> {
    let mut stations: Vec<Station<Orientation>> = Vec::new();
    for given in &entry.stations {
        let [share, tilt_deg, yaw_deg] = *given.as_ref();
        let follows = stations.last().is_none_or(|last| last.share < share);
        if !((0.0..=1.0).contains(&share) && follows && tilt_deg.abs() < 90.0 && yaw_deg.abs() <= 360.0) {
            let message = "a station is [place, tilt, yaw]: growing places from 0 to 1, a tilt below 90 degrees, a yaw of 360 at most";
            return Err(at(given, message));
        }
        let value = Orientation { tilt_rad: tilt_deg.to_radians(), yaw_rad: yaw_deg.to_radians() };
        stations.push(Station { share, value });
    }
    let program = match entry.interpolate {
        InterpolateWord::Angles => AxisProgram::Angles,
        InterpolateWord::Positions => AxisProgram::Positions,
    };
    Ok((!stations.is_empty()).then(|| program(stations)))
}

fn feeds(entry: &FinishTable, table: &PartTable, unit: LengthUnit) -> Result<FinishFeeds, Complaint> {
    let speed = entry.rev_per_min.as_ref().unwrap_or(&table.roughing.rev_per_min);
    let chip = entry.feed_per_tooth.as_ref().unwrap_or(&table.roughing.feed_per_tooth);
    let (rev_per_min, per_tooth_mm) = (positive(speed, "rev_per_min")?, length_mm(chip, unit, "feed_per_tooth")?);
    let cutting = rev_per_min * per_tooth_mm * f64::from(super::tool::teeth(&entry.teeth)?);
    let approach = entry.approach_feed.as_ref().or(table.roughing.approach_feed.as_ref());
    let max_raise_ratio = match &entry.max_raise {
        None => MAX_RAISE,
        Some(given) if *given.as_ref() >= 1.0 && given.as_ref().is_finite() => *given.as_ref(),
        Some(given) => return Err(at(given, "max_raise must be 1 or more")),
    };
    Ok(FinishFeeds {
        rev_per_min,
        per_tooth_mm,
        approach_mm_per_min: approach.map_or(Ok(cutting), |given| length_mm(given, unit, "approach_feed"))?,
        max_raise_ratio,
    })
}
