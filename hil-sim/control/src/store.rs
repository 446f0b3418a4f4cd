//! READ and PUNCH in EDIT mode: a program over the line into the control's memory, and back out.
//!
//! ```text
//!          % behind the program             DC1 (or the operator: punch)          all is out
//! Reading -----------------------> Stored ------------------------------> Punching ----------> Stored
//!    |                                                                                            and so on
//!    +--> Refused: TH, TV, a line error
//! ```
//! Memory keeps the characters of blocks, without blanks outside comments and without empty blocks (generally said of
//! these controls, read in no manual). The output is DC2, `%`, the blocks, `%`, DC4. DC1 begins it, in place of an
//! operator who presses PUNCH when the other side is ready.

use arcfeed_nc::alarm::Fault;
use arcfeed_units::Micros;

use super::dnc_port::DncPort;
use super::line::LineSettings;
use super::tape::ReceivedBlock;

/// Control in EDIT mode: receives a program over the serial line into its memory (READ), and sends it back (PUNCH).
#[derive(Debug)]
pub struct Store {
    port: DncPort,
    blocks: Vec<Vec<u8>>,
    state: StoreState,
}

/// State of a control in EDIT mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreState {
    /// It receives a program.
    Reading,
    /// It has a program in memory and does not send.
    Stored,
    /// It sends its program.
    Punching,
    /// It has rejected the received program because of this fault.
    Refused(Fault),
}

impl Store {
    /// Control after READ has been pressed.
    pub fn new(line: LineSettings) -> Self {
        Store { port: DncPort::on_line(line), blocks: Vec::new(), state: StoreState::Reading }
    }

    /// Serial port of the control.
    pub fn port(&mut self) -> &mut DncPort {
        &mut self.port
    }

    /// Progress of storing the program in memory.
    pub fn state(&self) -> StoreState {
        self.state
    }

    /// Blocks of the program as stored: without blanks outside comments, and without empty blocks.
    pub fn blocks(&self) -> &[Vec<u8>] {
        &self.blocks
    }

    /// Simulates the serial line for the time `dt`.
    pub fn step(&mut self, dt: Micros) {
        let fault = self.port.step(dt);
        match self.state {
            StoreState::Reading => self.read(fault),
            StoreState::Stored if self.port.take_request() => self.punch(),
            StoreState::Punching if !self.port.is_punching() => self.state = StoreState::Stored,
            StoreState::Stored | StoreState::Punching | StoreState::Refused(_) => {}
        }
    }

    /// Starts to send the stored program, as the key PUNCH does.
    pub fn punch(&mut self) {
        let code = self.port.code();
        let punch = self.port.punch();
        punch.open();
        let marks = [b"%".as_slice(), b"%"];
        let [first, last] = marks.map(std::iter::once);
        first.chain(self.blocks.iter().map(Vec::as_slice)).chain(last).for_each(|block| punch.print(block, code));
        punch.close();
        self.state = StoreState::Punching;
    }

    fn read(&mut self, mut fault: Option<Fault>) {
        while let Some(received) = self.port.take_block() {
            match received {
                ReceivedBlock::Label { .. } => {}
                ReceivedBlock::Block(text) if text.starts_with(b"%") => {
                    self.state = StoreState::Stored;
                    break;
                }
                ReceivedBlock::Block(text) => self.blocks.extend(stored_block(&text)),
                ReceivedBlock::Refused { fault: found, .. } => fault = fault.or(Some(found)),
            }
        }
        if let Some(fault) = fault {
            self.state = StoreState::Refused(fault);
        }
        if self.state != StoreState::Reading {
            self.port.close();
        }
    }
}

/// Characters that memory keeps of a block.
fn stored_block(text: &[u8]) -> Option<Vec<u8>> {
    let mut depth = 0;
    let is_kept = |byte: &u8| {
        depth += i32::from(*byte == b'(');
        let keeps = depth > 0 || !matches!(byte, b' ' | b'\t');
        depth -= i32::from(*byte == b')');
        keeps
    };
    let block: Vec<u8> = text.iter().copied().filter(is_kept).collect();
    (!block.is_empty()).then_some(block)
}

#[cfg(test)]
mod tests {
    use arcfeed_nc::alarm::Alarm;

    use super::*;
    use crate::code::{DC1, TapeCode};

    const MS: Micros = Micros::from_ms(1);

    fn read(text: &str, corrupt: impl Fn(u8) -> u8) -> Store {
        let mut store = Store::new(LineSettings::default());
        let frames: Vec<u8> = text.bytes().filter_map(|byte| TapeCode::Iso.encode(byte)).map(corrupt).collect();
        // Eight bits, as the sender of a line without parity of its own sends them.
        let mut line = LineSettings::default();
        line.sender = crate::line::SenderParity::None;
        store.port = DncPort::on_line(line);
        store.port().on_bytes(&frames);
        (0..2_000).for_each(|_| store.step(MS));
        store
    }

    fn punched(store: &mut Store) -> Vec<u8> {
        let mut out = Vec::new();
        for _ in 0..2_000 {
            store.step(MS);
            out.extend(std::iter::from_fn(|| store.port().poll_transmit()).map(|byte| byte & 0x7F));
        }
        out
    }

    #[test]
    fn a_stored_program_is_punched_when_the_other_side_is_ready() {
        let mut store = read("%\nO1 (A PART)\nG1 X1.\n\nM30\n%\n", |byte| byte);
        assert_eq!(store.state(), StoreState::Stored);
        assert_eq!(store.blocks(), [b"O1(A PART)".to_vec(), b"G1X1.".to_vec(), b"M30".to_vec()]);
        assert_eq!(punched(&mut store), [0x11, 0x13], "it has read; no DC1 yet");
        store.port().on_bytes(&[DC1]);
        assert_eq!(punched(&mut store), b"\x12%\nO1(A PART)\nG1X1.\nM30\n%\n\x14");
        assert_eq!(store.state(), StoreState::Stored);
    }

    #[test]
    fn a_character_with_wrong_parity_is_refused() {
        let store = read("%\nO1\nG1X1.\nM30\n%\n", |byte| if byte == b'X' | 0x80 { b'X' } else { byte });
        let StoreState::Refused(fault) = store.state() else { panic!("{:?}", store.state()) };
        assert_eq!(fault, Fault::alarm(Alarm::Character, 3));
    }
}
