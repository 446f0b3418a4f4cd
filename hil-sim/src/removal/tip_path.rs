//! Path of the tool's tip in the workpiece's layers, as few straight segments.
//!
//! A segment at one height is extended as long as it passes every replaced point, at distance d beside and a along it,
//! within t:
//!
//! ```text
//! slope of the leg within all of (d - t) / a .. (d + t) / a          (1)
//! ```
//!
//! Source: (1) similar triangles.

use arcfeed_kinematics::vector::Vector;
use nalgebra::Vector2;

use super::trail::BlockRef;

/// Tolerance t: far less than any mark of interest.
const OFF_MAX_MM: f64 = 1e-6;

/// Straight segment of the tip's path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipSegment {
    /// Block to which the segment belongs.
    pub block: BlockRef,
    /// Position of the tip at the beginning, in the program's coordinates.
    pub from_mm: Vector,
    /// Position of the tip at the end.
    pub to_mm: Vector,
}

/// Path of the tool's tip so far, as straight segments.
#[derive(Clone, Debug, Default)]
pub struct TipPath {
    segments: Vec<TipSegment>,
    at_mm: Option<Vector>,
    cone: Option<ExtensionCone>,
}

/// Directions in which the last segment may be extended.
#[derive(Clone, Copy, Debug)]
struct ExtensionCone {
    /// Direction of the segment, a unit vector.
    ahead: Vector2<f64>,
    slopes: [f64; 2],
    reached_mm: f64,
}

impl TipPath {
    /// All segments, in order of execution.
    pub fn segments(&self) -> &[TipSegment] {
        &self.segments
    }

    /// Whether the next point begins a new path.
    pub fn is_lifted(&self) -> bool {
        self.at_mm.is_none()
    }

    /// Extends the path by a straight motion of the tip to a point, or begins a new path there.
    pub fn move_to(&mut self, block: &BlockRef, tip_mm: Vector) {
        let Some(at_mm) = self.at_mm.replace(tip_mm).filter(|at_mm| *at_mm != tip_mm) else { return };
        if let (Some(segment), Some(cone)) = (self.segments.last_mut(), &mut self.cone)
            && segment.block == *block
            && cone.accepts(&segment.from_mm, &tip_mm)
        {
            segment.to_mm = tip_mm;
            return;
        }
        self.segments.push(TipSegment { block: *block, from_mm: at_mm, to_mm: tip_mm });
        self.cone = ExtensionCone::new(&at_mm, &tip_mm);
    }

    /// Interrupts the path: the tip is away from the layers, or its position is unknown.
    pub fn lift(&mut self) {
        (self.at_mm, self.cone) = (None, None);
    }
}

impl ExtensionCone {
    /// Directions for a new segment; `None` if the height changes.
    fn new(from_mm: &Vector, to_mm: &Vector) -> Option<Self> {
        let path_mm = plane(to_mm) - plane(from_mm);
        let reached_mm = path_mm.norm();
        let slope = OFF_MAX_MM / reached_mm;
        (from_mm[2] == to_mm[2]).then(|| ExtensionCone {
            ahead: path_mm / reached_mm,
            slopes: [-slope, slope],
            reached_mm,
        })
    }

    /// Whether a segment to this point is near to all points before; if so, the point is added. (1)
    fn accepts(&mut self, from_mm: &Vector, to_mm: &Vector) -> bool {
        let path_mm = plane(to_mm) - plane(from_mm);
        let (along_mm, beside_mm) = (self.ahead.dot(&path_mm), self.ahead.perp(&path_mm));
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

    fn block(count: u32) -> BlockRef {
        BlockRef { count, sequence: None, rule: None, is_rapid: false }
    }

    #[test]
    fn a_straight_path_is_one_segment_and_a_block_begins_another() {
        let mut tip_path = TipPath::default();
        for n in 0..1000 {
            tip_path.move_to(&block(1 + n / 600), [f64::from(n) * 0.3, f64::from(n) * 0.1, -1.0]);
        }
        assert_eq!(tip_path.segments().len(), 2);
        assert_eq!(tip_path.segments()[0].to_mm, tip_path.segments()[1].from_mm);
        assert_eq!(tip_path.segments()[1].to_mm, [299.7, 99.9, -1.0]);
    }

    #[test]
    fn the_path_of_an_arc_deviates_by_no_more_than_the_tolerance() {
        let (mut tip_path, radius_mm) = (TipPath::default(), 40.0);
        for n in 0..5000 {
            let (sin, cos) = libm::sincos(f64::from(n) * 2e-4);
            tip_path.move_to(&block(1), [radius_mm * cos, radius_mm * sin, 0.0]);
        }
        // The sagitta of a chord c is c^2 / 8 R, which leaves room for c = 0.018 mm of places 0.008 mm apart.
        assert!((1500..2600).contains(&tip_path.segments().len()), "{}", tip_path.segments().len());
        for segment in tip_path.segments() {
            let middle = (plane(&segment.from_mm) + plane(&segment.to_mm)) / 2.0;
            assert!(radius_mm - middle.norm() <= 1.001 * OFF_MAX_MM);
        }
    }

    #[test]
    fn a_lift_and_a_step_down_divide_the_path() {
        let mut tip_path = TipPath::default();
        tip_path.move_to(&block(1), [0.0; 3]);
        tip_path.move_to(&block(1), [1.0, 0.0, 0.0]);
        tip_path.move_to(&block(1), [1.0, 0.0, -1.0]);
        tip_path.move_to(&block(1), [2.0, 0.0, -1.0]);
        tip_path.lift();
        tip_path.move_to(&block(1), [5.0, 0.0, -1.0]);
        tip_path.move_to(&block(1), [6.0, 0.0, -1.0]);
        let ends: Vec<f64> = tip_path.segments().iter().map(|segment| segment.to_mm[0]).collect();
        assert_eq!(ends, [1.0, 1.0, 2.0, 6.0]);
    }
}
