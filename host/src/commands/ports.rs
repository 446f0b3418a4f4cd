//! `arcfeed ports`: list of the serial ports, as `python -m serial.tools.list_ports` prints it.

use super::outcome::{Failure, say};
use crate::console::note;
use crate::port::list::{grep, ports};

/// List the serial ports, as pyserial's list_ports does
#[derive(Debug, clap::Args)]
pub struct Ports {
    /// Only ports whose name, description or hardware id this regular expression matches, in either case
    regexp: Option<String>,
    /// With description and hardware id
    #[arg(short, long)]
    verbose: bool,
    /// Nothing on stderr
    #[arg(short, long)]
    quiet: bool,
    /// Only the N-th entry
    #[arg(short, value_name = "N")]
    n: Option<usize>,
    /// Also links to ports
    #[arg(short = 's', long)]
    include_links: bool,
    /// Print one JSON object a port (docs/json.md)
    #[arg(long)]
    json: bool,
}

impl Ports {
    /// Runs the command.
    ///
    /// # Errors
    /// The expression is invalid.
    pub fn run(&self) -> Result<(), Failure> {
        let mut found = ports(self.include_links);
        if let Some(regexp) = &self.regexp {
            if !self.quiet {
                note(format_args!("Filtered list with regexp: '{regexp}'"));
            }
            found = grep(found, regexp).map_err(|message| Failure::Input(format!("`{regexp}`: {message}")))?;
        }
        for (at, port) in found.iter().enumerate() {
            if self.n.is_some_and(|n| n != at + 1) {
                continue;
            }
            if self.json {
                let object = serde_json::to_string(port).map_err(|error| Failure::Input(error.to_string()))?;
                say(format_args!("{object}"));
                continue;
            }
            say(format_args!("{:20}", port.device));
            if self.verbose {
                say(format_args!("    desc: {}\n    hwid: {}", port.description, port.hwid));
            }
        }
        match found.len() {
            _ if self.quiet => {}
            0 => note(format_args!("no ports found")),
            count => note(format_args!("{count} ports found")),
        }
        Ok(())
    }
}
