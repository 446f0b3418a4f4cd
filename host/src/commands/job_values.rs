//! Values of a job on the command line, for programs without a job file.

use std::path::{Path, PathBuf};

use arcfeed_nc::block::Reading;
use arcfeed_units::LengthUnit;

use super::control_args::{ControlArgs, ControlReading, name_from};
use super::outcome::Failure;
use crate::console::note;
use crate::file_error::FileError;
use crate::init::answers::{Answers, ForTool, Length, Milling};
use crate::init::findings::Findings;
use crate::init::groups::group;
use crate::init::job_writer::job;
use crate::init::proposal::{LikelyTool, Proposal, ProposedTool, propose};
use crate::init::survey;
use crate::init::wording;
use crate::job::{ControlKind, JobFile, questions};

/// Difference between two diameters that are the same.
const SAME_RATIO: f64 = 0.01;

/// Options with values that a program does not contain, such as diameter and teeth.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Values for a program without a job file")]
pub struct JobValues {
    /// Diameter of the end mill, in the program's unit, or 10mm, 0.5in; T3=10 for one of several tools. Without it, the one
    /// in the program's comments
    #[arg(long, value_name = "[T3=]DIAMETER")]
    tool: Vec<ForTool<Length>>,
    /// Number of teeth
    #[arg(long, value_name = "[T3=]COUNT")]
    teeth: Vec<ForTool<u16>>,
    /// Feed per tooth wanted at the contour; without it, the programmed F is the feed at the contour
    #[arg(long, value_name = "[T3=]LENGTH")]
    feed_per_tooth: Vec<ForTool<Length>>,
    /// Spindle speed where the program has no S, rev/min
    #[arg(long, value_name = "REV_PER_MIN", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    spindle: Option<u32>,
    /// Feed outside arcs faster, up to this percentage of their F; without it they keep their F
    #[arg(long, value_name = "PERCENT", value_parser = clap::value_parser!(u16).range(100..=250))]
    max: Option<u16>,
    /// Feed mode (docs/job.md): rewrite-only writes F words, the others need an override
    #[arg(long, value_parser = ["rewrite-only", "safe-base", "override-only"])]
    mode: Option<String>,
    /// Direction of milling: with climb and M3, counter-clockwise arcs run inside the contour
    #[arg(long, value_enum)]
    milling: Option<Milling>,
    /// Folder of subprograms that are not in the program's file: O9010, O9010.nc or 9010.nc
    #[arg(long, value_name = "DIR")]
    pub library: Option<PathBuf>,
    /// Control that runs the program.
    #[command(flatten)]
    pub of_control: ControlArgs,
}

impl JobValues {
    /// Whether any of the values is given.
    pub fn is_any(&self) -> bool {
        let JobValues { tool, teeth, feed_per_tooth, spindle, max, mode, milling, library, of_control } = self;
        let is_listed = !tool.is_empty() || !teeth.is_empty() || !feed_per_tooth.is_empty();
        is_listed
            || spindle.is_some()
            || max.is_some()
            || mode.is_some()
            || milling.is_some()
            || library.is_some()
            || of_control.is_given()
    }

    /// These options as answers to the questions of a new job; `unit` is the program's unit at power-on, if known.
    pub fn answers(&self, unit: Option<LengthUnit>) -> Answers {
        Answers {
            diameters: self.tool.clone(),
            teeth: self.teeth.clone(),
            feeds_per_tooth: self.feed_per_tooth.clone(),
            rev_per_min: self.spindle,
            max_percent: self.max,
            mode: self.mode.clone(),
            milling: self.milling.unwrap_or_default(),
            units: unit,
        }
    }

    /// Keys and values for the table `[control]` of the job file `job`, as text.
    pub fn control_keys(&self, control: ControlKind, job: &Path) -> Vec<(&'static str, String)> {
        let mut keys = self.of_control.keys(control, job);
        keys.extend(self.library.as_ref().map(|folder| ("library", name_from(job, folder))));
        keys
    }

