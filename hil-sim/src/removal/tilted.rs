//! Remaining workpiece in layers square to a tilted tool.
//!
//! Edges are evaluated in layers square to the tool's axis. Where the axis stands otherwise than before, the layers are made
//! anew: the blank in the tool's frame, less all that the tool has swept until then. The layers are no source of rounding, because
//! sweeps are exact for any axis. What the edges of earlier cuts have left (feed marks) is lost with the old layers; from
//! move to move at one axis it is kept. A layer gets its material when the tool first comes to its height: most of a wheel lies
//! deeper than its slots.
//!
//! Sweeps are straight. One sweep stands for as much of a curved path as stays near its chord. With places at distance r_k from its
//! beginning and the tolerance t, its end lies in the directions that differ from those of all these places by
//!
//! ```text
//! angle <= asin(t / r_k)        (1)
//! ```
//!
//! The cone in `Onward` lies within these cones, so no place is farther from its chord than t, however many periods there are.
//!
//! For plunges a workpiece in which thousands of them follow each other is made about the tool's axis only, as far as the tool
//! reaches; where the tool goes farther away, it is made anew.
//!
//! The positions of the axes are whole nanometres. In the frame of a tilted tool a move along the axis so has a path across it of
//! a nanometre, which no machine makes and for which an edge would have a force. Coordinates that change by less count as
//! standing.
//!
//! Source: own.

use std::f64::consts::PI;
use std::sync::Arc;

use arcfeed_dexel::frame::Frame;
use arcfeed_dexel::grid::Grid;
use arcfeed_dexel::lattice::{Lattice, LatticeError};
use arcfeed_dexel::section::Sweep;
use arcfeed_dexel::solid::{InitialSolid, Machined, Solid};
use arcfeed_dexel::sweep::can_meet;
use arcfeed_dexel::tool::Tool;
use arcfeed_kinematics::machine::Machine;
use arcfeed_kinematics::vector::{Vector, cross, difference, dot, length, scaled, sum, unit};
use arcfeed_milling::cutting::edge_engagement::EdgeEngagement;
use arcfeed_milling::cutting::layers::Layers;

use super::placement::{ToolChord, WorkpiecePlacement};
use super::trail::PathSection;

/// Change of a coordinate that counts as none: the resolution of three axes.
const STILL_MM: f64 = 3e-6;
/// Distance from a straight path that counts as none.
const STRAIGHT_MM: f64 = 1e-6;
/// Largest distance of the tip's path from the chord of a sweep.
const CHORD_MM: f64 = 1e-3;
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

/// Directions in which a sweep may end, as seen from its beginning: a cone. (1)
#[derive(Clone, Copy, Debug)]
struct Onward {
    direction: Vector,
    half_rad: f64,
}

/// Workpiece of which the layers in force are made.
#[derive(Clone, Debug)]
struct LayerSource {
    /// Blank in the frame of the layers.
    blank: Arc<dyn InitialSolid>,
    /// Corners of the part of it that the layers have.
    corners_mm: [Vector; 2],
    /// Number of sweeps until the axis turned: what is swept later is cut by edges.
    sweeps: usize,
    /// Whether each layer has its material.
    is_filled: Vec<bool>,
}

/// Layers in force and what the tool has swept so far. Keeps its state between calls.
#[derive(Clone, Debug)]
pub(super) struct TiltedLayers {
    workpiece: TiltedWorkpiece,
    /// Height of a layer, and distance of its rays.
    sizes_mm: [f64; 2],
    sweeps: Vec<Sweep>,
    /// Directions in which the last sweep may go on; `None` before the first.
    onward: Option<Onward>,
    /// Source of the layers; `None` for the first ones, which are whole.
    source: Option<LayerSource>,
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
        TiltedLayers {
            workpiece,
            sizes_mm,
            sweeps: Vec::new(),
            onward: None,
            source: None,
            frame: Frame::OWN,
            about_mm: None,
            tip_mm: None,
            is_tilted: false,
        }
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

