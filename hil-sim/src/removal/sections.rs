//! Engaged sections of a tool along the moves that descend along its axis: for the plunge law.
//!
//! The end of the tool is in material where there is any below it, within a chip's thickness. On a ramp its sides are, in
//! addition, where there is material in front of the half of a circle that advances. A load is the largest sum, over a
//! turn, of what the edges of the tool have in material, so it does not depend on the angle of the spindle:
//!
//! ```text
//! end  = largest sum of moments of the end's edges                               mm2     (1)
//! side = sum over layers of layer height * radius * most edges in material       mm2     (2)
//! ```
//!
//! (2) adds the largest values of the layers, which no helix can exceed.
//!
//! At a joint of two descending moves the first tooth cuts what both have left: on the end the chip goes over
//! from that of the one move to that of the other, and on the sides the chips of both directions overlap. The section of
//! the joint has the larger end of both moves, and the sides in material in front of either direction.
//!
//! A descending move directly behind a move with engaged arcs meets the chip that this one has left; see
//! [`super::engagement`].
//!
//! Source: geometry; the moments are those of [`arcfeed_milling::cutting::engaged_section`].

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use arcfeed_kinematics::vector::Vector;
use arcfeed_milling::cutting::engaged_arcs::EdgeCircle;
use arcfeed_milling::cutting::engaged_section::{EngagedSection, is_above};
use arcfeed_milling::cutting::layers::{LEVEL_RATIO, Layers, Slice};
use arcfeed_model::governed::Descent;
use arcfeed_model::job::ToolAxis;
use arcfeed_model::tool::Edge;
use arcfeed_nc::segment::Segment;
use arcfeed_units::Nm;
use nalgebra::Vector2;

use super::trail::BlockRef;

/// Path between two moves within which the second meets the chip of the first: more than any tooth goes.
pub(super) const JOINED_MM: f64 = 2.0;

/// Settings for computing the engaged sections of descending moves (plunges and ramps).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionSettings {
    /// Numbers of edges on the tool's end and on a side of it.
    pub edges: EdgeCounts,
    /// Innermost and outermost radius of the tool.
    pub radii_mm: [f64; 2],
    /// Height above the tip of the rounded corner: below it the tool is narrower.
    pub corner_mm: f64,
    /// Whether ramps (moves that descend at an angle) have sections, too.
    pub has_ramps: bool,
}

/// Numbers of edges of the tool that pass a point in one turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeCounts {
    /// Number of edges on the end.
    pub end: usize,
    /// Number of edges on each side, the outer and the inner one.
    pub side: usize,
}

/// Descending move (plunge or ramp) with its engaged sections.
#[derive(Clone, Debug, PartialEq)]
pub struct SectionedMove {
    /// The move, in the workpiece's coordinates.
    pub segment: Segment,
    /// Samples in order of the path; empty if the tool's position on the workpiece is not known.
    pub samples: Vec<SectionSample>,
    /// Joints with the descending moves directly before and after it; `None` without one.
    pub joints: [Option<SectionJoint>; 2],
}

/// Engaged section at the joint where one descending move continues in another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SectionJoint {
    /// Moment (sum of radius times engaged width) of the end's edges: the larger one of both moves; 0 if the position is not known.
    pub end_mm2: f64,
    /// Moment of the sides' edges that have material in front of them in the direction of either move.
    pub side_mm2: f64,
    /// Larger sine of the slope angles of both moves, measured from the plane square to the tool's axis.
    pub sine_ratio: f64,
    /// Larger cosine of these angles.
    pub cosine_ratio: f64,
}

/// Descending moves of a run with their sections so far. Keeps its state between calls.
#[derive(Clone, Debug)]
pub(super) struct SectionMeter {
    settings: SectionSettings,
    moves: Vec<SectionedMove>,
    /// Count of the last descending move's block.
    descent: Option<u32>,
    /// Count of the block in execution.
    block: Option<u32>,
    /// Path since the last descending move; infinite behind a rapid.
    apart_mm: f64,
    /// The same since the last move with engaged arcs.
    since_arcs_mm: f64,
}

/// Engaged section of the tool at one position of a descending move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionSample {
    /// Path of the move up to the sample.
    pub at_mm: f64,
    /// Moment (sum of radius times engaged width) of the end's edges. (1)
    pub end_mm2: f64,
    /// Moment of the sides' edges; 0 on a move along the tool's axis. (2)
    pub side_mm2: f64,
}

/// The tool above its workpiece, at a place of a move.
pub(super) struct ToolAt<'a> {
    /// The workpiece in layers along the tool's axis.
    pub layers: &'a Layers,
    /// Slices of the tool from the tip upwards, each as high as a layer.
    pub slices: &'a [Slice],
    /// Height above the tip up to which the sides cut.
    pub depth_mm: f64,
    /// Distance within which material counts: a chip's thickness.
    pub ahead_mm: f64,
    /// Position of the tip on the workpiece.
    pub tip_mm: Vector,
}

