//! Segments: motions with checked geometry, in absolute and exact coordinates.
//!
//! Coordinates are integer nanometres. An arc's programmed start and end never lie on exactly one circle; the centre
//! is what the program says, the radius is the one at the start, and the difference at the end is checked against
//! parameter 3410.
//!
//! An arc whose start and end differ across its plane is a helix of at most one turn. Its F is measured along the arc
//! in the plane (parameter 1403, bit 5, HTG = 0: the control's default); all feeds follow this convention.
//!
//! Source: Fanuc 15i operator's manual B-63324EN, 4.5, and connection manual B-63783EN-1, 6.7 (there HTG is 1401, bit 2).

use crate::alarm::{Alarm, Fault, NotModelled};
use crate::modal::{Center, Feed, Motion, MotionKind, Plane, Pose, Turn};
use crate::radius::center_offset;
use arcfeed_units::Nm;

/// Largest accepted difference between an arc's radii at its start and end (parameter 3410; a common setting): 30 um.
pub const RADIUS_TOLERANCE: Nm = Nm(30_000);

/// One move of the tool centre with checked geometry, in absolute coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Sequence number (N word) of its block; `None` without one.
    pub sequence: Option<i64>,
    /// Start position.
    pub start: Pose,
    /// End position.
    pub end: Pose,
    /// Programmed feed, exactly as the program gives it.
    pub feed: Feed,
    /// Shape of the path.
    pub path: Path,
}

/// Shape of a segment's path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Path {
    /// Rapid traverse; the machine decides on the path.
    Rapid,
    /// Straight line, on which all axes move together.
    Line,
    /// Arc of a circle in one plane. If start and end differ across the plane, it is a helix.
    Arc(Arc),
}

/// A circular arc, described in the two axes of its plane, nanometres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Plane of the arc.
    pub plane: Plane,
    /// Sense of the arc.
    pub turn: Turn,
    /// Rotation centre, in the coordinates of the segment.
    pub center: [Nm; 2],
    /// Start, relative to the centre.
    pub from: [Nm; 2],
    /// End, relative to the centre; equal to `from` for a full circle.
    pub to: [Nm; 2],
}

/// Start angle and sweep of an arc in its plane, for the computation of many points on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArcAngles {
    /// Angle of the start from the plane's first axis, positive counter-clockwise.
    pub start_rad: f64,
    /// Angle from start to end, positive counter-clockwise, negative clockwise.
    pub turned_rad: f64,
}

impl Segment {
    /// Makes a segment from a commanded motion, if its geometry is possible.
    ///
    /// # Errors
    /// PS0020 for a radius difference above [`RADIUS_TOLERANCE`], or for ends that no circle of radius R reaches;
    /// PS0022 for no radius at all. Arcs that also turn a rotary axis, or have no angle, are not modelled.
    pub fn from_motion(motion: &Motion, sequence: Option<i64>) -> Result<Self, Fault> {
        Ok(Segment::along(Path::of(motion)?, motion, sequence))
    }

    /// A segment with this path, from a motion.
    pub(crate) fn along(path: Path, motion: &Motion, sequence: Option<i64>) -> Self {
        Segment { sequence, start: motion.start, end: motion.end, feed: motion.feed, path }
    }

    /// The same move, shifted by `by` in each axis.
    #[must_use]
    pub fn shifted(&self, by: Pose) -> Self {
        let mut path = self.path;
        if let Path::Arc(arc) = &mut path {
            let (first, second, _) = arc.plane.axes();
            arc.center = add(arc.center, [first, second].map(|axis| pick(&by.linear, axis)));
        }
        Segment { start: self.start.plus(by), end: self.end.plus(by), path, ..*self }
    }

    /// The arc of the segment; `None` if it is not an arc.
    pub fn arc(&self) -> Option<&Arc> {
        match &self.path {
            Path::Arc(arc) => Some(arc),
            Path::Rapid | Path::Line => None,
        }
    }

    /// Displacement along the normal of the arc's plane from start to end, nonzero on a helix; 0 for moves that are
    /// not arcs.
    pub fn rise(&self) -> Nm {
        let Path::Arc(arc) = &self.path else { return Nm(0) };
        let (_, _, normal) = arc.plane.axes();
        Nm(pick(&self.end.linear, normal).0.saturating_sub(pick(&self.start.linear, normal).0))
    }

    /// Position of an arc's start along the normal of its plane; 0 for moves that are not arcs.
    pub fn height(&self) -> Nm {
        let Path::Arc(arc) = &self.path else { return Nm(0) };
        let (_, _, normal) = arc.plane.axes();
        pick(&self.start.linear, normal)
    }

