//! `arcfeed serve`: the control and its machine in software, on a pseudo-terminal or a TCP port, for any sender.
//!
//! Simulated time follows wall time (times `--speed`) and never catches up: where this process was held up, its control
//! was held up with it, and what a sender wrote in the meantime was written before it could see an XOFF.

mod caller;

mod line;

mod memory;

use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use arcfeed_hil_sim::control::ControlSettings;
use arcfeed_hil_sim::control::code::Code;
use arcfeed_hil_sim::control::line::SenderParity;
use arcfeed_hil_sim::control::search::Search;
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::rig::Rig;
use arcfeed_shared::nc::block::Reading;
use arcfeed_shared::units::LengthUnit;
use clap::ValueEnum;

use super::outcome::{Failure, on_interrupt, say};
use super::simulate::control::control_settings;
use super::simulate::finish;
use super::simulate::measured::measure;
use super::stream::write_executed;
use crate::job::{ControlKind, JobFile, Parity, SerialSettings};
use crate::program::Folder;
use crate::report::figures::LinkFigures;
use line::Line;

/// Wall time between two looks at the line.
const PERIOD: Duration = Duration::from_millis(1);

/// Be the control (and its machine) for any sender
#[derive(Debug, clap::Args)]
pub struct Serve {
    /// The job file: tool, law and cut rules of the controller; without one, a plain control at 100 %
    job: Option<PathBuf>,
    #[command(flatten)]
    place: Place,
    #[command(flatten)]
    panel: Panel,
    /// Unit at power-on, without a job
    #[arg(long, value_enum, default_value = "mm", conflicts_with = "job")]
    units: UnitWord,
    /// The control, in place of the job's: fanuc-16i, fanuc-0i, fanuc-31i
    #[arg(long, value_parser = ControlKind::named)]
    control: Option<ControlKind>,
    /// The control's offsets, lengths and reference points, in place of the job's (docs/dialect.md)
    #[arg(long, value_name = "SETTINGS.toml")]
    settings: Option<PathBuf>,
    /// Folder of subprograms in the control's memory: O9010, O9010.nc or 9010.nc
    #[arg(long, value_name = "DIR")]
    library: Option<PathBuf>,
    /// Simulated seconds per second of wall time
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100))]
    speed: u32,
    /// Line rate, in place of the job's
    #[arg(long, value_parser = clap::value_parser!(u32).range(50..=4_000_000))]
    baudrate: Option<u32>,
    /// Stop after one program; without it, programs are taken until one ends in an alarm
    #[arg(long)]
    once: bool,
    /// Take a program into the control's memory in place of executing it, and punch it out when the other side says DC1
    #[arg(long, conflicts_with_all = ["executed", "json"])]
    store: bool,
    /// Write the blocks that the control executed here; a later program replaces them
    #[arg(long, value_name = "FILE")]
    executed: Option<PathBuf>,
    /// Print one JSON object a program, one a line (docs/json.md)
    #[arg(long)]
    json: bool,
}

/// Where the sender finds it.
#[derive(Debug, clap::Args)]
#[group(required = true, multiple = false)]
struct Place {
    /// On a new pseudo-terminal, whose name is printed first
    #[arg(long)]
    pty: bool,
    /// On a TCP port (HOST:PORT; port 0: any free one, printed first), one sender at a time
    #[arg(long, value_name = "ADDR")]
    tcp: Option<String>,
    /// As a serial port that RFC 2217 reaches, rfc2217://HOST:PORT; the client sets its port as the control's line is
    #[arg(long, value_name = "ADDR")]
    rfc2217: Option<String>,
}

