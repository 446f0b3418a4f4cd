//! Tools: the cup mill, a ring that cuts with its outer or its inner circle, and the ordinary end mill.

use arcfeed_units::{Mm, Nm};

/// Cutter in the spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tool {
    /// A ring.
    CupMill(CupMill),
    /// A disc.
    EndMill(EndMill),
}

impl Tool {
    /// Number of teeth that cut.
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
    /// r: cutting radius.
    pub radius: Nm,
    /// Number of teeth.
    pub teeth: u16,
}

/// A ring-shaped cutter, seen along its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CupMill {
    /// R: radius of the outer cutting circle.
    pub outer_radius: Nm,
    /// r: radius of the inner cutting circle.
    pub inner_radius: Nm,
    /// Number of teeth that cut on one side: half of the inserts if they alternate between the outer and the inner
    /// circle.
    pub active_teeth: u16,
}

/// Cutting circle of a ring.
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

    /// Cutting radius in millimetres, for the tick.
    pub fn radius_mm(&self, edge: Edge) -> Mm {
        Mm(self.radius(edge).to_mm() as f32)
    }
}
