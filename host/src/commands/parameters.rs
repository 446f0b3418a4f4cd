//! `arcfeed parameters`: a job as stored in the flash of a board at a tapped line.

use std::path::PathBuf;

use arcfeed_link::message::page::{self, TappedLine};
use arcfeed_link::message::parameters::ParametersError;
use arcfeed_link::message::staging::Staging;
use arcfeed_nc::settings::ArcCenters;
use arcfeed_nc::tape_code::TapeCode as LineCode;

use super::outcome::{Failure, refuse_inputs, say, warn_of_rules, write_whole};
use crate::console::note;
use crate::job::{JobFile, TapeCode};

/// Write tool, laws and cut rules of a job as a board at a tapped line keeps them in flash (docs/tap.md)
#[derive(Debug, clap::Args)]
pub struct Parameters {
    /// The job file
    job: PathBuf,
    /// Write the page of flash here
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

impl Parameters {
    /// Runs the command.
    ///
    /// # Errors
    /// The job is at fault or has nothing for a board, or the file cannot be written.
    pub fn run(&self) -> Result<(), Failure> {
        let file = JobFile::load(&self.job)?;
        refuse_inputs(&[Some(&self.output)], &file.inputs(&self.job))?;
        warn_of_rules(&self.job, &file, None);
        if file.plunge.is_some() {
            note(format_args!(
                "{}:1:1: warning: a board at a tapped line leaves plunges and ramps their programmed feed, because no sender gives it a table of \
                 their feeds: send with arcfeed stream --board, or send what arcfeed adapt -o writes, with their least feeds as F (found `[plunge]`)",
                self.job.display()
            ));
        }
        file.refuse_scopes(&self.job, "a board at a tapped line").map_err(Failure::Input)?;
        let job = self.job.display();
        let code = match file.dnc.code {
            Some(TapeCode::Iso) => LineCode::Iso,
            Some(TapeCode::Eia) => LineCode::Eia,
            // The receiver removes the parity of the line.
            Some(TapeCode::Ascii) | None => LineCode::Ascii,
        };
        if file.nc.arc_centers != ArcCenters::FromStart {
            return Err(Failure::Input(format!(
                "{job}: a board at a tapped line reads I, J, K as distances from the arc's start only: post them so and remove \
                 arc_centers, or send with arcfeed stream --board"
            )));
        }
        let tapped = TappedLine { code: Some(code), decimals: file.nc.decimals };
        let page = page::write(&file.job, tapped).map_err(|error| {
            Failure::Input(match error {
                ParametersError::Policy => {
                    format!(
                        "{job}: the mode rewrite-only leaves a board nothing to do: write safe-base or override-only"
                    )
                }
                ParametersError::Number => format!("{job}: it has a number that no board takes"),
                ParametersError::EngagementPerMove(index) => format!(
                    "{job}: cut rule {}: its engaged arcs are sent with each move, and at a tapped line no sender has them: \
                     send with arcfeed stream --board, or give the rule a shape or a table as its stock",
                    index + 1
                ),
                ParametersError::Large => format!("{job}: it does not fit into {} bytes", page::PAGE_MAX),
            })
        })?;
        // Reads the page back as the board does.
        if let Err(error) = page::read(&page, &mut Staging::new()) {
            return Err(Failure::Input(format!("{job}: no board takes it: {error:?}")));
        }
        write_whole(&self.output, &page)?;
        say(format_args!("{}: {} bytes, {} cut rules", self.output.display(), page.len(), file.job.rules.len()));
        Ok(())
    }
}
