//! Transformation between program coordinates and path coordinates.
//!
//! The *path* is that of the tool tip along the machine's axes, relative to the machine's zero. It does not jump when
//! a program changes its coordinates. With all offsets zero and no G51, G52, G92 or G68, program and path coordinates
//! are equal. With the shift s (work offset, G52, G92), G68's centre c and angle a in its plane, and the program's
//! point as scaled by G51,
//!
//! ```text
//! path = s + c + T(a) (G51(program) - c)        (1)
//! ```
//!
//! Lengths are exact integers, except that (1) rounds to nanometres. Machine coordinates are path coordinates plus the
//! tool length along Z.

use super::axis_scaling::AxisScaling;
use super::motion::{Plane, Pose};
use arcfeed_units::{MicroDeg, Nm};

/// Rotation of the program's coordinates by G68.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoordinateRotation {
    /// Plane in which the coordinates are rotated.
    pub plane: Plane,
    /// Centre of the rotation on the plane's first and second axis, in program coordinates after scaling by G51.
    pub center: [Nm; 2],
    /// Angle of the rotation, positive counter-clockwise.
    pub angle: MicroDeg,
    cos: f64,
    sin: f64,
}

/// Transformation from the program's coordinates to those of the path, which are relative to the machine's zero:
/// scaling, rotation, and shift by the offsets.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CoordinateFrame {
    shift: Pose,
    scaling: Option<AxisScaling>,
    rotation: Option<CoordinateRotation>,
    /// Cached: every block reads it, few change it.
    is_elsewhere: bool,
}

impl CoordinateRotation {
    /// Rotation by `angle` about a point of the plane; exact for whole quarter turns.
    #[inline(never)]
    pub fn new(plane: Plane, center: [Nm; 2], angle: MicroDeg) -> Self {
        const QUARTER: i64 = 90_000_000;
        let (sin, cos) = match (angle.0 % QUARTER, angle.0.div_euclid(QUARTER).rem_euclid(4)) {
            (0, 0) => (0.0, 1.0),
            (0, 1) => (1.0, 0.0),
            (0, 2) => (0.0, -1.0),
            (0, _) => (-1.0, 0.0),
            _ => libm::sincos(angle.to_deg().to_radians()),
        };
        CoordinateRotation { plane, center, angle, cos, sin }
    }

    /// Turns a point about the centre.
    pub(crate) fn apply(&self, axes: &mut [Nm; 3]) {
        self.turn(axes, self.center, self.sin);
    }

    fn turn(&self, axes: &mut [Nm; 3], center: [Nm; 2], sin: f64) {
        let (first, second, _) = self.plane.axes();
        let [cx, cy] = center;
        let from = |index: usize, center: Nm| axes.get(index).map_or(0.0, |axis| (axis.0 - center.0) as f64);
        let (x, y) = (from(first, cx), from(second, cy));
        let turned = [(first, cx, self.cos * x - sin * y), (second, cy, sin * x + self.cos * y)];
        for (index, center, value) in turned {
            if let Some(axis) = axes.get_mut(index) {
                axis.0 = center.0.saturating_add(libm::round(value) as i64); // (1)
            }
        }
    }
}

impl CoordinateFrame {
    /// Transformation with this shift (the program's origin in path coordinates), scaling or mirror image (G51,
    /// G51.1), and rotation (G68).
    pub fn new(shift: Pose, scaling: Option<AxisScaling>, rotation: Option<CoordinateRotation>) -> Self {
        let is_elsewhere = scaling.is_some() || rotation.is_some() || shift != Pose::ORIGIN;
        CoordinateFrame { shift, scaling, rotation, is_elsewhere }
    }

    /// Position of the program's origin in path coordinates.
    pub fn shift(&self) -> Pose {
        self.shift
    }

    /// Scaling (G51) or mirror image (G51.1); `None` without one.
    pub fn scaling(&self) -> Option<&AxisScaling> {
        self.scaling.as_ref()
    }

    /// Coordinate rotation (G68); `None` without one.
    pub fn rotation(&self) -> Option<&CoordinateRotation> {
        self.rotation.as_ref()
    }

    /// Whether program and path coordinates are equal.
    #[inline]
    pub fn is_plain(&self) -> bool {
        !self.is_elsewhere
    }

    /// Whether program coordinates differ from path coordinates at most by a shift.
    #[inline]
    pub fn is_shift(&self) -> bool {
        self.rotation.is_none() && self.scaling.is_none()
    }

    /// Converts a point from program to path coordinates.
    pub fn to_path(&self, mut program: Pose) -> Pose {
        if let Some(scaling) = &self.scaling {
            scaling.apply(&mut program.linear);
        }
        if let Some(rotation) = &self.rotation {
            rotation.apply(&mut program.linear);
        }
        program.plus(self.shift)
    }

    /// Converts a point from path to program coordinates.
    pub fn to_program(&self, path: Pose) -> Pose {
        let mut program = path.minus(self.shift);
        if let Some(rotation) = &self.rotation {
            rotation.turn(&mut program.linear, rotation.center, -rotation.sin);
        }
        if let Some(scaling) = &self.scaling {
            scaling.undo(&mut program.linear);
        }
        program
    }

    /// Converts a vector, such as I, J, K, from program to path coordinates.
    pub fn vector(&self, mut vector: [Nm; 3]) -> [Nm; 3] {
        if let Some(scaling) = &self.scaling {
            scaling.vector(&mut vector);
        }
        if let Some(rotation) = &self.rotation {
            rotation.turn(&mut vector, [Nm(0); 2], rotation.sin);
        }
        vector
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(x: f64, y: f64) -> Pose {
        Pose { linear: [Nm::from_mm(x), Nm::from_mm(y), Nm(7)], ..Pose::ORIGIN }
    }

    #[test]
    fn a_quarter_about_a_centre_is_exact_and_leads_back() {
        let center = [10.0, 0.0].map(Nm::from_mm);
        let rotation = CoordinateRotation::new(Plane::Xy, center, MicroDeg(90_000_000));
        let frame = CoordinateFrame::new(pose(100.0, 0.0), None, Some(rotation));
        let mut wanted = pose(110.0, 5.0);
        wanted.linear[2] = Nm(14);
        assert_eq!(frame.to_path(pose(15.0, 0.0)), wanted);
        assert_eq!(frame.to_program(wanted), pose(15.0, 0.0));
        assert_eq!(frame.vector([Nm(5), Nm(0), Nm(3)]), [Nm(0), Nm(5), Nm(3)]);
    }

    #[test]
    fn three_four_five_turned_back_is_within_a_nanometre() {
        let rotation = CoordinateRotation::new(Plane::Xy, [Nm(0); 2], MicroDeg(-36_869_898));
        let turned = CoordinateFrame::new(Pose::ORIGIN, None, Some(rotation)).to_path(pose(4.0, 3.0));
        // 36.869898 degrees is atan(3/4) to half a microdegree: 9e-9 rad over 5 mm.
        assert!((turned.linear[0].0 - 5_000_000).abs() <= 1 && turned.linear[1].0.abs() <= 45, "{turned:?}");
    }
}
