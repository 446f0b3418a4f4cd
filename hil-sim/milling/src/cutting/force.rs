//! Sum of the forces of all edges on the tool.
//!
//! A piece adds, in the tool frame of [`super::edges`],
//!
//! ```text
//! F = -(Ft t + Fr n + Fa m)        (1)
//! T = r Ft                         (2) about the axis, against the spindle
//! P = 2 pi n T                     (3)
//! ```
//!
//! On a cylinder's side Ft and Fr have no z component, so a positive Fa gives Fz = -Fa: towards the workpiece.
//!
//! Source: own geometry; (1) has the signs of the transformation of Engin, Altintas, Int. J. Machine Tools & Manufacture 41,
//! 2001 (recalled): +Fr cos k - Fa sin k along z.

use std::f64::consts::TAU;

use arcfeed_units::{MM_PER_M, S_PER_MIN};
use nalgebra::Vector3;

use super::edges::EdgePiece;
use super::material::EdgeForce;

/// Force and torque of the workpiece on the tool: sums over all edges at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Loads {
    /// Force on the tool, in the tool frame.
    pub force_n: Vector3<f64>,
    /// Torque about the spindle's axis, against its rotation.
    pub torque_n_m: f64,
}

impl Loads {
    /// Adds the force on an edge piece when M3 has turned the spindle by `turned_rad`; returns the added force in the tool frame. (1), (2)
    pub fn add(&mut self, piece: &EdgePiece, turned_rad: f64, force: &EdgeForce) -> Vector3<f64> {
        let to = piece.directions(turned_rad);
        let force_n = -(to.motion * force.tangential_n + to.normal * force.radial_n + to.along * force.axial_n); // (1)
        self.force_n += force_n;
        self.torque_n_m += piece.radius_mm * force.tangential_n / MM_PER_M; // (2)
        force_n
    }

    /// Component of the force square to the tool's axis, N, which bends the tool.
    pub fn bending_n(&self) -> f64 {
        libm::hypot(self.force_n.x, self.force_n.y)
    }

    /// Power of the spindle, W, at this speed. (3)
    pub fn power_w(&self, spindle_rev_per_min: f64) -> f64 {
        TAU * spindle_rev_per_min / S_PER_MIN * self.torque_n_m
    }
}
