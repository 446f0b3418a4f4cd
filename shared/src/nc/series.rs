//! Blocks that make several moves: canned cycles (G73 to G89) and the way to a reference point (G28, G30).
//!
//! A cycle is a list of steps carried out at each hole, along the normal of its plane: I the initial level, R the level
//! where rapid turns to feed, Z the bottom. Lists as the manual draws them (B-63534EN, 13.1); G88 is not among them, for
//! there a person pulls the tool out.

use super::frame::Frame;
use super::motion::{Center, Feed, Motion, MotionKind, Plane, Pose};
use crate::units::{Micros, Nm};

/// One thing that such a block does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Act {
    /// A straight move, rapid or at feed.
    Move(Motion),
    /// A wait.
    Dwell(Micros),
    /// The spindle is stopped, stopped where it points, reversed, or turned on again.
    Spindle(Spindle),
}

/// What a cycle does to the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spindle {
    /// Stop.
    Stop,
    /// Stop at an angle.
    Orient,
    /// The other way round.
    Reverse,
    /// As before.
    Forward,
}

/// The moves of one block, as a recipe; [`Series::acts`] carries it out.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to box into")]
pub enum Series {
    /// G28, G30: from, by way of, to; on the path.
    Reference([Pose; 3]),
    /// A canned cycle.
    Drill(Drill),
}

/// A canned cycle at one or more holes. Points and levels are the program's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drill {
    /// The cycle: 73 for G73.
    pub code: u8,
    /// Its plane; it drills along the normal.
    pub plane: Plane,
    /// Where the program's coordinates lie.
    pub frame: Frame,
    /// Where the tool stands before.
    pub start: Pose,
    /// Above the first hole, at the level of the start.
    pub first: Pose,
    /// From hole to hole (G91).
    pub step: Pose,
    /// How many.
    pub holes: u32,
    /// I, R and Z.
    pub levels: Levels,
    /// G99.
    pub returns_to_r: bool,
    /// Q: depth of a cut, or the shift that frees a boring tool.
    pub q: Nm,
    /// What a pecking cycle goes back by (G73), or stops short by (G83).
    pub clearance: Nm,
    /// P.
    pub dwell: Micros,
    /// F.
    pub feed: Feed,
}

/// Coordinates along the normal of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Levels {
    /// Where the tool stood when the cycle was first called.
    pub initial: Nm,
    /// R.
    pub r: Nm,
    /// Z.
    pub bottom: Nm,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Op {
    Position,
    RapidR,
    FeedR,
    FeedBottom,
    Peck,
    Dwell,
    Spindle(Spindle),
    ShiftOut,
    ShiftBack,
    /// To the level that G98 or G99 names.
    Return,
    Initial,
}

/// The steps of a cycle at one hole.
const fn ops(code: u8) -> &'static [Op] {
    use Op::{Dwell, FeedBottom, FeedR, Initial, Peck, Position, RapidR, Return, ShiftBack, ShiftOut};
    const STOP: Op = Op::Spindle(Spindle::Stop);
    const ORIENT: Op = Op::Spindle(Spindle::Orient);
    const REVERSE: Op = Op::Spindle(Spindle::Reverse);
    const FORWARD: Op = Op::Spindle(Spindle::Forward);
    match code {
        73 | 83 => &[Position, RapidR, Peck, Return],
        74 | 84 => &[Position, RapidR, FeedBottom, Dwell, REVERSE, FeedR, Dwell, FORWARD, Return],
        76 => &[Position, RapidR, FeedBottom, Dwell, ORIENT, ShiftOut, Return, ShiftBack, FORWARD],
        81 => &[Position, RapidR, FeedBottom, Return],
        82 => &[Position, RapidR, FeedBottom, Dwell, Return],
        85 => &[Position, RapidR, FeedBottom, FeedR, Return],
        86 => &[Position, RapidR, FeedBottom, STOP, Return, FORWARD],
        87 => &[
            Position, ORIENT, ShiftOut, RapidR, ShiftBack, FORWARD, FeedBottom, Dwell, ORIENT, ShiftOut, Initial,
            ShiftBack, FORWARD,
        ],
        89 => &[Position, RapidR, FeedBottom, Dwell, FeedR, Return],
        _ => &[],
    }
}

