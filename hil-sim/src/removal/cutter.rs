//! Stock that a run cuts: each section of the path removes its material as soon as it is complete.

use arcfeed_kinematics::machine::Machine;
use arcfeed_nc::machining::ToolInSpindle;
use arcfeed_nc::modal::Pose;
use arcfeed_units::{MicroDeg, Micros, Nm};

use crate::simulated_machine::{STEP, SimulatedMachine};
use arcfeed_control::action::{MoveContext, WorkpiecePlace};
use arcfeed_control::drives::limits::AXES;
use arcfeed_dexel::tool::Tool;
use arcfeed_dexel::workpiece::{Stock, StockError};

use super::placement::{LeftOutReason, WorkpiecePlacement};
use super::rate::Piece;
use super::trail::{AxisSample, BlockRef, PathSection, Trail};

/// Volume below this fraction of a cell is rounding when a tool moves along its own cut, and does not count.
const ROUNDING_RATIO: f64 = 1e-6;

/// Settings of a [`StockCutter`]: stock, tools and tolerance.
#[derive(Clone, Debug)]
pub struct StockCutterSettings {
    /// Workpiece, in the program's coordinates.
    pub stock: Stock,
    /// Cutting part of the tool, or of the first tool of several.
    pub tool: Tool,
    /// The other tools, with their numbers; `None` if the program has only one tool, which then makes all cuts.
    pub numbered: Option<NumberedTools>,
    /// Machine whose kinematics give the tool's direction under G43.4; `None` if unknown.
    pub machine: Option<Machine>,
    /// Largest distance of the chords, which replace the executed path, from that path.
    pub tolerance_mm: f64,
}

/// Several tools, found by the T numbers of the program.
#[derive(Clone, Debug)]
pub struct NumberedTools {
    /// T number of the first tool.
    pub first: Option<i64>,
    /// T numbers and cutting parts of the other tools.
    pub others: Vec<(Option<i64>, Tool)>,
}

impl StockCutterSettings {
    /// Tool of the settings that is in the spindle.
    fn tool_in(&self, spindle: ToolInSpindle) -> Option<&Tool> {
        let Some(numbered) = &self.numbered else { return Some(&self.tool) };
        let number = match spindle {
            ToolInSpindle::Number(number) => number,
            // The operator has loaded the only tool.
            ToolInSpindle::Unstated => return numbered.others.is_empty().then_some(&self.tool),
            ToolInSpindle::Unknown => return None,
        };
        let first = (numbered.first == Some(number)).then_some(&self.tool);
        first.or_else(|| numbered.others.iter().find(|(own, _)| *own == Some(number)).map(|(_, tool)| tool))
    }

    /// Distance from the tip to the farthest point of any tool.
    fn reach_mm(&self) -> f64 {
        let others = self.numbered.iter().flat_map(|numbered| numbered.others.iter().map(|(_, tool)| tool));
        let reach = |tool: &Tool| tool.middle_mm().abs() + tool.reach_mm();
        others.map(reach).fold(reach(&self.tool), f64::max)
    }
}

/// Cutting blocks whose material was not removed for one and the same reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Reason why it was not removed.
    pub reason: LeftOutReason,
    /// First of these blocks.
    pub first: BlockRef,
    /// Number of these blocks.
    pub blocks: usize,
    last: u32,
}

/// Stock that is cut along the executed path of a run, with a record of the removed material.
#[derive(Debug)]
pub struct StockCutter {
    settings: StockCutterSettings,
    trail: Trail,
    placement: WorkpiecePlacement,
    /// Rapids before the first cut.
    waiting: Vec<PathSection>,
    approach: ApproachState,
    /// Last section from an unknown position: the next section begins at its end, which is known then.
    arrival: Option<PathSection>,
    /// Last block in execution.
    last: Option<(BlockRef, MoveContext)>,
    blocks: Vec<BlockRef>,
    pieces: Vec<Piece>,
    left_out: Vec<LeftOut>,
}

/// State of the approach. The position of the axes is unknown at first, so rapids do not count before Z has moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ApproachState {
    Unknown,
    /// Z moves first in this block.
    Lifts(u32),
    Over,
}

impl LeftOut {
    /// Counts a left-out block; of rapids only those to and from machine positions, as all others take material by fault alone.
    pub(super) fn count(list: &mut Vec<LeftOut>, block: BlockRef, reason: LeftOutReason) {
        if block.is_rapid && reason != LeftOutReason::MachinePosition {
            return;
        }
        match list.iter_mut().find(|left_out| left_out.reason == reason) {
            Some(left_out) => {
                left_out.blocks += usize::from(left_out.last != block.count);
                left_out.last = block.count;
            }
            None => list.push(LeftOut { reason, first: block, blocks: 1, last: block.count }),
        }
    }
}

impl StockCutter {
    /// Stock cutter before the run.
    pub fn new(settings: StockCutterSettings) -> Self {
        StockCutter {
            trail: Trail::new(settings.tolerance_mm, settings.reach_mm()),
            settings,
            placement: WorkpiecePlacement::default(),
            waiting: Vec::new(),
            approach: ApproachState::Unknown,
            arrival: None,
            last: None,
            blocks: Vec::new(),
            pieces: Vec::new(),
            left_out: Vec::new(),
        }
    }

