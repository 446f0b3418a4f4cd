//! Motions of a block: positions, planes, feeds, moves.

use arcfeed_units::{MicroDeg, Nm};

/// Number of units of [`Feed::InverseTime`] in one block per minute.
pub const PER_MIN_SCALE: i64 = 1_000_000;

/// Kind of motion (G codes of group 01): rapid, straight at feed, or arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionKind {
    /// Rapid traverse (G0).
    Rapid,
    /// Straight move at feed (G1).
    Line,
    /// Arc at feed (G2, G3).
    Arc(Turn),
}

impl MotionKind {
    /// Kind of motion of a modal G code of group 1; `None` without a code, or for one of another group.
    #[inline]
    pub const fn of_code(code: Option<i64>) -> Option<Self> {
        match code {
            Some(0) => Some(MotionKind::Rapid),
            Some(1) => Some(MotionKind::Line),
            Some(2) => Some(MotionKind::Arc(Turn::Cw)),
            Some(3) => Some(MotionKind::Arc(Turn::Ccw)),
            _ => None,
        }
    }
}

/// Sense of an arc, seen against the normal of its plane, that is from the positive end of the third axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// Clockwise (G2).
    Cw,
    /// Counter-clockwise (G3).
    Ccw,
}

impl Turn {
    /// +1 for counter-clockwise, -1 for clockwise.
    pub const fn sign(self) -> i8 {
        match self {
            Turn::Cw => -1,
            Turn::Ccw => 1,
        }
    }
}

/// Plane in which arcs run (G codes of group 02), named by its first and second axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// G17.
    Xy,
    /// G18.
    Zx,
    /// G19.
    Yz,
}

/// Meaning of F (G codes of group 05): per minute, per revolution or inverse time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeedMode {
    /// F is a feed per minute (G94).
    PerMinute,
    /// F is the reciprocal of the block's duration in minutes (G93).
    InverseTime,
    /// F is a feed per revolution of the spindle (G95).
    PerRevolution,
}

/// Side of the contour on which cutter compensation puts the tool, seen in the direction of motion (G codes of group
/// 07).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompensationSide {
    /// Left (G41).
    Left,
    /// Right (G42).
    Right,
}

/// Position of the tool centre and of the rotary axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pose {
    /// X, Y, Z.
    pub linear: [Nm; 3],
    /// A, B, C.
    pub rotary: [MicroDeg; 3],
}

/// A programmed feed, as an exact whole number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feed {
    /// Nanometres per minute along the path.
    PerMinute(Nm),
    /// Reciprocal of the block's duration, in millionths of a block per minute (G93).
    InverseTime(i64),
    /// The program has given no F, or the move is a rapid.
    Missing,
}

/// A move that a block commands; whether its geometry is possible is not checked yet (see [`crate::segment`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Motion {
    /// Rapid, straight or arc.
    pub kind: MotionKind,
    /// Plane of an arc; without meaning for other moves.
    pub plane: Plane,
    /// Start position.
    pub start: Pose,
    /// End position.
    pub end: Pose,
    /// Centre or radius of an arc; without meaning for other moves.
    pub center: Center,
    /// Programmed feed; [`Feed::Missing`] for rapids.
    pub feed: Feed,
}

/// The way in which a block gives an arc's centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Center {
    /// I, J, K: the centre relative to the start, in X, Y, Z.
    Offset([Nm; 3]),
    /// R: the radius, negative for an arc of more than 180 degrees. It overrides I, J, K in the same block.
    Radius(Nm),
}

/// Chamfer or rounded corner inserted between a move and the next one (`,C`, `,R`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corner {
    /// A chamfer that begins and ends at this distance from the programmed corner.
    Chamfer(Nm),
    /// An arc of this radius that touches both moves.
    Rounding(Nm),
}

/// Stop or end that a block of the program commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgramStop {
    /// M0: the control waits for the operator.
    Program,
    /// M1: the control waits for the operator if the switch for optional stops is on.
    Optional,
    /// M2 or M30: end of the program.
    End,
}

impl Plane {
    /// Indices into [`Pose::linear`] of the plane's first axis, its second axis, and its normal.
    pub const fn axes(self) -> (usize, usize, usize) {
        match self {
            Plane::Xy => (0, 1, 2),
            Plane::Zx => (2, 0, 1),
            Plane::Yz => (1, 2, 0),
        }
    }
}

impl Pose {
    /// All axes at zero.
    pub const ORIGIN: Pose = Pose { linear: [Nm(0); 3], rotary: [MicroDeg(0); 3] };

    /// Sum of both positions, axis by axis.
    #[must_use]
    pub fn plus(self, other: Pose) -> Pose {
        self.zip(other, i64::saturating_add)
    }

    /// Difference of both positions, axis by axis.
    #[must_use]
    pub fn minus(self, other: Pose) -> Pose {
        self.zip(other, i64::saturating_sub)
    }

    fn zip(mut self, other: Pose, join: fn(i64, i64) -> i64) -> Pose {
        for (axis, Nm(by)) in self.linear.iter_mut().zip(other.linear) {
            axis.0 = join(axis.0, by);
        }
        for (axis, MicroDeg(by)) in self.rotary.iter_mut().zip(other.rotary) {
            axis.0 = join(axis.0, by);
        }
        self
    }

    /// Coordinate of the axis with this letter, nm (`X` to `Z`) or microdegrees (`A` to `C`); `None` for other
    /// letters.
    pub fn axis_mut(&mut self, letter: u8) -> Option<&mut i64> {
        match letter {
            b'X'..=b'Z' => self.linear.get_mut(usize::from(letter - b'X')).map(|axis| &mut axis.0),
            b'A'..=b'C' => self.rotary.get_mut(usize::from(letter - b'A')).map(|axis| &mut axis.0),
            _ => None,
        }
    }

    /// Coordinate of the axis with this letter, nm or microdegrees; 0 for letters other than `A` to `C` and `X` to
    /// `Z`.
    pub fn axis(&self, letter: u8) -> i64 {
        match letter {
            b'X'..=b'Z' => self.linear.get(usize::from(letter - b'X')).map_or(0, |axis| axis.0),
            b'A'..=b'C' => self.rotary.get(usize::from(letter - b'A')).map_or(0, |axis| axis.0),
            _ => 0,
        }
    }
}
