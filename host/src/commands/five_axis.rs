//! Common parts of `post` and `check --machine`: machine, placement of part and tool, and report of the findings.

use std::path::Path;

use arcfeed_kinematics::branch_selection::{Branch, PathStart};
use arcfeed_kinematics::forward::Setup;
use arcfeed_kinematics::singularity::{RepairLimits, ToolEnd};
use serde::Serialize;

use super::outcome::{Failure, json_text, say};
use crate::console::note;
use crate::machine_file::MachineFile;
use crate::plural::counted;
use crate::post::cl::Cl;
use crate::post::finding::Entry;
use crate::post::plan::{AxisPlan, Task};
use crate::program::{Severity, read_bounded};

/// Options for the placement of part and tool on the machine.
#[derive(Clone, Debug, clap::Args)]
pub struct PlacementArgs {
    /// The part's zero point in the machine frame with all axes at zero, X,Y,Z in mm; under G43.4 beyond the work offset
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", value_parser = point, allow_hyphen_values = true, requires = "machine")]
    part_zero: Point,
    /// Length from the gauge line to the tool's tip, mm; under G43.4 in addition to that of H
    #[arg(long, value_name = "MM", default_value_t = 0.0, requires = "machine")]
    tool_length: f64,
    /// Distance from the part during a change of branch, mm
    #[arg(long, value_name = "MM", default_value_t = 50.0, requires = "machine")]
    retract: f64,
    /// Positions of the rotary axes before the path, the one nearer to the part first, degrees: the path begins on the branch and in the turn
    /// that follow with the least travel
    #[arg(long, value_name = "DEG,DEG", value_parser = start, allow_hyphen_values = true, requires = "machine")]
    start: Option<Start>,
    /// Branch at the beginning: the side of the second rotary axis, seen from its position at the pole (of an A/C table the sign of A)
    #[arg(long, value_enum, requires = "machine")]
    branch: Option<BranchWord>,
}

/// Positions of both rotary axes.
#[derive(Clone, Copy, Debug)]
struct Start([f64; 2]);

/// Branch of the rotary axes.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum BranchWord {
    Positive,
    Negative,
}

impl From<BranchWord> for Branch {
    fn from(word: BranchWord) -> Self {
        match word {
            BranchWord::Positive => Branch::Positive,
            BranchWord::Negative => Branch::Negative,
        }
    }
}

/// Three coordinates given by a command-line option, `X,Y,Z`.
#[derive(Clone, Copy, Debug)]
pub struct Point([f64; 3]);

/// Findings as JSON.
#[derive(Serialize)]
struct Report<'a> {
    cl: String,
    machine: &'a str,
    points: usize,
    rotary_travel_deg: Option<[f64; 2]>,
    rotary_travel_repaired_deg: Option<[f64; 2]>,
    findings: Vec<Entry>,
}

impl PlacementArgs {
    /// Placement of part and tool on the machine, from the options.
    pub fn setup(&self) -> Setup {
        Setup { part_zero_mm: self.part_zero.0, tool_length_mm: self.tool_length }
    }

    /// Task of choosing the axis positions for this machine; `repair` is the cutting end of the tool if singularities are to be repaired.
    pub fn task(&self, file: &MachineFile, repair: Option<ToolEnd>) -> Task {
        let limits = RepairLimits::default();
        let branch = self.branch.map(Branch::from);
        let start = PathStart { rotary_deg: self.start.map(|start| start.0), branch };
        Task { machine: file.machine, setup: self.setup(), repair, start, limits, retract_mm: self.retract }
    }
}

/// Loads a machine, by its file or as a preset.
///
/// # Errors
/// It cannot be read, or describes no machine.
pub fn load_machine(path: &Path) -> Result<MachineFile, Failure> {
    MachineFile::named(path).map_err(Failure::Input)
}

/// Loads CL data from a file.
///
/// # Errors
/// They cannot be read.
pub fn load_cl(path: &Path) -> Result<Cl, Failure> {
    let bytes = read_bounded(path).map_err(Failure::Input)?;
    Cl::read(&String::from_utf8_lossy(&bytes)).map_err(|error| Failure::Input(format!("{}:{error}", path.display())))
}

