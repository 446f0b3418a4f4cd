//! The lowest level and the ends of all turns on twisted rotors, against scans of sampled surfaces.

use arcfeed_nc::modal::Turn;
use arcfeed_plan::cup_mill::level::TURN_MAX_RAD;
use arcfeed_plan::cup_mill::plan::SlotPlan;
use arcfeed_plan::cutter::CupMill;
use arcfeed_plan::geometry::blisk::Slot;
use arcfeed_plan::vector::{Flat, Point};
use nalgebra::Rotation2;

use crate::dense::{Dense, gap_mm};
use crate::twisted::{ALLOWANCE_MM, BLANK_MM, HUB_MM, ROTORS, Twisted, ring};

/// Overlap from which the planner counts a contact.
const TOUCH_MM: f64 = 2e-6;
/// Distance on the samples beyond which there is no contact between them, mm.
const NEAR_MM: f64 = 0.05;
/// Turns are scanned in such steps, rad, until an overlap is found.
const STEP_RAD: f64 = 1.5e-3;

/// Everything about a slot, sampled in the slot frame.
struct Surroundings<'f> {
    /// Pressure side, suction side, hub.
    obstacles: [Dense<'f>; 3],
    plan: &'f SlotPlan,
    cutter: CupMill,
}

impl<'f> Surroundings<'f> {
    fn new(slot: &'f Slot, plan: &'f SlotPlan) -> Self {
        let middle = slot.pressure.point(0.5, 0.5);
        let about = libm::atan2(middle.y, middle.x);
        let (turn, floor_mm) = (plan.turn, HUB_MM + ALLOWANCE_MM);
        let hub =
            Dense::new([[-16.0 - ALLOWANCE_MM, 16.0 + ALLOWANCE_MM], [about - 0.7, about + 0.7]], move |z, angle| {
                let (sin, cos) = libm::sincos(angle);
                turn * Point::new(floor_mm * cos, floor_mm * sin, z)
            });
        let side = |face, far| Dense::side(face, far, plan.turn);
        let obstacles = [side(&slot.pressure, 1), side(&slot.suction, 0), hub];
        Surroundings { obstacles, plan, cutter: ring() }
    }

    fn centre(&self, pivot: Flat, turn_rad: f64) -> Flat {
        let sense = if self.plan.path.outward == Turn::Ccw { 1.0 } else { -1.0 };
        pivot + Rotation2::new(turn_rad * sense) * (self.plan.path.base - pivot)
    }

    /// The bottom's lowest height over the hub at a centre: the ring raised until no sample is within it.
    fn lowest_mm(&self, centre: Flat) -> f64 {
        let [_, _, hub] = &self.obstacles;
        let rounding_mm = self.cutter.insert_radius_mm;
        let height_mm = |p: &Point| {
            let off_mm = libm::hypot(p.x - centre.x, p.y - centre.y);
            let half_mm = (self.cutter.outer_radius_mm - self.cutter.inner_radius_mm) / 2.0;
            let aside_mm = (off_mm - self.cutter.inner_radius_mm - half_mm).abs() - half_mm + rounding_mm;
            let within_mm = aside_mm.max(0.0);
            // Beside the ring: falling ever more steeply, so that the search finds its way back.
            let underside_mm = if within_mm <= rounding_mm {
                rounding_mm - libm::sqrt(rounding_mm * rounding_mm - within_mm * within_mm)
            } else {
                rounding_mm + 1e3 * (within_mm - rounding_mm)
            };
            underside_mm - p.z
        };
        -hub.least(height_mm).0
    }

    /// Largest overlap on every `stride`th sample.
    fn overlap_mm(&self, centre: Flat, bottom_mm: f64, stride: usize) -> f64 {
        let each = self.obstacles.iter().map(|dense| {
            let samples = dense.samples.iter().step_by(stride).map(|(_, p)| p).filter(|p| p.z > bottom_mm - 1e-3);
            -samples.map(|p| gap_mm(&self.cutter, centre, bottom_mm, p)).fold(f64::INFINITY, f64::min)
        });
        each.fold(f64::MIN, f64::max)
    }

    /// The same on ever finer grids about the best samples, where they are near.
    fn exact_overlap_mm(&self, centre: Flat, bottom_mm: f64) -> f64 {
        let gap = |p: &Point| gap_mm(&self.cutter, centre, bottom_mm, p);
        let each = self.obstacles.iter().map(|dense| {
            let near = dense.coarse(gap);
            if near.0 > NEAR_MM { -near.0 } else { -dense.finer(near, gap).0 }
        });
        each.fold(f64::MIN, f64::max)
    }

