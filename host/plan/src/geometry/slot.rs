//! Space between two blades, and copies of blades.
//!
//! The neighbour that a pressure side faces follows from its normals, so that rotors of both hands have slots.

use nalgebra::Rotation3;

use crate::vector::Vector;

use super::blisk::{Blade, Blisk, Slot};

impl Blade {
    /// The same blade after a rotation about the origin.
    pub fn turned(&self, turn: &Rotation3<f64>) -> Self {
        Blade { pressure: self.pressure.turned(turn), suction: self.suction.turned(turn) }
    }
}

/// Places along both parameters at which the facing direction of a side is sampled.
const PROBES: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];

impl Blisk {
    /// Angle from a blade to its next copy.
    pub fn pitch_rad(&self) -> f64 {
        core::f64::consts::TAU / f64::from(self.blades)
    }

    /// Number of kinds of blades, which is that of the blades of a pitch and of the kinds of slots.
    pub fn kinds(&self) -> i32 {
        1 + self.further_blades.len() as i32
    }

    /// Number of blades of all kinds.
    pub fn count(&self) -> i32 {
        self.blades.cast_signed() * self.kinds()
    }

    /// The blade with index `index` by growing angle about the axis; 0 is the first one.
    pub fn blade(&self, index: i32) -> Blade {
        let (pitch, kind) = (index.div_euclid(self.kinds()), index.rem_euclid(self.kinds()));
        let turn = Rotation3::from_axis_angle(&Vector::z_axis(), f64::from(pitch) * self.pitch_rad());
        let (pressure, suction) = match kind {
            0 => (&self.pressure, &self.suction),
            further => {
                let blade = &self.further_blades[further as usize - 1];
                (&blade.pressure, &blade.suction)
            }
        };
        Blade { pressure: pressure.turned(&turn), suction: suction.turned(&turn) }
    }

    /// All blades, in the order of their angles about the axis.
    pub fn blades(&self) -> impl Iterator<Item = Blade> + '_ {
        (0..self.count()).map(|index| self.blade(index))
    }

    /// The same rotor with the blade `index` as the first one: its [`slot`](Self::slot) lies at the pressure side of that blade.
    pub fn from_blade(&self, index: i32) -> Self {
        let Blade { pressure, suction } = self.blade(index);
        let further_blades = (1..self.kinds()).map(|further| self.blade(index + further)).collect();
        Blisk { pressure, suction, further_blades, ..self.clone() }
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

    /// Width of that slot about the axis, from the middle of one blade to the same place of the next, as a fraction of the pitch: 1 if all blades are alike.
    pub fn slot_ratio(&self) -> f64 {
        if self.further_blades.is_empty() {
            return 1.0;
        }
        let middle = |blade: &Blade| blade.pressure.point(0.5, 0.5) + blade.suction.point(0.5, 0.5).coords;
        let facing = self.facing();
        let [from, to] = [0, facing].map(|index| middle(&self.blade(index))).map(|at| libm::atan2(at.y, at.x));
        (f64::from(facing) * (to - from)).rem_euclid(core::f64::consts::TAU) / self.pitch_rad()
    }
}
