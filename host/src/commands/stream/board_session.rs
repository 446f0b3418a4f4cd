//! Session of a feed board while a program is sent: connection, moves ahead of the control, arming by a person,
//! supervision.

use std::io::BufRead;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, channel};

use arcfeed_model::job::Job;

use super::super::outcome::{Failure, on_interrupt};
use super::preparation::PreparedProgram;
use crate::adapt::Known;
use crate::board::line::BoardLine;
use crate::board::plan::{BoardPlan, PlanError};
use crate::board::run::{BoardRun, Outage, Stage};
use crate::board::standstill::TIMEOUT;
use crate::board::words;
use crate::console::note;
use crate::dnc::Sender;
use crate::dnc::sender::Gate;
use crate::dnc::transmission::Transmission;

/// Word that a person types to arm the board.
pub const ARM: &str = "arm";

/// Place where a person arms the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arming {
    /// At the board's button, or by typing `arm` here.
    Typed,
    /// Only at the board's button: the keyboard belongs to the screen.
    Button,
    /// Nowhere: the board and its button are simulated.
    Simulated,
}

/// Feed board during a transmission, or none.
pub struct BoardSession<'p> {
    board: Option<BoardRun<'p>>,
    arming: Arming,
    person: Option<Receiver<String>>,
    /// Last reported reason why the laws do not have the override.
    outage: Option<Outage>,
    /// Messages that have not been shown yet.
    said: Vec<String>,
}

impl<'p> BoardSession<'p> {
    /// Session without a board.
    pub fn none() -> Self {
        BoardSession { board: None, arming: Arming::Simulated, person: None, outage: None, said: Vec::new() }
    }

    /// Session with the board at the other end of `line`, which gets the moves of the transmission.
    ///
    /// # Errors
    /// The job or a move does not suit a board.
    pub fn with(
        line: BoardLine<'p>,
        ready: &PreparedProgram,
        sending: &Transmission,
        arming: Arming,
    ) -> Result<Self, Failure> {
        let job: &Job = &ready.file.job;
        let path = ready.file.program.display();
        let known = Known { places: ready.program.places.as_deref(), ..Known::of(&ready.file) };
        let plan = BoardPlan::new(sending, &ready.power_on(), job, known, &ready.bounds)
            .map_err(|PlanError { source, why }| Failure::Input(format!("{path}:{source}:1: error: {why}")))?;
        let board = BoardRun::new(line, job, plan).map_err(Failure::Input)?;
        let person = (arming == Arming::Typed).then(typed_lines);
        Ok(BoardSession { board: Some(board), arming, person, outage: None, said: Vec::new() })
    }

    /// Waits until the board has its parameters, is armed, and its override has risen; before that nothing is sent to the control. Calls
    /// `press` repeatedly meanwhile, which operates the panel of a simulated board.
    ///
    /// # Errors
    /// The board does not answer or refuses, or the operator stopped it.
    pub fn arm(&mut self, press: &mut dyn FnMut()) -> Result<(), Failure> {
        let interrupted = on_interrupt();
        let mut asked = None;
        while let Some(board) = self.board.as_mut().filter(|board| !board.is_ready()) {
            board.turn().map_err(|error| Failure::Machine(error.to_string()))?;
            if interrupted.load(Ordering::Relaxed) {
                return Err(Failure::Stopped(
                    "stopped by the operator: the board was not armed, nothing was sent".into(),
                ));
            }
            let outage = board.outage();
            if board.stage() == Stage::Ready && asked != Some(outage) && board.report().is_some() {
                asked = Some(outage);
                if self.arming != Arming::Simulated && !board.is_armed() {
                    self.said.push(words_of(board, outage, self.arming));
                }
            }
            press();
            board.wait();
            self.read_person_command();
            self.said.drain(..).for_each(|line| note(format_args!("{line}")));
        }
        Ok(())
    }

