//! `JOB.toml`: reading and checking. Every complaint names its place in the file.

mod quantity;

mod control_kind;

pub mod cutting;

pub mod stl;

pub mod flexible;

mod cut_table;

mod schema;

mod tables;

pub mod machine;

mod tool;

pub mod spindle;

pub mod plunge;

mod rules;

pub mod rule_scope;

pub mod workpiece;

mod feed_policy;

mod serial;

mod dnc;

pub mod questions;

use std::path::{Path, PathBuf};

use arcfeed_model::job::{FeedCeiling, FeedPolicy, Job, LawKind, OverrideLimits, ToolSetup, Tools};
use arcfeed_model::knots::Knots;
use arcfeed_model::machine::MachineLimits;
use arcfeed_model::tool::{EndMill, Tool};
use arcfeed_nc::settings::{Preset, Reading, Scope, Settings, Tables};
use arcfeed_units::{LengthUnit, MmPerTooth, Nm, RevPerMin};
use toml::Spanned;

use crate::control::Conventions;
use crate::engagement::EngagementMap;
use crate::file_error::FileError;
use crate::files;
use crate::key_values::{self, KeyValue};
use crate::machine_file::MachineFile;
use crate::place::place;
use crate::toml_reader;
use crate::toml_values::with_key;
pub use arcfeed_port::settings::{Parity, SerialSettings};
pub use control_kind::ControlKind;
pub use cutting::Cutting;
pub use dnc::{DncSettings, TapeCode};

pub use plunge::Plunge;
use rule_scope::RuleScope;
use schema::JobTable;
pub use schema::{Quantity, UnitWord};
pub use spindle::SpindleLimits;
pub use workpiece::Workpiece;

/// Bounds of lengths, and of feeds per minute: below one nanometre a length would round to nothing.
const LENGTH_MIN_MM: f64 = 1e-6;
const LENGTH_MAX_MM: f64 = 1e5;
/// Bounds of what must be positive, such as speeds.
const POSITIVE_MIN: f64 = 1e-6;
const POSITIVE_MAX: f64 = 1e6;

/// Content of a job file, checked.
#[derive(Clone, Debug)]
pub struct JobFile {
    /// Tools, laws, cut rules and limits, as controller and planner take them.
    pub job: Job,
    /// Path of the NC program that the job names.
    pub program: PathBuf,
    /// Kind of control on which the program runs.
    pub control: ControlKind,
    /// Path of the file with the settings of that control; `None`: standard settings.
    pub settings: Option<PathBuf>,
    /// Folder of subprograms that are not in the program's file.
    pub library: Option<PathBuf>,
    /// Conventions of the control that the job itself states.
    pub conventions: Conventions,
    /// Settings of the control after power-on.
    pub nc: Settings,
    /// Work offsets, tool lengths and reference points of the control.
    pub tables: Tables,
    /// Five-axis machine, if the job names one.
    pub machine: Option<MachineFile>,
    /// Path of the machine's file; `None` for a preset or without a machine.
    pub machine_path: Option<PathBuf>,
    /// Path of the engagement map that the cut rules name; `None` if they name none.
    pub map_file: Option<PathBuf>,
    /// Content of that map; `None` until it has been read.
    pub map: Option<EngagementMap>,
    /// Workpiece; `None` if the job does not describe one.
    pub workpiece: Option<Workpiece>,
    /// Cutting edges, forces and modes; `None` if the job does not describe them.
    pub cutting: Option<Cutting>,
    /// Settings of the plunge law, for descending moves; `None` if the job does not use it.
    pub plunge: Option<Plunge>,
    /// Largest power and torque of the spindle.
    pub spindle: SpindleLimits,
    /// Settings of the serial line to the control.
    pub serial: SerialSettings,
    /// Settings of the transmission (DNC) on that line.
    pub dnc: DncSettings,
    /// Line and column of each cut rule in the job file, counted from 1.
    pub rule_places: Vec<[usize; 2]>,
    /// Part of the program to which each cut rule applies, in the order of the rules.
    pub rule_scopes: Vec<RuleScope>,
}

/// A complaint at a byte offset of the file.
pub type Complaint = (usize, String);

/// Context in which a cut rule is read.
struct RuleContext<'t> {
    unit: LengthUnit,
    tool: &'t Tool,
    law: LawKind,
}

impl JobFile {
    /// Reads and checks a job file.
    ///
    /// # Errors
    /// See [`FileError`].
    pub fn load(path: &Path) -> Result<Self, FileError> {
        JobFile::load_with(path, &[])
    }

