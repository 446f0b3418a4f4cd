//! `arcfeed stream`: the adapted program to a control, block by block as it asks for them.

mod live;

mod prepare;

mod logbook;

mod resume;

mod sim_port;

use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::Instant;

use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_shared::units::Micros;

use super::outcome::{Failure, file_failure, on_interrupt};
use super::simulate::{add_baseline, finish, measure};
use crate::dnc::journal::How;
use crate::dnc::outbox::Outbox;
use crate::dnc::sender::Why;
use crate::dnc::{Sender, State};
use crate::port::Port;
use crate::port::open::{open, wrap};
use crate::port::url::{Base, PortUrl};
use crate::report::figures::{LinkFigures, RunReport};
use crate::report::printed;
use crate::screen::view::{Command, Listing, View};
use live::{Live, need_terminal};
use logbook::Logbook;
use prepare::Prepared;
use resume::Resume;
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
    /// Make comments upper case and leave out of them what the control's code does not have, in place of refusing
    #[arg(long)]
    filter: bool,
    /// The journal that --resume reads (docs/dnc.md); without it JOB.journal beside the job, and none for sim:
    #[arg(long, value_name = "FILE")]
    journal: Option<PathBuf>,
    #[command(flatten)]
    resume: Resume,
    /// Show program, line and machine on the whole terminal, with keys to hold, resume and abort (docs/tui.md)
    #[arg(long, conflicts_with = "json")]
    tui: bool,
    /// Write what happens here, one event a line: DC1, DC3, blocks, hold, alarms
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// Simulated seconds per second of wall time (sim: only); without it 1 with --tui, otherwise as fast as it goes
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=100))]
    speed: Option<u32>,
    /// Write the blocks that the control executed here (sim: only)
    #[arg(long, value_name = "FILE")]
    executed: Option<PathBuf>,
    /// Print one JSON object, with --resume two (docs/json.md)
    #[arg(long)]
    json: bool,
}

/// How sending ended.
enum End {
    /// All is sent, and as far as the port knows executed.
    Complete,
    /// The operator stopped it.
    Interrupted { at_rest: bool },
    /// The sender has given up.
    GivenUp(Why),
}

impl End {
    fn how(&self) -> How {
        match self {
            End::Complete => How::Complete,
            End::Interrupted { .. } => How::Aborted,
            End::GivenUp(_) => How::Failed,
        }
    }
}

impl Stream {
    /// Runs the command.
    ///
    /// # Errors
    /// The job or the program is at fault, the line or the machine failed, or the operator stopped it.
    pub fn run(&self) -> Result<(), Failure> {
        if self.tui {
            need_terminal()?;
        }
        let ready = Prepared::load(&self.job, self.baudrate, self.filter)?;
        let is_sim = self.port.base == Base::Sim;
        if self.executed.is_some() && !is_sim {
            let message = "--executed: a control on a serial line does not say what it executed; drop the option";
            return Err(Failure::Input(message.into()));
        }
        if self.speed.is_some() && !is_sim {
            return Err(Failure::Usage(
                "--speed: only the control in software (sim:) has a speed; drop the option".into(),
            ));
        }
        let line = ready.line_use(&self.port);
        let (sending, start) = if self.resume.is_wanted() {
            self.resume.prepare(self, &ready)?
        } else {
            (ready.whole.clone(), ready.start)
        };
        for note in ready.notes(&line) {
            eprintln!("{note}");
        }
        let mut sender = Sender::new(sending, line);
        // The line first: a port that does not open leaves the journal of the run before as it is.
        let journal = |sender: &mut Sender| match is_sim && self.journal.is_none() {
            true => Ok(Logbook::none()),
            false => Logbook::create(&self.journal_path(), &start, ready.chars_per_s() as usize, sender),
        };
        if is_sim {
            let logbook = journal(&mut sender)?;
            return self.to_simulator(&ready, sender, logbook);
        }
        let port = open(&self.port, &ready.file.serial)?;
        let logbook = journal(&mut sender)?;
        self.to_serial(&ready, port, sender, logbook)
    }

    /// Where the journal lies.
    fn journal_path(&self) -> PathBuf {
        self.journal.clone().unwrap_or_else(|| self.job.with_extension("journal"))
    }

    fn to_simulator(&self, ready: &Prepared, mut sender: Sender, logbook: Logbook) -> Result<(), Failure> {
        let file = &ready.file;
        let started = Instant::now();
        let mut port = SimPort::new(file, ControllerFault::None, self.speed.or(self.tui.then_some(1)))?;
        let outbox = Outbox::new(file.serial.patience());
        let mut line = wrap(&self.port, Box::new(&mut port))?;
        let live = self.live(ready, &sender)?;
        let end = self.send(&mut *line, &mut sender, outbox, (logbook, live))?;
        drop(line);
        let rig = port.rig();
        let mut report = measure(rig, &file.job);
        report.blocks_sent = Some(sender.blocks_sent());
        report.link = Some(port.link_figures());
        report.real_time_factor = Some(rig.now().to_s() / started.elapsed().as_secs_f64());
        if let Some(path) = &self.executed {
            write_executed(path, rig.control().executed())?;
        }
        let waits_for_more = matches!(end, End::Complete) && !rig.is_done();
        add_baseline(&mut report, file, &ready.program)?;
        self.finish(ready, &report, &sender, &end)?;
        if waits_for_more {
            return Err(Failure::Machine(match sender.state() {
                State::Sent => "the control executed all it got and waits for more: its M02 or M30 was lost".into(),
                _ => {
                    "the control has nothing left to execute, and its DC1 has not come: it was lost on the line".into()
                }
            }));
        }
        Ok(())
    }

