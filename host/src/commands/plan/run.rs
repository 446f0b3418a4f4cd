//! `arcfeed plan cup-mill`: reads the part, plans and proves, prints the figures and writes the files.

use super::super::outcome::{Failure, say};
use super::plan_result::PlanResult;
use super::refusal::{RefusalFigures, set_aside};
use super::{CupMill, figures, files, widths};
use crate::console::note;
use crate::part::{MachineSource, PartFile};

impl CupMill {
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
        let refused = |message: String| {
            if self.json {
                let figures = RefusalFigures { safe: false, refused: &message };
                say(format_args!("{}", serde_json::to_string(&figures).unwrap_or_default()));
            }
            Failure::Input(message)
        };
        let part = PartFile::load(&self.part).map_err(|error| refused(error.to_string()))?;
        if self.wheel && part.machine.is_none() {
            let message = "--wheel needs a [machine] in the part file: its axes turn the wheel to the tool";
            return Err(refused(format!("{}: {message}", self.part.display())));
        }
        note(format_args!("comparing paths along some 200 directions of the tool, then planning and proving the best"));
        let part = if self.widths { PartFile { passes_max: 1, ..part } } else { part };
        let passes = PlanResult::passes(part).map_err(|why| refused(format!("{}: {why}", self.part.display())))?;
        if self.widths {
            return widths::widths(&passes[0], self.json);
        }
        passes.iter().for_each(|composed| self.print(composed));
        if !passes[0].is_safe() {
            return Err(Failure::Input(format!("{}: {}", self.part.display(), figures::refusal(&passes[0]))));
        }
        match &self.output {
            Some(folder) => {
                let mut inputs = vec![self.part.clone()];
                if let Some(MachineSource::File(file)) = &passes[0].part.machine_source {
                    inputs.push(file.clone());
                }
                files::write(&passes, self.wheel, folder, &inputs)
            }
            None => Ok(()),
        }
    }

    fn print(&self, composed: &PlanResult) {
        let figures = figures::Figures::of(composed);
        if self.json {
            say(format_args!("{}", serde_json::to_string(&figures).unwrap_or_default()));
        } else {
            say(format_args!("{}", figures::text(composed, &figures)));
        }
    }
}
