//! Buffer of the tap: collects characters of the line into blocks, like the control's own buffer.
//!
//! ```text
//!   Label ---- end of block behind a % ----> Marked ---- first character ----> Program
//!     ^                                        ^                                |  |
//!     |                                        +-------- block with a % --------+  |
//!     +------------------------ M02, M30, no room ---------------------------------+
//! ```
//! The label is the text up to the first end of block after power-on, program end or a mark; the control skips it.
//! Here only a label with a `%` starts a program: without one, the position in the program is unknown. Comments,
//! blanks and ignored characters are left out, so a program needs less room here than in the control.
//!
//! Blocks are interpreted later, when the machine is near them (see [`super::blocks`]). Marks in the text show the
//! reader a damaged block or missing text.

use arcfeed_nc::tape_code::{Symbol, TapeCode, without_parity};
use heapless::{Deque, Vec};

use super::settings::LINE_MAX;

/// Mark of a damaged block. Every mark is a block of its own.
pub(super) const DAMAGED: u8 = 2;
/// Mark of missing text, for which there was no room.
pub(super) const MISSING: u8 = 3;
/// End of a block in the text.
const END: u8 = b'\n';
/// Reserved room for the end of a block and a mark after it.
const RESERVE: usize = 3;

/// Text between the sender and the machine, up to `N` characters.
#[derive(Debug)]
pub(super) struct Intake<const N: usize> {
    set_code: Option<TapeCode>,
    code: Option<TapeCode>,
    text: Deque<u8, N>,
    /// Number of complete blocks in the text.
    whole: u16,
    phase: Phase,
    block: Arriving,
    /// Whether the control may have been reset: then a `%` at the end of a line is a label, even within an open
    /// comment.
    expects_label: bool,
    /// Whether a program has just ended: then a `%` directly after it is its end mark, not a label.
    expects_end_mark: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Label,
    Marked,
    Program,
}

/// State of the block that is being received.
#[derive(Clone, Copy, Debug, Default)]
struct Arriving {
    /// First significant frame.
    first: Option<u8>,
    /// Last significant frame.
    last: u8,
    in_comment: bool,
    is_damaged: bool,
    /// Number of its characters in the text.
    len: u16,
    /// Number of an M word while it is being read.
    function: Option<u32>,
    ends_program: bool,
}

impl<const N: usize> Intake<N> {
    /// Empty intake; without `code` it detects the code of the line.
    pub fn new(code: Option<TapeCode>) -> Self {
        Intake {
            set_code: code,
            code,
            text: Deque::new(),
            whole: 0,
            phase: Phase::Label,
            block: Arriving::default(),
            expects_label: false,
            expects_end_mark: false,
        }
    }

    /// Processes a frame of the line. Returns whether a program starts with it; the rest of the previous program is
    /// then discarded, as in the control.
    #[inline]
    pub fn push(&mut self, frame: u8) -> bool {
        match self.phase {
            Phase::Label => self.push_label(frame),
            Phase::Marked => return self.push_after_mark(frame),
            Phase::Program => self.push_program(frame),
        }
        false
    }

    /// Registers an unreadable character.
    pub fn mark_damaged(&mut self) {
        self.block.is_damaged = true;
    }

    /// Registers a DC1 of the control after a long silence.
    pub fn expect_label(&mut self) {
        self.expects_label = true;
    }

    /// Registers a DC1 of the control or a silence: the next characters do not continue the previous ones.
    #[inline]
    pub fn separate(&mut self) {
        self.expects_end_mark = false;
    }

    /// Moves the next complete block to `line`, without its end. Returns whether it fits; `None` if there is none.
    pub fn next_block(&mut self, line: &mut Vec<u8, LINE_MAX>) -> Option<bool> {
        if self.whole == 0 {
            return None;
        }
        line.clear();
        let mut fits = true;
        while let Some(byte) = self.text.pop_front().filter(|byte| *byte != END) {
            fits &= line.push(byte).is_ok();
        }
        self.whole -= 1;
        Some(fits)
    }

    fn push_label(&mut self, frame: u8) {
        let ends = match self.code {
            Some(code) => code.ends_block(frame),
            None => {
                self.code = TapeCode::of_end_of_block(frame);
                self.code.is_some()
            }
        };
        if !ends {
            return self.block.note(frame);
        }
        let is_mark = self.code.is_some_and(|code| self.block.begins_with_mark(code));
        if is_mark && !self.expects_end_mark {
            self.phase = Phase::Marked;
        } else {
            // The next program may use the other code.
            self.code = self.set_code;
        }
        self.expects_end_mark &= self.block.first.is_none();
        self.block = Arriving::default();
    }