    /// Length along which F is measured, mm: the length of the path; for a helix, of its arc in the plane (HTG = 0).
    pub fn feed_length_mm(&self) -> f64 {
        match &self.path {
            Path::Arc(arc) => arc.length_mm(),
            Path::Rapid | Path::Line => self.straight_mm(),
        }
    }

    /// Length of the tool centre's path, mm; rotary axes do not count. On a helix it includes the rise.
    pub fn length_mm(&self) -> f64 {
        match &self.path {
            Path::Arc(arc) => libm::hypot(arc.length_mm(), self.rise().to_mm()),
            Path::Rapid | Path::Line => self.straight_mm(),
        }
    }

    fn straight_mm(&self) -> f64 {
        let [x, y, z] = self.start.linear;
        let [to_x, to_y, to_z] = self.end.linear;
        let axis = |from: Nm, to: Nm| to.to_mm() - from.to_mm();
        libm::hypot(libm::hypot(axis(x, to_x), axis(y, to_y)), axis(z, to_z))
    }

    /// Whether a rotary axis turns.
    pub fn turns_rotary_axis(&self) -> bool {
        self.start.rotary != self.end.rotary
    }
}

impl Path {
    /// The path of a motion, errors as [`Segment::from_motion`].
    pub(crate) fn of(motion: &Motion) -> Result<Self, Fault> {
        Ok(match motion.kind {
            MotionKind::Rapid => Path::Rapid,
            MotionKind::Line => Path::Line,
            MotionKind::Arc(turn) => Path::Arc(Arc::from_motion(motion, turn)?),
        })
    }
}

impl Arc {
    fn from_motion(motion: &Motion, turn: Turn) -> Result<Self, Fault> {
        let (first, second, _) = motion.plane.axes();
        let in_plane = |axes: &[Nm; 3]| [first, second].map(|axis| pick(axes, axis));
        let (start, end) = (in_plane(&motion.start.linear), in_plane(&motion.end.linear));
        if motion.start.rotary != motion.end.rotary {
            return Err(Fault::not_modelled(NotModelled::RotaryArc, 0));
        }
        let offset = match motion.center {
            Center::Offset(offset) => in_plane(&offset),
            Center::Radius(_) if start == end => return Err(Fault::not_modelled(NotModelled::ArcWithoutAngle, 0)),
            Center::Radius(radius) => center_offset(subtract(end, start), radius, turn, RADIUS_TOLERANCE)
                .map_err(|alarm| Fault::alarm(alarm, 0))?,
        };
        let center = add(start, offset);
        let arc = Arc {
            plane: motion.plane,
            turn,
            center,
            from: offset.map(|Nm(nm)| Nm(nm.saturating_neg())),
            to: subtract(end, center),
        };
        if arc.from == [Nm(0); 2] {
            return Err(Fault::alarm(Alarm::NoRadius, 0));
        }
        if !are_equally_long(arc.from, arc.to) {
            return Err(Fault::alarm(Alarm::RadiusTolerance, 0));
        }
        Ok(arc)
    }

    /// Radius at the start of the arc, mm.
    pub fn radius_mm(&self) -> f64 {
        length_mm(self.from)
    }

    /// Angle from start to end in the sense of the arc, in (0, 2 pi].
    pub fn sweep_rad(&self) -> f64 {
        use core::f64::consts::TAU;
        if self.from == self.to {
            return TAU;
        }
        let [x, y] = self.from.map(Nm::to_mm);
        let [to_x, to_y] = self.to.map(Nm::to_mm);
        let ccw = libm::atan2(x * to_y - y * to_x, x * to_x + y * to_y);
        let sweep = match self.turn {
            Turn::Ccw => ccw,
            Turn::Cw => -ccw,
        };
        if sweep > 0.0 { sweep } else { sweep + TAU }
    }

    /// Length of the arc in its plane, mm, with the radius at the start.
    pub fn length_mm(&self) -> f64 {
        self.radius_mm() * self.sweep_rad()
    }

    /// Unit vector from the centre to the point of the arc at this fraction of the sweep (0 at the start, 1 at the
    /// end).
    pub fn direction_at(&self, ratio: f64) -> [f64; 2] {
        self.angles().direction_at(ratio)
    }

    /// Start angle and sweep of the arc.
    pub fn angles(&self) -> ArcAngles {
        let [x, y] = self.from.map(Nm::to_mm);
        ArcAngles { start_rad: libm::atan2(y, x), turned_rad: f64::from(self.turn.sign()) * self.sweep_rad() }
    }
}

impl ArcAngles {
    /// Unit vector from the centre to the point of the arc at this fraction of the sweep (0 at the start, 1 at the
    /// end).
    pub fn direction_at(&self, ratio: f64) -> [f64; 2] {
        let (sin, cos) = libm::sincos(self.start_rad + ratio * self.turned_rad);
        [cos, sin]
    }

