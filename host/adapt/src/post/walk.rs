//! NC program on a five-axis machine: positions of all axes, move by move.
//!
//! Plain moves are given in the machine's own axes: the program's coordinates with their offsets, and the tool length
//! added to Z. Under G43.4 X, Y and Z are those of the tip, in a frame that the table carries, and the linear axes
//! follow from the rotary ones. In both cases the control's zero is that of the machine file.

use arcfeed_kinematics::forward::{Axes, Setup};
use arcfeed_kinematics::machine::{Letter, Machine};
use arcfeed_kinematics::tip_feed::TipMove;
use arcfeed_kinematics::vector::{Vector, difference, scaled, sum};
use arcfeed_nc::modal::Pose;
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::{MicroDeg, Nm};

use crate::program::{MoveTrace, Program};

/// Least number of steps on a curved path.
const STEPS_MIN: f64 = 8.0;

/// Move of an NC program on a five-axis machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// Move as the control executes it.
    pub made: MoveTrace,
    /// The move begins where the one before ended: not after a change of offsets, nor at the program's start.
    pub is_continuous: bool,
    /// Placement of part and tool; for a plain move (without G43.4) with the tool length.
    pub setup: Setup,
    /// Positions of the rotary axes at the start and at the end, degrees.
    pub rotary_deg: [[f64; 2]; 2],
}

/// All moves of a program without errors. `setup` is the placement of part and tool on the machine, which the control
/// does not know.
pub fn walk(program: &Program, machine: &Machine, setup: &Setup) -> Vec<Move> {
    let mut moves: Vec<Move> = Vec::new();
    for made in program.executed_moves() {
        let mut next = Move::new(made, machine, setup);
        next.is_continuous = moves.last().is_some_and(|last| {
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
            // The control knows the positions of its axes, independently of part and tool.
            false => Setup { tool_length_mm, ..Setup::default() },
        };
        let rotary_deg = [made.segment.start, made.segment.end].map(|pose| rotary_deg(&pose, machine));
        Move { made, is_continuous: false, setup, rotary_deg }
    }

    /// Whether the move is a cutting move.
    pub fn is_cut(&self) -> bool {
        self.made.segment.path != Path::Rapid
    }

    /// Rotation of both rotary axes during the move, degrees.
    pub fn turned_deg(&self) -> [f64; 2] {
        let [from, to] = self.rotary_deg;
        [to[0] - from[0], to[1] - from[1]]
    }

    /// Positions of the rotary axes at the fraction `part` (0 to 1) of the path, degrees.
    pub fn rotary_at(&self, part: f64) -> [f64; 2] {
        let ([from, _], turned) = (self.rotary_deg, self.turned_deg());
        [from[0] + part * turned[0], from[1] + part * turned[1]]
    }

    /// The move as a straight move of the tip under G43.4; `None` for other moves.
    pub fn of_tip(&self) -> Option<TipMove> {
        let is_straight = self.made.follows_tip && self.made.segment.path == Path::Line;
        let tip_mm = [self.made.segment.start, self.made.segment.end].map(|pose| pose.linear.map(Nm::to_mm));
        is_straight.then_some(TipMove { tip_mm, rotary_deg: self.rotary_deg })
    }

    /// Positions of all axes along the move: at both ends, and on an arc also in between, at most one degree of the arc
    /// apart.
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

/// Positions of the machine's rotary axes in a position of the program, degrees.
pub fn rotary_deg(pose: &Pose, machine: &Machine) -> [f64; 2] {
    machine.rotary().each_ref().map(|axis| {
        let at = Letter::ALL.iter().zip(pose.rotary).find(|(letter, _)| **letter == axis.letter);
        at.map_or(0.0, |(_, MicroDeg(at))| MicroDeg(at).to_deg())
    })
}

/// Point of the segment's path at the fraction `part` (0 to 1), mm.
pub fn point_at(segment: &Segment, part: f64) -> Vector {
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
