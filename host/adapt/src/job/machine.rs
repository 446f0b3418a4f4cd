//! `[machine]`, and the feed limits in `[control]`.

use std::path::Path;

use arcfeed_kinematics::machine::{Letter, Machine};
use arcfeed_model::machine::{ArcClamp, MachineLimits};
use arcfeed_units::{DegPerMin, LengthUnit, Mm, MmPerMin};
use toml::Spanned;

use super::schema::{ArcClampTable, JobTable, MaxFeedTable, Quantity};
use super::{Complaint, at, length_mm, positive};
use crate::key_values::KeyValue;
use crate::machine_file::MachineFile;

/// Five-axis machine that a job or a part names, by a file in `folder` or as a preset; `values` replace values of its file. `None` if
/// neither is named.
pub fn named(
    file: Option<&Spanned<String>>,
    preset: Option<&Spanned<String>>,
    folder: &Path,
    values: &[KeyValue],
) -> Result<Option<MachineFile>, Complaint> {
    match (file, preset) {
        (None, None) if !values.is_empty() => Err((0, "the job names no machine whose values could be changed".into())),
        (None, None) => Ok(None),
        (Some(_), Some(preset)) => Err(at(preset, "a machine is a `file` or a `preset`; remove one of them")),
        (Some(file), None) => {
            let read = MachineFile::load_with(&folder.join(file.as_ref()), values);
            read.map(Some).map_err(|message| at(file, &message))
        }
        (None, Some(preset)) => match MachineFile::preset_with(preset.as_ref(), values) {
            Some(read) => read.map(Some).map_err(|message| at(preset, &message)),
            None => Err(at(preset, &format!("no such machine; write {}, or a `file`", MachineFile::preset_names()))),
        },
    }
}

/// Limits of the machine in feeds per minute, for rotary axes in degrees. An axis's `max_feed` in the job takes precedence over that in
/// the machine's file. Fails at the first faulty value.
pub fn build(table: &JobTable, unit: LengthUnit, of: Option<&MachineFile>) -> Result<MachineLimits, Complaint> {
    let feed = |given: &Spanned<Quantity>, name: &str| {
        length_mm(given, unit, name).map(|mm_per_min| MmPerMin(mm_per_min as f32))
    };
    let MaxFeedTable { x, y, z, a, b, c } = &table.machine.max_feed;
    let linear = |given: &Option<Spanned<Quantity>>| given.as_ref().map(|given| feed(given, "max_feed")).transpose();
    let rotary = |given: &Option<Spanned<f64>>| {
        let checked = given.as_ref().map(|given| positive(given, "max_feed of a rotary axis, degrees per minute,"));
        checked.transpose().map(|degrees| degrees.map(|degrees| DegPerMin(degrees as f32)))
    };
    let clamp = |clamp: &ArcClampTable| {
        let floor = clamp.floor.as_ref().map_or(Ok(MmPerMin(0.0)), |floor| feed(floor, "floor"))?;
        let radius = Mm(length_mm(&clamp.radius, unit, "radius")? as f32);
        let most = feed(&clamp.feed, "feed")?;
        match &clamp.floor {
            Some(given) if floor > most => Err(at(given, "floor of arc_clamp must not be above its feed")),
            _ => Ok(ArcClamp { feed: most, radius, floor }),
        }
    };
    let MachineLimits { linear: filed, rotary: filed_rotary, .. } =
        of.map_or(MachineLimits::default(), |file| limits(&file.machine));
    let [filed_x, filed_y, filed_z] = filed;
    let [filed_a, filed_b, filed_c] = filed_rotary;
    Ok(MachineLimits {
        linear: [linear(x)?.or(filed_x), linear(y)?.or(filed_y), linear(z)?.or(filed_z)],
        rotary: [rotary(a)?.or(filed_a), rotary(b)?.or(filed_b), rotary(c)?.or(filed_c)],
        arc_clamp: table.control.arc_clamp.as_ref().map(clamp).transpose()?,
    })
}

/// Largest feed of each axis of a machine.
fn limits(machine: &Machine) -> MachineLimits {
    let speed = |mm_per_min: f64| MmPerMin(mm_per_min as f32);
    let linear = machine.linear().map(|axis| axis.speed_mm_per_min.map(speed));
    let rotary = Letter::ALL.map(|letter| {
        let axis = machine.rotary().iter().find(|axis| axis.letter == letter)?;
        axis.speed_deg_per_min.map(|speed| DegPerMin(speed as f32))
    });
    MachineLimits { linear, rotary, arc_clamp: None }
}

/// The machine with the axis speeds that the job has set.
pub fn with_limits(file: MachineFile, limits: &MachineLimits) -> MachineFile {
    let linear = limits.linear.map(|limit| limit.map(|MmPerMin(speed)| f64::from(speed)));
    let rotary = file.machine.rotary().each_ref().map(|axis| {
        let limit = Letter::ALL.iter().zip(limits.rotary).find(|(letter, _)| **letter == axis.letter);
        limit.and_then(|(_, limit)| limit).map(|DegPerMin(speed)| f64::from(speed))
    });
    let machine = file.machine.with_speeds(linear, rotary);
    let [x, y, z] = machine.linear().map(|axis| axis.speed_mm_per_min);
    let [first, second] = machine.rotary().map(|axis| axis.speed_deg_per_min);
    let drives = file.drives.map(|drives| drives.with_speeds([x, y, z, first, second]));
    MachineFile { machine, drives, ..file }
}