    /// Cosine and sine of the angle between neighbouring points if the sweep is divided into `steps` equal parts.
    pub fn step(&self, steps: usize) -> [f64; 2] {
        let (sin, cos) = libm::sincos(self.turned_rad / steps as f64);
        [cos, sin]
    }
}

fn pick(axes: &[Nm; 3], index: usize) -> Nm {
    axes.get(index).copied().unwrap_or_default()
}

fn add(a: [Nm; 2], b: [Nm; 2]) -> [Nm; 2] {
    let ([ax, ay], [bx, by]) = (a, b);
    [Nm(ax.0.saturating_add(bx.0)), Nm(ay.0.saturating_add(by.0))]
}

fn subtract(a: [Nm; 2], b: [Nm; 2]) -> [Nm; 2] {
    let ([ax, ay], [bx, by]) = (a, b);
    [Nm(ax.0.saturating_sub(bx.0)), Nm(ay.0.saturating_sub(by.0))]
}

/// Whether the lengths a and b of two vectors differ by [`RADIUS_TOLERANCE`] t at most. As (a + b)^2 >= a^2 + b^2, it
/// is sufficient that (a^2 - b^2)^2 <= t^2 (a^2 + b^2). This condition needs no root and holds for nearly every arc.
fn are_equally_long(a: [Nm; 2], b: [Nm; 2]) -> bool {
    let square = |vector: [Nm; 2]| {
        let [x, y] = vector.map(|Nm(nm)| nm as f64);
        x * x + y * y
    };
    let (a_squared, b_squared, tolerance) = (square(a), square(b), RADIUS_TOLERANCE.0 as f64);
    let difference = a_squared - b_squared;
    difference * difference <= tolerance * tolerance * (a_squared + b_squared)
        || libm::fabs(length_mm(a) - length_mm(b)) <= RADIUS_TOLERANCE.to_mm()
}

