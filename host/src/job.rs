//! `JOB.toml`: read, checked once, every complaint with its place in the file.

mod schema;

use std::path::{Path, PathBuf};

use arcfeed_firmware::ramp::{LimitsError, Ramp};
use arcfeed_shared::cut::{CutRule, RULES_MAX, Rotation, StockLine};
use arcfeed_shared::job::{FeedPolicy, Job, LawKind, OverrideLimits};
use arcfeed_shared::nc::modal::Turn;
use arcfeed_shared::tool::{CupMill, Edge};
use arcfeed_shared::units::{LengthUnit, MmPerTooth, Nm, RevPerMin};
use toml::Spanned;

use schema::{CutTable, JobTable, Quantity, StockTable};

/// A job file, checked.
#[derive(Clone, Debug)]
pub struct JobFile {
    /// What the controller and the planner need.
    pub job: Job,
    /// The program it speaks of.
    pub program: PathBuf,
    /// The DNC line.
    pub serial: SerialSettings,
}

/// The DNC line, under pyserial's names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SerialSettings {
    /// Bits per second.
    pub baudrate: u32,
    /// Data bits.
    pub bytesize: u8,
    /// Parity.
    pub parity: Parity,
    /// Stop bits.
    pub stopbits: u8,
    /// XON/XOFF, done by the sender itself.
    pub xonxoff: bool,
}

/// Parity of the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// N.
    None,
    /// E.
    Even,
    /// O.
    Odd,
}

impl SerialSettings {
    /// Bits on the line for one character.
    pub fn bits_per_char(&self) -> u32 {
        1 + u32::from(self.bytesize) + u32::from(self.parity != Parity::None) + u32::from(self.stopbits)
    }
}

/// What is wrong with a job file: `file:line:column: what and what to do`.
#[derive(Debug, thiserror::Error)]
pub enum JobError {
    /// The file cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// The job file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The file says something that makes no sense.
    #[error("{path}:{line}:{column}: {message}")]
    Content {
        /// The job file.
        path: PathBuf,
        /// Line, counted from 1.
        line: usize,
        /// Column, counted from 1.
        column: usize,
        /// What was found and what to do.
        message: String,
    },
}

/// A complaint at a byte offset of the file.
type Complaint = (usize, String);

impl JobFile {
    /// Reads and checks a job file.
    ///
    /// # Errors
    /// See [`JobError`].
    pub fn load(path: &Path) -> Result<Self, JobError> {
        let text = std::fs::read_to_string(path).map_err(|source| JobError::Read { path: path.into(), source })?;
        JobFile::parse(path, &text)
    }

    /// Checks a job given as text; `path` is for messages and for the program's place.
    ///
    /// # Errors
    /// See [`JobError`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, JobError> {
        let table: Result<JobTable, Complaint> = toml::from_str(text)
            .map_err(|error| (error.span().map_or(0, |span| span.start), error.message().to_string()));
        table.and_then(|table| build(&table, path.parent().unwrap_or(Path::new("")))).map_err(|(offset, message)| {
            let before = &text[..offset.min(text.len())];
            let line = before.matches('\n').count() + 1;
            let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
            let is_toml = path.extension().is_some_and(|extension| extension == "toml");
            let hint = if is_toml { "" } else { " (this command takes a job file, JOB.toml, not a program)" };
            JobError::Content { path: path.into(), line, column, message: format!("{message}{hint}") }
        })
    }
}

