//! `arcfeed plan finish`: reads the part, plans and proves, prints the figures and writes the files.

pub mod result;

pub mod figures;

pub mod viewer;

pub mod page;

pub mod files;

use super::super::outcome::{Failure, say};
use super::Finish;
use super::refusal::set_aside;
use crate::console::note;
use crate::part::MachineSource;
use crate::part::finish::FinishPart;
use result::FinishResult;

impl Finish {
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
        let part = FinishPart::load(&self.part)?;
        let place = self.part.display();
        note(format_args!("planning the passes, then proving every move of the whole mill"));
        let result = FinishResult::of(part).map_err(|why| Failure::Input(format!("{place}: {why}")))?;
        let figures = figures::FinishFigures::of(&result);
        if self.json {
            say(format_args!("{}", serde_json::to_string(&figures).unwrap_or_default()));
        } else {
            say(format_args!("{}", figures::text(&figures)));
        }
        if let Some(refusal) = result.refusal() {
            return Err(Failure::Input(format!("{place}: {refusal}; nothing is written")));
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
