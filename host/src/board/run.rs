//! Feed board during one run of a program: loading of parameters, arming by a person, moves sent ahead of the control.
//!
//! ```text
//!             link up             parameters accepted        armed, at the board or here
//!  Greeting ----------> Loading ----------------------> Idle ---------------------------> Armed
//!                                                        ^                                  |
//!                                                        +---- the override is taken away --+
//! ```
//!
//! Segments flow from Idle on. A refusal or the end of the link ends the run: nothing is retried automatically.

use std::collections::VecDeque;

use arcfeed_link::link::{LinkState, SendError};
use arcfeed_link::message::codes::{RefusalCode, RequestCode, StateCode};
use arcfeed_link::message::parameters::messages;
use arcfeed_link::message::{Message, table};
use arcfeed_model::job::Job;
use arcfeed_units::Micros;

use super::line::BoardLine;
use super::plan::BoardPlan;
use super::rise::Rise;
use super::standstill::Standstill;
use super::words;
use crate::dnc::transmission::Transmission;
use crate::port::PortError;

/// Longest time in which a board must answer.
const TIMEOUT: Micros = Micros::from_ms(3_000);
/// Number of the only parameter set of a session.
const SET: u32 = 1;
/// Longest time for closing the link.
const GOODBYE_MAX: Micros = Micros::from_ms(500);

/// Feed board that takes part in a run of a program.
pub struct BoardRun<'p> {
    line: BoardLine<'p>,
    stage: Stage,
    /// Time at which it reached this stage.
    since: Micros,
    /// Parameters still to be sent.
    parameters: VecDeque<Message>,
    plan: BoardPlan,
    /// Number of the plan's messages given to the link.
    sent: usize,
    info: Option<table::Info>,
    report: Option<table::Report>,
    /// `executed` of the report before the first segment.
    executed_before: Option<u32>,
    refusal: Option<table::Refused>,
    has_been_engaged: bool,
    rise: Rise,
    standstill: Standstill,
}

/// Progress of a board's start-up, from the handshake to parameters in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The board has not answered the handshake yet.
    Greeting,
    /// The parameters of the job are being sent.
    Loading,
    /// The parameters are in force: the board can be armed.
    Ready,
}

/// Reason why the feed laws of a board do not control the override (any more).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outage {
    /// The board is disarmed, or has lost the position or the link: the override is 100 %, or the value of the
    /// operator's dial.
    Disarmed,
    /// The board has detected a fault: the override is 0 % until a person resets the board at the machine.
    Faulted {
        /// Cause of the fault, as a code in the board's report.
        cause: u8,
    },
}

/// Reason why a run with a board has ended.
#[derive(Debug, thiserror::Error)]
pub enum BoardError {
    /// The port can no longer be used.
    #[error(transparent)]
    Port(#[from] PortError),
    /// The board has not answered, or the link was lost.
    #[error("board: {}", words::link(*.0))]
    Link(LinkState),
    /// The board has acknowledged receipt of the parameters, but has neither accepted nor refused them in time.
    #[error("board: no answer to the parameters for {} s", TIMEOUT.to_s())]
    NoAnswer,
    /// The board has refused a message.
    #[error("board: refused message {kind:#04x} ({reference}): {}", words::refusal(*why))]
    Refused {
        /// Number of the message's kind in the protocol.
        kind: u8,
        /// Number by which the board says which message it refused.
        reference: u32,
        /// Reason for the refusal.
        why: RefusalCode,
    },
}

impl<'p> BoardRun<'p> {
    /// State before the first message: `line` is the link, `job` gives the parameters, `plan` the moves.
    ///
    /// # Errors
    /// The reason why the job cannot be run with a board.
    pub fn new(line: BoardLine<'p>, job: &Job, plan: BoardPlan) -> Result<Self, String> {
        let mut parameters = VecDeque::new();
        messages(job, SET, &mut |message| parameters.push_back(message))
            .map_err(|error| format!("the job cannot be sent to a board: {error:?}"))?;
        Ok(BoardRun {
            line,
            stage: Stage::Greeting,
            since: Micros(0),
            parameters,
            plan,
            sent: 0,
            info: None,
            report: None,
            executed_before: None,
            refusal: None,
            has_been_engaged: false,
            rise: Rise::new(&job.limits),
            standstill: Standstill::default(),
        })
    }

    /// Receives messages, and sends as many as the board has room for. Does not wait; must be called repeatedly.
    ///
    /// # Errors
    /// The run with the board has ended; with the reason.
    pub fn turn(&mut self) -> Result<(), BoardError> {
        let mut heard = Vec::new();
        self.line.turn(&mut |message| heard.push(message))?;
        heard.into_iter().for_each(|message| self.receive(message));
        self.check_link()?;
        self.send_due();
        Ok(self.line.send_due()?)
    }

    fn receive(&mut self, message: Message) {
        match message {
            Message::Info(info) => self.info = Some(info),
            Message::Accepted(accepted) if accepted.set == SET && self.stage == Stage::Loading => {
                self.enter_stage(Stage::Ready);
            }
            Message::Refused(refused) => self.refusal = Some(refused),
            Message::Report(report) => {
                self.has_been_engaged |= words::is_engaged(report.state);
                self.rise.add(self.line.now(), report.override_percent);
                self.report = Some(report);
            }
            _ => {}
        }
    }

