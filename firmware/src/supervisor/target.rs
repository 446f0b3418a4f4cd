//! Target ratio at a place of a segment: the law's demand within the machine's limits and the job's bounds.

use arcfeed_model::machine::LimitedBy;
use arcfeed_units::fmath;
use arcfeed_units::{MmPerTooth, RevPerMin};

use crate::active::{ActiveSegment, MachineRatio};
use crate::ramp::{Bound, Ramp};
use arcfeed_law::NoDemand;

use super::report::{Limit, Reason, excess_percent};
use super::signals::Inhibit;

/// Override ratio that the law's demand leads to at a place of a segment, with its reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Target feed divided by the sent feed, reduced by the operator's dial.
    pub override_ratio: f32,
    /// Reason for the override once the ramp has reached this ratio.
    pub reason: Reason,
    /// Target feed per tooth at the tool's centre, along the path, lowered in time for what the rest of the segment
    /// demands; `None` without a demand.
    pub ipt_center: Option<MmPerTooth>,
}

/// Demand at a place, before any bound.
#[derive(Clone, Copy, Debug)]
struct Demand {
    ratio: f32,
    ipt_center: Option<MmPerTooth>,
    reason: Reason,
    machine: MachineRatio,
}

impl Target {
    /// Target after this distance travelled on the segment; `share_ratio`, at most 1, is the factor of the operator's
    /// dial.
    #[inline(always)]
    pub fn at(travelled_mm: f32, segment: &ActiveSegment, spindle: RevPerMin, ramp: &Ramp, share_ratio: f32) -> Self {
        let Demand { ratio: demanded_ratio, ipt_center, reason, machine } = Demand::at(travelled_mm, segment, spindle);
        let (feasible_ratio, reason) = if machine.feed_ratio < demanded_ratio {
            (machine.feed_ratio, Reason::Limited(Limit::of_machine(machine.by)))
        } else {
            (demanded_ratio, reason)
        };
        let (bounded_ratio, bound) = ramp.bounded(feasible_ratio);
        let override_ratio = bounded_ratio * share_ratio;
        let reason = match bound {
            Bound::Free => reason,
            Bound::Floor => Reason::Floor { chip_excess_percent: excess_percent(override_ratio, demanded_ratio) },
            Bound::Ceiling => Reason::Limited(Limit::Max),
            Bound::NotANumber => Reason::NoDemand(NoDemand::BadInput),
        };
        Target { override_ratio, reason, ipt_center }
    }
}

impl Demand {
    #[inline(always)]
    fn at(travelled_mm: f32, segment: &ActiveSegment, spindle: RevPerMin) -> Self {
        let (planned_ratio, answer) = segment.envelope.at(travelled_mm);
        let ratio = planned_ratio * segment.envelope.spindle_share(spindle);
        let as_sent = |ratio, reason| Demand { ratio, ipt_center: None, reason, machine: MachineRatio::FREE };
        let Some(sent) = segment.sent() else { return as_sent(ratio, Reason::Inhibited(Inhibit::NoFeed)) };
        match answer {
            Err(NoDemand::NoLaw) => as_sent(ratio, Reason::NoLaw),
            // A stopped spindle cuts no chip.
            _ if !fmath::is_positive(spindle.0) => as_sent(1.0, Reason::NoSpindle),
            // No feed is too high for the chip: the bounds decide.
            Err(NoDemand::ChipUnreachable) => {
                Demand { machine: sent.machine, ..as_sent(ratio, Reason::NoDemand(NoDemand::ChipUnreachable)) }
            }
            Err(refusal) => as_sent(ratio, Reason::NoDemand(refusal)),
            Ok(()) => Demand {
                ratio,
                ipt_center: Some(MmPerTooth(sent.ipt_center.0 * planned_ratio)),
                reason: Reason::Law,
                machine: sent.machine,
            },
        }
    }
}

impl Limit {
    fn of_machine(by: LimitedBy) -> Self {
        match by {
            LimitedBy::Axis => Limit::Axis,
            LimitedBy::ArcClamp => Limit::ArcClamp,
            LimitedBy::Ceiling => Limit::Ceiling,
        }
    }
}
