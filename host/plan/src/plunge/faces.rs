//! Plunging from the faces of the blank, where the mill does not pass radially ("bilateral").
//!
//! ```text
//! plane at radius r: along the rotor's axis, square to the passage's middle direction m(r)                 (1)
//! lowest plane: r = largest hub radius over the stretch + allowance + R                                     (2)
//! ```
//!
//! In these planes the boundary axes follow from the walls as in those across the rotor's axis; the mill's ends lie in one plane across it, beyond the
//! stretch by R, so that both families overlap. The side of the lowest mill stands on the allowance of the hub: no point of a plane (1) is nearer to
//! the rotor's axis than r. Above the blades' tips the plane has the boundary axes at the tips' height: all of a blade lies below it, so going up along m
//! the distance from all of it grows.
//!
//! Source: An Luling et al. name "bilateral plunge machining on inlet/outlet"; the rest is ours.

use super::boundary::Boundary;
use super::field::WallSide;
use super::infeasibility::PlungeInfeasible;
use super::mill::PlungeMill;
use super::passage::Passage;
use super::section::{Midway, PlungeSection, SectionFamily, SectionHeights, SectionPlane, boundary};
use crate::vector::{Point, Vector};

/// Distance of planes across the axis in which it is asked whether the mill passes radially, mm.
const LOOK_MM: f64 = 2.0;
/// Precision of the ends of the radial stretch, mm.
const BORDER_MM: f64 = 0.02;
/// Precision of the largest radius, mm.
const RADIUS_PRECISION_MM: f64 = 0.005;
/// Share of radius and allowance by which planes go beyond the blades, and of the radius that a plane opens above itself.
const REACH_RATIO: f64 = 0.9;
/// Planes in which the largest mill is sought.
const LOOKS: u32 = 5;

/// Face of the blank from which the mill enters the passage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EntryFace {
    /// Face at the lower end along the rotor's axis.
    Lower,
    /// Face at the upper end along the rotor's axis.
    Upper,
}

/// Family of planes of plunges from a face of the blank, ordered by their distance from the rotor's axis.
pub struct FaceFamily<'p> {
    /// Passage.
    pub passage: &'p Passage<'p>,
    /// Centre line of the passage.
    pub midway: &'p Midway,
    /// Face from which the mill comes.
    pub face: EntryFace,
    /// Position along the rotor's axis to which the mill's end goes, mm.
    pub inner_mm: f64,
}

/// Part of the passage, along the rotor's axis, in which the mill passes radially; `None` if it does so nowhere.
///
/// # Errors
/// Position of a plane, between others in which it passes, in which it does not: no face opens that.
pub fn radial_stretch(passage: &Passage<'_>, [from_mm, to_mm]: [f64; 2]) -> Result<Option<[f64; 2]>, f64> {
    let passes = |z_mm: f64| passage.boundary(z_mm).is_some_and(|found| found.room_mm() >= 0.0);
    let count = libm::ceil((to_mm - from_mm) / LOOK_MM).max(1.0) as usize;
    let place = |index: usize| from_mm + (to_mm - from_mm) * index as f64 / count as f64;
    let passing: Vec<bool> = (0..=count).map(|index| passes(place(index))).collect();
    let ends = passing.iter().position(|found| *found).zip(passing.iter().rposition(|found| *found));
    let Some((first, last)) = ends else { return Ok(None) };
    if let Some(at) = (first..=last).find(|at| !passing[*at]) {
        return Err(place(at));
    }
    let border = |mut inside: f64, mut outside: f64| {
        while (inside - outside).abs() > BORDER_MM {
            let middle = f64::midpoint(inside, outside);
            if passes(middle) { inside = middle } else { outside = middle }
        }
        inside
    };
    let low = first.checked_sub(1).map_or(from_mm, |before| border(place(first), place(before)));
    let high = if last == count { to_mm } else { border(place(last), place(last + 1)) };
    Ok(Some([low, high]))
}

