//! `arcfeed check`: what a control would say to a program.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use annotate_snippets::Renderer;
use arcfeed_shared::kinematics::between::Mode;
use arcfeed_shared::nc::block::{Line, Reading};
use arcfeed_shared::nc::settings::Scope;
use serde::Serialize;

use super::five_axis::{Placing, Told, is_cl, load_cl, load_machine};
use super::outcome::{Failure, file_failure, say, spindle_contradictions};
use crate::control::{self, Convention};
use crate::job::{ControlKind, JobFile};
use crate::machine_file::MachineFile;
use crate::post::back;
use crate::post::cl::Cl;
use crate::post::finding::What;
use crate::post::judge::judge;
use crate::post::plan::Plan;
use crate::program::{Diagnostic, Expansion, Program, ProgramLine, Severity, Tally};
use crate::snippet;

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
    placing: Placing,
    /// Report exactly what the control would refuse, also in titles and comments
    #[arg(long)]
    strict: bool,
    /// The control, in place of the job's: fanuc-16i, fanuc-0i, fanuc-31i; of a program alone a 16i
    #[arg(long, value_parser = ControlKind::named)]
    control: Option<ControlKind>,
    /// What differs on this machine, in place of the job's: offsets, lengths, switches (docs/dialect.md)
    #[arg(long, value_name = "SETTINGS.toml")]
    settings: Option<PathBuf>,
    /// How numbers without a decimal point count
    #[arg(long)]
    decimals: Option<Convention>,
    /// Folder of subprograms that are not in the program's file: O9010, O9010.nc or 9010.nc
    #[arg(long, value_name = "DIR")]
    library: Option<PathBuf>,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    json: bool,
}

/// What the program holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Lines of the file.
    pub lines: usize,
    /// Blocks: lines but `%` and empty ones.
    pub blocks: usize,
    /// Blocks of nothing but a comment or a title.
    pub comments: usize,
    /// Arcs, helices among them.
    pub arcs: usize,
    /// Arcs that also move across their plane.
    pub helices: usize,
    /// Straight cutting moves.
    pub linear: usize,
    /// Rapid moves.
    pub rapids: usize,
    /// Moves, of whatever kind, in which a rotary axis turns.
    pub rotary: usize,
}

