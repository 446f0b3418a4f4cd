//! `arcfeed init`: writes a first job file for a program.

use std::path::{Path, PathBuf};

use arcfeed_nc::block::Reading;
use arcfeed_units::{LengthUnit, Nm};
use serde::Serialize;

use super::control_args::{ControlReading, name_from};
use super::job_values::JobValues;
use super::outcome::{Failure, file_failure, json_text, refuse_inputs, say};
use crate::console::note;
use crate::init::findings::Findings;
use crate::init::groups::{Group, group};
use crate::init::job_writer::job;
use crate::init::proposal::{LikelyTool, ProposedTool, propose};
use crate::init::survey;
use crate::init::wording;
use crate::job::questions::{self, Question};
use crate::output;
use crate::plural::counted;
use crate::program::{Program, Severity};

/// Most radii that are shown to a person.
const GROUPS_SHOWN: usize = 20;

/// Write a first job file from a program: likely values from its arcs, and open questions in place of missing values
#[derive(Debug, clap::Args)]
pub struct Init {
    /// The NC program
    program: PathBuf,
    /// Write the job here; without it, beside the program under its name with .toml
    #[arg(short, long, value_name = "JOB.toml")]
    output: Option<PathBuf>,
    /// Write over a file that is there already
    #[arg(long)]
    force: bool,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    values: JobValues,
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
    /// Lowest and highest X, Y and Z of the cutting moves.
    extents: [Option<[f64; 2]>; 3],
    groups: Vec<GroupFigures>,
    proposed: Vec<ToolFigures>,
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
    diameter: Option<f64>,
    teeth: Option<u16>,
    comment_line: Option<usize>,
    rules: usize,
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
        let ControlReading { control, settings, tables, unit } = self.values.of_control.read(None, Reading::Lenient)?;
        let answers = self.values.answers(unit);
        let loaded = survey::load(&self.program, (settings, tables), unit, self.values.library.as_deref());
        let (program, survey) = loaded.map_err(Failure::Input)?;
        survey.check_max(&self.program, answers.max_percent).map_err(Failure::Usage)?;
        let output = self.output.clone().unwrap_or_else(|| self.program.with_extension("toml"));
        let groups = group(&survey.arcs);
        let proposal = propose(&groups, &survey, &answers);
        let name = name_from(&output, &self.program);
        let control = self.values.control_keys(control, &output);
        let findings = Findings {
            program: &name,
            survey: &survey,
            groups: &groups,
            proposal: &proposal,
            answers: &answers,
            control: &control,
        };
        let text = job(&findings);
        self.write(&output, &text)?;
        let questions = questions::open(&text);
        let mut found = program.diagnostics.iter().filter(|found| found.severity == Severity::Error);
        let errors = found.clone().count();
        if let Some(first) = found.next() {
            // Some values that `check` assumes are refused here, so its errors may be fewer.
            let path = program.path.display();
            let more = if errors > 1 { format!("; and {}", counted(errors - 1, "more error")) } else { String::new() };
            note(format_args!("{path}:{first}{more}: arcs behind them may be missing from the job"));
        }
        let tools = proposal.tools.iter().filter(|tool| !tool.cuts.is_empty());
        tools.filter_map(|tool| findings.doubtful_diameter(tool)).for_each(|found| note(format_args!("{found}")));
        wording::unknown_radius(&self.program, &survey).iter().for_each(|found| note(format_args!("{found}")));
        if self.json {
            let report = report(&program, &output, &findings, (errors, &questions));
            say(format_args!("{}", json_text(&report)));
        } else {
            print_text(&output, &findings, &questions);
        }
        Ok(())
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

fn print_text(output: &Path, findings: &Findings<'_>, questions: &[Question]) {
    let Findings { survey, groups, proposal, .. } = findings;
    let unit = findings.unit();
    for group in groups.iter().take(GROUPS_SHOWN) {
        say(format_args!("{}", wording::group(group, unit)));
    }
    if groups.len() > GROUPS_SHOWN {
        say(format_args!("  and {} radii more", groups.len() - GROUPS_SHOWN));
    }
    // Without any mill the job has a tool that governs nothing.
    let mut mills = proposal.tools.iter().filter(|tool| !tool.cuts.is_empty()).peekable();
    if mills.peek().is_none() {
        say(format_args!("{}", wording::NO_ARCS));
    }
    mills.for_each(|tool| {
        say(format_args!("{}", words(tool, findings)));
        findings.milling_hint(tool).iter().for_each(|hint| say(format_args!("{hint}")));
    });
    proposal.excluded.iter().for_each(|tool| say(format_args!("{}", wording::exclusion(tool))));
    let arcs = counted(survey.arcs.len(), "arc");
    if questions.is_empty() {
        say(format_args!("{arcs}; {} has no open question", output.display()));
        return;
    }
    say(format_args!("{arcs}. Open questions in {}:", output.display()));
    for Question { key, place: [line, column], .. } in questions {
        say(format_args!("  {}:{line}:{column}: {key}", output.display()));
    }
}

/// A tool for a person.
fn words(tool: &ProposedTool, findings: &Findings<'_>) -> String {
    let unit = findings.unit();
    let number = tool.number.map_or("the tool".into(), |number| format!("T{number}"));
    let kind = match tool.kind {
        LikelyTool::CupMill { outer_mm, inner_mm } => {
            let [outer, inner] = [outer_mm, inner_mm].map(|mm| wording::length(mm, unit));
            format!("a cup mill, outer radius {outer}, inner radius {inner} {}", unit.label())
        }
        LikelyTool::EndMill => match findings.diameter_mm(tool) {
            Some(mm) => format!("an end mill, diameter {} {}", wording::length(mm, unit), unit.label()),
            None => "an end mill".into(),
        },
    };
    format!("{number}: likely {kind}; {}", counted(tool.cuts.len(), "cut rule"))
}

fn report(
    program: &Program,
    output: &Path,
    findings: &Findings<'_>,
    (errors, questions): (usize, &[Question]),
) -> InitReport {
    let Findings { survey, groups, proposal, .. } = *findings;
    InitReport {
        program: program.path.display().to_string(),
        job: output.display().to_string(),
        unit: survey.unit.map(LengthUnit::label),
        spindle_speeds: survey.speeds.clone(),
        tools: survey.tools.clone(),
        errors,
        arcs: survey.arcs.len(),
        lines: survey.lines,
        extents: survey.extents_mm.map(|extent| extent.map(|ends| ends.map(|mm| mm / findings.unit().mm()))),
        groups: groups.iter().map(|group| GroupFigures::new(group, findings.unit())).collect(),
        proposed: proposal.tools.iter().map(|tool| ToolFigures::new(tool, findings)).collect(),
        questions: questions.iter().map(QuestionFigures::new).collect(),
    }
}

impl ToolFigures {
    fn new(tool: &ProposedTool, findings: &Findings<'_>) -> Self {
        let in_unit = |mm: f64| mm / findings.unit().mm();
        let radii = match tool.kind {
            LikelyTool::CupMill { outer_mm, inner_mm } => Some([outer_mm, inner_mm].map(in_unit)),
            LikelyTool::EndMill => None,
        };
        ToolFigures {
            number: tool.number,
            kind: if radii.is_some() { "cup-mill" } else { "end-mill" },
            outer_radius: radii.map(|[outer, _]| outer),
            inner_radius: radii.map(|[_, inner]| inner),
            diameter: findings.diameter_mm(tool).map(in_unit),
            teeth: findings.teeth(tool),
            comment_line: tool.note.as_ref().map(|note| note.line),
            rules: tool.cuts.len(),
        }
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