    /// Reads and checks a job file in which `values` replace its own values.
    ///
    /// # Errors
    /// See [`FileError`].
    pub fn load_with(path: &Path, values: &[KeyValue]) -> Result<Self, FileError> {
        let text = files::read_to_string(path).map_err(|source| FileError::Read { path: path.into(), source })?;
        if values.is_empty() {
            return JobFile::parse(path, &text);
        }
        let [of_machine, of_job] = key_values::divide(values);
        let text = key_values::with_values(&text, &of_job)
            .map_err(|message| FileError::Whole { path: path.into(), message }.with_values(values))?;
        JobFile::parse_with(path, &text, &of_machine).map_err(|error| error.with_values(values))
    }

    /// Settings for running a program without a job: no governed moves, on a 16i's usual line (9600 baud, 7E2,
    /// XON/XOFF).
    pub fn plain(unit: LengthUnit) -> Self {
        let job = Job {
            unit,
            tools: Tools::one(ToolSetup::new(
                Tool::EndMill(EndMill { radius: Nm(0), teeth: 1 }),
                RevPerMin(0.0),
                LawKind::Programmed,
                MmPerTooth(0.0),
            )),
            ceiling: FeedCeiling::default(),
            policy: FeedPolicy::OverrideOnly,
            limits: OverrideLimits::default(),
            machine: MachineLimits::default(),
            rules: heapless::Vec::new(),
            knots: Knots::default(),
        };
        let serial = SerialSettings {
            baudrate: 9_600,
            bytesize: 7,
            parity: Parity::Even,
            stopbits: 2,
            xonxoff: true,
            rtscts: false,
            write_timeout: None,
            exclusive: false,
        };
        let nc = Settings::preset(Preset::Fanuc16i, unit, Reading::Lenient);
        let nc = Settings { scope: Scope::Everything, ..nc };
        JobFile {
            job,
            program: PathBuf::new(),
            control: ControlKind::Fanuc16i,
            settings: None,
            library: None,
            conventions: Conventions::default(),
            nc,
            tables: Tables::default(),
            machine: None,
            machine_path: None,
            map_file: None,
            map: None,
            workpiece: None,
            cutting: None,
            plunge: None,
            spindle: SpindleLimits::default(),
            serial,
            dnc: DncSettings::default(),
            rule_places: Vec::new(),
            rule_scopes: Vec::new(),
        }
    }

    /// Rejects a job with rules that are restricted to lines of the file or to a plane, for a recipient `whom` that
    /// knows only blocks.
    ///
    /// # Errors
    /// Names the first such rule with its place and key; `path` is the job file.
    pub fn refuse_scopes(&self, path: &Path, whom: &str) -> Result<(), String> {
        let scoped = self.rule_scopes.iter().enumerate().find_map(|(index, scope)| Some((index, scope.key()?)));
        let Some((index, key)) = scoped else { return Ok(()) };
        let [line, column] = self.rule_places.get(index).copied().unwrap_or([1, 1]);
        Err(format!(
            "{}:{line}:{column}: error: {whom} knows no `{key}` of a rule: restrict cut rule {} by n or z in its place",
            path.display(),
            index + 1
        ))
    }

    /// Paths of all files that a run of the job reads; `path` is that of the job file itself.
    pub fn inputs(&self, path: &Path) -> Vec<PathBuf> {
        let mut files = vec![path.to_owned(), self.program.clone()];
        files.extend([&self.settings, &self.machine_path, &self.map_file].into_iter().flatten().cloned());
        let called = self.library.iter().flat_map(std::fs::read_dir).flatten().flatten();
        files.extend(called.map(|entry| entry.path()).filter(|path| path.is_file()));
        files.extend(self.workpiece.iter().flat_map(|workpiece| workpiece.files()).map(|file| file.path.clone()));
        files
    }

    /// Checks a job given as text. `path` is used in messages and to locate the program.
    ///
    /// # Errors
    /// See [`FileError`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, FileError> {
        JobFile::parse_with(path, text, &[])
    }

    /// The same with values in place of those of the machine's file.
    fn parse_with(path: &Path, text: &str, of_machine: &[KeyValue]) -> Result<Self, FileError> {
        questions::refuse_open(text)
            .and_then(|()| toml_reader::read::<JobTable>(text))
            .and_then(|table| {
                let file = build(&table, path.parent().unwrap_or(Path::new("")), of_machine)?;
                let rule_places = rules::tables(&table).map(|(_, cut)| place(text, cut.span().start)).collect();
                Ok(JobFile { rule_places, ..file })
            })
            .map_err(|(offset, message)| {
                let [line, column] = place(text, offset);
                let is_toml = path.extension().is_some_and(|extension| extension == "toml");
                let hint = if is_toml { "" } else { " (this command takes a job file, JOB.toml, not a program)" };
                let message = with_key(text, offset, &message) + hint;
                FileError::Content { path: path.into(), line, column, message }
            })
    }
}

