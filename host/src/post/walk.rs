//! An NC program on a five-axis machine: where all axes stand, move by move.
//!
//! Plain moves are the machine's own: the program's coordinates with their offsets, Z longer by the tool. Under G43.4 X, Y and Z are
//! the tip's, in a frame that the table carries, and the linear axes follow from the rotary ones. Both on a machine whose control
//! has its zero where the machine's file has it.

use arcfeed_shared::kinematics::follow::TipMove;
use arcfeed_shared::kinematics::forward::{Axes, Setup};
use arcfeed_shared::kinematics::machine::{Letter, Machine};
use arcfeed_shared::kinematics::vector::{Vector, difference, scaled, sum};
use arcfeed_shared::nc::modal::{Motion, Pose};
use arcfeed_shared::nc::series::Act;
use arcfeed_shared::segment::{Path, Segment};
use arcfeed_shared::units::{MicroDeg, Nm};

use crate::program::{Program, ProgramLine};

/// The least number of steps on a way that is bent.
const STEPS_MIN: f64 = 8.0;

/// One move.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// Its line, counted from 1.
    pub line: usize,
    /// On the path (see docs/dialect.md).
    pub segment: Segment,
    /// Whether G43.4 is in force.
    pub follows_tip: bool,
    /// Whether it begins where the one before ended: not behind a change of offsets, nor at the program's start.
    pub goes_on: bool,
    /// Part and tool; of a plain move what Z is longer by.
    pub setup: Setup,
    /// Where the axes stand: at both ends, and on a bent way a degree or less apart.
    pub places: Vec<Axes>,
}

/// All moves of a program without errors; `setup` is what the control does not know of part and tool.
pub fn walk(program: &Program, machine: &Machine, setup: &Setup) -> Vec<Move> {
    let mut moves: Vec<Move> = Vec::new();
    for (index, line) in program.lines.iter().enumerate() {
        for segment in segments(line) {
            let mut made = Move::new(index + 1, line, segment, setup);
            made.places = made.places_on(machine);
            made.goes_on = moves.last().is_some_and(|last| {
                last.segment.end == made.segment.start
                    && (last.follows_tip, last.setup) == (made.follows_tip, made.setup)
            });
            moves.push(made);
        }
    }
    moves
}

impl Move {
    fn new(line: usize, of: &ProgramLine, segment: Segment, around: &Setup) -> Self {
        let length_mm = of.tool_length.to_mm();
        let setup = match of.follows_tip {
            true => Setup { tool_length_mm: length_mm + around.tool_length_mm, ..*around },
            // The control knows where its axes are, whatever part and tool are.
            false => Setup { tool_length_mm: length_mm, ..Setup::default() },
        };
        Move { line, segment, follows_tip: of.follows_tip, goes_on: false, setup, places: Vec::new() }
    }

    /// Whether it cuts.
    pub fn is_cut(&self) -> bool {
        self.segment.path != Path::Rapid
    }

    /// What the rotary axes turn.
    pub fn turned_deg(&self) -> [f64; 2] {
        match (self.places.first(), self.places.last()) {
            (Some(from), Some(to)) => [to.rotary_deg[0] - from.rotary_deg[0], to.rotary_deg[1] - from.rotary_deg[1]],
            _ => [0.0; 2],
        }
    }

    /// The rotary axes at a part of the way.
    pub fn rotary_at(&self, part: f64) -> [f64; 2] {
        let from = self.places.first().map_or([0.0; 2], |place| place.rotary_deg);
        let turned = self.turned_deg();
        [from[0] + part * turned[0], from[1] + part * turned[1]]
    }

    /// The tip's move, if it is a straight one under G43.4.
    pub fn of_tip(&self) -> Option<TipMove> {
        let is_straight = self.follows_tip && self.segment.path == Path::Line;
        let tip_mm = [self.segment.start, self.segment.end].map(|pose| pose.linear.map(Nm::to_mm));
        is_straight.then(|| TipMove { tip_mm, rotary_deg: [self.rotary_at(0.0), self.rotary_at(1.0)] })
    }

    fn places_on(&self, machine: &Machine) -> Vec<Axes> {
        let [from, to] = [self.segment.start, self.segment.end].map(|pose| rotary_deg(&pose, machine));
        let turned = [to[0] - from[0], to[1] - from[1]];
        let bend_deg = match &self.segment.path {
            Path::Arc(arc) => arc.sweep_rad().to_degrees(),
            Path::Rapid | Path::Line if self.follows_tip => libm::fabs(turned[0]).max(libm::fabs(turned[1])),
            Path::Rapid | Path::Line => 0.0,
        };
        let steps = if bend_deg > 0.0 { libm::ceil(bend_deg).max(STEPS_MIN) } else { 1.0 };
        let place = |step: u32| {
            let part = f64::from(step) / steps;
            let rotary_deg = [from[0] + part * turned[0], from[1] + part * turned[1]];
            let on_path = point_at(&self.segment, part);
            let linear_mm = match self.follows_tip {
                true => machine.linear_for(on_path, rotary_deg, &self.setup),
                false => sum(on_path, [0.0, 0.0, self.setup.tool_length_mm]),
            };
            Axes { linear_mm, rotary_deg }
        };
        (0..=steps as u32).map(place).collect()
    }
}

/// Where a program has a machine's rotary axes.
pub fn rotary_deg(pose: &Pose, machine: &Machine) -> [f64; 2] {
    machine.rotary().each_ref().map(|axis| {
        let at = Letter::ALL.iter().zip(pose.rotary).find(|(letter, _)| **letter == axis.letter);
        at.map_or(0.0, |(_, MicroDeg(at))| MicroDeg(at).to_deg())
    })
}

/// The moves of a line, those of cycles and reference returns one by one.
fn segments(line: &ProgramLine) -> Vec<Segment> {
    let Some(meaning) = &line.meaning else { return Vec::new() };
    let sequence = meaning.parsed.block.sequence;
    let of_series = meaning.step.series.iter().flat_map(|series| series.acts()).filter_map(|act| match act {
        Act::Move(motion) => segment_of(&motion, sequence),
        Act::Dwell(_) | Act::Spindle(_) => None,
    });
    meaning.segment.into_iter().chain(of_series).collect()
}

fn segment_of(motion: &Motion, sequence: Option<i64>) -> Option<Segment> {
    Segment::from_motion(motion, sequence).ok()
}

/// A point of a segment's path.
fn point_at(segment: &Segment, part: f64) -> Vector {
    let [from, to] = [segment.start, segment.end].map(|pose| pose.linear.map(Nm::to_mm));
    let mut point = sum(from, scaled(difference(to, from), part));
    if let Path::Arc(arc) = &segment.path {
        let (first, second, _) = arc.plane.axes();
        let direction = arc.direction_at(part);
        for ((axis, center), along) in [first, second].into_iter().zip(arc.center).zip(direction) {
            if let Some(slot) = point.get_mut(axis) {
                *slot = center.to_mm() + arc.radius_mm() * along;
            }
        }
    }
    point
}
