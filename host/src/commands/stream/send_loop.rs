//! Loop that serves sender and port, with the journal, the display, the board and the control's reports.

use std::sync::atomic::Ordering;

use arcfeed_units::Micros;

use super::super::outcome::{Failure, on_interrupt};
use super::board_session::BoardSession;
use super::live_display::LiveDisplay;
use super::logbook::Logbook;
use crate::dnc::damage::DamageMonitor;
use crate::dnc::journal::EndReason;
use crate::dnc::outbox::Outbox;
use crate::dnc::reports::{ReportFinding, Reports};
use crate::dnc::sender::FailureReason;
use crate::dnc::{Sender, State};
use crate::port::Port;
use crate::screen::view::Command;

/// Longest sleep of the loop: largest delay until it sees an XOFF or a Ctrl-C.
const LOOP_MAX: Micros = Micros::from_ms(20);

/// End of the sending, with its cause.
pub enum End {
    /// All characters have been sent and, as far as the port knows, executed.
    Complete,
    /// The operator stopped it; `at_rest`: the axes have come to rest by feed hold.
    Interrupted { at_rest: bool },
    /// The sender has given up: the control's signal did not come.
    GivenUp(FailureReason),
    /// The board has left the run, for this reason.
    WithoutBoard(String),
    /// A report of the control differs from the program; `at_rest`: the axes have come to rest by feed hold.
    Differs { what: String, at_rest: bool },
}

impl End {
    fn how(&self) -> EndReason {
        match self {
            End::Complete => EndReason::Complete,
            End::Interrupted { .. } => EndReason::Aborted,
            End::GivenUp(_) | End::WithoutBoard(_) | End::Differs { .. } => EndReason::Failed,
        }
    }
}

/// Services that run beside a sender: journal, display, report check and board.
pub struct SendServices<'p> {
    /// Journal of the transmission.
    pub logbook: Logbook,
    /// Display of the progress.
    pub live: LiveDisplay,
    /// Check of the control's position reports.
    pub echo: ReportMonitor,
    /// Feed board that takes part, or none.
    pub board_session: BoardSession<'p>,
}

/// Check of the control's position reports, if the job requests them.
#[derive(Default)]
pub struct ReportMonitor {
    /// Expected and received position reports.
    pub reports: Reports,
    /// Largest number of blocks that the control reads ahead.
    pub read_ahead: usize,
    /// Longest wait for a report; `None`: no limit.
    pub timeout: Option<Micros>,
    heard_at: Micros,
    /// Difference from the program that was sent.
    differs: Option<String>,
}

impl ReportMonitor {
    /// Check for these reports, from a control that reads `read_ahead` blocks ahead.
    pub fn new(reports: Reports, read_ahead: usize, timeout: Option<Micros>) -> Self {
        ReportMonitor { reports, read_ahead, timeout, ..ReportMonitor::default() }
    }

    /// Reads printed text; returns messages about it.
    fn read_printed(&mut self, now: Micros, bytes: &[u8]) -> Vec<String> {
        if !bytes.is_empty() {
            self.heard_at = now;
        }
        let mut said = Vec::new();
        for remark in self.reports.read_printed(bytes) {
            match remark {
                ReportFinding::Differs(what) => self.differs = self.differs.take().or(Some(what)),
                ReportFinding::Doubtful(what) => said.push(format!("warning: {what}")),
            }
        }
        said
    }

    /// A report is still to come, and its time is not over.
    fn waits(&self, now: Micros, sender: &Sender) -> bool {
        let since = self.heard_at.max(sender.arrived_at());
        self.reports.awaited().is_some() && self.timeout.is_none_or(|timeout| now.since(since) < timeout)
    }
}

/// Number of blocks that the control has started: from the port, or at least that many from the control's reports.
fn executed(port: &dyn Port, sender: &Sender, echo: &ReportMonitor) -> Option<usize> {
    port.blocks_executed().or_else(|| echo.reports.taken_up(sender.transmission(), echo.read_ahead))
}

