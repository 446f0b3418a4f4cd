//! `arcfeed serve`: the control and its machine in software, on a pseudo-terminal or a TCP port, for any sender.
//!
//! Simulated time follows wall time (times `--speed`) and never catches up: where this process was held up, its control
//! was held up with it, and what a sender wrote in the meantime was written before it could see an XOFF.

mod program_start;

mod client;

mod tcp_line;

mod pty;

mod line;

mod memory;

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use arcfeed_control::ControlSettings;
use arcfeed_control::code::TapeCode;
use arcfeed_control::line::SenderParity;
use arcfeed_control::search::Search;
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_nc::block::Reading;
use arcfeed_units::LengthUnit;
use clap::ValueEnum;

use super::outcome::{Failure, on_interrupt, refuse_inputs, say};
use super::simulate::control::control_settings;
use super::simulate::finish;
use super::simulate::run_figures::measure;
use super::simulate::run_tables::{RunTables, TraceFiles};
use super::stream::write_executed;
use crate::job::{ControlKind, JobFile, Parity, SerialSettings};
use crate::program::Folder;
use crate::report::figures::LinkFigures;
use line::ControlLine;
use tcp_line::ClientLimits;

/// Wall time between two polls of the line.
const PERIOD: Duration = Duration::from_millis(1);

/// Emulate a Fanuc-like control and its machine for any sender
#[derive(Debug, clap::Args)]
pub struct Serve {
    /// Job file: tool, law and cut rules of the controller; without one, a plain control at 100 %
    job: Option<PathBuf>,
    #[command(flatten)]
    place: Place,
    #[command(flatten)]
    clients: Clients,
    #[command(flatten)]
    panel: Panel,
    /// Unit at power-on, without a job
    #[arg(long, value_enum, default_value = "mm", conflicts_with = "job")]
    units: UnitWord,
    /// Control, in place of the job's: fanuc-16i, fanuc-0i, fanuc-31i
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
    /// Stop after one program; without it, programs are accepted for ever, on a pseudo-terminal until one ends in an
    /// alarm
    #[arg(long)]
    once: bool,
    /// Read a program into the control's memory instead of executing it, and punch it when the other side sends DC1
    #[arg(long, conflicts_with_all = ["executed", "json", "trace"])]
    store: bool,
    /// Write the blocks that the control executed here; a later program replaces them
    #[arg(long, value_name = "FILE")]
    executed: Option<PathBuf>,
    /// Write the tables of the run here, .parquet or .csv: OUT and OUT-blocks; a later program replaces them
    /// (docs/traces.md)
    #[arg(long, value_name = "OUT.parquet|OUT.csv")]
    trace: Option<PathBuf>,
    /// Print one JSON object per program, one per line (docs/json.md)
    #[arg(long)]
    json: bool,
}

/// Port to which the sender connects.
#[derive(Debug, clap::Args)]
#[group(required = true, multiple = false)]
struct Place {
    /// On a new pseudo-terminal, whose name is printed first
    #[arg(long)]
    pty: bool,
    /// On a TCP port (HOST:PORT; port 0: any free one, printed first), one program at a time
    #[arg(long, value_name = "ADDR")]
    tcp: Option<String>,
    /// On a port for RFC 2217, rfc2217://HOST:PORT; the client sets its port like the control's line
    #[arg(long, value_name = "ADDR")]
    rfc2217: Option<String>,
}

/// Limits of TCP clients (docs/control.md).
#[derive(Debug, clap::Args)]
struct Clients {
    /// Listen on an address that other machines can reach: whoever connects can run programs
    #[arg(long, conflicts_with = "pty")]
    allow_remote: bool,
    /// Most connections at once, the one with the line and those that wait for it
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u16).range(1..=256))]
    max_clients: u16,
    /// Seconds of silence in a program after which a sender loses the line to another that waits
    #[arg(long, value_name = "SECONDS", default_value_t = 60, value_parser = clap::value_parser!(u64).range(1..=86_400))]
    idle_timeout: u64,
}

/// Settings of the control's panel.
#[derive(Debug, clap::Args)]
struct Panel {
    /// Code of the tape, in place of that of the job's line (iso and eia: the sender makes the parity bits itself)
    #[arg(long, value_enum)]
    code: Option<CodeWord>,
    /// TV check: a block with an odd number of characters is alarm PS0002
    #[arg(long)]
    tv_check: bool,
    /// Reject what the control rejects also in titles and comments
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

impl Clients {
    fn limits(&self) -> ClientLimits {
        ClientLimits {
            clients: usize::from(self.max_clients),
            idle_timeout: Duration::from_secs(self.idle_timeout),
            allow_remote: self.allow_remote,
        }
    }
}

impl Panel {
    /// Required settings of a sender's port: with `--code` its eight bits are the sender's own.
    fn line(&self, serial: SerialSettings) -> SerialSettings {
        match self.code {
            Some(_) => SerialSettings { bytesize: 8, parity: Parity::None, ..serial },
            None => serial,
        }
    }

