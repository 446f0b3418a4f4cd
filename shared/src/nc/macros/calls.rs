//! The words of calls and returns: G65, G66, G66.1, M98, M99.

use alloc::boxed::Box;
use alloc::vec::Vec;

use super::arguments::{Letters, locals};
use super::expression::whole;
use super::stack::{Call, When};
use super::step::Ending;
use super::words::Word;
use crate::nc::alarm::{Fault, NotModelled};
use crate::nc::macro_alarm::MacroAlarm;
use crate::units::LengthUnit;

/// Largest number of a program: eight digits.
const PROGRAM_MAX: u32 = 99_999_999;
/// Largest sequence number.
pub const SEQUENCE_MAX: u32 = 99_999;
/// In P of M98 the digits before the last four say how often, if there is no L.
const REPEAT_DIGITS: u32 = 10_000;
/// Most repetitions of a macro call.
const REPEATS_MAX: u32 = 9_999;

/// What happens when the block given out last is done.
#[derive(Debug, Default)]
pub enum Then {
    /// The next line.
    #[default]
    GoOn,
    /// A program is called.
    Call(Box<Call>),
    /// M99, with P and its column.
    Return(Option<(u32, u16)>),
    /// The program is over.
    End(Ending),
}

/// The call that G65, G66 or G66.1, the word `at`, makes with the words behind it, and when.
///
/// # Errors
/// PS0076, PS0078, PS0129 at the word that is missing or wrong.
pub fn macro_call(words: &[Word], at: usize, unit: LengthUnit) -> Result<Option<(Option<When>, Call)>, Fault> {
    let (before, rest) = words.split_at_checked(at).unwrap_or_default();
    let Some((code, arguments)) = rest.split_first() else { return Ok(None) };
    if let Some(word) = before.first() {
        return Err(Fault::in_macro(MacroAlarm::ArgumentAddress, word.column));
    }
    let last = |letter: u8| arguments.iter().rev().find(|word| word.letter == letter);
    let program = last(b'P').ok_or(Fault::in_macro(MacroAlarm::NoProgramNumber, code.column))?;
    let given = arguments.iter().filter(|word| !matches!(word.letter, b'P' | b'L'));
    let locals = locals(given, Letters::OfCall, unit)?;
    let number = number_of(program, PROGRAM_MAX)?;
    let repeats = last(b'L').map_or(Ok(1), |word| number_of(word, REPEATS_MAX))?;
    let when = match code.value {
        66.0 => Some(When::AfterMoves),
        65.0 => None,
        _ => Some(When::EveryBlock),
    };
    let arguments = Some(Box::new(locals));
    Ok(Some((when, Call { number, repeats, arguments, is_modal: when.is_some(), column: program.column })))
}

/// Takes M98 and M99 with their P and L out of a block: the words left, and what happens behind them.
///
/// # Errors
/// PS0076, PS0078, or a call that is not modelled.
pub fn split_call(words: Vec<Word>) -> Result<(Vec<Word>, Then), Fault> {
    let is_m = |word: &Word, code: f64| word.letter == b'M' && word.value == code;
    if let Some(word) = words.iter().find(|word| is_m(word, 198.0)) {
        return Err(Fault::not_modelled(NotModelled::MCode(198), word.column));
    }
    let Some(code) = words.iter().find(|word| is_m(word, 98.0) || is_m(word, 99.0)).cloned() else {
        return Ok((words, Then::GoOn));
    };
    let (own, others): (Vec<Word>, Vec<Word>) =
        words.into_iter().partition(|word| matches!(word.letter, b'P' | b'L') || *word == code);
    let last = |letter: u8| own.iter().rev().find(|word| word.letter == letter);
    let program = last(b'P');
    if code.value == 99.0 {
        let sequence = program.map(|word| Ok((number_of(word, SEQUENCE_MAX)?, word.column))).transpose()?;
        return Ok((others, Then::Return(sequence)));
    }
    if let Some(word) = others.iter().find(|word| matches!(word.letter, b'H' | b'Q')) {
        return Err(Fault::not_modelled(NotModelled::MCode(98), word.column));
    }
    let program = program.ok_or(Fault::in_macro(MacroAlarm::NoProgramNumber, code.column))?;
    let number = number_of(program, PROGRAM_MAX)?;
    let (number, repeats) = match last(b'L') {
        Some(word) => (number, number_of(word, PROGRAM_MAX)?),
        None if number >= REPEAT_DIGITS => (number % REPEAT_DIGITS, number / REPEAT_DIGITS),
        None => (number, 1),
    };
    let call = Call { number, repeats, arguments: None, is_modal: false, column: program.column };
    Ok((others, Then::Call(Box::new(call))))
}

fn number_of(word: &Word, max: u32) -> Result<u32, Fault> {
    whole(Some(word.value), 0..=max).ok_or(Fault::in_macro(MacroAlarm::ProgramNotFound, word.column))
}
