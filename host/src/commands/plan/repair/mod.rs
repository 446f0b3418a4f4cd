//! `arcfeed plan repair`: reads points measured on a repaired blade, plans what finishing leaves, prints the figures and writes the files.

mod result;

mod figures;

mod viewer;

mod page;

mod files;

use super::super::outcome::{Failure, say};
use super::Repair;
use super::refusal::set_aside;
use crate::console::note;
use crate::part::MachineSource;
use crate::part::repair::RepairFile;
use result::RepairResult;

impl Repair {
    /// Runs the command.
    ///
    /// # Errors
    /// See [`super::PlanCommand::run`].
    pub fn run(&self) -> Result<(), Failure> {
        let ran = self.planned();
        if let (Err(Failure::Input(_)), Some(folder)) = (&ran, &self.output) {
            set_aside(folder, 1);
        }
        ran
    }

    fn planned(&self) -> Result<(), Failure> {
        let file = RepairFile::load(&self.repair)?;
        note(format_args!("laying {} points on the nominal blade", file.points.len()));
        let mut inputs = file.inputs.clone();
        inputs.push(self.repair.clone());
        if let Some(MachineSource::File(machine)) = &file.part.machine_source {
            inputs.push(machine.clone());
        }
        let place = self.repair.display();
        let result = RepairResult::of(file).map_err(|why| Failure::Input(format!("{place}: {why}")))?;
        let figures = figures::RepairFigures::of(&result);
        if self.json {
            say(format_args!("{}", serde_json::to_string(&figures).unwrap_or_default()));
        } else {
            say(format_args!("{}", figures::text(&figures).trim_end()));
        }
        if let Some(refusal) = result.path.refusal() {
            return Err(Failure::Input(format!("{place}: {refusal}; nothing is written")));
        }
        match &self.output {
            Some(folder) => files::write(&result, &figures, folder, &inputs),
            None => Ok(()),
        }
    }
}
