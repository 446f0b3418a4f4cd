//! Periods (milliseconds) of a run one by one: motion of the axes in each, and the block to which it belongs.

use arcfeed_nc::segment::Segment;
use arcfeed_units::Micros;

use crate::simulated_machine::{STEP, SimulatedMachine};
use arcfeed_control::action::MoveContext;
use arcfeed_control::drives::limits::AXES;

use super::trail::{BlockRef, PathSection, at_tip};

/// Observer of a run that returns its periods one by one. Keeps the last period between calls.
#[derive(Clone, Debug, Default)]
pub struct Periods {
    axes: Option<[f64; AXES]>,
    /// Last block in execution.
    last: Option<(BlockRef, MoveContext, Segment)>,
}

/// One simulation period of a run, with the motion of the axes in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Period {
    /// Path of the period, as one chord.
    pub section: PathSection,
    /// Move in execution, in machine coordinates.
    pub segment: Segment,
    /// Axes in machine coordinates before and after: X, Y, Z in mm, A, B, C in degrees.
    pub axes: [[f64; AXES]; 2],
}

impl Periods {
    /// Processes the period that the simulation has just computed; `None` in the first one, and before the first block.
    pub fn observe(&mut self, simulation: &SimulatedMachine) -> Option<Period> {
        if let Some((block, segment)) = BlockRef::in_execution(simulation) {
            self.last = Some((block, *simulation.context(), *segment));
        }
        let axes = simulation.control().actual_axes();
        let before = self.axes.replace(axes)?;
        let &(block, context, segment) = self.last.as_ref()?;
        let positions = vec![at_tip(&before, &context), at_tip(&axes, &context)];
        let section =
            PathSection { block, context, from: Micros(simulation.now().0 - STEP.0), to: simulation.now(), positions };
        Some(Period { section, segment, axes: [before, axes] })
    }
}
