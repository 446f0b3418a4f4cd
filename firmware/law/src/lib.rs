#![doc = include_str!("../README.md")]
//!
//! Feed laws: the feed per tooth of the tool's *centre* that gives its edges their target.
//!
//! Each law has its own file. It is prepared for a segment and evaluated along it once, before the tool is on it. Laws
//! are independent of limits, overrides and time.
#![cfg_attr(not(test), no_std)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

pub mod step;

pub mod region;

pub mod circumference;

pub mod engaged_arc;

pub mod contour;

pub mod engagement;

pub mod table;

pub mod move_table;

use arcfeed_model::cut::{ContourSide, CutRule, Work};
use arcfeed_model::job::{Job, LawKind, ToolAxis};
use arcfeed_model::stock::Stock;
use arcfeed_model::tool::{CupMill, Edge, EndMill, Tool};
use arcfeed_nc::segment::Segment;
use arcfeed_units::fmath;
use arcfeed_units::{Mm, MmPerTooth, Nm};

use circumference::Circumference;
use contour::{Contour, ContourLimits};
use engaged_arc::{EdgePolicy, EngagedArc, Ring};
use engagement::{Engagement, PathShape};
use move_table::MoveTable;
use region::Region;
use table::Table;

/// A feed law, prepared for one segment: says at each place which feed per tooth the tool's centre needs.
pub trait FeedLaw {
    /// Demand of the law at a place of the segment.
    ///
    /// # Errors
    /// Reason why the law has no demand there.
    fn demand(&self, place: &Place) -> Result<FeedDemand, NoDemand>;

    /// Whether the demand is the same at every place of the segment.
    fn is_uniform(&self) -> bool {
        false
    }
}

/// Position and direction of motion of the tool's centre on its segment, in the plane of the segment.
///
/// The origin is the rotation centre A of an arc, or the start of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Position of the tool's centre, mm.
    pub center_mm: [f32; 2],
    /// Unit vector in the direction of motion, v.
    pub motion: [f32; 2],
    /// Unit vector from the tool's centre towards the rotation centre; on a line, to the left of the motion.
    pub towards: [f32; 2],
    /// Path from the segment's start, mm.
    pub travelled_mm: f32,
}

impl Place {
    /// Place on an arc: `direction` is the unit vector from the rotation centre to the tool's centre, `turn_ratio` is
    /// +1 for a counter-clockwise and -1 for a clockwise arc.
    #[inline(always)]
    pub fn on_arc(direction: [f32; 2], turn_ratio: f32, radius_mm: f32, travelled_mm: f32) -> Self {
        let [x, y] = direction;
        Place {
            center_mm: [radius_mm * x, radius_mm * y],
            motion: [-turn_ratio * y, turn_ratio * x],
            towards: [-x, -y],
            travelled_mm,
        }
    }

    /// Place on a line: `motion` is the unit vector of its direction in the plane.
    pub fn on_line(motion: [f32; 2], travelled_mm: f32) -> Self {
        let [x, y] = motion;
        Place { center_mm: [travelled_mm * x, travelled_mm * y], motion, towards: [-y, x], travelled_mm }
    }
}

/// Demand of a feed law at a place: the path of the tool's centre per tooth, and the contact point for which it is
/// computed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FeedDemand {
    /// Path of the tool's centre per tooth, mm.
    pub path_mm_per_tooth: f32,
    /// Unit vector from the tool's centre to that contact point. Components: in the direction in which the edge
    /// advances, and towards the rotation centre.
    pub contact: [f32; 2],
}

impl FeedDemand {
    /// Angle from the direction towards the rotation centre to the contact point, positive towards the side on which
    /// the edges advance, radians.
    pub fn contact_rad(&self) -> f32 {
        let [advance, towards] = self.contact;
        fmath::atan2(advance, towards)
    }
}

/// Reason why a law demands no feed at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NoDemand {
    /// No law governs the segment.
    NoLaw,
    /// The cutting circle does not meet the stock.
    NoContact,
    /// The cutting circle meets the stock only where its edges recede, or where the law's formula is not valid.
    OutsideValidity,
    /// No feed makes a chip as thick as the target there, so no feed is too high.
    ChipUnreachable,
    /// An input is not a number, or a radius or a feed per tooth is not positive.
    BadInput,
}

