//! Chips and forces of the tool's edges during a run.
//!
//! The edges turn in steps of equal angle, a whole number from one tooth to the next, so every tooth is evaluated at
//! the same angles. The path within a millisecond counts as straight. Material that a rapid removes gives no chips.
//!
//! Source: own; omissions: docs/simulate.md.

use std::f64::consts::TAU;

use arcfeed_kinematics::machine::Machine;
use arcfeed_kinematics::vector::Vector;
use arcfeed_model::tool::Edge;
use arcfeed_units::{Micros, S_PER_MIN};
use nalgebra::Vector2;

use crate::simulated_machine::{STEP, SimulatedMachine};
use arcfeed_milling::cutting::pose::ToolPose;
use arcfeed_milling::process::{Process, ProcessStep};

use super::chatter_detection::{ChatterResult, ChatterSamples};
use super::cutter::LeftOut;
use super::flexible_workpiece::FlexibleWorkpiece;
use super::load_statistics::{CHIP_MIN_MM, LoadSample, LoadStatistics, LoadWindow, TurnStatistics};
use super::periods::{Period, Periods};
use super::placement::{LeftOutReason, ToolChord, WorkpiecePlacement, between, is_near};
use super::tilted::{TiltedLayers, TiltedWorkpiece};
use super::tip_path::TipPath;
use super::tooth_passes::{PassStep, ToothPass, ToothPasses};
use super::trail::{BlockRef, PathSection};

/// Steps in a millisecond above which the spindle speed is taken for a mistake and nothing is evaluated.
const STEPS_MAX: f64 = 1e4;

/// Positions in a millisecond of a rapid at which the tool removes all material: at 60 m/min a mill of 6 mm leaves
/// marks of 0.7 um.
const CLEARINGS: u32 = 8;

/// Settings of a [`LoadMeter`]: edges, workpiece, step size.
#[derive(Clone, Debug)]
pub struct LoadSettings {
    /// Edges in the layers of the workpiece, in the program's coordinates; layers along Z.
    pub process: Process,
    /// Machine that gives the tool's direction under G43.4.
    pub machine: Option<Machine>,
    /// Largest angle of a step.
    pub step_max_rad: f64,
    /// Flexible workpiece, whose modes come first in the process; `None` for a rigid one.
    pub flexible: Option<FlexibleWorkpiece>,
    /// Workpiece for tools that the machine tilts; `None` to evaluate the edges of an upright tool only.
    pub tilted: Option<TiltedWorkpiece>,
    /// Whether the edges are evaluated at all positions of the rotary axes; otherwise only at those of the first cut.
    pub is_indexed: bool,
    /// Samples for chatter detection: their number per turn, and the change of position that counts as none.
    pub samples: ChatterSamples,
}

/// Meter of the cutting loads in a run: moves the tool's edges through the workpiece and records chips, forces and passes of teeth.
#[derive(Clone, Debug)]
pub struct LoadMeter {
    settings: LoadSettings,
    placement: WorkpiecePlacement,
    /// Layers for tilted tools.
    tilted: Option<TiltedLayers>,
    periods: Periods,
    /// Block that cut in the period before.
    before: Option<BlockRef>,
    /// Block that last lowered the tip.
    down: Option<BlockRef>,
    /// Number of steps in a turn, and count of all steps.
    steps_a_turn: usize,
    steps: u64,
    /// Steps since the last chip.
    steps_idle: usize,
    /// Steps since the last chip on the tool's end.
    steps_level: usize,
    /// Fraction of a step that is due.
    due: f64,
    turn: TurnStatistics,
    passes: ToothPasses,
    blocks: Vec<(BlockRef, LoadStatistics)>,
    windows: Vec<LoadWindow>,
    tip_path: TipPath,
    left_out: Vec<LeftOut>,
}

