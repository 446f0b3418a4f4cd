//! Position of the tool on the workpiece ("part" below), from the machine coordinates of the axes.
//!
//! The workpiece is defined in the program's coordinates at its first cut: those of the work coordinate system in force
//! there, with the rotary axes at their positions there. With L the machine coordinates of the tip, T(q) the turn of the part
//! by the rotary positions q about its axes, q0 those of the first cut, p0 the origin there and t0 the tool's axis:
//!
//! ```text
//! tip  = T(q0)^-1 T(q) L - p0                (1)
//! axis = R(q0)^-1 R(q) t0                    (2)
//! ```
//!
//! This needs the machine's kinematics, and a machine whose rotary axes both carry the part. Without them a block that cuts at
//! other positions than q0 has no known position on the workpiece. Edges are evaluated there only for an indexed placement, because
//! the workpiece of a job may be a part of the whole. Under G43.4 the program gives the tip on the part, and
//! the kinematics give the axis. While rotary axes turn without G43.4 the position is unknown.
//!
//! Source: (1), (2) the chain of `arcfeed_kinematics::forward`.

use arcfeed_kinematics::forward::{Axes, Setup};
use arcfeed_kinematics::machine::{Carries, Letter, Machine};
use arcfeed_kinematics::vector::{Vector, cross, difference, length, turned, unit};
use arcfeed_units::{MicroDeg, Nm};

use arcfeed_control::action::{MoveContext, ProgrammedPath, WorkpiecePlace};
use arcfeed_dexel::frame::Frame;
use arcfeed_dexel::motion::{Move, MoveError, Pose};
use arcfeed_dexel::section::Sweep;
use arcfeed_dexel::tool::Tool;
use arcfeed_milling::cutting::edge_engagement::EdgeEngagement;

use super::trail::{AxisPosition, PathSection};

/// Difference of rotary axes that counts as none.
const SAME_DEG: f64 = 1e-4;

/// Tilt of the tool axis, rad, that counts as upright.
const UPRIGHT_RAD: f64 = 1e-6;

/// Distance from the workpiece within which the edges are evaluated.
const NEAR_MM: f64 = 1.0;

/// Tool axis without rotary axes, or for the part in its first position.
pub const UP: Vector = [0.0, 0.0, 1.0];

/// Reason why the material of a block is not removed, or its edges are not evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LeftOutReason {
    /// A rotary axis turns, and the path is not programmed relative to the workpiece (G43.4).
    Turning,
    /// The rotary axes are at other positions than for the first cut, and the kinematics of a machine whose rotary axes turn the
    /// workpiece are not known.
    OtherPosition,
    /// The path is programmed relative to the workpiece (G43.4), and the machine's kinematics are not known.
    NoMachine,
    /// The tool goes to or comes from a machine position (G28, G30, G53), and no work offset is given.
    MachinePosition,
    /// The path is the contour under G41 or G42, not the path of the tool's centre.
    Contour,
    /// The tool is tilted on the workpiece, and edges are evaluated for an upright tool only.
    Tilted,
    /// The tool's axis turns on the workpiece during the move; edges are evaluated for a fixed axis only.
    AxisTurns,
    /// The shape of the tool in the spindle is not given.
    OtherTool,
    /// The spindle turns counter-clockwise (M4); the edges are those of a tool for M3.
    Backwards,
}

/// Tip and axis of the tool on the part, by the position of the axes.
type PoseOnPart<'p> = Box<dyn Fn(&AxisPosition) -> Pose + 'p>;

/// Straight motion (chord) of the tool's tip on the workpiece, while the tool's axis keeps its direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolChord {
    /// Start and end of the tip's motion, in the workpiece's coordinates.
    pub ends_mm: [Vector; 2],
    /// Frame of the tool on the workpiece: z along its axis to the holder, x and y those of the machine.
    pub frame: Frame,
}

impl ToolChord {
    /// Whether the tool's axis on the workpiece differs from Z.
    pub fn is_tilted(&self) -> bool {
        self.frame != Frame::OWN
    }
}

