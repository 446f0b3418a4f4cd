//! The numbers of the reasons in telemetry.
//!
//! A number, once given, keeps its meaning: loggers outlive firmware. New reasons take new numbers; the tens tell the
//! family (0 law and bounds, 10 no wish, 20 no law at work). docs/outputs.md has the same table.

use arcfeed_shared::machine::LimitedBy;

use crate::controller::Reason;
use crate::law::NoWish;
use crate::ramp::Bound;

/// One table, read in both directions: a reason without a number does not compile.
macro_rules! numbered {
    ($($code:literal => $reason:tt)+) => {
        /// The number of a reason.
        pub fn code_of(reason: Reason) -> u8 {
            match reason {
                $(numbered!(@pattern $reason) => $code,)+
            }
        }

        /// The reason of a number, if it has been given to one.
        pub fn reason_of(code: u8) -> Option<Reason> {
            match code {
                $($code => Some(numbered!(@pattern $reason)),)+
                _ => None,
            }
        }
    };
    (@pattern { $($reason:tt)+ }) => { $($reason)+ };
}

numbered! {
    0 => { Reason::Law }
    1 => { Reason::Bounded(Bound::Floor) }
    2 => { Reason::Bounded(Bound::Ceiling) }
    3 => { Reason::Bounded(Bound::Slew) }
    // Does not occur: what no bound holds back has its own reason.
    4 => { Reason::Bounded(Bound::Free) }
    5 => { Reason::Bounded(Bound::NotANumber) }
    6 => { Reason::Bounded(Bound::Machine(LimitedBy::Axis)) }
    7 => { Reason::Bounded(Bound::Machine(LimitedBy::ArcClamp)) }
    10 => { Reason::NoWish(NoWish::NoContact) }
    11 => { Reason::NoWish(NoWish::OutsideValidity) }
    12 => { Reason::NoWish(NoWish::ChipUnreachable) }
    13 => { Reason::NoWish(NoWish::BadInput) }
    20 => { Reason::NoWish(NoWish::NoLaw) }
    21 => { Reason::Inhibited }
    22 => { Reason::NoSpindle }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOOK: &str = include_str!("../../../../docs/outputs.md");

    #[test]
    fn every_number_leads_to_its_reason_and_back() {
        let known: Vec<u8> = (0..=255).filter(|code| reason_of(*code).is_some()).collect();
        assert!(known.iter().all(|code| reason_of(*code).map(code_of) == Some(*code)));
        assert_eq!(known, [0, 1, 2, 3, 4, 5, 6, 7, 10, 11, 12, 13, 20, 21, 22]);
    }

    #[test]
    fn the_book_lists_the_same_numbers() {
        for code in 0..=255 {
            let rows = BOOK.lines().filter(|line| line.starts_with(&format!("| {code} | `")));
            let listed: Vec<&str> = rows.filter_map(|row| row.split('`').nth(1)).collect();
            let expected: Vec<String> = reason_of(code).iter().map(|reason| format!("{reason:?}")).collect();
            assert_eq!(listed, expected, "reason {code} in docs/outputs.md");
        }
    }
}
