//! Telnet (RFC 854, 855): commands embedded in a stream of data, for client and server.

/// Byte that begins a command (IAC, interpret as command); as data it is sent twice.
pub const IAC: u8 = 255;
const SB: u8 = 250;
const SE: u8 = 240;
/// Longest subnegotiation kept; ours are far shorter.
const SUB_MAX: usize = 256;

/// Telnet command by which two ends negotiate the use of an option.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Verb {
    /// The end that sends this command wants to use the option.
    Will = 251,
    /// The end that sends this command does not use the option.
    Wont = 252,
    /// The end that receives this command should use the option.
    Do = 253,
    /// The end that receives this command should not use the option.
    Dont = 254,
}

/// Item of a Telnet stream: data or a command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// A byte of data, without the escape.
    Data(u8),
    /// Command about an option: the verb, and the option's number.
    Option(Verb, u8),
    /// Subnegotiation: the bytes between SB and SE, the first of which is the option's number.
    Subnegotiation(Vec<u8>),
    /// Any other command, by its code.
    Command(u8),
}

/// Decoder that separates a Telnet stream into data and commands, byte by byte.
#[derive(Clone, Debug, Default)]
pub struct Decoder {
    state: State,
    sub: Option<Vec<u8>>,
}

#[derive(Clone, Copy, Debug, Default)]
enum State {
    #[default]
    Plain,
    Command,
    Option(Verb),
}

impl Decoder {
    /// Decodes the next byte; returns an item if the byte completes one.
    pub fn on_byte(&mut self, byte: u8) -> Option<Event> {
        match self.state {
            State::Plain if byte == IAC => {
                self.state = State::Command;
                None
            }
            State::Plain => self.plain(byte),
            State::Command => {
                self.state = State::Plain;
                self.command(byte)
            }
            State::Option(verb) => {
                self.state = State::Plain;
                Some(Event::Option(verb, byte))
            }
        }
    }

    fn plain(&mut self, byte: u8) -> Option<Event> {
        let Some(sub) = &mut self.sub else { return Some(Event::Data(byte)) };
        if sub.len() < SUB_MAX {
            sub.push(byte);
        }
        None
    }

    fn command(&mut self, byte: u8) -> Option<Event> {
        let verb = match byte {
            IAC => return self.plain(IAC),
            SB => {
                self.sub = Some(Vec::new());
                return None;
            }
            SE => return self.sub.take().map(Event::Subnegotiation),
            251 => Verb::Will,
            252 => Verb::Wont,
            253 => Verb::Do,
            254 => Verb::Dont,
            other => return Some(Event::Command(other)),
        };
        self.state = State::Option(verb);
        None
    }
}

/// Appends data to `out`, with every byte 255 (IAC) doubled.
pub fn escape(bytes: &[u8], out: &mut Vec<u8>) {
    for &byte in bytes {
        out.push(byte);
        if byte == IAC {
            out.push(IAC);
        }
    }
}

/// Appends to `out` the command `verb` about an option.
pub fn say(verb: Verb, option: u8, out: &mut Vec<u8>) {
    out.extend([IAC, verb as u8, option]);
}

/// Appends to `out` a subnegotiation of `option`: a command code and its values, which may be any bytes.
pub fn subnegotiate(option: u8, code: u8, values: &[u8], out: &mut Vec<u8>) {
    out.extend([IAC, SB, option, code]);
    escape(values, out);
    out.extend([IAC, SE]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(bytes: &[u8]) -> Vec<Event> {
        let mut decoder = Decoder::default();
        bytes.iter().filter_map(|&byte| decoder.on_byte(byte)).collect()
    }

    #[test]
    fn doubled_iac_is_a_byte_in_data_and_in_values() {
        assert_eq!(decoded(&[65, IAC, IAC, 66]), [Event::Data(65), Event::Data(IAC), Event::Data(66)]);
        assert_eq!(decoded(&[IAC, SB, 44, 1, IAC, IAC, 0, IAC, SE]), [Event::Subnegotiation(vec![44, 1, IAC, 0])]);
    }

    #[test]
    fn every_byte_comes_back_through_its_escape() {
        let bytes: Vec<u8> = (0..=255).collect();
        let mut line = Vec::new();
        escape(&bytes, &mut line);
        assert_eq!(line.len(), 257);
        assert_eq!(decoded(&line), bytes.into_iter().map(Event::Data).collect::<Vec<_>>());
    }

    #[test]
    fn an_end_without_a_beginning_is_nothing() {
        assert_eq!(decoded(&[IAC, SE, 65, IAC, 241]), [Event::Data(65), Event::Command(241)]);
    }
}