impl Series {
    /// Everything the block does, in order; moves of no length are left out.
    pub fn acts(&self) -> Acts<'_> {
        Acts { series: self, cursor: self.begin() }
    }

    /// Before everything.
    pub fn begin(&self) -> Cursor {
        let (at, depth) = match self {
            Series::Reference([start, ..]) => (*start, Nm(0)),
            Series::Drill(drill) => (drill.start, drill.levels.r),
        };
        Cursor { at, hole: 0, op: 0, depth, is_down: false, stage: Stage::Positioning }
    }

    /// What comes next.
    pub fn advance(&self, cursor: &mut Cursor) -> Option<Act> {
        loop {
            let act = match self {
                Series::Reference(way) => cursor.reference(way),
                Series::Drill(drill) => cursor.drill(drill),
            }?;
            let is_idle = match act {
                Act::Move(motion) => motion.start == motion.end,
                Act::Dwell(span) => span == Micros(0),
                Act::Spindle(_) => false,
            };
            if !is_idle {
                return Some(act);
            }
        }
    }
}

impl Drill {
    /// Where the tool stands behind the last hole.
    pub fn end(&self) -> Pose {
        let level = if self.returns_to_r && self.code != 87 { self.levels.r } else { self.levels.initial };
        self.above(self.holes.saturating_sub(1), level)
    }

    fn normal(&self) -> usize {
        self.plane.axes().2
    }

    fn above(&self, hole: u32, level: Nm) -> Pose {
        let mut point = self.first;
        for (axis, Nm(step)) in point.linear.iter_mut().zip(self.step.linear) {
            axis.0 = axis.0.saturating_add(step.saturating_mul(i64::from(hole)));
        }
        for (axis, step) in point.rotary.iter_mut().zip(self.step.rotary) {
            axis.0 = axis.0.saturating_add(step.0.saturating_mul(i64::from(hole)));
        }
        at_level(point, self.normal(), level)
    }

    /// `by` further down than `level`, but not beyond the bottom.
    fn deeper(&self, level: Nm, by: Nm) -> Nm {
        let left = self.levels.bottom.0.saturating_sub(level.0);
        Nm(level.0.saturating_add(left.signum().saturating_mul(left.abs().min(by.0))))
    }

    fn shifted(&self, mut point: Pose, by: Nm) -> Pose {
        let (first, ..) = self.plane.axes();
        if let Some(axis) = point.linear.get_mut(first) {
            axis.0 = axis.0.saturating_add(by.0);
        }
        point
    }
}

fn at_level(mut point: Pose, normal: usize, level: Nm) -> Pose {
    if let Some(axis) = point.linear.get_mut(normal) {
        *axis = level;
    }
    point
}

/// See [`Series::acts`].
#[derive(Clone, Debug)]
pub struct Acts<'a> {
    series: &'a Series,
    cursor: Cursor,
}

/// How far a series is carried out.
#[derive(Clone, Debug, PartialEq)]
pub struct Cursor {
    at: Pose,
    hole: u32,
    op: usize,
    /// How far this hole is drilled.
    depth: Nm,
    /// Whether a pecking tool stands where its next cut begins.
    is_down: bool,
    stage: Stage,
}

/// Parts of a cycle, and of the way to a reference point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// To the hole; to the intermediate point.
    Positioning,
    /// To the level where rapid turns to feed.
    Approach,
    /// In the hole and out of it; from the intermediate point on.
    Work,
}

impl Cursor {
    /// The hole, from 0, and the stage of what was given last.
    pub fn stage(&self) -> (u32, Stage) {
        (self.hole, self.stage)
    }

    fn reference(&mut self, way: &[Pose; 3]) -> Option<Act> {
        let [start, between, end] = *way;
        self.op += 1;
        let (from, to, stage) = match self.op {
            1 => (start, between, Stage::Positioning),
            2 => (between, end, Stage::Work),
            _ => return None,
        };
        self.stage = stage;
        Some(Act::Move(straight(MotionKind::Rapid, Plane::Xy, [from, to], Feed::Missing)))
    }

