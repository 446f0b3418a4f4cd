//! `arcfeed check`: the alarms that a control would raise for a program.

mod findings;

mod path_report;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

use arcfeed_kinematics::deviation::Mode;
use arcfeed_nc::block::Reading;
use serde::Serialize;

use findings::CheckFindings;
use path_report::PathFigures;

use super::control_args::{ControlArgs, ControlReading};
use super::five_axis::{PathReport, PlacementArgs, is_cl, load_cl, load_machine};
use super::outcome::{Failure, json_text, name_tool, say, tool_at, warn_of_rules};
use crate::adapt::unused_rules::RuleUse;
use crate::console::note;
use crate::job::{ControlKind, JobFile};
use crate::machine_file::MachineFile;
use crate::plural::counted;
use crate::post::check::check_program;
use crate::post::cl::Cl;
use crate::post::cl_from_nc;
use crate::post::finding::FindingKind;
use crate::post::plan::AxisPlan;
use crate::program::{
    AssumedUnit, DecimalSurvey, Diagnostic, MoveCounts, PathSummary, Program, ProgramLine, ProgramSummary, RunBounds,
    Severity, Source, fitting_convention, read_bounded,
};

/// Check an NC program, or a job and its program: every alarm with line and column; with --machine also everything that
/// the machine cannot follow, in CL data too
#[derive(Debug, clap::Args)]
pub struct Check {
    /// The NC program, a job file (.toml), or with --machine CL data (.apt, .cl, .cls)
    program: PathBuf,
    /// Check on this five-axis machine, a file or the name of a preset (docs/kinematics.md)
    #[arg(long, value_name = "MACHINE.toml")]
    machine: Option<PathBuf>,
    #[command(flatten)]
    placement: PlacementArgs,
    /// Report exactly what the control would reject, also in titles and comments
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    of_control: ControlArgs,
    /// Folder of subprograms that are not in the program's file: O9010, O9010.nc or 9010.nc
    #[arg(long, value_name = "DIR")]
    library: Option<PathBuf>,
    /// Most blocks that a program with macro statements or calls executes, and most statements between two moves
    #[arg(long, value_name = "N", default_value_t = 2_000_000, value_parser = clap::value_parser!(u32).range(1..))]
    max_blocks: u32,
    /// Longest time in which it is executed
    #[arg(long, value_name = "SECONDS", default_value_t = 60, value_parser = clap::value_parser!(u64).range(1..=86_400))]
    max_seconds: u64,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    json: bool,
}

/// Numbers of a program's lines, blocks and moves, for the summary of `check`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Number of lines in the file.
    pub lines: usize,
    /// Number of blocks: all lines but `%` and empty ones.
    pub blocks: usize,
    /// Number of blocks with only a comment or a title.
    pub comments: usize,
    /// Number of arcs, including helices.
    pub arcs: usize,
    /// Number of arcs that also move along the axis square to their plane.
    pub helices: usize,
    /// Number of straight cutting moves.
    pub linear: usize,
    /// Number of rapid moves.
    pub rapids: usize,
    /// Number of moves of any kind in which a rotary axis moves.
    pub rotary: usize,
}

#[derive(Serialize)]
struct CheckReport<'a> {
    program: String,
    control: &'a str,
    strict: bool,
    counts: Counts,
    calls: Vec<CallCount>,
    summary: PathFigures,
    errors: Vec<Entry<'a>>,
    warnings: Vec<Entry<'a>>,
    not_listed: usize,
}

/// Executions of a called program.
#[derive(Serialize)]
struct CallCount {
    program: u32,
    executions: u32,
}

#[derive(Serialize)]
struct Entry<'a> {
    line: usize,
    column: usize,
    end_column: usize,
    alarm: Option<u16>,
    message: &'a str,
    found: &'a str,
}

/// Passes on all lines of a program, those that it executes if it has been run.
fn pass_lines(source: &Source, run: Option<&Program>, each: &mut dyn FnMut(&ProgramLine)) {
    match run {
        Some(program) => program.lines().for_each(|line| each(&line)),
        None => drop(source.survey(false, each, |_, _| {})),
    }
}