    fn apply(&self, settings: &mut ControlSettings) {
        if let Some(code) = self.code {
            settings.line.tape.code = Some(match code {
                CodeWord::Iso => TapeCode::Iso,
                CodeWord::Eia => TapeCode::Eia,
                CodeWord::Ascii => TapeCode::Ascii,
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
            (Some(job), _) => {
                let file = JobFile::load(job)?;
                file.refuse_scopes(job, "the control of `serve`").map_err(Failure::Input)?;
                file
            }
            (None, UnitWord::Inch) => JobFile::plain(LengthUnit::Inch),
            (None, UnitWord::Mm) => JobFile::plain(LengthUnit::Mm),
        };
        file.serial.baudrate = self.baudrate.unwrap_or(file.serial.baudrate);
        file.control = self.control.unwrap_or(file.control);
        file.settings = self.settings.clone().or(file.settings);
        let inputs = self.job.as_ref().map_or(Vec::from_iter(file.settings.clone()), |job| file.inputs(job));
        let trace = self.trace.as_deref().map(TraceFiles::of).transpose()?;
        let tables = trace.as_ref().map(TraceFiles::paths).into_iter().flatten().collect::<Vec<_>>();
        let outputs = tables.iter().map(|path| Some(path.as_path())).chain([self.executed.as_deref()]);
        refuse_inputs(&outputs.collect::<Vec<_>>(), &inputs)?;
        let of_control = file.control.settings(file.job.unit, file.settings.as_deref(), file.conventions);
        (file.nc, file.tables) = of_control.map_err(Failure::Input)?;
        let interrupted = on_interrupt();
        let mut line = match (&self.place.tcp, &self.place.rfc2217) {
            (Some(address), _) => ControlLine::tcp(address, None, self.clients.limits())?,
            (None, Some(address)) => {
                ControlLine::tcp(address, Some(self.panel.line(file.serial)), self.clients.limits())?
            }
            (None, None) => ControlLine::pty()?,
        };
        say(format_args!("port: {}", line.name()));
        if self.store {
            return self.keep_programs(&file, &mut line, interrupted);
        }
        let mut search = self.panel.restart_at.map(Search::Restart);
        loop {
            let mut simulation = self.simulation(&file)?;
            if let Some(search) = search {
                simulation.control_mut().search(search);
            }
            let mut tables = trace.as_ref().map(|files| files.begin(None, None)).transpose()?;
            if !serve_one(&mut simulation, &mut line, (self.speed, tables.as_mut()), interrupted)? {
                continue;
            }
            tables.map_or(Ok(()), |tables| tables.finish(&simulation, None, None))?;
            search = None;
            if interrupted.load(Ordering::Relaxed) {
                return Err(Failure::Stopped("stopped by the operator".into()));
            }
            // A control in alarm stays so until a reset: a fresh one would read the rest of the same program.
            if let Err(failure) = self.report(&file, &simulation, line.name()) {
                line.wait_for_silence(|| interrupted.load(Ordering::Relaxed))?;
                if self.once || !matches!(failure, Failure::Machine(_)) || !line.hang_up() {
                    return Err(failure);
                }
                // Over a new connection no rest of it can come.
                let _serves_on = failure.report();
            }
            if self.once {
                return Ok(());
            }
        }
    }

    fn simulation(&self, file: &JobFile) -> Result<Simulation, Failure> {
        let mut settings = control_settings(file);
        self.panel.apply(&mut settings);
        let fault = if self.job.is_some() { ControllerFault::None } else { ControllerFault::LawOff };
        let mut simulation = Simulation::on_line(settings, &file.job, fault)
            .map_err(|error| Failure::Input(format!("override limits: {error:?}")))?;
        match self.library.as_ref().or(file.library.as_ref()) {
            Some(folder) if !folder.is_dir() => {
                let message = format!("{}: no folder; --library wants one with subprograms", folder.display());
                return Err(Failure::Input(message));
            }
            Some(folder) => simulation.control_mut().set_library(Box::new(Folder(folder.clone()))),
            None => {}
        }
        Ok(simulation)
    }

    fn report(&self, file: &JobFile, simulation: &Simulation, name: &str) -> Result<(), Failure> {
        let counters = simulation.control().line_counters();
        let bits = counters.bytes as f64 * f64::from(file.serial.bits_per_char());
        let mut report = measure(simulation, &file.job);
        report.link = Some(LinkFigures {
            bytes: counters.bytes,
            utilization: bits / f64::from(file.serial.baudrate) / simulation.now().to_s(),
            xoff_count: counters.xoff_count,
            max_bytes_after_xoff: Some(counters.max_bytes_after_xoff),
            starved_ms: Some(simulation.control().starved_ms()),
            retries: 0,
            line_errors: None,
        });
        if let Some(path) = &self.executed {
            write_executed(path, simulation.control().executed())?;
        }
        finish(&report, self.json, format!("program received on {name}"))
    }
}

/// Runs a control until its program is over or the operator stops it; returns false if its sender left before it began
/// one. The control is switched on when a sender is there.
fn serve_one(
    simulation: &mut Simulation,
    line: &mut ControlLine,
    (speed, mut tables): (u32, Option<&mut RunTables>),
    interrupted: &AtomicBool,
) -> Result<bool, Failure> {
    while !line.begin() && !interrupted.load(Ordering::Relaxed) {
        std::thread::sleep(PERIOD);
    }
    while !simulation.is_done() && !interrupted.load(Ordering::Relaxed) {
        let started = Instant::now();
        for _ in 0..speed {
            let is_starved = simulation.control().is_starved();
            line.feed_control(simulation.control_mut().port(), is_starved)?;
            if line.is_abandoned() {
                return Ok(false);
            }
            if simulation.is_done() {
                break;
            }
            simulation.step();
            if let Some(tables) = &mut tables {
                tables.observe(simulation, None);
            }
            line.answer(simulation.control_mut().port())?;
        }
        std::thread::sleep(PERIOD.saturating_sub(started.elapsed()));
    }
    // The DC3 of the last step.
    line.answer(simulation.control_mut().port())?;
    Ok(true)
}