impl LoadMeter {
    /// Load meter before the run.
    pub fn new(settings: LoadSettings) -> Self {
        let cutter = settings.process.engagement().cutter();
        let mut sides = vec![Edge::Outer; cutter.teeth()];
        for piece in cutter.pieces() {
            sides[piece.tooth] = piece.side;
        }
        let of_pitch = libm::ceil(TAU / cutter.teeth() as f64 / settings.step_max_rad).max(1.0);
        let layers = settings.process.engagement().layers();
        let sizes_mm = layers.layers().first().map(|layer| [layers.rise_mm(), layer.step_mm()]);
        LoadMeter {
            tilted: settings.tilted.clone().zip(sizes_mm).map(|(workpiece, sizes)| TiltedLayers::new(workpiece, sizes)),
            steps_a_turn: of_pitch as usize * cutter.teeth(),
            placement: WorkpiecePlacement::new(settings.is_indexed),
            settings,
            periods: Periods::default(),
            before: None,
            down: None,
            steps: 0,
            steps_idle: 0,
            steps_level: 0,
            due: 0.0,
            turn: TurnStatistics::new(),
            passes: ToothPasses::new(sides),
            blocks: Vec::new(),
            windows: Vec::new(),
            tip_path: TipPath::default(),
            left_out: Vec::new(),
        }
    }

    /// Processes a period of the run.
    pub fn observe(&mut self, simulation: &SimulatedMachine) {
        if let Some(Period { section, .. }) = self.periods.observe(simulation) {
            let is_backwards = simulation.control().spindle().is_some_and(|spindle| spindle.rev_per_min() < 0.0);
            let rev_per_min = f64::from(simulation.spindle().0);
            self.process_period(&section, if is_backwards { -rev_per_min } else { rev_per_min });
        }
    }

    /// Ends the run: completes the last cut, and drops blocks and windows without cutting time. To be called once, before results are read.
    pub fn end(&mut self) {
        self.lift();
        self.blocks.retain(|(_, statistics)| statistics.time_s > 0.0);
        self.windows.retain(|window| window.statistics.time_s > 0.0);
    }

    /// Begins to record the passes of the teeth for [`LoadMeter::take_passes`].
    pub fn record_passes(&mut self) {
        self.passes.record();
    }

    /// Takes the passes of the teeth recorded since the last call.
    pub fn take_passes(&mut self) -> Vec<ToothPass> {
        self.passes.take()
    }

    /// Load statistics of each block that had chips, in order.
    pub fn blocks(&self) -> &[(BlockRef, LoadStatistics)] {
        &self.blocks
    }

    /// Load statistics of consecutive windows of a quarter of a second.
    pub fn windows(&self) -> &[LoadWindow] {
        &self.windows
    }

    /// Whether the edges of a tilted tool were evaluated: the layers are no longer those of the whole workpiece.
    pub fn is_tilted(&self) -> bool {
        self.tilted.as_ref().is_some_and(TiltedLayers::is_tilted)
    }

    /// Path of the tip while edges could touch the workpiece.
    pub fn tip_path(&self) -> &TipPath {
        &self.tip_path
    }

    /// Cutting blocks without loads, because the tool's position on the workpiece is unknown or its axis is tilted.
    pub fn left_out(&self) -> &[LeftOut] {
        &self.left_out
    }

    /// Chatter results of the blocks that were long enough; none for a rigid tool.
    pub fn chatter(&self) -> &[ChatterResult] {
        self.settings.samples.blocks()
    }

    /// Natural frequencies of a flexible workpiece in Hz, the lowest first; empty for a rigid one.
    pub fn workpiece_hz(&self) -> impl Iterator<Item = f64> {
        let count = self.settings.flexible.as_ref().map_or(0, FlexibleWorkpiece::count);
        self.settings.process.vibration().modes()[..count].iter().map(|mode| mode.frequency_hz)
    }

    /// Largest change of the tool's position, mm, that chatter detection counts as no change.
    pub fn floor_mm(&self) -> f64 {
        self.settings.samples.floor_mm()
    }

    /// Angle by which the tool turns in one step.
    pub fn step_rad(&self) -> f64 {
        TAU / self.steps_a_turn as f64
    }

    /// Process with edges, workpiece and vibration.
    pub fn process(&self) -> &Process {
        &self.settings.process
    }

