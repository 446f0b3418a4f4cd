//! `arcfeed serve`: the control and its machine in software, on a pseudo-terminal, for any sender.
//!
//! Simulated time follows wall time (times `--speed`) and never catches up: where this process was held up, its control
//! was held up with it, and what a sender wrote in the meantime was written before it could see an XOFF.

use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use arcfeed_hil_sim::control::dnc_port::DC3;
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::rig::Rig;
use serialport::{SerialPort, TTYPort};

use super::outcome::{Failure, on_interrupt, say};
use super::simulate::{control_settings, finish, measure};
use super::stream::write_executed;
use crate::job::JobFile;
use crate::report::figures::LinkFigures;

/// Wall time between two looks at the line.
const PERIOD: Duration = Duration::from_millis(1);

/// Be the control (and its machine) for any sender
#[derive(Debug, clap::Args)]
pub struct Serve {
    /// The job file: tool, law and cut rules of the controller
    job: PathBuf,
    /// On a new pseudo-terminal, whose name is printed first
    #[arg(long, required = true)]
    pty: bool,
    /// Simulated seconds per second of wall time
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100))]
    speed: u32,
    /// Line rate, in place of the job's
    #[arg(long)]
    baudrate: Option<u32>,
    /// Stop after one program; without it, programs are taken until one ends in an alarm
    #[arg(long)]
    once: bool,
    /// Write the blocks that the control executed here; a later program replaces them
    #[arg(long, value_name = "FILE")]
    executed: Option<PathBuf>,
    /// Print one JSON object a program, one a line (docs/json.md)
    #[arg(long)]
    json: bool,
}

/// The control's end of the line.
struct Line {
    /// The end we read and write.
    ours: TTYPort,
    /// The sender's end, held open so that the line outlives the sender.
    _theirs: File,
}

impl Serve {
    /// Runs the command.
    ///
    /// # Errors
    /// The job is at fault or the pseudo-terminal failed.
    pub fn run(&self) -> Result<(), Failure> {
        let mut file = JobFile::load(&self.job)?;
        file.serial.baudrate = self.baudrate.unwrap_or(file.serial.baudrate);
        let interrupted = on_interrupt();
        let (mut line, name) = Line::open()?;
        say(format_args!("port: {name}"));
        std::io::stdout().flush().map_err(|error| line_failure(&error))?;
        loop {
            let rig = self.serve_one(&file, &mut line, &interrupted)?;
            if interrupted.load(Ordering::Relaxed) {
                return Err(Failure::Stopped("stopped by the operator".into()));
            }
            // A control in alarm stays so until somebody resets it: a fresh one would take the rest of the same program.
            self.report(&file, &rig, &name)?;
            if self.once {
                return Ok(());
            }
        }
    }

    /// Runs a fresh control until its program is over or the operator has enough.
    fn serve_one(&self, file: &JobFile, line: &mut Line, interrupted: &AtomicBool) -> Result<Rig, Failure> {
        let mut rig = Rig::on_line(control_settings(file), &file.job, ControllerFault::None)
            .map_err(|error| Failure::Input(format!("override limits: {error:?}")))?;
        while !rig.is_done() && !interrupted.load(Ordering::Relaxed) {
            let started = Instant::now();
            line.listen(&mut rig).map_err(|error| line_failure(&error))?;
            for _ in 0..self.speed {
                if rig.is_done() {
                    break;
                }
                rig.step();
                line.answer(&mut rig).map_err(|error| line_failure(&error))?;
            }
            std::thread::sleep(PERIOD.saturating_sub(started.elapsed()));
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
        });
        if let Some(path) = &self.executed {
            write_executed(path, rig.control().executed())?;
        }
        finish(&report, self.json, format!("program received on {name}"))
    }
}

impl Line {
    fn open() -> Result<(Self, String), Failure> {
        let failed = |error: serialport::Error| line_failure(&error.into());
        let (ours, theirs) = TTYPort::pair().map_err(failed)?;
        let name = theirs.name().unwrap_or_default();
        // As a plain file: a serial port is locked, and the sender must be able to lock it.
        let held = File::options().read(true).write(true).open(&name).map_err(|error| line_failure(&error))?;
        drop(theirs);
        Ok((Line { ours, _theirs: held }, name))
    }

    /// Takes everything that has been written to the line.
    fn listen(&mut self, rig: &mut Rig) -> std::io::Result<()> {
        let mut buffer = [0; 256];
        while self.ours.bytes_to_read()? > 0 {
            match self.ours.read(&mut buffer) {
                Ok(len) => rig.control_mut().port().on_bytes(&buffer[..len]),
                Err(error) if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::Interrupted) => return Ok(()),
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Sends what the control has to say.
    fn answer(&mut self, rig: &mut Rig) -> std::io::Result<()> {
        while let Some(byte) = rig.control_mut().port().poll_transmit() {
            if byte == DC3 {
                self.listen(rig)?;
                rig.control_mut().port().excuse_what_is_on_the_wire();
            }
            self.ours.write_all(&[byte])?;
        }
        Ok(())
    }
}

fn line_failure(error: &std::io::Error) -> Failure {
    Failure::Machine(format!("pseudo-terminal: {error}"))
}