impl SectionMeter {
    /// State before the run.
    pub fn new(settings: SectionSettings) -> Self {
        let (apart_mm, since_arcs_mm) = (f64::INFINITY, f64::INFINITY);
        SectionMeter { settings, moves: Vec::new(), descent: None, block: None, apart_mm, since_arcs_mm }
    }

    /// Descending moves so far.
    pub fn moves(&self) -> &[SectionedMove] {
        &self.moves
    }

    /// Processes the block in execution; `has_arcs` states that engaged arcs are sampled on it. Returns whether a descending move begins
    /// that meets the chip of a move with engaged arcs.
    pub fn open(&mut self, block: &BlockRef, segment: &Segment, has_arcs: bool) -> bool {
        if self.block.replace(block.count) == Some(block.count) {
            return false;
        }
        let length_mm = if block.is_rapid { f64::INFINITY } else { segment.length_mm() };
        let before_mm = self.since_arcs_mm;
        self.since_arcs_mm = if has_arcs { 0.0 } else { before_mm + length_mm };
        let Some(descent) = self.settings.descent(segment) else {
            self.apart_mm += length_mm;
            return false;
        };
        let mut joints = [None; 2];
        if let Some(before) = self.moves.last_mut().filter(|_| self.apart_mm <= JOINED_MM) {
            let sines = self.settings.descent(&before.segment).map_or([1.0; 2], |d| [d.sine_ratio, descent.sine_ratio]);
            let cosines = sines.map(|sine| libm::sqrt((1.0 - sine * sine).max(0.0)));
            let [sine_ratio, cosine_ratio] = [sines, cosines].map(|[one, other]| f64::max(one, other));
            let joint = SectionJoint { sine_ratio, cosine_ratio, ..SectionJoint::default() };
            (before.joints[1], joints[0]) = (Some(joint), Some(joint));
        }
        self.moves.push(SectionedMove { segment: *segment, samples: Vec::new(), joints });
        self.descent = Some(block.count);
        self.apart_mm = 0.0;
        before_mm <= JOINED_MM
    }

    /// Whether a block is the last descending move.
    pub fn is_open(&self, block: &BlockRef) -> bool {
        self.descent == Some(block.count)
    }

    /// Takes a sample on the last descending move, unless the previous sample is nearer than `apart_mm`. The first
    /// sample of a move also counts for the joint with the move before.
    pub fn sample(&mut self, tool: &ToolAt<'_>, at_mm: f64, apart_mm: f64) {
        let [before @ .., moved] = &mut self.moves[..] else { return };
        if moved.samples.last().is_some_and(|last| at_mm < last.at_mm + apart_mm) {
            return;
        }
        let sample = self.settings.sample(tool, &moved.segment, at_mm);
        if let ([.., before], Some(joint), true) = (before, &mut moved.joints[0], moved.samples.is_empty()) {
            let last_mm2 = before.samples.last().map_or(0.0, |sample| sample.end_mm2);
            joint.end_mm2 = sample.end_mm2.max(last_mm2);
            joint.side_mm2 = self.settings.side_mm2(tool, &[&before.segment, &moved.segment]);
            before.joints[1] = Some(*joint);
        }
        moved.samples.push(sample);
    }
}

impl SectionSettings {
    fn descent(&self, segment: &Segment) -> Option<Descent> {
        Descent::of(segment, ToolAxis::Z).filter(|descent| self.has_ramps || descent.is_plunge())
    }

    /// Sample at a place of a move, after this path on it.
    fn sample(&self, tool: &ToolAt<'_>, segment: &Segment, at_mm: f64) -> SectionSample {
        SectionSample { at_mm, end_mm2: self.end_mm2(tool), side_mm2: self.side_mm2(tool, &[segment]) }
    }

    /// Moment of the end's edges. (1)
    fn end_mm2(&self, tool: &ToolAt<'_>) -> f64 {
        let ToolAt { layers, ahead_mm, tip_mm, .. } = tool;
        let Some(step_mm) = layers.layers().first().map(|layer| layer.step_mm()) else { return 0.0 };
        let below_mm = tip_mm[2] - ahead_mm;
        let (lowest, highest) = (layers.nth(below_mm), layers.nth(tip_mm[2] + self.corner_mm));
        let center_mm = Vector2::new(tip_mm[0], tip_mm[1]);
        let is_material = |point_mm: Vector2<f64>| {
            (lowest..=highest).any(|nth| {
                let layer = layers.place(nth).and_then(|index| layers.layers().get(index));
                layer.is_some_and(|layer| {
                    is_above(layer, point_mm, center_mm, layers.part_ratio(nth, below_mm).max(0.0))
                })
            })
        };
        let section = EngagedSection::of_ring(center_mm, self.radii_mm, self.edges.end, (step_mm, is_material));
        section.moment_sum_max_mm2(self.edges.end)
    }

