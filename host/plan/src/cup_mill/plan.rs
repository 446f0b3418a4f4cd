//! Plan of one slot: all steps of the method, in order.

use arcfeed_nc::modal::Turn;
use nalgebra::Rotation3;

use crate::cutter::CupMill;
use crate::frame::slot_frame;
use crate::geometry::blisk::{Blisk, Slot};
use crate::path::{Level, SlotPath};
use crate::vector::{Point, Vector};

use super::axis::{Axis, axis};
use super::base::{Base, Limits, settle};
use super::depth::{levels_mm, top_mm};
use super::infeasibility::{Infeasible, narrow};
use super::interior::{InteriorPivot, interior};
use super::level::Stop;
use super::neighbours::{Reach, WholeBlade};
use super::patch::Patch;
use super::room::{Room, SidePoints};
use super::side::{FarEdge, Hub, SideRange, floor, roof};
use super::turns::{Surroundings, Turns};

/// Requirements on the roughing path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughing {
    /// Allowance on blades and hub, mm.
    pub allowance_mm: f64,
    /// ADC_MAX, mm.
    pub axial_depth_max_mm: f64,
    /// Place where the turn about B1 meets the suction side's tip curve, as a fraction of the curve from the leading
    /// edge.
    pub interior_contact: f64,
    /// Approach height above the blank, mm.
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
    /// Direction with a known room for the cutter.
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

/// Plan of a slot.
#[derive(Clone, Debug)]
pub struct SlotPlan {
    /// LN3 and its points, part frame.
    pub blade_axis: Axis,
    /// Room along LN3.
    pub blade_room: Room,
    /// Room along the axis taken.
    pub room: Room,
    /// Rotation from the part frame into the slot frame.
    pub turn: Rotation3<f64>,
    /// Base position.
    pub base: Base,
    /// B1.
    pub interior: InteriorPivot,
    /// Ends of the turns about A and about B1, from the top.
    pub stops: Vec<[Stop; 2]>,
    /// Highest material under the ring at the base position, mm.
    pub top_mm: f64,
    /// Path.
    pub path: SlotPath,
}

/// Distance from the roomiest place to which the ring's axis moves at most, mm.
const TRAVEL_MM: f64 = 40.0;
/// Room below which another direction is searched, mm: rooms are computed on samples of the sides.
const ENOUGH_MM: f64 = 0.1;

/// Data of a slot that are the same for every cutter and every direction of the tool.
pub struct PreparedSlot {
    pressure: SideRange,
    suction: SideRange,
    blade: WholeBlade,
    hub: Patch,
    roof: Patch,
    blade_axis: Axis,
    /// Sides of the slot, for choosing directions.
    pub walls: SidePoints,
}

/// Plans the slot of a rotor, given in the part frame.
///
/// # Errors
/// The ring does not pass, or does not reach the hub.
pub fn plan(blisk: &Blisk, slot: &Slot, cutter: &CupMill, roughing: &Roughing) -> Result<SlotPlan, Infeasible> {
    PreparedSlot::new(blisk, slot, roughing.allowance_mm)?
        .plan(cutter, roughing, BaseLimits::Sides)
        .map(|(plan, _)| plan)
}

impl PreparedSlot {
    /// Prepares a slot with its allowance.
    ///
    /// # Errors
    /// A blade is not above the hub.
    pub fn new(blisk: &Blisk, slot: &Slot, allowance_mm: f64) -> Result<Self, Infeasible> {
        let above = Hub { hub: &blisk.hub, allowance_mm };
        let trim = |face, far, name| SideRange::new(face, far, &above).ok_or(Infeasible::NoFoot(name));
        let (sides, blade_axis) = rayon::join(
            || {
                rayon::join(
                    || trim(&slot.pressure, FarEdge::Trailing, "pressure"),
                    || trim(&slot.suction, FarEdge::Leading, "suction"),
                )
            },
            || axis(&slot.pressure, &blisk.hub, allowance_mm).ok_or(Infeasible::NoFoot("pressure")),
        );
        let (pressure, suction, blade_axis) = (sides.0?, sides.1?, blade_axis?);
        let lying = Rotation3::identity();
        let walls = SidePoints::new(&pressure.side(&lying), &suction.side(&lying));
        let about = bearings(slot);
        let (hub, roof) = (floor(blisk, allowance_mm, about), roof(blisk, about));
        let blade = WholeBlade::new(blisk, allowance_mm, [pressure.foot(), suction.foot()]);
        Ok(PreparedSlot { pressure, suction, blade, hub, roof, blade_axis, walls })
    }