    fn process_period(&mut self, section: &PathSection, rev_per_min: f64) {
        let Some(chord) = self.placement.tool_chord(section, self.settings.machine.as_ref()) else { return };
        match chord.and_then(|chord| self.ends_in_layers_mm(section, &chord)) {
            Ok(Some(ends)) => self.process_chord(section, ends, rev_per_min),
            Ok(None) => self.leave_workpiece(),
            Err(reason) => {
                LeftOut::count(&mut self.left_out, section.block, reason);
                self.leave_workpiece();
            }
        }
        if let Some(tilted) = &mut self.tilted {
            tilted.add(section, &self.placement, self.settings.machine.as_ref());
        }
    }

    /// Ends of a chord in the frame of the layers, which are made anew where the tool's axis has turned since; `None` on a
    /// rapid at another axis, whose material is gone when layers are made for the next cut.
    fn ends_in_layers_mm(
        &mut self,
        section: &PathSection,
        chord: &ToolChord,
    ) -> Result<Option<[Vector; 2]>, LeftOutReason> {
        let Some(tilted) = &mut self.tilted else {
            return if chord.is_tilted() { Err(LeftOutReason::Tilted) } else { Ok(Some(chord.ends_mm)) };
        };
        if !tilted.are_in_frame_of(chord) {
            if section.block.is_rapid || section.positions[0] == section.positions[1] {
                return Ok(None);
            }
            let layers = tilted.turn_to(chord).map_err(|_| LeftOutReason::Tilted)?;
            *self.settings.process.engagement_mut().layers_mut() = layers;
            self.leave_workpiece();
        }
        let ends = self.tilted.as_mut().map_or(chord.ends_mm, |tilted| tilted.ends_mm(chord));
        if let (true, Some(tilted)) = (is_near(self.settings.process.engagement(), &ends), &mut self.tilted) {
            let filled = tilted.fill_for(self.settings.process.engagement_mut(), &ends);
            filled.map_err(|_| LeftOutReason::Tilted)?;
        }
        Ok(Some(ends))
    }

    fn process_chord(&mut self, section: &PathSection, ends: [Vector; 2], rev_per_min: f64) {
        let turned = rev_per_min / S_PER_MIN * STEP.to_s() * self.steps_a_turn as f64;
        let is_near = is_near(self.settings.process.engagement(), &ends);
        let cuts = !section.block.is_rapid && section.positions[0] != section.positions[1];
        if is_near && cuts && turned < 0.0 {
            LeftOut::count(&mut self.left_out, section.block, LeftOutReason::Backwards);
        }
        if !(is_near && turned > 0.0 && turned < STEPS_MAX) {
            return self.leave_workpiece();
        }
        if section.block.is_rapid {
            self.lift();
            if !self.is_tilted() {
                ends.iter().for_each(|tip_mm| self.tip_path.move_to(&section.block, *tip_mm));
            }
            for clearing in 1..=CLEARINGS {
                let pose = self.pose(&between(&ends, f64::from(clearing) / f64::from(CLEARINGS)));
                self.settings.process.engagement_mut().clear_at(&pose);
            }
            return;
        }
        if let Some(flexible) = &mut self.settings.flexible {
            self.settings.process.vibration_mut().set_shapes(flexible.shapes(&ends[1]));
        }
        let was_due = self.due;
        let count = libm::floor(was_due + turned);
        self.due = was_due + turned - count;
        for step in 1..=count as u64 {
            let part = (step as f64 - was_due) / turned;
            let tip_mm = between(&ends, part);
            self.step(section, part, &tip_mm, rev_per_min);
            if !self.is_tilted() && (self.tip_path.is_lifted() || step == count as u64) {
                self.tip_path.move_to(&section.block, tip_mm);
            }
        }
        self.before = Some(section.block);
    }