#[derive(Serialize)]
struct CheckReport<'a> {
    program: String,
    control: &'a str,
    strict: bool,
    counts: Counts,
    errors: Vec<Entry<'a>>,
    warnings: Vec<Entry<'a>>,
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
            let bytes = std::fs::read(&path).map_err(|error| file_failure(&path, &error))?;
            if back::is_by_direction(&bytes) {
                return self.run_directions(&path, &bytes, &load_machine(machine)?);
            }
        }
        let (job, program, control) = self.read()?;
        let counts = count(&program);
        let errors = of_severity(&program, Severity::Error).count();
        // Nobody knows where the axes of a faulty program go.
        let on = self.machine.as_ref().filter(|_| errors == 0).map(|machine| load_machine(machine)).transpose()?;
        match (&on, self.json) {
            (None, true) => self.print_json(&program, counts, control),
            (Some(_), true) => {}
            (_, false) => self.print_text(&program, counts),
        }
        if errors > 0 {
            let path = program.path.display();
            return Err(Failure::Input(format!("{path}: {errors} errors: the control would stop")));
        }
        let contradictions = job.map_or(vec![], |file| spindle_contradictions(&file, &program));
        if !contradictions.is_empty() {
            return Err(Failure::Input(contradictions.join("\n")));
        }
        on.map_or(Ok(()), |file| self.run_program(&program, &file))
    }

    /// The program, read as its control would.
    fn read(&self) -> Result<(Option<JobFile>, Program, ControlKind), Failure> {
        let reading = if self.strict { Reading::Strict } else { Reading::Lenient };
        let job = self.is_job().then(|| JobFile::load(&self.program)).transpose()?;
        let path = job.as_ref().map_or(&self.program, |file| &file.program);
        let of_job = job.as_ref().map_or(ControlKind::Fanuc16i, |file| file.control);
        let control = self.control.unwrap_or(of_job);
        let file = self.settings.as_ref().or(job.as_ref().and_then(|file| file.settings.as_ref()));
        let (mut settings, tables) =
            control::load(control.preset(), reading, file.map(PathBuf::as_path)).map_err(Failure::Input)?;
        settings.scope = Scope::Everything;
        settings.decimals = self.decimals.map_or(settings.decimals, Into::into);
        settings.unit = job.as_ref().map_or(settings.unit, |file| file.job.unit);
        let bytes = std::fs::read(path).map_err(|error| file_failure(path, &error))?;
        let (library, keeps_moves) = (self.library.as_deref(), self.machine.is_some());
        let mut program = Program::run(path, &bytes, Expansion { settings, tables, library, keeps_moves });
        program.diagnostics.splice(0..0, program.lost_label());
        Ok((job, program, control))
    }

    /// The program itself, or that of the job.
    fn program_path(&self) -> Result<PathBuf, Failure> {
        Ok(if self.is_job() { JobFile::load(&self.program)?.program } else { self.program.clone() })
    }

    fn is_job(&self) -> bool {
        self.program.extension().is_some_and(|extension| extension == "toml")
    }

    /// CL data on a machine.
    fn run_cl(&self, file: &MachineFile) -> Result<(), Failure> {
        let is_of_program = self.strict || self.control.is_some() || self.settings.is_some();
        if is_of_program || self.decimals.is_some() || self.library.is_some() {
            let advice =
                "--strict, --control, --settings, --decimals and --library are for NC programs, not for CL data";
            return Err(Failure::Usage(advice.into()));
        }
        let cl = load_cl(&self.program)?;
        self.tell_points(&self.program, &cl, file, &Plan::new(&cl, &self.placing.task(file, None)))
    }

    /// A program with directions (G43.5), which no control here interprets: its points, for which the axes are chosen here.
    fn run_directions(&self, path: &Path, bytes: &[u8], file: &MachineFile) -> Result<(), Failure> {
        let read = back::read(bytes, &file.machine, &self.placing.setup(), Mode::Tcp);
        let cl = read.map_err(|error| Failure::Input(format!("{}:{error}", path.display())))?;
        let mut plan = Plan::new(&cl, &self.placing.task(file, None));
        // Such a control keeps the tool axis on its arc by itself.
        plan.findings.retain(|finding| !matches!(finding.what, What::Coarse { .. }));
        self.tell_points(path, &cl, file, &plan)
    }

    fn tell_points(&self, path: &Path, cl: &Cl, file: &MachineFile, plan: &Plan) -> Result<(), Failure> {
        let (points, passed_over) = (cl.points.len(), Some(cl.passed_over));
        self.tell(&Told { path, points, passed_over, machine: &file.name, plan })
    }

    /// A program that says itself where the rotary axes go.
    fn run_program(&self, program: &Program, file: &MachineFile) -> Result<(), Failure> {
        let (plan, points) = judge(program, &self.placing.task(file, None));
        self.tell(&Told { path: &program.path, points, passed_over: None, machine: &file.name, plan: &plan })
    }

    fn tell(&self, told: &Told<'_>) -> Result<(), Failure> {
        if self.json {
            told.print_json();
        } else {
            told.complain();
            say(format_args!("{}", told.summary()));
        }
        told.verdict()
    }

    fn print_text(&self, program: &Program, counts: Counts) {
        let path = program.path.display();
        for diagnostic in &program.diagnostics {
            let text = |is_terminal: bool| match program.lines.get(diagnostic.line - 1) {
                Some(line) if is_terminal => {
                    snippet::render(&self.program, &line.text, diagnostic, &Renderer::styled())
                }
                _ => format!("{path}:{diagnostic}"),
            };
            match diagnostic.severity {
                Severity::Error => eprintln!("{}", text(std::io::stderr().is_terminal())),
                Severity::Warning => say(format_args!("{}", text(std::io::stdout().is_terminal()))),
            }
        }
        let warnings = of_severity(program, Severity::Warning).count();
        let Counts { lines, blocks, comments, arcs, helices, linear, rapids, rotary } = counts;
        say(format_args!(
            "{path}: {lines} lines, {blocks} blocks ({comments} of them comments): {arcs} arcs ({helices} of them helices), \
             {linear} straight cutting moves, {rapids} rapids; a rotary axis turns in {rotary} of them; {warnings} warnings"
        ));
    }

    fn print_json(&self, program: &Program, counts: Counts, control: ControlKind) {
        let entries = |severity| of_severity(program, severity).map(Entry::new).collect();
        let report = CheckReport {
            program: program.path.display().to_string(),
            control: control.name(),
            strict: self.strict,
            counts,
            errors: entries(Severity::Error),
            warnings: entries(Severity::Warning),
        };
        say(format_args!("{}", serde_json::json!(report)));
    }
}

impl<'a> Entry<'a> {
    fn new(diagnostic: &'a Diagnostic) -> Self {
        let Diagnostic { line, column, end_column, alarm, message, found, .. } = diagnostic;
        Entry { line: *line, column: *column, end_column: *end_column, alarm: *alarm, message, found }
    }
}

fn of_severity(program: &Program, severity: Severity) -> impl Iterator<Item = &Diagnostic> {
    program.diagnostics.iter().filter(move |diagnostic| diagnostic.severity == severity)
}

fn count(program: &Program) -> Counts {
    let mut counts = Counts { lines: program.lines.len(), blocks: program.block_count(), ..Counts::default() };
    counts.comments = program.lines.iter().filter(|line| line.is_block() && is_comment(line)).count();
    let Tally { arcs, helices, linear, rapids, rotary } = program.moves;
    Counts { arcs, helices, linear, rapids, rotary, ..counts }
}

fn is_comment(line: &ProgramLine) -> bool {
    line.meaning.as_ref().is_some_and(|meaning| match meaning.parsed.line {
        Line::Block => meaning.parsed.block.is_empty() && meaning.parsed.block.program.is_none(),
        Line::Title => true,
        Line::ProgramMark => false,
    })
}
