//! A cut: where the tool is sent, what its edges find there, the forces of that, and how tool and workpiece give way.
//!
//! In each step the displacement and the forces are made to agree: the chips are asked of the material for a displacement, without
//! cutting, until nothing changes; then the edges go there and take what they sweep. The material keeps the marks, and
//! the next tooth meets them.
//!
//! The material is as the workpiece is unbent. An edge that stands at x, as does a workpiece that is bent by u, meets in it
//!
//! ```text
//! X = Phi^-1(x + u_T) = x + u_T - u_W(X)      (1)
//! ```
//!
//! and pushes on the workpiece's modes there. u_W is that of the point where the edge was at the end of the last step, carried on by the tool's way: off by the
//! strain times what the displacement changes by in a step.
//!
//! Source: Lorong et al., Simulation of a finishing operation, 2012, sections 1.3 and 3.1 and eqs 1 to 8, with modes in place of the full system (section 1).

use nalgebra::{Vector2, Vector3};

use crate::cutting::edge_engagement::{EdgeChip, EdgeEngagement};
use crate::cutting::edges::EdgePiece;
use crate::cutting::force::Loads;
use crate::cutting::material::{ChipSection, Cutting, EdgeForce};
use crate::cutting::pose::{Poses, Stand};
use crate::dynamics::vibration::{Places, Step, Vibration};
use crate::flexible::{Modal, Workpiece};

/// A chip on less than this part of a piece's height is a burr between two levels, and not what is told of as its thickness.
const NARROW_RATIO: f64 = 0.01;

/// No displacement changes by more than this in a step.
const MARGIN_MM: f64 = 0.1;

/// A tool at work.
#[derive(Clone, Debug)]
pub struct Process {
    engagement: EdgeEngagement,
    cutting: Cutting,
    /// Of the tool against the workpiece.
    vibration: Vibration,
    chips_mm: Vec<f64>,
    spread: Spread,
}

/// Edges that each give way in their own manner; state.
#[derive(Clone, Debug, Default)]
struct Spread {
    places: Places,
    /// Of each edge, which of the places is its own. Without one it is where the cut is.
    place_of: Vec<usize>,
    /// Of each edge, where it was bent to at the end of the last step.
    bent_mm: Vec<Vector3<f64>>,
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

/// The edges at one time, and what chips cost them.
struct Edges<'a> {
    engagement: &'a mut EdgeEngagement,
    cutting: &'a Cutting,
    stand: &'a Stand,
    at: &'a Poses,
}

impl Process {
    /// A cutter in its workpiece, and what both do under forces; a rigid pair has no modes.
    pub fn new(engagement: EdgeEngagement, cutting: Cutting, vibration: Vibration) -> Self {
        let chips_mm = vec![0.0; engagement.cutter().teeth()];
        Process { engagement, cutting, vibration, chips_mm, spread: Spread::default() }
    }

    /// The cutter and the workpiece.
    pub fn engagement(&self) -> &EdgeEngagement {
        &self.engagement
    }

    /// The cutter and the workpiece, to be moved without a cut.
    pub fn engagement_mut(&mut self) -> &mut EdgeEngagement {
        &mut self.engagement
    }

    /// The thickest chip of each tooth's side at the end of the last step.
    pub fn chips_mm(&self) -> &[f64] {
        &self.chips_mm
    }

    /// The edges are out of the material, and the tool is at rest when they come again.
    pub fn lift(&mut self) {
        self.engagement.lift();
        self.vibration.rest();
        self.spread.bent_mm.clear();
    }

    /// The modes.
    pub fn vibration(&self) -> &Vibration {
        &self.vibration
    }

    /// The force of all edges together, each with a chip this thick over its whole width, as if all pulled the same way.
    pub fn force_max_n(&self, thickness_mm: f64) -> f64 {
        let width_mm = self.engagement.cutter().pieces().iter().map(EdgePiece::width_mm).sum();
        let EdgeForce { tangential_n, radial_n, axial_n } = self.cutting.force(&ChipSection { thickness_mm, width_mm });
        Vector3::new(tangential_n, radial_n, axial_n).norm()
    }

