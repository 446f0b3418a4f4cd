//! A run seen period by period: what the axes did in each, and whose way that was.

use arcfeed_shared::segment::Segment;
use arcfeed_shared::units::Micros;

use crate::control::action::MoveContext;
use crate::drives::limits::AXES;
use crate::override_source::OverrideSource;
use crate::simulation::{STEP, Simulation};

use super::trail::{Of, Stretch, at_tip};

/// The run up to now; state.
#[derive(Clone, Debug, Default)]
pub struct Periods {
    axes: Option<[f64; AXES]>,
    /// The block in work last.
    last: Option<(Of, MoveContext, Segment)>,
}

/// A period of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Period {
    /// Its way, one chord.
    pub stretch: Stretch,
    /// The move in work, in machine coordinates.
    pub segment: Segment,
    /// The axes in machine coordinates before and after: X, Y, Z in mm, A, B, C in degrees.
    pub axes: [[f64; AXES]; 2],
}

impl Periods {
    /// Sees a period of the run; nothing before the second one, or before the first block.
    pub fn see<D: OverrideSource>(&mut self, simulation: &Simulation<D>) -> Option<Period> {
        let active = Of::in_work(simulation).map(|(of, segment)| (of, *simulation.context(), *segment));
        self.last = active.or(self.last);
        let axes = simulation.control().actual_axes();
        let (before, (of, context, segment)) = self.axes.replace(axes).zip(self.last)?;
        let places = vec![at_tip(&before, &context), at_tip(&axes, &context)];
        let stretch = Stretch { of, context, from: Micros(simulation.now().0 - STEP.0), to: simulation.now(), places };
        Some(Period { stretch, segment, axes: [before, axes] })
    }
}
