//! Engaged arcs of a tool's cutting circles along the moves of a run: for laws that use engagement per move.
//!
//! The result depends on the path alone, not on feeds, so one run of the program is valid for all others on the same
//! path. The material is a stack of layers, and the solid of revolution of the edges clears each. A circle is engaged
//! where any layer up to the depth has material in front of it. Angles are those of [`arcfeed_model::engaged`].
//! Material behind the circle, where its edges recede, does not count. Several arcs are reported as one, from the first
//! to the last.
//!
//! The first tooth of a descending move cuts what the move before has left in front of it, in addition to its own chip. Where
//! the plunge law governs the descending move, the arcs at the end of the move before are reported as whole, so that a law
//! raises no feed there and the chip that remains is the programmed one.
//!
//! Source: own; omissions: docs/engagement.md.

use arcfeed_kinematics::machine::Machine;
use arcfeed_kinematics::vector::{Vector, difference, length};
use arcfeed_model::tool::Edge;
use arcfeed_nc::segment::Segment;
use nalgebra::Vector2;

use crate::simulated_machine::SimulatedMachine;
use arcfeed_control::drives::limits::AXES;
use arcfeed_dexel::tool::{Slab, Tool};
use arcfeed_milling::cutting::engaged_arcs::EdgeCircle;
use arcfeed_milling::cutting::layers::{LEVEL_RATIO, Layers, Slice};

use super::cutter::LeftOut;
use super::heading::{AHEAD_DEG, Heading};
use super::periods::{Period, Periods};
use super::placement::{LeftOutReason, ToolChord, WorkpiecePlacement, between};
use super::sections::{JOINED_MM, SectionMeter, SectionSettings, SectionedMove, ToolAt, travelled_mm};
use super::tilted::{TiltedLayers, TiltedSide, TiltedWorkpiece};
use super::trail::BlockRef;

/// Distance between two positions at which the material is cleared, as a fraction of the rays' distance. Between two positions a circle
/// leaves a cusp of an eighth of their squared distance over its radius: 0.006 mm at 5 mm with rays 0.5 mm apart.
const CLEAR_RATIO: f64 = 1.0;
/// Distance, as a fraction of the sample distance, within which the end of a move gets no sample of its own.
const END_RATIO: f64 = 0.01;

/// Settings of an [`EngagementMeter`].
#[derive(Clone, Debug)]
pub struct EngagementSettings {
    /// The workpiece, in the program's coordinates; layers along Z.
    pub layers: Layers,
    /// Cutting part of the tool.
    pub tool: Tool,
    /// Height above the tip up to which engagement counts.
    pub depth_mm: f64,
    /// Distance in front of a cutting circle within which material counts as engaged: a chip's thickness.
    pub ahead_mm: f64,
    /// Distance between two samples of a move.
    pub every_mm: f64,
    /// For each cut rule of the job, whether moves under it are sampled.
    pub rules: Vec<bool>,
    /// Machine that gives the tool's direction under G43.4.
    pub machine: Option<Machine>,
    /// Settings of the sections of descending moves; `None` without the plunge law.
    pub sections: Option<SectionSettings>,
    /// Workpiece for sections at all positions of the rotary axes; `None` for those at the first cut only.
    pub tilted: Option<TiltedWorkpiece>,
}

/// A move with the engaged arcs of the outer and the inner circle along it.
#[derive(Clone, Debug, PartialEq)]
pub struct EngagedMove {
    /// Block of the move.
    pub block: BlockRef,
    /// Samples in order of the path; empty if the tool's position on the workpiece is not known.
    pub samples: Vec<EngagedSample>,
}

/// Engaged arcs of the tool's outer and inner circle at one position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EngagedSample {
    /// Path of the move up to the sample.
    pub at_mm: f64,
    /// Beginning and end of the engaged arc of the outer and of the inner circle, in the angles of the laws; `None`
    /// without material in front.
    pub intervals_deg: [Option<[f64; 2]>; 2],
}

/// Engagement meter: moves the tool through the layers of the workpiece and samples its engaged arcs. Keeps its state between calls.
#[derive(Clone, Debug)]
pub struct EngagementMeter {
    settings: EngagementSettings,
    slices: Vec<Slice>,
    placement: WorkpiecePlacement,
    periods: Periods,
    /// Last position on the sampled move.
    last: Option<Reached>,
    /// Position at which the material was cleared last.
    cleared_mm: Option<Vector>,
    moves: Vec<EngagedMove>,
    /// Sections of descending moves; `None` without the plunge law.
    descents: Option<SectionMeter>,
    /// Layers for tilted tools; `None` without sections of them.
    tilted: Option<TiltedSide>,
    left_out: Vec<LeftOut>,
}

