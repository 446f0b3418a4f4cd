//! The quantity that the chip meter measures for a job, in words.

use arcfeed_milling::cutting::measured_move::ChipMeasure;
use arcfeed_model::job::Job;

/// Measured quantity over its target: what the pages call it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChipQuantity {
    /// Feed at the contour of end mills, of all rules of a job. The chip differs from it: the engaged arc is another one in a corner.
    ContourFeed,
    /// Chip load, at the contact or the thickest one.
    ChipLoad,
}

impl ChipQuantity {
    /// Quantity that is measured under the rules of a job.
    pub fn of(job: &Job) -> Self {
        let mut measures = job.rules.iter().filter_map(|rule| ChipMeasure::of(rule, job.tool_of(rule))).peekable();
        let is_contour = measures.peek().is_some() && measures.all(|measure| measure == ChipMeasure::Contour);
        if is_contour { ChipQuantity::ContourFeed } else { ChipQuantity::ChipLoad }
    }

    /// Name of its column in the data of the viewer.
    pub const fn column(self) -> &'static str {
        match self {
            ChipQuantity::ContourFeed => "contour",
            ChipQuantity::ChipLoad => "chip",
        }
    }

    /// Name for a person.
    pub const fn words(self) -> &'static str {
        match self {
            ChipQuantity::ContourFeed => "feed at the contour",
            ChipQuantity::ChipLoad => "chip load",
        }
    }
}
