//! A run seen period by period: what the axes did in each, and whose way that was.

use arcfeed_shared::segment::Segment;
use arcfeed_shared::units::Micros;

use crate::control::action::Manner;
use crate::decider::Decider;
use crate::drives::limits::AXES;
use crate::rig::{Rig, STEP};

use super::trail::{Of, Stretch, at_tip};

/// The run up to now; state.
#[derive(Clone, Debug, Default)]
pub struct Periods {
    axes: Option<[f64; AXES]>,
    /// The block in work last.
    last: Option<(Of, Manner, Segment)>,
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
    pub fn see<D: Decider>(&mut self, rig: &Rig<D>) -> Option<Period> {
        let active = Of::in_work(rig).map(|(of, segment)| (of, *rig.manner(), *segment));
        self.last = active.or(self.last);
        let axes = rig.control().actual_axes();
        let (before, (of, manner, segment)) = self.axes.replace(axes).zip(self.last)?;
        let places = vec![at_tip(&before, &manner), at_tip(&axes, &manner)];
        let stretch = Stretch { of, manner, from: Micros(rig.now().0 - STEP.0), to: rig.now(), places };
        Some(Period { stretch, segment, axes: [before, axes] })
    }
}