impl Check {
    /// Runs the command.
    ///
    /// # Errors
    /// The program has errors, or cannot be read.
    pub fn run(&self) -> Result<(), Failure> {
        if let Some(machine) = &self.machine {
            if is_cl(&self.program) {
                return self.run_cl(&load_machine(machine)?);
            }
            let path = self.program_path()?;
            let bytes = read_bounded(&path).map_err(Failure::Input)?;
            if cl_from_nc::is_by_direction(&bytes) {
                return self.run_directions(&path, &bytes, &load_machine(machine)?);
            }
        }
        let (job, source, control, assumed) = self.read()?;
        let mut findings = CheckFindings::new(&self.program, &source.path, self.json);
        let mut used = job.as_ref().map(|file| RuleUse::new(&file.job, None));
        let mut decimals = DecimalSurvey::new(&source.settings);
        let mut path = PathSummary::new(source.settings.unit);
        let mut each_line = |line: &ProgramLine| {
            decimals.add(line);
            path.add_line(line);
            if let Some((file, used)) = job.as_ref().zip(used.as_mut()) {
                used.add(line, file, tool_at(line, &file.job));
            }
        };
        let (summary, whole) = if source.macro_line.is_none() && self.machine.is_none() {
            (source.survey(true, &mut each_line, |diagnostic, text| findings.add(diagnostic, Some(text))), None)
        } else {
            let library = self.library.as_deref().or(job.as_ref().and_then(|file| file.library.as_deref()));
            let (summary, program) = self.run_whole(&source, library, &mut findings)?;
            program.lines().for_each(|line| each_line(&line));
            (summary, Some(program))
        };
        let of_run = whole.as_ref().and_then(|program| program.run_summary.clone());
        let path = of_run.unwrap_or(path);
        let of_unit = assumed.iter().map(|assumed| (assumed.warning(), assumed.line_of(&source.bytes)));
        let of_decimals = decimals.warnings(|each| pass_lines(&source, whole.as_ref(), each));
        findings.add_all(of_decimals.into_iter().chain(path.warnings(&source.bytes)).chain(of_unit));
        findings.print();
        let path = PathFigures::new(&path);
        // The axis positions of a faulty program are unknown.
        let on =
            self.machine.as_ref().filter(|_| findings.errors == 0).map(|machine| load_machine(machine)).transpose()?;
        let counts = Counts::new(&summary);
        let calls = whole.as_ref().map(|program| &program.executions);
        match (&on, self.json) {
            (None, true) => self.print_json(&findings, (counts, path, call_counts(calls)), control),
            (Some(_), true) => {}
            (_, false) => {
                path.print();
                print_counts(&findings, counts);
                print_calls(&findings, &call_counts(calls));
            }
        }
        if findings.errors > 0 {
            return Err(refusal(&source, findings.errors));
        }
        if let Some(mut file) = job {
            // The moves of macros are only known while they run.
            let used = used.as_ref().filter(|_| source.macro_line.is_none());
            warn_of_rules(&self.program, &file, used.map(|used| (source.path.as_path(), used)));
            let question = name_tool(&mut file.job, &source.path, &summary.tools);
            question.map_or(Ok(()), |question| Err(Failure::Input(question)))?;
        }
        on.zip(whole).map_or(Ok(()), |(file, program)| self.run_program(&program, &file))
    }

    /// Text of the program, its control, and the unit if it is assumed.
    fn read(&self) -> Result<(Option<JobFile>, Source, ControlKind, Option<AssumedUnit>), Failure> {
        let reading = if self.strict { Reading::Strict } else { Reading::Lenient };
        let job = self.is_job().then(|| JobFile::load(&self.program)).transpose()?;
        let path = job.as_ref().map_or(&self.program, |file| &file.program);
        let ControlReading { control, settings, tables, unit } = self.of_control.read(job.as_ref(), reading)?;
        let mut source = Source::read(path, settings, tables).map_err(Failure::Input)?;
        let assumed = if unit.is_none() { AssumedUnit::of(&source.bytes) } else { None };
        source.settings.unit = assumed.as_ref().and_then(|assumed| assumed.likely).unwrap_or(settings.unit);
        Ok((job, source, control, assumed))
    }

    /// Reads a program that is interpreted, or whose moves are checked together.
    fn run_whole(
        &self,
        source: &Source,
        library: Option<&Path>,
        findings: &mut CheckFindings<'_>,
    ) -> Result<(ProgramSummary, Program), Failure> {
        let bounds =
            RunBounds { blocks: self.max_blocks, time: Duration::from_secs(self.max_seconds), has_options: true };
        let run = source.run(library, self.machine.is_some(), bounds);
        let mut program = run.map_err(Failure::Input)?;
        program.diagnostics.splice(0..0, program.missing_label());
        let diagnostics = std::mem::take(&mut program.diagnostics);
        let texts: Vec<&[u8]> = program.texts().collect();
        for diagnostic in diagnostics {
            let text = texts.get(diagnostic.line - 1).copied();
            findings.add(diagnostic, text);
        }
        Ok((ProgramSummary { moves: program.moves, ..ProgramSummary::new(program.lines()) }, program))
    }

    /// Path of the program, or of the job's program.
    fn program_path(&self) -> Result<PathBuf, Failure> {
        Ok(if self.is_job() { JobFile::load(&self.program)?.program } else { self.program.clone() })
    }

    fn is_job(&self) -> bool {
        self.program.extension().is_some_and(|extension| extension == "toml")
    }

    /// Checks CL data on a machine.
    fn run_cl(&self, file: &MachineFile) -> Result<(), Failure> {
        if self.strict || self.of_control.is_given() || self.library.is_some() {
            let advice = "--strict, --control, --settings, --decimals, --units and --library are for NC programs, not for CL data";
            return Err(Failure::Usage(advice.into()));
        }
        let cl = load_cl(&self.program)?;
        self.report_points(&self.program, &cl, file, &AxisPlan::new(&cl, &self.placement.task(file, None)))
    }