    fn to_serial(
        &self,
        ready: &Prepared,
        mut port: Box<dyn Port>,
        mut sender: Sender,
        logbook: Logbook,
    ) -> Result<(), Failure> {
        let file = &ready.file;
        let outbox = Outbox::new(file.serial.patience());
        let live = self.live(ready, &sender)?;
        let end = self.send(&mut *port, &mut sender, outbox, (logbook, live))?;
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
        self.finish(ready, &report, &sender, &end)
    }

    fn finish(&self, ready: &Prepared, report: &RunReport, sender: &Sender, end: &End) -> Result<(), Failure> {
        let title = format!("{} to {}", ready.file.program.display(), self.port.text);
        finish(report, self.json, title)?;
        let (sent, total) = sender.progress();
        let half = sender.half_block().map_or(String::new(), |half| {
            format!(
                ". The control holds `{}` without its end of block: it is not executed, but the next line sent would \
                 complete it: press RESET there before that",
                half.escape_ascii()
            )
        });
        match end {
            End::Complete => Ok(()),
            End::GivenUp(why) => Err(Failure::Machine(format!("{sent} of {total} characters sent: {why}{half}"))),
            End::Interrupted { at_rest: true } => Err(Failure::Stopped(format!(
                "stopped by the operator: feed hold, axes at rest, {sent} of {total} characters sent{half}"
            ))),
            End::Interrupted { at_rest: false } => Err(Failure::Stopped(format!(
                "stopped by the operator after {sent} of {total} characters; the control goes on with what it has: press \
                 FEED HOLD there{half}"
            ))),
        }
    }

    /// Sends until everything is out and, where the port can know, executed.
    fn send(
        &self,
        port: &mut dyn Port,
        sender: &mut Sender,
        mut outbox: Outbox,
        (mut logbook, mut live): (Logbook, Live),
    ) -> Result<End, Failure> {
        let ended = send_all(port, sender, &mut outbox, (&mut logbook, &mut live));
        live.show(port, sender);
        // The terminal is given back before anything is said.
        drop(live);
        let stands = match &ended {
            Ok(End::Interrupted { at_rest }) => *at_rest,
            Ok(_) => port.control_is_done() == Some(true),
            Err(_) => false,
        };
        let executed = port.blocks_executed().filter(|_| stands);
        logbook.end(sender, ended.as_ref().map_or(How::Failed, End::how), executed)?;
        match (ended, logbook.path()) {
            (Err(Failure::Machine(message)), Some(path)) => {
                let journal = path.display();
                Err(Failure::Machine(format!("{message}\nthe journal {journal} knows how far it came: see --resume")))
            }
            (ended, _) => ended,
        }
    }

    /// Who watches.
    fn live(&self, ready: &Prepared, sender: &Sender) -> Result<Live, Failure> {
        let program = ready.file.program.file_name().unwrap_or_default().to_string_lossy();
        let title = format!("{program} to {}", self.port.text);
        let live = if self.tui {
            let times_s = ready.loads(sender.transmission()).iter().map(|load| load.time_s).collect::<Vec<_>>();
            let listing = Listing::new(sender.transmission(), &times_s);
            Live::screen(View::new(title.clone(), listing, ready.chars_per_s() * sender.share()))?
        } else if self.json {
            Live::nothing()
        } else {
            Live::bar(sender.progress().1)
        };
        match &self.log {
            Some(path) => live.logging(path, &title, sender),
            None => Ok(live),
        }
    }
}

fn send_all(
    port: &mut dyn Port,
    sender: &mut Sender,
    outbox: &mut Outbox,
    (logbook, live): (&mut Logbook, &mut Live),
) -> Result<End, Failure> {
    let interrupted = on_interrupt();
    loop {
        logbook.follow(sender, port.blocks_executed())?;
        // Before the turn: a control that has waited gets characters at once when it goes on.
        match live.show(port, sender) {
            Some(Command::Hold) => sender.hold(),
            Some(Command::Resume) => sender.resume(),
            Some(Command::Abort) => interrupted.store(true, Ordering::Relaxed),
            None => {}
        }
        let is_out = outbox.turn(port, sender)?;
        match sender.state() {
            State::Cut if outbox.is_empty() => return Ok(End::Interrupted { at_rest: port.feed_hold() }),
            State::Failed(why) => return Ok(End::GivenUp(why)),
            State::Sent if interrupted.load(Ordering::Relaxed) => {
                return Ok(End::Interrupted { at_rest: port.feed_hold() });
            }
            _ if interrupted.load(Ordering::Relaxed) => sender.abort(port.now()),
            _ => {}
        }
        // A control that has nothing to do because we hold will get more; one in alarm will not.
        let waits_for_us = sender.state() == State::Held && port.machine().alarm.is_none();
        if port.control_is_done().unwrap_or(is_out) && !waits_for_us {
            logbook.follow(sender, port.blocks_executed())?;
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