/// Path on a five-axis machine with the errors and warnings found in it, for printing.
#[derive(Clone, Copy, Debug)]
pub struct PathReport<'a> {
    /// File of the CL data or of the program.
    pub path: &'a Path,
    /// Number of CL points, or of moves of the program.
    pub points: usize,
    /// Number of statements of the CL data that do not move the tool and were ignored; `None` for programs.
    pub passed_over: Option<usize>,
    /// Name of the machine.
    pub machine: &'a str,
    /// Axis positions, with the errors and warnings.
    pub plan: &'a AxisPlan,
}

impl PathReport<'_> {
    /// Prints the report on stdout.
    pub fn print_json(&self) {
        let travel = |of: [f64; 2]| self.is_reached().then_some(of);
        let [before, after] = self.plan.travel_deg;
        let report = Report {
            cl: self.path.display().to_string(),
            machine: self.machine,
            points: self.points,
            rotary_travel_deg: travel(before),
            rotary_travel_repaired_deg: travel(after),
            findings: self.plan.findings.iter().map(|finding| finding.entry()).collect(),
        };
        say(format_args!("{}", json_text(&report)));
    }

    /// Prints all findings on stderr.
    pub fn print_findings(&self) {
        for finding in &self.plan.findings {
            note(format_args!("{}:{finding}", self.path.display()));
        }
    }

    /// Summary of the path in one line.
    pub fn summary(&self) -> String {
        let PathReport { path, points, machine, plan, .. } = self;
        let [[before_0, before_1], [after_0, after_1]] = plan.travel_deg;
        let path = path.display();
        if !self.is_reached() {
            return format!("{path}: {points} points; {machine} does not reach all of them");
        }
        let counted = match self.passed_over {
            Some(words) => format!("{points} points on {machine}, {words} other words passed over"),
            None => format!("{} on {machine}", counted(*points, "move")),
        };
        let repaired = if plan.travel_deg[0] == plan.travel_deg[1] {
            String::new()
        } else {
            format!(", before the repair {before_0:.3} and {before_1:.3}")
        };
        format!(
            "{path}: {counted}; the rotary axes turn {after_0:.3} and {after_1:.3} degrees{repaired}; {} findings",
            plan.findings.len()
        )
    }

    /// There are axis positions for every point; a program gives them itself.
    fn is_reached(&self) -> bool {
        !self.plan.stops.is_empty() || self.passed_over.is_none()
    }

    /// Fails if the path has errors, so that the program must not run.
    ///
    /// # Errors
    /// There are errors; the message gives their number.
    pub fn verdict(&self) -> Result<(), Failure> {
        let errors = self.plan.findings.iter().filter(|finding| finding.severity() == Severity::Error).count();
        if errors == 0 {
            return Ok(());
        }
        Err(Failure::Input(format!(
            "{}: {errors} errors: not to be run on {} as it is",
            self.path.display(),
            self.machine
        )))
    }
}

/// Cutting end of the tool if a repair is requested: a ball of this radius, or without a radius any other end. Otherwise `None`.
pub fn tool_end(repair: bool, ball_radius: Option<f64>) -> Option<ToolEnd> {
    let ball = ball_radius.map(|radius_mm| ToolEnd::Ball { radius_mm });
    repair.then(|| ball.unwrap_or(ToolEnd::Other))
}

/// Whether the name of the file has the ending of CL data.
pub fn is_cl(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
    matches!(extension.as_deref(), Some("apt" | "cl" | "cls" | "aptsource"))
}

fn start(text: &str) -> Result<Start, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    match numbers.as_deref() {
        Ok([first, second]) if first.is_finite() && second.is_finite() => Ok(Start([*first, *second])),
        _ => Err("write two positions in degrees: 378.4,1.5".into()),
    }
}

fn point(text: &str) -> Result<Point, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    match numbers.as_deref() {
        Ok([x, y, z]) if [x, y, z].iter().all(|number| number.is_finite()) => Ok(Point([*x, *y, *z])),
        _ => Err("write X,Y,Z in mm: 0,0,120.5".into()),
    }
}