    /// Moment of the edges of both sides, for the directions of these moves; 0 if all of them are plunges. Every layer that
    /// the tool reaches into counts as a whole. (2)
    fn side_mm2(&self, tool: &ToolAt<'_>, moves: &[&Segment]) -> f64 {
        let is_ramp = |segment: &&&Segment| self.descent(segment).is_some_and(|descent| !descent.is_plunge());
        let motions_rad: Vec<f64> = moves.iter().filter(is_ramp).map(|segment| direction_rad(segment)).collect();
        let ToolAt { layers, slices, depth_mm, tip_mm, .. } = tool;
        let level_mm = LEVEL_RATIO * layers.rise_mm();
        let (lowest, highest) = (layers.nth(tip_mm[2] + level_mm), layers.nth(tip_mm[2] + depth_mm - level_mm));
        let of_layer = |nth: i64| {
            let Some(slice) = slices.get((nth - lowest) as usize).or(slices.last()) else { return 0.0 };
            let sides = [(Edge::Outer, slice.outer_mm), (Edge::Inner, slice.inner_mm)];
            let in_material = |(side, radius_mm)| match radius_mm > 0.0 {
                true => radius_mm * self.edges_in_material(tool, (side, radius_mm, nth), &motions_rad),
                false => 0.0,
            };
            layers.rise_mm() * sides.into_iter().map(in_material).sum::<f64>()
        };
        if motions_rad.is_empty() { 0.0 } else { (lowest..=highest).map(of_layer).sum() }
    }

    /// Most edges of a circle that are at once in the material of a layer, in front of one of these directions.
    fn edges_in_material(
        &self,
        tool: &ToolAt<'_>,
        (side, radius_mm, nth): (Edge, f64, i64),
        motions_rad: &[f64],
    ) -> f64 {
        let ToolAt { layers, ahead_mm, tip_mm, .. } = tool;
        let Some(layer) = layers.place(nth).and_then(|index| layers.layers().get(index)) else { return 0.0 };
        let circle = EdgeCircle { center_mm: Vector2::new(tip_mm[0], tip_mm[1]), radius_mm, side, ahead_mm: *ahead_mm };
        let floor_ratio = layers.part_ratio(nth, tip_mm[2]).max(0.0) + LEVEL_RATIO;
        let spare_rad = layer.step_mm() / 2.0 / radius_mm;
        let in_front = |motion_rad: &f64| {
            let advance_rad = if side == Edge::Outer { *motion_rad } else { motion_rad + PI };
            let front_rad = [advance_rad - FRAC_PI_2, advance_rad + FRAC_PI_2];
            let within_rad = [front_rad[0] - spare_rad, front_rad[1] + spare_rad];
            let [from_rad, to_rad] = circle.engaged_rad(layer, floor_ratio, within_rad, None)?;
            Some([(from_rad - spare_rad).max(front_rad[0]), (to_rad + spare_rad).min(front_rad[1])])
        };
        // Both fronts count as one, which no edge passes twice in a turn.
        let fronts_rad: Vec<[f64; 2]> = motions_rad.iter().filter_map(in_front).collect();
        let Some(width_rad) = hull_width_rad(&fronts_rad) else { return 0.0 };
        (libm::floor(width_rad / (TAU / self.edges.side as f64)) + 1.0).min(self.edges.side as f64)
    }
}

/// Least width of an arc that has all these arcs in it, each at most half a turn wide; `None` without arcs.
fn hull_width_rad(arcs_rad: &[[f64; 2]]) -> Option<f64> {
    let past = |angle_rad: f64| angle_rad - libm::floor(angle_rad / TAU) * TAU;
    let from = |start_rad: f64| {
        let end_rad = |[from, to]: &[f64; 2]| past(from - start_rad) + (to - from);
        arcs_rad.iter().map(end_rad).fold(0.0, f64::max)
    };
    arcs_rad.iter().map(|[start_rad, _]| from(*start_rad)).reduce(f64::min)
}

/// Direction of a move across the axis.
fn direction_rad(segment: &Segment) -> f64 {
    let [x, y] = [0, 1].map(|axis: usize| (segment.end.linear[axis].0 - segment.start.linear[axis].0) as f64);
    libm::atan2(y, x)
}

/// Path of a straight move up to a position of the axes.
pub(super) fn travelled_mm(segment: &Segment, axes: &[f64]) -> f64 {
    let [start, end] = [segment.start, segment.end].map(|pose| pose.linear.map(Nm::to_mm));
    let along: f64 = (0..3).map(|axis| (axes[axis] - start[axis]) * (end[axis] - start[axis])).sum();
    along / segment.length_mm()
}
