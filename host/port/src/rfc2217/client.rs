//! Client side of RFC 2217, without I/O: the bytes to send, and the state of the negotiation.
//!
//! ```text
//!            DO 44              all answered           last answered
//! Telnet ------------> Settings ------------> Controls -------------> Open
//!    |                    |                      |
//!    +--------------------+----------------------+--> NegotiationError: refused, or not answered in time
//! ```
//! Settings go out together, controls one by one, because their answers have the same code. The order is pyserial's.
//! The server's received data are not purged: the control may have sent DC1 already, and sends it once.

use std::collections::VecDeque;

use arcfeed_units::{Micros, US_PER_S};

use super::com_port::{
    ANSWER, COM_PORT, NOTIFY_MODEMSTATE, OPTIONS, PURGE_DATA, RESUME, SET_BAUDRATE, SET_CONTROL, SET_DATASIZE,
    SET_PARITY, SET_STOPSIZE, SUSPEND, parity_code,
};
use super::telnet::{Decoder, Event, Verb, say, subnegotiate};
use crate::settings::SerialSettings;
use crate::url::Rfc2217Options;

/// Largest age of the known state of the modem lines, that of pyserial.
const MODEM_STATE_AGE: Micros = Micros::from_ms(300);

/// Settings that the client requests for the server's serial line.
#[derive(Clone, Copy, Debug)]
pub struct RequestedLine {
    baudrate: u32,
    bytesize: u8,
    parity: u8,
    stopbits: u8,
    rtscts: bool,
}

impl RequestedLine {
    /// Requests for the settings of the job. XON/XOFF of the server is requested off: the sender does it itself and
    /// must see DC1 and DC3.
    pub fn new(settings: &SerialSettings) -> Self {
        let SerialSettings { baudrate, bytesize, stopbits, rtscts, .. } = *settings;
        RequestedLine { baudrate, bytesize, parity: parity_code(settings.parity), stopbits, rtscts }
    }

    fn settings(&self) -> Vec<Request> {
        vec![
            Request::new("baudrate", SET_BAUDRATE, &self.baudrate.to_be_bytes()),
            Request::new("bytesize", SET_DATASIZE, &[self.bytesize]),
            Request::new("parity", SET_PARITY, &[self.parity]),
            Request::new("stopbits", SET_STOPSIZE, &[self.stopbits]),
        ]
    }

    fn controls(&self) -> VecDeque<Request> {
        let (none, hardware, dtr_on, rts_on) = (1, 3, 8, 11);
        let flow = if self.rtscts { hardware } else { none };
        let mut all = VecDeque::from([Request::new("flow control", SET_CONTROL, &[flow])]);
        all.push_back(Request::new("DTR", SET_CONTROL, &[dtr_on]));
        if !self.rtscts {
            all.push_back(Request::new("RTS", SET_CONTROL, &[rts_on]));
        }
        all.push_back(Request::new("purge of what is to be sent", PURGE_DATA, &[2]));
        all
    }
}

/// Request to the server.
#[derive(Clone, Debug)]
struct Request {
    name: &'static str,
    code: u8,
    value: Vec<u8>,
    answered: bool,
}

impl Request {
    fn new(name: &'static str, code: u8, value: &[u8]) -> Self {
        Request { name, code, value: value.to_vec(), answered: false }
    }
}

/// Reason why a connection to an RFC 2217 server cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NegotiationError {
    /// The server refuses COM-PORT-OPTION, or does not answer.
    #[error("the server does not speak RFC 2217{}; for bare TCP write socket://host:port", if *.silent { " or is slower than timeout" } else { "" })]
    NotSpoken {
        /// The server did not answer at all (true), or refused the option (false).
        silent: bool,
    },
    /// The server answered a setting with another value.
    #[error("the server refused {name}: it has {has:?} where {wanted:?} was asked for; change [serial] in the job")]
    Setting {
        /// Name of the setting, as in pyserial.
        name: &'static str,
        /// Value that the client requested, as the bytes of the request.
        wanted: Vec<u8>,
        /// Value that the server answered.
        has: Vec<u8>,
    },
    /// The server did not answer a request within the time-out.
    #[error("the server did not answer about {name}; give it longer (?timeout=10){}", if *.is_control { " or do not ask (?ign_set_control)" } else { "" })]
    Late {
        /// Name of the request, as in pyserial.
        name: &'static str,
        /// The request is a SET-CONTROL, which some servers never answer.
        is_control: bool,
    },
}