    /// Job for a program without a job file: the one that `arcfeed init` proposes with these values, without the
    /// tools that have open questions.
    ///
    /// # Errors
    /// The program cannot be read, or a value is missing: with the option that gives it.
    pub fn job_of(&self, path: &Path) -> Result<JobFile, Failure> {
        let ControlReading { control, settings, tables, unit } = self.of_control.read(None, Reading::Lenient)?;
        let answers = self.answers(unit);
        let loaded = survey::load(path, (settings, tables), unit, self.library.as_deref());
        let (_, survey) = loaded.map_err(Failure::Input)?;
        survey.warn_of_unit(path);
        survey.check_max(path, self.max).map_err(Failure::Usage)?;
        wording::unknown_radius(path, &survey).iter().for_each(|found| note(format_args!("{found}")));
        let groups = group(&survey.arcs);
        let mut proposal = propose(&groups, &survey, &answers);
        let failed = |message: String| Failure::Usage(format!("{}: {message}", path.display()));
        keep_known(&mut proposal, &answers).map_err(failed)?;
        let program = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let findings = Findings {
            program: &program,
            survey: &survey,
            groups: &groups,
            proposal: &proposal,
            answers: &answers,
            control: &self.control_keys(control, path),
        };
        let text = job(&findings);
        let open: Vec<String> = questions::open(&text).into_iter().map(|question| question.key).collect();
        let open = missing_options(&open);
        if !open.is_empty() {
            return Err(failed(format!("missing: {}; or make a job file: `arcfeed init`", open.join(", "))));
        }
        // The text is that of a job file in the program's folder.
        let file = JobFile::parse(&path.with_extension("toml"), &text).map_err(|error| match error {
            FileError::Content { message, .. } => failed(message),
            error => error.into(),
        })?;
        let named = proposal.tools.iter().filter(|tool| !tool.cuts.is_empty());
        named.for_each(|tool| {
            note(format_args!("{}", words(tool, &findings)));
            findings.milling_hint(tool).iter().for_each(|hint| note(format_args!("note: {hint}")));
            other_diameter(tool, &findings).iter().for_each(|warning| note(format_args!("{warning}")));
        });
        Ok(file)
    }
}

/// Keeps the tools whose diameter is known, and says which others keep their feeds.
fn keep_known(proposal: &mut Proposal, answers: &Answers) -> Result<(), String> {
    let name = |tool: &ProposedTool| tool.number.map_or("the tool".into(), |number| format!("T{number}"));
    let is_cup = |tool: &ProposedTool| tool.kind != LikelyTool::EndMill;
    let noted = |tool: &ProposedTool| tool.note.as_ref().and_then(|note| note.data.diameter_mm).is_some();
    let is_named =
        |tool: &ProposedTool| answers.diameters.iter().any(|value| value.tool.is_some() && value.tool == tool.number);
    let is_open = |tool: &&ProposedTool| !noted(tool) && !is_named(tool);
    if let Some(unknown) = answers
        .diameters
        .iter()
        .filter_map(|value| value.tool)
        .find(|tool| !proposal.tools.iter().any(|own| own.number == Some(*tool)))
    {
        let tools: Vec<String> = proposal.tools.iter().map(name).collect();
        return Err(format!("--tool T{unknown}: this tool mills no arcs in G17; those that do: {}", tools.join(", ")));
    }
    let open: Vec<String> = proposal.tools.iter().filter(is_open).map(name).collect();
    let has_common = answers.diameters.iter().any(|value| value.tool.is_none());
    if has_common && proposal.tools.len() > 1 {
        let tools: Vec<String> = proposal.tools.iter().map(|tool| format!("--tool {}=DIAMETER", name(tool))).collect();
        return Err(format!(
            "several tools mill arcs: write {}; those whose diameter is unknown keep their feeds",
            tools.join(" ")
        ));
    }
    proposal.excluded.iter().for_each(|tool| note(format_args!("note: {}", wording::exclusion(tool))));
    if has_common {
        return Ok(());
    }
    if let Some(cup) = proposal.tools.iter().find(|tool| is_cup(tool)) {
        return Err(format!("{} looks like a cup mill, which needs a job file: `arcfeed init`", name(cup)));
    }
    if proposal.tools.iter().all(|tool| tool.cuts.is_empty()) {
        note(format_args!("note: {}", wording::NO_ARCS));
        return Ok(());
    }
    proposal.tools.retain(|tool| noted(tool) || is_named(tool));
    let option = |tool: &String| match tool.strip_prefix('T') {
        Some(number) => format!("--tool T{number}=DIAMETER"),
        None => "--tool DIAMETER".into(),
    };
    let options: Vec<String> = open.iter().map(option).collect();
    match (proposal.tools.is_empty(), open.as_slice()) {
        (true, open) => Err(format!("the diameter of {} is unknown: write {}", open.join(", "), options.join(" "))),
        (false, []) => Ok(()),
        (false, open) => {
            note(format_args!(
                "note: the diameter of {} is unknown: its feeds stay ({})",
                open.join(", "),
                options.join(" ")
            ));
            Ok(())
        }
    }
}

