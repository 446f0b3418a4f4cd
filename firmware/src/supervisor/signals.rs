//! What is on or off, one bit each, in one word: a tick on which nothing is on is told by one comparison.

/// Any number of signals at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Signals(u32);

/// What the board finds wrong with itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BoardFault {
    /// The watchdog bit, now or before this start.
    Watchdog,
    /// The parameters fail their check sum or their validation.
    Parameters,
    /// Supply, clock, output read back wrong, dial open or shorted.
    Hardware,
}

/// What a person, or the host for one, asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Let the laws have the override.
    Arm,
    /// Give it back to the operator.
    Disarm,
    /// Clear a fault; only for a person at the machine.
    Reset,
}

/// A condition under which the laws must not have the override.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Condition {
    /// G41 or G42: the control corrects the feed of arcs itself.
    CutterCompensation,
    /// #3004 bit 1: the control ignores the override.
    OverrideOff,
}

/// Why the override has nothing to act on for now.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
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
    /// None.
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

    /// A fault of the board.
    pub const fn of_fault(fault: BoardFault) -> Self {
        Signals(1 << (8 + fault as u32))
    }

    /// A button pressed or a command of the host; held, it counts once.
    pub const fn of_request(request: Request) -> Self {
        Signals(1 << (16 + request as u32))
    }

    /// Conditions and buttons by their bits, as a machine line brings them; `None` if other bits are among them: what is wrong
    /// with the board only the board knows.
    pub const fn of_machine(bits: u32) -> Option<Self> {
        const CONDITIONS: u32 = 0x7F;
        const REQUESTS: u32 = 0b111 << 16;
        if bits & !(CONDITIONS | REQUESTS) == 0 { Some(Signals(bits)) } else { None }
    }

    /// A bit each, as in docs/protocol.md.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Both these and those.
    #[must_use]
    pub const fn with(self, others: Signals) -> Self {
        Signals(self.0 | others.0)
    }

    /// Whether one of `others` is among these.
    pub const fn has(self, others: Signals) -> bool {
        self.0 & others.0 != 0
    }

    /// Those that were not among `before`.
    #[must_use]
    pub const fn risen_since(self, before: Signals) -> Self {
        Signals(self.0 & !before.0)
    }

    /// Whether a request is among these.
    pub const fn asks(self, request: Request) -> bool {
        self.has(Signals::of_request(request))
    }

    /// The board's fault, if it has one; the watchdog first.
    #[inline(always)]
    pub fn fault(self) -> Option<BoardFault> {
        let faults = [BoardFault::Watchdog, BoardFault::Parameters, BoardFault::Hardware];
        let any = faults.map(Signals::of_fault).into_iter().fold(Signals::NONE, Signals::with);
        // One comparison where there is none, as nearly always.
        if !self.has(any) {
            return None;
        }
        faults.into_iter().find(|fault| self.has(Signals::of_fault(*fault)))
    }

    /// The condition that keeps the laws off the override, if any.
    pub fn refusing(self) -> Option<Condition> {
        if self.has(Self::CUTTER_COMPENSATION) {
            Some(Condition::CutterCompensation)
        } else {
            self.has(Self::OVERRIDE_OFF).then_some(Condition::OverrideOff)
        }
    }

    /// Why the override must stay at 100 % for now, if it must.
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
