//! `arcfeed post`: CL data to a machine's program, and back.

use std::path::{Path, PathBuf};

use arcfeed_kinematics::deviation::Mode;
use arcfeed_kinematics::linearise::Tolerance;

use super::five_axis::{PathReport, PlacementArgs, load_cl, load_machine, tool_end};
use super::outcome::{Failure, refuse_inputs, say, write_whole};
use crate::console::note;
use crate::machine_file::MachineFile;
use crate::post::nc::Style;
use crate::post::plan::AxisPlan;
use crate::post::{cl_from_nc, nc};
use crate::program::{Severity, read_bounded};

/// Turn APT CL data (GOTO/x,y,z,i,j,k) into NC for a five-axis machine, or back
///
/// A path that the machine cannot follow is rejected: directions out of reach, axes beyond their ranges, and, except in
/// the mode `machine`, changes of branch. All findings go to stderr, the program to stdout or to the file of -o.
#[derive(Debug, clap::Args)]
pub struct Post {
    /// CL data; with --reverse an NC program
    input: PathBuf,
    /// The machine: a file, or the name of a preset (docs/kinematics.md)
    #[arg(long, value_name = "MACHINE.toml")]
    machine: PathBuf,
    /// Mode of the program: the axes are computed by the control (tcp: G43.5 with I J K), by the post-processor except
    /// for the tip in the part's frame (part-rotary: G43.4), or all by the post-processor (machine)
    #[arg(long, value_enum, default_value_t = ModeWord::PartRotary)]
    mode: ModeWord,
    /// File of the program; stdout by default
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// From NC of this mode to CL data
    #[arg(long)]
    reverse: bool,
    #[command(flatten)]
    placement: PlacementArgs,
    /// Largest distance of the tip from its straight line between two blocks, mm
    #[arg(long, value_name = "MM", default_value_t = 0.01)]
    tolerance: f64,
    /// Largest angle of the tool axis from its arc between two blocks, degrees
    #[arg(long, value_name = "DEG", default_value_t = 0.1)]
    axis_tolerance: f64,
    /// Repair incoherent movement beside a pole by turning the tool axis a little
    #[arg(long, conflicts_with = "reverse")]
    repair: bool,
    /// The tool is a ball end mill of this radius, mm: its centre stays where it is, whatever the repair turns
    #[arg(long, value_name = "MM", requires = "repair")]
    ball_radius: Option<f64>,
    /// With -o: print one JSON object with the findings (docs/json.md)
    #[arg(long, requires = "output", conflicts_with = "reverse")]
    json: bool,
}

/// Mode of the program: where the axes are computed.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum ModeWord {
    Tcp,
    PartRotary,
    Machine,
}

impl From<ModeWord> for Mode {
    fn from(word: ModeWord) -> Self {
        match word {
            ModeWord::Tcp => Mode::Tcp,
            ModeWord::PartRotary => Mode::PartRotary,
            ModeWord::Machine => Mode::Machine,
        }
    }
}

impl Post {
    /// Runs the command.
    ///
    /// # Errors
    /// A file is at fault, or the machine cannot follow the path.
    pub fn run(&self) -> Result<(), Failure> {
        if !(self.tolerance > 0.0 && self.axis_tolerance > 0.0 && self.ball_radius.is_none_or(|radius| radius > 0.0)) {
            return Err(Failure::Usage("tolerances and the ball's radius must be above zero".into()));
        }
        let file = load_machine(&self.machine)?;
        refuse_inputs(&[self.output.as_deref()], &[self.input.clone(), PathBuf::from(&self.machine)])?;
        if self.reverse { self.back(&file) } else { self.forth(&file) }
    }

    fn forth(&self, file: &MachineFile) -> Result<(), Failure> {
        let cl = load_cl(&self.input)?;
        let task = self.placement.task(file, tool_end(self.repair, self.ball_radius));
        let plan = AxisPlan::new(&cl, &task);
        let (points, passed_over) = (cl.points.len(), Some(cl.passed_over));
        let path_report = PathReport { path: &self.input, points, passed_over, machine: &file.name, plan: &plan };
        path_report.print_findings();
        if self.json {
            path_report.print_json();
        }
        let leaves_part = matches!(self.mode, ModeWord::Machine);
        let errors = plan.findings.iter().filter(|finding| finding.severity() == Severity::Error).count();
        if errors > if leaves_part { plan.changes().count() } else { 0 } {
            return path_report.verdict();
        }
        let tolerance = Tolerance { tip_mm: self.tolerance, axis_deg: self.axis_tolerance };
        let style = Style { name: &file.name, mode: self.mode.into(), tolerance, start: None };
        let written = nc::write(&cl, &plan, &task, &style);
        let (text, blocks) = written.map_err(|error| Failure::Input(format!("{}:{error}", self.input.display())))?;
        note(format_args!("{}; {blocks} blocks", path_report.summary()));
        put(self.output.as_deref(), &text)
    }

    fn back(&self, file: &MachineFile) -> Result<(), Failure> {
        let bytes = read_bounded(&self.input).map_err(Failure::Input)?;
        let read = cl_from_nc::read(&bytes, &file.machine, &self.placement.setup(), self.mode.into());
        let cl = read.map_err(|error| Failure::Input(format!("{}:{error}", self.input.display())))?;
        put(self.output.as_deref(), &cl.write())
    }
}

/// Writes to a file, or to stdout.
fn put(output: Option<&Path>, text: &str) -> Result<(), Failure> {
    match output {
        Some(path) => write_whole(path, text.as_bytes()),
        None => {
            say(format_args!("{}", text.trim_end_matches('\n')));
            Ok(())
        }
    }
}
