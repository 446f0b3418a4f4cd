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
//! Source: geometry; the moments are those of [`arcfeed_milling::cutting::engaged_section`].

use std::f64::consts::{FRAC_PI_2, TAU};

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

/// Settings of the sections.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionSettings {
    /// Edges of the tool's end, and those of a side of it.
    pub edges: EdgeCounts,
    /// Innermost and outermost radius of the tool.
    pub radii_mm: [f64; 2],
    /// Height above the tip up to which the tool has a smaller radius than there.
    pub corner_mm: f64,
    /// Whether moves that descend at an angle have sections, too.
    pub has_ramps: bool,
}

/// Numbers of edges that pass a place in one turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeCounts {
    /// On the end.
    pub end: usize,
    /// On each side, the outer and the inner one.
    pub side: usize,
}

/// A descending move with its sections.
#[derive(Clone, Debug, PartialEq)]
pub struct SectionedMove {
    /// The move in the workpiece's coordinates.
    pub segment: Segment,
    /// Samples in order; empty if the position on the workpiece is not known.
    pub samples: Vec<SectionSample>,
}

/// Engaged section at one place of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionSample {
    /// Path of the move up to the sample; grows from sample to sample.
    pub at_mm: f64,
    /// Moment of the end's edges. (1)
    pub end_mm2: f64,
    /// Moment of the edges of the sides; 0 on a move along the axis. (2)
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

impl SectionSettings {
    /// Whether a move has sections.
    pub fn include(&self, segment: &Segment) -> bool {
        self.descent(segment).is_some()
    }

    fn descent(&self, segment: &Segment) -> Option<Descent> {
        Descent::of(segment, ToolAxis::Z).filter(|descent| self.has_ramps || descent.is_plunge())
    }

    /// Sample at a place of a move, after this path on it.
    pub(super) fn sample(&self, tool: &ToolAt<'_>, segment: &Segment, at_mm: f64) -> SectionSample {
        let [x, y] = [0, 1].map(|axis: usize| (segment.end.linear[axis].0 - segment.start.linear[axis].0) as f64);
        let is_ramp = self.descent(segment).is_some_and(|descent| !descent.is_plunge());
        let side_mm2 = if is_ramp { self.side_mm2(tool, libm::atan2(y, x)) } else { 0.0 };
        SectionSample { at_mm, end_mm2: self.end_mm2(tool), side_mm2 }
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

    /// Moment of the edges of both sides, for a motion in this direction. Every layer that the tool reaches into counts
    /// as a whole. (2)
    fn side_mm2(&self, tool: &ToolAt<'_>, motion_rad: f64) -> f64 {
        let ToolAt { layers, slices, depth_mm, tip_mm, .. } = tool;
        let level_mm = LEVEL_RATIO * layers.rise_mm();
        let (lowest, highest) = (layers.nth(tip_mm[2] + level_mm), layers.nth(tip_mm[2] + depth_mm - level_mm));
        let of_layer = |nth: i64| {
            let Some(slice) = slices.get((nth - lowest) as usize).or(slices.last()) else { return 0.0 };
            let sides = [(Edge::Outer, slice.outer_mm), (Edge::Inner, slice.inner_mm)];
            let in_material = |(side, radius_mm)| match radius_mm > 0.0 {
                true => radius_mm * self.edges_in_material(tool, (side, radius_mm, nth), motion_rad),
                false => 0.0,
            };
            layers.rise_mm() * sides.into_iter().map(in_material).sum::<f64>()
        };
        (lowest..=highest).map(of_layer).sum()
    }

    /// Most edges of a circle that are in the material of a layer at once.
    fn edges_in_material(&self, tool: &ToolAt<'_>, (side, radius_mm, nth): (Edge, f64, i64), motion_rad: f64) -> f64 {
        let ToolAt { layers, ahead_mm, tip_mm, .. } = tool;
        let Some(layer) = layers.place(nth).and_then(|index| layers.layers().get(index)) else { return 0.0 };
        let circle = EdgeCircle { center_mm: Vector2::new(tip_mm[0], tip_mm[1]), radius_mm, side };
        let floor_ratio = layers.part_ratio(nth, tip_mm[2]).max(0.0) + LEVEL_RATIO;
        let spare_rad = layer.step_mm() / 2.0 / radius_mm;
        let advance_rad = if side == Edge::Outer { motion_rad } else { motion_rad + TAU / 2.0 };
        let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
        for [begin, end] in circle.engaged_rad(layer, *ahead_mm, floor_ratio) {
            for turns in [-1.0, 0.0, 1.0, 2.0] {
                let off = |end: f64| end - advance_rad + (turns - libm::floor((begin - advance_rad) / TAU)) * TAU - TAU;
                let (low, high) = ((off(begin) - spare_rad).max(-FRAC_PI_2), (off(end) + spare_rad).min(FRAC_PI_2));
                if low < high {
                    (from, to) = (from.min(low), to.max(high));
                }
            }
        }
        if from < to { libm::floor((to - from) / (TAU / self.edges.side as f64)) + 1.0 } else { 0.0 }
    }
}

/// Path of a straight move up to a position of the axes.
pub(super) fn travelled_mm(segment: &Segment, axes: &[f64]) -> f64 {
    let [start, end] = [segment.start, segment.end].map(|pose| pose.linear.map(Nm::to_mm));
    let along: f64 = (0..3).map(|axis| (axes[axis] - start[axis]) * (end[axis] - start[axis])).sum();
    along / segment.length_mm()
}