#[derive(Clone, Debug)]
enum State {
    Telnet,
    Settings(Vec<Request>),
    Controls(VecDeque<Request>),
    Open,
}

/// Negotiation of an option at one end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Desired {
    Asked,
    Agreed,
    Refused,
}

/// Client's end of an RFC 2217 connection, without I/O.
#[derive(Clone, Debug)]
pub struct Rfc2217Client {
    decoder: Decoder,
    /// Options of both ends, in the order of [`OPTIONS`].
    desired: [[Desired; OPTIONS.len()]; 2],
    line: RequestedLine,
    state: State,
    deadline: Micros,
    timeout: Micros,
    ign_set_control: bool,
    poll_modem: bool,
    modem_state: Option<u8>,
    modem_asked: Micros,
    suspended: bool,
    refusal: Option<NegotiationError>,
    data: VecDeque<u8>,
    outgoing: Vec<u8>,
}

impl Rfc2217Client {
    /// Client whose connection was made at `now`.
    pub fn new(line: &RequestedLine, options: &Rfc2217Options, now: Micros) -> Self {
        let mut outgoing = Vec::new();
        for option in OPTIONS {
            say(Verb::Will, option, &mut outgoing);
            say(Verb::Do, option, &mut outgoing);
        }
        let timeout = Micros((options.timeout_s * US_PER_S as f64) as u64);
        Rfc2217Client {
            decoder: Decoder::default(),
            desired: [[Desired::Asked; OPTIONS.len()]; 2],
            line: *line,
            state: State::Telnet,
            deadline: now.after(timeout),
            timeout,
            ign_set_control: options.ign_set_control,
            poll_modem: options.poll_modem,
            modem_state: None,
            modem_asked: now,
            suspended: false,
            refusal: None,
            data: VecDeque::new(),
            outgoing,
        }
    }

    /// Processes bytes received from the server at the time `now`.
    pub fn on_bytes(&mut self, now: Micros, bytes: &[u8]) {
        for &byte in bytes {
            match self.decoder.on_byte(byte) {
                Some(Event::Data(byte)) => self.data.push_back(byte),
                Some(Event::Option(verb, option)) => self.on_option(verb, option),
                Some(Event::Subnegotiation(body)) => self.on_subnegotiation(&body),
                Some(Event::Command(_)) | None => {}
            }
        }
        self.advance(now);
    }

    fn on_option(&mut self, verb: Verb, option: u8) {
        let (end, yes, no) = match verb {
            Verb::Do | Verb::Dont => (0, Verb::Will, Verb::Wont),
            Verb::Will | Verb::Wont => (1, Verb::Do, Verb::Dont),
        };
        let wanted = matches!(verb, Verb::Do | Verb::Will);
        let known = OPTIONS.iter().position(|known| *known == option);
        let Some(desired) = known.map(|at| &mut self.desired[end][at]) else {
            if wanted {
                say(no, option, &mut self.outgoing);
            }
            return;
        };
        match (*desired, wanted) {
            (Desired::Asked, _) | (Desired::Agreed, true) | (Desired::Refused, false) => {}
            (Desired::Agreed, false) => say(no, option, &mut self.outgoing),
            (Desired::Refused, true) => say(yes, option, &mut self.outgoing),
        }
        *desired = if wanted { Desired::Agreed } else { Desired::Refused };
    }

    fn on_subnegotiation(&mut self, body: &[u8]) {
        let [COM_PORT, code, value @ ..] = body else { return };
        // pyserial's own server sends these two with the code of a request.
        match (*code, value) {
            (code, [state, ..]) if code == NOTIFY_MODEMSTATE + ANSWER => self.modem_state = Some(*state),
            (code, _) if code == SUSPEND || code == SUSPEND + ANSWER => self.suspended = true,
            (code, _) if code == RESUME || code == RESUME + ANSWER => self.suspended = false,
            (code, value) => self.on_answer(code, value),
        }
    }