    /// The plan, and the surroundings of the slot in its frame. The allowance is that for which the slot was prepared.
    ///
    /// # Errors
    /// The ring does not pass, or does not reach the hub.
    pub fn plan(
        &self,
        cutter: &CupMill,
        roughing: &Roughing,
        limits: BaseLimits,
    ) -> Result<(SlotPlan, Surroundings), Infeasible> {
        let PreparedSlot { pressure, suction, blade, hub, roof, blade_axis, walls } = self;
        let blade_room = walls.room(cutter, &blade_axis.direction).ok_or(Infeasible::NoAxis)?;
        let room = match roughing.axis {
            AxisChoice::Blade => self.near_blade(cutter, || walls.roomiest(cutter)),
            AxisChoice::Roomiest => walls.roomiest(cutter),
            AxisChoice::Given(direction) => direction.try_normalize(0.0).and_then(|axis| walls.room(cutter, &axis)),
            AxisChoice::Found(room) => Some(room),
        };
        let room = room.ok_or(Infeasible::NoAxis)?;
        let turn = slot_frame(&room.direction).ok_or(Infeasible::NoAxis)?;
        let sides = [pressure.side(&turn), suction.side(&turn)];
        if room.room_mm < 0.0 {
            return Err(narrow(&room, &sides[0], &sides[1]));
        }
        let hub = hub.turned(&turn);
        let lowest_mm =
            sides.iter().flat_map(|side| side.patch.samples()).map(|point| point.z).fold(f64::MAX, f64::min);
        let reach = Reach { centre: room.centre, travel_mm: TRAVEL_MM, bottom_mm: lowest_mm };
        let blades = blade.about(&turn, cutter, &reach);
        let [pressure, suction] = sides;
        let around = Surroundings { pressure, suction, hub, blades };
        let level_context =
            around.level_context(cutter, roughing, limits).ok_or(Infeasible::NoBase { room_mm: room.room_mm })?;
        let top_mm = top_mm(cutter, level_context.base.centre, &roof.turned(&turn)).ok_or(Infeasible::NoFloor)?;
        let (stops, path) = level_context.levels(cutter, roughing, top_mm)?;
        let (base, interior) = (level_context.base, level_context.interior);
        let plan = SlotPlan { blade_axis: *blade_axis, blade_room, room, turn, base, interior, stops, top_mm, path };
        Ok((plan, around))
    }

    /// Blade's axis, or the nearest direction, towards the roomiest one, with enough room.
    pub fn near_blade(&self, cutter: &CupMill, roomiest: impl Fn() -> Option<Room>) -> Option<Room> {
        let blade = self.walls.room(cutter, &self.blade_axis.direction)?;
        if blade.room_mm >= ENOUGH_MM {
            return Some(blade);
        }
        let roomiest = roomiest()?;
        Some(self.walls.nearest(cutter, &blade, &roomiest, ENOUGH_MM.min(roomiest.room_mm / 2.0)))
    }
}

/// Data that are the same on all levels.
struct LevelContext<'a> {
    around: &'a Surroundings,
    base: Base,
    interior: InteriorPivot,
    outward: Turn,
}

impl Surroundings {
    fn limits(&self, limits: BaseLimits) -> Limits<'_> {
        let whole = |is_outside: bool| {
            let own = self.blades.iter().filter(move |near| near.is_own && (near.blade == 0) == is_outside);
            own.filter(move |_| limits == BaseLimits::WholeBlades).map(|near| &near.patch)
        };
        Limits {
            outside: std::iter::once(&self.pressure.patch).chain(whole(true)).collect(),
            inside: std::iter::once(&self.suction.patch).chain(whole(false)).collect(),
            hollow: self.suction.tip_middle(),
        }
    }

    /// Base position and B1. `None` if no position touches both blades as required.
    fn level_context(&self, cutter: &CupMill, roughing: &Roughing, limits: BaseLimits) -> Option<LevelContext<'_>> {
        let Surroundings { pressure, suction, .. } = self;
        let lines = [pressure.tip(pressure.edges[0]), suction.tip(suction.edges[1])];
        let base = settle(&self.limits(limits), cutter, lines)?;
        // Sense in which the outer circle, turned about A, approaches the pressure side's middle.
        let spoke = pressure.tip_middle() - base.exterior;
        let away = pressure.tip_middle() - suction.tip_middle();
        let outward = if spoke.perp(&away) >= 0.0 { Turn::Ccw } else { Turn::Cw };
        let interior = interior(suction, cutter, &base, outward, roughing.interior_contact)?;
        Some(LevelContext { around: self, base, interior, outward })
    }
}

impl LevelContext<'_> {
    fn levels(
        &self,
        cutter: &CupMill,
        roughing: &Roughing,
        top_mm: f64,
    ) -> Result<(Vec<[Stop; 2]>, SlotPath), Infeasible> {
        let LevelContext { around, base, interior, outward } = self;
        let pivots = [base.exterior, interior.pivot];
        let turns = Turns { around, cutter, centre: base.centre, pivots, outward: *outward };
        let low_mm = turns.lowest_mm().ok_or(Infeasible::NoFloor)?;
        let tallest_mm = around.suction.patch.samples().map(|point| point.z).fold(f64::MIN, f64::max);
        let needed_mm = tallest_mm - low_mm;
        if needed_mm > cutter.cavity_depth_mm {
            return Err(Infeasible::Shallow { cavity_mm: cutter.cavity_depth_mm, needed_mm });
        }
        let heights = levels_mm(cutter, top_mm, low_mm, roughing.axial_depth_max_mm);
        let stops = turns.stops(&heights);
        let levels = heights.iter().zip(&stops).map(|(height_mm, [exterior, interior])| Level {
            height_mm: *height_mm,
            exterior_end: exterior.centre,
            interior_end: interior.centre,
        });
        let path = SlotPath {
            exterior: base.exterior,
            interior: interior.pivot,
            base: base.centre,
            outward: *outward,
            levels: levels.collect(),
            clear_mm: top_mm + roughing.clearance_mm,
        };
        Ok((stops, path))
    }
}

/// Angles about the rotor's axis between which a slot and its neighbours lie.
fn bearings(slot: &Slot) -> [f64; 2] {
    let at = |point: Point| libm::atan2(point.y, point.x);
    let (from, to) = (at(slot.pressure.point(0.5, 0.5)), at(slot.suction.point(0.5, 0.5)));
    let pitch = libm::remainder(to - from, core::f64::consts::TAU);
    let middle = from + pitch / 2.0;
    [middle - 1.5 * pitch.abs(), middle + 1.5 * pitch.abs()]
}

impl SlotPlan {
    /// Tool axis, part frame.
    pub fn tool_axis(&self) -> Vector {
        self.room.direction
    }
}
