//! Binary signals for the supervisor (faults, requests, conditions) in one word, one bit each; a single comparison
//! detects that none is set.

/// Set of binary signals for the supervisor: faults of the board, requests of a person, and conditions of the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Signals(u32);

/// Fault of the board: 0 % until a person resets it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BoardFault {
    /// The watchdog has expired, since the start or as the cause of it.
    Watchdog,
    /// The parameters have a wrong checksum or are invalid.
    Parameters,
    /// Failure of supply, clock or output (read back), or a dial that is open or shorted.
    Hardware,
}

/// Request of a person, by a button at the machine or through the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Arm: the laws may set the override.
    Arm,
    /// Disarm: the operator's dial sets the override.
    Disarm,
    /// Clear a fault of the board; only by a button at the machine.
    Reset,
}

/// A condition, reported by the control, under which the override stays with the operator and no law may set it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Condition {
    /// Cutter compensation (G41, G42): the control itself changes the feed on arcs.
    CutterCompensation,
    /// Bit 1 of the macro variable #3004: the control ignores the override.
    OverrideOff,
}

/// Reason why the override does not act on the present feed, so that no law may set it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Inhibit {
    /// A tapping cycle runs.
    Tapping,
    /// A thread is being cut.
    Threading,
    /// G63 (tapping mode) holds the feed at 100 %.
    FeedForced,
    /// The axes are in rapid traverse.
    Rapid,
    /// The segment in execution has no feed per minute.
    NoFeed,
}

impl Signals {
    /// No signal.
    pub const NONE: Signals = Signals(0);
    /// The control reports cutter compensation (G41 or G42).
    pub const CUTTER_COMPENSATION: Signals = Signals(1);
    /// The control reports that bit 1 of #3004 is set, so it ignores the override.
    pub const OVERRIDE_OFF: Signals = Signals(1 << 1);
    /// The control reports a tapping cycle.
    pub const TAPPING: Signals = Signals(1 << 2);
    /// The control reports thread cutting.
    pub const THREADING: Signals = Signals(1 << 3);
    /// The control reports G63 (tapping mode), which holds the feed at 100 %.
    pub const FEED_FORCED: Signals = Signals(1 << 4);
    /// The control reports rapid traverse.
    pub const RAPID: Signals = Signals(1 << 5);
    /// The control reports feed hold.
    pub const FEED_HOLD: Signals = Signals(1 << 6);

    /// The set with only this fault of the board.
    pub const fn of_fault(fault: BoardFault) -> Self {
        Signals(1 << (8 + fault as u32))
    }

    /// The set with only this request, which a pressed button or a message of the host makes. It acts once, even if it
    /// lasts.
    pub const fn of_request(request: Request) -> Self {
        Signals(1 << (16 + request as u32))
    }

    /// The set with these bits, as a machine reports them; `None` if other bits are set, because only the board itself
    /// can report its faults.
    pub const fn of_machine(bits: u32) -> Option<Self> {
        const CONDITIONS: u32 = 0x7F;
        const REQUESTS: u32 = 0b111 << 16;
        if bits & !(CONDITIONS | REQUESTS) == 0 { Some(Signals(bits)) } else { None }
    }

    /// The set as bits, numbered as in docs/protocol.md.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// The signals that are in either set.
    #[must_use]
    pub const fn with(self, others: Signals) -> Self {
        Signals(self.0 | others.0)
    }

    /// Whether at least one of `others` is in the set.
    pub const fn has(self, others: Signals) -> bool {
        self.0 & others.0 != 0
    }

    /// The signals of this set that are not in `before`.
    #[must_use]
    pub const fn risen_since(self, before: Signals) -> Self {
        Signals(self.0 & !before.0)
    }

    /// Whether this request is in the set.
    pub const fn asks(self, request: Request) -> bool {
        self.has(Signals::of_request(request))
    }

    /// The fault in the set, `None` without one; if there are several, the watchdog first.
    #[inline(always)]
    pub fn fault(self) -> Option<BoardFault> {
        let faults = [BoardFault::Watchdog, BoardFault::Parameters, BoardFault::Hardware];
        let any = faults.map(Signals::of_fault).into_iter().fold(Signals::NONE, Signals::with);
        // One comparison in the usual case without a fault.
        if !self.has(any) {
            return None;
        }
        faults.into_iter().find(|fault| self.has(Signals::of_fault(*fault)))
    }

    /// The condition in the set under which no law may set the override; `None` without one.
    pub fn refusing(self) -> Option<Condition> {
        if self.has(Self::CUTTER_COMPENSATION) {
            Some(Condition::CutterCompensation)
        } else {
            self.has(Self::OVERRIDE_OFF).then_some(Condition::OverrideOff)
        }
    }

    /// The reason in the set why the override does not act on the present feed; `None` without one.
    #[inline(always)]
    pub fn inhibiting(self) -> Option<Inhibit> {
        let causes = [
            (Self::TAPPING, Inhibit::Tapping),
            (Self::THREADING, Inhibit::Threading),
            (Self::FEED_FORCED, Inhibit::FeedForced),
            (Self::RAPID, Inhibit::Rapid),
        ];
        if !self.has(Self::TAPPING.with(Self::THREADING).with(Self::FEED_FORCED).with(Self::RAPID)) {
            return None;
        }
        causes.into_iter().find(|(condition, _)| self.has(*condition)).map(|(_, why)| why)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_signal_is_a_bit_of_its_own() {
        let conditions = [
            Signals::CUTTER_COMPENSATION,
            Signals::OVERRIDE_OFF,
            Signals::TAPPING,
            Signals::THREADING,
            Signals::FEED_FORCED,
            Signals::RAPID,
            Signals::FEED_HOLD,
        ];
        let faults = [BoardFault::Watchdog, BoardFault::Parameters, BoardFault::Hardware].map(Signals::of_fault);
        let requests = [Request::Arm, Request::Disarm, Request::Reset].map(Signals::of_request);
        let all = conditions.into_iter().chain(faults).chain(requests);
        assert_eq!(all.clone().fold(Signals::NONE, Signals::with).0.count_ones(), all.count() as u32);
    }

    #[test]
    fn a_held_button_has_not_risen() {
        let (arm, disarm) = (Signals::of_request(Request::Arm), Signals::of_request(Request::Disarm));
        assert!(arm.risen_since(Signals::NONE).asks(Request::Arm));
        assert!(!arm.risen_since(arm).asks(Request::Arm));
        assert!(arm.with(disarm).risen_since(arm).asks(Request::Disarm));
    }
}