/// How the control is set.
#[derive(Debug, clap::Args)]
struct Panel {
    /// The tape's code, in place of what the job's line says (iso and eia: the sender makes the parity bits itself)
    #[arg(long, value_enum)]
    code: Option<CodeWord>,
    /// TV check: a block with an odd number of characters is alarm PS0002
    #[arg(long)]
    tv_check: bool,
    /// Refuse what the control refuses also in titles and comments
    #[arg(long)]
    strict: bool,
    /// The optional-stop switch is on: M01 waits a second for the simulated operator
    #[arg(long)]
    optional_stop: bool,
    /// Block-delete switches that are on (1 to 9): `--block-delete 1,3`
    #[arg(long, value_name = "N", value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=9))]
    block_delete: Vec<u16>,
    /// The dry-run switch is on
    #[arg(long)]
    dry_run: bool,
    /// Restart the first program at this sequence number
    #[arg(long, value_name = "N")]
    restart_at: Option<u32>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum UnitWord {
    Inch,
    Mm,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum CodeWord {
    Iso,
    Eia,
    Ascii,
}

impl Panel {
    /// What a sender's port must be set to: with `--code` its eight bits are the sender's own.
    fn line(&self, serial: SerialSettings) -> SerialSettings {
        match self.code {
            Some(_) => SerialSettings { bytesize: 8, parity: Parity::None, ..serial },
            None => serial,
        }
    }

    fn apply(&self, settings: &mut ControlSettings) {
        if let Some(code) = self.code {
            settings.line.tape.code = Some(match code {
                CodeWord::Iso => Code::Iso,
                CodeWord::Eia => Code::Eia,
                CodeWord::Ascii => Code::Ascii,
            });
            settings.line.sender = SenderParity::None;
        }
        if self.strict {
            settings.nc.reading = Reading::Strict;
        }
        settings.line.tape.strict_characters = self.strict;
        settings.line.tape.tv_check = self.tv_check;
        settings.switches.optional_stop = self.optional_stop;
        settings.switches.block_delete |= self.block_delete.iter().fold(0, |bits, switch| bits | 1 << (switch - 1));
        settings.switches.dry_run = self.dry_run;
    }
}

impl Serve {
    /// Runs the command.
    ///
    /// # Errors
    /// The job is at fault, the line failed or the control raised an alarm.
    pub fn run(&self) -> Result<(), Failure> {
        let mut file = match (&self.job, self.units) {
            (Some(job), _) => JobFile::load(job)?,
            (None, UnitWord::Inch) => JobFile::plain(LengthUnit::Inch),
            (None, UnitWord::Mm) => JobFile::plain(LengthUnit::Mm),
        };
        file.serial.baudrate = self.baudrate.unwrap_or(file.serial.baudrate);
        file.control = self.control.unwrap_or(file.control);
        file.settings = self.settings.clone().or(file.settings);
        (file.nc, file.tables) =
            file.control.settings(file.job.unit, file.settings.as_deref()).map_err(Failure::Input)?;
        let interrupted = on_interrupt();
        let mut line = match (&self.place.tcp, &self.place.rfc2217) {
            (Some(address), _) => Line::tcp(address, None)?,
            (None, Some(address)) => Line::tcp(address, Some(self.panel.line(file.serial)))?,
            (None, None) => Line::pty()?,
        };
        say(format_args!("port: {}", line.name()));
        std::io::stdout().flush().map_err(|error| Failure::Machine(format!("stdout: {error}")))?;
        if self.store {
            return self.keep_programs(&file, &mut line, interrupted);
        }
        let mut search = self.panel.restart_at.map(Search::Restart);
        loop {
            let mut rig = self.rig(&file)?;
            if let Some(search) = search.take() {
                rig.control_mut().search(search);
            }
            serve_one(&mut rig, &mut line, self.speed, interrupted)?;
            if interrupted.load(Ordering::Relaxed) {
                return Err(Failure::Stopped("stopped by the operator".into()));
            }
            // A control in alarm stays so until somebody resets it: a fresh one would take the rest of the same program.
            if let Err(failure) = self.report(&file, &rig, line.name()) {
                std::io::stdout().flush().map_err(|error| Failure::Machine(format!("stdout: {error}")))?;
                line.wait_for_silence(|| interrupted.load(Ordering::Relaxed))?;
                return Err(failure);
            }
            if self.once {
                return Ok(());
            }
        }
    }

    fn rig(&self, file: &JobFile) -> Result<Rig, Failure> {
        let mut settings = control_settings(file);
        self.panel.apply(&mut settings);
        let fault = if self.job.is_some() { ControllerFault::None } else { ControllerFault::LawOff };
        let mut rig = Rig::on_line(settings, &file.job, fault)
            .map_err(|error| Failure::Input(format!("override limits: {error:?}")))?;
        match &self.library {
            Some(folder) if !folder.is_dir() => {
                let message = format!("{}: no folder; --library wants one with subprograms", folder.display());
                return Err(Failure::Input(message));
            }
            Some(folder) => rig.control_mut().set_library(Box::new(Folder(folder.clone()))),
            None => {}
        }
        Ok(rig)
    }

    fn report(&self, file: &JobFile, rig: &Rig, name: &str) -> Result<(), Failure> {
        let counters = rig.control().line_counters();
        let bits = counters.bytes as f64 * f64::from(file.serial.bits_per_char());
        let mut report = measure(rig, &file.job);
        report.link = Some(LinkFigures {
            bytes: counters.bytes,
            utilization: bits / f64::from(file.serial.baudrate) / rig.now().to_s(),
            xoff_count: counters.xoff_count,
            max_bytes_after_xoff: Some(counters.max_bytes_after_xoff),
            starved_ms: Some(rig.control().starved_ms()),
            retries: 0,
            line_errors: None,
        });
        if let Some(path) = &self.executed {
            write_executed(path, rig.control().executed())?;
        }
        finish(&report, self.json, format!("program received on {name}"))
    }
}

/// Runs a control until its program is over or the operator has enough. It is switched on when a sender is there.
fn serve_one(rig: &mut Rig, line: &mut Line, speed: u32, interrupted: &AtomicBool) -> Result<(), Failure> {
    while !line.has_sender()? && !interrupted.load(Ordering::Relaxed) {
        std::thread::sleep(PERIOD);
    }
    while !rig.is_done() && !interrupted.load(Ordering::Relaxed) {
        let started = Instant::now();
        for _ in 0..speed {
            line.listen(rig.control_mut().port())?;
            if rig.is_done() {
                break;
            }
            rig.step();
            line.answer(rig.control_mut().port())?;
        }
        std::thread::sleep(PERIOD.saturating_sub(started.elapsed()));
    }
    // The DC3 of the last step.
    line.answer(rig.control_mut().port())
}