/// A position on a move.
#[derive(Clone, Copy, Debug)]
struct Reached {
    block: BlockRef,
    segment: Segment,
    axes: [f64; AXES],
    /// Position of the tip on the workpiece; for a tilted tool in the frame of its layers.
    tip_mm: Vector,
    is_tilted: bool,
}

impl EngagementMeter {
    /// Engagement meter before the run.
    pub fn new(settings: EngagementSettings) -> Self {
        let rise_mm = settings.layers.rise_mm();
        let heights =
            (0..).map(|n| (f64::from(n) + 0.5) * rise_mm).take_while(|height_mm| *height_mm < settings.depth_mm);
        let slices = heights.filter_map(|height_mm| slice(&settings.tool, height_mm)).collect();
        let sizes_mm = [rise_mm, settings.layers.layers().first().map_or(rise_mm, |layer| layer.step_mm())];
        let tilted = settings.tilted.clone();
        EngagementMeter {
            placement: WorkpiecePlacement::new(tilted.is_some()),
            tilted: tilted.map(|workpiece| TiltedSide { state: TiltedLayers::new(workpiece, sizes_mm), layers: None }),
            descents: settings.sections.map(SectionMeter::new),
            slices,
            periods: Periods::default(),
            last: None,
            cleared_mm: None,
            moves: Vec::new(),
            left_out: Vec::new(),
            settings,
        }
    }

    /// Processes a period of the run.
    pub fn observe(&mut self, simulation: &SimulatedMachine) {
        let executed = BlockRef::in_execution(simulation);
        let in_execution = executed.map(|(block, _)| block);
        if self.last.is_some_and(|last| in_execution.is_some_and(|block| block != last.block)) {
            self.end();
        }
        if let Some(block) = in_execution.filter(|block| self.is_sampled(block)) {
            self.open(block);
        }
        if let Some((block, segment)) = executed {
            let has_arcs = self.is_sampled(&block);
            if self.descents.as_mut().is_some_and(|descents| descents.open(&block, segment, has_arcs)) {
                self.widen_end();
            }
        }
        if let Some(period) = self.periods.observe(simulation) {
            self.process_period(&period);
        }
    }

    /// Ends the sampled move, or the run: its end gets a sample, however near the last sample was.
    pub fn end(&mut self) {
        if let Some(reached) = self.last.take() {
            self.sample(&reached, END_RATIO * self.settings.every_mm);
            self.sample_section(&reached, END_RATIO * self.settings.every_mm);
        }
    }

    /// Reports the arcs at the end of the last move as whole.
    fn widen_end(&mut self) {
        let Some(samples) = self.moves.last_mut().map(|moved| &mut moved.samples) else { return };
        let from_mm = samples.last().map_or(0.0, |last| last.at_mm) - JOINED_MM;
        let near_end = samples.iter_mut().filter(|sample| sample.at_mm >= from_mm);
        near_end.flat_map(|sample| sample.intervals_deg.iter_mut().flatten()).for_each(|arc_deg| *arc_deg = AHEAD_DEG);
    }

    /// Moves under a rule whose law needs engaged arcs, with the arcs sampled along each of them, in order of execution.
    pub fn moves(&self) -> &[EngagedMove] {
        &self.moves
    }

    /// Descending moves with their engaged sections, in order of execution; empty without the plunge law.
    pub fn descents(&self) -> &[SectionedMove] {
        self.descents.as_ref().map_or(&[], SectionMeter::moves)
    }

    /// Cutting blocks without engaged arcs, because the tool's position on the workpiece is unknown or its axis is tilted.
    pub fn left_out(&self) -> &[LeftOut] {
        &self.left_out
    }

    fn is_sampled(&self, block: &BlockRef) -> bool {
        block.rule.is_some_and(|rule| self.settings.rules.get(rule) == Some(&true))
    }

    fn open(&mut self, block: BlockRef) {
        if self.moves.last().is_none_or(|last| last.block != block) {
            self.moves.push(EngagedMove { block, samples: Vec::new() });
        }
    }

    fn is_descent(&self, block: &BlockRef) -> bool {
        self.descents.as_ref().is_some_and(|descents| descents.is_open(block))
    }

