//! The method, one step a file: from the blades about a slot to the way of a cup mill's centre through it.

pub mod patch;

pub mod side;

pub mod axis;

pub mod fit;

pub mod base;

pub mod lowest;

pub mod turn;

pub mod interior;

pub mod level;

pub mod link;

use arcfeed_shared::nc::modal::Turn;
use nalgebra::Rotation3;
use thiserror::Error;

use crate::cutter::CupMill;
use crate::frame::slot_frame;
use crate::geometry::blisk::{Blisk, Slot};
use crate::path::{Level, SlotPath};
use crate::search::{Least, descend};
use crate::vector::{Flat, Point, Vector};

use self::axis::{Axis, axis};
use self::base::{Base, settle};
use self::fit::{Room, Walls};
use self::interior::{Interior, interior};
use self::level::{Obstacle, Stop, stop};
use self::link::{Below, shortened_rad};
use self::lowest::{levels_mm, lowest_mm};
use self::patch::Patch;
use self::side::{FarEdge, Hub, Side, floor};
use self::turn::Turning;

/// What the planner may do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughing {
    /// Left on blades and hub, mm.
    pub allowance_mm: f64,
    /// ADC_MAX, mm.
    pub axial_depth_max_mm: f64,
    /// How near the leading edge the turn about B1 meets the suction side's tip curve, as a share of it.
    pub interior_contact: f64,
    /// Approach height above the blank, mm.
    pub clearance_mm: f64,
    /// The tool's axis.
    pub axis: AxisChoice,
}

/// Which axis a tool has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AxisChoice {
    /// LN3 where the ring passes along it, otherwise the direction nearest to it, towards the roomiest, in which it does.
    #[default]
    Auto,
    /// LN3.
    Blade,
    /// The roomiest.
    Roomiest,
}

/// A slot's plan.
#[derive(Clone, Debug)]
pub struct SlotPlan {
    /// LN3 and the points it goes through, part frame.
    pub blade_axis: Axis,
    /// Room along LN3.
    pub blade_room: Room,
    /// Room along the axis taken.
    pub room: Room,
    /// Turns the part into the slot frame.
    pub turn: Rotation3<f64>,
    /// The base position.
    pub base: Base,
    /// B1.
    pub interior: Interior,
    /// From the top: how the turns about A and about B1 end.
    pub stops: Vec<[Stop; 2]>,
    /// Highest material under the ring at the base position, mm.
    pub top_mm: f64,
    /// The way.
    pub path: SlotPath,
}

/// Why there is no plan.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Infeasible {
    /// A blade ends above the hub.
    #[error("the {0} side does not reach the hub with its allowance")]
    NoFoot(&'static str),
    /// The tool would lie along the rotor's axis.
    #[error("the blade's edge lies along the rotor's axis: no tool comes in along it")]
    NoAxis,
    /// No ring of this width passes.
    #[error("no ring of this width passes: {missing_mm:.1} mm missing {place}")]
    TooNarrow {
        /// By how much it would have to be narrower.
        missing_mm: f64,
        /// Where.
        place: String,
    },
    /// There is room, but not from this base position.
    #[error(
        "the ring passes ({room_mm:.2} mm to spare on each side), but not where it touches both blades as the base position does"
    )]
    NoBase {
        /// Room, mm.
        room_mm: f64,
    },
    /// The ring is nowhere above the hub.
    #[error("the ring is nowhere above the hub at the base position: its radius does not suit the slot")]
    NoFloor,
    /// The hollow is not deep enough.
    #[error(
        "the cup is {cavity_mm:.1} mm deep, but the blade inside it reaches {needed_mm:.1} mm up from the lowest level"
    )]
    Shallow {
        /// The cutter's.
        cavity_mm: f64,
        /// What it takes.
        needed_mm: f64,
    },
}

/// Room that a direction must leave before another is looked for, mm: rooms are judged on samples of the sides.
const ENOUGH_MM: f64 = 0.1;

/// What stands about a slot, slot frame.
struct Around {
    pressure: Side,
    suction: Side,
    hub: Patch,
    top: Patch,
}

