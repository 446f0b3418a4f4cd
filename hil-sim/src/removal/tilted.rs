//! Remaining workpiece in layers square to a tilted tool.
//!
//! Edges are evaluated in layers square to the tool's axis. Where the axis stands otherwise than before, the layers are made
//! anew: the blank in the tool's frame, less all that the tool has swept so far. Nothing is rounded in between, because the
//! sweeps are exact for any axis. What the edges of earlier cuts have left (feed marks) is lost with the old layers; from
//! move to move at one axis it is kept.
//!
//! For plunges a workpiece in which thousands of them follow each other is made about the tool's axis only, as far as the tool
//! reaches; where the tool goes farther away, it is made anew.
//!
//! The positions of the axes are whole nanometres. In the frame of a tilted tool a move along the axis so has a path across it of
//! a nanometre, which no machine makes and for which an edge would have a force. Coordinates that change by less count as
//! standing.
//!
//! Source: own.

use std::sync::Arc;

use arcfeed_dexel::frame::Frame;
use arcfeed_dexel::grid::Grid;
use arcfeed_dexel::lattice::{Lattice, LatticeError};
use arcfeed_dexel::section::Sweep;
use arcfeed_dexel::solid::{InitialSolid, Machined, Solid};
use arcfeed_dexel::sweep::passes;
use arcfeed_dexel::tool::Tool;
use arcfeed_kinematics::machine::Machine;
use arcfeed_kinematics::vector::{Vector, cross, difference, dot, length};
use arcfeed_milling::cutting::layers::Layers;

use super::placement::{ToolChord, WorkpiecePlacement};
use super::trail::PathSection;

/// Change of a coordinate that counts as none: the resolution of three axes.
const STILL_MM: f64 = 3e-6;
/// Distance from a straight path that counts as none.
const STRAIGHT_MM: f64 = 1e-6;
/// Distance of unit vectors that count as one.
const SAME_RATIO: f64 = 1e-6;
/// Distance from the axis about which layers are made, in radii of the tool, up to which the tool stays within them.
const BESIDE_RADII: f64 = 0.5;
/// Half width of layers about an axis, in radii of the tool.
const ABOUT_RADII: f64 = 2.0;

/// Workpiece for evaluating the edges of tilted tools.
#[derive(Clone, Debug)]
pub struct TiltedWorkpiece {
    /// Workpiece before the first cut, in the program's coordinates.
    pub blank: Arc<dyn InitialSolid>,
    /// Cutting part of the tool.
    pub tool: Tool,
    /// Largest distance of sweeps from the path of a tool whose axis turns.
    pub tolerance_mm: f64,
    /// Radius about the tool's axis up to which layers are made, for plunges; `None` to make them of the whole workpiece.
    pub about_mm: Option<f64>,
}

/// Part of a solid between two corners; its rays go on beyond them.
#[derive(Debug)]
struct PartOf<'a> {
    solid: &'a dyn Solid,
    corners_mm: [Vector; 2],
}

impl Solid for PartOf<'_> {
    fn bounds_mm(&self) -> [Vector; 2] {
        self.corners_mm
    }

    fn grid(&self, lattice: &Lattice, axis: usize) -> Grid {
        self.solid.grid(lattice, axis)
    }
}

/// Layers in force and what the tool has swept so far. Keeps its state between calls.
#[derive(Clone, Debug)]
pub(super) struct TiltedLayers {
    workpiece: TiltedWorkpiece,
    /// Height of a layer, and distance of its rays.
    sizes_mm: [f64; 2],
    sweeps: Vec<Sweep>,
    frame: Frame,
    /// Place of the tool's axis in the frame about which the layers are made; `None`: they are whole.
    about_mm: Option<Vector>,
    /// Last place of the tip in the frame.
    tip_mm: Option<Vector>,
    is_tilted: bool,
}

/// Layers square to a tilted tool; the last ones remain until they are made for another axis.
#[derive(Clone, Debug)]
pub(super) struct TiltedSide {
    /// Sweeps of the tool so far, and the frame of the layers.
    pub state: TiltedLayers,
    /// Layers; `None` before the first tilted cut, or if there are none about its axis.
    pub layers: Option<Layers>,
}

impl TiltedLayers {
    /// State before the run: the layers are those of an upright tool.
    pub fn new(workpiece: TiltedWorkpiece, sizes_mm: [f64; 2]) -> Self {
        let (sweeps, frame) = (Vec::new(), Frame::OWN);
        TiltedLayers { workpiece, sizes_mm, sweeps, frame, about_mm: None, tip_mm: None, is_tilted: false }
    }

    /// Whether layers were made for a tilted tool.
    pub fn is_tilted(&self) -> bool {
        self.is_tilted
    }