/// Feed law of a segment, prepared for it.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to box into, and one segment is active at a time")]
pub enum SegmentLaw {
    /// Constant feed per tooth on the circumference of a cup mill, at the contact with the stock line.
    Circumference(Circumference),
    /// The thickest chip anywhere on the engaged arc is kept at the target.
    EngagedArc(EngagedArc),
    /// Constant feed along the finished contour.
    Contour(Contour),
    /// Constant chip thickness of an end mill.
    Engagement(Engagement),
    /// Feed per tooth from a table over the path.
    Table(Table),
    /// No law governs this segment: it runs as programmed.
    Programmed,
}

impl SegmentLaw {
    /// The law of the rule's tool, prepared for a segment. [`SegmentLaw::Programmed`] without a rule, and if tool,
    /// law, rule and segment do not fit together.
    pub fn for_segment(segment: &Segment, rule: Option<&CutRule>, job: &Job) -> Self {
        SegmentLaw::with_table(segment, rule, None, job)
    }

    /// As [`SegmentLaw::for_segment`], with the table that was sent for this segment. Engaged arcs count if the rule
    /// expects them with each move; feeds are the law of a segment without a rule.
    pub fn with_table(segment: &Segment, rule: Option<&CutRule>, along: Option<&MoveTable>, job: &Job) -> Self {
        let Some(rule) = rule else {
            let feeds = along.and_then(MoveTable::feeds);
            return feeds.map_or(SegmentLaw::Programmed, |feeds| SegmentLaw::Table(feeds.clone()));
        };
        let setup = job.tool_of(rule);
        if setup.law == LawKind::Table {
            return for_table(rule, job);
        }
        let feed_per_tooth = job.feed_per_tooth_of(rule);
        match (&setup.tool, &rule.work, setup.law) {
            (Tool::CupMill(mill), Work::Ring(edge, stock), LawKind::Circumference) => {
                for_rotation(segment, mill, (*edge, stock), feed_per_tooth)
            }
            (_, Work::Ring(_, stock), LawKind::EngagedArc { .. }) => {
                let Some(height) = height(segment, setup.axis) else { return SegmentLaw::Programmed };
                let region = match (stock, along.and_then(MoveTable::engaged)) {
                    (Stock::PerMove, Some(table)) => Some(Region::Engaged(table.clone())),
                    _ => Region::new(stock, origin_mm(segment), height.to_mm()),
                };
                region.map_or(SegmentLaw::Programmed, |region| for_circles(segment, rule, region, job))
            }
            (Tool::EndMill(mill), Work::Mill { side, radial_depth }, law) => {
                for_mill(segment, mill, (*side, *radial_depth), law, feed_per_tooth)
            }
            _ => SegmentLaw::Programmed,
        }
    }
}

impl SegmentLaw {
    /// Calls `take` with each position at which the demand may bend or jump because of a table of the law: path from
    /// the segment's start, mm.
    pub fn knots_mm(&self, take: &mut dyn FnMut(f32)) {
        match self {
            SegmentLaw::Table(law) => law.knots_mm(take),
            SegmentLaw::EngagedArc(law) => law.knots_mm(take),
            SegmentLaw::Circumference(_) | SegmentLaw::Contour(_) | SegmentLaw::Engagement(_) => {}
            SegmentLaw::Programmed => {}
        }
    }
}

impl FeedLaw for SegmentLaw {
    fn demand(&self, place: &Place) -> Result<FeedDemand, NoDemand> {
        match self {
            SegmentLaw::Circumference(law) => law.demand(place),
            SegmentLaw::EngagedArc(law) => law.demand(place),
            SegmentLaw::Contour(law) => law.demand(place),
            SegmentLaw::Engagement(law) => law.demand(place),
            SegmentLaw::Table(law) => law.demand(place),
            SegmentLaw::Programmed => Err(NoDemand::NoLaw),
        }
    }

    fn is_uniform(&self) -> bool {
        match self {
            SegmentLaw::Circumference(law) => law.is_uniform(),
            SegmentLaw::EngagedArc(law) => law.is_uniform(),
            SegmentLaw::Contour(law) => law.is_uniform(),
            SegmentLaw::Engagement(law) => law.is_uniform(),
            SegmentLaw::Table(law) => law.is_uniform(),
            SegmentLaw::Programmed => true,
        }
    }
}

