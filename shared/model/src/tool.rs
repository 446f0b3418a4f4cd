//! Tools: the cup mill, a ring that cuts with its outer or its inner circle, and the ordinary end mill.

use arcfeed_units::{Mm, Nm};

/// Cutter in the spindle, as the feed laws see it: along its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tool {
    /// A cup mill: a ring that cuts with its outer or its inner circle.
    CupMill(CupMill),
    /// An end mill: a disc that cuts with its circumference.
    EndMill(EndMill),
}

impl Tool {
    /// Number of teeth that cut one after the other on one circle.
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

/// A cup mill: a ring-shaped cutter with an outer and an inner cutting circle, seen along its axis.
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

/// Cutting circle of a cup mill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// The outer circle, radius R: its edges advance away from the tool's centre.
    Outer,
    /// The inner circle, radius r: its edges advance towards the tool's centre.
    Inner,
}

impl Edge {
    /// k of the feed law: +1 for the outer circle, whose edges advance away from the tool's centre, -1 for the inner
    /// one.
    #[inline]
    pub const fn advance(self) -> i8 {
        match self {
            Edge::Outer => 1,
            Edge::Inner => -1,
        }
    }
}

impl CupMill {
    /// r0 of the feed law: radius of this cutting circle.
    pub const fn radius(&self, edge: Edge) -> Nm {
        match edge {
            Edge::Outer => self.outer_radius,
            Edge::Inner => self.inner_radius,
        }
    }

    /// Radius of this cutting circle in millimetres, as f32 for computations at each control tick.
    pub fn radius_mm(&self, edge: Edge) -> Mm {
        Mm(self.radius(edge).to_mm() as f32)
    }
}