    fn process_period(&mut self, period: &Period) {
        let (section, machine) = (&period.section, self.settings.machine);
        let Some(chord) = self.placement.tool_chord(section, machine.as_ref()) else { return };
        let chord =
            chord.map_err(|reason| if reason == LeftOutReason::AxisTurns { LeftOutReason::Tilted } else { reason });
        match chord {
            Ok(chord) if chord.is_tilted() && self.tilted.is_some() => self.process_tilted(period, &chord),
            _ => self.process_upright(period, chord.and_then(upright_mm)),
        }
        if let Some(tilted) = &mut self.tilted {
            tilted.state.add(section, &self.placement, machine.as_ref());
        }
    }

    /// Samples the section of a tilted tool on a descending move, in the workpiece that the moves before it have left. What the move
    /// itself has taken lies above the tip and counts as material still.
    fn process_tilted(&mut self, Period { section, segment, axes }: &Period, chord: &ToolChord) {
        let Some(tilted) = self
            .tilted
            .as_mut()
            .filter(|_| self.descents.as_ref().is_some_and(|descents| descents.is_open(&section.block)))
        else {
            return;
        };
        if tilted.layers.is_none() || !tilted.state.are_in_frame_of(chord) {
            // Without layers the move has no sections, and keeps its feed.
            tilted.layers = tilted.state.turn_to(chord).ok().and_then(|mut layers| {
                let is_filled = tilted.state.fill(&mut layers, [f64::NEG_INFINITY, f64::INFINITY]).is_ok();
                is_filled.then_some(layers)
            });
        }
        let ends = tilted.state.ends_mm(chord);
        if tilted.layers.is_none() {
            return LeftOut::count(&mut self.left_out, section.block, LeftOutReason::Tilted);
        }
        let count = libm::ceil(length(difference(ends[1], ends[0])) / self.settings.every_mm).max(1.0);
        for step in 1..=count as u64 {
            let part = step as f64 / count;
            let axes = std::array::from_fn(|axis| axes[0][axis] + (axes[1][axis] - axes[0][axis]) * part);
            let tip_mm = between(&ends, part);
            let reached = Reached { block: section.block, segment: *segment, axes, tip_mm, is_tilted: true };
            self.sample_section(&reached, self.settings.every_mm);
            self.last = Some(reached);
        }
    }

    fn process_upright(
        &mut self,
        Period { section, segment, axes }: &Period,
        ends: Result<[Vector; 2], LeftOutReason>,
    ) {
        let ends = match ends {
            Ok(ends) => ends,
            Err(reason) => return LeftOut::count(&mut self.left_out, section.block, reason),
        };
        let fine_mm = CLEAR_RATIO * self.step_mm();
        let count = libm::ceil(length(difference(ends[1], ends[0])) / fine_mm).max(1.0);
        for step in 1..=count as u64 {
            let part = step as f64 / count;
            let tip_mm = between(&ends, part);
            if self.is_sampled(&section.block) || self.is_descent(&section.block) {
                let axes = std::array::from_fn(|axis| axes[0][axis] + (axes[1][axis] - axes[0][axis]) * part);
                let reached = Reached { block: section.block, segment: *segment, axes, tip_mm, is_tilted: false };
                self.sample(&reached, self.settings.every_mm);
                self.sample_section(&reached, self.settings.every_mm);
                self.last = Some(reached);
            }
            if self.cleared_mm.is_none_or(|last| length(difference(tip_mm, last)) >= fine_mm) {
                self.clear(&tip_mm);
                self.cleared_mm = Some(tip_mm);
            }
        }
    }

    /// Layer of the tip, within the tolerance of a level; the tool's lowest slice is there.
    fn lowest(&self, tip_mm: &Vector) -> i64 {
        let layers = &self.settings.layers;
        layers.nth(tip_mm[2] + LEVEL_RATIO * layers.rise_mm())
    }

    /// Removes the material above the tip. The part of a layer that a ramp leaves is in front of a later, deeper move.
    fn clear(&mut self, tip_mm: &Vector) {
        let (lowest, layers) = (self.lowest(tip_mm), &mut self.settings.layers);
        for (slice, nth) in self.slices.iter().zip(lowest..) {
            let foot_ratio = layers.part_ratio(nth, tip_mm[2]).max(0.0);
            if let Some(index) = layers.place(nth) {
                let axis_mm = Vector2::new(tip_mm[0], tip_mm[1]);
                layers.layers_mut()[index].lower_ring(axis_mm, [slice.inner_mm, slice.outer_mm], foot_ratio);
            }
        }
    }

    fn step_mm(&self) -> f64 {
        self.settings.layers.layers().first().map_or(f64::INFINITY, |layer| layer.step_mm())
    }