/// Plans the slot of a rotor.
///
/// # Errors
/// The ring does not pass, or does not reach.
pub fn plan(blisk: &Blisk, slot: &Slot, cutter: &CupMill, roughing: &Roughing) -> Result<SlotPlan, Infeasible> {
    let allowance_mm = roughing.allowance_mm;
    let lying = Rotation3::identity();
    let above = Hub { hub: &blisk.hub, allowance_mm };
    let pressure =
        |turn| Side::new(&slot.pressure, FarEdge::Trailing, &above, turn).ok_or(Infeasible::NoFoot("pressure"));
    let suction = |turn| Side::new(&slot.suction, FarEdge::Leading, &above, turn).ok_or(Infeasible::NoFoot("suction"));
    let blade_axis = axis(&slot.pressure, &blisk.hub, allowance_mm).ok_or(Infeasible::NoFoot("pressure"))?;
    let walls = Walls::new(&pressure(&lying)?, &suction(&lying)?);
    let blade_room = walls.room(cutter, &blade_axis.direction).ok_or(Infeasible::NoAxis)?;
    let room = match roughing.axis {
        AxisChoice::Blade => blade_room,
        AxisChoice::Auto if blade_room.room_mm >= ENOUGH_MM => blade_room,
        AxisChoice::Auto => {
            let roomiest = walls.roomiest(cutter).ok_or(Infeasible::NoAxis)?;
            walls.nearest(cutter, &blade_room, &roomiest, ENOUGH_MM.min(roomiest.room_mm / 2.0))
        }
        AxisChoice::Roomiest => walls.roomiest(cutter).ok_or(Infeasible::NoAxis)?,
    };
    let turn = slot_frame(&room.direction).ok_or(Infeasible::NoAxis)?;
    let (pressure, suction) = (pressure(&turn)?, suction(&turn)?);
    if room.room_mm < 0.0 {
        return Err(narrow(&room, &pressure, &suction));
    }
    let about = bearings(slot);
    let around =
        Around { hub: floor(blisk, allowance_mm, about, &turn), top: top(blisk, about, &turn), pressure, suction };
    around.plan(cutter, roughing, Found { blade_axis, blade_room, room, turn })
}

/// What is known before the base position.
struct Found {
    blade_axis: Axis,
    blade_room: Room,
    room: Room,
    turn: Rotation3<f64>,
}

impl Around {
    fn plan(&self, cutter: &CupMill, roughing: &Roughing, found: Found) -> Result<SlotPlan, Infeasible> {
        let sides = [&self.pressure, &self.suction];
        let lines = [self.pressure.tip(self.pressure.edges[0]), self.suction.tip(self.suction.edges[1])];
        let no_base = Infeasible::NoBase { room_mm: found.room.room_mm };
        let base = settle(sides, cutter, lines, f64::NEG_INFINITY).ok_or(no_base)?;
        let top_mm = self.top_mm(cutter, base.centre).ok_or(Infeasible::NoFloor)?;
        let outward = self.outward(&base);
        let share = roughing.interior_contact;
        let interior = interior(&self.suction, cutter, &base, outward, share).ok_or(Infeasible::NoFloor)?;
        let turns =
            Turns { around: self, cutter, centre: base.centre, pivots: [base.exterior, interior.pivot], outward };
        let low_mm = turns.lowest_mm().ok_or(Infeasible::NoFloor)?;
        let tallest = self.suction.patch.samples().map(|point| point.z).fold(f64::MIN, f64::max);
        if tallest - low_mm > cutter.cavity_depth_mm {
            return Err(Infeasible::Shallow { cavity_mm: cutter.cavity_depth_mm, needed_mm: tallest - low_mm });
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
            outward,
            levels: levels.collect(),
            clear_mm: top_mm + roughing.clearance_mm,
        };
        let Found { blade_axis, blade_room, room, turn } = found;
        Ok(SlotPlan { blade_axis, blade_room, room, turn, base, interior, stops, top_mm, path })
    }

    /// Highest material under the ring.
    fn top_mm(&self, cutter: &CupMill, centre: Flat) -> Option<f64> {
        let under = |p: &Point| {
            let radius_mm = (p.xy() - centre).norm();
            let is_under = (cutter.inner_radius_mm..=cutter.outer_radius_mm).contains(&radius_mm);
            if is_under { -p.z } else { f64::INFINITY }
        };
        self.top.least(under).map(|least| -least.value)
    }

    /// The sense in which the outer circle, turned about A, comes nearer to the pressure side's middle.
    fn outward(&self, base: &Base) -> Turn {
        let spoke = self.pressure.tip_middle() - base.exterior;
        let away = self.pressure.tip_middle() - self.suction.tip_middle();
        if spoke.perp(&away) >= 0.0 { Turn::Ccw } else { Turn::Cw }
    }
}

/// Both turns out of the base position.
struct Turns<'a> {
    around: &'a Around,
    cutter: &'a CupMill,
    centre: Flat,
    /// A, B1.
    pivots: [Flat; 2],
    outward: Turn,
}

/// Places along an arc where the hub is asked for.
const HUB_STEPS: i32 = 12;
/// How often the lowest level is raised for its arcs.
const HUB_ROUNDS: i32 = 2;