/// Sends until everything has been sent and, if the port can know, executed, or the sending ends otherwise. Closes the
/// journal and restores the terminal.
///
/// # Errors
/// The port can no longer be used, or the journal cannot be written.
pub fn send(
    port: &mut dyn Port,
    sender: &mut Sender,
    mut outbox: Outbox,
    mut services: SendServices<'_>,
) -> Result<(End, Reports), Failure> {
    let ended = send_all(port, sender, &mut outbox, &mut services);
    let known = executed(port, sender, &services.echo);
    let SendServices { mut logbook, mut live, echo, board_session } = services;
    live.show_end(port, sender, known);
    // The terminal is restored before any message.
    drop(live);
    let is_stopped = match &ended {
        Ok(End::Interrupted { at_rest } | End::Differs { at_rest, .. }) => *at_rest,
        Ok(_) => port.control_is_done() == Some(true),
        Err(_) => false,
    };
    let stood = port.blocks_executed().filter(|_| is_stopped);
    let closed = logbook.end(sender, ended.as_ref().map_or(EndReason::Failed, End::how), stood);
    let left = board_session.release();
    match ended {
        Err(Failure::Machine(message)) => {
            let journal = logbook.path().filter(|_| closed.is_ok()).map_or(String::new(), |path| {
                format!("\nThe journal {} knows how far it came: see --resume", path.display())
            });
            Err(Failure::Machine(format!("{message}\n{}{journal}", place(sender, &outbox))))
        }
        ended => {
            closed?;
            left?;
            Ok((ended?, echo.reports))
        }
    }
}

/// Extent of an interrupted transmission, and the remedy at the control.
fn place(sender: &Sender, outbox: &Outbox) -> String {
    let (sent, total) = sender.progress();
    let taken = sent - outbox.len();
    if taken == 0 {
        return "Nothing was sent".into();
    }
    let sending = sender.transmission();
    let blocks = sending.blocks_before(sending.line_at(taken));
    format!(
        "The line has accepted {taken} of {total} characters, {blocks} whole blocks; how much of that has arrived is not known. The \
         control may hold half a block, which the next characters would complete: press RESET there before anything else"
    )
}

fn send_all(
    port: &mut dyn Port,
    sender: &mut Sender,
    outbox: &mut Outbox,
    services: &mut SendServices<'_>,
) -> Result<End, Failure> {
    let SendServices { logbook, live, echo, board_session } = services;
    let interrupted = on_interrupt();
    let (mut damage, mut without_board) = (DamageMonitor::default(), None);
    loop {
        let known = executed(port, sender, echo);
        logbook.follow(sender, known)?;
        // Before the turn: a control that has waited gets characters at once when it continues.
        live.set_board(board_session.state());
        match live.show(port, sender, known) {
            Some(Command::Hold) => sender.hold(),
            Some(Command::Resume) => sender.resume(),
            Some(Command::Abort) => interrupted.store(true, Ordering::Relaxed),
            None => {}
        }
        without_board = without_board.or(board_session.turn(sender));
        board_session.check_standstill(known, sender.transmission());
        let is_out = outbox.turn(port, sender)?;
        let now = port.now();
        let warnings =
            damage.check(now, || port.line_errors()).into_iter().chain(echo.read_printed(now, &sender.take_printed()));
        warnings.chain(board_session.take_messages()).for_each(|warning| live.warn(now, warning));
        let stops = interrupted.load(Ordering::Relaxed) || echo.differs.is_some() || without_board.is_some();
        let is_over = matches!(sender.state(), State::Aborted | State::Sent) && outbox.is_empty();
        if is_over && let Some(why) = without_board.take() {
            return Ok(End::WithoutBoard(why));
        }
        match sender.state() {
            State::Aborted | State::Sent if stops && outbox.is_empty() => {
                return Ok(stopped(port, echo.differs.take()));
            }
            State::Failed(why) => return Ok(End::GivenUp(why)),
            _ if stops => sender.abort(now),
            _ => {}
        }
        // A control that has nothing to execute because of the hold will get more; one in alarm will not.
        let waits_for_us = sender.state() == State::Held && port.machine().alarm.is_none();
        let has_all =
            port.control_is_done().unwrap_or_else(|| is_out && !echo.waits(now, sender) && board_session.is_done());
        if has_all && !waits_for_us {
            logbook.follow(sender, executed(port, sender, echo))?;
            if let Some(line) = echo.reports.awaited() {
                live.warn(now, format!("warning: no report of line {line} has come: look at the control"));
            }
            return Ok(End::Complete);
        }
        let latest = port.now().after(LOOP_MAX);
        port.wait(sender.poll_at().map_or(latest, |at| at.min(latest)));
    }
}

fn stopped(port: &mut dyn Port, differs: Option<String>) -> End {
    let at_rest = port.feed_hold();
    match differs {
        Some(what) => End::Differs { what, at_rest },
        None => End::Interrupted { at_rest },
    }
}