/// Position of the workpiece on the machine; it becomes known at the first cut.
#[derive(Clone, Copy, Debug, Default)]
pub struct WorkpiecePlacement {
    origin_mm: Option<Vector>,
    rotary_deg: Option<Vector>,
    /// Whether edges are evaluated at other positions of the rotary axes than at the first cut.
    is_indexed: bool,
}

impl WorkpiecePlacement {
    /// Placement before the first cut; `is_indexed` if edges are evaluated at all positions of the rotary axes.
    pub fn new(is_indexed: bool) -> Self {
        WorkpiecePlacement { is_indexed, ..WorkpiecePlacement::default() }
    }

    /// Whether the position of the workpiece is known, because [`locate`](Self::locate) has seen the first cut.
    pub fn is_known(&self) -> bool {
        self.origin_mm.is_some()
    }

    /// Sets the workpiece's position from the first cut; what is already known does not change.
    pub fn locate(&mut self, cut: &PathSection) {
        self.locate_at(&cut.positions[0], &cut.context, cut.turn_deg() <= SAME_DEG);
    }

    /// Sets the workpiece's position from the axes' position at the first cut; `stands` says whether the rotary axes stand still.
    pub fn locate_at(&mut self, position: &AxisPosition, context: &MoveContext, stands: bool) {
        self.origin_mm.get_or_insert_with(|| origin_of(context));
        if context.programmed_path != ProgrammedPath::Tip && stands {
            self.rotary_deg.get_or_insert(rotary(position));
        }
    }

    /// Straight sweeps of the tool on the workpiece along a path section, in order.
    ///
    /// # Errors
    /// The tool's position on the workpiece is unknown.
    pub fn sweeps(
        &self,
        section: &PathSection,
        tool: &Tool,
        machine: Option<&Machine>,
        tolerance_mm: f64,
    ) -> Result<Vec<Sweep>, LeftOutReason> {
        let poses: Vec<Pose> = section.positions.iter().map(self.pose_on_part(section, machine)?).collect();
        let chords = poses.windows(2).map(|pair| Move::Straight { from: pair[0], to: pair[1] });
        let sweeps: Result<Vec<Vec<Sweep>>, MoveError> = chords.map(|chord| chord.sweeps(tool, tolerance_mm)).collect();
        sweeps.map(|sweeps| sweeps.concat()).map_err(|_| LeftOutReason::Turning)
    }

    /// Straight motion of the tip of a tool with a fixed axis on the workpiece, for a path section of one chord; `None` before the
    /// first cut has given the workpiece's position.
    ///
    /// # Errors
    /// The tool's position on the workpiece is unknown, or its axis turns on the part.
    pub fn tool_chord(
        &mut self,
        section: &PathSection,
        machine: Option<&Machine>,
    ) -> Option<Result<ToolChord, LeftOutReason>> {
        let [from, to] = section.positions[..] else { return None };
        if !section.block.is_rapid && from != to {
            self.locate(section);
        }
        self.is_known().then(|| self.fixed_chord(section, machine))
    }

    fn fixed_chord(&self, section: &PathSection, machine: Option<&Machine>) -> Result<ToolChord, LeftOutReason> {
        let pose = self.pose_on_part(section, machine)?;
        let is_by_axes = section.context.programmed_path == ProgrammedPath::Axes;
        if is_by_axes && !self.is_indexed && !self.is_at_first_cut(section) {
            return Err(LeftOutReason::OtherPosition);
        }
        let poses: Vec<Pose> = section.positions.iter().map(pose).collect();
        let ends_mm = [poses[0].tip_mm, poses[1].tip_mm];
        if poses.iter().all(|pose| !is_tilted(pose.axis)) {
            return Ok(ToolChord { ends_mm, frame: Frame::OWN });
        }
        let turns = length(difference(poses[1].axis, poses[0].axis)) > UPRIGHT_RAD;
        match machine {
            Some(machine) if !turns => {
                let position = &section.positions[0];
                let frame = if is_by_axes {
                    self.in_first_cut(machine, position)
                } else {
                    frame_at(machine, rotary_deg(machine, position, &section.context))
                };
                Ok(ToolChord { ends_mm, frame })
            }
            _ => Err(LeftOutReason::AxisTurns),
        }
    }

