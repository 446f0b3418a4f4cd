//! `JOB.toml`: read, checked once, every complaint with its place in the file.

mod quantity;

pub mod cutting;

pub mod stl;

pub mod flexible;

mod schema;

mod tables;

pub(crate) mod machine;

mod rules;

pub mod workpiece;

mod sending;

mod serial;

mod dnc;

pub mod questions;

use std::path::{Path, PathBuf};

use arcfeed_shared::job::{FeedPolicy, Job, LawKind, OverrideLimits};
use arcfeed_shared::knots::Knots;
use arcfeed_shared::machine::MachineLimits;
use arcfeed_shared::nc::settings::{Preset, Reading, Scope, Settings, Tables};
use arcfeed_shared::tool::{CupMill, EndMill, Tool};
use arcfeed_shared::units::{LengthUnit, MmPerTooth, Nm, PERCENT, RevPerMin};
use toml::Spanned;

use crate::control;
use crate::engagement::EngagementMap;
use crate::file_error::FileError;
use crate::machine_file::MachineFile;
use crate::place::place;
pub use cutting::Cutting;
pub use dnc::{DncSettings, TapeCode};
use schema::{JobTable, LawTable, ToolTable};
pub(crate) use schema::{Quantity, UnitWord};
pub use serial::{Parity, SerialSettings};
pub use workpiece::Workpiece;

/// A job file, checked.
#[derive(Clone, Debug)]
pub struct JobFile {
    /// What the controller and the planner need.
    pub job: Job,
    /// The program it speaks of.
    pub program: PathBuf,
    /// The control it runs on.
    pub control: ControlKind,
    /// The file with what that control is set to.
    pub settings: Option<PathBuf>,
    /// How it reads a program; in effect at power-on.
    pub nc: Settings,
    /// Its offsets.
    pub tables: Tables,
    /// The five-axis machine it runs on, where the job names one.
    pub machine: Option<MachineFile>,
    /// The engagement map that its rules name.
    pub map_file: Option<PathBuf>,
    /// That map, once it was read.
    pub map: Option<EngagementMap>,
    /// What it cuts, where the job says so.
    pub workpiece: Option<Workpiece>,
    /// What cutting it takes, where the job says so.
    pub cutting: Option<Cutting>,
    /// The DNC line.
    pub serial: SerialSettings,
    /// What is sent on it, and how.
    pub dnc: DncSettings,
}

/// The controls there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControlKind {
    /// Series 16i.
    Fanuc16i,
    /// Series 0i.
    Fanuc0i,
    /// Series 31i.
    Fanuc31i,
}

impl ControlKind {
    /// As in job files.
    pub const fn name(self) -> &'static str {
        match self {
            ControlKind::Fanuc16i => "fanuc-16i",
            ControlKind::Fanuc0i => "fanuc-0i",
            ControlKind::Fanuc31i => "fanuc-31i",
        }
    }

    /// Its standard settings.
    pub const fn preset(self) -> Preset {
        match self {
            ControlKind::Fanuc16i => Preset::Fanuc16i,
            ControlKind::Fanuc0i => Preset::Fanuc0i,
            ControlKind::Fanuc31i => Preset::Fanuc31i,
        }
    }

    /// Its settings and offsets, as a settings file changes them, at power-on in `unit`.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub fn settings(self, unit: LengthUnit, file: Option<&Path>) -> Result<(Settings, Tables), String> {
        let (settings, tables) = control::load(self.preset(), Reading::Lenient, file)?;
        Ok((Settings { unit, scope: Scope::Everything, ..settings }, tables))
    }

    /// The control of this name.
    ///
    /// # Errors
    /// There is none.
    pub fn named(name: &str) -> Result<Self, &'static str> {
        match name {
            "fanuc-16i" => Ok(ControlKind::Fanuc16i),
            "fanuc-0i" => Ok(ControlKind::Fanuc0i),
            "fanuc-31i" => Ok(ControlKind::Fanuc31i),
            _ => Err("no such control; write \"fanuc-16i\", \"fanuc-0i\" or \"fanuc-31i\""),
        }
    }
}

/// A complaint at a byte offset of the file.
pub(crate) type Complaint = (usize, String);