fn build(table: &JobTable, folder: &Path) -> Result<JobFile, Complaint> {
    let unit = table.units.into();
    let tool = build_tool(table, unit)?;
    let spindle = &table.spindle.rev_per_min;
    let rev_per_min = positive(spindle, "the spindle speed")?;
    let law = match table.law.kind.as_ref().as_str() {
        "circumference" => LawKind::Circumference,
        "programmed" => LawKind::Programmed,
        _ => {
            return Err(at(&table.law.kind, "this law is not built yet; write \"circumference\" or \"programmed\""));
        }
    };
    let feed_mm = length_mm(&table.law.feed_per_tooth, unit, "the feed per tooth")?;
    let job = Job {
        unit,
        tool,
        spindle: RevPerMin(rev_per_min as f32),
        law,
        feed_per_tooth: MmPerTooth(feed_mm as f32),
        policy: build_policy(table)?,
        limits: build_limits(table)?,
        rules: build_rules(table, unit)?,
    };
    if table.control.preset.as_ref() != "fanuc-16i" {
        return Err(at(&table.control.preset, "no such control; write \"fanuc-16i\""));
    }
    Ok(JobFile { job, program: folder.join(table.program.as_ref()), serial: build_serial(table)? })
}

fn build_tool(table: &JobTable, unit: LengthUnit) -> Result<CupMill, Complaint> {
    if table.tool.kind.as_ref() != "cup-mill" {
        return Err(at(&table.tool.kind, "only \"cup-mill\" is built so far"));
    }
    let outer_mm = length_mm(&table.tool.outer_radius, unit, "outer_radius")?;
    let inner_mm = length_mm(&table.tool.inner_radius, unit, "inner_radius")?;
    if inner_mm >= outer_mm {
        return Err(at(&table.tool.inner_radius, "inner_radius must be less than outer_radius"));
    }
    let teeth = *table.tool.active_teeth.as_ref();
    if teeth == 0 {
        return Err(at(&table.tool.active_teeth, "a tool needs at least one active tooth"));
    }
    Ok(CupMill { outer_radius: Nm::from_mm(outer_mm), inner_radius: Nm::from_mm(inner_mm), active_teeth: teeth })
}