    /// Takes a sample of the section at a position that is `apart_mm` or more from the last one.
    fn sample_section(&mut self, reached: &Reached, apart_mm: f64) {
        let Some(descents) = self.descents.as_mut().filter(|descents| descents.is_open(&reached.block)) else { return };
        let &EngagementSettings { ref layers, ahead_mm, depth_mm, .. } = &self.settings;
        let tilted = self.tilted.as_ref().and_then(|tilted| tilted.layers.as_ref());
        let layers = if reached.is_tilted { tilted.unwrap_or(layers) } else { layers };
        let tool = ToolAt { layers, slices: &self.slices, depth_mm, ahead_mm, tip_mm: reached.tip_mm };
        descents.sample(&tool, travelled_mm(&reached.segment, &reached.axes), apart_mm);
    }

    /// Takes a sample at a position that is `apart_mm` or more from the last one.
    fn sample(&mut self, reached: &Reached, apart_mm: f64) {
        if reached.is_tilted || !self.is_sampled(&reached.block) {
            return;
        }
        let Some(heading) = Heading::of(&reached.segment, &reached.axes) else { return };
        let Some(last) = self.moves.last().map(|moved| moved.samples.last().map(|sample| sample.at_mm)) else { return };
        if last.is_some_and(|last_mm| heading.travelled_mm < last_mm + apart_mm) {
            return;
        }
        let intervals_deg = [Edge::Outer, Edge::Inner].map(|side| self.engaged_deg(side, &reached.tip_mm, &heading));
        if let Some(moved) = self.moves.last_mut() {
            moved.samples.push(EngagedSample { at_mm: heading.travelled_mm, intervals_deg });
        }
    }

    fn engaged_deg(&self, side: Edge, tip_mm: &Vector, heading: &Heading) -> Option<[f64; 2]> {
        let (layers, center_mm) = (&self.settings.layers, Vector2::new(tip_mm[0], tip_mm[1]));
        let radius_mm = |slice: &Slice| if side == Edge::Outer { slice.outer_mm } else { slice.inner_mm };
        let least_mm = self.slices.iter().map(radius_mm).filter(|radius_mm| *radius_mm > 0.0).reduce(f64::min)?;
        // Exact to half the rays' distance; widened to the safe side.
        let spare_rad = self.step_mm() / 2.0 / least_mm;
        let widened = |[from_rad, to_rad]: [f64; 2]| [from_rad - spare_rad, to_rad + spare_rad];
        let within_rad = widened(heading.front_rad(side));
        // Every layer that the tool reaches into; the last slice is used for the highest.
        let lowest = self.lowest(tip_mm);
        let highest = layers.nth(tip_mm[2] + self.settings.depth_mm - LEVEL_RATIO * layers.rise_mm());
        let in_layer = |known_rad: Option<[f64; 2]>, nth: i64| {
            let slice = self.slices.get((nth - lowest) as usize).or(self.slices.last())?;
            let (radius_mm, layer) = (radius_mm(slice), layers.layers().get(layers.place(nth)?)?);
            let ahead_mm = self.settings.ahead_mm;
            let circle = (radius_mm > 0.0).then_some(EdgeCircle { center_mm, radius_mm, side, ahead_mm })?;
            let floor_ratio = layers.part_ratio(nth, tip_mm[2]).max(0.0) + LEVEL_RATIO;
            circle.engaged_rad(layer, floor_ratio, within_rad, known_rad)
        };
        let engaged_rad = (lowest..=highest).fold(None, |known_rad, nth| in_layer(known_rad, nth).or(known_rad));
        heading.in_front_deg(side, &widened(engaged_rad?))
    }
}

/// Ends of the tip's motion of an upright tool.
fn upright_mm(chord: ToolChord) -> Result<[Vector; 2], LeftOutReason> {
    if chord.is_tilted() { Err(LeftOutReason::Tilted) } else { Ok(chord.ends_mm) }
}

/// Slice of the tool at a height; `None` if no part of the tool cuts there.
fn slice(tool: &Tool, height_mm: f64) -> Option<Slice> {
    let slab = tool.slabs().iter().find(|slab| (slab.heights_mm[0]..slab.heights_mm[1]).contains(&height_mm))?;
    let Slab { heights_mm: [low_mm, high_mm], outer_mm, inner_mm } = *slab;
    let part = (height_mm - low_mm) / (high_mm - low_mm);
    let at = |[low_mm, high_mm]: [f64; 2]| low_mm + (high_mm - low_mm) * part;
    Some(Slice { height_mm, inner_mm: inner_mm.map_or(0.0, at), outer_mm: at(outer_mm) })
}
