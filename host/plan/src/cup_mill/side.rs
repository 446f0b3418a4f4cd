//! One side of a blade with its allowance, and the hub with its allowance.
//!
//! The round edges of a blade belong to both of its sides. A side in the sense of the method is the part between them,
//! as in a CAD model: where the normal stays near that of the middle. The ring turns about points beside one of its
//! edges; at the other edge, which it approaches, the round is included. (About a point of the first edge's own round a
//! ring cannot turn without cutting into it: by half the square of the turn, relative to the allowance.) A side begins
//! where it leaves the hub with its allowance, and is extended above the tip, straight, by the allowance: the tip's
//! edge is to keep its distance, too.

use nalgebra::Rotation3;

use crate::geometry::blisk::{Blisk, Revolution};
use crate::geometry::face::Face;
use crate::vector::{Flat, Point, Vector};

use super::patch::Patch;

/// A side of a blade turns by less than this from its middle to its edges, where the round ones begin.
const EDGE_TURN_DEG: f64 = 35.0;
/// Search steps of a side.
const SIDE_STEPS: [usize; 2] = [48, 32];
/// Search steps of the hub: a ring that cuts a few hundredths into it does so on a few millimetres of it.
const HUB_STEPS: [usize; 2] = [32, 128];
/// Number of equal parts into which the height of a slot's sides is divided; the ring passes beside all of them, or the upper ones.
pub const EIGHTHS: usize = 8;
/// Number of sections on which the edges are searched.
const SECTIONS: i32 = 8;
/// Steps from the middle of a side outwards.
const WALK: i32 = 200;
/// Halvings that exhaust the precision of a parameter.
const HALVINGS: i32 = 50;

/// Side of a blade, displaced outwards by the allowance, between its edges and above the hub.
#[derive(Debug)]
pub struct OffsetSide {
    /// Surface of the side.
    pub patch: Patch,
    /// First and last parameter u of the part of the side between the blade's round edges.
    pub edges: [f64; 2],
    /// Parameter v at which the side leaves the hub.
    pub foot: f64,
}

/// Hub with the allowance that is to be left on it.
#[derive(Clone, Copy, Debug)]
pub struct Hub<'h> {
    /// Surface of the hub, in the rotor's own frame.
    pub hub: &'h Revolution,
    /// Allowance on hub and blades, mm.
    pub allowance_mm: f64,
}

/// Round edge of a blade that the turning ring approaches, at the other end of the side than the pivot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FarEdge {
    /// Leading edge, of a suction side.
    Leading,
    /// Trailing edge, of a pressure side.
    Trailing,
}

/// Part of a blade's side that matters for a slot, in the rotor's own frame; it is the same for every direction of the tool.
#[derive(Debug)]
pub struct SideRange {
    face: Face,
    allowance_mm: f64,
    /// First and last u, with the round of the far edge.
    around: [f64; 2],
    edges: [f64; 2],
    foot: f64,
}

impl SideRange {
    /// Part of `face` above the hub with its allowance, including the round of the edge `far`. `None` if the blade does not reach that hub.
    pub fn new(face: &Face, far: FarEdge, above: &Hub<'_>) -> Option<Self> {
        let edges = edges(face);
        let around = match far {
            FarEdge::Leading => [0.0, edges[1]],
            FarEdge::Trailing => [edges[0], 1.0],
        };
        let foot = foot(face, above.hub, above.allowance_mm, edges)?;
        Some(SideRange { face: face.clone(), allowance_mm: above.allowance_mm, around, edges, foot })
    }

    /// Parameter v at which the side leaves the hub.
    pub fn foot(&self) -> f64 {
        self.foot
    }

    /// The same side without the lowest `uncut_eighths` of the [`EIGHTHS`] of of its height.
    pub fn above(&self, uncut_eighths: usize) -> Self {
        let foot = self.foot + (1.0 - self.foot) * uncut_eighths as f64 / EIGHTHS as f64;
        SideRange { face: self.face.clone(), foot, ..*self }
    }

    /// The side with its allowance, after the rotation `turn`.
    pub fn side(&self, turn: &Rotation3<f64>) -> OffsetSide {
        let SideRange { allowance_mm, around, edges, foot, .. } = *self;
        let patch = offset_patch(self.face.turned(turn), allowance_mm, [around, [foot, 1.0]], SIDE_STEPS);
        OffsetSide { patch, edges, foot }
    }
}

/// Offset surface of `face` over `ranges`, extended straight above the tip by the allowance.
pub fn offset_patch(face: Face, allowance_mm: f64, ranges: [[f64; 2]; 2], steps: [usize; 2]) -> Patch {
    let [around, [foot, tip]] = ranges;
    let high = tip + allowance_mm / face.jet(0.5, 1.0).v.norm();
    Patch::new([around, [foot, high]], steps, move |u, v| {
        let beyond = (v - 1.0).max(0.0);
        let tip = face.offset(u, v, allowance_mm);
        if beyond > 0.0 { tip + face.jet(u, 1.0).v * beyond } else { tip }
    })
}

