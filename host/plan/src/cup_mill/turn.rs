//! Largest turn of a tool about a point of its own circle before it meets something.
//!
//! The tool is a solid of revolution: when its centre turns about a pivot, it moves as if it were rotated as a whole.
//! The contact with a fixed point q occurs when the annulus at its height, [r_h, R_h], reaches it:
//!
//! ```text
//! |q - C|^2 = s^2 + L^2 - 2 s L cos(psi),  s = |q - pivot|, L = |C - pivot|   (1)
//! psi_h = acos((s^2 + L^2 - rho^2) / (2 s L)),  rho = R_h or r_h              (2)
//! turn = least positive of  +-(psi0 -+ psi_h)                                 (3)
//! ```
//!
//! with psi the angle from C to q seen from the pivot, psi0 its value at the beginning. So the turn up to contact with
//! a surface is the least value of (3) over its points, without gaps: there are no steps in time.

use arcfeed_nc::modal::Turn;

use crate::cutter::CupMill;
use crate::vector::{Flat, Point};

/// Tool at the beginning of a turn about a pivot.
#[derive(Clone, Copy, Debug)]
pub struct TurningTool<'c> {
    /// Cutter, as a solid of revolution.
    pub cutter: &'c CupMill,
    /// Centre of the tool at the beginning, seen along the tool.
    pub centre: Flat,
    /// Height of the tool's bottom, mm; it does not change in the turn.
    pub bottom_mm: f64,
    /// Point about which the tool's centre turns, seen along the tool.
    pub pivot: Flat,
    /// Sense of rotation of the turn.
    pub turn: Turn,
}

/// Circle of the ring (inner or outer) that meets a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Circle {
    /// Inner circle.
    Inner,
    /// Outer circle.
    Outer,
}

impl TurningTool<'_> {
    /// Angle of the turn, rad, after which the ring meets `point`; `None` if it never does or already contains the point.
    pub fn until(&self, point: &Point) -> Option<(f64, Circle)> {
        let radii = self.cutter.radii_mm(point.z - self.bottom_mm)?;
        let place = Flat::new(point.x, point.y);
        let from_centre_mm = (place - self.centre).norm();
        let circle = if from_centre_mm > (radii[0] + radii[1]) / 2.0 { Circle::Outer } else { Circle::Inner };
        let radius_mm = if circle == Circle::Outer { radii[1] } else { radii[0] };
        self.circle_until(place, radius_mm, circle).map(|turn| (turn, circle))
    }

    /// Centre of the tool after a turn by this angle, seen along the tool.
    pub fn centre_after(&self, turn_rad: f64) -> Flat {
        let turn = nalgebra::Rotation2::new(turn_rad * self.sense());
        self.pivot + turn * (self.centre - self.pivot)
    }

    fn sense(&self) -> f64 {
        if self.turn == Turn::Ccw { 1.0 } else { -1.0 }
    }

    /// Angle of the turn, rad, after which the ring's circle of `radius_mm` goes through `place`; `None` if it never does, 0 if the
    /// ring is there already.
    pub fn circle_until(&self, place: Flat, radius_mm: f64, circle: Circle) -> Option<f64> {
        let (to_place, to_centre) = (place - self.pivot, self.centre - self.pivot);
        let (s, l) = (to_place.norm(), to_centre.norm());
        let from_centre_mm = (place - self.centre).norm();
        let (rho, has_it) = match circle {
            Circle::Outer => (radius_mm - TOUCH_MM, from_centre_mm < radius_mm - TOUCH_MM),
            Circle::Inner => (radius_mm + TOUCH_MM, from_centre_mm > radius_mm + TOUCH_MM),
        };
        let cos = (s * s + l * l - rho * rho) / (2.0 * s * l); // (1)
        if has_it {
            return Some(0.0);
        }
        if !(-1.0..=1.0).contains(&cos) {
            return None;
        }
        let met = libm::acos(cos); // (2)
        let now = libm::atan2(to_centre.perp(&to_place), to_centre.dot(&to_place)) * self.sense();
        let ahead = [now - met, now + met].map(|turn| if turn < 0.0 { turn + core::f64::consts::TAU } else { turn });
        Some(ahead[0].min(ahead[1])) // (3)
    }
}

/// Depth up to which touching is no contact, mm: the pivot's own place stays on its circle, and rounding must not make
/// it a contact.
const TOUCH_MM: f64 = 2e-6;
