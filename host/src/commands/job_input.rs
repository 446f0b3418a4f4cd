//! Job with its program and the engagement map that its rules may name.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arcfeed_model::cut::CutRule;
use arcfeed_model::job::LawKind;
use arcfeed_nc::alarm::NotModelled;

use super::job_values::JobValues;
use super::outcome::{Failure, file_failure, read_source};
use crate::adapt::{Adapted, Known, PlanReason, PlannedBlock, adapt_with};
use crate::checksum::fingerprint;
use crate::console::note;
use crate::engagement::EngagementMap;
use crate::files;
use crate::job::JobFile;
use crate::job::cutting::Coefficients;
use crate::job::stl::StlFile;
use crate::job::workpiece::Blank;
use crate::key_values::KeyValue;
use crate::plural::counted;
use crate::program::{Diagnostic, ExecutedPlaces, Program, ProgramLine, Source};

/// Lines that a warning names beside the first.
const KEPT_LINES: usize = 3;

/// Input of a command: a job file, or a program with the values that a job would add.
#[derive(Clone, Debug, clap::Args)]
pub struct JobInput {
    /// The job file (.toml); or an NC program, for end mills: tools from its comments or from the options below
    #[arg(value_name = "JOB.toml|PROGRAM.nc")]
    pub job: PathBuf,
    /// Value for a key of the job file in place of its own, cut.2.feed_per_tooth=0.05, or of its machine's file,
    /// machine-file.linear.X.max_feed=9000; items are counted from 1; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<KeyValue>,
    #[command(flatten)]
    values: JobValues,
}

impl JobInput {
    /// Whether it is a job file.
    pub fn is_job(&self) -> bool {
        self.job.extension().is_some_and(|extension| extension == "toml")
    }

    /// Loads job and program, both without errors, with the engagement map that the job names.
    ///
    /// # Errors
    /// See [`JobInput::load_text`]; a program too long to be kept as a whole.
    pub fn load(&self) -> Result<(JobFile, Program), Failure> {
        let (file, source, _) = self.load_text()?;
        let program = source.whole().map_err(Failure::Input)?;
        Ok((file, program))
    }

    /// Loads job and program, keeping only the program's text; also says whether a feed set by a law could stay in
    /// force for a line that needs another one.
    ///
    /// # Errors
    /// Every error of the program, one per line; a fault of the map; options beside a job file; a missing option.
    pub fn load_text(&self) -> Result<(JobFile, Source, bool), Failure> {
        let file = match self.is_job() {
            true if self.values.is_any() => {
                let message = "the options for programs without a job file do not go with one: write them into the job";
                return Err(Failure::Usage(message.into()));
            }
            true => JobFile::load_with(&self.job, &self.set)?,
            false if !self.set.is_empty() => {
                return Err(Failure::Usage(
                    "--set changes a job file: give JOB.toml, or the options for programs".into(),
                ));
            }
            false => self.values.job_of(&self.job)?,
        };
        let (mut file, source, may_leak) = read_source(&self.job, file)?;
        read_map(&mut file, || source.bytes.clone())?;
        Ok((file, source, may_leak))
    }
}

/// Loads a job and the text of its program; also says whether a feed set by a law could stay in force for a line that
/// needs another one.
///
/// # Errors
/// Every error of the program, one per line; a fault of the map.
pub fn load_text(job: &Path) -> Result<(JobFile, Source, bool), Failure> {
    let (mut file, source, may_leak) = read_source(job, JobFile::load(job)?)?;
    read_map(&mut file, || source.bytes.clone())?;
    Ok((file, source, may_leak))
}

fn read_map(file: &mut JobFile, program: impl FnOnce() -> Vec<u8>) -> Result<(), Failure> {
    if let Some(named) = &file.map_file {
        file.map = Some(EngagementMap::read(named, made_of(file, program())?)?);
    }
    Ok(())
}

