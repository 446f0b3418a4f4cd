//! What the supervisor says about its decisions.

use arcfeed_shared::fmath;
use arcfeed_shared::units::PERCENT;

use crate::law::NoDemand;

use super::input::Source;
use super::signals::{BoardFault, Condition, Inhibit, Signals};
use super::state::{Disarm, Hold, State};

/// Why the override is what it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Reason {
    /// The law's demand, or on its way there.
    Law,
    /// The law has no demand: 100 %.
    NoDemand(NoDemand),
    /// No law governs the segment: 100 %.
    NoLaw,
    /// The spindle's speed is not a positive number: 100 %.
    NoSpindle,
    /// The demand lies below `min`: `min`, and the chip is thicker than its target.
    Floor {
        /// By how much, % rounded up; `u16::MAX` where the law wants no feed at all.
        chip_excess_percent: u16,
    },
    /// The demand lies above a limit: the limit.
    Limited(Limit),
    /// The samples are too old to act on: unchanged.
    Stale,
    /// Armed, nothing that a law could take up.
    Waiting,
    /// Never armed.
    NotArmed,
    /// The axes stand.
    Held(Hold),
    /// Position or link was lost.
    Lost(Source),
    /// The board failed.
    Fault(BoardFault),
    /// Nothing to act on.
    Inhibited(Inhibit),
    /// The override was taken from the laws.
    Disarmed(Disarm),
}

/// The limit that a demand ran into.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Limit {
    /// `max` of the job.
    Max,
    /// What a linear or rotary axis can do on this segment.
    Axis,
    /// The control's own clamp of the feed on arcs.
    ArcClamp,
    /// The job's fastest feed, or its largest raise of the programmed one.
    Ceiling,
}

/// Whether somebody should look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alarm {
    /// No.
    None,
    /// For as long as the condition that disarmed lasts.
    Passing,
    /// Until a person acts: resets a fault, arms or disarms after a loss.
    Latched,
}

/// Why arming was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// A fault is there, or was not reset.
    Faulted,
    /// Position or link is not fresh.
    NotFresh,
    /// After a loss: fresh, but not for long enough yet.
    NotResynchronised,
    /// The dial is below its threshold, or was just turned down.
    Operator,
    /// A condition of the control.
    Condition(Condition),
}

/// How often things happened; they stop at the largest number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Invalid frames and samples ignored.
    pub invalid_frames: u32,
    /// Ticks at which running stood still for stale or invalid samples.
    pub stale_ticks: u32,
    /// Ticks without a demand: the law does not meet the stock.
    pub no_contact_ticks: u32,
    /// Ticks without a demand: outside the law's validity.
    pub outside_validity_ticks: u32,
    /// Ticks without a demand: the chip cannot be reached.
    pub unreachable_ticks: u32,
    /// Ticks without a demand: an input or the demand is not a number.
    pub bad_input_ticks: u32,
    /// Ticks without a spindle speed.
    pub no_spindle_ticks: u32,
    /// Ticks at the floor.
    pub floor_ticks: u32,
    /// Ticks at a limit.
    pub limited_ticks: u32,
    /// Times position or link was lost while engaged.
    pub losses: u32,
    /// Faults.
    pub faults: u32,
    /// Times the override was taken from the laws.
    pub disarms: u32,
    /// Armings refused.
    pub refusals: u32,
}

impl Reason {
    /// The reason that a state has by itself; while running the target has its own.
    pub fn of_state(state: &State) -> Self {
        match *state {
            State::Idle => Reason::NotArmed,
            State::Armed => Reason::Waiting,
            State::Running => Reason::Stale,
            State::Holding { cause } => Reason::Held(cause),
            State::Fallback { source, .. } => Reason::Lost(source),
            State::Faulted { fault } => Reason::Fault(fault),
            State::Inhibited { why } => Reason::Inhibited(why),
            State::Disarmed { by } => Reason::Disarmed(by),
        }
    }
}

impl Alarm {
    /// The alarm of a state, which may last for as long as a condition that forbids the laws.
    #[inline(always)]
    pub fn of(state: &State, signals: Signals) -> Self {
        match state {
            State::Faulted { .. } | State::Fallback { .. } => Alarm::Latched,
            State::Disarmed { by: Disarm::Condition(_) } if signals.refusing().is_some() => Alarm::Passing,
            State::Idle
            | State::Armed
            | State::Running
            | State::Holding { .. }
            | State::Inhibited { .. }
            | State::Disarmed { .. } => Alarm::None,
        }
    }
}

impl Counters {
    /// Counts a tick by its reason.
    #[inline(always)]
    pub fn take(&mut self, reason: Reason) {
        let counter = match reason {
            Reason::NoDemand(NoDemand::NoContact) => &mut self.no_contact_ticks,
            Reason::NoDemand(NoDemand::OutsideValidity) => &mut self.outside_validity_ticks,
            Reason::NoDemand(NoDemand::ChipUnreachable) => &mut self.unreachable_ticks,
            Reason::NoDemand(NoDemand::BadInput) => &mut self.bad_input_ticks,
            Reason::NoSpindle => &mut self.no_spindle_ticks,
            Reason::Floor { .. } => &mut self.floor_ticks,
            Reason::Limited(_) => &mut self.limited_ticks,
            Reason::Stale => &mut self.stale_ticks,
            Reason::Law
            | Reason::NoLaw
            | Reason::NoDemand(NoDemand::NoLaw)
            | Reason::Waiting
            | Reason::NotArmed
            | Reason::Held(_)
            | Reason::Lost(_)
            | Reason::Fault(_)
            | Reason::Inhibited(_)
            | Reason::Disarmed(_) => return,
        };
        count(counter);
    }

    /// Counts what a change of state means.
    pub fn take_change(&mut self, from: &State, to: &State) {
        match (from.is_engaged(), to) {
            (_, State::Faulted { .. }) => count(&mut self.faults),
            (true, State::Fallback { .. }) => count(&mut self.losses),
            (true, State::Disarmed { .. }) => count(&mut self.disarms),
            (true | false, State::Idle | State::Armed | State::Running)
            | (true | false, State::Holding { .. } | State::Inhibited { .. })
            | (false, State::Fallback { .. } | State::Disarmed { .. }) => {}
        }
    }
}

fn count(counter: &mut u32) {
    *counter = counter.saturating_add(1);
}

/// By how much `level_ratio` exceeds `wanted_ratio`, % rounded up; no excess is zero.
pub(super) fn excess_percent(level_ratio: f32, wanted_ratio: f32) -> u16 {
    let excess_percent = (level_ratio / fmath::max(wanted_ratio, 0.0) - 1.0) * PERCENT;
    // The conversion saturates, and takes no excess for zero.
    fmath::ceil(excess_percent) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_excess_is_rounded_up_and_never_negative() {
        for (level, wanted, percent) in [
            (0.1, 0.08, 25),
            (0.1, 0.0, u16::MAX),
            (0.0, 0.0, 0),
            (0.1, 0.099_9, 1),
            (0.09, 0.1, 0),
            (0.5, -1.0, u16::MAX),
        ] {
            assert_eq!(excess_percent(level, wanted), percent, "{level} {wanted}");
        }
    }

    #[test]
    fn counters_stop_at_the_largest_number() {
        let mut counters = Counters { floor_ticks: u32::MAX, ..Counters::default() };
        counters.take(Reason::Floor { chip_excess_percent: 1 });
        assert_eq!(counters.floor_ticks, u32::MAX);
    }
}
