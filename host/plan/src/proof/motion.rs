//! Step of the path as a curve, by the length along it.

use arcfeed_nc::modal::Turn;

use crate::path::Step;
use crate::vector::{Flat, Point, Vector};

/// An arc whose ends are nearer than this has no length: rounding.
const SAME_MM: f64 = 1e-9;

/// One step of the path as a curve: line or arc of the middle of the tool's bottom, in the slot frame (z along the tool's axis).
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// Length, mm.
    pub length_mm: f64,
    from: Point,
    /// Direction of a line; an arc is horizontal.
    direction: Vector,
    arc: Option<Arc>,
}

/// Horizontal arc of a motion.
#[derive(Clone, Copy, Debug)]
pub struct Arc {
    /// Centre.
    pub centre: Flat,
    /// Radius, mm.
    pub radius_mm: f64,
    /// Angle of the start as seen from the centre, from x towards y.
    pub start_rad: f64,
    /// Angle from start to end, positive from x towards y.
    pub sweep_rad: f64,
}

/// Position of the tool on its path, with direction and curvature of the path there.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    /// Position of the middle of the tool's bottom.
    pub place: Point,
    /// Unit vector along the motion.
    pub tangent: Vector,
    /// Curvature vector: towards the centre of the arc, with the length 1/radius, 1/mm; zero on a line.
    pub curvature: Vector,
}

impl Arc {
    /// Both ends relative to the centre.
    pub fn ends(&self) -> [Flat; 2] {
        [self.start_rad, self.start_rad + self.sweep_rad].map(|angle_rad| {
            let (sin, cos) = libm::sincos(angle_rad);
            Flat::new(self.radius_mm * cos, self.radius_mm * sin)
        })
    }
}

impl Motion {
    /// Motion of a step. An arc back to its start has no length.
    pub fn new(step: &Step) -> Self {
        let (from, to) = (Point::from(step.from), Point::from(step.to));
        let way = to - from;
        let line = Motion {
            length_mm: way.norm(),
            from,
            direction: way.try_normalize(0.0).unwrap_or_else(Vector::zeros),
            arc: None,
        };
        let Some((centre, turn)) = step.about.filter(|_| line.length_mm > SAME_MM) else { return line };
        let angle = |place: &Point| libm::atan2(place.y - centre.y, place.x - centre.x);
        let (start_rad, end_rad) = (angle(&from), angle(&to));
        let full = core::f64::consts::TAU;
        let ccw_rad = (end_rad - start_rad).rem_euclid(full);
        let sweep_rad = match turn {
            Turn::Ccw => ccw_rad,
            Turn::Cw => ccw_rad - full,
        };
        let radius_mm = libm::hypot(from.x - centre.x, from.y - centre.y);
        let arc = Arc { centre, radius_mm, start_rad, sweep_rad };
        Motion { length_mm: radius_mm * sweep_rad.abs(), arc: Some(arc), ..line }
    }

    /// The arc, if the motion is one.
    pub fn arc(&self) -> Option<&Arc> {
        self.arc.as_ref()
    }

    /// Position of the tool after this length of the motion.
    pub fn at(&self, way_mm: f64) -> Pose {
        let Some(arc) = &self.arc else {
            let place = self.from + self.direction * way_mm;
            return Pose { place, tangent: self.direction, curvature: Vector::zeros() };
        };
        let sense = arc.sweep_rad.signum();
        let (sin, cos) = libm::sincos(arc.start_rad + sense * way_mm / arc.radius_mm);
        let radial = Vector::new(cos, sin, 0.0);
        let place = Point::new(arc.centre.x + arc.radius_mm * cos, arc.centre.y + arc.radius_mm * sin, self.from.z);
        Pose { place, tangent: Vector::new(-sin, cos, 0.0) * sense, curvature: -radial / arc.radius_mm }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::Purpose;

    fn step(to: [f64; 3], about: Option<(Flat, Turn)>) -> Motion {
        Motion::new(&Step { purpose: Purpose::Link, level: 0, from: [3.0, 0.0, 5.0], to, about })
    }

    #[test]
    fn a_motion_ends_where_its_step_ends() {
        let quarter = step([0.0, 3.0, 5.0], Some((Flat::origin(), Turn::Ccw)));
        let other_way = step([0.0, 3.0, 5.0], Some((Flat::origin(), Turn::Cw)));
        assert!((other_way.length_mm - 3.0 * quarter.length_mm).abs() < 1e-12);
        for motion in [quarter, other_way] {
            assert!((motion.at(motion.length_mm).place - Point::new(0.0, 3.0, 5.0)).norm() < 1e-12);
        }
        assert!((quarter.at(0.0).tangent - Vector::y()).norm() < 1e-12);
        let line = step([3.0, 4.0, 2.0], None);
        assert!((line.at(5.0).place - Point::new(3.0, 4.0, 2.0)).norm() < 1e-12);
        assert_eq!(step([3.0, 0.0, 5.0], Some((Flat::origin(), Turn::Cw))).length_mm, 0.0);
    }
}
