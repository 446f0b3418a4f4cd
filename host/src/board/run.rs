//! A board during one run: parameters, arming by a person, segments ahead of the control.
//!
//! ```text
//!             link up             parameters accepted        armed, at the board or here
//!  Greeting ----------> Loading ----------------------> Idle ---------------------------> Armed
//!                                                        ^                                  |
//!                                                        +---- the override is taken away --+
//! ```
//!
//! Segments flow from Idle on. Whatever ends the link, or a refusal, ends the run: nothing is tried again by itself.

use std::collections::VecDeque;

use arcfeed_shared::job::Job;
use arcfeed_shared::units::Micros;
use arcfeed_shared::wire::link::{LinkState, SendError};
use arcfeed_shared::wire::message::codes::{RefusalCode, RequestCode, StateCode};
use arcfeed_shared::wire::message::parameters::messages;
use arcfeed_shared::wire::message::{Message, table};

use super::line::Line;
use super::plan::Plan;
use super::standstill::Standstill;
use super::words;
use crate::dnc::transmission::Transmission;
use crate::port::PortError;

/// How long a board may take to answer.
const TIMEOUT: Micros = Micros::from_ms(3_000);
/// The host's number of its one set of a session.
const SET: u32 = 1;
/// How long a goodbye may take.
const GOODBYE_MAX: Micros = Micros::from_ms(500);

/// A board that takes part in a run.
pub struct Board<'p> {
    line: Line<'p>,
    stage: Stage,
    /// When it became that.
    since: Micros,
    /// Parameters still to be sent.
    parameters: VecDeque<Message>,
    plan: Plan,
    /// Messages of the plan handed to the link.
    sent: usize,
    info: Option<table::Info>,
    report: Option<table::Report>,
    /// `executed` of the report before the first segment.
    executed_before: Option<u32>,
    refusal: Option<table::Refused>,
    has_been_engaged: bool,
    standstill: Standstill,
}

/// How far a board has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// It has not answered yet.
    Greeting,
    /// It has parameters on their way.
    Loading,
    /// Its parameters are in force.
    Ready,
}

/// Why a board does not obey the laws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outage {
    /// It was disarmed, or position or link were lost: 100 %, or the dial's.
    Disarmed,
    /// It has a fault: 0 % until a person resets it at the machine.
    Faulted {
        /// As its report names it.
        cause: u8,
    },
}

/// Why a run with a board is over.
#[derive(Debug, thiserror::Error)]
pub enum BoardError {
    /// Its port.
    #[error(transparent)]
    Port(#[from] PortError),
    /// It has not answered, or its link is lost.
    #[error("board: {}", words::link(*.0))]
    Link(LinkState),
    /// It has heard, and does not answer what it was asked.
    #[error("board: no answer to the parameters for {} s", TIMEOUT.to_s())]
    Mute,
    /// It refuses.
    #[error("board: refused message {kind:#04x} ({reference}): {}", words::refusal(*why))]
    Refused {
        /// Kind of the message.
        kind: u8,
        /// As it says.
        reference: u32,
        /// Why.
        why: RefusalCode,
    },
}

impl<'p> Board<'p> {
    /// A board that is not spoken to yet.
    ///
    /// # Errors
    /// A job that no board can be told, in words.
    pub fn new(line: Line<'p>, job: &Job, plan: Plan) -> Result<Self, String> {
        let mut parameters = VecDeque::new();
        messages(job, SET, &mut |message| parameters.push_back(message))
            .map_err(|error| format!("the job cannot be told to a board: {error:?}"))?;
        Ok(Board {
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
            standstill: Standstill::default(),
        })
    }

    /// One turn: hears it, and gives it what it has room for.
    ///
    /// # Errors
    /// The run is over.
    pub fn turn(&mut self) -> Result<(), BoardError> {
        let mut heard = Vec::new();
        self.line.turn(&mut |message| heard.push(message))?;
        heard.into_iter().for_each(|message| self.hear(message));
        self.look_at_the_link()?;
        self.give();
        Ok(self.line.put_out()?)
    }

    fn hear(&mut self, message: Message) {
        match message {
            Message::Info(info) => self.info = Some(info),
            Message::Accepted(accepted) if accepted.set == SET && self.stage == Stage::Loading => {
                self.become_stage(Stage::Ready);
            }
            Message::Refused(refused) => self.refusal = Some(refused),
            Message::Report(report) => {
                self.has_been_engaged |= words::is_engaged(report.state);
                self.report = Some(report);
            }
            _ => {}
        }
    }

