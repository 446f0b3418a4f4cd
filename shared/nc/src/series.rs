//! Blocks that make several moves: canned cycles (G73 to G89) and the return to a reference point (G28, G30).
//!
//! A cycle is a list of operations at each hole along the normal of its plane. I is the initial level, R the level at
//! which rapid changes to feed, Z the bottom. The lists follow the manual (B-63534EN, 13.1). G88 is missing, because
//! in it the operator retracts the tool by hand.

use super::frame::{CoordinateFrame, CoordinateRotation};
use super::motion::{Center, Feed, Motion, MotionKind, Plane, Pose};
use arcfeed_units::{MicroDeg, Micros, Nm};

/// One action of a block that makes several moves, such as a canned cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SeriesAction {
    /// A straight move, rapid or at feed.
    Move(Motion),
    /// A dwell.
    Dwell(Micros),
    /// A change of the spindle's motion.
    Spindle(SpindleAction),
}

/// Change of the spindle's rotation in a canned cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpindleAction {
    /// The spindle stops.
    Stop,
    /// The spindle stops in its oriented position.
    Orient,
    /// The spindle turns backward.
    Reverse,
    /// The spindle turns forward.
    Forward,
}

/// Block that makes several moves, such as a canned cycle; [`Series::actions`] gives its single actions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to box into")]
pub enum Series {
    /// Return to a reference point (G28, G30): positions at the start, at the intermediate point and at the end, in
    /// path coordinates.
    Reference([Pose; 3]),
    /// A canned cycle (G73 to G89) at one or more holes.
    Drill(Drill),
}

/// A canned cycle at one or more holes. Points and levels are in program coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drill {
    /// G code of the cycle: 73 for G73.
    pub code: u8,
    /// Plane of the hole pattern; the cycle drills along its normal.
    pub plane: Plane,
    /// Transformation from program to path coordinates.
    pub frame: CoordinateFrame,
    /// Position of the tool before the cycle, in program coordinates.
    pub start: Pose,
    /// Position above the first hole, at the level of the tool before the cycle.
    pub first: Pose,
    /// Displacement from one hole to the next; zero except for repeated holes under G91.
    pub step: Pose,
    /// Circle on which the holes lie, for an angle that is repeated under G16 and G91; otherwise `None`.
    pub circle: Option<HoleCircle>,
    /// Number of holes.
    pub holes: u32,
    /// Initial level, level R and bottom of the holes.
    pub levels: Levels,
    /// Whether the tool returns to level R after each hole (G99) instead of the initial level (G98).
    pub returns_to_r: bool,
    /// Q word: depth of one peck, or the shift that clears a boring tool.
    pub q: Nm,
    /// G73: distance by which the tool retracts after each peck. G83: distance above the last depth at which rapid
    /// changes to feed.
    pub clearance: Nm,
    /// Dwell at the bottom of the hole (P word).
    pub dwell: Micros,
    /// Feed into the hole (F word).
    pub feed: Feed,
}

/// Holes at equal angles on a circle in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoleCircle {
    /// First hole.
    pub first: Polar,
    /// Angle from one hole to the next, positive counter-clockwise.
    pub step: MicroDeg,
}

/// A point of the plane in polar coordinates (G16).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Polar {
    /// Distance from the pole (origin of the polar coordinates).
    pub radius: Nm,
    /// Pole, in the axes of the plane: the program's origin, or the tool's position where a radius was last given
    /// under G91.
    pub pole: [Nm; 2],
    /// Angle from the plane's first axis, positive counter-clockwise.
    pub angle: MicroDeg,
}

impl Polar {
    /// Moves a position to this point, in the plane.
    #[inline(never)]
    pub(crate) fn place(&self, end: &mut Pose, plane: Plane) {
        let (first, second, _) = plane.axes();
        let [x, y] = self.pole;
        for (index, value) in [(first, x.0.saturating_add(self.radius.0)), (second, y.0)] {
            if let Some(axis) = end.linear.get_mut(index) {
                axis.0 = value;
            }
        }
        CoordinateRotation::new(plane, self.pole, self.angle).apply(&mut end.linear);
    }
}

/// Levels of a canned cycle: positions along the normal of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Levels {
    /// Initial level: that of the tool when the cycle was first called.
    pub initial: Nm,
    /// Level R, from which the tool moves at feed instead of rapid.
    pub r: Nm,
    /// Bottom of the hole (Z).
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
    Spindle(SpindleAction),
    ShiftOut,
    ShiftBack,
    /// Return to the level of G98 or G99.
    Return,
    Initial,
}

