//! `arcfeed stream`: the adapted program to a control, block by block as it asks for them.

mod live;

mod outbox;

mod sim_port;

use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_shared::units::Micros;

use super::outcome::{Failure, adapted, file_failure, load, on_interrupt};
use super::simulate::{add_baseline, finish, measure};
use crate::dnc::{Sender, State};
use crate::job::JobFile;
use crate::port::Port;
use crate::port::open::{open, wrap};
use crate::port::url::{Base, PortUrl};
use crate::program::Program;
use crate::report::figures::{LinkFigures, RunReport};
use crate::report::printed;
use live::Progress;
use outbox::Outbox;
use sim_port::SimPort;

/// Longest time the loop sleeps: how late it may see an XOFF or a Ctrl-C.
const LOOP_MAX: Micros = Micros::from_ms(20);

/// Adapt a program and send it to a control; `sim:` is the control in software
#[derive(Debug, clap::Args)]
pub struct Stream {
    /// The job file
    job: PathBuf,
    /// The DNC line: a serial port's name, one of pyserial's URLs (docs/ports.md), or `sim:`
    #[arg(long, value_name = "URL", default_value = "sim:")]
    port: PortUrl,
    /// Line rate, in place of the job's
    #[arg(long)]
    baudrate: Option<u32>,
    /// Write the blocks that the control executed here (sim: only)
    #[arg(long, value_name = "FILE")]
    executed: Option<PathBuf>,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    json: bool,
}

/// How sending ended.
enum End {
    /// All is sent, and as far as the port knows executed.
    Complete,
    /// The operator stopped it.
    Interrupted { at_rest: bool },
}

impl Stream {
    /// Runs the command.
    ///
    /// # Errors
    /// The job or the program is at fault, the line or the machine failed, or the operator stopped it.
    pub fn run(&self) -> Result<(), Failure> {
        let (mut file, program) = load(&self.job)?;
        file.serial.baudrate = self.baudrate.unwrap_or(file.serial.baudrate);
        let serial = file.serial;
        if let Some(warning) = program.lost_label() {
            eprintln!("{}:{warning}", program.path.display());
        }
        let text = adapted(&program, &file.job).text;
        let sender = Sender::new(text, serial.baudrate, serial.bits_per_char(), serial.xonxoff);
        match self.port.base {
            Base::Sim => self.to_simulator(&file, &program, sender),
            _ => self.to_serial(&file, sender),
        }
    }

    fn to_simulator(&self, file: &JobFile, program: &Program, mut sender: Sender) -> Result<(), Failure> {
        let started = Instant::now();
        let mut port = SimPort::new(file, ControllerFault::None)?;
        let outbox = Outbox::new(file.serial.patience());
        let end = send(&mut *wrap(&self.port, Box::new(&mut port))?, &mut sender, outbox, !self.json)?;
        let rig = port.rig();
        let mut report = measure(rig, &file.job);
        report.blocks_sent = Some(sender.blocks_sent());
        report.link = Some(port.link_figures());
        report.real_time_factor = Some(rig.now().to_s() / started.elapsed().as_secs_f64());
        if let Some(path) = &self.executed {
            write_executed(path, rig.control().executed())?;
        }
        let waits_for_more = matches!(end, End::Complete) && !rig.is_done();
        add_baseline(&mut report, file, program)?;
        self.finish(file, &report, &sender, &end)?;
        if waits_for_more {
            let message = "the control executed all it got and waits for more: the program has no M02 or M30";
            return Err(Failure::Machine(message.into()));
        }
        Ok(())
    }

    fn to_serial(&self, file: &JobFile, mut sender: Sender) -> Result<(), Failure> {
        if self.executed.is_some() {
            let message = "--executed: a control on a serial line does not say what it executed; drop the option";
            return Err(Failure::Input(message.into()));
        }
        let mut port = open(&self.port, &file.serial)?;
        let outbox = Outbox::new(file.serial.patience());
        let end = send(&mut *port, &mut sender, outbox, !self.json)?;
        let (bytes, _) = sender.progress();
        let bits = bytes as f64 * f64::from(file.serial.bits_per_char());
        let mut report = RunReport { unit: file.job.unit.label(), ..RunReport::default() };
        report.blocks_sent = Some(sender.blocks_sent());
        report.printed = printed::lines(&sender.take_heard());
        report.link = Some(LinkFigures {
            bytes: bytes as u64,
            utilization: bits / f64::from(file.serial.baudrate) / port.now().to_s(),
            xoff_count: sender.counters().xoff_count,
            max_bytes_after_xoff: None,
            starved_ms: None,
            retries: 0,
        });
        self.finish(file, &report, &sender, &end)
    }

    fn finish(&self, file: &JobFile, report: &RunReport, sender: &Sender, end: &End) -> Result<(), Failure> {
        let title = format!("{} to {}", file.program.display(), self.port.text);
        finish(report, self.json, title)?;
        let (sent, total) = sender.progress();
        match end {
            End::Complete => Ok(()),
            End::Interrupted { at_rest: true } => Err(Failure::Stopped(format!(
                "stopped by the operator: feed hold, axes at rest, {sent} of {total} characters sent"
            ))),
            End::Interrupted { at_rest: false } => Err(Failure::Stopped(format!(
                "stopped by the operator after {sent} of {total} characters; the control goes on with what it has: press \
                 FEED HOLD there"
            ))),
        }
    }
}

/// Sends until everything is out and, where the port can know, executed; `shown` on a terminal.
fn send(port: &mut dyn Port, sender: &mut Sender, mut outbox: Outbox, shown: bool) -> Result<End, Failure> {
    let progress = Progress::new(sender.progress().1, shown);
    let interrupted: &AtomicBool = &on_interrupt();
    let mut incoming = [0; 64];
    loop {
        let len = port.read(&mut incoming)?;
        sender.on_bytes(&incoming[..len]);
        outbox.pump(port, sender)?;
        progress.show(sender);
        if interrupted.load(Ordering::Relaxed) {
            return Ok(End::Interrupted { at_rest: port.feed_hold() });
        }
        let is_out = sender.state() == State::Sent && outbox.is_empty() && port.out_waiting()? == 0;
        if port.control_is_done().unwrap_or(is_out) {
            return Ok(End::Complete);
        }
        let latest = port.now().after(LOOP_MAX);
        port.wait(sender.poll_at().map_or(latest, |at| at.min(latest)));
    }
}

/// Writes executed blocks, one a line.
///
/// # Errors
/// The file cannot be written.
pub fn write_executed(path: &PathBuf, blocks: &[Vec<u8>]) -> Result<(), Failure> {
    let write = || -> std::io::Result<()> {
        let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
        for block in blocks {
            file.write_all(block)?;
            file.write_all(b"\n")?;
        }
        file.flush()
    };
    write().map_err(|error| file_failure(path, &error))
}
