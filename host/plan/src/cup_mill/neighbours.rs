//! Whole blades about a slot: all surfaces of blades that the sides of the method leave out.
//!
//! The method knows one pressure side and one suction side, each with one of its round edges. The ring is large and
//! passes other blades, too, and the edges behind its pivots. Of the two blades at the slot, the whole surface keeps
//! all but [`NEARER_RATIO`] of the allowance: a ring cannot turn about a point of a round edge without cutting into the
//! allowance there. All other blades keep the whole allowance.

use core::f64::consts::TAU;

use nalgebra::Rotation3;

use crate::cutter::CupMill;
use crate::geometry::blisk::Blade;
use crate::geometry::blisk::Blisk;
use crate::geometry::flaws::BladeSide;
use crate::vector::{Flat, Point, Vector};

use super::patch::Patch;
use super::side::offset_patch;

/// Largest depth by which the ring may cut into the allowance of the slot's own two blades, as a fraction of the allowance: beside the
/// round edge of a finished blade, about which the ring turns (docs/plan.md).
pub const NEARER_RATIO: f64 = 0.15;
/// Distance by which the planner stays away from the limit of the proof, mm: what the proof loses to its triangles, and
/// the planner on lines from level to level.
const PROOF_MM: f64 = 0.025;
/// Search steps of a side.
const STEPS: [usize; 2] = [32, 16];

/// Side of a blade near the slot, which the ring could touch, in the slot frame (z along the tool's axis).
#[derive(Debug)]
pub struct Neighbour {
    /// Blade, counted from that of the slot's pressure side by growing angle; negative before it.
    pub blade: i32,
    /// Pressure or suction side of that blade.
    pub side: BladeSide,
    /// Whether the blade is one of the two beside the slot.
    pub is_own: bool,
    /// Surface of the side with its allowance, including both round edges.
    pub patch: Patch,
}

/// All blades of a rotor, by those of one pitch.
#[derive(Debug)]
pub struct WholeBlades {
    /// Blades of one pitch, by growing angle; the first one is that of the slot's pressure side.
    kinds: Vec<WholeBlade>,
    /// Number of the other blade at the slot.
    across: i32,
    pitches: i32,
}

/// Both sides of one blade with their round edges, with the allowance as a blade beside the slot and as another blade.
#[derive(Debug)]
struct WholeBlade {
    /// As a blade at the slot, and as another one.
    sides: [[Patch; 2]; 2],
    /// Centre of a ball about the blade, and its radius.
    ball: (Point, f64),
}

impl WholeBlade {
    /// Blade with its allowance; `feet` are the parameters v at which its pressure and its suction side leave the hub.
    fn new(blade: &Blade, allowance_mm: f64, feet: [f64; 2]) -> Self {
        let nearer_mm = (allowance_mm * (1.0 - NEARER_RATIO) + PROOF_MM).min(allowance_mm);
        let of_blade = |allowance_mm: f64| {
            [(&blade.pressure, feet[0]), (&blade.suction, feet[1])]
                .map(|(face, foot)| offset_patch(face.clone(), allowance_mm, [[0.0, 1.0], [foot, 1.0]], STEPS))
        };
        let sides = [nearer_mm, allowance_mm].map(of_blade);
        let points = || sides[1].iter().flat_map(Patch::samples);
        // Their mean turns with the blade, as the centre of a box would not.
        let sum = points().map(|point| point.coords).sum::<Vector>();
        let centre = Point::from(sum / points().count() as f64);
        let radius_mm = points().map(|point| (point - centre).norm()).fold(0.0, f64::max);
        WholeBlade { sides, ball: (centre, radius_mm) }
    }

    /// The same blade with fewer samples of its surfaces.
    fn coarse(&self, stride: usize) -> Self {
        let sides = [0, 1].map(|kind: usize| [0, 1].map(|side: usize| self.sides[kind][side].coarse(stride)));
        WholeBlade { sides, ball: self.ball }
    }
}

impl WholeBlades {
    /// Blades of a rotor with their allowance; `feet` are, for each blade of a pitch, the parameters v at which its pressure and its suction side
    /// leave the hub.
    pub fn new(blisk: &Blisk, allowance_mm: f64, feet: &[[f64; 2]]) -> Self {
        let blade = |(index, feet): (i32, &[f64; 2])| WholeBlade::new(&blisk.blade(index), allowance_mm, *feet);
        WholeBlades {
            kinds: (0..).zip(feet).map(blade).collect(),
            across: blisk.facing(),
            pitches: blisk.blades.cast_signed(),
        }
    }

    /// The same blades with fewer samples of their surfaces, for comparisons of plans.
    pub fn coarse(&self, stride: usize) -> Self {
        WholeBlades { kinds: self.kinds.iter().map(|blade| blade.coarse(stride)).collect(), ..*self }
    }

    /// Sides of all blades that a ring near `centre` can meet, slot frame; its centre moves by `travel_mm` at most, and
    /// its bottom stays above `bottom_mm`.
    pub fn about(&self, turn: &Rotation3<f64>, cutter: &CupMill, reach: &Reach) -> Vec<Neighbour> {
        let pitch_rad = TAU / f64::from(self.pitches);
        let kinds = self.kinds.len() as i32;
        let count = self.pitches * kinds;
        let first = -(count - 1) / 2;
        let placed = (first..first + count).map(|blade| {
            let pitch = f64::from(blade.div_euclid(kinds));
            let turn = turn * Rotation3::from_axis_angle(&Vector::z_axis(), pitch * pitch_rad);
            (blade, &self.kinds[blade.rem_euclid(kinds) as usize], turn)
        });
        let near = placed.filter(|(_, whole, turn)| {
            let (middle, radius_mm) = whole.ball;
            let at = turn * middle;
            let off_mm = (at.xy() - reach.centre).norm();
            let slack_mm = radius_mm + reach.travel_mm;
            at.z + radius_mm > reach.bottom_mm
                && off_mm < cutter.outer_radius_mm + slack_mm
                && off_mm > cutter.inner_radius_mm - slack_mm
        });
        let both = near.flat_map(|(blade, whole, turn)| {
            let is_own = blade == 0 || blade == self.across;
            let sides = [BladeSide::Pressure, BladeSide::Suction].into_iter().zip(&whole.sides[usize::from(!is_own)]);
            sides.map(|(side, patch)| Neighbour { blade, side, is_own, patch: patch.turned(&turn) }).collect::<Vec<_>>()
        });
        both.collect()
    }
}

/// Space that the ring can occupy during a path, by which blades out of reach are left out.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    /// Centre about which the ring moves, seen along the tool.
    pub centre: Flat,
    /// Largest distance of its axis from there, mm.
    pub travel_mm: f64,
    /// Lowest height of the tool's bottom, mm.
    pub bottom_mm: f64,
}