    /// Layers perpendicular to the tool, for the material that remains so far; [`TiltedLayers::fill`] gives it to them.
    ///
    /// # Errors
    /// There are too many layers or rays.
    pub fn turn_to(&mut self, chord: &ToolChord) -> Result<Layers, LatticeError> {
        let about_mm = self.workpiece.about_mm.map(|_| chord.frame.coordinates(chord.ends_mm[0]));
        let blank = self.workpiece.blank.in_frame(&chord.frame);
        let mut corners_mm = blank.bounds_mm();
        if let Some((about_mm, radius_mm)) = about_mm.zip(self.workpiece.about_mm) {
            for axis in [0, 1] {
                corners_mm[0][axis] = corners_mm[0][axis].max(about_mm[axis] - ABOUT_RADII * radius_mm);
                corners_mm[1][axis] = corners_mm[1][axis].min(about_mm[axis] + ABOUT_RADII * radius_mm);
            }
        }
        let [rise_mm, step_mm] = self.sizes_mm;
        let layers = Layers::empty(corners_mm, 2, rise_mm, step_mm)?;
        let is_filled = vec![false; layers.layers().len()];
        self.source = Some(LayerSource { blank: blank.into(), corners_mm, sweeps: self.sweeps.len(), is_filled });
        (self.frame, self.about_mm, self.tip_mm) = (chord.frame, about_mm, None);
        self.is_tilted |= chord.is_tilted();
        Ok(layers)
    }

    /// Gives the layers that a tool can touch on a chord, with ends in the frame of the layers, their material.
    ///
    /// # Errors
    /// As [`TiltedLayers::fill`].
    pub fn fill_for(&mut self, engagement: &mut EdgeEngagement, ends_mm: &[Vector; 2]) -> Result<(), LatticeError> {
        let [from, to] = ends_mm.map(|tip_mm| engagement.heights_mm(tip_mm[2]));
        self.fill(engagement.layers_mut(), [from[0].min(to[0]), from[1].max(to[1])])
    }

    /// Gives the layers in force between two heights the material that remained when the tool's axis turned, where they do not have it yet.
    ///
    /// # Errors
    /// There are too many rays.
    pub fn fill(&mut self, layers: &mut Layers, heights_mm: [f64; 2]) -> Result<(), LatticeError> {
        let Some(source) = &mut self.source else { return Ok(()) };
        let [first, last] = heights_mm.map(|height_mm| layers.nth(height_mm));
        let nths = first.max(0)..=last.min(source.is_filled.len() as i64 - 1);
        let due: Vec<usize> =
            nths.filter_map(|nth| layers.place(nth)).filter(|index| !source.is_filled[*index]).collect();
        let [Some(&lowest), Some(&highest)] = [due.first(), due.last()] else { return Ok(()) };
        let step_mm = self.sizes_mm[1];
        // The outermost rays stand up to a step beyond the corners.
        let mut around_mm = [0, 1].map(|side: usize| source.corners_mm[side].map(|at| at + [-step_mm, step_mm][side]));
        (around_mm[0][2], around_mm[1][2]) = (layers.middle_mm(lowest) - step_mm, layers.middle_mm(highest) + step_mm);
        let tool = &self.workpiece.tool;
        let sweeps = self.sweeps[..source.sweeps].iter().map(|sweep| sweep.in_frame(&self.frame));
        let sweeps: Vec<Sweep> = sweeps.filter(|sweep| can_meet(tool, sweep, &around_mm)).collect();
        let machined = Machined { solid: &*source.blank, tool, sweeps: &sweeps };
        let part = PartOf { solid: &machined, corners_mm: source.corners_mm };
        for index in due {
            layers.fill(index, &part, 2)?;
            source.is_filled[index] = true;
        }
        Ok(())
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
    /// Sweeps of which layers in force are made stay as they are.
    pub fn add(&mut self, section: &PathSection, placement: &WorkpiecePlacement, machine: Option<&Machine>) {
        let TiltedWorkpiece { tool, tolerance_mm, .. } = &self.workpiece;
        // Where the tool's place is unknown, its material stays.
        let sweeps = placement.sweeps(section, tool, machine, *tolerance_mm).unwrap_or_default();
        let is_free = |count: usize| self.source.as_ref().is_none_or(|source| count > source.sweeps);
        for sweep in sweeps.iter().filter(|sweep| sweep.from_mm != sweep.to_mm) {
            let count = self.sweeps.len();
            let last = self.sweeps.last_mut();
            let longer = last.as_ref().zip(self.onward).and_then(|(last, onward)| onward.extended(last, sweep));
            match (last, longer) {
                (Some(last), Some(onward)) if is_free(count) => {
                    last.to_mm = sweep.to_mm;
                    self.onward = Some(onward);
                }
                (Some(last), _) if covers(last, sweep) => {}
                _ => {
                    self.sweeps.push(*sweep);
                    self.onward = Some(Onward::of(sweep.motion_mm()));
                }
            }
        }
    }
}

impl Onward {
    /// Directions of a chord that passes a place, seen from its beginning. (1)
    fn of(place_mm: Vector) -> Self {
        let distance_mm = length(place_mm);
        let half_rad = if distance_mm > CHORD_MM { libm::asin(CHORD_MM / distance_mm) } else { PI };
        Onward { direction: scaled(place_mm, 1.0 / distance_mm), half_rad }
    }