/// Fingerprint (hash) of everything on which an engagement map depends: program, tool, workpiece. `made_of` has the
/// first part of these data.
///
/// # Errors
/// A file of the workpiece cannot be read.
pub fn made_of(file: &JobFile, mut made_of: Vec<u8>) -> Result<u64, Failure> {
    let JobFile { job, workpiece, cutting, .. } = file;
    let depth = cutting.as_ref().map(|cutting| (cutting.axial_depth_mm, cutting.layers));
    let body = workpiece.as_ref().map(|workpiece| (workpiece.body, workpiece.step_mm));
    let is_indexed = workpiece.as_ref().is_some_and(|workpiece| workpiece.is_indexed);
    made_of.extend(
        format!("{:?}", (job.unit, job.tools.first().tool, job.tools.first().feed_per_tooth, body, depth)).bytes(),
    );
    if let Some(plunge) = &file.plunge {
        let material = cutting.as_ref().map(|cutting| match &cutting.coefficients {
            Coefficients::Material { name, .. } => name.clone(),
            numbers => format!("{numbers:?}"),
        });
        made_of.extend(format!("{:?}", (plunge.has_ramps, is_indexed, material)).bytes());
    }
    match workpiece.as_ref().map(|workpiece| &workpiece.blank) {
        Some(Blank::Stl(StlFile { path, unit })) => {
            made_of.extend(format!("{unit:?}").bytes());
            made_of.extend(files::read(path).map_err(|error| file_failure(path, &error))?);
        }
        shape => made_of.extend(format!("{shape:?}").bytes()),
    }
    Ok(fingerprint(&made_of))
}

/// Applies the job's feeds to the program; warns on stderr of moves that keep their own feed although a cut rule
/// matches them.
pub fn adapted(program: &Program, file: &JobFile) -> Adapted {
    let adapted = adapt_with(program, &file.job, Known::of(file));
    let (mut kept, mut unknown) = (KeptMoves::new(program.places.clone()), UnknownMoves::default());
    let mut blocks = adapted.blocks.iter().peekable();
    for (number, line) in (1..).zip(program.lines()) {
        while let Some(block) = blocks.next_if(|block| block.line == number) {
            unknown.add(block, file);
            kept.add(block, &line);
        }
    }
    kept.warn(&program.path);
    unknown.warn(&program.path, file);
    adapted
}

/// Moves that do not have the feed that their law demands, counted by reason.
#[derive(Debug, Default)]
pub struct KeptMoves {
    reasons: Vec<KeptReason>,
    /// Places of blocks as executed, and the lines of the file that are counted.
    places: Option<Arc<ExecutedPlaces>>,
    counted: BTreeSet<(usize, &'static str)>,
    /// Cutting moves, those that a law governs, and the reasons of the others.
    cutting: usize,
    governed: usize,
    ungoverned: BTreeMap<&'static str, usize>,
}

/// Moves with the same reason.
#[derive(Debug)]
struct KeptReason {
    reason: PlanReason,
    under: Option<NotModelled>,
    /// Warning of the first.
    first: Diagnostic,
    /// Lines of the next few.
    lines: Vec<usize>,
    /// All others.
    count: usize,
}

impl KeptMoves {
    /// Empty list. `places` are the places of the executed blocks in the program's file, if they differ from its lines.
    pub fn new(places: Option<Arc<ExecutedPlaces>>) -> Self {
        KeptMoves { places, ..KeptMoves::default() }
    }