impl Turns<'_> {
    fn turning(&self, pivot: Flat, bottom_mm: f64) -> Turning<'_> {
        Turning { cutter: self.cutter, centre: self.centre, bottom_mm, pivot, turn: self.outward }
    }

    /// The lowest level: at which the whole of its path is clear of the hub.
    fn lowest_mm(&self) -> Option<f64> {
        let hub = &self.around.hub;
        let mut low_mm = lowest_mm(self.cutter, self.centre, hub)?;
        let blades =
            [(Obstacle::Pressure, &self.around.pressure.patch), (Obstacle::Suction, &self.around.suction.patch)];
        // Higher up the turns are longer, so they are asked again.
        for _ in 0..HUB_ROUNDS {
            low_mm = self.pivots.into_iter().fold(low_mm, |low_mm, pivot| {
                let turning = self.turning(pivot, low_mm);
                let whole_rad = stop(&turning, &blades).turn_rad;
                self.highest_hub_mm(&turning, whole_rad).map_or(low_mm, |high_mm| high_mm.max(low_mm))
            });
        }
        Some(low_mm)
    }

    /// The lowest position that the hub allows all along a turn.
    fn highest_hub_mm(&self, turning: &Turning<'_>, whole_rad: f64) -> Option<f64> {
        let allowed = |[share, _]: [f64; 2]| {
            let centre = turning.centre_after(whole_rad * share);
            lowest_mm(self.cutter, centre, &self.around.hub).map_or(f64::INFINITY, |low_mm| -low_mm)
        };
        let places = (0..=HUB_STEPS).map(|k| [f64::from(k) / f64::from(HUB_STEPS), 0.0]);
        let start = places.map(|at| Least { at, value: allowed(at) }).min_by(|a, b| a.value.total_cmp(&b.value))?;
        let found = descend([[0.0, 1.0], [0.0, 0.0]], start, [1.0 / f64::from(HUB_STEPS), 0.0], allowed);
        found.value.is_finite().then_some(-found.value)
    }

    /// How the turns end, level by level. Where one meets nothing, there is no more of the slot than below it.
    fn stops(&self, heights_mm: &[f64]) -> Vec<[Stop; 2]> {
        let Around { pressure, suction, hub, .. } = self.around;
        let obstacles =
            [(Obstacle::Pressure, &pressure.patch), (Obstacle::Suction, &suction.patch), (Obstacle::Hub, hub)];
        let mut below: Option<([Stop; 2], f64)> = None;
        let mut stops: Vec<[Stop; 2]> = Vec::new();
        for (index, height_mm) in heights_mm.iter().enumerate().rev() {
            let both = [0, 1].map(|which: usize| {
                let turning = self.turning(self.pivots[which], *height_mm);
                let met = stop(&turning, &obstacles);
                let Some((below, bottom_mm)) = below else { return met };
                let below = below[which];
                if met.at.is_none() {
                    return Stop { at: None, ..below };
                }
                // A level ends where the next one begins.
                if which != SlotPath::end_of(index) {
                    return met;
                }
                let below = Below { centre: below.centre, bottom_mm, turn_rad: below.turn_rad };
                let turn_rad = shortened_rad(&turning, met.turn_rad, &below, &[&pressure.patch, &suction.patch]);
                if turn_rad < met.turn_rad {
                    Stop { turn_rad, centre: turning.centre_after(turn_rad), at: None }
                } else {
                    met
                }
            });
            below = Some((both, *height_mm));
            stops.push(both);
        }
        stops.reverse();
        stops
    }
}

/// The blank's outside above the slot.
fn top(blisk: &Blisk, about: [f64; 2], turn: &Rotation3<f64>) -> Patch {
    let (blank, turn) = (blisk.blank, *turn);
    Patch::new([blank.faces_mm, about], [16, 48], move |z, angle| {
        let (sin, cos) = libm::sincos(angle);
        turn * Point::new(blank.radius_mm * cos, blank.radius_mm * sin, z)
    })
}

/// Angles about the rotor's axis between which a slot and its neighbours lie.
fn bearings(slot: &Slot) -> [f64; 2] {
    let at = |point: Point| libm::atan2(point.y, point.x);
    let (from, to) = (at(slot.pressure.point(0.5, 0.5)), at(slot.suction.point(0.5, 0.5)));
    let pitch = libm::remainder(to - from, core::f64::consts::TAU);
    let middle = from + pitch / 2.0;
    [middle - 1.5 * pitch.abs(), middle + 1.5 * pitch.abs()]
}

/// In words where the ring is held.
fn narrow(room: &Room, pressure: &Side, suction: &Side) -> Infeasible {
    let off = |point: &Point| (point.xy() - room.centre).norm();
    let tightest = [(pressure, 1.0, "pressure"), (suction, -1.0, "suction")].map(|(side, sign, name)| {
        let least = side.patch.least(|point| sign * off(point));
        least.map_or(String::new(), |least| {
            let [u, v] = least.at;
            let share = (u - side.edges[0]) / (side.edges[1] - side.edges[0]);
            format!("the {name} side's {} {:.0} % up the blade", along(share), 100.0 * v)
        })
    });
    Infeasible::TooNarrow { missing_mm: -2.0 * room.room_mm, place: format!("between {}", tightest.join(" and ")) }
}

/// Where along a side.
fn along(share: f64) -> &'static str {
    match share {
        ..0.2 => "leading edge",
        0.2..0.8 => "middle",
        _ => "trailing edge",
    }
}

/// The direction of the tool, part frame.
impl SlotPlan {
    /// The tool's axis, part frame.
    pub fn tool_axis(&self) -> Vector {
        self.room.direction
    }
}