impl OffsetSide {
    /// Side of `face` (in the rotor's own frame) above the hub with its allowance, after the rotation `turn`. `None` if the blade does
    /// not reach that hub.
    pub fn new(face: &Face, far: FarEdge, above: &Hub<'_>, turn: &Rotation3<f64>) -> Option<Self> {
        SideRange::new(face, far, above).map(|trim| trim.side(turn))
    }

    /// The side after a rotation.
    pub fn turned(&self, turn: &Rotation3<f64>) -> Self {
        OffsetSide { patch: self.patch.turned(turn), ..*self }
    }

    /// The same side with fewer samples, for comparisons of plans.
    pub fn coarse(&self, stride: usize) -> Self {
        OffsetSide { patch: self.patch.coarse(stride), ..*self }
    }

    /// Point of the side between its edges: `along` is the fraction of the way from the leading to the trailing edge, `up` that from
    /// the hub to the tip.
    pub fn at(&self, [along, up]: [f64; 2]) -> Point {
        let between = |[from, to]: [f64; 2], share: f64| from + (to - from) * share;
        self.patch.point(between(self.edges, along), between([self.foot, 1.0], up))
    }

    /// Point of the tip's edge at the parameter u, seen along the tool.
    pub fn tip(&self, u: f64) -> Flat {
        self.patch.point(u, 1.0).xy()
    }

    /// Middle of the tip's edge, seen along the tool.
    pub fn tip_middle(&self) -> Flat {
        self.tip((self.edges[0] + self.edges[1]) / 2.0)
    }
}

/// The hub with its allowance around the slot, in the part frame. The parameter u runs along the rotor's axis, beyond
/// both faces of the blank by the allowance; v runs around the axis.
pub fn floor(blisk: &Blisk, allowance_mm: f64, about: [f64; 2]) -> Patch {
    let hub = blisk.hub.clone();
    let [low, high] = blisk.blank.faces_mm;
    Patch::new([[low - allowance_mm, high + allowance_mm], about], HUB_STEPS, move |z, angle| {
        let (sin, cos) = libm::sincos(angle);
        let radius_mm = hub.radius_mm(z);
        let on = Point::new(radius_mm * cos, radius_mm * sin, z);
        on + hub.normal(&on) * allowance_mm
    })
}

/// Outer surface of the blank about the slot, in the part frame.
pub fn roof(blisk: &Blisk, about: [f64; 2]) -> Patch {
    let radius_mm = blisk.blank.radius_mm;
    Patch::new([blisk.blank.faces_mm, about], SIDE_STEPS, move |z, angle| {
        let (sin, cos) = libm::sincos(angle);
        Point::new(radius_mm * cos, radius_mm * sin, z)
    })
}

/// Range of u between the round edges: within it, the normal of no section turns by more than 35 degrees from that of
/// the section's middle.
pub fn edges(face: &Face) -> [f64; 2] {
    let least_cos = libm::cos(EDGE_TURN_DEG.to_radians());
    let bounds = (0..=SECTIONS).map(|j| {
        let v = f64::from(j) / f64::from(SECTIONS);
        let middle = face.normal(0.5, v);
        let is_side = |u: f64| face.normal(u, v).dot(&middle) >= least_cos;
        [0.0, 1.0].map(|end| farthest(0.5, end, is_side))
    });
    bounds.fold([0.0, 1.0], |[first, last]: [f64; 2], [low, high]| [first.max(low), last.min(high)])
}

/// Parameter v at which, at the parameter u, a side with its allowance leaves the hub with its allowance; `None` if it does not.
pub fn leaves_hub(face: &Face, hub: &Revolution, allowance_mm: f64, u: f64) -> Option<f64> {
    let is_above = |v: f64| hub.height_mm(&face.offset(u, v, allowance_mm)) >= allowance_mm;
    is_above(1.0).then(|| farthest(1.0, 0.0, is_above))
}

/// Lowest of these heights.
fn foot(face: &Face, hub: &Revolution, allowance_mm: f64, [first, last]: [f64; 2]) -> Option<f64> {
    let places = (0..=SECTIONS).map(|i| first + (last - first) * f64::from(i) / f64::from(SECTIONS));
    places.filter_map(|u| leaves_hub(face, hub, allowance_mm, u)).min_by(f64::total_cmp)
}

/// Farthest place from `inside` towards `end` up to which `holds` is true.
fn farthest(inside: f64, end: f64, holds: impl Fn(f64) -> bool) -> f64 {
    // In steps, not only by halving: a curve may waver about its end.
    let mut good = inside;
    for step in 1..=WALK {
        let place = inside + (end - inside) * f64::from(step) / f64::from(WALK);
        if !holds(place) {
            let mut bad = place;
            for _ in 0..HALVINGS {
                let middle = (good + bad) / 2.0;
                if holds(middle) { good = middle } else { bad = middle }
            }
            return good;
        }
        good = place;
    }
    good
}

/// Point PT1 of the source, the upper end of the pressure side's leading edge, and the normal there.
pub fn leading_tip(face: &Face, allowance_mm: f64) -> (Point, Vector) {
    let [first, _] = edges(face);
    (face.offset(first, 1.0, allowance_mm), face.normal(first, 1.0))
}