    fn drill(&mut self, drill: &Drill) -> Option<Act> {
        while self.hole < drill.holes {
            let Some(op) = ops(drill.code).get(self.op) else {
                (self.hole, self.op, self.depth) = (self.hole + 1, 0, drill.levels.r);
                if ops(drill.code).is_empty() {
                    return None;
                }
                continue;
            };
            let approach = ops(drill.code).iter().position(|op| *op == Op::RapidR).unwrap_or(0);
            self.stage = match self.op {
                0 => Stage::Positioning,
                op if op <= approach => Stage::Approach,
                _ => Stage::Work,
            };
            if *op != Op::Peck {
                self.op += 1;
                return Some(self.perform(drill, *op));
            }
            match self.peck(drill) {
                Some(act) => return Some(act),
                None => self.op += 1,
            }
        }
        None
    }

    fn perform(&mut self, drill: &Drill, op: Op) -> Act {
        use MotionKind::{Line, Rapid};
        let Levels { initial, r, bottom } = drill.levels;
        let to = |level| at_level(self.at, drill.normal(), level);
        match op {
            Op::Position => {
                let level = self.at.linear.get(drill.normal()).copied().unwrap_or_default();
                self.go(drill, Rapid, drill.above(self.hole, level))
            }
            Op::RapidR => self.go(drill, Rapid, to(r)),
            Op::FeedR => self.go(drill, Line, to(r)),
            Op::FeedBottom | Op::Peck => self.go(drill, Line, to(bottom)),
            Op::Return => self.go(drill, Rapid, to(if drill.returns_to_r { r } else { initial })),
            Op::Initial => self.go(drill, Rapid, to(initial)),
            Op::ShiftOut => self.go(drill, Rapid, drill.shifted(self.at, drill.q)),
            Op::ShiftBack => self.go(drill, Rapid, drill.shifted(self.at, Nm(drill.q.0.saturating_neg()))),
            Op::Dwell => Act::Dwell(drill.dwell),
            Op::Spindle(what) => Act::Spindle(what),
        }
    }

    /// The next move of a pecking cycle at this hole; nothing once it is deep enough.
    fn peck(&mut self, drill: &Drill) -> Option<Act> {
        let Levels { r, bottom, .. } = drill.levels;
        let to = |level| at_level(self.at, drill.normal(), level);
        if self.depth == bottom {
            self.is_down = false;
            return None;
        }
        let is_first = self.depth == r;
        let stop_short = Nm(self.depth.0.saturating_sub((bottom.0 - r.0).signum().saturating_mul(drill.clearance.0)));
        let level = self.at.linear.get(drill.normal()).copied().unwrap_or_default();
        if is_first || self.is_down {
            self.is_down = false;
            self.depth = drill.deeper(self.depth, drill.q);
            return Some(self.go(drill, MotionKind::Line, to(self.depth)));
        }
        if drill.code == 83 && level != r {
            return Some(self.go(drill, MotionKind::Rapid, to(r)));
        }
        self.is_down = true;
        Some(self.go(drill, MotionKind::Rapid, to(stop_short)))
    }

    fn go(&mut self, drill: &Drill, kind: MotionKind, to: Pose) -> Act {
        let ends = [drill.frame.to_path(self.at), drill.frame.to_path(to)];
        self.at = to;
        Act::Move(straight(kind, drill.plane, ends, drill.feed))
    }
}

fn straight(kind: MotionKind, plane: Plane, [start, end]: [Pose; 2], feed: Feed) -> Motion {
    let feed = if kind == MotionKind::Rapid { Feed::Missing } else { feed };
    Motion { kind, plane, start, end, center: Center::Offset([Nm(0); 3]), feed }
}

impl Iterator for Acts<'_> {
    type Item = Act;

    fn next(&mut self) -> Option<Act> {
        self.series.advance(&mut self.cursor)
    }
}