fn build_policy(table: &JobTable) -> Result<FeedPolicy, Complaint> {
    match table.r#override.mode.as_ref().as_str() {
        "safe-base" => Ok(FeedPolicy::SafeBase),
        "override-only" => Ok(FeedPolicy::OverrideOnly),
        _ => {
            Err(at(&table.r#override.mode, "no such mode, or not built yet; write \"safe-base\" or \"override-only\""))
        }
    }
}

fn build_limits(table: &JobTable) -> Result<OverrideLimits, Complaint> {
    let given = &table.r#override;
    let limits = OverrideLimits {
        min_percent: *given.min.as_ref(),
        max_percent: *given.max.as_ref(),
        step_percent: *given.step.as_ref(),
        slew_up_percent_per_s: *given.slew_up.as_ref(),
        slew_down_percent_per_s: *given.slew_down.as_ref(),
    };
    match Ramp::new(&limits) {
        Ok(_) => Ok(limits),
        Err(LimitsError::Range) if limits.min_percent > 100 => Err(at(&given.min, "min must be at most 100 %")),
        Err(LimitsError::Range) => Err(at(&given.max, "max must lie between 100 % and 254 %, the control's limit")),
        Err(LimitsError::Step) => Err(at(&given.step, "step must be a divisor of 100 %")),
        Err(LimitsError::Slew) => Err(at(&given.slew_up, "slew_up and slew_down must be positive, in % per second")),
    }
}

fn build_rules(table: &JobTable, unit: LengthUnit) -> Result<heapless::Vec<CutRule, RULES_MAX>, Complaint> {
    let mut rules = heapless::Vec::new();
    for cut in &table.cut {
        let rule = build_rule(cut.as_ref(), unit)?;
        rules.push(rule).map_err(|_| at(cut, &format!("more than {RULES_MAX} cut rules")))?;
    }
    Ok(rules)
}

fn build_rule(cut: &CutTable, unit: LengthUnit) -> Result<CutRule, Complaint> {
    let level = cut.z.as_ref().map(|levels| {
        let [low, high] = levels.as_ref();
        let nm = |quantity: &Quantity| Nm::from_mm(quantity.to_mm(unit));
        (nm(low), nm(high))
    });
    if let (Some((low, high)), Some(given)) = (level, &cut.z)
        && low > high
    {
        return Err(at(given, "the lower level comes first"));
    }
    let sequence = cut.n.as_ref().map(|range| {
        let [first, last] = *range.as_ref();
        (first, last)
    });
    Ok(CutRule {
        rotation: match cut.rotation {
            schema::RotationWord::Interior => Rotation::Interior,
            schema::RotationWord::Exterior => Rotation::Exterior,
        },
        turn: match cut.direction {
            schema::DirectionWord::Cw => Turn::Cw,
            schema::DirectionWord::Ccw => Turn::Ccw,
        },
        edge: match cut.side {
            schema::SideWord::Outer => Edge::Outer,
            schema::SideWord::Inner => Edge::Inner,
        },
        stock: build_stock(&cut.stock, unit)?,
        sequence,
        level,
    })
}

/// A line by angle and offset, or through two points with the material on the left of the way from one to the other.
fn build_stock(stock: &Spanned<StockTable>, unit: LengthUnit) -> Result<StockLine, Complaint> {
    match stock.as_ref() {
        StockTable { normal_deg: Some(normal_deg), offset: Some(offset), from: None, to: None } => {
            Ok(StockLine::from_angle(*normal_deg, offset.to_mm(unit)))
        }
        StockTable { normal_deg: None, offset: None, from: Some(from), to: Some(to) } => {
            let [x, y] = from.each_ref().map(|quantity| quantity.to_mm(unit));
            let [to_x, to_y] = to.each_ref().map(|quantity| quantity.to_mm(unit));
            let (dx, dy) = (to_x - x, to_y - y);
            let length = libm::hypot(dx, dy);
            if length == 0.0 {
                return Err(at(stock, "`from` and `to` are the same point"));
            }
            let normal = [dy / length, -dx / length];
            Ok(StockLine { normal, offset_mm: normal[0] * x + normal[1] * y })
        }
        _ => Err(at(stock, "give the stock line as { normal_deg, offset } or as { from = [x, y], to = [x, y] }")),
    }
}

fn build_serial(table: &JobTable) -> Result<SerialSettings, Complaint> {
    let given = &table.serial;
    let choice = |value: &Spanned<u8>, allowed: std::ops::RangeInclusive<u8>, name: &str| {
        let (low, high) = (allowed.start(), allowed.end());
        if allowed.contains(value.as_ref()) {
            Ok(*value.as_ref())
        } else {
            Err(at(value, &format!("{name} must be {low} to {high}")))
        }
    };
    let baudrate = *given.baudrate.as_ref();
    if !(50..=4_000_000).contains(&baudrate) {
        return Err(at(&given.baudrate, "baudrate must lie between 50 and 4000000"));
    }
    Ok(SerialSettings {
        baudrate,
        bytesize: choice(&given.bytesize, 5..=8, "bytesize")?,
        parity: match given.parity.as_ref().as_str() {
            "N" => Parity::None,
            "E" => Parity::Even,
            "O" => Parity::Odd,
            _ => return Err(at(&given.parity, "parity must be \"N\", \"E\" or \"O\"")),
        },
        stopbits: choice(&given.stopbits, 1..=2, "stopbits")?,
        xonxoff: given.xonxoff,
    })
}

fn length_mm(quantity: &Spanned<Quantity>, unit: LengthUnit, name: &str) -> Result<f64, Complaint> {
    let mm = quantity.as_ref().to_mm(unit);
    if mm > 0.0 && mm < 1e5 { Ok(mm) } else { Err(at(quantity, &format!("{name} must be a positive length"))) }
}

fn positive(value: &Spanned<f64>, name: &str) -> Result<f64, Complaint> {
    let number = *value.as_ref();
    if number > 0.0 && number < 1e6 { Ok(number) } else { Err(at(value, &format!("{name} must be positive"))) }
}

fn at<T>(place: &Spanned<T>, message: &str) -> Complaint {
    (place.span().start, message.to_string())
}

#[cfg(test)]
mod tests;
