//! Stock that a run cuts: each segment of the path removes its material as soon as it is complete.

use arcfeed_shared::kinematics::machine::Machine;
use arcfeed_shared::nc::modal::Pose;
use arcfeed_shared::units::{MicroDeg, Micros, Nm};

use crate::control::action::MoveContext;
use crate::drives::limits::AXES;
use crate::override_source::OverrideSource;
use crate::simulation::{STEP, Simulation};
use crate::stock::tool::Tool;
use crate::stock::workpiece::{Stock, StockError};

use super::placing::{Placing, Unplaced};
use super::rate::Piece;
use super::trail::{Of, Seen, Stretch, Trail};

/// Volume below this fraction of a cell is rounding when a tool moves along its own cut, and does not count.
const ROUNDING_RATIO: f64 = 1e-6;

/// Stock, tool and tolerance.
#[derive(Clone, Debug)]
pub struct CutterSettings {
    /// Workpiece, in the program's coordinates.
    pub stock: Stock,
    /// Cutting part of the tool.
    pub tool: Tool,
    /// Machine that gives the tool's direction under G43.4.
    pub machine: Option<Machine>,
    /// Largest distance of chords from the path of the axes.
    pub tolerance_mm: f64,
}

/// Cutting blocks whose material was not removed, by reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Reason.
    pub why: Unplaced,
    /// First of the blocks.
    pub first: Of,
    /// Number of blocks.
    pub blocks: usize,
    last: u32,
}

/// A stock, with the record of what was removed from it.
#[derive(Debug)]
pub struct Cutter {
    settings: CutterSettings,
    trail: Trail,
    placing: Placing,
    /// Rapids before the first cut.
    waiting: Vec<Stretch>,
    approach: Approach,
    /// Last block in execution.
    last: Option<(Of, MoveContext)>,
    blocks: Vec<Of>,
    pieces: Vec<Piece>,
    left_out: Vec<LeftOut>,
}

/// State of the approach. The position of the axes is unknown at first, so rapids do not count before Z has moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Approach {
    Unknown,
    /// Z moves first in this block.
    Lifts(u32),
    Over,
}

impl LeftOut {
    /// Counts a left-out block, unless it is a rapid.
    pub(super) fn count(list: &mut Vec<LeftOut>, of: Of, why: Unplaced) {
        if of.is_rapid {
            return;
        }
        match list.iter_mut().find(|left_out| left_out.why == why) {
            Some(left_out) => {
                left_out.blocks += usize::from(left_out.last != of.count);
                left_out.last = of.count;
            }
            None => list.push(LeftOut { why, first: of, blocks: 1, last: of.count }),
        }
    }
}

impl Cutter {
    /// State before the run.
    pub fn new(settings: CutterSettings) -> Self {
        let reach_mm = settings.tool.middle_mm().abs() + settings.tool.reach_mm();
        Cutter {
            trail: Trail::new(settings.tolerance_mm, reach_mm),
            settings,
            placing: Placing::default(),
            waiting: Vec::new(),
            approach: Approach::Unknown,
            last: None,
            blocks: Vec::new(),
            pieces: Vec::new(),
            left_out: Vec::new(),
        }
    }

    /// Processes a period of the run.
    ///
    /// # Errors
    /// The remaining stock takes more memory than allowed.
    pub fn see<D: OverrideSource>(&mut self, simulation: &Simulation<D>) -> Result<(), StockError> {
        let active = Of::in_work(simulation).map(|(of, segment)| (of, segment.start));
        if let (Some((of, start)), Some((before, context))) = (active, self.last)
            && of.count != before.count
            && simulation.control().meets_corners()
        {
            let at = Micros(simulation.now().0 - STEP.0 / 2);
            self.go_on(&Seen { at, axes: axes_of(&start), of: before, context })?;
        }
        self.last = active.map(|(of, _)| (of, *simulation.context())).or(self.last);
        let Some((of, context)) = self.last else { return Ok(()) };
        self.go_on(&Seen { at: simulation.now(), axes: simulation.control().actual_axes(), of, context })
    }

    /// Processes the end of the run.
    ///
    /// # Errors
    /// The remaining stock takes more memory than allowed.
    pub fn end(&mut self) -> Result<(), StockError> {
        self.trail.end().map_or(Ok(()), |stretch| self.take(stretch))
    }

    /// Remaining stock.
    pub fn stock(&self) -> &Stock {
        &self.settings.stock
    }

    /// Cutting part of the tool.
    pub fn tool(&self) -> &Tool {
        &self.settings.tool
    }

    /// Largest distance of chords from the path of the axes.
    pub fn tolerance_mm(&self) -> f64 {
        self.settings.tolerance_mm
    }

    /// Blocks that moved while the workpiece's position was known, in order.
    pub fn blocks(&self) -> &[Of] {
        &self.blocks
    }

    /// Volume removed on each segment of the path, in order.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Cutting blocks without a known position on the workpiece.
    pub fn left_out(&self) -> &[LeftOut] {
        &self.left_out
    }

    fn go_on(&mut self, seen: &Seen) -> Result<(), StockError> {
        self.trail.go_on(seen).map_or(Ok(()), |stretch| self.take(stretch))
    }

    fn take(&mut self, stretch: Stretch) -> Result<(), StockError> {
        if stretch.of.is_rapid && self.is_approach(&stretch) {
            return Ok(());
        }
        if stretch.of.is_rapid && !self.placing.is_known() {
            self.waiting.push(stretch);
            return Ok(());
        }
        if !stretch.of.is_rapid {
            self.approach = Approach::Over;
            self.placing.learn(&stretch);
        }
        for waiting in std::mem::take(&mut self.waiting) {
            self.cut(&waiting)?;
        }
        self.cut(&stretch)
    }

    fn is_approach(&mut self, stretch: &Stretch) -> bool {
        let rises = stretch.places.iter().any(|place| place[2] != stretch.places[0][2]);
        self.approach = match self.approach {
            Approach::Unknown if rises => Approach::Lifts(stretch.of.count),
            Approach::Lifts(count) if count != stretch.of.count => Approach::Over,
            other => other,
        };
        self.approach != Approach::Over
    }

    fn cut(&mut self, stretch: &Stretch) -> Result<(), StockError> {
        let CutterSettings { stock, tool, machine, tolerance_mm } = &mut self.settings;
        let sweeps = match self.placing.sweeps(stretch, tool, machine.as_ref(), *tolerance_mm) {
            Ok(sweeps) => sweeps,
            Err(why) => {
                LeftOut::count(&mut self.left_out, stretch.of, why);
                return Ok(());
            }
        };
        let rounding_mm3 = ROUNDING_RATIO * stock.lattice().area_mm2() * stock.lattice().step_mm();
        let removed = stock.cut(tool, &sweeps)?.by_axis.map(|mm3| if mm3 > rounding_mm3 { mm3 } else { 0.0 });
        if self.blocks.last() != Some(&stretch.of) {
            self.blocks.push(stretch.of);
        }
        let (block, way_mm) = (self.blocks.len() - 1, stretch.way_mm());
        self.pieces.push(Piece { block, from: stretch.from, to: stretch.to, way_mm, removed });
        Ok(())
    }
}

fn axes_of(pose: &Pose) -> [f64; AXES] {
    let ([x, y, z], [a, b, c]) = (pose.linear.map(Nm::to_mm), pose.rotary.map(MicroDeg::to_deg));
    [x, y, z, a, b, c]
}
