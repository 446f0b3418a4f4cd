//! Arguments of macro calls: the words of G65, G66 and G66.1 set local variables of the called macro.
//!
//! Every letter has its variable (specification I). I, J, K may be given ten times, each time for the next three
//! variables of #4 to #33 (specification II). A call may use both; the later word wins. A value without a decimal
//! point is in least increments of its address, or in whole units for D, E, F, H, M, S, T.

use super::variables::Locals;
use super::words::MacroWord;
use arcfeed_nc::alarm::Fault;
use arcfeed_nc::macro_alarm::MacroAlarm;
use arcfeed_units::LengthUnit;

/// Letters in the order of their variables, from #1 on.
const LETTERS: &[u8; 26] = b"ABCIJKDEFGHLMNOPQRSTUVWXYZ";
/// Maximum number of sets of I, J, K.
const SETS: usize = 10;

/// Letters whose words can be arguments of a macro call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Letters {
    /// G65 and G66: all letters except G, L, N, O, P.
    Call,
    /// A block under G66.1, whose words are all arguments: all letters except O; of several G words only the last one
    /// counts.
    Block,
}

/// Local variables #1 to #33 of the called macro, as these words of the call set them.
///
/// # Errors
/// PS0129 for a letter that cannot be an argument, or for I, J, K more than ten times.
pub fn locals<'w>(
    words: impl Iterator<Item = &'w MacroWord>,
    letters: Letters,
    unit: LengthUnit,
) -> Result<Locals, Fault> {
    let mut locals: Locals = [None; 33];
    // Set of the last I, J or K, and its index in the set.
    let mut last: Option<(usize, usize)> = None;
    for word in words {
        let fault = Fault::in_macro(MacroAlarm::ArgumentAddress, word.column);
        let is_allowed = match letters {
            Letters::Call => !matches!(word.letter, b'G' | b'L' | b'N' | b'O' | b'P'),
            Letters::Block => word.letter != b'O',
        };
        let mut place = LETTERS.iter().position(|letter| *letter == word.letter).filter(|_| is_allowed).ok_or(fault)?;
        if let b'I'..=b'K' = word.letter {
            let of_set = usize::from(word.letter - b'I');
            let set = last.map_or(0, |(set, before)| if of_set <= before { set + 1 } else { set });
            if set == SETS {
                return Err(fault);
            }
            last = Some((set, of_set));
            place = 3 + 3 * set + of_set;
        }
        if let Some(local) = locals.get_mut(place) {
            *local = Some(value(word, unit));
        }
    }
    Ok(locals)
}

fn value(word: &MacroWord, unit: LengthUnit) -> f64 {
    let counts_whole = matches!(word.letter, b'D'..=b'H' | b'L'..=b'P' | b'S' | b'T');
    let increments = match (word.letter, unit) {
        _ if word.has_point || counts_whole => 1,
        (b'A'..=b'C', _) | (_, LengthUnit::Mm) => 1_000,
        (_, LengthUnit::Inch) => 10_000,
    };
    word.value / f64::from(increments)
}

#[cfg(test)]
mod tests {
    use super::super::code::MacroCode;
    use super::super::expression::Evaluator;
    use super::super::function::AngleRange;
    use super::super::variables::{Context, Variables};
    use super::super::words::read;
    use super::*;
    use arcfeed_nc::modal::Modal;
    use arcfeed_units::Micros;

    fn set(text: &str) -> Result<Vec<(usize, f64)>, Fault> {
        let unit = LengthUnit::Mm;
        let variables = Variables::new(Context::new(&Modal::at_power_on(unit), Micros(0)));
        let code = MacroCode::new(text.as_bytes());
        let words = read(&mut code.cursor(), Evaluator::new(&variables, AngleRange::Positive), unit).unwrap();
        let locals = locals(words.iter(), Letters::Call, unit)?;
        Ok((1..).zip(locals).filter_map(|(number, value)| Some((number, value?))).collect())
    }

    #[test]
    fn every_letter_has_its_variable() {
        // The table of argument specification I.
        let table = [
            ('A', 1),
            ('B', 2),
            ('C', 3),
            ('D', 7),
            ('E', 8),
            ('F', 9),
            ('H', 11),
            ('I', 4),
            ('J', 5),
            ('K', 6),
            ('M', 13),
            ('Q', 17),
            ('R', 18),
            ('S', 19),
            ('T', 20),
            ('U', 21),
            ('V', 22),
            ('W', 23),
            ('X', 24),
            ('Y', 25),
            ('Z', 26),
        ];
        for (letter, number) in table {
            assert_eq!(set(&format!("{letter}2.5")), Ok(vec![(number, 2.5)]), "{letter}");
        }
    }

    #[test]
    fn repeated_centres_fill_the_next_variables_and_the_later_word_wins() {
        // Example of the operator's manual with both specifications in one call.
        assert_eq!(set("A1.0B2.0I-3.0I4.0D5.0"), Ok(vec![(1, 1.0), (2, 2.0), (4, -3.0), (7, 5.0)]));
        let ten = "I1.J1.K1.".repeat(10);
        assert_eq!(set(&ten).unwrap().last(), Some(&(33, 1.0)));
        assert_eq!(set(&(ten + "I1.")), Err(Fault::in_macro(MacroAlarm::ArgumentAddress, 91)));
    }

    #[test]
    fn without_a_point_an_argument_counts_increments_or_whole_ones() {
        assert_eq!(set("X1000F25S900"), Ok(vec![(9, 25.0), (19, 900.0), (24, 1.0)]));
        for text in ["G1", "L2", "N5", "O1", "P2"] {
            assert_eq!(set(text), Err(Fault::in_macro(MacroAlarm::ArgumentAddress, 1)), "{text}");
        }
    }
}
