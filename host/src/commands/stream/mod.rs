//! `arcfeed stream`: sends the adapted program to a control, block by block as it requests them.

mod live_display;

pub(super) mod preparation;

mod live_path;

mod board_session;

mod logbook;

mod resume;

mod sim_port;

mod sim_link;

mod send_loop;

mod run_page;

mod simulator;

mod checks;

mod judgement;

mod linuxcnc_trace;

mod linuxcnc;

use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use arcfeed_units::Micros;

use super::job_input::JobInput;
use super::line_args::LineArgs;
use super::outcome::{Failure, refuse_inputs, write_whole};
use super::simulate::assertions::Assertion;
use super::simulate::finish;
use super::simulate::run_tables::TraceFiles;
use crate::board::line::{BAUDRATE, BoardLine};
use crate::console::note;
use crate::dnc::Sender;
use crate::dnc::outbox::Outbox;
use crate::port::Port;
use crate::port::open::open;
use crate::port::url::{Base, PortUrl};
use crate::report::figures::{LineErrorFigures, LinkFigures, ReportFigures, RunReport};
use crate::report::print_output;
use crate::screen::view::{Listing, View};
use board_session::{Arming, BoardSession};
use live_display::{LiveDisplay, need_terminal};
use logbook::Logbook;
use preparation::PreparedProgram;
use resume::Resume;
use send_loop::{End, ReportMonitor, SendServices, send};

/// Adapt a program and send it to a control; `sim:` is the simulated control, `linuxcnc:` a LinuxCNC on this computer
#[derive(Debug, clap::Args)]
pub struct Stream {
    /// DNC line: a serial port's name, one of pyserial's URLs (docs/ports.md), `sim:` or `linuxcnc:` (docs/linuxcnc.md)
    #[arg(long, value_name = "URL", default_value = "sim:")]
    port: PortUrl,
    /// Feed board that takes part, at this port (docs/board.md): it gets the job and each move ahead of the control
    #[arg(long, value_name = "URL")]
    board: Option<PortUrl>,
    /// Rate of the board's link; 8N1, no flow control
    #[arg(long, default_value_t = BAUDRATE, requires = "board")]
    board_baudrate: u32,
    #[command(flatten)]
    line: LineArgs,
    /// Refuse comments with characters that the control's code does not have, instead of sending capitals and blanks
    #[arg(long)]
    keep_comments: bool,
    /// Journal that --resume reads (docs/dnc.md); without it JOB.journal beside the job, and none for sim:
    #[arg(long, value_name = "FILE")]
    journal: Option<PathBuf>,
    #[command(flatten)]
    resume: Resume,
    /// Show program, line and machine on the whole terminal, with keys to hold, resume and abort (docs/tui.md)
    #[arg(long, conflicts_with = "json")]
    tui: bool,
    /// Serve a live page to browsers on this computer, with buttons to hold, resume and abort (docs/web.md); with IP:PORT at
    /// that address
    #[arg(long, value_name = "IP:PORT", num_args = 0..=1, default_missing_value = "127.0.0.1:0")]
    web: Option<SocketAddr>,
    /// Write the events here, one per line: DC1, DC3, blocks, hold, alarms
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// Simulated seconds per second of wall time (sim: only); without it 1 with --tui or --web, otherwise as fast as possible
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=100))]
    speed: Option<u32>,
    /// Write the blocks that the control executed here (sim: only)
    #[arg(long, value_name = "FILE")]
    executed: Option<PathBuf>,
    /// Write the report of the run here, as one HTML file (sim: only; docs/report.md)
    #[arg(long, value_name = "OUT.html")]
    report: Option<PathBuf>,
    /// Write the tables of the run here, .parquet or .csv: OUT and OUT-blocks; with linuxcnc: OUT alone (docs/traces.md)
    #[arg(long, value_name = "OUT.parquet|OUT.csv")]
    trace: Option<PathBuf>,
    /// Require a limit of the run, as far as it went: chip<=1.05, feed<=5000mm/min or time<=120s; may be given several
    /// times (sim: and linuxcnc: only; docs/simulate.md)
    #[arg(long = "assert", value_name = "FIGURE<=LIMIT")]
    assertions: Vec<Assertion>,
    /// Write the outcomes of the assertions here, as JUnit XML
    #[arg(long, value_name = "OUT.xml", requires = "assertions")]
    junit: Option<PathBuf>,
    /// Print one JSON object, with --resume two (docs/json.md)
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    input: JobInput,
}

