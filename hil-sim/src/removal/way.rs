//! Path of the tool's tip among the layers, in as few segments as possible.
//!
//! A segment at one height is extended as long as it passes every replaced point, at distance d beside and a along it,
//! within t:
//!
//! ```text
//! slope of the leg within all of (d - t) / a .. (d + t) / a          (1)
//! ```
//!
//! Source: (1) similar triangles.

use arcfeed_shared::kinematics::vector::Vector;
use nalgebra::Vector2;

use super::trail::Of;

/// Tolerance t: far less than any mark of interest.
const OFF_MAX_MM: f64 = 1e-6;

/// Straight part of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// Block of the segment.
    pub of: Of,
    /// Position of the tip at the beginning, in the program's coordinates.
    pub from_mm: Vector,
    /// Position of the tip at the end.
    pub to_mm: Vector,
}

/// The path so far.
#[derive(Clone, Debug, Default)]
pub struct Way {
    legs: Vec<Leg>,
    at_mm: Option<Vector>,
    aim: Option<Aim>,
}

/// Directions in which the last segment may be extended.
#[derive(Clone, Copy, Debug)]
struct Aim {
    /// Direction of the segment, a unit vector.
    ahead: Vector2<f64>,
    slopes: [f64; 2],
    reached_mm: f64,
}

impl Way {
    /// All segments, in order.
    pub fn legs(&self) -> &[Leg] {
        &self.legs
    }

    /// Whether the next point begins a new path.
    pub fn is_lifted(&self) -> bool {
        self.at_mm.is_none()
    }

    /// Moves the tip straight to a point.
    pub fn go(&mut self, of: &Of, tip_mm: Vector) {
        let Some(at_mm) = self.at_mm.replace(tip_mm).filter(|at_mm| *at_mm != tip_mm) else { return };
        if let (Some(leg), Some(aim)) = (self.legs.last_mut(), &mut self.aim)
            && leg.of == *of
            && aim.takes(&leg.from_mm, &tip_mm)
        {
            leg.to_mm = tip_mm;
            return;
        }
        self.legs.push(Leg { of: *of, from_mm: at_mm, to_mm: tip_mm });
        self.aim = Aim::new(&at_mm, &tip_mm);
    }

    /// Interrupts the path: the tip is away from the layers, or its position is unknown.
    pub fn lift(&mut self) {
        (self.at_mm, self.aim) = (None, None);
    }
}

impl Aim {
    /// Directions for a new segment; `None` if the height changes.
    fn new(from_mm: &Vector, to_mm: &Vector) -> Option<Self> {
        let way_mm = plane(to_mm) - plane(from_mm);
        let reached_mm = way_mm.norm();
        let slope = OFF_MAX_MM / reached_mm;
        (from_mm[2] == to_mm[2]).then(|| Aim { ahead: way_mm / reached_mm, slopes: [-slope, slope], reached_mm })
    }

    /// Whether a segment to this point is near to all points before; if so, the point is added. (1)
    fn takes(&mut self, from_mm: &Vector, to_mm: &Vector) -> bool {
        let way_mm = plane(to_mm) - plane(from_mm);
        let (along_mm, beside_mm) = (self.ahead.dot(&way_mm), self.ahead.perp(&way_mm));
        let [low, high] = self.slopes;
        let goes_on = from_mm[2] == to_mm[2] && along_mm > self.reached_mm;
        if !(goes_on && (low..=high).contains(&(beside_mm / along_mm))) {
            return false;
        }
        let [least, most] = [-OFF_MAX_MM, OFF_MAX_MM].map(|off_mm| (beside_mm + off_mm) / along_mm);
        (self.slopes, self.reached_mm) = ([low.max(least), high.min(most)], along_mm);
        true
    }
}

fn plane(place_mm: &Vector) -> Vector2<f64> {
    Vector2::new(place_mm[0], place_mm[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(count: u32) -> Of {
        Of { count, sequence: None, rule: None, is_rapid: false }
    }

    #[test]
    fn a_straight_way_is_one_leg_and_a_block_begins_another() {
        let mut way = Way::default();
        for n in 0..1000 {
            way.go(&of(1 + n / 600), [f64::from(n) * 0.3, f64::from(n) * 0.1, -1.0]);
        }
        assert_eq!(way.legs().len(), 2);
        assert_eq!(way.legs()[0].to_mm, way.legs()[1].from_mm);
        assert_eq!(way.legs()[1].to_mm, [299.7, 99.9, -1.0]);
    }

    #[test]
    fn an_arc_is_off_by_no_more_than_told() {
        let (mut way, radius_mm) = (Way::default(), 40.0);
        for n in 0..5000 {
            let (sin, cos) = libm::sincos(f64::from(n) * 2e-4);
            way.go(&of(1), [radius_mm * cos, radius_mm * sin, 0.0]);
        }
        // The sagitta of a chord c is c^2 / 8 R, which leaves room for c = 0.018 mm of places 0.008 mm apart.
        assert!((1500..2600).contains(&way.legs().len()), "{}", way.legs().len());
        for leg in way.legs() {
            let middle = (plane(&leg.from_mm) + plane(&leg.to_mm)) / 2.0;
            assert!(radius_mm - middle.norm() <= 1.001 * OFF_MAX_MM);
        }
    }

    #[test]
    fn a_lift_and_a_step_down_part_the_way() {
        let mut way = Way::default();
        way.go(&of(1), [0.0; 3]);
        way.go(&of(1), [1.0, 0.0, 0.0]);
        way.go(&of(1), [1.0, 0.0, -1.0]);
        way.go(&of(1), [2.0, 0.0, -1.0]);
        way.lift();
        way.go(&of(1), [5.0, 0.0, -1.0]);
        way.go(&of(1), [6.0, 0.0, -1.0]);
        let ends: Vec<f64> = way.legs().iter().map(|leg| leg.to_mm[0]).collect();
        assert_eq!(ends, [1.0, 1.0, 2.0, 6.0]);
    }
}