impl FaceFamily<'_> {
    /// Distances of the first and the last plane from the rotor's axis, mm: half of the mill above the blank, and (2).
    pub fn range_mm(&self) -> [f64; 2] {
        let Passage { blisk, mill, needs, .. } = self.passage;
        let ends_mm = [self.inner_mm, self.blank_face_mm()];
        let hub = blisk.hub.between([ends_mm[0].min(ends_mm[1]), ends_mm[0].max(ends_mm[1])]);
        let hub_mm = hub.iter().map(|[_, radius_mm]| *radius_mm).fold(0.0, f64::max);
        let lowest_mm = hub_mm + needs.allowance_mm + mill.radius_mm; // (2)
        // The plane lies above the tips beside it: higher up no blade is near.
        let (tip_mm, rim_mm) = (self.passage.field.radii_mm[1], blisk.blank.radius_mm);
        let beside_mm = tip_mm * libm::cos(blisk.pitch_rad() / 2.0);
        let walled_mm = beside_mm + REACH_RATIO * (mill.radius_mm + needs.allowance_mm);
        let reaches_rim = walled_mm + REACH_RATIO * mill.radius_mm >= rim_mm;
        let highest_mm = if reaches_rim { rim_mm.min(walled_mm) } else { rim_mm };
        [highest_mm.max(lowest_mm), lowest_mm]
    }

    /// Sign of the direction from the passage to the face along the rotor's axis.
    fn outward(&self) -> f64 {
        match self.face {
            EntryFace::Lower => -1.0,
            EntryFace::Upper => 1.0,
        }
    }

    fn blank_face_mm(&self) -> f64 {
        let [low_mm, high_mm] = self.passage.blisk.blank.faces_mm;
        if self.face == EntryFace::Lower { low_mm } else { high_mm }
    }

    /// Largest diameter that passes in all planes of its own, mm.
    fn largest_mm(&self) -> Option<f64> {
        let passes = |radius_mm: f64| {
            let mill = PlungeMill { radius_mm, ..self.passage.mill.clone() };
            let passage = Passage { mill: &mill, ..*self.passage };
            let family = FaceFamily { passage: &passage, ..*self };
            let [high_mm, low_mm] = family.range_mm();
            let share = |look: u32| f64::from(look) / f64::from(LOOKS - 1);
            (0..LOOKS).map(|look| low_mm + (high_mm - low_mm) * share(look)).all(|at_mm| has_room(&family, at_mm))
        };
        largest_radius_mm(self.passage.mill.radius_mm, passes).map(|radius_mm| 2.0 * radius_mm)
    }
}

/// Whether the mill passes in a plane; where no blade is near, any does.
pub(super) fn has_room(family: &dyn SectionFamily, at_mm: f64) -> bool {
    family.at(at_mm).map_or(true, |found| found.boundary.room_mm() >= 0.0)
}

/// Largest radius below one that does not pass, by halving.
pub(super) fn largest_radius_mm(fails_mm: f64, passes: impl Fn(f64) -> bool) -> Option<f64> {
    let (mut low, mut high) = (RADIUS_PRECISION_MM, fails_mm);
    if !passes(low) {
        return None;
    }
    while high - low > RADIUS_PRECISION_MM {
        let middle = f64::midpoint(low, high);
        if passes(middle) { low = middle } else { high = middle }
    }
    Some(low)
}

/// Points of both blades that the boundary axes' mills touch.
pub(super) fn touched(passage: &Passage<'_>, plane: &SectionPlane, boundary: &Boundary) -> [Point; 2] {
    [(WallSide::Left, 0), (WallSide::Right, 1)]
        .map(|(side, index)| passage.field.distance(side, &plane.point(&boundary.touching[index])).1)
}

impl SectionFamily for FaceFamily<'_> {
    fn at(&self, at_mm: f64) -> Result<PlungeSection, PlungeInfeasible> {
        let Passage { field, mill, .. } = self.passage;
        let ([low_mm, high_mm], outward) = (field.ends_mm, self.outward());
        let edge_mm = if self.face == EntryFace::Lower { low_mm } else { high_mm };
        // The middle direction is linear between hub and tip, so that the planes change evenly.
        let [foot_mm, tip_mm] = field.radii_mm;
        let [foot_rad, tip_rad] = [foot_mm, tip_mm]
            .map(|radius_mm| self.midway.angle_rad([f64::midpoint(self.inner_mm, edge_mm), radius_mm]));
        let share = (at_mm.min(tip_mm) - foot_mm) / (tip_mm - foot_mm);
        let middle_rad = foot_rad + (tip_rad - foot_rad) * share;
        let (sin, cos) = libm::sincos(middle_rad);
        let plane = |radius_mm: f64| SectionPlane {
            origin: Point::new(radius_mm * cos, radius_mm * sin, 0.0),
            across: Vector::new(-sin, cos, 0.0),
            up: Vector::z() * outward,
        };
        let heights = SectionHeights {
            floor_mm: outward * self.inner_mm,
            edge_mm: (outward * edge_mm).max(outward * self.inner_mm + mill.radius_mm),
            roof_mm: outward * self.blank_face_mm(),
        };
        let beside = plane(at_mm.min(tip_mm));
        let found = boundary(self.passage, self.midway, &beside, &heights, middle_rad)
            .ok_or(PlungeInfeasible::NoBoundary { z_mm: self.inner_mm })?;
        Ok(PlungeSection { plane: plane(at_mm), boundary: found })
    }

    fn too_narrow(&self, PlungeSection { plane, boundary }: &PlungeSection) -> PlungeInfeasible {
        PlungeInfeasible::FaceTooNarrow {
            z_mm: self.inner_mm,
            radius_mm: libm::hypot(plane.origin.x, plane.origin.y),
            missing_mm: -boundary.room_mm(),
            touching: touched(self.passage, plane, boundary),
            largest_mm: self.largest_mm(),
        }
    }
}
