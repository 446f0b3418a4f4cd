//! Cutting process: tool position, engagement of the edges, cutting forces, and displacement of tool and workpiece.
//!
//! Each step iterates displacement and forces until they agree: it evaluates the chips in the material for a
//! displacement, without cutting, until nothing changes; then the edges move there and remove the swept material. The
//! material keeps the marks, and the next tooth meets them.
//!
//! The material is stored in the coordinates of the unbent workpiece. An edge at x, in a workpiece that is bent by u,
//! meets the material point
//!
//! ```text
//! X = Phi^-1(x + u_T) = x + u_T - u_W(X)      (1)
//! ```
//!
//! and its force acts on the workpiece's modes there. u_W is evaluated at the edge's point at the end of the last step,
//! moved by the tool's path: the error is the strain times the change of displacement in a step.
//!
//! Source: Lorong et al., Simulation of a finishing operation, 2012, sections 1.3 and 3.1 and eqs 1 to 8, with modes in place of the full system (section 1).

use nalgebra::{Vector2, Vector3};

use crate::cutting::edge_engagement::{EdgeChip, EdgeEngagement};
use crate::cutting::edges::EdgePiece;
use crate::cutting::force::Loads;
use crate::cutting::material::{ChipSection, Cutting, EdgeForce};
use crate::cutting::pose::{EdgePoses, ToolPose};
use arcfeed_modal::dynamics::vibration::{Places, Vibration, VibrationStep};
use arcfeed_modal::flexible::{Modal, Workpiece};

/// Fraction of a piece's height: a chip on less is a burr between two levels and does not count for the thickness.
const NARROW_RATIO: f64 = 0.01;

/// Upper bound of the change of a displacement in a step.
const MARGIN_MM: f64 = 0.1;

/// Milling process: computes chips, cutting forces and vibration of a cutter in its workpiece, step by step.
#[derive(Clone, Debug)]
pub struct Process {
    engagement: EdgeEngagement,
    cutting: Cutting,
    /// Vibration of the tool relative to the workpiece.
    vibration: Vibration,
    chips_mm: Vec<f64>,
    edge_displacements: EdgeDisplacements,
}

/// Displacements of the edges, each with its own. Keeps its state between calls.
#[derive(Clone, Debug, Default)]
struct EdgeDisplacements {
    places: Places,
    /// For each edge, the index of its point. An edge without its own point has that of the cut.
    place_of: Vec<usize>,
    /// For each edge, its displacement at the end of the last step.
    bent_mm: Vec<Vector3<f64>>,
}

/// Result of one time step of the process: chips, loads, and displacement at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessStep {
    /// Force and torque on the tool at the end of the step.
    pub loads: Loads,
    /// Displacement of the tool relative to the workpiece at the end of the step, by their vibration.
    pub displacement_mm: Vector3<f64>,
    /// Thickest chip of all edges on the tool's side at the end of the step.
    pub thickest_mm: f64,
    /// Largest mean chip thickness of all edges on the tool's end, at the end of the step.
    pub end_mm: f64,
    /// Removed volume as the rays along each axis of the layers measure it, mm3.
    pub removed_mm3: [f64; 2],
    /// Whether the iteration of force and displacement converged in this step.
    pub has_converged: bool,
}

/// Edges at one time, with the force model.
struct Edges<'a> {
    engagement: &'a mut EdgeEngagement,
    cutting: &'a Cutting,
    pose: &'a ToolPose,
    at: &'a EdgePoses,
}

impl Process {
    /// Process of a cutter in its workpiece; `vibration` has the modes of both, or none for a rigid pair.
    pub fn new(engagement: EdgeEngagement, cutting: Cutting, vibration: Vibration) -> Self {
        let chips_mm = vec![0.0; engagement.cutter().teeth()];
        Process { engagement, cutting, vibration, chips_mm, edge_displacements: EdgeDisplacements::default() }
    }

    /// Cutter and workpiece, to be read.
    pub fn engagement(&self) -> &EdgeEngagement {
        &self.engagement
    }

    /// Cutter and workpiece, to move them without a cut.
    pub fn engagement_mut(&mut self) -> &mut EdgeEngagement {
        &mut self.engagement
    }

    /// Thickest chip, mm, of each tooth on the tool's side, at the end of the last step.
    pub fn chips_mm(&self) -> &[f64] {
        &self.chips_mm
    }

    /// Takes the edges out of the material and stops the vibration.
    pub fn lift(&mut self) {
        self.engagement.lift();
        self.vibration.rest();
        self.edge_displacements.bent_mm.clear();
    }

    /// Vibration of tool and workpiece.
    pub fn vibration(&self) -> &Vibration {
        &self.vibration
    }

    /// Upper bound of the cutting force, N: all edges cut a chip of this thickness over their whole width, and all their forces have
    /// the same direction.
    pub fn force_max_n(&self, thickness_mm: f64) -> f64 {
        let width_mm = self.engagement.cutter().pieces().iter().map(EdgePiece::width_mm).sum();
        let EdgeForce { tangential_n, radial_n, axial_n } = self.cutting.force(&ChipSection { thickness_mm, width_mm });
        Vector3::new(tangential_n, radial_n, axial_n).norm()
    }

    /// Vibration of tool and workpiece, to set mode shapes for another position of the cut.
    pub fn vibration_mut(&mut self) -> &mut Vibration {
        &mut self.vibration
    }

