//! Twisted rotors, made here: circular-arc camber, elliptic thickness, laid on cylinders about the axis.

use arcfeed_plan::cup_mill::plan::{AxisChoice, Roughing, SlotPlan, plan};
use arcfeed_plan::cutter::CupMill;
use arcfeed_plan::geometry::blisk::Blade;
use arcfeed_plan::geometry::blisk::{Blank, Blisk, Revolution, Slot};
use arcfeed_plan::geometry::face::Face;
use arcfeed_plan::vector::{Point, Vector};
use nalgebra::Rotation3;

/// Radii of hub and tip, mm.
pub const HUB_MM: f64 = 80.0;
/// Left on blades and hub, mm.
pub const ALLOWANCE_MM: f64 = 0.889;
const TIP_MM: f64 = 108.6;
/// Radius of the blank, mm.
pub const BLANK_MM: f64 = 109.0;
/// Number of blades.
pub const BLADES: u32 = 19;
const SECTIONS: usize = 9;
const POINTS: usize = 61;

/// A rotor's numbers; pairs are those at the hub and at the tip.
#[derive(Clone, Copy, Debug)]
pub struct Twisted {
    pub name: &'static str,
    pub chord_mm: f64,
    pub stagger_deg: [f64; 2],
    pub camber_deg: [f64; 2],
    pub thickness_ratio: [f64; 2],
    /// 1: suction sides look to growing angles; -1: the mirror image.
    pub hand: f64,
    /// The sections are shifted by this length along their chords.
    pub shift_mm: f64,
}

/// By how many degrees the stagger grows from hub to tip: 14, 27, 6.
pub const ROTORS: [Twisted; 3] = [
    Twisted {
        name: "28-42",
        chord_mm: 26.0,
        stagger_deg: [28.0, 42.0],
        camber_deg: [14.0, 10.0],
        thickness_ratio: [0.1, 0.055],
        hand: 1.0,
        shift_mm: 0.0,
    },
    Twisted {
        name: "25-52",
        chord_mm: 26.0,
        stagger_deg: [25.0, 52.0],
        camber_deg: [14.0, 10.0],
        thickness_ratio: [0.1, 0.055],
        hand: 1.0,
        shift_mm: 0.0,
    },
    Twisted {
        name: "34-40",
        chord_mm: 24.0,
        stagger_deg: [34.0, 40.0],
        camber_deg: [12.0, 8.0],
        thickness_ratio: [0.08, 0.05],
        hand: 1.0,
        shift_mm: 0.0,
    },
];

/// The published ring, with inserts of 0.8 mm.
pub fn ring() -> CupMill {
    CupMill {
        outer_radius_mm: 128.576,
        inner_radius_mm: 112.701,
        insert_radius_mm: 0.8,
        cavity_depth_mm: 60.0,
        height_mm: 80.0,
        holder_mm: Vec::new(),
        active_teeth: 10,
    }
}

/// 0.035 in of allowance, 0.1 in of axial depth.
pub fn roughing() -> Roughing {
    let axis = AxisChoice::Blade;
    Roughing { allowance_mm: ALLOWANCE_MM, axial_depth_max_mm: 2.54, interior_contact: 0.15, clearance_mm: 5.0, axis }
}

impl Twisted {
    /// Point of a side by its height between hub and tip and its place between the edges, both 0 to 1; `outward` 1 for the suction side.
    pub fn point(&self, share: f64, place: f64, outward: f64, turn_rad: f64) -> Point {
        let between = |[hub, tip]: [f64; 2]| hub + (tip - hub) * share;
        let radius_mm = between([HUB_MM, TIP_MM]);
        let (sin, cos) = libm::sincos(between(self.stagger_deg).to_radians());
        let half_rad = between(self.camber_deg).to_radians() / 2.0;
        let camber_mm = self.chord_mm / (2.0 * libm::sin(half_rad));
        let half_mm = self.chord_mm * between(self.thickness_ratio) / 2.0;
        let station = core::f64::consts::PI * place;
        let bearing = -libm::cos(station) * half_rad;
        let from_mm = camber_mm + outward * half_mm * libm::sin(station);
        let along_mm = from_mm * libm::sin(bearing) + self.shift_mm;
        let off_mm = from_mm * libm::cos(bearing) - camber_mm * libm::cos(half_rad);
        let angle = self.hand * (along_mm * sin + off_mm * cos) / radius_mm + turn_rad;
        let (y, x) = libm::sincos(angle);
        Point::new(radius_mm * x, radius_mm * y, along_mm * cos - off_mm * sin)
    }

    /// Sections of one side, from the hub to the tip; `outward` 1 for the suction side.
    fn sections(&self, outward: f64, turn_rad: f64) -> Vec<Vec<Point>> {
        let share = |k: usize, count: usize| k as f64 / (count - 1) as f64;
        let point = |j: usize, i: usize| self.point(share(j, SECTIONS), share(i, POINTS), outward, turn_rad);
        (0..SECTIONS).map(|j| (0..POINTS).map(|i| point(j, i)).collect()).collect()
    }

    /// A side, turned about the rotor's axis; `outward` 1 for the suction side.
    fn face(&self, outward: f64, turn_rad: f64) -> Face {
        let normal = Rotation3::from_axis_angle(&Vector::z_axis(), turn_rad) * Vector::y() * (outward * self.hand);
        Face::through(&self.sections(outward, turn_rad), normal).unwrap()
    }

    /// A blade, turned about the rotor's axis.
    pub fn blade(&self, turn_rad: f64) -> Blade {
        Blade { pressure: self.face(-1.0, turn_rad), suction: self.face(1.0, turn_rad) }
    }

    /// Rotor and slot, all turned about the rotor's axis.
    pub fn slot(&self, turn_rad: f64) -> (Blisk, Slot) {
        let pitch_rad = core::f64::consts::TAU / f64::from(BLADES);
        let pressure = self.face(-1.0, turn_rad);
        let across = self.face(1.0, turn_rad - pitch_rad * self.hand);
        let blisk = Blisk {
            blades: BLADES,
            pressure: pressure.clone(),
            suction: self.face(1.0, turn_rad),
            further_blades: Vec::new(),
            hub: Revolution { profile_mm: vec![[-40.0, HUB_MM], [40.0, HUB_MM]] },
            blank: Blank { radius_mm: BLANK_MM, faces_mm: [-16.0, 16.0] },
        };
        (blisk, Slot { pressure, suction: across })
    }

    /// Plan of the rotor with the published ring.
    pub fn plan(&self) -> SlotPlan {
        let (blisk, slot) = self.slot(0.0);
        plan(&blisk, &slot, &ring(), &roughing()).unwrap_or_else(|why| panic!("{}: {why}", self.name))
    }
}
