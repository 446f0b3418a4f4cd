//! Requirements on the plan of a cup mill's path through a slot.

use crate::cutter::CupMill;
use crate::vector::Vector;

use super::free_width::FreeWidth;

/// Requirements on a roughing path: allowance, depth of the levels, tool axis, clearance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughing {
    /// Allowance on blades and hub, mm.
    pub allowance_mm: f64,
    /// Greatest axial depth of cut of a level (ADC_MAX), mm.
    pub axial_depth_max_mm: f64,
    /// Point at which the ring, turning about B1, meets the suction side's tip curve, as a fraction of the curve from the start edge.
    pub interior_contact: f64,
    /// Distance by which the tool approaches above everything that turns with the rotor, mm.
    pub clearance_mm: f64,
    /// Choice of the tool's axis.
    pub axis: AxisChoice,
}

/// Way in which the tool's axis is chosen for a slot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AxisChoice {
    /// Along the blade's edge (the source's LN3) or, if the ring does not pass there, the nearest direction in which it does.
    #[default]
    Blade,
    /// Direction with the largest free width.
    Roomiest,
    /// Given direction, in the rotor's own frame.
    Given(Vector),
    /// Direction that a search has found, with its free width, in the slot's normal form.
    Found(FreeWidth),
}

/// Surfaces that the ring touches at the base position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BaseLimits {
    /// The sides of the slot, as in the source.
    Sides,
    /// The whole blades: the sides, and the round edges behind them.
    WholeBlades,
}

/// Request for a plan of a slot: cutter, requirements, and how deep.
#[derive(Clone, Copy, Debug)]
pub struct Request<'r> {
    /// Cutter.
    pub cutter: &'r CupMill,
    /// Requirements.
    pub roughing: &'r Roughing,
    /// Surfaces that the ring touches at the base position.
    pub limits: BaseLimits,
    /// Number of the eighths of the sides' height, from the hub up, beside which the ring does not pass; below
    /// [`EIGHTHS`](super::side::EIGHTHS), 0 for the whole depth.
    pub uncut_eighths: usize,
    /// Greatest number of levels, for a fast comparison of plans; levels may then be deeper than allowed. `None`: no limit.
    pub levels_max: Option<u32>,
}

impl<'r> Request<'r> {
    /// Request for a path over the whole depth, as in the source.
    pub fn whole(cutter: &'r CupMill, roughing: &'r Roughing) -> Self {
        Request { cutter, roughing, limits: BaseLimits::Sides, uncut_eighths: 0, levels_max: None }
    }

    /// Whether the plan is only compared with others, on fewer samples of the surfaces.
    pub fn is_coarse(&self) -> bool {
        self.levels_max.is_some()
    }
}
