//! Rules for the numbers after each address letter.
//!
//! The numbers of digits differ between the series of controls (see [`super::settings::Settings`]). In all of them
//! only axes, feeds, radii and G accept a decimal point, and only axes and radii a minus sign.

use super::alarm::{Alarm, Fault};
use super::block::{Block, letters};
use super::settings::OFFSETS;
use super::word::Word;

/// Largest S (parameter 3031).
const SPINDLE_MAX: i64 = 99_999;

/// Letters whose numbers must be whole and not negative.
const RESTRICTED: u32 = letters(b"DHLMPST");

/// Checks that the number of each address word of a block is one that the control accepts for its letter: decimal
/// point, sign, size. G words are checked elsewhere, and blocks of macro calls must not be passed.
///
/// # Errors
/// PS0003 (too many digits), PS0006 (negative), PS0007 (decimal point) or PS0030 (offset number).
pub fn check(block: &Block) -> Result<(), Fault> {
    block.word(b'F').map_or(Ok(()), check_sign)?;
    if block.may_have(RESTRICTED) { block.words.iter().try_for_each(check_word) } else { Ok(()) }
}

fn check_word(word: &Word) -> Result<(), Fault> {
    if letters(&[word.letter]) & RESTRICTED == 0 {
        return Ok(());
    }
    check_sign(word)?;
    let whole = word.number.as_whole().filter(|_| !word.number.has_point());
    let value = whole.ok_or(Fault::alarm(Alarm::DecimalPoint, word.column))?;
    match word.letter {
        b'D' | b'H' if value > OFFSETS as i64 => Err(Fault::alarm(Alarm::OffsetNumber, word.column)),
        b'S' if value > SPINDLE_MAX => Err(Fault::alarm(Alarm::TooManyDigits, word.column)),
        _ => Ok(()),
    }
}

/// Rejects a negative number, for words that may have a fraction: F and G.
pub(super) fn check_sign(word: &Word) -> Result<(), Fault> {
    if word.number.is_negative() {
        return Err(Fault::alarm(Alarm::MinusSign, word.column + 1));
    }
    Ok(())
}

/// The last word with this letter as a whole number, and its column.
pub(super) fn whole(block: &Block, letter: u8) -> Option<(i64, u16)> {
    let word = block.word(letter)?;
    Some((word.number.as_whole()?, word.column))
}
