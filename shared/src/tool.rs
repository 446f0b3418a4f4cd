//! Tools: the cup mill, a ring that cuts with its outer or its inner circle, and the ordinary end mill.

use crate::units::{Mm, Nm};

/// What turns in the spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tool {
    /// A ring.
    CupMill(CupMill),
    /// A disc.
    EndMill(EndMill),
}

impl Tool {
    /// Teeth that cut.
    pub const fn active_teeth(&self) -> u16 {
        match self {
            Tool::CupMill(mill) => mill.active_teeth,
            Tool::EndMill(mill) => mill.teeth,
        }
    }
}

/// An ordinary end mill, seen along its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndMill {
    /// r.
    pub radius: Nm,
    /// Its teeth.
    pub teeth: u16,
}

/// A ring-shaped cutter, seen along its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CupMill {
    /// R.
    pub outer_radius: Nm,
    /// r.
    pub inner_radius: Nm,
    /// Teeth that cut on one side: half of the inserts where they alternate outside and inside.
    pub active_teeth: u16,
}

/// The circle of the ring that cuts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// Radius R; edges advance outward.
    Outer,
    /// Radius r; edges advance inward.
    Inner,
}

impl Edge {
    /// k of the feed law: +1 if the edge advances away from the tool's centre, -1 if towards it.
    #[inline]
    pub const fn advance(self) -> i8 {
        match self {
            Edge::Outer => 1,
            Edge::Inner => -1,
        }
    }
}

impl CupMill {
    /// r0 of the feed law: the radius of the circle that cuts.
    pub const fn radius(&self, edge: Edge) -> Nm {
        match edge {
            Edge::Outer => self.outer_radius,
            Edge::Inner => self.inner_radius,
        }
    }

    /// The same in millimetres, for the tick.
    pub fn radius_mm(&self, edge: Edge) -> Mm {
        Mm(self.radius(edge).to_mm() as f32)
    }
}