    /// Serves the link without waiting, and permits the sender the text whose moves the board has. Returns the reason if the run must end.
    pub fn turn(&mut self, sender: &mut Sender) -> Option<String> {
        self.read_person_command();
        let board = self.board.as_mut()?;
        if let Err(error) = board.turn() {
            // The permissions of the board are void; blocks that have left, have left.
            self.board = None;
            return Some(error.to_string());
        }
        let until = board.permitted(sender.transmission());
        sender.permit(Gate::Board, until);
        let outage = board.outage();
        if outage.is_some() && outage != self.outage {
            self.said.push(words_of(board, outage, self.arming));
        }
        self.outage = outage;
        None
    }

    /// State of the board as text; `None` without a board.
    pub fn state(&self) -> Option<&'static str> {
        Some(self.board.as_ref()?.report().map_or("silent", |report| words::state(report.state)))
    }

    /// Messages for the operator that have not been returned yet.
    pub fn take_messages(&mut self) -> Vec<String> {
        std::mem::take(&mut self.said)
    }

    /// Adds a message if the board sees no more ends of moves although the control continues; `blocks` is the number of blocks that the
    /// control has started.
    pub fn check_standstill(&mut self, blocks: Option<usize>, sending: &Transmission) {
        let stands = self.board.as_mut().zip(blocks).and_then(|(board, blocks)| board.standstill_line(blocks, sending));
        let Some(line) = stands else { return };
        let source = sending.lines().get(line).map_or(0, |line| line.source);
        self.said.push(format!(
            "warning: the board has stood for {} s at the move of line {source}, and the control is past it: the board has not seen \
             its end. The override stays at 100 %, and no more leaves than the board has room for. Check the position that it \
             gets; then stop, and go on with --resume",
            TIMEOUT.to_s()
        ));
    }

    /// Whether the board has reported the end of all moves; true without a board.
    pub fn is_done(&self) -> bool {
        self.board.as_ref().is_none_or(BoardRun::is_done)
    }

    /// Disarms the board and closes the link.
    ///
    /// # Errors
    /// The port can no longer be used.
    pub fn release(self) -> Result<(), Failure> {
        match self.board {
            Some(board) => board.release().map_err(|error| Failure::Machine(error.to_string())),
            None => Ok(()),
        }
    }

    fn read_person_command(&mut self) {
        let (Some(board), Some(person)) = (&mut self.board, &self.person) else { return };
        for line in person.try_iter() {
            match line.trim() {
                ARM => {
                    if board.arm().is_err() {
                        self.said
                            .push(format!("the board has not said yet how things stand: look, and type {ARM} again"));
                    }
                }
                "" => {}
                other => self.said.push(format!("`{other}` means nothing here; {ARM} arms the board")),
            }
        }
        if let Some(why) = board.take_arm_refusal() {
            self.said.push(format!("the board is not armed: {why}"));
        }
    }
}

/// Message about a board whose laws do not have the override.
fn words_of(board: &BoardRun<'_>, outage: Option<Outage>, arming: Arming) -> String {
    let how = how_to_arm(board, arming);
    match outage {
        None => how,
        Some(Outage::Disarmed) => format!("note: {how}; the program continues at its own feeds"),
        Some(Outage::Faulted { cause }) => format!(
            "warning: the board has a fault: {}. It puts out 0 %: feed moves stand still, as at feed hold (rapids do not), until a person \
             has removed the cause and pressed RESET at the board; from then on the dial has the override, and the program continues at its \
             own feeds. To continue under the laws: {how}",
            words::fault(cause)
        ),
    }
}

fn how_to_arm(board: &BoardRun<'_>, arming: Arming) -> String {
    let state = board.report().map_or("silent", |report| words::state(report.state));
    let or_here = if arming == Arming::Typed { format!(", or type {ARM} and Enter here") } else { String::new() };
    format!(
        "the board is {state}. Look at the machine: dial at 100 %, the right tool, the program's zero set at the board. \
         Then press ARM there{or_here}"
    )
}

/// Channel that receives the lines which a person types on stdin.
pub fn typed_lines() -> Receiver<String> {
    let (lines, typed_lines) = channel();
    std::thread::spawn(move || {
        for line in std::io::stdin().lock().lines().map_while(Result::ok) {
            if lines.send(line).is_err() {
                return;
            }
        }
    });
    typed_lines
}