    /// The first turn after which something is overlapped: scanned, then halved, at last on the finest grids.
    fn first_turn_rad(&self, pivot: Flat, bottom_mm: f64) -> Option<f64> {
        let is_met =
            |turn_rad: f64, stride| self.overlap_mm(self.centre(pivot, turn_rad), bottom_mm, stride) > TOUCH_MM;
        let steps = (TURN_MAX_RAD / STEP_RAD) as i32;
        let beyond = (1..=steps).map(|k| f64::from(k) * STEP_RAD).find(|turn| is_met(*turn, 7))?;
        let (mut clear, mut beyond) = (0.0_f64.max(beyond - STEP_RAD), beyond);
        for _ in 0..12 {
            let middle = (clear + beyond) / 2.0;
            if is_met(middle, 1) { beyond = middle } else { clear = middle }
        }
        // Overlaps between samples occur a little earlier.
        clear = (clear - 0.03).max(0.0);
        for _ in 0..18 {
            let middle = (clear + beyond) / 2.0;
            let is_met = self.exact_overlap_mm(self.centre(pivot, middle), bottom_mm) > TOUCH_MM;
            if is_met { beyond = middle } else { clear = middle }
        }
        Some(beyond)
    }
}

fn check_turns(rotor: &Twisted) {
    let (_, slot) = rotor.slot(0.0);
    let plan = rotor.plan();
    let around = Surroundings::new(&slot, &plan);
    let pivots = [plan.path.exterior, plan.path.interior];
    let (mut worst_rad, mut worst_mm, mut met) = (0.0_f64, f64::MIN, 0);
    for (level, stops) in plan.path.levels.iter().zip(&plan.stops) {
        for (stop, pivot) in stops.iter().zip(pivots) {
            let found = around.first_turn_rad(pivot, level.height_mm);
            worst_mm = worst_mm.max(around.exact_overlap_mm(stop.centre, level.height_mm));
            if stop.at.is_some() {
                let found_rad = found.unwrap_or_else(|| panic!("{}: a turn ends at nothing, {stop:?}", rotor.name));
                worst_rad = worst_rad.max((found_rad - stop.turn_rad).abs());
                met += 1;
            } else {
                // Nothing is met, or the line to the next level needs a shorter turn.
                assert!(found.is_none_or(|found_rad| stop.turn_rad <= found_rad + 1e-6), "{}: {stop:?}", rotor.name);
            }
        }
    }
    let all = 2 * plan.path.levels.len();
    println!("{}: {met} of {all} turns meet a side, {worst_rad:.1e} rad off; overlap {worst_mm:.1e} mm", rotor.name);
    assert!(met > all / 2 && worst_rad < 1e-6 && worst_mm < 1.1 * TOUCH_MM, "{}", rotor.name);
}

#[test]
fn turns_end_where_a_scan_finds_the_first_overlap() {
    for rotor in &ROTORS {
        check_turns(rotor);
    }
}

#[test]
fn the_lowest_level_is_that_of_the_ring_raised_off_the_sampled_hub() {
    for rotor in &ROTORS {
        let (_, slot) = rotor.slot(0.0);
        let plan = rotor.plan();
        let around = Surroundings::new(&slot, &plan);
        let bottom_mm = plan.path.levels.last().unwrap().height_mm;
        let stops = plan.stops.last().unwrap();
        let pivots = [plan.path.exterior, plan.path.interior];
        let mut lowest_mm = around.lowest_mm(plan.path.base);
        let base_mm = lowest_mm;
        for which in 0..2 {
            for k in 1..=24 {
                let turn_rad = stops[which].turn_rad * f64::from(k) / 24.0;
                lowest_mm = lowest_mm.max(around.lowest_mm(around.centre(pivots[which], turn_rad)));
            }
        }
        let (off_mm, lifted_mm) = (bottom_mm - lowest_mm, lowest_mm - base_mm);
        println!("{}: lowest level {off_mm:.1e} mm; the turns raise it by {lifted_mm:.3} mm", rotor.name);
        // The planner's turns there are a little longer than where they end at last.
        assert!(off_mm > -1e-6 && off_mm < 1e-3, "{}", rotor.name);
        let turn = plan.turn;
        let middle = slot.pressure.point(0.5, 0.5);
        let about = libm::atan2(middle.y, middle.x);
        let roof = Dense::new([[-16.0, 16.0], [about - 0.4, about + 0.4]], move |z, angle| {
            let (sin, cos) = libm::sincos(angle);
            turn * Point::new(BLANK_MM * cos, BLANK_MM * sin, z)
        });
        let is_under = |p: &&([f64; 2], Point)| {
            let off_mm = libm::hypot(p.1.x - plan.path.base.x, p.1.y - plan.path.base.y);
            off_mm >= ring().inner_radius_mm && off_mm <= ring().outer_radius_mm
        };
        let highest_mm = roof.samples.iter().filter(is_under).map(|(_, p)| p.z).fold(f64::MIN, f64::max);
        println!("{}: highest material {:.1e} mm above that of samples", rotor.name, plan.top_mm - highest_mm);
        assert!((plan.top_mm - highest_mm).abs() < 0.02, "{}", rotor.name);
    }
}
