//! The report of a plan: what was planned, whether it is safe, and what it is worth.
//!
//! Plain inputs, all lengths in millimetres, places in the slot frame; the page shows them in the program's unit.

mod grid;

mod picture;

mod tables;

use arcfeed_plan::cutter::CupMill;
use arcfeed_plan::output::baseline::{FlankMilling, Passes, PlannedTime, SlotTime};
use arcfeed_plan::output::limits::StockLimit;
use arcfeed_plan::path::SlotPath;
use arcfeed_shared::units::LengthUnit;

use super::{Page, Section};

/// Everything that the page shows.
#[derive(Clone, Debug)]
pub struct PlanReport {
    /// The part's name.
    pub name: String,
    /// Of all lengths shown.
    pub unit: LengthUnit,
    /// In words.
    pub verdict: Verdict,
    /// How the rotor lies.
    pub axis: Axis,
    /// The tool.
    pub mill: CupMill,
    /// The path of one slot.
    pub path: SlotPath,
    /// What ended the turns about A and B1, level by level.
    pub stops: Vec<Stops>,
    /// Where the stock ends.
    pub limits: Vec<StockLimit>,
    /// Times.
    pub times: Times,
    /// How near the tool comes to everything.
    pub clearances: Vec<Clearance>,
    /// What it removes.
    pub removed: Option<Removed>,
    /// What it leaves.
    pub left: Vec<LeftMap>,
    /// What there is around the tool, seen along it.
    pub outlines: Vec<Outline>,
}

/// Whether the plan may be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// Nothing is touched, and nothing is left unsaid.
    pub is_safe: bool,
    /// A sentence each.
    pub sentences: Vec<String>,
}

/// How the rotor lies under the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// The tool's axis in the part frame.
    pub direction: [f64; 3],
    /// A, of all slots.
    pub tilt_deg: f64,
    /// B of the first slot.
    pub first_deg: f64,
    /// How many slots.
    pub slots: u32,
}

/// What ended the turns of a level.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Stops {
    /// That about A, at D.
    pub exterior: String,
    /// That about B1, at E.
    pub interior: String,
}

/// The path's time and the baseline's.
#[derive(Clone, Debug)]
pub struct Times {
    /// One slot on the planned path.
    pub planned: PlannedTime,
    /// The baseline, or why there is none.
    pub baseline: Result<Baseline, String>,
}

/// Flank milling of one slot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Baseline {
    /// The mill.
    pub mill: FlankMilling,
    /// Its levels and passes.
    pub passes: Passes,
    /// Its time.
    pub time: SlotTime,
}

/// The least distance between a part of the tool and an obstacle over the whole way.
#[derive(Clone, Debug, PartialEq)]
pub struct Clearance {
    /// `ring`, `body`, `holder`.
    pub part: String,
    /// From what.
    pub obstacle: String,
    /// It is at least this.
    pub certified_mm: f64,
    /// And at most this, which was found.
    pub found_mm: f64,
    /// Where on the way.
    pub place: String,
}

/// Volumes of one slot.
#[derive(Clone, Debug, PartialEq)]
pub struct Removed {
    /// Between the allowances, within the blank.
    pub available_mm3: f64,
    /// Of that.
    pub removed_mm3: f64,
    /// By each level, from the top.
    pub levels_mm3: Vec<f64>,
}

/// What is left on a surface above its allowance; negative where too much was taken.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftMap {
    /// Which surface.
    pub surface: String,
    /// What lies to the left, the right, below and above.
    pub sides: [String; 4],
    /// Cells in a row.
    pub columns: usize,
    /// Row by row from below; nothing where the tool was never near.
    pub values_mm: Vec<Option<f64>>,
}

/// A curve seen along the tool.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// What it is.
    pub name: String,
    /// Its points.
    pub points_mm: Vec<[f64; 2]>,
}

impl PlanReport {
    /// The page.
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
        Page { title: format!("Plan: {}", self.name), sections }
    }
}

/// Lengths and volumes as the page shows them.
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
            LengthUnit::Inch => format!("{:.4}", length_mm / arcfeed_shared::units::MM_PER_INCH),
            LengthUnit::Mm => format!("{length_mm:.3}"),
        }
    }

    fn feed(self, feed_mm_per_min: f64) -> String {
        match self.0 {
            LengthUnit::Inch => format!("{:.2}", feed_mm_per_min / arcfeed_shared::units::MM_PER_INCH),
            LengthUnit::Mm => format!("{feed_mm_per_min:.1}"),
        }
    }

    /// Cubic inches, or cubic centimetres.
    fn volume(self, volume_mm3: f64) -> String {
        let edge_mm = match self.0 {
            LengthUnit::Inch => arcfeed_shared::units::MM_PER_INCH,
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
