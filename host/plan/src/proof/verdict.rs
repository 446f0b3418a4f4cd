//! Collision proof of the path through one slot, with remaining and removed material.

use nalgebra::Rotation3;

use crate::cutter::{CupMill, ToolPart};
use crate::geometry::blisk::Blisk;
use crate::geometry::turning_height::highest_mm;
use crate::parallel;
use crate::path::{Pass, SlotPath};
use crate::vector::{Point, Vector};

use super::bodies;
use super::clearance::{Body, Clearance, Obstacle, clearance};
use super::earlier::{Earlier, EarlierFloor};
use super::floor::Floor;
use super::motion::Motion;
use super::remaining::{RemainingMaterial, Ring, SlotWalls, leaves};
use super::removal::{RemovedVolumes, Stock, removed};
use super::section::Section;
use super::spheres::Tree;

/// Path of a cup mill through a slot, with everything that its collision proof needs.
pub struct ProofCase<'c> {
    /// Finished part and its blank.
    pub blisk: &'c Blisk,
    /// Tool with its holder.
    pub tool: &'c CupMill,
    /// Path, in the slot frame (z along the tool's axis).
    pub path: &'c SlotPath,
    /// Rotation from the part frame to the slot frame.
    pub to_slot: Rotation3<f64>,
    /// Allowance on blades and hub.
    pub allowance_mm: f64,
    /// Fixtures: boxes that turn with the rotor, each by two opposite corners in the rotor's own frame.
    pub fixture: &'c [[Point; 2]],
    /// Passes of the same tool through the slot before this one.
    pub earlier: &'c [Pass],
}

/// Resolution of a collision proof: a finer one takes longer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProofResolution {
    /// Largest distance of the obstacles' triangles from the true surfaces.
    pub chord_mm: f64,
    /// Largest difference between the lower and the upper bound of a distance, in addition to that.
    pub gap_mm: f64,
    /// Numbers of rows and columns of the maps of remaining material.
    pub grid: [usize; 2],
    /// Cell size by which volumes are computed.
    pub cell_mm: f64,
}

/// Result of a proof: clearances, remaining material and removed volume of a path.
#[derive(Clone, Debug, PartialEq)]
pub struct Proof {
    /// Clearances of ring, body and holder from blades, hub, fixture and, except for the ring, the blank.
    pub clearances: Vec<Clearance>,
    /// Height of the lifted tool above all that turns while the part is indexed, mm; infinite if there is no path.
    pub indexing_mm: f64,
    /// Material that the ring leaves on both sides of the slot and on the hub, after this pass and all earlier ones.
    pub left: RemainingMaterial,
    /// Volumes that the ring removes from what earlier passes have left.
    pub removed: RemovedVolumes,
}

impl Default for ProofResolution {
    fn default() -> Self {
        ProofResolution { chord_mm: 0.01, gap_mm: 0.0005, grid: [13, 25], cell_mm: 0.5 }
    }
}

impl Proof {
    /// Clearances for which a collision is not excluded.
    pub fn open(&self) -> impl Iterator<Item = &Clearance> {
        self.clearances.iter().filter(|clearance| !clearance.is_free())
    }

    /// Whether there is no collision, the ring leaves the allowance within `tolerance_mm`, and the part can be
    /// indexed.
    pub fn holds(&self, allowance_mm: f64, tolerance_mm: f64) -> bool {
        let is_kept = |found: &Clearance| {
            found.part != ToolPart::Ring
                || found.obstacle == Obstacle::Fixture
                || found.beyond_mm(allowance_mm)[0] >= -tolerance_mm
        };
        self.open().next().is_none() && self.clearances.iter().all(is_kept) && self.indexing_mm > 0.0
    }

    /// Clearance by part and obstacle.
    pub fn clearance(&self, part: ToolPart, obstacle: Obstacle) -> Option<&Clearance> {
        self.clearances.iter().find(|found| found.part == part && found.obstacle == obstacle)
    }
}

/// Proves the path, or finds its faults. `None` if a blade is not above the hub.
pub fn prove(case: &ProofCase<'_>, fineness: &ProofResolution) -> Option<Proof> {
    let steps = case.path.steps();
    let motions: Vec<Motion> = steps.iter().map(Motion::new).collect();
    let sections = Section::of(case.tool, ToolPart::Ring);
    let earlier: Vec<Vec<Motion>> =
        case.earlier.iter().map(|pass| pass.path.steps().iter().map(Motion::new).collect()).collect();
    let ring = |motions| Ring { sections: &sections, motions, gap_mm: fineness.gap_mm };
    let turns = case.earlier.iter().map(|pass| pass.to_slot * case.to_slot.inverse());
    let rings = earlier.iter().map(|motions| ring(motions)).zip(turns);
    let rings: Vec<_> = rings.chain([(ring(&motions), Rotation3::identity())]).collect();
    let walls = SlotWalls::new(&case.blisk.slot(), &case.blisk.hub, case.allowance_mm, case.to_slot)?;
    let floors: Vec<EarlierFloor> = case.earlier.iter().map(|pass| EarlierFloor::new(case.tool, pass)).collect();
    let earlier = Earlier::new(&floors, *case.to_slot.inverse().matrix());
    let stock = Stock { blank: &case.blisk.blank, to_slot: case.to_slot, earlier };
    let floor = Floor::new(case.tool, &steps);
    let bodies = bodies(case, fineness.chord_mm);
    let parts = [ToolPart::Ring, ToolPart::Body, ToolPart::Holder];
    // The ring may cut the blank.
    let pairs = parts.into_iter().flat_map(|part| bodies.iter().map(move |body| (part, body)));
    let pairs = pairs.filter(|(part, body)| *part != ToolPart::Ring || body.obstacle != Obstacle::Blank);
    let pairs: Vec<(ToolPart, &Body)> = pairs.collect();
    let near = |(part, body): &(ToolPart, &Body)| clearance(case.tool, *part, &steps, body, fineness.gap_mm);
    let indexing_mm = case.path.clear_mm - highest_mm(&case.blisk.blank, case.fixture, &case.to_slot);
    let removed = || removed(&floor, case.path.levels.len(), &stock, &walls, fineness.cell_mm);
    let ((clearances, left), removed) = parallel::join(
        || parallel::join(|| parallel::map(&pairs, &near), || leaves(&rings, &walls, fineness.grid)),
        removed,
    );
    Some(Proof { clearances, indexing_mm, left, removed })
}

/// All obstacles of a case, as triangles within `chord_mm` of the surfaces.
pub fn bodies(case: &ProofCase<'_>, chord_mm: f64) -> Vec<Body> {
    let ProofCase { blisk, to_slot, .. } = case;
    let blade = |k: u32| to_slot * Rotation3::from_axis_angle(&Vector::z_axis(), f64::from(k) * blisk.pitch_rad());
    let here = vec![*to_slot];
    let body = |obstacle, triangles, turns, chord_mm| Body { obstacle, tree: Tree::new(triangles), turns, chord_mm };
    let fixture = case.fixture.iter().flat_map(bodies::cuboid).collect();
    vec![
        body(Obstacle::Blades, bodies::blades(blisk, chord_mm), (0..blisk.blades).map(blade).collect(), chord_mm),
        body(Obstacle::Hub, bodies::hub(blisk, chord_mm), here.clone(), chord_mm),
        body(Obstacle::Fixture, fixture, here.clone(), 0.0),
        body(Obstacle::Blank, bodies::blank(&blisk.blank, chord_mm), here, chord_mm),
    ]
}