    /// Directions in which the sweep may go on after the next one has extended it; `None` if the next one does not go on from its end, near
    /// enough to a chord.
    fn extended(&self, last: &Sweep, next: &Sweep) -> Option<Self> {
        let whole = difference(next.to_mm, last.from_mm);
        let other = Onward::of(whole);
        let aside = cross(self.direction, other.direction);
        let (sin, cos) = (length(aside), dot(self.direction, other.direction));
        let between_rad = libm::atan2(sin, cos);
        let is_onward = length(whole) > length(last.motion_mm()) && between_rad <= self.half_rad;
        if last.axis != next.axis || last.to_mm != next.from_mm || !is_onward {
            return None;
        }
        // The largest cone within both; its axis is between theirs.
        let from_rad = (-self.half_rad).max(between_rad - other.half_rad);
        let to_rad = self.half_rad.min(between_rad + other.half_rad);
        let (middle_rad, half_rad) = ((from_rad + to_rad) / 2.0, (to_rad - from_rad) / 2.0);
        let across = unit(cross(aside, self.direction));
        let direction = across.map_or(self.direction, |across| {
            sum(scaled(self.direction, libm::cos(middle_rad)), scaled(across, libm::sin(middle_rad)))
        });
        Some(Onward { direction, half_rad })
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

#[cfg(test)]
mod tests {
    use arcfeed_control::action::MoveContext;
    use arcfeed_dexel::motion::Pose;
    use arcfeed_dexel::solid::Revolved;
    use arcfeed_units::Micros;

    use super::*;
    use crate::removal::trail::BlockRef;

    /// Sweeps of an upright tool through places, a period each.
    fn sweeps(places_mm: &[[f64; 2]]) -> Vec<Sweep> {
        let tool = Tool::cylinder(1.0, 1.0).unwrap();
        let blank = Revolved::new(tool.clone(), &Pose { tip_mm: [0.0; 3], axis: [0.0, 0.0, 1.0] }).unwrap();
        let workpiece = TiltedWorkpiece { blank: Arc::new(blank), tool, tolerance_mm: 0.01, about_mm: None };
        let mut layers = TiltedLayers::new(workpiece, [1.0; 2]);
        let mut placement = WorkpiecePlacement::new(true);
        for pair in places_mm.windows(2) {
            let section = PathSection {
                block: BlockRef { count: 1, sequence: None, rule: None, is_rapid: false },
                context: MoveContext::default(),
                from: Micros(0),
                to: Micros(0),
                positions: [0, 1].map(|end: usize| [pair[end][0], pair[end][1], 0.0, 0.0, 0.0, 0.0]).to_vec(),
            };
            placement.locate(&section);
            layers.add(&section, &placement, None);
        }
        layers.sweeps
    }

    /// In whole nanometres.
    fn rounded(mm: f64) -> f64 {
        libm::round(mm * 1e6) / 1e6
    }

    #[test]
    fn chords_of_an_arc_are_within_the_tolerance_however_slow_it_is() {
        let (radius_mm, way_mm) = (100.0, 4.0);
        for step_mm in [0.02, 0.0004] {
            let count = libm::round(way_mm / step_mm) as u32;
            let place = |step: u32| {
                let (sin, cos) = libm::sincos(f64::from(step) * step_mm / radius_mm);
                [rounded(radius_mm * cos), rounded(radius_mm * sin)]
            };
            let found = sweeps(&(0..=count).map(place).collect::<Vec<_>>());
            // A chord of length c is c^2 / 8 R from its arc.
            let least = libm::ceil(way_mm / libm::sqrt(8.0 * radius_mm * CHORD_MM)) as usize;
            assert!((least..=least + 1).contains(&found.len()), "{step_mm}: {} chords, {least} at least", found.len());
            for sweep in &found {
                let middle = scaled(sum(sweep.from_mm, sweep.to_mm), 0.5);
                assert!(radius_mm - libm::hypot(middle[0], middle[1]) <= 1.01 * CHORD_MM, "{step_mm}: {sweep:?}");
            }
            assert!(found.windows(2).all(|pair| pair[0].to_mm == pair[1].from_mm));
        }
    }

    #[test]
    fn a_straight_path_is_one_sweep_and_back_over_it_is_none() {
        let there = (0..=20_000).map(|step| [0.3, 0.4].map(|part| rounded(part * 0.01 * f64::from(step))));
        let there: Vec<[f64; 2]> = there.collect();
        let found = sweeps(&there.iter().chain(there.iter().rev()).copied().collect::<Vec<_>>());
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].from_mm, found[0].to_mm), ([0.0; 3], [60.0, 80.0, 0.0]));
    }
}
