//! Both turns out of the base position, level by level, and the lowest level at which they are clear of the hub.

use arcfeed_nc::modal::Turn;

use crate::cutter::CupMill;
use crate::parallel;
use crate::path::SlotPath;
use crate::search::{Minimum, descend};
use crate::vector::{Flat, Point};

use super::depth::lowest_mm;
use super::level::{Stop, StopSurface, stop};
use super::link::{LowerEnd, shortened_rad};
use super::neighbours::Neighbour;
use super::patch::Patch;
use super::side::OffsetSide;
use super::turn::TurningTool;

/// Surroundings: surfaces about a slot with their allowance, in the slot frame (z along the tool's axis).
#[derive(Debug)]
pub struct Surroundings {
    /// Pressure side of the slot.
    pub pressure: OffsetSide,
    /// Suction side of the slot.
    pub suction: OffsetSide,
    /// Upper parts of both sides, if the ring passes beside these only; `None` if it passes beside the whole sides.
    pub raised: Option<[OffsetSide; 2]>,
    /// Hub.
    pub hub: Patch,
    /// Whole sides of all blades near the ring.
    pub blades: Vec<Neighbour>,
}

/// Both turns of the ring away from the base position: about A to one blade, and about B1 to the other.
pub struct Turns<'a> {
    /// Surfaces that end the turns.
    pub around: &'a Surroundings,
    /// Cutter.
    pub cutter: &'a CupMill,
    /// Centre of the ring at the base position, seen along the tool.
    pub centre: Flat,
    /// Pivots A and B1, seen along the tool.
    pub pivots: [Flat; 2],
    /// Sense of rotation of both turns, seen along the tool.
    pub outward: Turn,
}

/// Number of places along an arc at which the hub is checked.
const HUB_STEPS: i32 = 12;
/// Number of corrections of the lowest level for its arcs.
const HUB_ROUNDS: i32 = 2;

/// Depth up to which a side at the base position is not under the ring, mm.
const TOUCH_MM: f64 = 1e-4;

impl Surroundings {
    /// Pressure and suction side, or their upper parts if the ring passes beside these only.
    pub fn upper(&self) -> [&OffsetSide; 2] {
        self.raised.as_ref().map_or([&self.pressure, &self.suction], |[pressure, suction]| [pressure, suction])
    }

    /// Whether the ring at `base`, with its bottom at `bottom_mm`, cuts into a round edge of the slot's own blades.
    pub fn cuts_edge(&self, cutter: &CupMill, base: Flat, bottom_mm: f64) -> bool {
        self.blades.iter().any(|near| near.is_own && is_cut(near, cutter, base, bottom_mm))
    }

    /// Surfaces that end turns: the slot's own first. A surface of these blades that the ring cuts at the base position
    /// ends no turn: the base position touches their sides, and the proof decides about their edges. The lowest position
    /// of the tool's bottom is `bottom_mm`.
    fn obstacles(&self, cutter: &CupMill, base: Flat, bottom_mm: f64) -> Vec<(StopSurface, &Patch)> {
        let own = [(StopSurface::Pressure, &self.pressure.patch), (StopSurface::Suction, &self.suction.patch)];
        let counts = self.blades.iter().filter(|near| !near.is_own || !is_cut(near, cutter, base, bottom_mm));
        let blades = counts.map(|near| (StopSurface::Blade(near.blade, near.side), &near.patch));
        own.into_iter().chain(blades).collect()
    }
}

fn is_cut(near: &Neighbour, cutter: &CupMill, base: Flat, bottom_mm: f64) -> bool {
    let radii_mm = cutter.inner_radius_mm + TOUCH_MM..cutter.outer_radius_mm - TOUCH_MM;
    let is_within = |point: &Point| radii_mm.contains(&(point.xy() - base).norm());
    near.patch.samples().any(|point| point.z > bottom_mm && is_within(point))
}