/// Options that answer these questions. The highest feed is that of the program where a feed per tooth is given.
fn missing_options(keys: &[String]) -> Vec<String> {
    let is_open = |name: &str| keys.iter().any(|key| key.ends_with(name));
    let asked = keys.iter().filter(|key| !(key.ends_with("max_feed") && is_open("feed_per_tooth")));
    asked.map(|key| option_of(key)).collect()
}

/// Option that answers a question.
fn option_of(key: &str) -> String {
    match key.rsplit('.').next().unwrap_or(key) {
        "diameter" => "--tool DIAMETER".into(),
        "teeth" => "--teeth COUNT".into(),
        "feed_per_tooth" => "--feed-per-tooth LENGTH".into(),
        "rev_per_min" => "--spindle REV_PER_MIN (the program has no S)".into(),
        "units" => "--units mm or --units inch (the program has no G20 or G21)".into(),
        _ => format!("`{key}`"),
    }
}

/// Warning of a given diameter that is not that of the program's comment.
fn other_diameter(tool: &ProposedTool, findings: &Findings<'_>) -> Option<String> {
    let given_mm = Answers::of(&findings.answers.diameters, tool.number)?.to_mm(findings.unit());
    let (noted, noted_mm) = tool.note.as_ref().and_then(|note| Some((note, note.data.diameter_mm?)))?;
    let unit = findings.unit();
    ((given_mm / noted_mm - 1.0).abs() > SAME_RATIO).then(|| {
        let [given, own] = [given_mm, noted_mm].map(|mm| wording::length(mm, unit));
        format!(
            "warning: --tool gives a diameter of {given} {unit}, line {} says {own} {unit}: {}",
            noted.line,
            noted.text.trim(),
            unit = unit.label()
        )
    })
}

/// A tool of the job for a person, with the source of its diameter.
fn words(tool: &ProposedTool, findings: &Findings<'_>) -> String {
    let unit = findings.unit();
    let number = tool.number.map_or("tool".into(), |number| format!("T{number}"));
    let is_given = Answers::of(&findings.answers.diameters, tool.number).is_some();
    let source = match &tool.note {
        Some(note) if !is_given => format!(" (line {}: {})", note.line, note.text.trim()),
        _ => String::new(),
    };
    let diameter = wording::length(findings.diameter_mm(tool).unwrap_or_default(), unit);
    let direction = match findings.answers.milling {
        Milling::Climb => "climb milling: ccw arcs inside, cw arcs outside",
        Milling::Conventional => "conventional milling: cw arcs inside, ccw arcs outside",
    };
    format!("note: {number}: end mill, diameter {diameter} {}{source}; {direction}", unit.label())
}
