//! Requirements on the plan of a slot.

use crate::cutter::CupMill;
use crate::vector::Vector;

use super::room::Room;

/// Requirements on a roughing path: allowance, depth, axis, clearance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughing {
    /// Allowance on blades and hub, mm.
    pub allowance_mm: f64,
    /// ADC_MAX, mm.
    pub axial_depth_max_mm: f64,
    /// Place where the turn about B1 meets the suction side's tip curve, as a fraction of the curve from the start edge.
    pub interior_contact: f64,
    /// Approach height above all that turns, mm.
    pub clearance_mm: f64,
    /// Choice of the tool's axis.
    pub axis: AxisChoice,
}

/// Choice of the tool's axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AxisChoice {
    /// LN3 if the ring passes along it, otherwise the nearest direction, towards the roomiest one, along which it does.
    #[default]
    Blade,
    /// Direction with the most room.
    Roomiest,
    /// Given direction, part frame.
    Given(Vector),
    /// Direction with a known room for the cutter, in the slot's normal form.
    Found(Room),
}

/// Surfaces that the ring touches at the base position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BaseLimits {
    /// The sides of the slot, as in the source.
    Sides,
    /// The sides, and the round edges behind them.
    WholeBlades,
}

/// Request for a plan: cutter, requirements, and what part of the depth.
#[derive(Clone, Copy, Debug)]
pub struct Request<'r> {
    /// Cutter.
    pub cutter: &'r CupMill,
    /// Requirements.
    pub roughing: &'r Roughing,
    /// Limits of the base position.
    pub limits: BaseLimits,
    /// Parts of the sides' height, from the hub, beside which the ring does not pass; below
    /// [`RAISES`](super::side::RAISES).
    pub raise: usize,
    /// Most levels, for a comparison of plans: deeper than allowed, if need be.
    pub levels_max: Option<u32>,
}

impl<'r> Request<'r> {
    /// Request for a path over the whole depth, as in the source.
    pub fn whole(cutter: &'r CupMill, roughing: &'r Roughing) -> Self {
        Request { cutter, roughing, limits: BaseLimits::Sides, raise: 0, levels_max: None }
    }

    /// Whether the plan is only compared with others, on fewer samples of the surfaces.
    pub fn is_coarse(&self) -> bool {
        self.levels_max.is_some()
    }
}
