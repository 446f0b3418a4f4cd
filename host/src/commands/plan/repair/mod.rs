//! `arcfeed plan repair`: reads points measured on a repaired blade, plans what finishing leaves, prints the figures and writes the files.

mod result;

mod figures;

mod page;

mod files;

use super::super::outcome::{Failure, say};
use super::Repair;
use crate::console::note;
use crate::part::repair::RepairFile;
use result::RepairResult;

impl Repair {
    /// Runs the command.
    ///
    /// # Errors
    /// See [`super::PlanCommand::run`].
    pub fn run(&self) -> Result<(), Failure> {
        let file = RepairFile::load(&self.repair)?;
        note(format_args!("laying {} points on the nominal blade", file.points.len()));
        let mut inputs = file.inputs.clone();
        inputs.push(self.repair.clone());
        let place = self.repair.display();
        let result = RepairResult::of(file).map_err(|why| Failure::Input(format!("{place}: {why}")))?;
        let figures = figures::RepairFigures::of(&result);
        if self.json {
            say(format_args!("{}", serde_json::to_string(&figures).unwrap_or_default()));
        } else {
            say(format_args!("{}", figures::text(&figures).trim_end()));
        }
        match &self.output {
            Some(folder) => files::write(&result, &figures, folder, &inputs),
            None => Ok(()),
        }
    }
}
