//! `arcfeed init`: writes a first job file for a program.

use std::path::{Path, PathBuf};

use arcfeed_nc::block::Reading;
use arcfeed_units::{LengthUnit, Nm};
use serde::Serialize;

use super::control_args::ControlArgs;
use super::outcome::{Failure, file_failure, refuse_inputs, say};
use crate::console::note;
use crate::init::groups::{Group, group};
use crate::init::job_writer::{Findings, job};
use crate::init::proposal::{LikelyTool, Proposal, propose};
use crate::init::survey::{self, Survey};
use crate::init::wording;
use crate::job::ControlKind;
use crate::job::questions::{self, Question};
use crate::output;
use crate::program::{Program, Severity};

/// Write a first job file from a program: likely values from its arcs, and open questions in place of missing values
#[derive(Debug, clap::Args)]
pub struct Init {
    /// The NC program
    program: PathBuf,
    /// Write the job here; without it, beside the program under its name with .toml
    #[arg(short, long, value_name = "JOB.toml")]
    output: Option<PathBuf>,
    #[command(flatten)]
    of_control: ControlArgs,
    /// Write over a file that is there already
    #[arg(long)]
    force: bool,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct InitReport {
    program: String,
    job: String,
    unit: Option<&'static str>,
    spindle_speeds: Vec<i64>,
    tools: Vec<i64>,
    errors: usize,
    arcs: usize,
    lines: usize,
    groups: Vec<GroupFigures>,
    tool: ToolFigures,
    rules: usize,
    questions: Vec<QuestionFigures>,
}

#[derive(Serialize)]
struct GroupFigures {
    tool: Option<i64>,
    plane: &'static str,
    direction: &'static str,
    radius: f64,
    arcs: usize,
    helices: usize,
    n: Option<[i64; 2]>,
    line: [usize; 2],
    z: Vec<f64>,
    feeds: Vec<f64>,
    sweep_deg: [f64; 2],
}

#[derive(Serialize)]
struct ToolFigures {
    number: Option<i64>,
    kind: &'static str,
    outer_radius: Option<f64>,
    inner_radius: Option<f64>,
}

#[derive(Serialize)]
struct QuestionFigures {
    key: String,
    line: usize,
    column: usize,
}

impl Init {
    /// Runs the command.
    ///
    /// # Errors
    /// The program cannot be read, the job file is there already or cannot be written.
    pub fn run(&self) -> Result<(), Failure> {
        let (control, settings, tables) = self.of_control.read(None, Reading::Lenient)?;
        let (program, survey) = survey::load(&self.program, settings, tables).map_err(Failure::Input)?;
        let output = self.output.clone().unwrap_or_else(|| self.program.with_extension("toml"));
        let groups = group(&survey.arcs);
        let proposal = propose(&groups);
        let name = name_from(&output, &self.program);
        let control = self.control_keys(control, &output);
        let findings =
            Findings { program: &name, survey: &survey, groups: &groups, proposal: &proposal, control: &control };
        let text = job(&findings);
        self.write(&output, &text)?;
        let questions = questions::open(&text);
        let errors = program.diagnostics.iter().filter(|found| found.severity == Severity::Error).count();
        if errors > 0 {
            let path = program.path.display();
            note(format_args!(
                "{path}: {errors} errors, see `arcfeed check`: arcs behind them may be missing from the job"
            ));
        }
        if self.json {
            let report = report(&program, &output, (&survey, &groups, &proposal), (errors, &questions));
            say(format_args!("{}", serde_json::json!(report)));
        } else {
            print_text(&output, &findings, &questions);
        }
        Ok(())
    }

    /// Keys of the job's control.
    fn control_keys(&self, control: ControlKind, output: &Path) -> Vec<(&'static str, String)> {
        let mut keys = vec![("preset", control.name().to_owned())];
        keys.extend(self.of_control.decimals.map(|decimals| ("decimals", decimals.name().to_owned())));
        let settings = self.of_control.settings.as_ref();
        keys.extend(settings.map(|settings| ("settings", name_from(output, settings))));
        keys
    }