    fn check_link(&mut self) -> Result<(), BoardError> {
        let waited = self.line.now().since(self.since);
        match self.line.link().state() {
            LinkState::Up if self.stage == Stage::Greeting => {
                self.enter_stage(Stage::Loading);
                self.parameters.push_front(table::AskInfo {}.into());
            }
            LinkState::Up => {}
            state @ LinkState::Lost(_) => return Err(BoardError::Link(state)),
            state if waited >= TIMEOUT => return Err(BoardError::Link(state)),
            _ => return Ok(()),
        }
        match self.refusal.take() {
            // Arming may be refused: a person reads the reason and asks again.
            Some(refused) if refused.kind == arm(0).kind() => self.refusal = Some(refused),
            Some(table::Refused { kind, reference, why }) => return Err(BoardError::Refused { kind, reference, why }),
            None => {}
        }
        if self.stage == Stage::Loading && waited >= TIMEOUT { Err(BoardError::NoAnswer) } else { Ok(()) }
    }

    fn send_due(&mut self) {
        while let Some(message) = self.parameters.front() {
            match self.line.send(message) {
                Ok(()) => self.parameters.pop_front(),
                Err(_) => return,
            };
        }
        let Some(report) = self.report.filter(|report| self.stage == Stage::Ready && report.set == SET) else { return };
        self.executed_before.get_or_insert(report.executed);
        // Not more than the board has room for: a move that waits there would delay all later messages, a request to
        // arm included.
        let until = self.done() + self.info.map_or(0, |info| usize::from(info.capacity).saturating_sub(1));
        while let Some(message) = self.plan.messages(until).get(self.sent) {
            if self.line.send(message).is_err() {
                return;
            }
            self.sent += 1;
        }
    }

    /// Number of moves that the board has seen done, by its last report.
    fn done(&self) -> usize {
        let executed = self.report.zip(self.executed_before);
        executed.map_or(0, |(now, before)| now.executed.wrapping_sub(before) as usize)
    }

    fn enter_stage(&mut self, stage: Stage) {
        (self.stage, self.since) = (stage, self.line.now());
    }

    /// Offset in the transmission up to which text may be sent to the control: the board must already have the moves of
    /// these blocks, with their engaged arcs.
    pub fn permitted(&self, sending: &Transmission) -> usize {
        let delivered = self.sent.saturating_sub(self.line.link().unacknowledged());
        self.plan.permitted(delivered, sending)
    }

    /// Whether the board has reported the end of all moves.
    pub fn is_done(&self) -> bool {
        self.executed_before.is_some() && self.done() >= self.plan.moves()
    }

    /// For a board that no longer sees the control's moves: index of the line of the move whose end it waits for,
    /// although the control has started `blocks` blocks. `Some` once for each such standstill, otherwise `None`.
    pub fn standstill_line(&mut self, blocks: usize, sending: &Transmission) -> Option<usize> {
        let (now, done, by_control) = (self.line.now(), self.done(), self.plan.over(blocks, sending));
        let stands = self.standstill.check(now, done, by_control);
        self.plan.line_of(done).filter(|_| stands)
    }

    /// Sends a request to arm, for a person who has seen the last report.
    ///
    /// # Errors
    /// There is no report yet, or the link accepts no message now.
    pub fn arm(&mut self) -> Result<(), SendError> {
        let epoch = self.report.ok_or(SendError::Down)?.epoch;
        self.line.send(&arm(epoch))
    }

    /// Reason why the board refused to arm; returned once, then `None`.
    pub fn take_arm_refusal(&mut self) -> Option<&'static str> {
        self.refusal.take().map(|refused| words::refusal(refused.why))
    }

    /// Whether the parameters are in force and the board is armed, so that the laws control the override.
    pub fn is_armed(&self) -> bool {
        self.stage == Stage::Ready && self.report.is_some_and(|report| words::is_engaged(report.state))
    }

    /// Whether the board is armed and its override, which begins at 0 % after power-on, no longer rises: then the
    /// first block gets its full feed.
    pub fn is_ready(&self) -> bool {
        self.is_armed() && self.rise.has_ended(self.line.now())
    }

    /// Reason why the laws do not control the override any more; `None` while they do, and before the first arming.
    pub fn outage(&self) -> Option<Outage> {
        match self.report {
            Some(report) if report.state == StateCode::Faulted => Some(Outage::Faulted { cause: report.cause }),
            _ => (self.has_been_engaged && !self.is_armed()).then_some(Outage::Disarmed),
        }
    }

    /// Progress of the start-up.
    pub fn stage(&self) -> Stage {
        self.stage
    }

    /// Identification of the board; `None` before it has sent it.
    pub fn info(&self) -> Option<&table::Info> {
        self.info.as_ref()
    }

    /// Latest report of the board; `None` before the first.
    pub fn report(&self) -> Option<&table::Report> {
        self.report.as_ref()
    }

    /// Link to the board.
    pub fn line(&self) -> &BoardLine<'p> {
        &self.line
    }

    /// Waits until the run must be served again.
    pub fn wait(&mut self) {
        self.line.wait();
    }

    /// Disarms the board and closes the link, so that a completed run leaves no alarm.
    ///
    /// # Errors
    /// The port can no longer be used.
    pub fn release(mut self) -> Result<(), BoardError> {
        let disarm = table::Request { what: RequestCode::Disarm, epoch: 0 }.into();
        let started = self.line.now();
        let mut is_asked = false;
        while self.line.is_up() && self.line.now().since(started) < GOODBYE_MAX {
            is_asked = is_asked || self.line.send(&disarm).is_ok();
            self.line.turn(&mut |_| {})?;
            if is_asked && self.line.link().unacknowledged() == 0 {
                break;
            }
            self.line.wait();
        }
        Ok(self.line.close()?)
    }
}

fn arm(epoch: u16) -> Message {
    table::Request { what: RequestCode::Arm, epoch }.into()
}
