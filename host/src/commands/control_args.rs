//! Options that say which control reads a program.

use std::path::{Component, Path, PathBuf};

use arcfeed_nc::block::Reading;
use arcfeed_nc::settings::{Scope, Settings, Tables};
use arcfeed_units::LengthUnit;

use super::outcome::Failure;
use crate::control::{self, Convention, Conventions, LoadedSettings};
use crate::job::{ControlKind, JobFile};

/// Options that describe the control: preset, settings file, decimals and unit.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct ControlArgs {
    /// Control, in place of the job's: fanuc-16i, fanuc-0i, fanuc-31i; for a program without a job a 16i
    #[arg(long, value_parser = ControlKind::named)]
    pub control: Option<ControlKind>,
    /// Settings of this machine, in place of the job's: offsets, lengths, switches (docs/dialect.md)
    #[arg(long, value_name = "SETTINGS.toml")]
    pub settings: Option<PathBuf>,
    /// Meaning of numbers without a decimal point
    #[arg(long)]
    pub decimals: Option<Convention>,
    /// Unit at power-on: that of a program without G20 and G21
    #[arg(long, value_name = "inch|mm", value_parser = unit_named)]
    pub units: Option<LengthUnit>,
}

/// Control with which a program is read: kind, settings, offsets and unit.
pub struct ControlReading {
    /// Kind of the control.
    pub control: ControlKind,
    /// Settings of the control (dialect, options).
    pub settings: Settings,
    /// Offsets stored in the control.
    pub tables: Tables,
    /// Unit at power-on that the options, the job or the settings file state; `None` if none of them does.
    pub unit: Option<LengthUnit>,
}

/// The unit of this name.
///
/// # Errors
/// The name is unknown.
pub fn unit_named(name: &str) -> Result<LengthUnit, &'static str> {
    match name {
        "inch" => Ok(LengthUnit::Inch),
        "mm" => Ok(LengthUnit::Mm),
        _ => Err("no such unit; write inch or mm"),
    }
}

impl ControlArgs {
    /// Whether any of the options is given.
    pub fn is_given(&self) -> bool {
        self.control.is_some() || self.settings.is_some() || self.decimals.is_some() || self.units.is_some()
    }

    /// The control that reads a program: as the options say, otherwise as the job says.
    ///
    /// # Errors
    /// The settings file is at fault.
    pub fn read(&self, job: Option<&JobFile>, reading: Reading) -> Result<ControlReading, Failure> {
        let control = self.control.or(job.map(|file| file.control)).unwrap_or(ControlKind::Fanuc16i);
        let file = self.settings.as_ref().or(job.and_then(|file| file.settings.as_ref()));
        let loaded = control::load(control.preset(), reading, file.map(PathBuf::as_path));
        let LoadedSettings { mut settings, tables, states_unit } = loaded.map_err(Failure::Input)?;
        if let Some(file) = job {
            file.conventions.apply(&mut settings);
        }
        let of_job = job.map(|file| file.job.unit);
        let unit = self.units.or(of_job).or(states_unit.then_some(settings.unit));
        settings.unit = unit.unwrap_or(settings.unit);
        Conventions { decimals: self.decimals, arc_centers: None }.apply(&mut settings);
        settings.scope = Scope::Everything;
        Ok(ControlReading { control, settings, tables, unit })
    }

    /// Keys and values for the table `[control]` of the job file `job`, as text.
    pub fn keys(&self, control: ControlKind, job: &Path) -> Vec<(&'static str, String)> {
        let mut keys = vec![("preset", control.name().to_owned())];
        keys.extend(self.decimals.map(|decimals| ("decimals", decimals.name().to_owned())));
        keys.extend(self.settings.as_ref().map(|settings| ("settings", name_from(job, settings))));
        keys
    }
}

/// Path of `file` as it is written in the job file `job`: relative to the job's folder, or absolute if the two share no
/// folder.
pub fn name_from(job: &Path, file: &Path) -> String {
    let name = relative(job, file).unwrap_or_else(|| std::path::absolute(file).unwrap_or_else(|_| file.to_owned()));
    name.display().to_string()
}

/// Path from the folder of `job` to `file`, along real folders: `..` leads out of the folder that a link names.
fn relative(job: &Path, file: &Path) -> Option<PathBuf> {
    let folder = |path: &Path| std::path::absolute(path).ok()?.parent()?.canonicalize().ok();
    let (from, to) = (folder(job)?, folder(file)?);
    let shared = from.components().zip(to.components()).take_while(|(one, other)| one == other).count();
    let is_named = |part: Component<'_>| matches!(part, Component::Normal(_));
    if from != to && !from.components().take(shared).any(is_named) {
        return None;
    }
    let up = from.components().skip(shared).map(|_| Component::ParentDir);
    Some(up.chain(to.components().skip(shared)).collect::<PathBuf>().join(file.file_name()?))
}