fn build(table: &JobTable, folder: &Path, of_machine: &[KeyValue]) -> Result<JobFile, Complaint> {
    let unit = table.units.into();
    let tools = tool::setups(table)?;
    let machine = machine::named(table.machine.file.as_ref(), table.machine.preset.as_ref(), folder, of_machine)?;
    let (rules, knots) = rules::build(table, &tools)?;
    let limits = machine::build(table, unit, machine.as_ref())?;
    let job = Job {
        unit,
        ceiling: feed_policy::ceiling(table, unit, &tools, &limits)?,
        tools,
        policy: feed_policy::policy(&table.r#override, unit)?,
        limits: feed_policy::limits(&table.r#override)?,
        machine: limits,
        rules,
        knots,
    };
    let preset = &table.control.preset;
    let machine = machine.map(|file| machine::with_limits(file, &job.machine));
    let control = ControlKind::named(preset.as_ref()).map_err(|message| at(preset, message))?;
    let place = table.control.settings.as_ref();
    let settings = place.map(|file| folder.join(file.as_ref()));
    let conventions = Conventions { decimals: table.control.decimals, arc_centers: table.control.arc_centers };
    let loaded = control.settings(unit, settings.as_deref(), conventions);
    let (nc, tables) = loaded.map_err(|message| at(place.unwrap_or(preset), &message))?;
    let library = table.control.library.as_ref().map(|place| library(place, folder)).transpose()?;
    let program = folder.join(table.program.as_ref());
    let workpiece = workpiece::build(table, &job, folder)?;
    let height_mm = workpiece.as_ref().map(|workpiece| workpiece.body.height_mm);
    let cutting = table.cutting.as_ref().map(|entry| cutting::build(entry, &job, height_mm)).transpose()?;
    let map_file = rules::map(table)?.map(|file| folder.join(file.as_ref()));
    let serial = serial::build(&table.serial)?;
    let dnc = dnc::build(&table.dnc, &serial)?;
    let spindle = spindle::build(table)?;
    let plunge = plunge::build(table, &job, &spindle)?;
    let (map, rule_places, rule_scopes) = (None, Vec::new(), rule_scope::build(table)?);
    Ok(JobFile {
        job,
        program,
        control,
        settings,
        library,
        conventions,
        nc,
        tables,
        machine,
        machine_path: table.machine.file.as_ref().map(|file| folder.join(file.as_ref())),
        map_file,
        map,
        workpiece,
        cutting,
        plunge,
        spindle,
        serial,
        dnc,
        rule_places,
        rule_scopes,
    })
}

fn library(place: &Spanned<String>, folder: &Path) -> Result<PathBuf, Complaint> {
    let path = folder.join(place.as_ref());
    if path.is_dir() {
        Ok(path)
    } else {
        Err(at(place, "no such folder; name one with the called programs, as O9010.nc"))
    }
}

/// Length in mm, if it is positive and in the range of lengths.
///
/// # Errors
/// Place and message.
pub fn length_mm(quantity: &Spanned<Quantity>, unit: LengthUnit, name: &str) -> Result<f64, Complaint> {
    let mm = quantity.as_ref().to_mm(unit);
    if (LENGTH_MIN_MM..LENGTH_MAX_MM).contains(&mm) {
        return Ok(mm);
    }
    Err(at(
        quantity,
        &format!("{name} must be a positive length, from {LENGTH_MIN_MM} to less than {LENGTH_MAX_MM} mm"),
    ))
}

/// A number, if it is positive and in the range of numbers.
///
/// # Errors
/// Place and message.
pub fn positive(value: &Spanned<f64>, name: &str) -> Result<f64, Complaint> {
    let number = *value.as_ref();
    if (POSITIVE_MIN..POSITIVE_MAX).contains(&number) {
        return Ok(number);
    }
    Err(at(value, &format!("{name} must be positive, from {POSITIVE_MIN} to less than {POSITIVE_MAX}")))
}

/// Complaint about a value: its place, and the message.
pub fn at<T>(place: &Spanned<T>, message: &str) -> Complaint {
    (place.span().start, message.to_string())
}

#[cfg(test)]
mod tests;
