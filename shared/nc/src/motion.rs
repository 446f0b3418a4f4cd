//! Motions of a block: positions, planes, feeds, moves.

use arcfeed_units::{MicroDeg, Nm};

/// Units of [`Feed::InverseTime`] in a feed of 1/min.
pub const PER_MIN_SCALE: i64 = 1_000_000;

/// Kind of motion (G codes of group 01): rapid, line, arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionKind {
    /// G0.
    Rapid,
    /// G1.
    Line,
    /// G2, G3.
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

/// Sense of an arc, seen against the plane's normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// G2.
    Cw,
    /// G3.
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

/// Group 02: the plane of arcs, as indices of its first and second axis.
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
    /// G94.
    PerMinute,
    /// G93: F is the reciprocal of the block's duration in minutes.
    InverseTime,
    /// G95: F per revolution of the spindle.
    PerRevolution,
}

/// Group 07: side of the contour on which the tool runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompensationSide {
    /// G41.
    Left,
    /// G42.
    Right,
}

/// Position of the tool centre and the rotary axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pose {
    /// X, Y, Z.
    pub linear: [Nm; 3],
    /// A, B, C.
    pub rotary: [MicroDeg; 3],
}

/// A feed as programmed, exact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feed {
    /// Nanometres per minute.
    PerMinute(Nm),
    /// Blocks per minute in [`PER_MIN_SCALE`]ths.
    InverseTime(i64),
    /// The program has given no F.
    Missing,
}

/// A commanded motion; its geometry is not checked yet (see [`crate::segment`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Motion {
    /// Kind of motion.
    pub kind: MotionKind,
    /// The plane of an arc.
    pub plane: Plane,
    /// Start position.
    pub start: Pose,
    /// End position.
    pub end: Pose,
    /// Centre or radius of an arc.
    pub center: Center,
    /// Feed; [`Feed::Missing`] also for rapids.
    pub feed: Feed,
}

/// Specification of an arc's centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Center {
    /// I, J, K: relative to the start.
    Offset([Nm; 3]),
    /// R: the radius, negative for an arc of more than 180 degrees. It overrides I, J, K in the same block.
    Radius(Nm),
}

/// Corner inserted between a move and the next one (`,C`, `,R`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corner {
    /// A chamfer that begins and ends at this distance from the programmed corner.
    Chamfer(Nm),
    /// An arc of this radius that touches both moves.
    Rounding(Nm),
}

/// Stop commanded by the program, such as M00 or M30.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgramStop {
    /// M0: wait for the operator.
    Program,
    /// M1: wait if the switch is on.
    Optional,
    /// M2, M30.
    End,
}

impl Plane {
    /// Indices into [`Pose::linear`] of the first and second axis and of the normal.
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

    /// Adds or subtracts axis by axis.
    #[must_use]
    pub fn plus(self, other: Pose) -> Pose {
        self.zip(other, i64::saturating_add)
    }

    /// Adds or subtracts axis by axis.
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

    /// The axis of a letter (`A` to `C`, `X` to `Z`), nm or microdegrees; `None` for other letters.
    pub fn axis_mut(&mut self, letter: u8) -> Option<&mut i64> {
        match letter {
            b'X'..=b'Z' => self.linear.get_mut(usize::from(letter - b'X')).map(|axis| &mut axis.0),
            b'A'..=b'C' => self.rotary.get_mut(usize::from(letter - b'A')).map(|axis| &mut axis.0),
            _ => None,
        }
    }

    /// The axis of a letter, as in [`Pose::axis_mut`]; 0 for other letters.
    pub fn axis(&self, letter: u8) -> i64 {
        match letter {
            b'X'..=b'Z' => self.linear.get(usize::from(letter - b'X')).map_or(0, |axis| axis.0),
            b'A'..=b'C' => self.rotary.get(usize::from(letter - b'A')).map_or(0, |axis| axis.0),
            _ => 0,
        }
    }
}
