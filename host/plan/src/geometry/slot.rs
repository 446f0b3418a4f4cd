//! Space between two blades, and copies of blades.
//!
//! The neighbour that a pressure side faces follows from its normals, so that rotors of both hands have slots.

use nalgebra::Rotation3;

use crate::vector::Vector;

use super::blisk::{Blisk, Slot};
use super::face::Face;

/// Pressure and suction side of one blade of a rotor.
#[derive(Clone, Debug)]
pub struct Blade {
    /// Concave side.
    pub pressure: Face,
    /// Convex side.
    pub suction: Face,
}

/// Places along both parameters at which the facing direction of a side is sampled.
const PROBES: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];

impl Blisk {
    /// Angle from one blade to the next.
    pub fn pitch_rad(&self) -> f64 {
        core::f64::consts::TAU / f64::from(self.blades)
    }

    /// The blade with index `index` about the axis; 0 is the first one.
    pub fn blade(&self, index: i32) -> Blade {
        let turn = Rotation3::from_axis_angle(&Vector::z_axis(), f64::from(index) * self.pitch_rad());
        Blade { pressure: self.pressure.turned(&turn), suction: self.suction.turned(&turn) }
    }

    /// All blades, in the order of their angles about the axis.
    pub fn blades(&self) -> impl Iterator<Item = Blade> + '_ {
        (0..self.blades).map(|index| self.blade(index.cast_signed()))
    }

    /// Direction from the first blade to the blade that its pressure side faces: 1 for increasing angles, -1 for
    /// decreasing ones.
    pub fn facing(&self) -> i32 {
        let places = PROBES.iter().flat_map(|u| PROBES.map(|v| (*u, v)));
        let around = |(u, v)| {
            let point = self.pressure.point(u, v);
            Vector::z().cross(&point.coords).normalize().dot(&self.pressure.normal(u, v))
        };
        if places.map(around).sum::<f64>() < 0.0 { -1 } else { 1 }
    }

    /// Slot at the pressure side of the first blade, with the suction side of the next blade across it, in the rotor's own frame.
    pub fn slot(&self) -> Slot {
        Slot { pressure: self.pressure.clone(), suction: self.blade(self.facing()).suction }
    }
}
