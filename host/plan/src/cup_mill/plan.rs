//! Plan of one slot: all steps of the method, in order.

use std::sync::OnceLock;

use nalgebra::{Matrix3, Rotation3};

use crate::cutter::CupMill;
use crate::frame::slot_frame;
use crate::geometry::blisk::{Blisk, Slot};
use crate::geometry::face::Face;
use crate::geometry::turning_height::highest_mm;
use crate::parallel;
use crate::path::{Pass, SlotPath};
use crate::vector::{Point, Vector};

use super::axis::{Axis, axis};
use super::base::Base;
use super::depth::{contact_mm, top_mm};
use super::free_width::{FreeWidth, SidePoints};
use super::infeasibility::{Infeasible, narrow};
use super::interior::InteriorPivot;
use super::level::Stop;
use super::neighbours::{Reach, WholeBlades};
use super::normal_form::{NormalForm, StartEdge};
use super::patch::Patch;
use super::side::{EIGHTHS, FarEdge, Hub, OffsetSide, SideRange, floor, roof};
use super::turns::Surroundings;

pub use super::roughing::{AxisChoice, BaseLimits, Request, Roughing};

/// Plan of the path of a cup mill through one slot: tool axis, base position, pivots and path.
#[derive(Clone, Debug)]
pub struct SlotPlan {
    /// Edges of the blades near which the ring turns.
    pub start: StartEdge,
    /// Number of the eighths ([`EIGHTHS`]) of the sides' height, from the hub up, beside which the ring does not pass; 0: the whole depth.
    pub uncut_eighths: usize,
    /// Tool axis along the blade's edge (the source's line LN3), in the rotor's own frame.
    pub blade_axis: Axis,
    /// Free width of the ring between the blades along that axis.
    pub blade_free_width: FreeWidth,
    /// Free width of the ring between the blades along the chosen axis.
    pub free_width: FreeWidth,
    /// Rotation from the part frame (that of the rotor) into the slot frame, whose z is the chosen axis.
    pub turn: Rotation3<f64>,
    /// Base position, in which the ring touches both blades.
    pub base: Base,
    /// Pivot B1 of the turn at the suction side.
    pub interior: InteriorPivot,
    /// For each level from the top: ends of the turns about A and about B1.
    pub stops: Vec<[Stop; 2]>,
    /// Highest material under the ring at the base position, mm.
    pub top_mm: f64,
    /// Path through the slot, level by level.
    pub path: SlotPath,
}

/// Plan of a slot, with the fraction of the slot's volume that it removes.
#[derive(Clone, Debug)]
pub struct ValuedPlan {
    /// Plan of the path through the slot.
    pub plan: SlotPlan,
    /// Fraction of the slot's volume that the plan removes in addition to earlier passes, 0 to 1.
    pub share_ratio: f64,
}

/// Distance from the roomiest place to which the ring's axis moves at most, mm.
const TRAVEL_MM: f64 = 40.0;
/// Stride through the samples of surfaces for a comparison of plans.
const COARSE_STRIDE: usize = 2;
/// Free width below which another direction is searched, mm: widths are computed on samples of the sides.
const ENOUGH_MM: f64 = 0.1;

/// Data of a slot that are the same for all cutters and tool axes, in normal form (turned and mirrored, see [`NormalForm`]).
pub struct PreparedSlot {
    start: StartEdge,
    form: NormalForm,
    /// Rotor.
    pub blisk: Blisk,
    /// Pressure and suction side.
    ranges: [SideRange; 2],
    blade_axis: Axis,
    walls: [OnceLock<SidePoints>; EIGHTHS],
    fine: Shapes,
    coarse: Shapes,
}

/// Surfaces about a slot.
struct Shapes {
    /// Pressure and suction side above a number of parts of their height.
    sides: [OnceLock<[OffsetSide; 2]>; EIGHTHS],
    blades: WholeBlades,
    hub: Patch,
    roof: Patch,
}

/// Plans the path of a ring through a slot of a rotor, in the rotor's own frame: over the whole depth and from the leading edges.
///
/// # Errors
/// The ring does not pass between the blades, or does not reach the hub.
pub fn plan(blisk: &Blisk, slot: &Slot, cutter: &CupMill, roughing: &Roughing) -> Result<SlotPlan, Infeasible> {
    let prepared = PreparedSlot::new(blisk, slot, roughing.allowance_mm, StartEdge::Leading, None)?;
    prepared.plan(&Request::whole(cutter, roughing)).map(|(plan, _)| prepared.restored(plan))
}