impl Stream {
    /// Runs the command.
    ///
    /// # Errors
    /// The job or the program is at fault, the line or the machine failed, or the operator stopped it.
    pub fn run(&self) -> Result<(), Failure> {
        self.check_assertions()?;
        if self.port.base == Base::LinuxCnc {
            return self.to_linuxcnc();
        }
        if self.tui {
            need_terminal()?;
        }
        self.check_line_options()?;
        let mut ready = PreparedProgram::load(&self.input, &self.line, !self.keep_comments)?;
        self.check_mode(&ready.file.job.policy)?;
        let is_sim = self.port.base == Base::Sim;
        let journal = (!is_sim || self.journal.is_some()).then(|| self.journal_path());
        let written = [&self.log, &self.executed, &self.report, &self.junit].map(Option::as_deref);
        let mut outputs = [&[journal.as_deref()], &written[..]].concat();
        let trace = self.trace.as_deref().map(TraceFiles::of).transpose()?;
        let tables = trace.as_ref().map(TraceFiles::paths).into_iter().flatten().collect::<Vec<_>>();
        outputs.extend(tables.iter().map(|path| Some(path.as_path())).chain(self.port.files().map(Some)));
        refuse_inputs(&outputs, &ready.file.inputs(&self.input.job))?;
        let line = ready.line_use(&self.port);
        let (sending, start, reports) = if self.resume.is_wanted() {
            self.resume.prepare(self, &ready)?
        } else {
            (ready.whole.clone(), ready.start, ready.reports.clone())
        };
        ready.reports = reports;
        ready.notes = ready.line_notes(&line);
        ready.notes.iter().for_each(|line| note(format_args!("{line}")));
        let mut sender = Sender::new(sending, line);
        // The line first: if a port does not open, the journal of the run before stays as it is.
        let journal = |sender: &mut Sender| match &journal {
            None => Ok(Logbook::none()),
            Some(path) => Logbook::create(path, &start, ready.chars_per_s() as usize, sender),
        };
        if is_sim {
            let logbook = journal(&mut sender)?;
            return self.to_simulator(&ready, sender, logbook);
        }
        let mut board_session = self.board_session(&ready, &sender)?;
        board_session.arm(&mut || {})?;
        let port = open(&self.port, &ready.file.serial)?;
        let logbook = journal(&mut sender)?;
        self.to_serial(&ready, port, sender, (logbook, board_session))
    }