/// The table law applies to any segment: it depends only on the path travelled.
fn for_table(rule: &CutRule, job: &Job) -> SegmentLaw {
    let table = rule.table.and_then(|range| Table::new(job.knots.table(range)).ok());
    table.map_or(SegmentLaw::Programmed, SegmentLaw::Table)
}

fn for_rotation(
    segment: &Segment,
    mill: &CupMill,
    (edge, stock): (Edge, &Stock),
    feed_per_tooth: MmPerTooth,
) -> SegmentLaw {
    let (Some(arc), Some(line)) = (segment.arc(), stock.line()) else { return SegmentLaw::Programmed };
    let line = line.at_height(segment.height().to_mm());
    let law = Circumference::for_arc(arc, mill.radius_mm(edge), edge, &line, feed_per_tooth);
    SegmentLaw::Circumference(law)
}

/// Engaged-arc law: both circles of a ring on an arc, or the circle of an end mill on any move.
fn for_circles(segment: &Segment, rule: &CutRule, region: Region, job: &Job) -> SegmentLaw {
    let setup = job.tool_of(rule);
    let (Work::Ring(edge, _), LawKind::EngagedArc { both_edges }) = (&rule.work, setup.law) else {
        return SegmentLaw::Programmed;
    };
    let path_radius = segment.arc().map(|arc| Mm(arc.radius_mm() as f32));
    let (radii, path_radius) = match (&setup.tool, path_radius) {
        (Tool::CupMill(_), None) => return SegmentLaw::Programmed,
        (Tool::CupMill(mill), Some(radius)) => ([Edge::Outer, Edge::Inner].map(|edge| mill.radius_mm(edge)), radius),
        (Tool::EndMill(mill), radius) => {
            ([Mm(mill.radius.to_mm() as f32), Mm(0.0)], radius.unwrap_or(Mm(f32::INFINITY)))
        }
    };
    let [outer_radius, inner_radius] = radii;
    let ring = Ring { outer_radius, inner_radius, path_radius, feed_per_tooth: job.feed_per_tooth_of(rule) };
    let policy = if both_edges { EdgePolicy::Both } else { EdgePolicy::Only(*edge) };
    SegmentLaw::EngagedArc(EngagedArc::new(ring, policy, region))
}

/// Height of a segment's plane; `None` for lines that are not in X and Y, in which places on a line are given.
fn height(segment: &Segment, axis: ToolAxis) -> Option<Nm> {
    let [_, _, z] = segment.start.linear;
    match segment.arc() {
        Some(_) => Some(segment.height()),
        None => (axis == ToolAxis::Z).then_some(z),
    }
}

/// Origin of a segment's plane coordinates: the rotation centre of an arc, the start of a line.
fn origin_mm(segment: &Segment) -> [f64; 2] {
    let [x, y, _] = segment.start.linear;
    segment.arc().map_or([x, y], |arc| arc.center).map(Nm::to_mm)
}

fn for_mill(
    segment: &Segment,
    mill: &EndMill,
    (side, radial_depth): (ContourSide, Nm),
    law: LawKind,
    feed_per_tooth: MmPerTooth,
) -> SegmentLaw {
    let tool_radius = Mm(mill.radius.to_mm() as f32);
    let path_radius = segment.arc().map(|arc| arc.radius_mm() as f32);
    match law {
        LawKind::Contour { inside_only, floor_ratio } => {
            let limits = ContourLimits { inside_only, floor_ratio };
            let path_radius = Mm(path_radius.unwrap_or(f32::INFINITY));
            SegmentLaw::Contour(Contour::new(path_radius, tool_radius, side, feed_per_tooth, limits))
        }
        LawKind::Engagement => {
            let shape = match (segment.arc(), side) {
                (Some(arc), ContourSide::Inside) => PathShape::Inside {
                    contour_radius: Mm(arc.radius_mm() as f32 + tool_radius.0),
                    turn_rad: arc.sweep_rad() as f32,
                },
                _ => PathShape::Straight,
            };
            let depth = if side == ContourSide::Slot { Nm(2 * mill.radius.0) } else { radial_depth };
            let depth = Mm(depth.to_mm() as f32);
            SegmentLaw::Engagement(Engagement::new(tool_radius, depth, feed_per_tooth, shape))
        }
        LawKind::Circumference | LawKind::EngagedArc { .. } | LawKind::Table | LawKind::Programmed => {
            SegmentLaw::Programmed
        }
    }
}