    /// The modes, to see them from another place of the cut.
    pub fn vibration_mut(&mut self) -> &mut Vibration {
        &mut self.vibration
    }

    /// Goes to the next place, `dt_s` later, less than a quarter of a turn on; all edges are bent alike, as the cut is.
    pub fn step(&mut self, dt_s: f64, stand: &Stand) -> Moment {
        let at = self.engagement.poses(stand);
        let mut edges = Edges { engagement: &mut self.engagement, cutting: &self.cutting, stand, at: &at };
        let (chips_mm, mut found) = (&mut self.chips_mm, Default::default());
        let step = self.vibration.step(dt_s, |displacement_mm| {
            let bent: Vector2<f64> = displacement_mm.xy();
            found = edges.loaded(|_| bent, chips_mm, |_, _| ());
            found.0.force_n
        });
        let bent = step.displacement_mm.xy();
        let removed_mm3 = self.engagement.cut(&at, |_| bent);
        self.moment(&step, found, removed_mm3)
    }

    /// The same, but each edge that may have a chip is bent as the workpiece is where it is. The workpiece's modes are the first.
    pub fn step_on<B: Modal>(&mut self, dt_s: f64, stand: &Stand, workpiece: &mut Workpiece<B>) -> Moment {
        let mut at = self.engagement.poses(stand);
        self.spread.see(&self.engagement, &mut at, &self.vibration, workpiece);
        let mut edges = Edges { engagement: &mut self.engagement, cutting: &self.cutting, stand, at: &at };
        let (place_of, chips_mm, mut found) = (&self.spread.place_of, &mut self.chips_mm, Default::default());
        let step = self.vibration.step_at(dt_s, &mut self.spread.places, |moved_mm, forces_n| {
            let bent = |edge: usize| moved_mm[place_of[edge]].xy();
            found = edges.loaded(bent, chips_mm, |edge, force_n| forces_n[place_of[edge]] += force_n);
        });
        self.spread.keep();
        let bent_mm = &self.spread.bent_mm;
        let removed_mm3 = self.engagement.cut(&at, |edge| bent_mm[edge].xy());
        self.moment(&step, found, removed_mm3)
    }

    fn moment(&self, step: &Step, (loads, end_mm): (Loads, f64), removed_mm3: [f64; 2]) -> Moment {
        let thickest_mm = self.chips_mm.iter().copied().fold(0.0, f64::max);
        let (displacement_mm, agrees) = (step.displacement_mm, step.agrees);
        Moment { loads, displacement_mm, thickest_mm, end_mm, removed_mm3, agrees }
    }
}

impl Edges<'_> {
    /// What they find where they are bent to: the loads, the largest mean chip of an edge on the end, and into the list the thickest of each tooth's side;
    /// `push` is told the force on each edge.
    fn loaded(
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
            // Out of the cut there is no force.
            if section.thickness_mm > 0.0 && section.width_mm > 0.0 {
                push(edge, loads.add(&piece, self.stand.turned_rad, &self.cutting.force(&section)));
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

impl Spread {
    /// The cut itself is the first place; each edge with material around it has one of its own. The others are set apart.
    fn see<B: Modal>(
        &mut self,
        engagement: &EdgeEngagement,
        at: &mut Poses,
        vibration: &Vibration,
        workpiece: &mut Workpiece<B>,
    ) {
        let Spread { places, place_of, bent_mm } = self;
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

    /// Where the edges are at the end of the step.
    fn keep(&mut self) {
        let moved_mm = self.places.moved_mm();
        self.bent_mm.iter_mut().zip(&self.place_of).for_each(|(bent_mm, place)| *bent_mm = moved_mm[*place]);
    }
}
