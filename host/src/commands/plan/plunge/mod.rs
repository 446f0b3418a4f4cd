//! `arcfeed plan plunge`: reads the part, plans and proves, prints the figures and writes the files.

mod result;

mod figures;

mod comparison;

mod plot;

mod viewer;

mod page;

mod files;

use super::super::outcome::{Failure, say};
use super::Plunge;
use crate::part::MachineSource;
use crate::part::plunge::PlungePart;
use result::PlungeResult;

impl Plunge {
    /// Runs the command.
    ///
    /// # Errors
    /// See [`super::PlanCommand::run`].
    pub fn run(&self) -> Result<(), Failure> {
        let part = PlungePart::load(&self.part)?;
        let place = self.part.display();
        let result = PlungeResult::of(part).map_err(|why| Failure::Input(format!("{place}: {why}")))?;
        let figures = figures::PlungeFigures::of(&result);
        if self.json {
            say(format_args!("{}", serde_json::to_string(&figures).unwrap_or_default()));
        } else {
            say(format_args!("{}", figures::text(&figures)));
        }
        if !result.proof.holds() {
            return Err(Failure::Input(format!("{place}: {}", figures::refusal(&result))));
        }
        match &self.output {
            Some(folder) => {
                let mut inputs = vec![self.part.clone()];
                if let Some(MachineSource::File(file)) = &result.part.machine_source {
                    inputs.push(file.clone());
                }
                files::write(&result, &figures, folder, &inputs)
            }
            None => Ok(()),
        }
    }
}