impl<'a> Turns<'a> {
    fn turning(&self, pivot: Flat, bottom_mm: f64) -> TurningTool<'_> {
        TurningTool { cutter: self.cutter, centre: self.centre, bottom_mm, pivot, turn: self.outward }
    }

    /// Lowest height of the tool's bottom, mm, at which the whole path is clear of the hub; `None` if there is none.
    pub fn lowest_mm(&self) -> Option<f64> {
        let hub = &self.around.hub;
        let mut low_mm = lowest_mm(self.cutter, self.centre, hub)?;
        low_mm = self.blades_mm().map_or(low_mm, |blades_mm| blades_mm.max(low_mm));
        // Higher up the turns are longer, so they are computed again.
        for _ in 0..HUB_ROUNDS {
            let blades = self.around.obstacles(self.cutter, self.centre, low_mm);
            low_mm = self.pivots.into_iter().fold(low_mm, |low_mm, pivot| {
                let turning = self.turning(pivot, low_mm);
                let whole_rad = stop(&turning, &blades).turn_rad;
                self.highest_hub_mm(&turning, whole_rad).map_or(low_mm, |high_mm| high_mm.max(low_mm))
            });
        }
        Some(low_mm)
    }

    /// Lowest position that the blades allow at the base position: those beside the slot, and the lower parts of its own.
    fn blades_mm(&self) -> Option<f64> {
        // The sides that the ring touches at the base position are not under it.
        let cutter = CupMill {
            inner_radius_mm: self.cutter.inner_radius_mm + TOUCH_MM,
            outer_radius_mm: self.cutter.outer_radius_mm - TOUCH_MM,
            ..self.cutter.clone()
        };
        let Surroundings { pressure, suction, raised, blades, .. } = self.around;
        let own = raised.iter().flat_map(|_| [&pressure.patch, &suction.patch]);
        let others = blades.iter().filter(|blade| !blade.is_own).map(|blade| &blade.patch);
        own.chain(others).filter_map(|patch| lowest_mm(&cutter, self.centre, patch)).max_by(f64::total_cmp)
    }

    /// Lowest position that the hub allows along a whole turn.
    fn highest_hub_mm(&self, turning: &TurningTool<'_>, whole_rad: f64) -> Option<f64> {
        let allowed = |[share, _]: [f64; 2]| {
            let centre = turning.centre_after(whole_rad * share);
            lowest_mm(self.cutter, centre, &self.around.hub).map_or(f64::INFINITY, |low_mm| -low_mm)
        };
        let places = (0..=HUB_STEPS).map(|k| [f64::from(k) / f64::from(HUB_STEPS), 0.0]);
        let start = places.map(|at| Minimum { at, value: allowed(at) }).min_by(|a, b| a.value.total_cmp(&b.value))?;
        let found = descend([[0.0, 1.0], [0.0, 0.0]], start, [1.0 / f64::from(HUB_STEPS), 0.0], allowed);
        found.value.is_finite().then_some(-found.value)
    }

    /// Ends of both turns for each of these heights of the tool's bottom. If a turn meets nothing, the slot ends there, and the turn of
    /// the level below is used.
    pub fn stops(&self, heights_mm: &[f64]) -> Vec<[Stop; 2]> {
        let bottom_mm = heights_mm.last().copied().unwrap_or(f64::NEG_INFINITY);
        let mut obstacles = self.around.obstacles(self.cutter, self.centre, bottom_mm);
        let walls: Vec<&Patch> = obstacles.iter().map(|(_, patch)| *patch).collect();
        obstacles.insert(2, (StopSurface::Hub, &self.around.hub));
        let alone = |height_mm: &f64| self.pivots.map(|pivot| stop(&self.turning(pivot, *height_mm), &obstacles));
        let met = parallel::map(heights_mm, &alone);
        let mut below: Option<([Stop; 2], f64)> = None;
        let mut stops: Vec<[Stop; 2]> = Vec::new();
        for (index, height_mm) in heights_mm.iter().enumerate().rev() {
            let both = [0, 1].map(|which: usize| {
                let turning = self.turning(self.pivots[which], *height_mm);
                let met = met[index][which];
                let Some((below, bottom_mm)) = below else { return met };
                let below = below[which];
                if met.at.is_none() {
                    return Stop { at: None, ..below };
                }
                // A level ends where the next one begins.
                if which != SlotPath::end_of(index) {
                    return met;
                }
                let below = LowerEnd { centre: below.centre, bottom_mm, turn_rad: below.turn_rad };
                let turn_rad = shortened_rad(&turning, met.turn_rad, &below, &walls);
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
