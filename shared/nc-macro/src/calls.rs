//! Calls of subprograms and macros, and returns: G65, G66, G66.1, M98, M99, M198.

use alloc::boxed::Box;
use alloc::vec::Vec;

use super::arguments::{Letters, locals};
use super::expression::whole;
use super::stack::{Call, ModalCallTiming};
use super::step::Ending;
use super::words::MacroWord;
use arcfeed_nc::alarm::{Fault, NotModelled};
use arcfeed_nc::macro_alarm::MacroAlarm;
use arcfeed_units::LengthUnit;

/// Largest number of a program: eight digits.
const PROGRAM_MAX: u32 = 99_999_999;
/// Largest sequence number.
pub const SEQUENCE_MAX: u32 = 99_999;
/// Without L, the digits of M98's P before the last four are the number of repetitions.
const REPEAT_DIGITS: u32 = 10_000;
/// Maximum number of repetitions of a macro call.
const REPEATS_MAX: u32 = 9_999;

/// Continuation of the program after a block was passed to the control.
#[derive(Debug, Default)]
pub enum Continuation {
    /// Continue with the next line.
    #[default]
    GoOn,
    /// Call a program.
    Call(Box<Call>),
    /// Return (M99), with P and its column.
    Return(Option<(u32, u16)>),
    /// End of the program.
    End(Ending),
}

/// The macro call that the word with index `at` commands (G65, G66 or G66.1), with the words after it as arguments.
/// With the timing of the call if it is modal (G66, G66.1). `None` if there is no such word.
///
/// # Errors
/// PS0076, PS0078 or PS0129 at the missing or wrong word.
pub fn macro_call(
    words: &[MacroWord],
    at: usize,
    unit: LengthUnit,
) -> Result<Option<(Option<ModalCallTiming>, Call)>, Fault> {
    let (before, rest) = words.split_at_checked(at).unwrap_or_default();
    let Some((code, arguments)) = rest.split_first() else { return Ok(None) };
    if let Some(word) = before.first() {
        return Err(Fault::in_macro(MacroAlarm::ArgumentAddress, word.column));
    }
    let last = |letter: u8| arguments.iter().rev().find(|word| word.letter == letter);
    let program = last(b'P').ok_or(Fault::in_macro(MacroAlarm::NoProgramNumber, code.column))?;
    let given = arguments.iter().filter(|word| !matches!(word.letter, b'P' | b'L'));
    let locals = locals(given, Letters::Call, unit)?;
    let number = number_of(program, PROGRAM_MAX)?;
    let repeats = last(b'L').map_or(Ok(1), |word| number_of(word, REPEATS_MAX))?;
    let when = match code.value {
        66.0 => Some(ModalCallTiming::AfterMoves),
        65.0 => None,
        _ => Some(ModalCallTiming::EveryBlock),
    };
    let arguments = Some(Box::new(locals));
    let (is_modal, column) = (when.is_some(), program.column);
    Ok(Some((when, Call { number, repeats, arguments, is_modal, is_external: false, column })))
}

/// Takes M98, M99 and M198 with their P and L out of a block. Returns the other words, and what the program continues
/// with after them.
///
/// # Errors
/// PS0076, PS0078, or a call that is not modelled.
pub fn split_call(words: Vec<MacroWord>) -> Result<(Vec<MacroWord>, Continuation), Fault> {
    let is_m = |word: &MacroWord, code: f64| word.letter == b'M' && word.value == code;
    let is_call = |word: &&MacroWord| [98.0, 99.0, 198.0].iter().any(|code| is_m(word, *code));
    let Some(code) = words.iter().find(is_call).cloned() else {
        return Ok((words, Continuation::GoOn));
    };
    let (own, others): (Vec<MacroWord>, Vec<MacroWord>) =
        words.into_iter().partition(|word| matches!(word.letter, b'P' | b'L') || *word == code);
    let last = |letter: u8| own.iter().rev().find(|word| word.letter == letter);
    let program = last(b'P');
    if code.value == 99.0 {
        let sequence = program.map(|word| Ok((number_of(word, SEQUENCE_MAX)?, word.column))).transpose()?;
        return Ok((others, Continuation::Return(sequence)));
    }
    if let Some(word) = others.iter().find(|word| matches!(word.letter, b'H' | b'Q')) {
        return Err(Fault::not_modelled(NotModelled::MCode(code.value as u16), word.column));
    }
    let program = program.ok_or(Fault::in_macro(MacroAlarm::NoProgramNumber, code.column))?;
    let number = number_of(program, PROGRAM_MAX)?;
    let (number, repeats) = match last(b'L') {
        Some(word) => (number, number_of(word, PROGRAM_MAX)?),
        None if number >= REPEAT_DIGITS => (number % REPEAT_DIGITS, number / REPEAT_DIGITS),
        None => (number, 1),
    };
    let (is_external, column) = (code.value == 198.0, program.column);
    let call = Call { number, repeats, arguments: None, is_modal: false, is_external, column };
    Ok((others, Continuation::Call(Box::new(call))))
}

fn number_of(word: &MacroWord, max: u32) -> Result<u32, Fault> {
    whole(Some(word.value), 0..=max).ok_or(Fault::in_macro(MacroAlarm::ProgramNotFound, word.column))
}