    fn write(&self, output: &Path, text: &str) -> Result<(), Failure> {
        refuse_inputs(&[Some(output)], std::slice::from_ref(&self.program))?;
        let write = if self.force { output::write_whole } else { output::write_new };
        match write(output, text.as_bytes()) {
            Ok(()) => Ok(()),
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {
                Err(Failure::Input(format!("{}: exists already; --force writes over it", output.display())))
            }
            Err(error) => Err(file_failure(output, &error)),
        }
    }
}

/// A file's name as seen from the job file: jobs name files relative to themselves.
fn name_from(job: &Path, program: &Path) -> String {
    let folder = |path: &Path| std::path::absolute(path).ok().and_then(|path| path.parent().map(Path::to_owned));
    let name = match program.file_name() {
        Some(name) if folder(job) == folder(program) => PathBuf::from(name),
        _ => std::path::absolute(program).unwrap_or_else(|_| program.to_owned()),
    };
    name.display().to_string()
}

fn print_text(output: &Path, findings: &Findings<'_>, questions: &[Question]) {
    let Findings { survey, groups, proposal, .. } = findings;
    let unit = survey.unit.unwrap_or(LengthUnit::Inch);
    for group in *groups {
        say(format_args!("{}", wording::group(group, unit)));
    }
    let likely = match proposal.tool {
        LikelyTool::CupMill { outer_mm, inner_mm } => {
            let [outer, inner] = [outer_mm, inner_mm].map(|mm| wording::length(mm, unit));
            format!("a cup mill, outer radius {outer}, inner radius {inner} {}", unit.label())
        }
        LikelyTool::EndMill => "an end mill".into(),
    };
    let (arcs, rules) = (survey.arcs.len(), proposal.cuts.len());
    say(format_args!("{arcs} arcs; likely {likely}; {rules} cut rules. Open questions in {}:", output.display()));
    for Question { key, place: [line, column], .. } in questions {
        say(format_args!("  {}:{line}:{column}: {key}", output.display()));
    }
}

fn report(
    program: &Program,
    output: &Path,
    (survey, groups, proposal): (&Survey, &[Group], &Proposal),
    (errors, questions): (usize, &[Question]),
) -> InitReport {
    let unit = survey.unit.unwrap_or(LengthUnit::Inch);
    let radii = match proposal.tool {
        LikelyTool::CupMill { outer_mm, inner_mm } => Some([outer_mm, inner_mm].map(|mm| mm / unit.mm())),
        LikelyTool::EndMill => None,
    };
    InitReport {
        program: program.path.display().to_string(),
        job: output.display().to_string(),
        unit: survey.unit.map(LengthUnit::label),
        spindle_speeds: survey.speeds.clone(),
        tools: survey.tools.clone(),
        errors,
        arcs: survey.arcs.len(),
        lines: survey.lines,
        groups: groups.iter().map(|group| GroupFigures::new(group, unit)).collect(),
        tool: ToolFigures {
            number: proposal.number,
            kind: if radii.is_some() { "cup-mill" } else { "end-mill" },
            outer_radius: radii.map(|[outer, _]| outer),
            inner_radius: radii.map(|[_, inner]| inner),
        },
        rules: proposal.cuts.len(),
        questions: questions.iter().map(QuestionFigures::new).collect(),
    }
}

impl GroupFigures {
    fn new(group: &Group, unit: LengthUnit) -> Self {
        let in_unit = |values: &[Nm]| values.iter().map(|value| value.0 as f64 / unit.nm() as f64).collect();
        GroupFigures {
            tool: group.tool,
            plane: wording::plane(group.plane),
            direction: wording::direction(group.turn),
            radius: group.radius_mm / unit.mm(),
            arcs: group.arcs,
            helices: group.helices,
            n: group.sequence,
            line: group.lines,
            z: in_unit(&group.levels),
            feeds: in_unit(&group.feeds),
            sweep_deg: group.sweep_rad.map(f64::to_degrees),
        }
    }
}

impl QuestionFigures {
    fn new(question: &Question) -> Self {
        let [line, column] = question.place;
        QuestionFigures { key: question.key.clone(), line, column }
    }
}