    /// Moves the tool to its next pose within `dt_s` seconds, less than a quarter of a turn on, and cuts. All edges have the same
    /// displacement: that at the place of the cut.
    pub fn step(&mut self, dt_s: f64, pose: &ToolPose) -> ProcessStep {
        let at = self.engagement.poses(pose);
        let mut edges = Edges { engagement: &mut self.engagement, cutting: &self.cutting, pose, at: &at };
        let (chips_mm, mut found) = (&mut self.chips_mm, Default::default());
        let step = self.vibration.step(dt_s, |displacement_mm| {
            let bent: Vector2<f64> = displacement_mm.xy();
            found = edges.evaluate(|_| bent, chips_mm, |_, _| ());
            found.0.force_n
        });
        let bent = step.displacement_mm.xy();
        let removed_mm3 = self.engagement.cut(&at, |_| bent);
        self.moment(&step, found, removed_mm3)
    }

    /// Moves the tool as [`Process::step`], but on a flexible workpiece: each edge that may have a chip has the workpiece's
    /// displacement at the edge's own position. The workpiece's modes must come first among the modes of the vibration.
    pub fn step_on<B: Modal>(&mut self, dt_s: f64, pose: &ToolPose, workpiece: &mut Workpiece<B>) -> ProcessStep {
        let mut at = self.engagement.poses(pose);
        self.edge_displacements.update(&self.engagement, &mut at, &self.vibration, workpiece);
        let mut edges = Edges { engagement: &mut self.engagement, cutting: &self.cutting, pose, at: &at };
        let (place_of, chips_mm, mut found) =
            (&self.edge_displacements.place_of, &mut self.chips_mm, Default::default());
        let step = self.vibration.step_at(dt_s, &mut self.edge_displacements.places, |moved_mm, forces_n| {
            let bent = |edge: usize| moved_mm[place_of[edge]].xy();
            found = edges.evaluate(bent, chips_mm, |edge, force_n| forces_n[place_of[edge]] += force_n);
        });
        self.edge_displacements.store();
        let bent_mm = &self.edge_displacements.bent_mm;
        let removed_mm3 = self.engagement.cut(&at, |edge| bent_mm[edge].xy());
        self.moment(&step, found, removed_mm3)
    }

    fn moment(&self, step: &VibrationStep, (loads, end_mm): (Loads, f64), removed_mm3: [f64; 2]) -> ProcessStep {
        let thickest_mm = self.chips_mm.iter().copied().fold(0.0, f64::max);
        let (displacement_mm, has_converged) = (step.displacement_mm, step.has_converged);
        ProcessStep { loads, displacement_mm, thickest_mm, end_mm, removed_mm3, has_converged }
    }
}

impl Edges<'_> {
    /// Evaluates the edges at their displaced positions. Returns the loads and the largest mean chip of an edge on the
    /// end; writes the thickest chip of each tooth's side into the list; passes the force on each edge to `push`.
    fn evaluate(
        &mut self,
        bent: impl Fn(usize) -> Vector2<f64> + Copy,
        chips_mm: &mut [f64],
        mut push: impl FnMut(usize, Vector3<f64>),
    ) -> (Loads, f64) {
        let mut loads = Loads::default();
        // Parts of an end edge come one after the other.
        let mut ends: Vec<(usize, ChipSection)> = Vec::new();
        chips_mm.fill(0.0);
        for EdgeChip { edge, piece, section } in self.engagement.chips(self.at, bent) {
            // No force outside the cut.
            if section.thickness_mm > 0.0 && section.width_mm > 0.0 {
                push(edge, loads.add(&piece, self.pose.turned_rad, &self.cutting.force(&section)));
            }
            if piece.is_end() {
                match ends.last_mut().filter(|(last, _)| *last == edge) {
                    Some((_, end)) => *end = end.with(&section),
                    None => ends.push((edge, section)),
                }
            } else if let Some(thickest_mm) = chips_mm.get_mut(piece.tooth)
                && section.thickness_mm > *thickest_mm
                && section.width_mm >= NARROW_RATIO * piece.width_mm()
            {
                *thickest_mm = section.thickness_mm;
            }
        }
        (loads, ends.iter().map(|(_, end)| end.thickness_mm).fold(0.0, f64::max))
    }
}

impl EdgeDisplacements {
    /// Updates the points: the cut itself is the first; each edge with material around it has its own. The others are
    /// set apart.
    fn update<B: Modal>(
        &mut self,
        engagement: &EdgeEngagement,
        at: &mut EdgePoses,
        vibration: &Vibration,
        workpiece: &mut Workpiece<B>,
    ) {
        let EdgeDisplacements { places, place_of, bent_mm } = self;
        bent_mm.resize(engagement.edges(), Vector3::zeros());
        places.clear();
        place_of.clear();
        vibration.add_place(&[], places);
        for (edge, bent_mm) in bent_mm.iter().enumerate() {
            if !engagement.is_near(edge, at, bent_mm.xy(), MARGIN_MM) {
                place_of.push(0);
                at.set_apart(edge);
                continue;
            }
            let material_mm = engagement.edge_mm(edge, at) + bent_mm; // (1)
            place_of.push(places.count());
            vibration.add_place(workpiece.shapes_at(edge, material_mm.into()), places);
        }
    }

    /// Stores the displacements of the edges at the end of the step.
    fn store(&mut self) {
        let moved_mm = self.places.moved_mm();
        self.bent_mm.iter_mut().zip(&self.place_of).for_each(|(bent_mm, place)| *bent_mm = moved_mm[*place]);
    }
}