    /// Processes a frame after a mark; further marks and empty lines have no effect.
    fn push_after_mark(&mut self, frame: u8) -> bool {
        let code = self.code();
        if code.ends_block(frame) {
            self.block = Arriving::default();
            return false;
        }
        let is_in_label = self.block.first.is_some();
        self.block.note(frame);
        if is_in_label || self.block.first.is_none() || self.block.begins_with_mark(code) {
            return false;
        }
        self.text.clear();
        self.whole = 0;
        self.phase = Phase::Program;
        self.block = Arriving::default();
        self.push_program(frame);
        true
    }

    #[inline]
    fn push_program(&mut self, frame: u8) {
        let code = self.code();
        if code.ends_block(frame) {
            return self.end_block(code);
        }
        self.block.note(frame);
        match code.decode(frame) {
            Ok(Symbol::Character(byte)) => self.put(byte),
            Ok(Symbol::EndOfBlock | Symbol::Ignored) => {}
            Err(_) => self.block.is_damaged = true,
        }
    }

    fn end_block(&mut self, code: TapeCode) {
        let mut block = core::mem::take(&mut self.block);
        // No block of a program ends with a mark: this is a label after a truncated block or an open comment.
        let may_be_label = core::mem::take(&mut self.expects_label) || !block.in_comment;
        if block.begins_with_mark(code) || (may_be_label && block.ends_with_mark(code)) {
            self.drop_last(block.len);
            self.phase = Phase::Marked;
        } else if block.is_damaged {
            self.drop_last(block.len);
            self.mark(DAMAGED);
        } else if block.len > 0 {
            block.scan_function(END);
            let _room = self.text.push_back(END);
            self.whole = self.whole.saturating_add(1);
        }
        if block.ends_program {
            (self.phase, self.code) = (Phase::Label, self.set_code);
            self.expects_end_mark = true;
        }
    }

    #[inline]
    fn put(&mut self, byte: u8) {
        let block = &mut self.block;
        match byte {
            b'(' => block.in_comment = true,
            b')' if block.in_comment => block.in_comment = false,
            _ if block.in_comment => {}
            b' ' | b'\t' => {}
            0x21..=0x7E if self.text.len() + RESERVE < N => {
                block.scan_function(byte);
                block.len = block.len.saturating_add(1);
                let _room = self.text.push_back(byte);
            }
            0x21..=0x7E => self.overflow(),
            _ => block.is_damaged = true,
        }
    }

    /// Handles a full buffer: after the missing text nothing can be followed.
    #[cold]
    fn overflow(&mut self) {
        self.drop_last(self.block.len);
        self.mark(MISSING);
        (self.phase, self.code) = (Phase::Label, self.set_code);
        // The rest of this block is not a label.
        self.block = Arriving { first: Some(0), ..Arriving::default() };
    }

    fn drop_last(&mut self, len: u16) {
        for _ in 0..len {
            self.text.pop_back();
        }
    }

    /// Without room there is already a mark.
    fn mark(&mut self, mark: u8) {
        if self.text.len() + 2 <= N {
            let _room = (self.text.push_back(mark), self.text.push_back(END));
            self.whole = self.whole.saturating_add(1);
        }
    }

    #[inline]
    fn code(&self) -> TapeCode {
        self.code.unwrap_or(TapeCode::Iso)
    }
}

impl Arriving {
    /// Records the first and the last frame that are not leader or trailer in any code.
    #[inline]
    fn note(&mut self, frame: u8) {
        if !matches!(without_parity(frame), 0 | b'\r' | 0x7F) {
            self.first.get_or_insert(frame);
            self.last = frame;
        }
    }

    fn begins_with_mark(&self, code: TapeCode) -> bool {
        self.first.is_some_and(|frame| code.decode(frame) == Ok(Symbol::Character(b'%')))
    }

    fn ends_with_mark(&self, code: TapeCode) -> bool {
        code.decode(self.last) == Ok(Symbol::Character(b'%'))
    }

    /// Detects M2 and M30 in the characters.
    #[inline]
    fn scan_function(&mut self, byte: u8) {
        match (byte, self.function) {
            (b'0'..=b'9', Some(number)) => {
                self.function = Some(number.saturating_mul(10).saturating_add(u32::from(byte - b'0')));
            }
            (_, number) => {
                self.ends_program |= matches!(number, Some(2 | 30));
                self.function = (byte == b'M').then_some(0);
            }
        }
    }
}

#[cfg(test)]
mod tests;
