//! Where the tool is to the workpiece.
//!
//! The workpiece is told in the coordinates of the program, as they are for its first cut: of the work coordinate system in
//! force there, and with the rotary axes where they stand. So a block that cuts with the rotary axes elsewhere, or
//! while they turn, is on no known part of it, unless the tool's tip is told on the part (G43.4) and the machine's
//! kinematics say where the tool points.

use arcfeed_shared::kinematics::machine::{Letter, Machine};
use arcfeed_shared::kinematics::vector::Vector;
use arcfeed_shared::units::{MicroDeg, Nm};

use crate::control::action::Way;
use crate::stock::motion::{Move, MoveError, Pose};
use crate::stock::section::Sweep;
use crate::stock::tool::Tool;

use super::trail::{Place, Stretch};

/// Rotary axes nearer than this are where they were.
const SAME_DEG: f64 = 1e-4;

/// A tool axis that leans by less than this, rad, stands upright.
const UPRIGHT_RAD: f64 = 1e-6;

/// Without rotary axes, or for the part as it lies.
const UP: Vector = [0.0, 0.0, 1.0];

/// Why a block takes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Unplaced {
    /// A rotary axis turns, and the way is not told on the part.
    Turning,
    /// The rotary axes stand elsewhere than for the first cut.
    OtherPosition,
    /// The way is told on the part, and no machine is named.
    NoMachine,
    /// The way is the part's contour: G41, G42.
    Contour,
    /// The tool leans on the part, and edges are asked for chips only where it stands upright.
    Tilted,
    /// The spindle turns counter-clockwise (M4), and edges are those of a tool for M3.
    Backwards,
}

/// The workpiece's place.
#[derive(Clone, Copy, Debug, Default)]
pub struct Placing {
    origin_mm: Option<Vector>,
    rotary_deg: Option<Vector>,
}

impl Placing {
    /// Whether it is known where the workpiece is.
    pub fn is_known(&self) -> bool {
        self.origin_mm.is_some()
    }

    /// Takes a cut: the first one tells where the workpiece is.
    pub fn learn(&mut self, cut: &Stretch) {
        let context = &cut.context;
        let origin = context.origin.linear.map(Nm::to_mm);
        self.origin_mm.get_or_insert([origin[0], origin[1], origin[2] - Nm::to_mm(context.tool)]);
        if context.way != Way::Tip && cut.turn_deg() <= SAME_DEG {
            self.rotary_deg.get_or_insert(rotary(&cut.places[0]));
        }
    }

    /// The sweeps of a stretch, in order.
    ///
    /// # Errors
    /// It is not known where the tool is to the workpiece.
    pub fn sweeps(
        &self,
        stretch: &Stretch,
        tool: &Tool,
        machine: Option<&Machine>,
        tolerance_mm: f64,
    ) -> Result<Vec<Sweep>, Unplaced> {
        let poses = self.poses(stretch, machine)?;
        let chords = poses.windows(2).map(|pair| Move::Straight { from: pair[0], to: pair[1] });
        let sweeps: Result<Vec<Vec<Sweep>>, MoveError> = chords.map(|chord| chord.sweeps(tool, tolerance_mm)).collect();
        sweeps.map(|sweeps| sweeps.concat()).map_err(|_| Unplaced::Turning)
    }

    /// Where the tip of an upright tool goes on the part in a stretch of one chord; nothing as long as no cut has told where the part
    /// is.
    ///
    /// # Errors
    /// It is not known where the tool is to the workpiece, or it leans.
    pub fn chord_mm(&mut self, stretch: &Stretch, machine: Option<&Machine>) -> Option<Result<[Vector; 2], Unplaced>> {
        let [from, to] = stretch.places[..] else { return None };
        if !stretch.of.is_rapid && from != to {
            self.learn(stretch);
        }
        let ends_mm = |places: Vec<Vector>| [places[0], places[1]];
        self.is_known().then(|| self.upright_mm(stretch, machine).map(ends_mm))
    }

    fn upright_mm(&self, stretch: &Stretch, machine: Option<&Machine>) -> Result<Vec<Vector>, Unplaced> {
        let poses = self.poses(stretch, machine)?;
        let leans = |pose: &Pose| pose.axis[2] < 0.0 || libm::hypot(pose.axis[0], pose.axis[1]) > UPRIGHT_RAD;
        if poses.iter().any(leans) { Err(Unplaced::Tilted) } else { Ok(poses.iter().map(|pose| pose.tip_mm).collect()) }
    }

    /// Tip and axis on the part, place by place.
    fn poses(&self, stretch: &Stretch, machine: Option<&Machine>) -> Result<Vec<Pose>, Unplaced> {
        let axis: Box<dyn Fn(&Place) -> Vector + '_> = match (stretch.context.way, machine) {
            (Way::Contour, _) => return Err(Unplaced::Contour),
            (Way::Tip, None) => return Err(Unplaced::NoMachine),
            (Way::Tip, Some(machine)) => Box::new(move |place| axis_at(machine, place, stretch)),
            (Way::Axes, _) if stretch.turn_deg() > SAME_DEG => return Err(Unplaced::Turning),
            (Way::Axes, _) if !self.is_at_first_cut(stretch) => return Err(Unplaced::OtherPosition),
            (Way::Axes, _) => Box::new(|_| UP),
        };
        let origin_mm = self.origin_mm.unwrap_or_default();
        let tip_mm = |place: &Place| [0, 1, 2].map(|along: usize| place[along] - origin_mm[along]);
        Ok(stretch.places.iter().map(|place| Pose { tip_mm: tip_mm(place), axis: axis(place) }).collect())
    }

    fn is_at_first_cut(&self, stretch: &Stretch) -> bool {
        let stands = rotary(&stretch.places[0]);
        self.rotary_deg.is_none_or(|first| first.iter().zip(stands).all(|(a, b)| (a - b).abs() <= SAME_DEG))
    }
}

/// A part of the way from one place to another.
pub(super) fn between(ends_mm: &[Vector; 2], part: f64) -> Vector {
    [0, 1, 2].map(|axis: usize| ends_mm[0][axis] + (ends_mm[1][axis] - ends_mm[0][axis]) * part)
}

/// The tool axis on the part.
fn axis_at(machine: &Machine, place: &Place, stretch: &Stretch) -> Vector {
    let origin_deg = stretch.context.origin.rotary.map(MicroDeg::to_deg);
    let rotary_deg = machine.rotary().each_ref().map(|axis| {
        let index = Letter::ALL.iter().position(|letter| *letter == axis.letter).unwrap_or(0);
        place[3 + index] - origin_deg[index]
    });
    machine.axis_at(rotary_deg)
}

fn rotary(place: &Place) -> Vector {
    [place[3], place[4], place[5]]
}