    /// Moves the edges by one step, to a position of the tip at this part of the period.
    fn step(&mut self, section: &PathSection, part: f64, tip_mm: &Vector, rev_per_min: f64) {
        self.steps += 1;
        let pose = self.pose(tip_mm);
        let engagement = self.settings.process.engagement_mut();
        // A period in which the block changes contains a part of the path of the block before.
        if engagement.descends(&pose) && self.before == Some(section.block) {
            self.down = self.before;
        }
        engagement.enter(&pose);
        let dt_s = S_PER_MIN / rev_per_min / self.steps_a_turn as f64;
        let LoadSettings { process, flexible, .. } = &mut self.settings;
        let moment = match flexible {
            Some(flexible) => process.step_on(dt_s, &pose, flexible.workpiece_mut()),
            None => process.step(dt_s, &pose),
        };
        let loads = moment.loads;
        self.sample(&section.block, &moment, rev_per_min);
        let sample = LoadSample {
            dt_s,
            bending_n: loads.bending_n(),
            thrust_n: loads.force_n.z,
            torque_n_m: loads.torque_n_m,
            power_w: loads.power_w(rev_per_min),
            end_mm: moment.end_mm,
        };
        // Material that the end removes after the tip has stopped belongs to the block that lowered the tip.
        let last = self.blocks.last().filter(|(block, _)| moment.end_mm > 0.0 && self.down == Some(*block));
        let step = PassStep {
            block: last.map_or(section.block, |(block, _)| *block),
            at_s: section.from.to_s() + part * STEP.to_s(),
            tip_mm: *tip_mm,
            bending_n: sample.bending_n,
            torque_n_m: sample.torque_n_m,
        };
        self.count(&step, section.from, &sample, moment.thickest_mm);
    }

    /// Samples the tool's deflection while there is a chip in every turn.
    fn sample(&mut self, block: &BlockRef, moment: &ProcessStep, rev_per_min: f64) {
        self.steps_idle = if moment.thickest_mm >= CHIP_MIN_MM { 0 } else { self.steps_idle + 1 };
        if self.settings.process.vibration().is_rigid() || self.steps_idle > self.steps_a_turn {
            return self.settings.samples.lift();
        }
        // After a descent the tool springs back, which counts as entering the cut on its new level.
        self.steps_level = if moment.end_mm >= CHIP_MIN_MM { 0 } else { self.steps_level + 1 };
        if self.steps_level == self.steps_a_turn {
            self.settings.samples.lift();
        }
        let every = (self.steps_a_turn / self.settings.samples.per_turn()) as u64;
        if self.steps.is_multiple_of(every) {
            self.settings.samples.add(block, moment.displacement_mm, rev_per_min / S_PER_MIN);
        }
    }

    fn count(&mut self, step: &PassStep, from: Micros, sample: &LoadSample, thickest_mm: f64) {
        let block = step.block;
        if self.blocks.last().is_none_or(|(last, _)| *last != block) {
            self.turn = TurnStatistics::new();
            self.blocks.push((block, LoadStatistics::default()));
        }
        let window = LoadWindow::around(from);
        if self.windows.last().is_none_or(|last| last.from != window.from) {
            self.windows.push(window);
        }
        let ended = self.passes.advance(step, self.settings.process.chips_mm());
        let statistics_lists = self.blocks.last_mut().map(|(_, statistics)| statistics).into_iter();
        for statistics in statistics_lists.chain(self.windows.last_mut().map(|window| &mut window.statistics)) {
            if thickest_mm.max(sample.end_mm) >= CHIP_MIN_MM {
                statistics.add(sample);
            }
            ended.iter().for_each(|pass| statistics.add_pass(pass.side, pass.chip_mm));
        }
        self.turn.add(sample.bending_n, thickest_mm);
        if self.steps.is_multiple_of(self.steps_a_turn as u64) {
            let turn = std::mem::take(&mut self.turn);
            if let Some((_, statistics)) = self.blocks.last_mut() {
                statistics.add_turn(&turn, self.steps_a_turn);
            }
        }
    }

    /// Ends the cut: unfinished passes and turns do not count.
    fn lift(&mut self) {
        self.settings.process.lift();
        self.settings.samples.lift();
        self.passes.lift();
        self.turn = TurnStatistics::new();
    }

    /// Leaves the reach of the workpiece.
    fn leave_workpiece(&mut self) {
        self.lift();
        self.tip_path.lift();
    }

    fn pose(&self, tip_mm: &Vector) -> ToolPose {
        let turned = self.steps % self.steps_a_turn as u64;
        let turned_rad = TAU * turned as f64 / self.steps_a_turn as f64;
        ToolPose { axis_mm: Vector2::new(tip_mm[0], tip_mm[1]), tip_mm: tip_mm[2], turned_rad }
    }
}
