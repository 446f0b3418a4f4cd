//! Reasons, alarms and counters of the supervisor, which decides whether the feed laws may set the override.

use arcfeed_units::PERCENT;
use arcfeed_units::fmath;

use arcfeed_law::NoDemand;

use super::input::Source;
use super::signals::{BoardFault, Condition, Inhibit, Signals};
use super::state::{Disarm, Hold, State};

/// Reason for the override that is output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reason {
    /// The law's demand, or the ramp towards it.
    Law,
    /// The law has no feed to demand at this place: 100 %.
    NoDemand(NoDemand),
    /// No cut rule of the job matches the move, so no law governs it: 100 %.
    NoLaw,
    /// The measured spindle speed is not a positive number: 100 %.
    NoSpindle,
    /// The law demands less than the lower bound of the override, which is output: the chip is thicker than its
    /// target.
    Floor {
        /// Amount by which the chip exceeds its target, % rounded up; `u16::MAX` if the law demands a feed of zero.
        chip_excess_percent: u16,
    },
    /// The law demands more than an upper limit allows: the override is at the limit.
    Limited(Limit),
    /// Position or link is stale, but not lost: the override stays as it was.
    Stale,
    /// The laws may set the override, but no segment is in execution on which one can act.
    Waiting,
    /// The laws have not been armed since the start.
    NotArmed,
    /// The axes are at standstill, by feed hold or an override of 0 %.
    Held(Hold),
    /// Position or link was lost, and the laws have not been armed since.
    Lost(Source),
    /// The board has a fault.
    Fault(BoardFault),
    /// The override does not act on the present feed.
    Inhibited(Inhibit),
    /// The override was taken from the laws.
    Disarmed(Disarm),
}

/// Upper limit that reduces a law's demand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Limit {
    /// The upper bound of the override in the job.
    Max,
    /// Maximum feed of a linear or rotary axis on this segment.
    Axis,
    /// The control's reduction of the feed on arcs, by their radius.
    ArcClamp,
    /// The job's maximum feed, or its maximum multiple of the programmed feed.
    Ceiling,
}

/// Alarm level of the board, for a lamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Alarm {
    /// No alarm.
    None,
    /// Alarm as long as the condition of the control lasts because of which the laws were disarmed.
    Passing,
    /// Alarm until a person acts: resets a fault, or arms or disarms after a loss.
    Latched,
}

/// Reason why a person's request to arm the laws was rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// The board has a fault, or it was not reset.
    Faulted,
    /// The data of position or link are not recent and valid.
    NotFresh,
    /// The data are recent and valid again after a loss, but not for the required time.
    NotResynchronised,
    /// The operator's dial is below its threshold, or was just turned down too far.
    Operator,
    /// A condition of the control forbids that a law sets the override.
    Condition(Condition),
}

/// Counts of events since the start; they stop at their maximum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Invalid frames and samples, which were ignored.
    pub invalid_frames: u32,
    /// Ticks at which a law could not act because position or link was stale.
    pub stale_ticks: u32,
    /// Ticks at which the law had no demand because the cutting edges do not meet the stock.
    pub no_contact_ticks: u32,
    /// Ticks at which the law had no demand because its formula is not valid at this place.
    pub outside_validity_ticks: u32,
    /// Ticks at which the law had no demand because no feed gives the wanted chip.
    pub unreachable_ticks: u32,
    /// Ticks at which the law had no demand because an input or its result was not a number.
    pub bad_input_ticks: u32,
    /// Ticks without a measured spindle speed.
    pub no_spindle_ticks: u32,
    /// Ticks at which the law demanded less than the lower bound of the override.
    pub floor_ticks: u32,
    /// Ticks at which the law demanded more than an upper limit.
    pub limited_ticks: u32,
    /// Losses of position or link while the laws were armed.
    pub losses: u32,
    /// Faults of the board.
    pub faults: u32,
    /// Number of times that the override was taken from the armed laws.
    pub disarms: u32,
    /// Rejected requests to arm.
    pub refusals: u32,
}

impl Reason {
    /// Reason that belongs to a state. In the running state, the law's target has the more exact reason.
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
    /// Alarm level that belongs to a state, and to the conditions of the control among the signals.
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
    /// Counts one tick under its reason; reasons without a counter are not counted.
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

    /// Counts a change of state as fault, loss or disarming.
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