    /// Adds a block if it does not have the feed that its law demands; of the executions of a line, the first.
    pub fn add(&mut self, block: &PlannedBlock, line: &ProgramLine) {
        let (reason, under) = (block.reason, block.under);
        let corner = block.inserted.as_ref().and_then(|inserted| inserted.demand);
        if block.demand.or(corner).is_some() {
            self.governed += 1;
        } else if reason != PlanReason::Rapid {
            *self.ungoverned.entry(reason.label()).or_default() += 1;
        }
        self.cutting += usize::from(reason != PlanReason::Rapid);
        if block.rule.is_none() && !block.is_descent {
            return;
        }
        let mut number = block.line;
        if let Some(places) = &self.places {
            number = places.line_in_file(number);
            if !self.counted.insert((number, reason.label())) {
                return;
            }
        }
        match self.reasons.iter_mut().find(|known| (known.reason, known.under) == (reason, under)) {
            Some(known) if known.lines.len() < KEPT_LINES => known.lines.push(number),
            Some(known) => known.count += 1,
            None => self.reasons.extend(block.departure(line).map(|first| KeptReason {
                reason,
                under,
                first,
                lines: Vec::new(),
                count: 0,
            })),
        }
    }

    /// Explains on stderr why no move is governed, if none is, and what to change.
    pub fn explain(&self, program: &Path, file: &JobFile) {
        if self.governed > 0 || file.job.tools.first().law == LawKind::Programmed && file.job.tools.len() == 1 {
            return;
        }
        let (cutting, unfit) = (self.cutting, self.ungoverned.get(PlanReason::NoRule.label()).copied().unwrap_or(0));
        let why = match (cutting, file.job.rules.is_empty()) {
            (0, _) => "it has no cutting move".to_owned(),
            (_, true) => "the job has no cut rule: add a [[cut]] for its moves (docs/job.md)".into(),
            _ if unfit == cutting => format!(
                "no cut rule fits its {}: compare moves, direction, n, z, lines and plane of the rules, and \
                 the tool's number and radii, with the program",
                counted(cutting, "cutting move")
            ),
            _ => {
                let counts: Vec<String> =
                    self.ungoverned.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
                format!("reasons of its {} (docs/json.md): {}", counted(cutting, "cutting move"), counts.join(", "))
            }
        };
        note(format_args!(
            "{}: warning: no move is governed, so all feeds stay as programmed: {why}",
            program.display()
        ));
    }

    /// Warns on stderr of these moves, once for each reason.
    pub fn warn(&self, program: &Path) {
        for KeptReason { first, lines, count, .. } in &self.reasons {
            let first = self.places.as_ref().map_or_else(|| first.clone(), |places| places.in_file(first.clone()));
            let lines: Vec<String> = lines.iter().map(usize::to_string).collect();
            let others = match (lines.as_slice(), count) {
                ([], _) => String::new(),
                (_, 0) => format!("; the same in lines {}", lines.join(", ")),
                _ => format!("; the same in lines {} and {count} more", lines.join(", ")),
            };
            note(format_args!("{}:{first}{others}", program.display()));
        }
    }
}

/// Moves whose cut rule takes the engagement from the engagement map, but which the map does not contain: their first
/// line and their number.
#[derive(Clone, Copy, Debug, Default)]
pub struct UnknownMoves {
    first_line: usize,
    count: usize,
}

impl UnknownMoves {
    /// Counts a block if the map does not contain it.
    pub fn add(&mut self, block: &PlannedBlock, file: &JobFile) {
        let rule = block.rule.and_then(|rule| file.job.rules.get(rule));
        if block.along.is_none() && block.under.is_none() && rule.is_some_and(CutRule::expects_engagement_per_move) {
            self.first_line = if self.count == 0 { block.line } else { self.first_line };
            self.count += 1;
        }
    }

    /// Warns on stderr of their number and first line, if there are any.
    pub fn warn(&self, program: &Path, file: &JobFile) {
        let Some(named) = file.map_file.as_ref().filter(|_| self.count > 0) else { return };
        note(format_args!(
            "{}:{}:1: warning: {} knows nothing of {} from here on, which keep their own feed; make the map \
             anew with `arcfeed engage` if rules have changed",
            program.display(),
            self.first_line,
            named.display(),
            counted(self.count, "move")
        ));
    }
}