    /// Connects to the board, if one is requested.
    fn board_session(&self, ready: &PreparedProgram, sender: &Sender) -> Result<BoardSession<'static>, Failure> {
        match &self.board {
            None => Ok(BoardSession::none()),
            Some(url) => {
                let arming = if self.tui { Arming::Button } else { Arming::Typed };
                BoardSession::with(BoardLine::open(url, self.board_baudrate)?, ready, sender.transmission(), arming)
            }
        }
    }

    /// Path of the journal.
    fn journal_path(&self) -> PathBuf {
        self.journal.clone().unwrap_or_else(|| self.input.job.with_extension("journal"))
    }

    fn to_serial(
        &self,
        ready: &PreparedProgram,
        mut port: Box<dyn Port>,
        mut sender: Sender,
        (logbook, board_session): (Logbook, BoardSession<'_>),
    ) -> Result<(), Failure> {
        let (report, end) = self.over_line(ready, &mut *port, &mut sender, (logbook, board_session))?;
        self.finish(ready, &report, &sender, &end)
    }

    /// Sends over a line whose control reports nothing, and returns the figures that are known then.
    fn over_line(
        &self,
        ready: &PreparedProgram,
        port: &mut dyn Port,
        sender: &mut Sender,
        (logbook, board_session): (Logbook, BoardSession<'_>),
    ) -> Result<(RunReport, End), Failure> {
        let file = &ready.file;
        let outbox = Outbox::new(file.serial.write_timeout());
        let services = self.services(ready, (&*port, sender), (logbook, board_session))?;
        let (end, heard) = send(port, sender, outbox, services)?;
        let (bytes, _) = sender.progress();
        let bits = bytes as f64 * f64::from(file.serial.bits_per_char());
        let mut report = RunReport { unit: file.job.unit.label(), ..RunReport::default() };
        report.blocks_sent = Some(sender.blocks_sent());
        report.print_output = print_output::lines(&heard.printed());
        report.reports = ReportFigures::of(&heard);
        report.link = Some(LinkFigures {
            bytes: bytes as u64,
            utilization: bits / f64::from(file.serial.baudrate) / port.now().to_s(),
            xoff_count: sender.counters().xoff_count,
            max_bytes_after_xoff: None,
            starved_ms: None,
            retries: 0,
            line_errors: port.line_errors().map(LineErrorFigures::from),
        });
        Ok((report, end))
    }

    fn finish(&self, ready: &PreparedProgram, report: &RunReport, sender: &Sender, end: &End) -> Result<(), Failure> {
        let title = format!("{} to {}", ready.file.program.display(), self.port.text);
        let printed = finish(report, self.json, title);
        if matches!(printed, Err(Failure::Machine(_))) {
            return printed;
        }
        // The remedy at the machine is reported even if the report cannot be printed.
        Self::ended(sender, end).and(printed)
    }

    /// Result of sending, in words.
    fn ended(sender: &Sender, end: &End) -> Result<(), Failure> {
        let ((sent, total), blocks) = (sender.progress(), sender.blocks_sent());
        let half = sender.half_block().map_or(String::new(), |half| {
            format!(
                ". The control holds `{}` without its end of block: it is not executed, but the next line sent would \
                 complete it: press RESET there before that",
                half.escape_ascii()
            )
        });
        match end {
            End::Complete => Ok(()),
            End::WithoutBoard(why) => Err(Failure::Machine(format!(
                "{why}. Sending stopped after {sent} of {total} characters{half}; the control continues with the blocks it has, at \
                 100 % once the board's last value is too old. A board that failed or was restarted by its watchdog puts out \
                 0 % until RESET there. To continue: look at board and machine, take the program up again with --resume, and arm"
            ))),
            End::GivenUp(why) => Err(Failure::Machine(format!(
                "{sent} of {total} characters, {blocks} whole blocks, were sent: {why}{half}"
            ))),
            End::Differs { what, at_rest } => Err(Failure::Machine(format!(
                "{what}. Nothing more is sent, {sent} of {total} characters were; {}{half}",
                if *at_rest {
                    "feed hold, axes at rest"
                } else {
                    "the control continues with the blocks it has: press FEED HOLD there"
                }
            ))),
            End::Interrupted { at_rest: true } => Err(Failure::Stopped(format!(
                "stopped by the operator: feed hold, axes at rest, {sent} of {total} characters sent{half}"
            ))),
            End::Interrupted { at_rest: false } => Err(Failure::Stopped(format!(
                "stopped by the operator after {sent} of {total} characters; the control continues with the blocks it has: press \
                 FEED HOLD there{half}"
            ))),
        }
    }

    /// Journal, display, reports and board beside the sender at this port.
    fn services<'p>(
        &self,
        ready: &PreparedProgram,
        (port, sender): (&dyn Port, &Sender),
        (logbook, board_session): (Logbook, BoardSession<'p>),
    ) -> Result<SendServices<'p>, Failure> {
        let live = self.live(ready, sender, (port.opened(), logbook.path()))?;
        let (dnc, reports) = (&ready.file.dnc, ready.reports.clone());
        let timeout = (dnc.xoff_timeout > Micros(0)).then_some(dnc.xoff_timeout);
        Ok(SendServices { logbook, live, echo: ReportMonitor::new(reports, dnc.read_ahead, timeout), board_session })
    }

    /// Display and event log of the run.
    fn live(
        &self,
        ready: &PreparedProgram,
        sender: &Sender,
        (opened, journal): (Option<SystemTime>, Option<&Path>),
    ) -> Result<LiveDisplay, Failure> {
        let program = ready.file.program.file_name().unwrap_or_default().to_string_lossy();
        let title = format!("{program} to {}", self.port.text);
        let view = || {
            let times_s = ready.loads(sender.transmission()).iter().map(|load| load.time_s).collect::<Vec<_>>();
            let listing = Listing::new(sender.transmission(), &times_s);
            let mut view = View::new(title.clone(), listing, ready.chars_per_s() * sender.share());
            view.unit = ready.file.job.unit;
            view.notes.clone_from(&ready.notes);
            view.journal = journal.map(|path| path.display().to_string());
            view
        };
        let mut page =
            self.web.map(|address| live_path::serve(ready, sender.transmission(), address, view())).transpose()?;
        let mut live = if self.tui {
            let mut view = view();
            view.notes.extend(page.iter().map(|(_, page)| format!("note: the live page is {}", page.url())));
            LiveDisplay::screen(view)?
        } else if self.json {
            LiveDisplay::nothing()
        } else {
            LiveDisplay::bar(sender.progress().1)
        };
        if let Some((view, page)) = page.take() {
            live = live.on_page(view, page);
        }
        match &self.log {
            Some(path) => live.logging(path, &title, opened, sender),
            None => Ok(live),
        }
    }
}

/// Writes executed blocks, one per line.
///
/// # Errors
/// The file cannot be written.
pub fn write_executed(path: &Path, blocks: &[Vec<u8>]) -> Result<(), Failure> {
    let lines: Vec<u8> = blocks.iter().flat_map(|block| block.iter().chain(b"\n")).copied().collect();
    write_whole(path, &lines)
}

#[cfg(test)]
mod tests;