/// Operations of a cycle at one hole.
const fn ops(code: u8) -> &'static [Op] {
    use Op::{Dwell, FeedBottom, FeedR, Initial, Peck, Position, RapidR, Return, ShiftBack, ShiftOut};
    const STOP: Op = Op::Spindle(SpindleAction::Stop);
    const ORIENT: Op = Op::Spindle(SpindleAction::Orient);
    const REVERSE: Op = Op::Spindle(SpindleAction::Reverse);
    const FORWARD: Op = Op::Spindle(SpindleAction::Forward);
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
    /// All actions of the block in order; moves of zero length are left out.
    pub fn actions(&self) -> SeriesActions<'_> {
        SeriesActions { series: self, cursor: self.begin() }
    }

    /// Cursor before the first action, for [`Series::advance`].
    pub fn begin(&self) -> SeriesCursor {
        let (at, depth) = match self {
            Series::Reference([start, ..]) => (*start, Nm(0)),
            Series::Drill(drill) => (drill.start, drill.levels.r),
        };
        SeriesCursor { at, hole: 0, op: 0, depth, is_down: false, stage: Stage::Positioning }
    }

    /// The action after the cursor, which moves on; `None` after the last one.
    pub fn advance(&self, cursor: &mut SeriesCursor) -> Option<SeriesAction> {
        loop {
            let act = match self {
                Series::Reference(way) => cursor.reference(way),
                Series::Drill(drill) => cursor.drill(drill),
            }?;
            let is_idle = match act {
                SeriesAction::Move(motion) => motion.start == motion.end,
                SeriesAction::Dwell(span) => span == Micros(0),
                SeriesAction::Spindle(_) => false,
            };
            if !is_idle {
                return Some(act);
            }
        }
    }
}

impl Drill {
    /// Position of the tool after the last hole, in program coordinates.
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
        if let Some(HoleCircle { first, step }) = self.circle {
            let turned = step.0.saturating_mul(i64::from(hole));
            let angle = MicroDeg(first.angle.0.saturating_add(turned));
            Polar { angle, ..first }.place(&mut point, self.plane);
        }
        at_level(point, self.normal(), level)
    }

    /// The level that is `by` deeper than `level`, but not below the bottom.
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

/// Iterator of [`Series::actions`].
#[derive(Clone, Debug)]
pub struct SeriesActions<'a> {
    series: &'a Series,
    cursor: SeriesCursor,
}

/// Place in the sequence of actions of a block.
#[derive(Clone, Debug, PartialEq)]
pub struct SeriesCursor {
    at: Pose,
    hole: u32,
    op: usize,
    /// Level to which this hole is drilled.
    depth: Nm,
    /// Whether a pecking tool is at the start of its next cut.
    is_down: bool,
    stage: Stage,
}

/// Stage of a canned cycle, or of the return to a reference point, to which an action belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Rapid move to above the hole, or to the intermediate point.
    Positioning,
    /// Rapid move down to level R.
    Approach,
    /// Everything in the hole and out of it, or the move from the intermediate point to the reference point.
    Work,
}

impl SeriesCursor {
    /// Index of the hole, from 0, and the stage to which the last action belongs.
    pub fn stage(&self) -> (u32, Stage) {
        (self.hole, self.stage)
    }

    fn reference(&mut self, way: &[Pose; 3]) -> Option<SeriesAction> {
        let [start, between, end] = *way;
        self.op += 1;
        let (from, to, stage) = match self.op {
            1 => (start, between, Stage::Positioning),
            2 => (between, end, Stage::Work),
            _ => return None,
        };
        self.stage = stage;
        Some(SeriesAction::Move(straight(MotionKind::Rapid, Plane::Xy, [from, to], Feed::Missing)))
    }

    fn drill(&mut self, drill: &Drill) -> Option<SeriesAction> {
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

    fn perform(&mut self, drill: &Drill, op: Op) -> SeriesAction {
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
            Op::Dwell => SeriesAction::Dwell(drill.dwell),
            Op::Spindle(what) => SeriesAction::Spindle(what),
        }
    }

    /// The next move of a pecking cycle at this hole; `None` at full depth.
    fn peck(&mut self, drill: &Drill) -> Option<SeriesAction> {
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

    fn go(&mut self, drill: &Drill, kind: MotionKind, to: Pose) -> SeriesAction {
        let ends = [drill.frame.to_path(self.at), drill.frame.to_path(to)];
        self.at = to;
        SeriesAction::Move(straight(kind, drill.plane, ends, drill.feed))
    }
}

fn straight(kind: MotionKind, plane: Plane, [start, end]: [Pose; 2], feed: Feed) -> Motion {
    let feed = if kind == MotionKind::Rapid { Feed::Missing } else { feed };
    Motion { kind, plane, start, end, center: Center::Offset([Nm(0); 3]), feed }
}

impl Iterator for SeriesActions<'_> {
    type Item = SeriesAction;

    fn next(&mut self) -> Option<SeriesAction> {
        self.series.advance(&mut self.cursor)
    }
}
