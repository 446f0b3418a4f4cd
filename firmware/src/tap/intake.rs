//! Characters of the line to blocks that wait to be read, as the control's own buffer holds them.
//!
//! ```text
//!   Label ---- end of block behind a % ----> Marked ---- first character ----> Program
//!     ^                                        ^                                |  |
//!     |                                        +-------- block with a % --------+  |
//!     +------------------------ M02, M30, no room ---------------------------------+
//! ```
//! Up to the first end of block after power-on, program end or a mark stands the label, which the control skips. Only a
//! label with a `%` begins a program here: without one, nobody knows where in a program the line is. Comments, blanks and
//! what the code ignores are left out, so a program takes less room here than in the control.
//!
//! Blocks are read later, when the machine is near them (see [`super::blocks`]). A mark in the text tells the reader where a
//! block is damaged, and where text is missing.

use arcfeed_shared::nc::tape_code::{Code, Symbol, without_parity};
use heapless::{Deque, Vec};

use super::settings::LINE_MAX;

/// In the text: the block that came here cannot be read. As every mark, a block of its own.
pub(super) const DAMAGED: u8 = 2;
/// In the text: there was no room for what came here.
pub(super) const MISSING: u8 = 3;
/// In the text: the end of a block.
const END: u8 = b'\n';
/// What characters leave free: for the end of their block, and for a mark behind it.
const RESERVE: usize = 3;

/// The text between the sender and the machine; `N` characters of it.
#[derive(Debug)]
pub(super) struct Intake<const N: usize> {
    set_code: Option<Code>,
    code: Option<Code>,
    text: Deque<u8, N>,
    /// Whole blocks in the text.
    whole: u16,
    phase: Phase,
    block: Arriving,
    /// The control may have been reset: a `%` at the end of a line is a label, also in half a comment.
    expects_label: bool,
    /// A program has just ended: a `%` right behind it is its own, and no label.
    expects_end_mark: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Label,
    Marked,
    Program,
}

/// What is known of the block that is coming in.
#[derive(Clone, Copy, Debug, Default)]
struct Arriving {
    /// Its first frame that means something.
    first: Option<u8>,
    /// Its last one.
    last: u8,
    in_comment: bool,
    is_damaged: bool,
    /// Characters of it in the text.
    len: u16,
    /// The number behind an M, while it is being read.
    function: Option<u32>,
    ends_program: bool,
}

impl<const N: usize> Intake<N> {
    pub fn new(code: Option<Code>) -> Self {
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

    /// Takes a frame off the line. Whether a program has begun with it: what was left of another is forgotten, here as in
    /// the control.
    #[inline]
    pub fn take(&mut self, frame: u8) -> bool {
        match self.phase {
            Phase::Label => self.take_of_label(frame),
            Phase::Marked => return self.take_behind_mark(frame),
            Phase::Program => self.take_of_program(frame),
        }
        false
    }

    /// A character came that the receiver could not read.
    pub fn take_error(&mut self) {
        self.block.is_damaged = true;
    }

    /// The control asks after a long silence.
    pub fn expect_label(&mut self) {
        self.expects_label = true;
    }

    /// The control asks, or the line was silent: what comes is not behind what came.
    #[inline]
    pub fn part(&mut self) {
        self.expects_end_mark = false;
    }

    /// Takes the next whole block out of the text, without its end: whether it fits.
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

    fn take_of_label(&mut self, frame: u8) {
        let ends = match self.code {
            Some(code) => code.ends_block(frame),
            None => {
                self.code = Code::of_end_of_block(frame);
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
            // Whatever it was, the next program may come in the other code.
            self.code = self.set_code;
        }
        self.expects_end_mark &= self.block.first.is_none();
        self.block = Arriving::default();
    }

    /// Further marks and empty lines change nothing.
    fn take_behind_mark(&mut self, frame: u8) -> bool {
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
        self.take_of_program(frame);
        true
    }

    #[inline]
    fn take_of_program(&mut self, frame: u8) {
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

    fn end_block(&mut self, code: Code) {
        let mut block = core::mem::take(&mut self.block);
        // No block of a program ends with a mark: it is a label behind a block that was cut off, or behind half a comment.
        let may_be_label = core::mem::take(&mut self.expects_label) || !block.in_comment;
        if block.begins_with_mark(code) || (may_be_label && block.ends_with_mark(code)) {
            self.drop_last(block.len);
            self.phase = Phase::Marked;
        } else if block.is_damaged {
            self.drop_last(block.len);
            self.mark(DAMAGED);
        } else if block.len > 0 {
            block.take_function(END);
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
                block.take_function(byte);
                block.len = block.len.saturating_add(1);
                let _room = self.text.push_back(byte);
            }
            0x21..=0x7E => self.overflow(),
            _ => block.is_damaged = true,
        }
    }

    /// No room: what is missing from here on leaves nothing behind it that could be relied on.
    #[cold]
    fn overflow(&mut self) {
        self.drop_last(self.block.len);
        self.mark(MISSING);
        (self.phase, self.code) = (Phase::Label, self.set_code);
        // What still comes of this block is no label.
        self.block = Arriving { first: Some(0), ..Arriving::default() };
    }

    fn drop_last(&mut self, len: u16) {
        for _ in 0..len {
            self.text.pop_back();
        }
    }

    /// Where there is no room left, a mark stands there already.
    fn mark(&mut self, mark: u8) {
        if self.text.len() + 2 <= N {
            let _room = (self.text.push_back(mark), self.text.push_back(END));
            self.whole = self.whole.saturating_add(1);
        }
    }

    #[inline]
    fn code(&self) -> Code {
        self.code.unwrap_or(Code::Iso)
    }
}

impl Arriving {
    /// Remembers the first and the last frame that are no leader or trailer in any code.
    #[inline]
    fn note(&mut self, frame: u8) {
        if !matches!(without_parity(frame), 0 | b'\r' | 0x7F) {
            self.first.get_or_insert(frame);
            self.last = frame;
        }
    }

    fn begins_with_mark(&self, code: Code) -> bool {
        self.first.is_some_and(|frame| code.decode(frame) == Ok(Symbol::Character(b'%')))
    }

    fn ends_with_mark(&self, code: Code) -> bool {
        code.decode(self.last) == Ok(Symbol::Character(b'%'))
    }

    /// Looks for M2 and M30 as the characters come by.
    #[inline]
    fn take_function(&mut self, byte: u8) {
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
