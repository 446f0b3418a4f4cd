//! Server side of RFC 2217, without I/O: a serial port offered to a client.
//!
//! ```text
//!            DO or WILL 44          settings, controls         first data, or 200 ms of silence
//! Telnet ------------------> Agreed -------------------> Agreed ----------------------> Open
//! ```
//! The line opens only when the client has sent all its requests: pyserial purges received data as its last step, and a
//! control that had sent DC1 before would wait for ever. If the client requests XON/XOFF of the server, DC1 and DC3 of
//! the control stop the server and are not passed on, as in a driver; otherwise they are data like all others.

use std::collections::VecDeque;

use arcfeed_units::Micros;

use super::com_port::{
    ANSWER, COM_PORT, NOTIFY_LINESTATE, NOTIFY_MODEMSTATE, OPTIONS, PURGE_DATA, RESUME, SET_BAUDRATE, SET_CONTROL,
    SET_DATASIZE, SET_LINESTATE_MASK, SET_MODEMSTATE_MASK, SET_PARITY, SET_STOPSIZE, SIGNATURE, SUSPEND, parity_code,
};
use super::telnet::{Decoder, Event, Verb, escape, say, subnegotiate};
use crate::settings::SerialSettings;

/// State of the control's modem lines: carrier, DSR and CTS on.
const MODEM_LINES: u8 = 0xb0;
/// Time after the last request of a client until the line opens.
const SETTLE: Micros = Micros::from_ms(200);
/// One break is an alarm; more of them need not be counted.
const BREAKS_MAX: usize = 16;
const DC1: u8 = 0x11;
const DC3: u8 = 0x13;

/// Flow control of the server's serial port, as the client has requested it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// No flow control by the server: DC1 and DC3 are passed on to the client.
    None,
    /// The server itself stops at the control's DC3 and continues at its DC1; the client does not see them.
    XonXoff,
    /// RTS/CTS. The line here has no such signals, therefore CTS always counts as on.
    Hardware,
}

/// Settings of the serial port that the client has requested, named as in pyserial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PortSettings {
    /// Bits per second.
    pub baudrate: u32,
    /// Number of data bits, 5 to 8.
    pub bytesize: u8,
    /// Parity as a code of RFC 2217: 1 none, 2 odd, 3 even, 4 mark, 5 space.
    pub parity: u8,
    /// Stop bits as a code of RFC 2217: 1, 2, or 3 for one and a half.
    pub stopbits: u8,
    /// Flow control, from the values 1 to 3 of SET-CONTROL.
    pub flow: Flow,
}

impl PortSettings {
    /// Whether a control whose line has the settings `line` would understand this port. A wrong number of stop bits
    /// does not matter.
    pub fn is_understood_by(&self, line: &SerialSettings) -> bool {
        (self.baudrate, self.bytesize, self.parity) == (line.baudrate, line.bytesize, parity_code(line.parity))
    }
}

/// Server's end of an RFC 2217 connection with one client, without I/O: the caller moves the bytes.
#[derive(Clone, Debug)]
pub struct Server {
    decoder: Decoder,
    settings: PortSettings,
    /// Options for which the server has sent WILL and DO.
    agreed: [Vec<u8>; 2],
    /// Time of the client's last request; `None` before the negotiation.
    asked: Option<Micros>,
    breaks: usize,
    /// The control has sent DC3, and the server stops.
    is_stopped: bool,
    /// The client accepts no data now.
    is_suspended: bool,
    from_client: VecDeque<u8>,
    to_client: Vec<u8>,
    outgoing: Vec<u8>,
}

impl Server {
    /// State for a client that has just connected. The port has the settings `line` until the client requests others.
    pub fn new(line: &SerialSettings) -> Self {
        let SerialSettings { baudrate, bytesize, stopbits, .. } = *line;
        Server {
            decoder: Decoder::default(),
            settings: PortSettings { baudrate, bytesize, parity: parity_code(line.parity), stopbits, flow: Flow::None },
            agreed: [Vec::new(), Vec::new()],
            asked: None,
            breaks: 0,
            is_stopped: false,
            is_suspended: false,
            from_client: VecDeque::new(),
            to_client: Vec::new(),
            outgoing: Vec::new(),
        }
    }

    /// Processes bytes received from the client at the time `now`.
    pub fn on_bytes(&mut self, now: Micros, bytes: &[u8]) {
        for &byte in bytes {
            match self.decoder.on_byte(byte) {
                Some(Event::Data(byte)) => self.from_client.push_back(byte),
                Some(Event::Option(verb, option)) => self.on_option(now, verb, option),
                Some(Event::Subnegotiation(body)) => {
                    if let [COM_PORT, code, value @ ..] = &body[..] {
                        self.asked = Some(now);
                        self.on_request(*code, value);
                    }
                }
                Some(Event::Command(_)) | None => {}
            }
        }
    }

    /// Accepts a supported option, once; refuses the rest.
    fn on_option(&mut self, now: Micros, verb: Verb, option: u8) {
        let (end, yes, no) = match verb {
            Verb::Do | Verb::Dont => (0, Verb::Will, Verb::Wont),
            Verb::Will | Verb::Wont => (1, Verb::Do, Verb::Dont),
        };
        let is_wanted = matches!(verb, Verb::Do | Verb::Will);
        let agreed = &mut self.agreed[end];
        match (is_wanted, agreed.iter().position(|known| *known == option)) {
            (true, Some(_)) | (false, None) => {}
            (true, None) if OPTIONS.contains(&option) => {
                agreed.push(option);
                say(yes, option, &mut self.outgoing);
            }
            (true, None) => say(no, option, &mut self.outgoing),
            (false, Some(at)) => {
                agreed.remove(at);
                say(no, option, &mut self.outgoing);
            }
        }
        if option == COM_PORT && is_wanted {
            if self.asked.is_none() {
                // These values will not change, and a client that does not ask expects one report of them.
                self.answer(NOTIFY_MODEMSTATE, &[MODEM_LINES]);
            }
            self.asked = Some(now);
        }
    }

