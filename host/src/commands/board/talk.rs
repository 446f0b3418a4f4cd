//! A conversation with a board: greeting, questions, answers.

use arcfeed_shared::units::Micros;
use arcfeed_shared::wire::link::LinkState;
use arcfeed_shared::wire::message::{Message, table};

use super::super::outcome::Failure;
use crate::board::line::Line;
use crate::board::words;
use crate::port::url::PortUrl;

/// How long a board may take to answer.
const TIMEOUT: Micros = Micros::from_ms(3_000);
/// Heartbeats that make a round trip worth telling.
const LISTEN: Micros = Micros::from_ms(500);

/// A board that answers.
pub struct Talk {
    line: Line<'static>,
    heard: Vec<Message>,
}

impl Talk {
    /// Greets a board.
    ///
    /// # Errors
    /// It does not answer, or cannot be talked to.
    pub fn open(url: &PortUrl, baudrate: u32) -> Result<Self, Failure> {
        let mut talk = Talk { line: Line::open(url, baudrate)?, heard: Vec::new() };
        let started = talk.line.now();
        while !talk.line.is_up() {
            talk.turn()?;
            if talk.line.now().since(started) >= TIMEOUT {
                return Err(Failure::Machine(format!("{}: {}", url.text, words::link(talk.line.link().state()))));
            }
        }
        Ok(talk)
    }

    /// One turn, and a wait.
    fn turn(&mut self) -> Result<(), Failure> {
        let heard = &mut self.heard;
        self.line.turn(&mut |message| heard.push(message))?;
        if let state @ LinkState::Lost(_) = self.line.link().state() {
            return Err(Failure::Machine(format!("board: {}", words::link(state))));
        }
        self.line.wait();
        Ok(())
    }

    /// Asks, and waits for the answer that `wanted` picks.
    ///
    /// # Errors
    /// It refuses, or does not answer.
    pub fn ask<T>(&mut self, question: &Message, wanted: impl Fn(Message) -> Option<T>) -> Result<T, Failure> {
        let started = self.line.now();
        let mut is_asked = false;
        loop {
            is_asked = is_asked || self.line.send(question).is_ok();
            self.turn()?;
            for message in std::mem::take(&mut self.heard) {
                match message {
                    Message::Refused(table::Refused { kind, why, .. }) if kind == question.kind() => {
                        return Err(Failure::Machine(format!("the board refuses: {}", words::refusal(why))));
                    }
                    other => {
                        if let Some(answer) = wanted(other) {
                            return Ok(answer);
                        }
                    }
                }
            }
            if self.line.now().since(started) >= TIMEOUT {
                return Err(Failure::Machine(format!("the board has not answered for {} s", TIMEOUT.to_s())));
            }
        }
    }

    /// Listens for a while: the link learns its round trip.
    ///
    /// # Errors
    /// The link is lost.
    pub fn listen(&mut self) -> Result<(), Failure> {
        let until = self.line.now().after(LISTEN);
        while self.line.now() < until {
            self.turn()?;
        }
        Ok(())
    }

    /// What it has said since it was asked last.
    ///
    /// # Errors
    /// The link is lost.
    pub fn hear(&mut self) -> Result<Vec<Message>, Failure> {
        self.turn()?;
        Ok(std::mem::take(&mut self.heard))
    }

    /// The line.
    pub fn line(&self) -> &Line<'static> {
        &self.line
    }

    /// Says goodbye.
    ///
    /// # Errors
    /// The port is gone.
    pub fn close(self) -> Result<(), Failure> {
        Ok(self.line.close()?)
    }
}