    /// Processes one period of the run: removes the material of the path sections that it completes.
    ///
    /// # Errors
    /// The remaining stock takes more memory than allowed.
    pub fn observe(&mut self, simulation: &SimulatedMachine) -> Result<(), StockError> {
        let active = BlockRef::in_execution(simulation).map(|(block, segment)| (block, segment.start));
        if let (Some((block, start)), Some((before, context))) = (active, self.last)
            && block.count != before.count
            && simulation.control().meets_corners()
        {
            let at = Micros(simulation.now().0 - STEP.0 / 2);
            self.add_sample(&AxisSample { at, axes: axes_of(&start), block: before, context })?;
        }
        self.last = active.map(|(block, _)| (block, *simulation.context())).or(self.last);
        let Some((block, context)) = self.last else { return Ok(()) };
        self.add_sample(&AxisSample { at: simulation.now(), axes: simulation.control().actual_axes(), block, context })
    }

    /// Processes the end of the run: removes the material of the last path section.
    ///
    /// # Errors
    /// The remaining stock takes more memory than allowed.
    pub fn end(&mut self) -> Result<(), StockError> {
        self.trail.end().map_or(Ok(()), |section| self.process_section(section))
    }

    /// Remaining stock.
    pub fn stock(&self) -> &Stock {
        &self.settings.stock
    }

    /// Cutting part of the tool, or of the first of several.
    pub fn tool(&self) -> &Tool {
        &self.settings.tool
    }

    /// Cutting parts of all tools.
    pub fn tools(&self) -> impl Iterator<Item = &Tool> {
        let others = self.settings.numbered.iter().flat_map(|numbered| &numbered.others);
        std::iter::once(&self.settings.tool).chain(others.map(|(_, tool)| tool))
    }

    /// Largest distance of chords from the path of the axes.
    pub fn tolerance_mm(&self) -> f64 {
        self.settings.tolerance_mm
    }

    /// Blocks that moved while the workpiece's position was known, in order.
    pub fn blocks(&self) -> &[BlockRef] {
        &self.blocks
    }

    /// Material removed on each section of the path, in order of execution.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Cutting blocks whose material was not removed, by reason.
    pub fn left_out(&self) -> &[LeftOut] {
        &self.left_out
    }

    fn add_sample(&mut self, sample: &AxisSample) -> Result<(), StockError> {
        self.trail.add(sample).map_or(Ok(()), |section| self.process_section(section))
    }

    fn process_section(&mut self, section: PathSection) -> Result<(), StockError> {
        if section.block.is_rapid && self.is_approach(&section) {
            return Ok(());
        }
        if section.block.is_rapid && !self.placement.is_known() {
            self.waiting.push(section);
            return Ok(());
        }
        if !section.block.is_rapid {
            self.approach = ApproachState::Over;
            self.placement.locate(&section);
        }
        for waiting in std::mem::take(&mut self.waiting) {
            self.cut(&waiting)?;
        }
        self.cut(&section)
    }

    fn is_approach(&mut self, section: &PathSection) -> bool {
        let rises = section.positions.iter().any(|position| position[2] != section.positions[0][2]);
        self.approach = match self.approach {
            ApproachState::Unknown if rises => ApproachState::Lifts(section.block.count),
            ApproachState::Lifts(count) if count != section.block.count => ApproachState::Over,
            other => other,
        };
        self.approach != ApproachState::Over
    }

    /// Cuts a section; after one from an unknown position first where that ended, as only its end is known.
    fn cut(&mut self, section: &PathSection) -> Result<(), StockError> {
        if section.context.place != WorkpiecePlace::Known {
            self.arrival = Some(section.clone());
        } else if let Some(mut arrival) = self.arrival.take() {
            let end = arrival.positions.last().copied().unwrap_or_default();
            (arrival.positions, arrival.context.place) = (vec![end; 2], WorkpiecePlace::Known);
            self.remove(&arrival)?;
        }
        self.remove(section)
    }

    fn remove(&mut self, section: &PathSection) -> Result<(), StockError> {
        let Some(tool) = self.settings.tool_in(section.context.machining.tool).cloned() else {
            LeftOut::count(&mut self.left_out, section.block, LeftOutReason::OtherTool);
            return Ok(());
        };
        let StockCutterSettings { stock, machine, tolerance_mm, .. } = &mut self.settings;
        let sweeps = match self.placement.sweeps(section, &tool, machine.as_ref(), *tolerance_mm) {
            Ok(sweeps) => sweeps,
            Err(reason) => {
                LeftOut::count(&mut self.left_out, section.block, reason);
                return Ok(());
            }
        };
        let rounding_mm3 = ROUNDING_RATIO * stock.lattice().area_mm2() * stock.lattice().step_mm();
        let removed = stock.cut(&tool, &sweeps)?.by_axis.map(|mm3| if mm3 > rounding_mm3 { mm3 } else { 0.0 });
        if self.blocks.last() != Some(&section.block) {
            self.blocks.push(section.block);
        }
        let (block, path_mm) = (self.blocks.len() - 1, section.path_mm());
        self.pieces.push(Piece { block, from: section.from, to: section.to, path_mm, removed });
        Ok(())
    }
}

fn axes_of(pose: &Pose) -> [f64; AXES] {
    let ([x, y, z], [a, b, c]) = (pose.linear.map(Nm::to_mm), pose.rotary.map(MicroDeg::to_deg));
    [x, y, z, a, b, c]
}