impl PreparedSlot {
    /// Prepares a slot whose surfaces keep `allowance_mm`. For a search, lengths are rounded to multiples of `grain_mm`.
    ///
    /// # Errors
    /// A blade does not reach the hub with its allowance.
    pub fn new(
        blisk: &Blisk,
        slot: &Slot,
        allowance_mm: f64,
        start: StartEdge,
        grain_mm: Option<f64>,
    ) -> Result<Self, Infeasible> {
        let (form, blisk, slot) = NormalForm::of(blisk, slot, start, grain_mm);
        let above = Hub { hub: &blisk.hub, allowance_mm };
        let trim = |face, far, name| SideRange::new(face, far, &above).ok_or(Infeasible::NoFoot(name));
        let (sides, blade_axis) = parallel::join(
            || {
                parallel::join(
                    || trim(&slot.pressure, FarEdge::Trailing, "pressure"),
                    || trim(&slot.suction, FarEdge::Leading, "suction"),
                )
            },
            || axis(&slot.pressure, &blisk.hub, allowance_mm).ok_or(Infeasible::NoFoot("pressure")),
        );
        let (pressure, suction, blade_axis) = (sides.0?, sides.1?, blade_axis?);
        let about = bearings(&slot, &blisk);
        let ranges = [pressure, suction];
        let fine = Shapes {
            sides: Default::default(),
            blades: WholeBlades::new(&blisk, allowance_mm, &feet(&blisk, &ranges, &above)?),
            hub: floor(&blisk, allowance_mm, about),
            roof: roof(&blisk, about),
        };
        let coarse = Shapes {
            sides: Default::default(),
            blades: fine.blades.coarse(COARSE_STRIDE),
            hub: fine.hub.coarse(COARSE_STRIDE),
            roof: fine.roof.coarse(COARSE_STRIDE),
        };
        Ok(PreparedSlot { start, form, blisk, ranges, blade_axis, walls: Default::default(), fine, coarse })
    }

    fn fine_sides(&self, uncut_eighths: usize) -> &[OffsetSide; 2] {
        let lying = Rotation3::identity();
        self.fine.sides[uncut_eighths]
            .get_or_init(|| [0, 1].map(|side: usize| self.ranges[side].above(uncut_eighths).side(&lying)))
    }

    fn coarse_sides(&self, uncut_eighths: usize) -> &[OffsetSide; 2] {
        let of = |side: usize| self.fine_sides(uncut_eighths)[side].coarse(COARSE_STRIDE);
        self.coarse.sides[uncut_eighths].get_or_init(|| [0, 1].map(of))
    }

    /// Sample points of the slot's sides without the lowest `uncut_eighths` eighths of their height, for choosing directions.
    pub fn walls(&self, uncut_eighths: usize) -> &SidePoints {
        self.walls[uncut_eighths].get_or_init(|| {
            let [pressure, suction] = self.fine_sides(uncut_eighths);
            SidePoints::new(pressure, suction)
        })
    }

    /// Plans the path of a ring through the slot that leaves the allowance of [`new`](Self::new). Also returns the surfaces about
    /// the slot, in the slot frame. Both are in the [normal form](super::normal_form); [`restored`](Self::restored) converts the plan
    /// back to the frames of the part and the slot.
    ///
    /// # Errors
    /// The ring does not fit into the slot, or does not reach the hub.
    pub fn plan(&self, request: &Request<'_>) -> Result<(SlotPlan, Surroundings), Infeasible> {
        let Request { cutter, roughing, uncut_eighths, .. } = *request;
        let free_width = self.free_width(request).ok_or(Infeasible::NoAxis)?;
        let turn = slot_frame(&free_width.direction).ok_or(Infeasible::NoAxis)?;
        let around = self.around(request, &free_width, &turn)?;
        let level_context =
            around.level_context(request).ok_or(Infeasible::NoBase { room_mm: free_width.per_side_mm })?;
        let (base, interior) = (level_context.base, level_context.interior);
        let roof = if request.is_coarse() { &self.coarse.roof } else { &self.fine.roof };
        let top_mm = top_mm(cutter, base.centre, &roof.turned(&turn)).ok_or(Infeasible::NoFloor)?;
        let clear_mm = top_mm.max(highest_mm(&self.blisk.blank, &[], &turn)) + roughing.clearance_mm;
        let contact_mm = contact_mm(cutter, base.centre, &self.blisk.blank, &turn).unwrap_or(top_mm).max(top_mm);
        let (stops, path) = level_context.path(request, top_mm, [clear_mm, contact_mm])?;
        let blade_axis = self.blade_axis;
        let blade_free_width = self.walls(0).free_width(cutter, &blade_axis.direction).ok_or(Infeasible::NoAxis)?;
        let start = self.start;
        let plan = SlotPlan {
            start,
            uncut_eighths,
            blade_axis,
            blade_free_width,
            free_width,
            turn,
            base,
            interior,
            stops,
            top_mm,
            path,
        };
        Ok((plan, around))
    }

    fn free_width(&self, request: &Request<'_>) -> Option<FreeWidth> {
        let (cutter, walls) = (request.cutter, self.walls(request.uncut_eighths));
        match request.roughing.axis {
            AxisChoice::Blade => self.near_blade(cutter, walls),
            AxisChoice::Roomiest => walls.roomiest(cutter, &self.blade_axis.direction),
            AxisChoice::Given(direction) => {
                let axis = self.form.normal(&direction).try_normalize(0.0)?;
                walls.free_width(cutter, &axis)
            }
            AxisChoice::Found(width) => Some(width),
        }
    }

