//! Feed laws: which feed per tooth the tool's *centre* needs so that its cutting circumference keeps its own.

pub mod step;

pub mod circumference;

use arcfeed_shared::cut::CutRule;
use arcfeed_shared::fmath;
use arcfeed_shared::job::{Job, LawKind};
use arcfeed_shared::segment::Segment;

use circumference::Circumference;

/// A law prepared for one segment.
pub trait FeedLaw {
    /// The feed per tooth at the centre wanted where the tool's centre lies in `direction` (unit vector from the
    /// rotation centre, in the arc's plane).
    ///
    /// # Errors
    /// Why the law has no wish there.
    fn wish(&self, direction: [f32; 2]) -> Result<Wish, NoWish>;
}

/// What a law wants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wish {
    /// Path of the tool's centre per tooth, along the arc, mm.
    pub path_mm_per_tooth: f32,
    /// Direction of the contact from the tool's centre, of any length: its components along the edge's advance and towards
    /// the rotation centre.
    pub contact: [f32; 2],
}

impl Wish {
    /// Angle of the contact from the direction of the rotation centre towards the cutting side, radians in (0, pi/2]. For
    /// reports: the tick has no use for it and does not pay for it.
    pub fn contact_rad(&self) -> f32 {
        let [advance, towards] = self.contact;
        fmath::atan2(advance, towards)
    }
}

/// Why a law has no wish.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NoWish {
    /// The cutting circle does not meet the stock line.
    NoContact,
    /// It meets it only where the edge recedes or more than 90 degrees from the rotation centre.
    OutsideValidity,
    /// The wanted chip is thicker than any feed could make it there: no feed is too high for it.
    ChipUnreachable,
    /// An input is not a number, or a radius or feed per tooth is not positive.
    BadInput,
}

/// The law of one segment, or that it has none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SegmentLaw {
    /// Constant feed per tooth on the circumference.
    Circumference(Circumference),
    /// No law governs this segment: it runs as programmed.
    None,
}

impl SegmentLaw {
    /// The job's law for a segment that `rule` speaks of.
    pub fn for_segment(segment: &Segment, rule: Option<&CutRule>, job: &Job) -> Self {
        match (job.law, segment.arc(), rule) {
            (LawKind::Circumference, Some(arc), Some(rule)) => {
                let radius = job.tool.radius_mm(rule.edge);
                let law = Circumference::for_arc(arc, radius, rule.edge, &rule.stock, job.feed_per_tooth);
                SegmentLaw::Circumference(law)
            }
            _ => SegmentLaw::None,
        }
    }
}
