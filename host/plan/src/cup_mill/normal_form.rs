//! Normal form of a rotor for the search: the slot's middle lies at the angle 0, its start edge at low z and at u = 0, and its
//! pressure side faces growing angles.
//!
//! ```text
//! N = diag(1, facing, flip) R_z(-middle)                                      (1)
//! x = facing x',  y = flip y'                                                 (2)
//! ```
//!
//! (1) leads from the part frame to the normal form, (2) from a slot's places in the normal form to those in its own frame: tool and z
//! are the same in both. For a search, numbers are rounded to a power of two far below a manufacturing tolerance. So a rotor whose file
//! lists the points of its sections in reverse, starts at another blade, or is a mirror image is planned with the same numbers to the bit, and
//! choices of the search do not depend on rounding errors.

use arcfeed_nc::modal::Turn;
use nalgebra::{Matrix3, Rotation3};

use crate::geometry::blisk::Blade;
use crate::geometry::blisk::{Blank, Blisk, Revolution, Slot};
use crate::geometry::face::Face;
use crate::path::{Level, SlotPath};
use crate::vector::{Flat, Point, Vector};

use super::axis::Axis;
use super::base::Base;
use super::free_width::FreeWidth;
use super::interior::InteriorPivot;
use super::level::{Stop, StopSurface};

/// Edges of the slot's two blades near which the ring turns, and from which the path starts. The pivots are A at the pressure side's
/// edge, and B1 near the suction side's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartEdge {
    /// Leading edges, as in the source.
    Leading,
    /// Trailing edges.
    Trailing,
}

/// Map between a rotor and its normal form: the same rotor turned and mirrored so that a search does not depend on
/// how a file describes it.
#[derive(Clone, Copy, Debug)]
pub struct NormalForm {
    /// (1)
    to_normal: Matrix3<f64>,
    /// Signs of (2).
    signs: [f64; 2],
}

/// Places along both parameters whose mean is the slot's middle: the same for both senses of u.
const PROBES: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
/// Rounding of lengths for a search, mm: a power of two, so that it is exact.
pub const GRAIN_MM: f64 = 1.0 / (1 << 23) as f64;

impl NormalForm {
    /// Normal form of a rotor and one of its slots; returns the map and both in normal form, with lengths rounded to `grain_mm` if given.
    pub fn of(blisk: &Blisk, slot: &Slot, start: StartEdge, grain_mm: Option<f64>) -> (Self, Blisk, Slot) {
        let faces = [&slot.pressure, &slot.suction];
        let points = PROBES.iter().flat_map(|u| PROBES.map(|v| faces.map(|face| face.point(*u, v).coords)));
        let middle: Vector = points.flatten().sum();
        let lowering = slot.pressure.point(1.0, 0.5).z - slot.pressure.point(0.0, 0.5).z;
        let is_reversed = start == StartEdge::Trailing;
        let flip = if (lowering < 0.0) == is_reversed { 1.0 } else { -1.0 };
        let towards = blisk.facing();
        let facing = f64::from(towards);
        let centred = Rotation3::from_axis_angle(&Vector::z_axis(), -libm::atan2(middle.y, middle.x));
        let to_normal = Matrix3::from_diagonal(&Vector::new(1.0, facing, flip)) * centred.matrix(); // (1)
        let face = |face: &Face| {
            let mapped = face.mapped(&to_normal, is_reversed);
            grain_mm.map_or(mapped.clone(), |grain_mm| mapped.rounded(grain_mm))
        };
        let rounded = |mm: f64| grain_mm.map_or(mm, |grain_mm| libm::round(mm / grain_mm) * grain_mm);
        let mut profile_mm: Vec<[f64; 2]> =
            blisk.hub.profile_mm.iter().map(|[z, radius]| [rounded(flip * z), rounded(*radius)]).collect();
        let [low, high] = blisk.blank.faces_mm.map(|face| rounded(flip * face));
        let faces_mm = [low.min(high), low.max(high)];
        if flip < 0.0 {
            profile_mm.reverse();
        }
        let further = (1..blisk.kinds()).map(|further| blisk.blade(towards * further));
        let normal = Blisk {
            blades: blisk.blades,
            pressure: face(&blisk.pressure),
            suction: face(&blisk.suction),
            further_blades: further
                .map(|blade| Blade { pressure: face(&blade.pressure), suction: face(&blade.suction) })
                .collect(),
            hub: Revolution { profile_mm },
            blank: Blank { faces_mm, ..blisk.blank },
        };
        let slot = Slot { pressure: face(&slot.pressure), suction: face(&slot.suction) };
        (NormalForm { to_normal, signs: [facing, flip] }, normal, slot)
    }

