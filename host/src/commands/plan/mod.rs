//! `arcfeed plan`: from the blades of a rotor to an NC program, its job, and the proof that the tool collides with
//! nothing.

#[cfg(feature = "plan")]
mod refusal;

#[cfg(feature = "plan")]
mod plan_result;

#[cfg(feature = "plan")]
mod slot_frame;

#[cfg(feature = "plan")]
mod figures;

#[cfg(feature = "plan")]
mod widths;

#[cfg(feature = "plan")]
mod page;

#[cfg(feature = "plan")]
mod planned_path;

#[cfg(feature = "plan")]
mod viewer;

#[cfg(feature = "plan")]
mod earlier_stock;

#[cfg(feature = "plan")]
mod files;

#[cfg(feature = "plan")]
mod run;

#[cfg(feature = "plan")]
mod plunge;

#[cfg(feature = "plan")]
mod finish;

#[cfg(feature = "plan")]
mod repair;

use std::path::PathBuf;

use super::outcome::Failure;

/// Plan tool paths from geometry: NC program, job, stock and report
///
/// Exit code 1 if there is no plan, or if the tool would collide with something; nothing is written then.
#[derive(Debug, clap::Args)]
pub struct PlanCommand {
    #[command(subcommand)]
    method: Method,
}

#[derive(Debug, clap::Subcommand)]
enum Method {
    CupMill(CupMill),
    Plunge(Plunge),
    Finish(Finish),
    Repair(Repair),
}

/// Rough the slots of a bladed rotor with a cup mill (docs/plan.md)
#[derive(Debug, clap::Args)]
struct CupMill {
    /// The part file
    part: PathBuf,
    /// Folder for the NC program, job.toml with its engagement map, stock.stl, finished.stl and report.html; created if it does not exist
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Plan and prove other rings, by width and middle radius, and mark the one that removes most
    #[arg(long, conflicts_with = "output")]
    widths: bool,
    /// Make the whole blank the job's workpiece, not the part of it about one slot: `simulate` then cuts all slots, which takes minutes
    #[arg(long, requires = "output")]
    wheel: bool,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    json: bool,
}

/// Bore out the passages of a bladed rotor by plunging (docs/plunge.md)
#[derive(Debug, clap::Args)]
struct Plunge {
    /// The part file
    part: PathBuf,
    /// Folder for the NC program, plunges.apt, job.toml, stock.stl, finished.stl and report.html; created if it does not exist
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    json: bool,
}

/// Finish the blades of a rotor in five axes (docs/finish.md)
#[derive(Debug, clap::Args)]
struct Finish {
    /// The part file
    part: PathBuf,
    /// Folder for the NC program, finish.apt, job.toml, axes.svg and report.html; created if it does not exist
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    json: bool,
}

/// Plan the milling of a repaired blade from measured points to the NC program (docs/repair.md)
#[derive(Debug, clap::Args)]
struct Repair {
    /// The repair file
    repair: PathBuf,
    /// Folder for the NC program, repair.apt, job.toml, stock.stl, finished.stl, allowance.csv, contacts.csv and report.html; created if it does not exist
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    json: bool,
}

impl PlanCommand {
    /// Runs the command.
    ///
    /// # Errors
    /// The part file is at fault, there is no plan, or a file cannot be written.
    pub fn run(&self) -> Result<(), Failure> {
        match &self.method {
            Method::CupMill(method) => method.run(),
            Method::Plunge(method) => method.run(),
            Method::Finish(method) => method.run(),
            Method::Repair(method) => method.run(),
        }
    }
}

#[cfg(not(feature = "plan"))]
impl Finish {
    fn run(&self) -> Result<(), Failure> {
        Err(Failure::Usage(crate::features::not_built_in("the planner", "plan")))
    }
}

#[cfg(not(feature = "plan"))]
impl Plunge {
    fn run(&self) -> Result<(), Failure> {
        Err(Failure::Usage(crate::features::not_built_in("the planner", "plan")))
    }
}

#[cfg(not(feature = "plan"))]
impl CupMill {
    fn run(&self) -> Result<(), Failure> {
        Err(Failure::Usage(crate::features::not_built_in("the planner", "plan")))
    }
}

#[cfg(not(feature = "plan"))]
impl Repair {
    fn run(&self) -> Result<(), Failure> {
        Err(Failure::Usage(crate::features::not_built_in("the planner", "plan")))
    }
}
