//! Everything from which a new job file is written: survey of the program, proposal and given answers.

use arcfeed_model::cut::ContourSide;
use arcfeed_units::LengthUnit;

use super::answers::{Answers, Milling};
use super::groups::Group;
use super::proposal::{LikelyTool, Movement, Proposal, ProposedCut, ProposedTool};
use super::survey::Survey;
use super::wording::length;

/// An arc is smaller than a tool if its radius is less than the tool's by this, mm: more than coordinates are rounded.
const SMALLER_MIN_MM: f64 = 0.01;

/// Difference of two diameters that counts as none, mm.
const SAME_DIAMETER_MM: f64 = 0.01;

/// Input for a new job file: what the program shows, and the given values.
#[derive(Clone, Copy, Debug)]
pub struct Findings<'a> {
    /// Path of the program, as it is written in the job file.
    pub program: &'a str,
    /// Survey of the program: unit, speeds, tools, arcs.
    pub survey: &'a Survey,
    /// Arcs of the program, grouped by tool, plane, direction and radius.
    pub groups: &'a [Group],
    /// Proposed tools and cut rules.
    pub proposal: &'a Proposal,
    /// Values given on the command line.
    pub answers: &'a Answers,
    /// Keys and values of the table `[control]`.
    pub control: &'a [(&'static str, String)],
}

impl Findings<'_> {
    /// Unit of the program; inches where it is unknown.
    pub fn unit(&self) -> LengthUnit {
        let Survey { unit, likely_unit, .. } = self.survey;
        unit.or(self.answers.units).or(*likely_unit).unwrap_or(LengthUnit::Inch)
    }

    /// Whether the tool's target feed is the programmed F.
    pub fn follows_program(&self, tool: &ProposedTool) -> bool {
        // Without rules nothing is governed, and nothing has to be answered.
        let has_own = !tool.cuts.is_empty() && Answers::of(&self.answers.feeds_per_tooth, tool.number).is_some();
        let mode = self.answers.mode.as_deref();
        let has_cup = self.proposal.tools.iter().any(ProposedTool::is_cup_mill);
        !tool.is_cup_mill() && !has_own && mode.map_or(!has_cup, |mode| mode == "rewrite-only")
    }

    /// Diameter of an end mill, given or from a comment, mm; `None` if it is unknown.
    pub fn diameter_mm(&self, tool: &ProposedTool) -> Option<f64> {
        let given = Answers::of(&self.answers.diameters, tool.number).map(|length| length.to_mm(self.unit()));
        given.or(tool.note.as_ref().and_then(|note| note.data.diameter_mm))
    }

    /// Hint for a tool all of whose arcs are taken for outside arcs, but are smaller than the tool itself: no contour has such an outside.
    pub fn milling_hint(&self, tool: &ProposedTool) -> Option<String> {
        let radius_mm = self.diameter_mm(tool)? / 2.0;
        let is_outside = |cut: &ProposedCut| cut.movement == Movement::Contour(ContourSide::Outside);
        let mut groups = tool.cuts.iter().flat_map(|cut| &cut.groups).map(|index| &self.groups[*index]);
        let are_small = groups.all(|group| group.radius_mm < radius_mm - SMALLER_MIN_MM);
        let are_outside = !tool.cuts.is_empty() && tool.cuts.iter().all(is_outside);
        (are_outside && are_small).then(|| {
            let number = tool.number.map_or("the tool".into(), |number| format!("T{number}"));
            let other = if self.answers.milling == Milling::Climb { "conventional" } else { "climb" };
            format!(
                "{number} keeps its feeds: all its arcs are smaller than its radius, so they run around no outside of a contour; if the \
                 tool mills on their inner side: --milling {other}"
            )
        })
    }

    /// Warning of a given diameter that another one in the comment, or the path, contradicts.
    pub fn doubtful_diameter(&self, tool: &ProposedTool) -> Option<String> {
        let mm = Answers::of(&self.answers.diameters, tool.number)?.to_mm(self.unit());
        let note = tool.note.as_ref().and_then(|note| Some((note.line, note.data.diameter_mm?)));
        let in_unit = |mm: f64| format!("{} {}", length(mm, self.unit()), self.unit().label());
        let [across, along] =
            [0, 1].map(|axis: usize| self.survey.extents_mm[axis].map_or(0.0, |[low, high]| high - low));
        let reason = match note {
            Some((_, noted_mm)) if (noted_mm - mm).abs() <= SAME_DIAMETER_MM => return None,
            Some((line, noted_mm)) => format!("the comment in line {line} says {}", in_unit(noted_mm)),
            None if mm > across.max(along) => {
                format!("its centre moves within X {} and Y {} only", in_unit(across), in_unit(along))
            }
            None => return None,
        };
        let number = tool.number.map_or("the tool".into(), |number| format!("T{number}"));
        Some(format!("warning: {number}: diameter {}, but {reason}: check it", in_unit(mm)))
    }

    /// Number of teeth, given or from a comment; `None` if it is unknown.
    pub fn teeth(&self, tool: &ProposedTool) -> Option<u16> {
        Answers::of(&self.answers.teeth, tool.number).or(tool.note.as_ref().and_then(|note| note.data.teeth))
    }
}

impl ProposedTool {
    /// Whether the tool is a cup mill.
    pub fn is_cup_mill(&self) -> bool {
        matches!(self.kind, LikelyTool::CupMill { .. })
    }
}