    /// Converts a direction from the part frame to the normal form.
    pub fn normal(&self, direction: &Vector) -> Vector {
        self.to_normal * direction
    }

    /// Converts a direction from the normal form to the part frame.
    pub fn direction(&self, normal: &Vector) -> Vector {
        self.to_normal.tr_mul(normal)
    }

    /// Matrix from the normal form to the part frame; it may mirror.
    pub fn to_part(&self) -> Matrix3<f64> {
        self.to_normal.transpose()
    }

    /// Converts a tool axis from the normal form to the part frame.
    pub fn axis(&self, axis: &Axis) -> Axis {
        let point = |point: Point| Point::from(self.direction(&point.coords));
        Axis { tip: point(axis.tip), foot: point(axis.foot), direction: self.direction(&axis.direction) }
    }

    /// Converts a rotation into the slot frame: the argument begins in the normal form, the result in the part frame.
    pub fn turn(&self, normal: &Rotation3<f64>) -> Rotation3<f64> {
        let [x, y] = self.signs;
        let signs = Matrix3::from_diagonal(&Vector::new(x, y, 1.0));
        Rotation3::from_matrix_unchecked(signs * normal.matrix() * self.to_normal)
    }

    /// Converts a point seen along the tool from the normal form to the slot frame. (2)
    pub fn place(&self, place: Flat) -> Flat {
        Flat::new(self.signs[0] * place.x, self.signs[1] * place.y)
    }

    /// Converts a free width with its centre and direction from the normal form to the frames of part and slot.
    pub fn free_width(&self, free_width: &FreeWidth) -> FreeWidth {
        FreeWidth {
            centre: self.place(free_width.centre),
            direction: self.direction(&free_width.direction),
            ..*free_width
        }
    }

    /// Converts a base position from the normal form to the slot frame.
    pub fn base(&self, base: &Base) -> Base {
        let [exterior, interior, centre] = [base.exterior, base.interior, base.centre].map(|place| self.place(place));
        Base { exterior, interior, centre, ..*base }
    }

    /// Converts a pivot from the normal form to the slot frame.
    pub fn interior(&self, interior: &InteriorPivot) -> InteriorPivot {
        InteriorPivot { pivot: self.place(interior.pivot), ..*interior }
    }

    /// Converts the end of a turn from the normal form to the slot frame; blades count by growing angle.
    pub fn stop(&self, stop: &Stop) -> Stop {
        let at = stop.at.map(|(surface, circle, point)| {
            let surface = match surface {
                StopSurface::Blade(blade, side) if self.signs[0] < 0.0 => StopSurface::Blade(-blade, side),
                other => other,
            };
            let place = self.place(point.xy());
            (surface, circle, Point::new(place.x, place.y, point.z))
        });
        Stop { centre: self.place(stop.centre), at, ..*stop }
    }

    /// Converts a path from the normal form to the slot frame.
    pub fn path(&self, path: SlotPath) -> SlotPath {
        let outward = if self.signs[0] * self.signs[1] > 0.0 { path.outward } else { opposite(path.outward) };
        let level = |level: Level| Level {
            exterior_end: self.place(level.exterior_end),
            interior_end: self.place(level.interior_end),
            ..level
        };
        SlotPath {
            exterior: self.place(path.exterior),
            interior: self.place(path.interior),
            base: self.place(path.base),
            outward,
            levels: path.levels.into_iter().map(level).collect(),
            ..path
        }
    }
}

fn opposite(turn: Turn) -> Turn {
    match turn {
        Turn::Cw => Turn::Ccw,
        Turn::Ccw => Turn::Cw,
    }
}