    fn on_answer(&mut self, code: u8, value: &[u8]) {
        let request = match &mut self.state {
            State::Settings(all) => all.iter_mut().find(|request| request.code + ANSWER == code),
            State::Controls(left) => left.front_mut().filter(|request| request.code + ANSWER == code),
            State::Telnet | State::Open => None,
        };
        let Some(request) = request else { return };
        if value.starts_with(&request.value) {
            request.answered = true;
        } else if !(self.ign_set_control && request.code == SET_CONTROL) {
            let Request { name, value: wanted, .. } = request.clone();
            self.refusal =
                self.refusal.take().or(Some(NegotiationError::Setting { name, wanted, has: value.to_vec() }));
        }
    }

    /// Continues with the next stage once everything is answered.
    fn advance(&mut self, now: Micros) {
        match &mut self.state {
            State::Telnet => match self.desired[0][0] {
                Desired::Agreed => {
                    let settings = self.line.settings();
                    settings.iter().for_each(|request| ask(request, &mut self.outgoing));
                    self.state = State::Settings(settings);
                    self.deadline = now.after(self.timeout);
                }
                Desired::Refused => self.refusal = Some(NegotiationError::NotSpoken { silent: false }),
                Desired::Asked => {}
            },
            State::Settings(all) if all.iter().all(|request| request.answered) => {
                self.state = State::Controls(self.line.controls());
                self.next_control(now);
            }
            State::Controls(left) => {
                if left.front().is_none_or(|request| request.answered) {
                    left.pop_front();
                    self.next_control(now);
                }
            }
            State::Settings(_) | State::Open => {}
        }
    }

    /// Sends the next control; a control whose answer is ignored is done at once.
    fn next_control(&mut self, now: Micros) {
        let State::Controls(left) = &mut self.state else { return };
        self.deadline = now.after(self.timeout);
        while let Some(request) = left.front() {
            ask(request, &mut self.outgoing);
            if !(self.ign_set_control && request.code == SET_CONTROL) {
                return;
            }
            left.pop_front();
        }
        self.state = State::Open;
    }

    /// Fails if the negotiation can no longer succeed; otherwise queues a request for the state of the modem lines when
    /// it is due.
    ///
    /// # Errors
    /// The server refused the option or a setting, or has not answered in time.
    pub fn check(&mut self, now: Micros) -> Result<(), NegotiationError> {
        if let Some(refusal) = &self.refusal {
            return Err(refusal.clone());
        }
        let late = match &self.state {
            State::Telnet => Some(NegotiationError::NotSpoken { silent: true }),
            State::Settings(all) => all.iter().find(|request| !request.answered).map(late),
            State::Controls(left) => left.front().map(late),
            State::Open => None,
        };
        if let Some(late) = late {
            return if now >= self.deadline { Err(late) } else { Ok(()) };
        }
        if self.poll_modem && now.since(self.modem_asked) >= MODEM_STATE_AGE {
            self.modem_asked = now;
            subnegotiate(COM_PORT, NOTIFY_MODEMSTATE, &[], &mut self.outgoing);
        }
        Ok(())
    }

    /// Moves the bytes to be sent to the server to the end of `out`.
    pub fn poll_transmit(&mut self, out: &mut Vec<u8>) {
        out.append(&mut self.outgoing);
    }

    /// Moves data received from the serial line into `buffer`; returns their number.
    pub fn take_data(&mut self, buffer: &mut [u8]) -> usize {
        let len = buffer.len().min(self.data.len());
        for (slot, byte) in buffer.iter_mut().zip(self.data.drain(..len)) {
            *slot = byte;
        }
        len
    }

    /// Whether the negotiation is complete: the line is open with the requested settings.
    pub fn is_open(&self) -> bool {
        matches!(self.state, State::Open)
    }

    /// Whether the server has asked the client to send no data for the present.
    pub fn is_suspended(&self) -> bool {
        self.suspended
    }

    /// State of the modem lines that the server last reported (CD, RI, DSR, CTS in bits 7 to 4); `None` before its
    /// first report.
    pub fn modem_state(&self) -> Option<u8> {
        self.modem_state
    }
}

fn ask(request: &Request, out: &mut Vec<u8>) {
    subnegotiate(COM_PORT, request.code, &request.value, out);
}

fn late(request: &Request) -> NegotiationError {
    NegotiationError::Late { name: request.name, is_control: request.code == SET_CONTROL }
}

#[cfg(test)]
mod tests;