/// What a cut rule is read with.
struct Around<'t> {
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
        let text = std::fs::read_to_string(path).map_err(|source| FileError::Read { path: path.into(), source })?;
        JobFile::parse(path, &text)
    }

    /// No job: a control that executes programs as they are, on a 16i's usual line (9600 baud, 7E2, XON/XOFF).
    pub fn plain(unit: LengthUnit) -> Self {
        let job = Job {
            unit,
            tool: Tool::EndMill(EndMill { radius: Nm(0), teeth: 1 }),
            spindle: RevPerMin(0.0),
            law: LawKind::Programmed,
            feed_per_tooth: MmPerTooth(0.0),
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
            nc,
            tables: Tables::default(),
            machine: None,
            map_file: None,
            map: None,
            workpiece: None,
            cutting: None,
            serial,
            dnc: DncSettings::default(),
        }
    }

    /// Checks a job given as text; `path` is for messages and for the program's place.
    ///
    /// # Errors
    /// See [`FileError`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, FileError> {
        let read = || -> Result<JobTable, Complaint> {
            toml::from_str(text)
                .map_err(|error| (error.span().map_or(0, |span| span.start), error.message().to_string()))
        };
        questions::refuse_open(text)
            .and_then(|()| read())
            .and_then(|table| build(&table, path.parent().unwrap_or(Path::new(""))))
            .map_err(|(offset, message)| {
                let [line, column] = place(text, offset);
                let is_toml = path.extension().is_some_and(|extension| extension == "toml");
                let hint = if is_toml { "" } else { " (this command takes a job file, JOB.toml, not a program)" };
                FileError::Content { path: path.into(), line, column, message: format!("{message}{hint}") }
            })
    }
}

