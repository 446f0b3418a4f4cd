//! Reasons, alarms and counters of the supervisor.

use arcfeed_units::PERCENT;
use arcfeed_units::fmath;

use arcfeed_law::NoDemand;

use super::input::Source;
use super::signals::{BoardFault, Condition, Inhibit, Signals};
use super::state::{Disarm, Hold, State};

/// Reason for the override at the output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reason {
    /// The law's demand, or the slew towards it.
    Law,
    /// The law has no demand: 100 %.
    NoDemand(NoDemand),
    /// No law governs the segment: 100 %.
    NoLaw,
    /// The spindle speed is not a positive number: 100 %.
    NoSpindle,
    /// The demand is below `min`: the override is `min`, and the chip is thicker than its target.
    Floor {
        /// Excess of the chip, % rounded up; `u16::MAX` if the demanded feed is 0.
        chip_excess_percent: u16,
    },
    /// The demand is above a limit: the override is at the limit.
    Limited(Limit),
    /// The samples are stale: the override is unchanged.
    Stale,
    /// Armed, without a segment for a law.
    Waiting,
    /// Not armed yet.
    NotArmed,
    /// The axes are held.
    Held(Hold),
    /// Position or link was lost.
    Lost(Source),
    /// The board has a fault.
    Fault(BoardFault),
    /// The override has nothing to act on.
    Inhibited(Inhibit),
    /// The laws were disarmed.
    Disarmed(Disarm),
}

/// Limit that reduces a law's demand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Limit {
    /// `max` of the job.
    Max,
    /// Maximum feed of a linear or rotary axis on this segment.
    Axis,
    /// Clamp of the control on arcs.
    ArcClamp,
    /// The job's maximum feed, or its largest raise of the programmed feed.
    Ceiling,
}

/// Alarm level, for a lamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Alarm {
    /// No alarm.
    None,
    /// Active while the condition that disarmed lasts.
    Passing,
    /// Active until a person resets the fault, or arms or disarms after a loss.
    Latched,
}

/// Reason why arming was rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// A fault is active or was not reset.
    Faulted,
    /// Position or link is not fresh.
    NotFresh,
    /// After a loss: fresh, but not yet for long enough.
    NotResynchronised,
    /// The dial is below its threshold, or was just turned down.
    Operator,
    /// A condition of the control.
    Condition(Condition),
}

/// Counters of events; they saturate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Invalid frames and samples ignored.
    pub invalid_frames: u32,
    /// Ticks in the running state with stale or invalid samples.
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
    /// Number of losses of position or link while engaged.
    pub losses: u32,
    /// Faults.
    pub faults: u32,
    /// Number of disarmings.
    pub disarms: u32,
    /// Rejected armings.
    pub refusals: u32,
}

impl Reason {
    /// Reason of a state; in the running state the target has its own reason.
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
    /// Alarm of a state; it may depend on a condition that excludes the laws.
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
    /// Counts a tick under its reason.
    #[inline(always)]
    pub fn count(&mut self, reason: Reason) {
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

    /// Counts a change of state.
    pub fn count_change(&mut self, from: &State, to: &State) {
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

/// Excess of `level_ratio` over `wanted_ratio`, % rounded up; at least zero.
pub(super) fn excess_percent(level_ratio: f32, wanted_ratio: f32) -> u16 {
    let excess_percent = (level_ratio / fmath::max(wanted_ratio, 0.0) - 1.0) * PERCENT;
    // The conversion saturates at both ends.
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
        counters.count(Reason::Floor { chip_excess_percent: 1 });
        assert_eq!(counters.floor_ticks, u32::MAX);
    }
}