    /// Checks a program with directions (G43.5), which no control here interprets: the axes for its points are chosen
    /// here.
    fn run_directions(&self, path: &Path, bytes: &[u8], file: &MachineFile) -> Result<(), Failure> {
        let read = cl_from_nc::read(bytes, &file.machine, &self.placement.setup(), Mode::Tcp);
        let cl = read.map_err(|error| Failure::Input(format!("{}:{error}", path.display())))?;
        let mut plan = AxisPlan::new(&cl, &self.placement.task(file, None));
        // Such a control keeps the tool axis on its arc by itself.
        plan.findings.retain(|finding| !matches!(finding.what, FindingKind::Coarse { .. }));
        self.report_points(path, &cl, file, &plan)
    }

    fn report_points(&self, path: &Path, cl: &Cl, file: &MachineFile, plan: &AxisPlan) -> Result<(), Failure> {
        let (points, passed_over) = (cl.points.len(), Some(cl.passed_over));
        self.report(&PathReport { path, points, passed_over, machine: &file.name, plan })
    }

    /// Checks a program that gives the positions of the rotary axes itself.
    fn run_program(&self, program: &Program, file: &MachineFile) -> Result<(), Failure> {
        let (plan, points) = check_program(program, &self.placement.task(file, None));
        self.report(&PathReport { path: &program.path, points, passed_over: None, machine: &file.name, plan: &plan })
    }

    fn report(&self, path_report: &PathReport<'_>) -> Result<(), Failure> {
        if self.json {
            path_report.print_json();
        } else {
            path_report.print_findings();
            say(format_args!("{}", path_report.summary()));
        }
        path_report.verdict()
    }

    fn print_json(
        &self,
        findings: &CheckFindings<'_>,
        (counts, summary, calls): (Counts, PathFigures, Vec<CallCount>),
        control: ControlKind,
    ) {
        let entries = |severity| {
            let of = findings.listed.iter().filter(move |diagnostic| diagnostic.severity == severity);
            of.map(Entry::new).collect::<Vec<_>>()
        };
        let report = CheckReport {
            program: findings.path.display().to_string(),
            control: control.name(),
            strict: self.strict,
            counts,
            calls,
            summary,
            errors: entries(Severity::Error),
            warnings: entries(Severity::Warning),
            not_listed: findings.errors + findings.warnings - findings.listed.len(),
        };
        say(format_args!("{}", json_text(&report)));
    }
}

/// Failure of a program with errors, after advice about a convention with which it has fewer.
fn refusal(source: &Source, errors: usize) -> Failure {
    let is_plain = source.macro_line.is_none();
    if let Some(advice) = is_plain.then(|| fitting_convention(source)).flatten() {
        note(format_args!("{advice}"));
    }
    Failure::Input(format!("{}: {}: the control would stop", source.path.display(), counted(errors, "error")))
}

fn print_counts(findings: &CheckFindings<'_>, counts: Counts) {
    let (path, warnings) = (findings.path.display(), findings.warnings);
    let Counts { lines, blocks, comments, arcs, helices, linear, rapids, rotary } = counts;
    say(format_args!(
        "{path}: {}, {} ({comments} of them comments): {} ({helices} of them helices), {}, {}; a rotary axis turns in {rotary} \
         of them; {}",
        counted(lines, "line"),
        counted(blocks, "block"),
        counted(arcs, "arc"),
        counted(linear, "straight cutting move"),
        counted(rapids, "rapid"),
        counted(warnings, "warning")
    ));
}

/// One line with the called programs, if there are any.
fn print_calls(findings: &CheckFindings<'_>, calls: &[CallCount]) {
    let called: Vec<String> = calls
        .iter()
        .map(|CallCount { program, executions }| format!("O{program:04} {}", counted(*executions as usize, "time")))
        .collect();
    if !called.is_empty() {
        say(format_args!("{}: called: {}", findings.path.display(), called.join(", ")));
    }
}

fn call_counts(executions: Option<&BTreeMap<u32, u32>>) -> Vec<CallCount> {
    let counts = executions.into_iter().flatten();
    counts.map(|(program, executions)| CallCount { program: *program, executions: *executions }).collect()
}

impl Counts {
    fn new(summary: &ProgramSummary) -> Self {
        let ProgramSummary { lines, blocks, comments, moves, .. } = *summary;
        let MoveCounts { arcs, helices, linear, rapids, rotary } = moves;
        Counts { lines, blocks, comments, arcs, helices, linear, rapids, rotary }
    }
}

impl<'a> Entry<'a> {
    fn new(diagnostic: &'a Diagnostic) -> Self {
        let Diagnostic { line, column, end_column, alarm, message, found, .. } = diagnostic;
        Entry { line: *line, column: *column, end_column: *end_column, alarm: *alarm, message, found }
    }
}