    fn on_request(&mut self, code: u8, value: &[u8]) {
        let settings = &mut self.settings;
        match (code, value) {
            (SIGNATURE, []) => self.answer(code, b"arcfeed serve"),
            (SET_BAUDRATE, &[a, b, c, d]) => {
                let wanted = u32::from_be_bytes([a, b, c, d]);
                // 0 is a query.
                settings.baudrate = if wanted == 0 { settings.baudrate } else { wanted };
                let has = settings.baudrate.to_be_bytes();
                self.answer(code, &has);
            }
            (SET_DATASIZE, &[wanted]) => {
                settings.bytesize = if (5..=8).contains(&wanted) { wanted } else { settings.bytesize };
                let has = settings.bytesize;
                self.answer(code, &[has]);
            }
            (SET_PARITY, &[wanted]) => {
                settings.parity = if (1..=5).contains(&wanted) { wanted } else { settings.parity };
                let has = settings.parity;
                self.answer(code, &[has]);
            }
            (SET_STOPSIZE, &[wanted]) => {
                settings.stopbits = if (1..=3).contains(&wanted) { wanted } else { settings.stopbits };
                let has = settings.stopbits;
                self.answer(code, &[has]);
            }
            (SET_CONTROL, &[wanted]) => {
                let has = self.control(wanted);
                self.answer(code, &[has]);
            }
            (NOTIFY_LINESTATE, _) => self.answer(code, &[0]),
            (NOTIFY_MODEMSTATE, _) => self.answer(code, &[MODEM_LINES]),
            (SUSPEND, _) => self.is_suspended = true,
            (RESUME, _) => self.is_suspended = false,
            (SET_LINESTATE_MASK | SET_MODEMSTATE_MASK, &[mask]) => self.answer(code, &[mask]),
            (PURGE_DATA, &[what @ 1..=3]) => {
                if what & 2 != 0 {
                    self.from_client.clear();
                }
                if what & 1 != 0 {
                    self.to_client.clear();
                }
                self.answer(code, &[what]);
            }
            _ => {}
        }
    }

    /// Answer to a SET-CONTROL.
    fn control(&mut self, wanted: u8) -> u8 {
        self.settings.flow = match wanted {
            1 => Flow::None,
            2 => Flow::XonXoff,
            3 => Flow::Hardware,
            _ => self.settings.flow,
        };
        match wanted {
            0..=3 => {
                self.is_stopped &= self.settings.flow == Flow::XonXoff;
                self.settings.flow as u8 + 1
            }
            // Break: off, on, off. DTR and RTS: on, until they are set; the other end ignores them.
            4 => 6,
            5 => {
                self.breaks = BREAKS_MAX.min(self.breaks + 1);
                5
            }
            7 => 8,
            10 => 11,
            // Inbound flow control is always that of the outbound direction.
            13..=19 => 14 + self.settings.flow as u8,
            other => other,
        }
    }

    fn answer(&mut self, code: u8, value: &[u8]) {
        subnegotiate(COM_PORT, code + ANSWER, value, &mut self.outgoing);
    }

    /// Whether the client has sent a request about a serial port (COM-PORT-OPTION) yet.
    pub fn has_asked(&self) -> bool {
        self.asked.is_some()
    }

    /// Number of characters and bytes of answers that wait for [`Server::poll_transmit`].
    pub fn unsent(&self) -> usize {
        self.outgoing.len() + self.to_client.len()
    }

    /// Whether the client has finished its requests: it has sent data, or has requested nothing for 200 ms.
    pub fn is_open(&self, now: Micros) -> bool {
        self.asked.is_some_and(|asked| !self.from_client.is_empty() || now.since(asked) >= SETTLE)
    }

    /// Settings that the client has requested for the port.
    pub fn settings(&self) -> PortSettings {
        self.settings
    }

    /// Number of characters from the client that [`Server::next_for_line`] has not returned yet.
    pub fn waiting(&self) -> usize {
        self.from_client.len()
    }

    /// Takes the next character of the client for the serial line; `None` if there is none or the control has stopped
    /// the server by DC3.
    pub fn next_for_line(&mut self) -> Option<u8> {
        if self.is_stopped { None } else { self.from_client.pop_front() }
    }

    /// Number of break signals that the client has requested since the last call.
    pub fn take_breaks(&mut self) -> usize {
        std::mem::take(&mut self.breaks)
    }

    /// Passes on a character that the control has sent, or follows it if it is DC1 or DC3 and the server does XON/XOFF.
    /// The eighth bit may be parity.
    pub fn on_line(&mut self, byte: u8) {
        match (self.settings.flow, byte & 0x7f) {
            (Flow::XonXoff, DC3) => self.is_stopped = true,
            (Flow::XonXoff, DC1) => self.is_stopped = false,
            _ => self.to_client.push(byte),
        }
    }

    /// Moves the bytes to be sent to the client to the end of `out`; data of the line only if the client has not
    /// suspended them.
    pub fn poll_transmit(&mut self, out: &mut Vec<u8>) {
        out.append(&mut self.outgoing);
        if !self.is_suspended {
            escape(&self.to_client, out);
            self.to_client.clear();
        }
    }
}

#[cfg(test)]
mod tests;