    fn look_at_the_link(&mut self) -> Result<(), BoardError> {
        let waited = self.line.now().since(self.since);
        match self.line.link().state() {
            LinkState::Up if self.stage == Stage::Greeting => {
                self.become_stage(Stage::Loading);
                self.parameters.push_front(table::AskInfo {}.into());
            }
            LinkState::Up => {}
            state @ LinkState::Lost(_) => return Err(BoardError::Link(state)),
            state if waited >= TIMEOUT => return Err(BoardError::Link(state)),
            _ => return Ok(()),
        }
        match self.refusal.take() {
            // Asking to arm may be refused: a person reads why, and asks again.
            Some(refused) if refused.kind == arm(0).kind() => self.refusal = Some(refused),
            Some(table::Refused { kind, reference, why }) => return Err(BoardError::Refused { kind, reference, why }),
            None => {}
        }
        if self.stage == Stage::Loading && waited >= TIMEOUT { Err(BoardError::Mute) } else { Ok(()) }
    }

    fn give(&mut self) {
        while let Some(message) = self.parameters.front() {
            match self.line.send(message) {
                Ok(()) => self.parameters.pop_front(),
                Err(_) => return,
            };
        }
        let Some(report) = self.report.filter(|report| self.stage == Stage::Ready && report.set == SET) else { return };
        self.executed_before.get_or_insert(report.executed);
        // No more than it has room for: a move that waits there holds up everything behind it, a request to arm too.
        let until = self.done() + self.info.map_or(0, |info| usize::from(info.capacity).saturating_sub(1));
        while let Some(message) = self.plan.messages(until).get(self.sent) {
            if self.line.send(message).is_err() {
                return;
            }
            self.sent += 1;
        }
    }

    /// Moves that the board has seen done, by its last report.
    fn done(&self) -> usize {
        let executed = self.report.zip(self.executed_before);
        executed.map_or(0, |(now, before)| now.executed.wrapping_sub(before) as usize)
    }

    fn become_stage(&mut self, stage: Stage) {
        (self.stage, self.since) = (stage, self.line.now());
    }

    /// How far the text may go to the control: no block whose move the board does not have, with all that belongs to it.
    pub fn permitted(&self, sending: &Transmission) -> usize {
        let delivered = self.sent.saturating_sub(self.line.link().unacknowledged());
        self.plan.permitted(delivered, sending)
    }

    /// Whether all moves are done, as the board saw it.
    pub fn is_done(&self) -> bool {
        self.executed_before.is_some() && self.done() >= self.plan.moves()
    }

    /// The line of the move that the board waits for the end of, if it stands there though the control has gone on; once for each
    /// standstill. The control has taken up so many blocks.
    pub fn stands_at(&mut self, blocks: usize, sending: &Transmission) -> Option<usize> {
        let (now, done, by_control) = (self.line.now(), self.done(), self.plan.over(blocks, sending));
        let stands = self.standstill.look(now, done, by_control);
        self.plan.line_of(done).filter(|_| stands)
    }

    /// Asks to arm, on behalf of a person who has seen the last report.
    ///
    /// # Errors
    /// There is no report yet, or the link takes nothing now.
    pub fn arm(&mut self) -> Result<(), SendError> {
        let epoch = self.report.ok_or(SendError::Down)?.epoch;
        self.line.send(&arm(epoch))
    }

    /// Why arming was refused, once.
    pub fn take_arm_refusal(&mut self) -> Option<&'static str> {
        self.refusal.take().map(|refused| words::refusal(refused.why))
    }

    /// Whether parameters are in force and the laws may have the override.
    pub fn is_armed(&self) -> bool {
        self.stage == Stage::Ready && self.report.is_some_and(|report| words::is_engaged(report.state))
    }

    /// Why the laws do not have the override any more: a fault, or that it was taken away from them.
    pub fn outage(&self) -> Option<Outage> {
        match self.report {
            Some(report) if report.state == StateCode::Faulted => Some(Outage::Faulted { cause: report.cause }),
            _ => (self.has_been_engaged && !self.is_armed()).then_some(Outage::Disarmed),
        }
    }

    /// How far it has come.
    pub fn stage(&self) -> Stage {
        self.stage
    }

    /// What it is.
    pub fn info(&self) -> Option<&table::Info> {
        self.info.as_ref()
    }

    /// How things stand.
    pub fn report(&self) -> Option<&table::Report> {
        self.report.as_ref()
    }

    /// Its line.
    pub fn line(&self) -> &Line<'p> {
        &self.line
    }

    /// Lets time pass until its next turn.
    pub fn wait(&mut self) {
        self.line.wait();
    }

    /// Gives the override back and says goodbye: a run that ended as it should leaves no alarm.
    ///
    /// # Errors
    /// The port is gone.
    pub fn leave(mut self) -> Result<(), BoardError> {
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
