//! A cut: where the tool is sent, what its edges find there, the forces of that, and how tool and workpiece give way.
//!
//! In each step the displacement and the forces are made to agree: the chips are asked of the material for a displacement, without
//! cutting, until nothing changes; then the edges go there and take what they sweep. The material keeps the marks, and
//! the next tooth meets them.
//!
//! Source: Lorong et al., Simulation of a finishing operation, 2012, section 1.3 and eqs 1 to 6, with modes in place of the full
//! system (section 1); the displacement is that of one place of the cut, the same for all edges.

use nalgebra::{Vector2, Vector3};

use crate::cutting::bite::{Bite, Stand};
use crate::cutting::force::Loads;
use crate::cutting::material::{ChipSection, Cutting};
use crate::dynamics::vibration::Vibration;

/// A chip on less than this part of a piece's height is a burr between two levels, and not what is told of as its thickness.
const NARROW_RATIO: f64 = 0.01;

/// A tool at work.
#[derive(Clone, Debug)]
pub struct Process {
    bite: Bite,
    cutting: Cutting,
    /// Of the tool against the workpiece.
    vibration: Vibration,
    chips_mm: Vec<f64>,
}

/// What happened in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// At its end, on the tool.
    pub loads: Loads,
    /// Of the tool against the workpiece, at its end.
    pub displacement_mm: Vector3<f64>,
    /// The thickest chip of any edge on the side at its end.
    pub thickest_mm: f64,
    /// The largest mean thickness of any edge's chip on the tool's end.
    pub end_mm: f64,
    /// Material taken, as the rays along each axis of the layers have it, mm3.
    pub removed_mm3: [f64; 2],
    /// Whether force and displacement came to agree.
    pub agrees: bool,
}

impl Process {
    /// A cutter in its workpiece, and what both do under forces; a rigid pair has no modes.
    pub fn new(bite: Bite, cutting: Cutting, vibration: Vibration) -> Self {
        let chips_mm = vec![0.0; bite.cutter().teeth()];
        Process { bite, cutting, vibration, chips_mm }
    }

    /// The cutter and the workpiece.
    pub fn bite(&self) -> &Bite {
        &self.bite
    }

    /// The cutter and the workpiece, to be moved without a cut.
    pub fn bite_mut(&mut self) -> &mut Bite {
        &mut self.bite
    }

    /// The thickest chip of each tooth's side at the end of the last step.
    pub fn chips_mm(&self) -> &[f64] {
        &self.chips_mm
    }

    /// The edges are out of the material, and the tool is at rest when they come again.
    pub fn lift(&mut self) {
        self.bite.lift();
        self.vibration.rest();
    }

    /// The modes.
    pub fn vibration(&self) -> &Vibration {
        &self.vibration
    }

    /// The modes, to see them from another place of the cut.
    pub fn vibration_mut(&mut self) -> &mut Vibration {
        &mut self.vibration
    }

    /// Goes to the next place, `dt_s` later, less than a quarter of a turn on.
    pub fn step(&mut self, dt_s: f64, stand: &Stand) -> Moment {
        let (bite, cutting, chips_mm) = (&self.bite, &self.cutting, &mut self.chips_mm);
        let (mut loads, mut end_mm) = (Loads::default(), 0.0);
        let step = self.vibration.step(dt_s, |displacement_mm| {
            (loads, end_mm) = loaded(bite, cutting, stand, (displacement_mm, chips_mm));
            loads.force_n
        });
        let thickest_mm = self.chips_mm.iter().copied().fold(0.0, f64::max);
        let bent = step.displacement_mm.xy();
        let removed_mm3 = self.bite.cut(stand, |_| bent);
        Moment { loads, displacement_mm: step.displacement_mm, thickest_mm, end_mm, removed_mm3, agrees: step.agrees }
    }
}

/// What the edges find where they are bent to: the loads, the largest mean chip of an edge on the end, and into the list the thickest of each tooth's side.
fn loaded(
    bite: &Bite,
    cutting: &Cutting,
    stand: &Stand,
    (displacement_mm, chips_mm): (&Vector3<f64>, &mut [f64]),
) -> (Loads, f64) {
    let bent: Vector2<f64> = displacement_mm.xy();
    let mut loads = Loads::default();
    // Parts of an end edge come one after the other.
    let mut ends: Vec<(usize, ChipSection)> = Vec::new();
    chips_mm.fill(0.0);
    for (piece, chip) in bite.chips(stand, |_| bent) {
        loads.add(&piece, stand.turned_rad, &cutting.force(&chip));
        if piece.is_end() {
            match ends.last_mut().filter(|(tooth, _)| *tooth == piece.tooth) {
                Some((_, edge)) => *edge = edge.with(&chip),
                None => ends.push((piece.tooth, chip)),
            }
        } else if let Some(thickest_mm) =
            chips_mm.get_mut(piece.tooth).filter(|_| chip.width_mm >= NARROW_RATIO * piece.width_mm())
        {
            *thickest_mm = thickest_mm.max(chip.thickness_mm);
        }
    }
    (loads, ends.iter().map(|(_, edge)| edge.thickness_mm).fold(0.0, f64::max))
}
