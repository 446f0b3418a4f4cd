//! First characters of a client: only a client that begins a program, with `%` in any code, reaches the control. Other
//! connections to a TCP port (a browser, a port scan) would put the control in alarm.

/// Most characters of leader and trailer.
const LEADER_MAX: usize = 4_096;

/// Detector of the beginning of a client's next program. Keeps its state between calls.
#[derive(Clone, Debug)]
pub enum ProgramStart {
    /// Only leader (characters before a program, without meaning) has come so far, of this length.
    Awaited(usize),
    /// A program has ended, and only leader has come since, of this length; the trailer of that program may still come.
    AwaitedAgain(usize),
    /// `%` has come, and leader of this length after it.
    Marked(usize),
    /// A character of the program has come.
    Begun,
}

/// Handling of a received character: passed on, dropped, or a reason to disconnect the client.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ByteHandling {
    /// It is passed to the control.
    Pass,
    /// It belongs to the trailer of the last program and is dropped.
    Discard,
    /// The client is disconnected, for this reason.
    Refuse(String),
}

impl Default for ProgramStart {
    fn default() -> Self {
        ProgramStart::Awaited(0)
    }
}

impl ProgramStart {
    /// Expects the next program.
    pub fn expect_next(&mut self) {
        if self.has_begun() {
            *self = ProgramStart::AwaitedAgain(0);
        }
    }

    /// Whether the program has begun.
    pub fn has_begun(&self) -> bool {
        matches!(self, ProgramStart::Begun)
    }

    /// Reads a character, whose eighth bit may be parity.
    pub fn on_byte(&mut self, byte: u8) -> ByteHandling {
        let (is_mark, is_leader) = (is_mark(byte), is_leader(byte));
        match self {
            ProgramStart::Begun => return ByteHandling::Pass,
            ProgramStart::Awaited(_) | ProgramStart::AwaitedAgain(_) if is_mark => *self = ProgramStart::Marked(0),
            ProgramStart::Marked(_) if !is_mark && !is_leader => *self = ProgramStart::Begun,
            ProgramStart::Awaited(_) if !is_leader => {
                return ByteHandling::Refuse(
                    "what it sends does not begin with `%`, as a program over this port does".into(),
                );
            }
            ProgramStart::Awaited(len) | ProgramStart::AwaitedAgain(len) | ProgramStart::Marked(len) => {
                *len += usize::from(!is_device_control(byte));
                if *len > LEADER_MAX {
                    return ByteHandling::Refuse(format!("more than {LEADER_MAX} characters and no program"));
                }
            }
        }
        let is_trailer = matches!(self, ProgramStart::AwaitedAgain(_)) && !is_leader;
        if is_trailer { ByteHandling::Discard } else { ByteHandling::Pass }
    }

    /// Checks characters that are not read yet; `Err` if they would be refused.
    pub fn check(mut self, bytes: &[u8]) -> Result<(), Option<String>> {
        bytes.iter().try_for_each(|byte| match self.on_byte(*byte) {
            ByteHandling::Refuse(reason) => Err(Some(reason)),
            ByteHandling::Pass | ByteHandling::Discard => Ok(()),
        })
    }
}

/// The character is `%` in ISO, with parity or without, or in EIA.
fn is_mark(byte: u8) -> bool {
    byte & 0x7f == b'%' || byte == 0x0b
}

/// The character is blank tape, an end of block, a space, DEL, or one of DC1 to DC4.
fn is_leader(byte: u8) -> bool {
    matches!(byte & 0x7f, 0 | b'\t' | b'\n' | b'\r' | 0x10 | b' ' | 0x7f) || is_device_control(byte)
}

fn is_device_control(byte: u8) -> bool {
    matches!(byte & 0x7f, 0x11..=0x14)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(start: &mut ProgramStart, text: &[u8]) -> ByteHandling {
        text.iter().map(|byte| start.on_byte(*byte)).last().expect("a character")
    }

    #[test]
    fn a_program_begins_with_a_mark_in_any_code() {
        for text in [&b"\0\0\x7f%\nO"[..], b"\xa5\x0aO", b"\x0b\x80\x46"] {
            let mut start = ProgramStart::default();
            assert_eq!((taken(&mut start, text), start.has_begun()), (ByteHandling::Pass, true), "{text:?}");
        }
    }

    #[test]
    fn a_browser_and_an_endless_leader_are_refused() {
        for text in [&b"GET / HTTP/1.1"[..], b"\x16\x03\x01", &[0; LEADER_MAX + 1], &[b'%'; LEADER_MAX + 2]] {
            let mut start = ProgramStart::default();
            assert!(matches!(taken(&mut start, text), ByteHandling::Refuse(_)), "{text:?}");
            assert!(ProgramStart::default().check(text).is_err());
        }
    }

    #[test]
    fn the_trailer_of_a_program_does_not_reach_the_next() {
        let mut start = ProgramStart::default();
        taken(&mut start, b"%\nM30");
        start.expect_next();
        assert_eq!(taken(&mut start, b"\n(END)"), ByteHandling::Discard);
        assert_eq!(taken(&mut start, b"\n%\n%\n"), ByteHandling::Pass);
        assert!(!start.has_begun());
        taken(&mut start, b"O1");
        assert!(start.has_begun());
    }
}
