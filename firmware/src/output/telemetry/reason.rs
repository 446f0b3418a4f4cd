//! Numbers by which telemetry states the reason of an override.
//!
//! A number never changes its meaning, because loggers outlive firmware versions. New causes get new numbers; the tens
//! digit is the family. Additional data of a reason (the excess of a chip over its target) is the record's detail.
//! docs/outputs.md has the same table.

use crate::supervisor::input::Source;
use crate::supervisor::report::{Limit, Reason};
use crate::supervisor::signals::{BoardFault, Condition, Inhibit};
use crate::supervisor::state::{Disarm, Hold};
use arcfeed_law::NoDemand;

/// Declares the causes with their numbers.
macro_rules! numbered {
    ($($code:literal $cause:ident)+) => {
        /// Reason of the override as a number in telemetry: the supervisor's reason without the data that belong to
        /// it.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[allow(missing_docs, reason = "each is the reason of the same name")]
        #[repr(u8)]
        pub enum Cause {
            $($cause = $code,)+
        }

        impl Cause {
            /// The reason with this number; `None` if no reason has it.
            pub fn of_code(code: u8) -> Option<Self> {
                match code {
                    $($code => Some(Cause::$cause),)+
                    _ => None,
                }
            }
        }
    };
}

numbered! {
    0 Law
    1 Floor
    2 MaxLimit
    3 AxisLimit
    4 ArcClamp
    5 FeedCeiling
    10 NoContact
    11 OutsideValidity
    12 ChipUnreachable
    13 BadInput
    20 NoLaw
    21 NoFeed
    22 NoSpindle
    23 Stale
    30 NotArmed
    31 Waiting
    32 FeedHold
    33 ZeroOverride
    40 PositionLost
    41 LinkLost
    50 Watchdog
    51 Parameters
    52 Hardware
    60 Tapping
    61 Threading
    62 FeedForced
    63 Rapid
    70 DisarmedByOperator
    71 DisarmedOnRequest
    72 CutterCompensation
    73 OverrideOff
}

impl From<Reason> for Cause {
    fn from(reason: Reason) -> Self {
        match reason {
            Reason::Law => Cause::Law,
            Reason::Floor { .. } => Cause::Floor,
            Reason::Limited(Limit::Max) => Cause::MaxLimit,
            Reason::Limited(Limit::Axis) => Cause::AxisLimit,
            Reason::Limited(Limit::ArcClamp) => Cause::ArcClamp,
            Reason::Limited(Limit::Ceiling) => Cause::FeedCeiling,
            Reason::NoDemand(NoDemand::NoContact) => Cause::NoContact,
            Reason::NoDemand(NoDemand::OutsideValidity) => Cause::OutsideValidity,
            Reason::NoDemand(NoDemand::ChipUnreachable) => Cause::ChipUnreachable,
            Reason::NoDemand(NoDemand::BadInput) => Cause::BadInput,
            Reason::NoLaw | Reason::NoDemand(NoDemand::NoLaw) => Cause::NoLaw,
            Reason::NoSpindle => Cause::NoSpindle,
            Reason::Stale => Cause::Stale,
            Reason::NotArmed => Cause::NotArmed,
            Reason::Waiting => Cause::Waiting,
            Reason::Held(Hold::Feed) => Cause::FeedHold,
            Reason::Held(Hold::ZeroOverride) => Cause::ZeroOverride,
            Reason::Lost(Source::Position) => Cause::PositionLost,
            Reason::Lost(Source::Link) => Cause::LinkLost,
            Reason::Fault(BoardFault::Watchdog) => Cause::Watchdog,
            Reason::Fault(BoardFault::Parameters) => Cause::Parameters,
            Reason::Fault(BoardFault::Hardware) => Cause::Hardware,
            Reason::Inhibited(Inhibit::Tapping) => Cause::Tapping,
            Reason::Inhibited(Inhibit::Threading) => Cause::Threading,
            Reason::Inhibited(Inhibit::FeedForced) => Cause::FeedForced,
            Reason::Inhibited(Inhibit::Rapid) => Cause::Rapid,
            Reason::Inhibited(Inhibit::NoFeed) => Cause::NoFeed,
            Reason::Disarmed(Disarm::Operator { .. }) => Cause::DisarmedByOperator,
            Reason::Disarmed(Disarm::Request) => Cause::DisarmedOnRequest,
            Reason::Disarmed(Disarm::Condition(Condition::CutterCompensation)) => Cause::CutterCompensation,
            Reason::Disarmed(Disarm::Condition(Condition::OverrideOff)) => Cause::OverrideOff,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOOK: &str = include_str!("../../../../docs/outputs.md");

    #[test]
    fn every_number_leads_to_its_cause_and_back() {
        let known: Vec<Cause> = (0..=255).filter_map(Cause::of_code).collect();
        assert!(known.iter().all(|cause| Cause::of_code(*cause as u8) == Some(*cause)));
        assert_eq!(known.len(), 31);
    }

    #[test]
    fn the_book_lists_the_same_numbers() {
        for code in 0..=255 {
            let rows = BOOK.lines().filter(|line| line.starts_with(&format!("| {code} | `")));
            let listed: Vec<&str> = rows.filter_map(|row| row.split('`').nth(1)).collect();
            let expected: Vec<String> = Cause::of_code(code).iter().map(|cause| format!("{cause:?}")).collect();
            assert_eq!(listed, expected, "cause {code} in docs/outputs.md");
        }
    }
}