    /// Tip and axis of the tool on the workpiece at a position of the axes, in a move with this context. Before the first cut it is
    /// computed as if the workpiece were where it is then. `None` without rotary axes, or if the machine does not turn the workpiece.
    pub fn pose(&self, position: &AxisPosition, context: &MoveContext, machine: &Machine) -> Option<Pose> {
        let origin_mm = self.origin_mm.unwrap_or_else(|| origin_of(context));
        let tip_mm = difference([position[0], position[1], position[2]], origin_mm);
        match context.programmed_path {
            ProgrammedPath::Contour => None,
            ProgrammedPath::Tip => Some(Pose { tip_mm, axis: axis_at(machine, position, context) }),
            ProgrammedPath::Axes => turns_part(machine).then(|| self.indexed_pose(machine, position, origin_mm)),
        }
    }

    /// Tip and axis on the part at the points of a section.
    ///
    /// # Errors
    /// The tool's position on the workpiece is unknown.
    fn pose_on_part<'p>(
        &'p self,
        section: &'p PathSection,
        machine: Option<&'p Machine>,
    ) -> Result<PoseOnPart<'p>, LeftOutReason> {
        if section.context.place != WorkpiecePlace::Known {
            return Err(LeftOutReason::MachinePosition);
        }
        let origin_mm = self.origin_mm.unwrap_or_default();
        let tip_mm = move |position: &AxisPosition| difference([position[0], position[1], position[2]], origin_mm);
        match (section.context.programmed_path, machine) {
            (ProgrammedPath::Contour, _) => Err(LeftOutReason::Contour),
            (ProgrammedPath::Tip, None) => Err(LeftOutReason::NoMachine),
            (ProgrammedPath::Tip, Some(machine)) => Ok(Box::new(move |position| Pose {
                tip_mm: tip_mm(position),
                axis: axis_at(machine, position, &section.context),
            })),
            (ProgrammedPath::Axes, _) if section.turn_deg() > SAME_DEG => Err(LeftOutReason::Turning),
            (ProgrammedPath::Axes, _) if self.is_at_first_cut(section) => {
                Ok(Box::new(move |position| Pose { tip_mm: tip_mm(position), axis: UP }))
            }
            (ProgrammedPath::Axes, Some(machine)) if turns_part(machine) => {
                Ok(Box::new(move |position| self.indexed_pose(machine, position, origin_mm)))
            }
            (ProgrammedPath::Axes, _) => Err(LeftOutReason::OtherPosition),
        }
    }

    /// Tip and axis on the part at other positions of the rotary axes than at the first cut. (1), (2)
    fn indexed_pose(&self, machine: &Machine, position: &AxisPosition, origin_mm: Vector) -> Pose {
        let on_part = machine.forward(&machine_axes(machine, position), &Setup::default());
        let at_first_cut = machine.linear_for(on_part.tip_mm, self.first_deg(machine), &Setup::default());
        Pose { tip_mm: difference(at_first_cut, origin_mm), axis: self.turned_back(machine, on_part.axis) }
    }

    /// Frame of the tool on the part as it was at the first cut. (2)
    fn in_first_cut(&self, machine: &Machine, position: &AxisPosition) -> Frame {
        let now = frame_at(machine, machine_axes(machine, position).rotary_deg);
        Frame { axes: now.axes.map(|direction| self.turned_back(machine, direction)) }
    }

    /// Direction on the part, turned back to the position of the part at the first cut. (2)
    fn turned_back(&self, machine: &Machine, direction: Vector) -> Vector {
        let ([first, second], [first_deg, second_deg]) = (machine.rotary(), self.first_deg(machine));
        turned(turned(direction, first.direction, -first_deg), second.direction, -second_deg)
    }

    /// Positions of the machine's rotary axes at the first cut, in the order of its description.
    fn first_deg(&self, machine: &Machine) -> [f64; 2] {
        let first = self.rotary_deg.unwrap_or_default();
        machine.rotary().each_ref().map(|axis| first[letter_index(axis.letter)])
    }

    fn is_at_first_cut(&self, section: &PathSection) -> bool {
        let stands = rotary(&section.positions[0]);
        self.rotary_deg.is_none_or(|first| first.iter().zip(stands).all(|(a, b)| (a - b).abs() <= SAME_DEG))
    }
}