fn length_mm(vector: [Nm; 2]) -> f64 {
    let [x, y] = vector.map(Nm::to_mm);
    libm::hypot(x, y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{FRAC_PI_2, TAU};

    fn mm(values: [f64; 2]) -> [Nm; 2] {
        values.map(Nm::from_mm)
    }

    fn motion(turn: Turn, start: [f64; 2], end: [f64; 2], offset: [f64; 2]) -> Motion {
        let pose = |[x, y]: [Nm; 2]| Pose { linear: [x, y, Nm(0)], ..Pose::default() };
        let [i, j] = mm(offset);
        Motion {
            kind: MotionKind::Arc(turn),
            plane: Plane::Xy,
            start: pose(mm(start)),
            end: pose(mm(end)),
            center: Center::Offset([i, j, Nm(0)]),
            feed: Feed::Missing,
        }
    }

    fn arc(turn: Turn, start: [f64; 2], end: [f64; 2], offset: [f64; 2]) -> Result<Arc, Fault> {
        let segment = Segment::from_motion(&motion(turn, start, end, offset), None)?;
        Ok(*segment.arc().unwrap())
    }

    #[test]
    fn a_quarter_is_a_quarter_one_way_and_three_the_other() {
        let quarter = arc(Turn::Ccw, [10.0, 0.0], [0.0, 10.0], [-10.0, 0.0]).unwrap();
        assert!((quarter.sweep_rad() - FRAC_PI_2).abs() < 1e-15);
        assert!((quarter.length_mm() - 10.0 * FRAC_PI_2).abs() < 1e-12);
        let rest = arc(Turn::Cw, [10.0, 0.0], [0.0, 10.0], [-10.0, 0.0]).unwrap();
        assert!((rest.sweep_rad() - 3.0 * FRAC_PI_2).abs() < 1e-15);
    }

    #[test]
    fn an_arc_back_to_its_start_is_a_full_circle() {
        let circle = arc(Turn::Cw, [10.0, 0.0], [10.0, 0.0], [-10.0, 0.0]).unwrap();
        assert_eq!(circle.sweep_rad(), TAU);
    }

    #[test]
    fn halfway_along_a_clockwise_quarter_points_down_right() {
        let quarter = arc(Turn::Cw, [10.0, 0.0], [0.0, -10.0], [-10.0, 0.0]).unwrap();
        let [x, y] = quarter.direction_at(0.5);
        assert!((x - libm::sqrt(0.5)).abs() < 1e-15 && (y + libm::sqrt(0.5)).abs() < 1e-15);
    }

    #[test]
    fn end_points_off_the_circle_are_an_alarm() {
        let off = |end| arc(Turn::Ccw, [10.0, 0.0], [0.0, end], [-10.0, 0.0]);
        assert!(off(10.029).is_ok());
        assert_eq!(off(10.031), Err(Fault::alarm(Alarm::RadiusTolerance, 0)));
        assert_eq!(arc(Turn::Ccw, [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]), Err(Fault::alarm(Alarm::NoRadius, 0)));
    }

    #[test]
    fn helix_length_is_that_of_the_unrolled_cylinder_and_its_feed_length_that_in_the_plane() {
        let mut helix = motion(Turn::Ccw, [10.0, 0.0], [0.0, 10.0], [-10.0, 0.0]);
        helix.end.linear[2] = Nm::from_mm(-7.0);
        let segment = Segment::from_motion(&helix, None).unwrap();
        assert_eq!(segment.rise(), Nm::from_mm(-7.0));
        let arc_mm = 10.0 * FRAC_PI_2;
        assert!((segment.feed_length_mm() - arc_mm).abs() < 1e-12);
        assert!((segment.length_mm() - libm::sqrt(arc_mm * arc_mm + 49.0)).abs() < 1e-12);
    }

    #[test]
    fn a_shifted_arc_is_the_same_about_a_shifted_centre() {
        let mut segment =
            Segment::from_motion(&motion(Turn::Ccw, [10.0, 0.0], [0.0, 10.0], [-10.0, 0.0]), None).unwrap();
        let by = Pose { linear: [1.0, 2.0, 3.0].map(Nm::from_mm), ..Pose::ORIGIN };
        let shifted = segment.shifted(by);
        assert_eq!(shifted.end.linear, [1.0, 12.0, 3.0].map(Nm::from_mm));
        let (arc, moved) = (*segment.arc().unwrap(), *shifted.arc().unwrap());
        assert_eq!(moved, Arc { center: mm([1.0, 2.0]), ..arc });
        let Path::Arc(arc) = &mut segment.path else { unreachable!() };
        arc.plane = Plane::Zx;
        assert_eq!(segment.shifted(by).arc().unwrap().center, mm([3.0, 1.0]));
    }

    #[test]
    fn by_radius_an_arc_is_the_shorter_or_the_longer_way_round() {
        for (radius, turn, sweep) in [
            (10.0, Turn::Ccw, FRAC_PI_2),
            (-10.0, Turn::Ccw, 3.0 * FRAC_PI_2),
            (10.0, Turn::Cw, FRAC_PI_2),
            (-10.0, Turn::Cw, 3.0 * FRAC_PI_2),
        ] {
            let mut by_radius = motion(turn, [10.0, 0.0], [0.0, 10.0], [0.0; 2]);
            by_radius.center = Center::Radius(Nm::from_mm(radius));
            let arc = *Segment::from_motion(&by_radius, None).unwrap().arc().unwrap();
            assert!((arc.sweep_rad() - sweep).abs() < 1e-15 && arc.radius_mm() == 10.0, "R{radius} {turn:?}");
        }
    }

    #[test]
    fn what_is_no_arc_in_its_plane_is_refused() {
        let mut turning = motion(Turn::Ccw, [10.0, 0.0], [0.0, 10.0], [-10.0, 0.0]);
        turning.end.rotary[1].0 = 1;
        let fault = Segment::from_motion(&turning, None).unwrap_err();
        assert_eq!(fault, Fault::not_modelled(NotModelled::RotaryArc, 0));
        let mut straight = motion(Turn::Ccw, [10.0, 0.0], [10.0, 0.0], [0.0; 2]);
        straight.center = Center::Radius(Nm(1));
        straight.end.linear[2] = Nm(1);
        let fault = Segment::from_motion(&straight, None).unwrap_err();
        assert_eq!(fault, Fault::not_modelled(NotModelled::ArcWithoutAngle, 0));
    }

    #[test]
    fn the_short_way_to_compare_two_radii_never_accepts_what_the_roots_refuse() {
        let mut seed = 1_u64;
        let mut next = |below: i64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((seed >> 16) as i64).rem_euclid(below)
        };
        let mut equal = 0;
        for _ in 0..200_000 {
            let radius = 10_i64.pow(next(12) as u32 + 1) + next(1_000);
            let turned = next(1_000_000) as f64 * TAU / 1e6;
            let longer = (radius + next(90_000) - 45_000) as f64;
            let (a, b) =
                ([Nm(radius), Nm(0)], [libm::cos(turned), libm::sin(turned)].map(|part| Nm((part * longer) as i64)));
            let by_roots = libm::fabs(length_mm(a) - length_mm(b)) <= RADIUS_TOLERANCE.to_mm();
            assert_eq!(are_equally_long(a, b), by_roots, "{a:?} {b:?}");
            equal += u32::from(by_roots);
        }
        assert!((50_000..190_000).contains(&equal), "{equal}");
    }
}
