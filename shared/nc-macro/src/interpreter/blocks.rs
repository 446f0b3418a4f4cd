//! Blocks of words: their values, the calls in them, and the plain block that remains.

use alloc::boxed::Box;
use alloc::vec::Vec;

use super::{Interpreter, StepResult};
use crate::arguments::{Letters, locals};
use crate::calls::{Continuation, macro_call, split_call};
use crate::code::{CodeCursor, Head, MacroCode};
use crate::expression::whole;
use crate::stack::{Call, ModalCallTiming};
use crate::step::{Ending, MacroStep, PlainBlock};
use crate::words::{self, MacroWord, spell_block};
use arcfeed_nc::alarm::{Fault, NotModelled};

impl Interpreter {
    pub(super) fn block(&mut self, head: &Head, mut cursor: CodeCursor<'_>) -> StepResult {
        let unit = self.variables.context.unit;
        let words = words::read(&mut cursor, self.evaluator(), unit)?;
        let tenths = |word: &MacroWord| (word.letter == b'G').then(|| whole(Some(word.value * 10.0), 0..=9_999))?;
        if let Some(at) = words.iter().position(|word| matches!(tenths(word), Some(650 | 660 | 661))) {
            return self.call_macro(&words, at).map(|()| None);
        }
        let (cancels, words): (Vec<_>, Vec<_>) = words.into_iter().partition(|word| tenths(word) == Some(670));
        if let Some(word) = cancels.first()
            && !self.stack.cancel_modal()
        {
            return Err(Fault::not_modelled(NotModelled::GCode(670), word.column));
        }
        if let Some(call) = self.stack.modal_call(ModalCallTiming::EveryBlock).filter(|_| !words.is_empty()) {
            let arguments = Some(Box::new(locals(words.iter(), Letters::Block, unit)?));
            self.then = Continuation::Call(Box::new(Call { arguments, ..call }));
            return Ok(None);
        }
        let (words, then) = split_call(words)?;
        let step = (!words.is_empty() || matches!(then, Continuation::GoOn)).then(|| {
            let (mut text, mut columns) = spell_block(words.iter());
            if let Some(sequence) = head.sequence {
                let number = alloc::format!("N{sequence}");
                text.splice(..0, number.bytes());
                columns.splice(..0, core::iter::repeat_n(1, number.len()));
            }
            let code = MacroCode::new(&text);
            self.emit(text, columns, &code)
        });
        // A call of this block precedes a modal call; M99 in a block with M30 is not executed.
        if !matches!(then, Continuation::GoOn) && !matches!(self.then, Continuation::End(_)) {
            self.then = then;
        }
        Ok(step)
    }

    /// Emits a block and prepares the action after it.
    pub(super) fn emit(&mut self, text: Vec<u8>, columns: Vec<u16>, code: &MacroCode) -> MacroStep {
        let kind = self.variables.codes.apply_block(code.cursor());
        if kind.moves || kind.dwells {
            self.steps = 0;
        }
        if kind.ends {
            self.then = Continuation::End(Ending::Program);
        } else if let Some(call) = self.stack.modal_call(ModalCallTiming::AfterMoves).filter(|_| kind.moves) {
            self.then = Continuation::Call(Box::new(call));
        }
        MacroStep::Block(PlainBlock { text, place: self.place, calls: self.stack.calls(), columns })
    }

    /// Executes G65, G66 or G66.1 with the words after it.
    fn call_macro(&mut self, words: &[MacroWord], at: usize) -> Result<(), Fault> {
        let Some((when, call)) = macro_call(words, at, self.variables.context.unit)? else { return Ok(()) };
        let Some(when) = when else {
            self.then = Continuation::Call(Box::new(call));
            return Ok(());
        };
        let column = call.column;
        let is_set = self.stack.set_modal(when, call, &self.settings.bounds)?;
        if is_set { Ok(()) } else { Err(Fault::not_modelled(NotModelled::GCode(660), column)) }
    }
}