/// Point at a fraction of a chord.
pub(super) fn between(ends_mm: &[Vector; 2], part: f64) -> Vector {
    [0, 1, 2].map(|axis: usize| ends_mm[0][axis] + (ends_mm[1][axis] - ends_mm[0][axis]) * part)
}

/// Whether an edge may touch the workpiece with the tip at one of these places, in the frame of the layers.
pub(super) fn is_near(engagement: &EdgeEngagement, tips_mm: &[Vector]) -> bool {
    let reach_mm = engagement.cutter().reach_mm() + NEAR_MM;
    let is_beside = |tip_mm: &Vector, [lowest_mm, highest_mm]: [[f64; 2]; 2]| {
        (0..2).all(|axis| (lowest_mm[axis] - reach_mm..=highest_mm[axis] + reach_mm).contains(&tip_mm[axis]))
    };
    let extent_mm = engagement.layers().extent_mm();
    tips_mm.iter().any(|tip_mm| {
        extent_mm.is_some_and(|extent_mm| is_beside(tip_mm, extent_mm)) && engagement.is_in(tip_mm[2], NEAR_MM)
    })
}

/// Whether a tool axis is tilted.
fn is_tilted(axis: Vector) -> bool {
    axis[2] < 0.0 || libm::hypot(axis[0], axis[1]) > UPRIGHT_RAD
}

/// Origin of the program's coordinates for the tip.
fn origin_of(context: &MoveContext) -> Vector {
    let origin = context.origin.linear.map(Nm::to_mm);
    [origin[0], origin[1], origin[2] - Nm::to_mm(context.tool)]
}

/// Direction of the tool axis on the part.
fn axis_at(machine: &Machine, position: &AxisPosition, context: &MoveContext) -> Vector {
    machine.axis_at(rotary_deg(machine, position, context))
}

/// Frame of the tool on the part at these positions of the rotary axes.
fn frame_at(machine: &Machine, rotary_deg: [f64; 2]) -> Frame {
    let [first, second] = machine.rotary();
    // Square to the tool with all axes at zero: X of a machine whose tool stands along Z.
    let x = unit(cross([0.0, 1.0, 0.0], machine.tool())).unwrap_or([1.0, 0.0, 0.0]);
    let x = turned(turned(x, second.direction, rotary_deg[1]), first.direction, rotary_deg[0]);
    let z = machine.axis_at(rotary_deg);
    Frame { axes: [x, cross(z, x), z] }
}

/// Positions of the machine's rotary axes in the order of its description.
fn rotary_deg(machine: &Machine, position: &AxisPosition, context: &MoveContext) -> [f64; 2] {
    let origin_deg = context.origin.rotary.map(MicroDeg::to_deg);
    machine.rotary().each_ref().map(|axis| {
        let index = letter_index(axis.letter);
        position[3 + index] - origin_deg[index]
    })
}

/// Whether both rotary axes turn the part, under a tool along Z.
fn turns_part(machine: &Machine) -> bool {
    machine.tool() == UP && machine.rotary().iter().all(|axis| axis.carries == Carries::Part)
}

/// Machine coordinates of the tip, and positions of the machine's rotary axes.
fn machine_axes(machine: &Machine, position: &AxisPosition) -> Axes {
    Axes {
        linear_mm: [position[0], position[1], position[2]],
        rotary_deg: machine.rotary().each_ref().map(|axis| position[3 + letter_index(axis.letter)]),
    }
}

/// Place of an axis among A, B, C.
fn letter_index(letter: Letter) -> usize {
    match letter {
        Letter::A => 0,
        Letter::B => 1,
        Letter::C => 2,
    }
}

fn rotary(position: &AxisPosition) -> Vector {
    [position[3], position[4], position[5]]
}
