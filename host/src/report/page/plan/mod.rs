//! Report of a plan: the planned path, its safety, and its time compared with the baseline.
//!
//! Plain inputs: all lengths in millimetres, places in the slot frame. The page shows them in the program's unit.

mod grid;

mod picture;

mod tables;

use arcfeed_plan::cutter::CupMill;
use arcfeed_plan::output::baseline::{FlankMilling, Passes, PlannedTime, SlotTime};
use arcfeed_plan::output::limits::StockLimit;
use arcfeed_plan::path::SlotPath;
use arcfeed_units::LengthUnit;

use super::{Page, Section};

/// Content of the report page of a plan.
#[derive(Clone, Debug)]
pub struct PlanReport {
    /// Name of the part.
    pub name: String,
    /// Unit of all lengths on the page.
    pub unit: LengthUnit,
    /// Whether the program may be used, in words.
    pub verdict: PlanVerdict,
    /// Direction of the tool's axis, and positions of the rotary axes.
    pub axis: Axis,
    /// Tool.
    pub mill: CupMill,
    /// Path of one slot.
    pub path: SlotPath,
    /// Reasons for the ends of the turns about A and B1, level by level.
    pub stops: Vec<Stops>,
    /// Limits of the stock.
    pub limits: Vec<StockLimit>,
    /// Times of the planned path and of flank milling.
    pub times: Times,
    /// Clearances between the parts of the tool and the obstacles.
    pub clearances: Vec<Clearance>,
    /// Removed volumes.
    pub removed: Option<Removed>,
    /// Remaining material.
    pub left: Vec<LeftMap>,
    /// Outlines of the surroundings, seen along the tool.
    pub outlines: Vec<Outline>,
}

/// Verdict on a plan: whether its program may be used, with the reasons.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlanVerdict {
    /// The tool collides with nothing and keeps the allowance on the whole path, and the proof has left no part of it undecided.
    pub is_safe: bool,
    /// Sentences of the verdict.
    pub sentences: Vec<String>,
}

/// Tool axis of a plan, and the rotary positions of the rotor under the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// Direction of the tool's axis in the coordinates of the part.
    pub direction: [f64; 3],
    /// Position of the machine's axis A (tilt), the same for all slots, degrees.
    pub tilt_deg: f64,
    /// Position of the machine's axis B for the first slot, degrees.
    pub first_deg: f64,
    /// Number of slots.
    pub slots: u32,
}

/// Reasons why the turns of a level end, as text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Stops {
    /// Reason for the end of the turn about A, at D.
    pub exterior: String,
    /// Reason for the end of the turn about B1, at E.
    pub interior: String,
}

/// Times of the planned path and of the baseline.
#[derive(Clone, Debug)]
pub struct Times {
    /// Time of one slot on the planned path.
    pub planned: PlannedTime,
    /// Baseline, or the reason why there is none.
    pub baseline: Result<BaselineResult, String>,
}

/// Result of the baseline: flank milling of one slot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaselineResult {
    /// Ball-end mill.
    pub mill: FlankMilling,
    /// Levels and passes.
    pub passes: Passes,
    /// Time of the baseline.
    pub time: SlotTime,
}

/// Smallest distance between a part of the tool and an obstacle over the whole path.
#[derive(Clone, Debug, PartialEq)]
pub struct Clearance {
    /// Part of the tool: `ring`, `body`, `holder`.
    pub part: String,
    /// Obstacle.
    pub obstacle: String,
    /// Lower bound of the distance.
    pub certified_mm: f64,
    /// Upper bound: a distance that was found.
    pub found_mm: f64,
    /// Place on the path of the distance that was found, in words.
    pub place: String,
}

/// Volumes that a plan removes from one slot.
#[derive(Clone, Debug, PartialEq)]
pub struct Removed {
    /// Volume to be removed from the slot: between the allowances, within the blank.
    pub available_mm3: f64,
    /// Volume of it that the plan removes.
    pub removed_mm3: f64,
    /// Volume that each level removes, from the top.
    pub levels_mm3: Vec<f64>,
}

/// Remaining material on a surface above its allowance; negative where too much was removed.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftMap {
    /// Name of the surface.
    pub surface: String,
    /// Names of its left, right, lower and upper neighbours.
    pub sides: [String; 4],
    /// Cells in a row.
    pub columns: usize,
    /// Values row by row from below; `None` where the tool never came near.
    pub values_mm: Vec<Option<f64>>,
}

/// Curve of a picture, seen along the tool.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Name of the curve.
    pub name: String,
    /// Points of the curve.
    pub points_mm: Vec<[f64; 2]>,
}

impl PlanReport {
    /// Builds the report page.
    pub fn page(&self) -> Page {
        let section = |heading: &str, body: String| Section { heading: heading.into(), body };
        let mut sections = vec![
            section("Verdict", tables::verdict(&self.verdict)),
            section("Tool and part", tables::setup(self)),
            section("Seen along the tool", picture::slot(self)),
            section("Levels", tables::levels(self)),
            section("Movements and stock", tables::limits(self)),
            section("Time", tables::times(self)),
        ];
        if !self.clearances.is_empty() {
            sections.push(section("Clearances", tables::clearances(self)));
        }
        if let Some(removed) = &self.removed {
            sections.push(section("Removed", tables::removed(removed, self.unit)));
        }
        if !self.left.is_empty() {
            let body = self.left.iter().enumerate().map(|(index, map)| grid::svg(map, index, self.unit)).collect();
            sections.push(section("Left", body));
        }
        Page { title: format!("Plan: {}", self.name), lead: None, viewer: None, sections }
    }
}

/// Unit of lengths and volumes on the page.
#[derive(Clone, Copy, Debug)]
struct Lengths(LengthUnit);

impl Lengths {
    fn label(self) -> &'static str {
        match self.0 {
            LengthUnit::Inch => "in",
            LengthUnit::Mm => "mm",
        }
    }

    fn of(self, length_mm: f64) -> String {
        match self.0 {
            LengthUnit::Inch => format!("{:.4}", length_mm / arcfeed_units::MM_PER_INCH),
            LengthUnit::Mm => format!("{length_mm:.3}"),
        }
    }

    fn feed(self, feed_mm_per_min: f64) -> String {
        match self.0 {
            LengthUnit::Inch => format!("{:.2}", feed_mm_per_min / arcfeed_units::MM_PER_INCH),
            LengthUnit::Mm => format!("{feed_mm_per_min:.1}"),
        }
    }

    /// Volume in cubic inches, or cubic centimetres.
    fn volume(self, volume_mm3: f64) -> String {
        let edge_mm = match self.0 {
            LengthUnit::Inch => arcfeed_units::MM_PER_INCH,
            LengthUnit::Mm => 10.0,
        };
        format!("{:.3}", volume_mm3 / (edge_mm * edge_mm * edge_mm))
    }

    fn volume_label(self) -> &'static str {
        match self.0 {
            LengthUnit::Inch => "in3",
            LengthUnit::Mm => "cm3",
        }
    }
}

#[cfg(test)]
mod tests;