fn build(table: &JobTable, folder: &Path) -> Result<JobFile, Complaint> {
    let unit = table.units.into();
    let rev_per_min = positive(&table.spindle.rev_per_min, "the spindle speed")?;
    let feed_mm = length_mm(&table.law.feed_per_tooth, unit, "the feed per tooth")?;
    let tool = build_tool(&table.tool, unit)?;
    let law = build_law(&table.law, &tool)?;
    let machine = machine::named(table.machine.file.as_ref(), table.machine.preset.as_ref(), folder)?;
    let (rules, knots) = rules::build(&table.cut, &Around { unit, tool: &tool, law })?;
    let job = Job {
        unit,
        spindle: RevPerMin(rev_per_min as f32),
        law,
        feed_per_tooth: MmPerTooth(feed_mm as f32),
        policy: sending::policy(&table.r#override, unit)?,
        limits: sending::limits(&table.r#override)?,
        machine: machine::build(table, unit, machine.as_ref())?,
        rules,
        knots,
        tool,
    };
    let preset = &table.control.preset;
    let machine = machine.map(|file| machine::with_limits(file, &job.machine));
    let control = ControlKind::named(preset.as_ref()).map_err(|message| at(preset, message))?;
    let place = table.control.settings.as_ref();
    let settings = place.map(|file| folder.join(file.as_ref()));
    let loaded = control.settings(unit, settings.as_deref());
    let (nc, tables) = loaded.map_err(|message| at(place.unwrap_or(preset), &message))?;
    let program = folder.join(table.program.as_ref());
    let workpiece = workpiece::build(table, &job, folder)?;
    let height_mm = workpiece.as_ref().map(|workpiece| workpiece.body.height_mm);
    let cutting = table.cutting.as_ref().map(|told| cutting::build(told, &job, height_mm)).transpose()?;
    let map_file = rules::map(&table.cut)?.map(|file| folder.join(file.as_ref()));
    let serial = serial::build(&table.serial)?;
    let dnc = dnc::build(&table.dnc, &serial)?;
    let map = None;
    Ok(JobFile { job, program, control, settings, nc, tables, machine, map_file, map, workpiece, cutting, serial, dnc })
}

fn build_tool(table: &ToolTable, unit: LengthUnit) -> Result<Tool, Complaint> {
    let ToolTable { kind, outer_radius, inner_radius, active_teeth, diameter, teeth, .. } = table;
    match (kind.as_ref().as_str(), outer_radius, inner_radius, active_teeth, diameter, teeth) {
        ("cup-mill", Some(outer), Some(inner), Some(teeth), None, None) => {
            let outer_mm = length_mm(outer, unit, "outer_radius")?;
            let inner_mm = length_mm(inner, unit, "inner_radius")?;
            if inner_mm >= outer_mm {
                return Err(at(inner, "inner_radius must be less than outer_radius"));
            }
            let (outer_radius, inner_radius) = (Nm::from_mm(outer_mm), Nm::from_mm(inner_mm));
            Ok(Tool::CupMill(CupMill { outer_radius, inner_radius, active_teeth: some_teeth(teeth)? }))
        }
        ("end-mill", None, None, None, Some(diameter), Some(teeth)) => {
            let radius = Nm::from_mm(length_mm(diameter, unit, "diameter")? / 2.0);
            Ok(Tool::EndMill(EndMill { radius, teeth: some_teeth(teeth)? }))
        }
        ("cup-mill", ..) => Err(at(kind, "a cup-mill has outer_radius, inner_radius and active_teeth")),
        ("end-mill", ..) => Err(at(kind, "an end-mill has diameter and teeth")),
        _ => Err(at(kind, "no such tool; write \"cup-mill\" or \"end-mill\"")),
    }
}

fn some_teeth(teeth: &Spanned<u16>) -> Result<u16, Complaint> {
    match *teeth.as_ref() {
        0 => Err(at(teeth, "a tool needs at least one active tooth")),
        teeth => Ok(teeth),
    }
}

fn build_law(table: &LawTable, tool: &Tool) -> Result<LawKind, Complaint> {
    let kind = table.kind.as_ref().as_str();
    let settings = (&table.edges, table.inside_only, &table.floor);
    match (kind, tool, settings) {
        ("programmed", _, (None, None, None)) => Ok(LawKind::Programmed),
        ("table", _, (None, None, None)) => Ok(LawKind::Table),
        ("circumference", Tool::CupMill(_), (None, None, None)) => Ok(LawKind::Circumference),
        ("engaged-arc", Tool::CupMill(_), (edges, None, None)) => {
            match edges.as_ref().map(|edges| edges.as_ref().as_str()) {
                None | Some("both") => Ok(LawKind::EngagedArc { both_edges: true }),
                Some("side") => Ok(LawKind::EngagedArc { both_edges: false }),
                Some(_) => Err(at(&table.kind, "edges must be \"both\" or \"side\" (the one the cut rule names)")),
            }
        }
        ("engaged-arc", Tool::EndMill(_), (None, None, None)) => Ok(LawKind::EngagedArc { both_edges: false }),
        ("engagement", Tool::EndMill(_), (None, None, None)) => Ok(LawKind::Engagement),
        ("contour", Tool::EndMill(_), (None, inside_only, floor)) => {
            let floor_ratio = floor.as_ref().map_or(0.0, |floor| *floor.as_ref() / PERCENT);
            match floor {
                Some(floor) if !(0.0..=1.0).contains(&floor_ratio) => Err(at(floor, "floor must be 0 to 100 %")),
                _ => Ok(LawKind::Contour { inside_only: inside_only.unwrap_or(true), floor_ratio }),
            }
        }
        ("engaged-arc", Tool::EndMill(_), (Some(edges), ..)) => Err(at(edges, "an end-mill has one circle only")),
        ("circumference", Tool::EndMill(_), _) => Err(at(&table.kind, "this law needs a cup-mill")),
        ("engagement" | "contour", Tool::CupMill(_), _) => Err(at(&table.kind, "this law needs an end-mill")),
        ("circumference" | "engaged-arc" | "engagement" | "contour" | "table" | "programmed", ..) => Err(at(
            &table.kind,
            "`edges` belongs to engaged-arc, `inside_only` and `floor` to contour; remove what does not",
        )),
        _ => Err(at(
            &table.kind,
            "no such law; write \"circumference\" (cup mills), \"contour\" or \"engagement\" (end mills), \"engaged-arc\", \
             \"table\" or \"programmed\"",
        )),
    }
}

pub(crate) fn length_mm(quantity: &Spanned<Quantity>, unit: LengthUnit, name: &str) -> Result<f64, Complaint> {
    let mm = quantity.as_ref().to_mm(unit);
    if mm > 0.0 && mm < 1e5 { Ok(mm) } else { Err(at(quantity, &format!("{name} must be a positive length"))) }
}

pub(crate) fn positive(value: &Spanned<f64>, name: &str) -> Result<f64, Complaint> {
    let number = *value.as_ref();
    if number > 0.0 && number < 1e6 { Ok(number) } else { Err(at(value, &format!("{name} must be positive"))) }
}

pub(crate) fn at<T>(place: &Spanned<T>, message: &str) -> Complaint {
    (place.span().start, message.to_string())
}

#[cfg(test)]
mod tests;