    /// Surroundings of the slot, if the ring passes between its sides.
    fn around(
        &self,
        request: &Request<'_>,
        free_width: &FreeWidth,
        turn: &Rotation3<f64>,
    ) -> Result<Surroundings, Infeasible> {
        let sides = |uncut_eighths: usize| {
            let lying =
                if request.is_coarse() { self.coarse_sides(uncut_eighths) } else { self.fine_sides(uncut_eighths) };
            [0, 1].map(|side: usize| lying[side].turned(turn))
        };
        let shapes = if request.is_coarse() { &self.coarse } else { &self.fine };
        let [pressure, suction] = sides(0);
        let raised = (request.uncut_eighths > 0).then(|| sides(request.uncut_eighths));
        let points = [&pressure, &suction].into_iter().flat_map(|side| side.patch.samples());
        let bottom_mm = points.map(|point| point.z).fold(f64::MAX, f64::min);
        let reach = Reach { centre: free_width.centre, travel_mm: TRAVEL_MM, bottom_mm };
        let blades = shapes.blades.about(turn, request.cutter, &reach);
        let around = Surroundings { pressure, suction, raised, hub: shapes.hub.turned(turn), blades };
        if free_width.per_side_mm < 0.0 {
            let [pressure, suction] = around.upper();
            return Err(narrow(free_width, pressure, suction, self.start));
        }
        Ok(around)
    }

    /// First direction with enough free width on the way from the blade's axis to the direction with the most,
    /// at worst that one; `None` if the free width of neither can be computed.
    fn near_blade(&self, cutter: &CupMill, walls: &SidePoints) -> Option<FreeWidth> {
        let blade = walls.free_width(cutter, &self.blade_axis.direction)?;
        if blade.per_side_mm >= ENOUGH_MM {
            return Some(blade);
        }
        let roomiest = walls.roomiest(cutter, &blade.direction)?;
        Some(walls.nearest(cutter, &blade, &roomiest, ENOUGH_MM.min(roomiest.per_side_mm / 2.0)))
    }

    /// Matrix from the normal form to the part frame; it may mirror.
    pub fn to_part(&self) -> Matrix3<f64> {
        self.form.to_part()
    }

    /// Converts a plan from the normal form to the frames of the part and the slot.
    pub fn restored(&self, plan: SlotPlan) -> SlotPlan {
        let form = &self.form;
        SlotPlan {
            blade_axis: form.axis(&plan.blade_axis),
            blade_free_width: form.free_width(&plan.blade_free_width),
            free_width: form.free_width(&plan.free_width),
            turn: form.turn(&plan.turn),
            base: form.base(&plan.base),
            interior: form.interior(&plan.interior),
            stops: plan.stops.iter().map(|both| both.map(|stop| form.stop(&stop))).collect(),
            path: form.path(plan.path),
            ..plan
        }
    }
}

/// For each blade of a pitch, the parameters v at which its sides leave the hub; `ranges` are the sides of the slot.
fn feet(blisk: &Blisk, ranges: &[SideRange; 2], above: &Hub<'_>) -> Result<Vec<[f64; 2]>, Infeasible> {
    let across = blisk.facing().rem_euclid(blisk.kinds());
    let [pressure, suction] = ranges;
    let foot = |face: &Face, far: FarEdge, name| {
        SideRange::new(face, far, above).map(|range| range.foot()).ok_or(Infeasible::NoFoot(name))
    };
    let of_blade = |index: i32| {
        let blade = blisk.blade(index);
        Ok([
            match index {
                0 => pressure.foot(),
                _ => foot(&blade.pressure, FarEdge::Trailing, "next blade's pressure")?,
            },
            match index {
                _ if index == across => suction.foot(),
                _ => foot(&blade.suction, FarEdge::Leading, "first blade's suction")?,
            },
        ])
    };
    (0..blisk.kinds()).map(of_blade).collect()
}

/// Angles about the rotor's axis between which a slot and its neighbours lie.
fn bearings(slot: &Slot, blisk: &Blisk) -> [f64; 2] {
    let at = |point: Point| libm::atan2(point.y, point.x);
    let ends = |slot: &Slot| [at(slot.pressure.point(0.5, 0.5)), at(slot.suction.point(0.5, 0.5))];
    let width = |[from, to]: [f64; 2]| libm::remainder(to - from, core::f64::consts::TAU);
    let [from, to] = ends(slot);
    let own = width([from, to]);
    let middle = from + own / 2.0;
    let others = (1..blisk.kinds()).map(|index| width(ends(&blisk.from_blade(index).slot())).abs());
    let widest = others.fold(own.abs(), f64::max);
    [middle - 1.5 * widest, middle + 1.5 * widest]
}

impl SlotPlan {
    /// The plan's path, as a pass through the slot.
    pub fn pass(&self) -> Pass {
        Pass { path: self.path.clone(), to_slot: self.turn }
    }

    /// Fraction of the sides' height, from the tip down, beside which the ring passes.
    pub fn depth_ratio(&self) -> f64 {
        1.0 - self.uncut_eighths as f64 / EIGHTHS as f64
    }

    /// Chosen tool axis, in the rotor's own frame.
    pub fn tool_axis(&self) -> Vector {
        self.free_width.direction
    }
}
