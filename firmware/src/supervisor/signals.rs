//! Binary signals in one word, one bit each; a single comparison detects that none is set.

/// A set of signals: board faults, requests, and conditions of the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Signals(u32);

/// Fault of the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BoardFault {
    /// The watchdog has expired, now or before this start.
    Watchdog,
    /// The parameters have a wrong checksum or are invalid.
    Parameters,
    /// Failure of supply, clock or output (read back), or a dial that is open or shorted.
    Hardware,
}

/// Request of a person, at the machine or through the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Give the override to the laws.
    Arm,
    /// Give the override back to the operator.
    Disarm,
    /// Clear a fault; only at the machine.
    Reset,
}

/// A condition, reported by the control, under which the override stays with the operator and no law may set it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Condition {
    /// G41 or G42: the control corrects the feed of arcs itself.
    CutterCompensation,
    /// #3004 bit 1: the control ignores the override.
    OverrideOff,
}

/// Reason why the override has nothing to act on at present.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Inhibit {
    /// A tapping cycle.
    Tapping,
    /// Thread cutting.
    Threading,
    /// G63.
    FeedForced,
    /// Positioning.
    Rapid,
    /// The segment has no feed per minute.
    NoFeed,
}

impl Signals {
    /// No signal.
    pub const NONE: Signals = Signals(0);
    /// G41 or G42 is active.
    pub const CUTTER_COMPENSATION: Signals = Signals(1);
    /// #3004 bit 1 is set.
    pub const OVERRIDE_OFF: Signals = Signals(1 << 1);
    /// A tapping cycle is active.
    pub const TAPPING: Signals = Signals(1 << 2);
    /// Thread cutting is active.
    pub const THREADING: Signals = Signals(1 << 3);
    /// G63 is active.
    pub const FEED_FORCED: Signals = Signals(1 << 4);
    /// The axes are positioning.
    pub const RAPID: Signals = Signals(1 << 5);
    /// Feed hold is active.
    pub const FEED_HOLD: Signals = Signals(1 << 6);

    /// Signals with one fault of the board.
    pub const fn of_fault(fault: BoardFault) -> Self {
        Signals(1 << (8 + fault as u32))
    }

    /// Signals with one request: a pressed button or a command of the host. A request acts once, also if held.
    pub const fn of_request(request: Request) -> Self {
        Signals(1 << (16 + request as u32))
    }

    /// Conditions and buttons from the bits of a machine line; `None` if other bits are set, as only the board itself
    /// can report its faults.
    pub const fn of_machine(bits: u32) -> Option<Self> {
        const CONDITIONS: u32 = 0x7F;
        const REQUESTS: u32 = 0b111 << 16;
        if bits & !(CONDITIONS | REQUESTS) == 0 { Some(Signals(bits)) } else { None }
    }

    /// Bits of the signals, as in docs/protocol.md.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Union of two sets.
    #[must_use]
    pub const fn with(self, others: Signals) -> Self {
        Signals(self.0 | others.0)
    }

    /// Whether one of `others` is set.
    pub const fn has(self, others: Signals) -> bool {
        self.0 & others.0 != 0
    }

    /// Signals that are not set in `before`.
    #[must_use]
    pub const fn risen_since(self, before: Signals) -> Self {
        Signals(self.0 & !before.0)
    }

    /// Whether a request is set.
    pub const fn asks(self, request: Request) -> bool {
        self.has(Signals::of_request(request))
    }

    /// The board's fault, if any; the watchdog has priority.
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

    /// Condition that excludes the laws, if any.
    pub fn refusing(self) -> Option<Condition> {
        if self.has(Self::CUTTER_COMPENSATION) {
            Some(Condition::CutterCompensation)
        } else {
            self.has(Self::OVERRIDE_OFF).then_some(Condition::OverrideOff)
        }
    }

    /// Reason why the override must be 100 % at present, if any.
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