    /// Whether the layers are in the frame of the tool, and reach as far as it does.
    pub fn are_in_frame_of(&self, chord: &ToolChord) -> bool {
        let mut pairs = self.frame.axes.iter().zip(chord.frame.axes);
        let is_same = pairs.all(|(axis, other)| length(difference(*axis, other)) <= SAME_RATIO);
        let is_within = self.about_mm.zip(self.workpiece.about_mm).is_none_or(|(about_mm, radius_mm)| {
            let off_mm = chord.ends_mm.map(|end_mm| difference(self.frame.coordinates(end_mm), about_mm));
            off_mm.iter().all(|off| libm::hypot(off[0], off[1]) <= BESIDE_RADII * radius_mm)
        });
        is_same && is_within
    }

    /// Layers perpendicular to the tool, with the material that remains so far.
    ///
    /// # Errors
    /// There are too many layers or rays.
    pub fn turn_to(&mut self, chord: &ToolChord) -> Result<Layers, LatticeError> {
        let about_mm = self.workpiece.about_mm.map(|_| chord.frame.coordinates(chord.ends_mm[0]));
        let solid = self.workpiece.blank.in_frame(&chord.frame);
        let mut corners_mm = solid.bounds_mm();
        if let Some((about_mm, radius_mm)) = about_mm.zip(self.workpiece.about_mm) {
            for axis in [0, 1] {
                corners_mm[0][axis] = corners_mm[0][axis].max(about_mm[axis] - ABOUT_RADII * radius_mm);
                corners_mm[1][axis] = corners_mm[1][axis].min(about_mm[axis] + ABOUT_RADII * radius_mm);
            }
        }
        let sweeps = self.sweeps.iter().map(|sweep| sweep.in_frame(&chord.frame));
        let tool = &self.workpiece.tool;
        let [rise_mm, step_mm] = self.sizes_mm;
        // The outermost rays stand up to a step beyond the corners.
        let around_mm = [0, 1].map(|side: usize| corners_mm[side].map(|at| at + [-step_mm, step_mm][side]));
        let is_near = |sweep: &Sweep| passes(tool, &[*sweep], 2).iter().any(|pass| pass.meets(&around_mm));
        let sweeps: Vec<Sweep> = sweeps.filter(is_near).collect();
        let machined = Machined { solid: &*solid, tool, sweeps: &sweeps };
        let layers = Layers::of_solid(&PartOf { solid: &machined, corners_mm }, 2, rise_mm, step_mm)?;
        (self.frame, self.about_mm, self.tip_mm) = (chord.frame, about_mm, None);
        self.is_tilted |= chord.is_tilted();
        Ok(layers)
    }

    /// Ends of a chord in the frame of the layers.
    pub fn ends_mm(&mut self, chord: &ToolChord) -> [Vector; 2] {
        if !chord.is_tilted() {
            return chord.ends_mm;
        }
        chord.ends_mm.map(|end_mm| {
            let at_mm = self.frame.coordinates(end_mm);
            let last_mm = self.tip_mm.unwrap_or(at_mm);
            let still = |axis: usize| {
                let is_still = libm::fabs(at_mm[axis] - last_mm[axis]) < STILL_MM;
                if is_still { last_mm[axis] } else { at_mm[axis] }
            };
            *self.tip_mm.insert([0, 1, 2].map(still))
        })
    }

    /// Adds the sweeps of a path section. A sweep that continues the last one extends it; one that only goes back over it adds nothing.
    pub fn add(&mut self, section: &PathSection, placement: &WorkpiecePlacement, machine: Option<&Machine>) {
        let TiltedWorkpiece { tool, tolerance_mm, .. } = &self.workpiece;
        // Where the tool's place is unknown, its material stays.
        let sweeps = placement.sweeps(section, tool, machine, *tolerance_mm).unwrap_or_default();
        for sweep in sweeps.iter().filter(|sweep| sweep.from_mm != sweep.to_mm) {
            match self.sweeps.last_mut() {
                Some(last) if continues(last, sweep) => last.to_mm = sweep.to_mm,
                Some(last) if covers(last, sweep) => {}
                _ => self.sweeps.push(*sweep),
            }
        }
    }
}

/// Whether a sweep lies within another one, under the same axis.
fn covers(last: &Sweep, next: &Sweep) -> bool {
    let (whole, whole_mm) = (last.motion_mm(), length(last.motion_mm()));
    let is_within = |place_mm: Vector| {
        let way = difference(place_mm, last.from_mm);
        let along_mm = dot(way, whole) / whole_mm;
        (-STRAIGHT_MM..=whole_mm + STRAIGHT_MM).contains(&along_mm)
            && length(cross(way, whole)) / whole_mm <= STRAIGHT_MM
    };
    last.axis == next.axis && is_within(next.from_mm) && is_within(next.to_mm)
}

/// Whether a sweep goes on where another ends, straight ahead under the same axis.
fn continues(last: &Sweep, next: &Sweep) -> bool {
    let (before, after) = (last.motion_mm(), next.motion_mm());
    let whole = difference(next.to_mm, last.from_mm);
    let off_mm = length(cross(before, whole)) / length(whole);
    last.axis == next.axis && last.to_mm == next.from_mm && off_mm <= STRAIGHT_MM && dot(before, after) > 0.0
}
