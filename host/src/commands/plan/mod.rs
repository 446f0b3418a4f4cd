//! `arcfeed plan`: from the blades of a rotor to an NC program, its job, and the proof that nothing is touched.

mod composed;

mod told;

mod drawn;

mod written;

use std::path::PathBuf;

use super::outcome::{Failure, say};
use crate::part::{MachineTold, Part};
use composed::Composed;

/// Plan tool paths from geometry: NC program, job, stock and report
///
/// Exit code 1 where there is no plan, or where the tool would touch what it must not; nothing is written then.
#[derive(Debug, clap::Args)]
pub struct Plan {
    #[command(subcommand)]
    method: Method,
}

#[derive(Debug, clap::Subcommand)]
enum Method {
    CupMill(CupMill),
}

/// Rough the slots of a bladed rotor with a cup mill (docs/plan.md)
#[derive(Debug, clap::Args)]
struct CupMill {
    /// The part file
    part: PathBuf,
    /// Folder for the NC program, job.toml, stock.stl, finished.stl and report.html; made if it is not there
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Try other widths of the ring about the same middle, and print which takes most
    #[arg(long, conflicts_with = "output")]
    widths: bool,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    json: bool,
}

impl Plan {
    /// Runs the command.
    ///
    /// # Errors
    /// The part file is at fault, there is no plan, or a file cannot be written.
    pub fn run(&self) -> Result<(), Failure> {
        let Method::CupMill(method) = &self.method;
        method.run()
    }
}

impl CupMill {
    fn run(&self) -> Result<(), Failure> {
        let part = Part::load(&self.part)?;
        let composed = Composed::of(part).map_err(|why| Failure::Input(format!("{}: {why}", self.part.display())))?;
        if self.widths {
            return told::widths(&composed, self.json);
        }
        let figures = told::Figures::of(&composed);
        if self.json {
            say(format_args!("{}", serde_json::to_string(&figures).unwrap_or_default()));
        } else {
            say(format_args!("{}", told::text(&composed, &figures)));
        }
        if !composed.is_safe() {
            return Err(Failure::Input(format!("{}: {}", self.part.display(), told::refusal(&composed))));
        }
        match &self.output {
            Some(folder) => {
                let mut inputs = vec![self.part.clone()];
                if let Some(MachineTold::File(file)) = &composed.part.machine_told {
                    inputs.push(file.clone());
                }
                written::write(&composed, folder, &inputs)
            }
            None => Ok(()),
        }
    }
}
