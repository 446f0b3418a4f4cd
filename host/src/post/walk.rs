//! An NC program on a five-axis machine: where all axes stand, move by move.
//!
//! Plain moves are the machine's own: the program's coordinates with their offsets, Z longer by the tool. Under G43.4 X, Y and Z are
//! the tip's, in a frame that the table carries, and the linear axes follow from the rotary ones. Both on a machine whose control
//! has its zero where the machine's file has it.

use arcfeed_shared::kinematics::follow::TipMove;
use arcfeed_shared::kinematics::forward::{Axes, Setup};
use arcfeed_shared::kinematics::machine::{Letter, Machine};
use arcfeed_shared::kinematics::vector::{Vector, difference, scaled, sum};
use arcfeed_shared::nc::modal::Pose;
use arcfeed_shared::segment::{Path, Segment};
use arcfeed_shared::units::{MicroDeg, Nm};

use crate::program::{MoveTrace, Program};

/// The least number of steps on a way that is bent.
const STEPS_MIN: f64 = 8.0;

/// One move.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// As the control makes it.
    pub made: MoveTrace,
    /// Whether it begins where the one before ended: not behind a change of offsets, nor at the program's start.
    pub goes_on: bool,
    /// Part and tool; of a plain move what Z is longer by.
    pub setup: Setup,
    /// The rotary axes at both ends.
    pub rotary_deg: [[f64; 2]; 2],
}

/// All moves of a program without errors; `setup` is what the control does not know of part and tool.
pub fn walk(program: &Program, machine: &Machine, setup: &Setup) -> Vec<Move> {
    let mut moves: Vec<Move> = Vec::new();
    for made in program.made() {
        let mut next = Move::new(made, machine, setup);
        next.goes_on = moves.last().is_some_and(|last| {
            let is_as_before = last.made.follows_tip == made.follows_tip && last.setup == next.setup;
            is_as_before && last.made.segment.end == made.segment.start
        });
        moves.push(next);
    }
    moves
}

impl Move {
    fn new(made: MoveTrace, machine: &Machine, around: &Setup) -> Self {
        let tool_length_mm = made.tool_length.to_mm();
        let setup = match made.follows_tip {
            true => Setup { tool_length_mm: tool_length_mm + around.tool_length_mm, ..*around },
            // The control knows where its axes are, whatever part and tool are.
            false => Setup { tool_length_mm, ..Setup::default() },
        };
        let rotary_deg = [made.segment.start, made.segment.end].map(|pose| rotary_deg(&pose, machine));
        Move { made, goes_on: false, setup, rotary_deg }
    }

    /// Whether it cuts.
    pub fn is_cut(&self) -> bool {
        self.made.segment.path != Path::Rapid
    }

    /// What the rotary axes turn.
    pub fn turned_deg(&self) -> [f64; 2] {
        let [from, to] = self.rotary_deg;
        [to[0] - from[0], to[1] - from[1]]
    }

    /// The rotary axes at a part of the way.
    pub fn rotary_at(&self, part: f64) -> [f64; 2] {
        let ([from, _], turned) = (self.rotary_deg, self.turned_deg());
        [from[0] + part * turned[0], from[1] + part * turned[1]]
    }

    /// The tip's move, if it is a straight one under G43.4.
    pub fn of_tip(&self) -> Option<TipMove> {
        let is_straight = self.made.follows_tip && self.made.segment.path == Path::Line;
        let tip_mm = [self.made.segment.start, self.made.segment.end].map(|pose| pose.linear.map(Nm::to_mm));
        is_straight.then_some(TipMove { tip_mm, rotary_deg: self.rotary_deg })
    }

    /// Where the axes stand: at both ends, and on a bent way a degree or less apart.
    pub fn places(&self, machine: &Machine) -> Vec<Axes> {
        let turned = self.turned_deg();
        let bend_deg = match &self.made.segment.path {
            Path::Arc(arc) => arc.sweep_rad().to_degrees(),
            Path::Rapid | Path::Line if self.made.follows_tip => libm::fabs(turned[0]).max(libm::fabs(turned[1])),
            Path::Rapid | Path::Line => 0.0,
        };
        let steps = if bend_deg > 0.0 { libm::ceil(bend_deg).max(STEPS_MIN) } else { 1.0 };
        let place = |step: u32| {
            let part = f64::from(step) / steps;
            let rotary_deg = self.rotary_at(part);
            let on_path = point_at(&self.made.segment, part);
            let linear_mm = match self.made.follows_tip {
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
