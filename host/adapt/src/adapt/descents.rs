//! Moves that descend along the tool's axis or at an angle to it, under the plunge law: which moves these are, and the table of permitted
//! feeds for each.

use arcfeed_law::table::Table;
use arcfeed_model::governed::Descent;
use arcfeed_model::job::{ToolAxis, ToolSetup};
use arcfeed_model::tool::Tool;
use arcfeed_nc::segment::Segment;
use arcfeed_units::{Nm, RevPerMin};

use super::PlanReason;
use crate::axial_law::{AxialLaw, Edges, floor_mm2, torque_max_n_m};
use crate::engagement::EngagementMap;
use crate::engagement::sections::{DescentLookup, MappedDescent, TangentialForce};
use crate::job::{Plunge, SpindleLimits};

/// Finds the descending moves of a program, in its order, and pairs each with the plunge law and with its sections in the engagement map.
/// It keeps its place in the map between calls.
#[derive(Clone, Debug)]
pub struct Descents<'a> {
    law: Law,
    lookup: DescentLookup<'a>,
}

#[derive(Clone, Copy, Debug)]
struct Law {
    plunge: Plunge,
    limits: SpindleLimits,
    force: TangentialForce,
}

/// A descending move, the plunge law that governs it, and the sections of tool and material along it.
#[derive(Clone, Copy, Debug)]
pub struct Descending<'a> {
    law: Law,
    /// Sections of the move; `None` if the engagement map has none of it.
    pub mapped: Option<&'a MappedDescent>,
    length_mm: f64,
    descent: Descent,
}

impl<'a> Descents<'a> {
    /// State before the first move. `None` if the job has no `[plunge]` or there is no map.
    pub fn of(plunge: Option<(Plunge, SpindleLimits)>, map: Option<&'a EngagementMap>) -> Option<Self> {
        let ((plunge, limits), map) = plunge.zip(map)?;
        let law = Law { plunge, limits, force: map.descents.force };
        Some(Descents { law, lookup: map.descents.lookup() })
    }

    /// The descending move for the next segment of the program. `None` if the segment is not one: it does not descend into material, is a
    /// ramp and the job does not govern ramps, or a cut rule governs it (`matched`).
    pub fn next<R>(&mut self, segment: &Segment, matched: &Result<R, PlanReason>) -> Option<Descending<'a>> {
        let is_free = matches!(matched, Err(PlanReason::NoRule | PlanReason::Axial));
        let descent = Descent::of(segment, ToolAxis::Z).filter(|_| is_free)?;
        if !descent.is_plunge() && !self.law.plunge.has_ramps {
            return None;
        }
        let mapped = self.lookup.next(segment);
        // A move through air leaves no chip, and the next one finds material no nearer than its own map says.
        if mapped.is_some_and(MappedDescent::is_in_air) {
            return None;
        }
        Some(Descending { law: self.law, mapped, length_mm: segment.length_mm(), descent })
    }
}

impl Descending<'_> {
    /// Table of the permitted path of the tool centre per tooth along the move, at this spindle speed. `None` if no feed keeps the
    /// spindle's torque and power, or the map has no sections of the move.
    pub fn table(&self, setup: &ToolSetup, spindle: RevPerMin) -> Option<Table> {
        let Law { plunge, limits, force } = self.law;
        let radius = match &setup.tool {
            Tool::CupMill(cup) => cup.outer_radius,
            Tool::EndMill(mill) => mill.radius,
        };
        let law = AxialLaw {
            feed_per_tooth_mm: plunge.feed_per_tooth_mm,
            edges: Edges::of(&setup.tool),
            diameter_mm: 2.0 * Nm::to_mm(radius),
            force,
            torque_max_n_m: torque_max_n_m(limits.torque_n_m, limits.power_w, f64::from(spindle.0)),
            floor_mm2: floor_mm2(&setup.tool),
        };
        law.table(self.mapped?, self.length_mm, (self.descent.sine_ratio, self.descent.is_plunge()))
    }
}
