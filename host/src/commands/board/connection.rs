//! Connection to a feed board for single requests and their answers.

use arcfeed_link::link::LinkState;
use arcfeed_link::message::{Message, table};
use arcfeed_units::Micros;

use super::super::outcome::Failure;
use crate::board::line::BoardLine;
use crate::board::words;
use crate::port::url::PortUrl;

/// Longest time in which a board must answer.
const TIMEOUT: Micros = Micros::from_ms(3_000);
/// Time with enough heartbeats for a measured round trip.
const LISTEN: Micros = Micros::from_ms(500);

/// Connection to a feed board.
pub struct BoardConnection {
    line: BoardLine<'static>,
    heard: Vec<Message>,
}

impl BoardConnection {
    /// Connects to the board at this port.
    ///
    /// # Errors
    /// It does not answer, or is incompatible.
    pub fn open(url: &PortUrl, baudrate: u32) -> Result<Self, Failure> {
        let mut connection = BoardConnection { line: BoardLine::open(url, baudrate)?, heard: Vec::new() };
        let started = connection.line.now();
        while !connection.line.is_up() {
            connection.turn()?;
            if connection.line.now().since(started) >= TIMEOUT {
                return Err(Failure::Machine(format!("{}: {}", url.text, words::link(connection.line.link().state()))));
            }
        }
        Ok(connection)
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

    /// Sends `question` and waits for the message for which `wanted` returns a value: the answer.
    ///
    /// # Errors
    /// The board refuses, or does not answer.
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

    /// Exchanges heartbeats for a while, from which the link measures its round-trip time.
    ///
    /// # Errors
    /// The link is lost.
    pub fn measure_round_trip(&mut self) -> Result<(), Failure> {
        let until = self.line.now().after(LISTEN);
        while self.line.now() < until {
            self.turn()?;
        }
        Ok(())
    }

    /// Messages that the board has sent since the last request, reports for instance.
    ///
    /// # Errors
    /// The link is lost.
    pub fn take_messages(&mut self) -> Result<Vec<Message>, Failure> {
        self.turn()?;
        Ok(std::mem::take(&mut self.heard))
    }

    /// Link to the board.
    pub fn line(&self) -> &BoardLine<'static> {
        &self.line
    }

    /// Closes the link.
    ///
    /// # Errors
    /// The port can no longer be used.
    pub fn close(self) -> Result<(), Failure> {
        Ok(self.line.close()?)
    }
}
