//! Stock limit of each of the four movements: the face of the blank at which its chip is thickest.
//!
//! A ring that turns about a pivot moves as a whole, so a point of a circle at direction u from the centre removes a
//! chip of
//!
//! ```text
//! chip = k s u.v                                                             (1)
//! ```
//!
//! for a step s of the centre along v: the outer circle (k = +1) cuts before the centre, the inner one (k = -1) behind
//! it. Both cut at once, at opposite ends of the slot, and the chip grows from 0 at the pivot to the end that is
//! farther from it. There the stock has its limit. The ends are the blank's faces k.p = f, k the rotor's axis, planes
//! that are tilted in the slot frame:
//!
//! ```text
//! y = (f - k_z (z + h)) / k_y                                                (2)
//! ```
//!
//! with h the height of the cutting plane above the tool's bottom, the insert's radius. Source: Petean, section 5.1,
//! tables 5.1 and 5.2 and figure 3.9. The choice by (1) is ours, and gives that table for pivots placed as there. A
//! blank whose rim is nearer than its face ends the cut before the line: the chip is then below the target.

use arcfeed_model::cut::RotationCircle;
use arcfeed_model::tool::Edge;
use arcfeed_nc::modal::Turn;
use thiserror::Error;

use crate::cutter::CupMill;
use crate::frame::slot_frame;
use crate::geometry::blisk::Blank;
use crate::path::{Purpose, SlotPath, Step};
use crate::vector::{Flat, Vector};

/// Number of sampled places of an arc.
const SAMPLES: usize = 17;

/// Margin of a rule's levels beyond the first and last, mm: more than a program's resolution, less than a level.
const LEVEL_MARGIN_MM: f64 = 0.02;

/// Thickness of a chip elsewhere, relative to the one at the line, from which a law with this line is of no use.
const ELSEWHERE_MAX_RATIO: f64 = 4.0;

/// The four movements.
const MOVEMENTS: [Purpose; 4] = [Purpose::Movement1, Purpose::Movement2, Purpose::Movement3, Purpose::Movement4];

/// Face of the blank, named by its position along the rotor's axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlankFace {
    /// Face with the smaller coordinate.
    Lower,
    /// Face with the larger coordinate.
    Upper,
}

/// Stock limit (line at which the stock ends) of one movement of the ring, with the circle that cuts there and the pivot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StockLimit {
    /// Number of the movement, 1 to 4, as in table 5.1.
    pub movement: usize,
    /// Circle on which the ring's centre moves about the pivot.
    pub rotation: RotationCircle,
    /// Sense of rotation of the movement.
    pub turn: Turn,
    /// Cutting circle (outer or inner) that cuts the thickest chip.
    pub edge: Edge,
    /// Face of the blank at which the chip is thickest.
    pub face: BlankFace,
    /// Line of that face in the plane of a level: direction of its normal out of the material, from the slot frame's x axis.
    pub normal_deg: f64,
    /// Distance of that line from the origin along the normal, at height 0.
    pub offset_mm: f64,
    /// Change of that distance per unit of height.
    pub rise_ratio: f64,
    /// Heights of the lowest and of the highest level on which the movement cuts.
    pub heights_mm: [f64; 2],
    /// Smallest and largest angle of the contact, measured from the direction of the pivot.
    pub contact_deg: [f64; 2],
    /// Thickest chip of the other circle, or at the other face, divided by the chip at this line; above 1 another chip is the thicker
    /// one.
    pub elsewhere_ratio: f64,
    /// Chip at this line divided by the target, under a law that knows this line only. It is below 1 if the circle meets the line a
    /// second time on its far side and the law takes that contact for the thicker one: the chip is then thinner than the target, and
    /// the feed slow.
    pub kept_ratio: f64,
}

impl StockLimit {
    /// Whether the movement gets a cut rule of the law that knows this line only: [`StockLimit::elsewhere_ratio`], by which the feed per
    /// tooth is divided, is not too large. Otherwise the movement keeps its programmed feed.
    pub fn is_governed_by_line(&self) -> bool {
        self.elsewhere_ratio < ELSEWHERE_MAX_RATIO
    }
}

/// Reason why the stock limits of a path cannot be found.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum LimitError {
    /// The blank's faces are square to the tool, so they do not bound the levels.
    #[error("the tool stands along the rotor's axis: no face of the blank bounds a level")]
    AlongRotor,
    /// The movement of this number meets no face of the blank.
    #[error(
        "movement {0} meets neither face of the blank ahead of its edges: is the blank narrower than the slot's pivots?"
    )]
    NoContact(usize),
}

/// Stock limit of each movement.
///
/// # Errors
/// The blank does not bound the levels.
pub fn stock_limits(
    path: &SlotPath,
    mill: &CupMill,
    blank: &Blank,
    tool_axis: &Vector,
) -> Result<Vec<StockLimit>, LimitError> {
    let frame = slot_frame(tool_axis).ok_or(LimitError::AlongRotor)?;
    let rotor = frame * Vector::z();
    let faces = [BlankFace::Lower, BlankFace::Upper].map(|face| line(face, blank, &rotor, mill.insert_radius_mm));
    let mut steps = path.steps();
    // The last arc returns through the part already cut.
    let arcs = steps.iter().rposition(|step| step.about.is_some()).unwrap_or(0);
    steps.truncate(arcs);
    let of = |purpose: Purpose| steps.iter().filter(move |step| step.purpose == purpose).collect::<Vec<_>>();
    let found = MOVEMENTS.iter().filter(|purpose| !of(**purpose).is_empty());
    found.map(|purpose| limit(*purpose, &of(*purpose), &faces, mill)).collect()
}

/// Line of a face: (2).
#[derive(Clone, Copy, Debug)]
struct Line {
    face: BlankFace,
    /// +1 or -1: the normal is along y or against it.
    outward: f64,
    offset_mm: f64,
    rise_ratio: f64,
}

impl Line {
    fn normal_deg(&self) -> f64 {
        if self.outward > 0.0 { 90.0 } else { 270.0 }
    }
}

fn line(face: BlankFace, blank: &Blank, rotor: &Vector, above_mm: f64) -> Line {
    let (outward, at_mm) = match face {
        BlankFace::Lower => (-1.0, blank.faces_mm[0]),
        BlankFace::Upper => (1.0, blank.faces_mm[1]),
    };
    let rise_ratio = -outward * rotor.z / rotor.y;
    Line { face, outward, offset_mm: outward * at_mm / rotor.y + rise_ratio * above_mm, rise_ratio } // (2)
}

/// Circle that may cut, and the face where it would.
struct Candidate {
    edge: Edge,
    line: Line,
    /// Chip over step (1) and contact angle, at every sampled place.
    contacts: Vec<Option<Contact>>,
}

#[derive(Clone, Copy)]
struct Contact {
    chip_ratio: f64,
    angle_rad: f64,
    /// Chip ratio at the thicker of both points.
    law_chip_ratio: f64,
}

fn limit(purpose: Purpose, steps: &[&Step], faces: &[Line; 2], mill: &CupMill) -> Result<StockLimit, LimitError> {
    let movement = purpose.movement().unwrap_or_default();
    let places: Vec<Place> = steps.iter().flat_map(|step| places(step)).collect();
    let edges = [(Edge::Outer, mill.outer_radius_mm), (Edge::Inner, mill.inner_radius_mm)];
    let pairs = edges.iter().flat_map(|edge| faces.iter().map(move |line| (*edge, *line)));
    let candidates = pairs.map(|(edge, line)| candidate(edge, line, &places));
    let mut candidates: Vec<Candidate> = candidates.collect();
    let total =
        |candidate: &Candidate| candidate.contacts.iter().flatten().map(|contact| contact.chip_ratio).sum::<f64>();
    candidates.sort_by(|a, b| total(b).total_cmp(&total(a)));
    let [chosen, others @ ..] = candidates.as_slice() else { return Err(LimitError::NoContact(movement)) };
    let contacts = || chosen.contacts.iter().flatten();
    let angles_deg = || contacts().map(|contact| contact.angle_rad.to_degrees());
    if angles_deg().next().is_none() {
        return Err(LimitError::NoContact(movement));
    }
    let heights = || steps.iter().map(|step| step.from[2]);
    Ok(StockLimit {
        movement,
        rotation: match purpose {
            Purpose::Movement1 | Purpose::Movement4 => RotationCircle::Interior,
            _ => RotationCircle::Exterior,
        },
        turn: steps.iter().find_map(|step| step.about).map_or(Turn::Cw, |(_, turn)| turn),
        edge: chosen.edge,
        face: chosen.line.face,
        normal_deg: chosen.line.normal_deg(),
        offset_mm: chosen.line.offset_mm,
        rise_ratio: chosen.line.rise_ratio,
        heights_mm: [
            heights().fold(f64::INFINITY, f64::min) - LEVEL_MARGIN_MM,
            heights().fold(f64::NEG_INFINITY, f64::max) + LEVEL_MARGIN_MM,
        ],
        contact_deg: [angles_deg().fold(f64::INFINITY, f64::min), angles_deg().fold(0.0, f64::max)],
        kept_ratio: contacts().map(|contact| contact.chip_ratio / contact.law_chip_ratio).fold(1.0, f64::min),
        elsewhere_ratio: others.iter().map(|other| elsewhere_ratio(chosen, other)).fold(0.0, f64::max),
    })
}

/// Position of the centre, its direction of motion, and the direction of its pivot; unit vectors.
struct Place {
    center_mm: Flat,
    height_mm: f64,
    motion: [f64; 2],
    towards: [f64; 2],
}

fn places(step: &Step) -> Vec<Place> {
    let Some((pivot, turn)) = step.about else { return Vec::new() };
    let sign = f64::from(turn.sign());
    let [arm_x, arm_y] = [step.from[0] - pivot.x, step.from[1] - pivot.y];
    let place = |index: usize| {
        let (sin, cos) = libm::sincos(sign * step.sweep_rad() * index as f64 / (SAMPLES - 1) as f64);
        let [x, y] = [arm_x * cos - arm_y * sin, arm_x * sin + arm_y * cos];
        let radius_mm = libm::hypot(x, y);
        Place {
            center_mm: Flat::new(pivot.x + x, pivot.y + y),
            height_mm: step.from[2],
            motion: [-sign * y / radius_mm, sign * x / radius_mm],
            towards: [-x / radius_mm, -y / radius_mm],
        }
    };
    (0..SAMPLES).map(place).collect()
}

fn candidate((edge, radius_mm): (Edge, f64), line: Line, places: &[Place]) -> Candidate {
    let advance = f64::from(edge.advance());
    Candidate { edge, line, contacts: places.iter().map(|place| contact(place, line, advance, radius_mm)).collect() }
}

/// Contact of a circle with a line. A circle meets a line twice; the slot is where it is nearer to the pivot.
/// Admissible are points on the pivot's side of the centre where the edge advances; among two, the law takes the one
/// with the thicker chip.
fn contact(place: &Place, line: Line, advance: f64, radius_mm: f64) -> Option<Contact> {
    let y_mm = line.outward * (line.offset_mm + line.rise_ratio * place.height_mm);
    let up = (y_mm - place.center_mm.y) / radius_mm;
    let side = libm::sqrt(1.0 - up * up);
    let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
    let points = [[side, up], [-side, up]].map(|u| (advance * dot(u, place.motion), dot(u, place.towards))); // (1)
    let is_admissible = |(chip_ratio, towards): &(f64, f64)| *chip_ratio > 0.0 && *towards >= 0.0;
    let law_chip_ratio = points.into_iter().filter(is_admissible).map(|point| point.0).fold(0.0, f64::max);
    let near = points.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).filter(is_admissible)?;
    Some(Contact { chip_ratio: near.0, angle_rad: libm::atan2(near.0, near.1), law_chip_ratio })
}

fn elsewhere_ratio(chosen: &Candidate, other: &Candidate) -> f64 {
    let pairs = chosen.contacts.iter().zip(&other.contacts);
    let ratio = |(own, other): (&Option<Contact>, &Option<Contact>)| match (own, other) {
        (_, None) => 0.0,
        (None, Some(_)) => f64::INFINITY,
        (Some(own), Some(other)) => other.chip_ratio / own.chip_ratio,
    };
    pairs.map(ratio).fold(0.0, f64::max)
}
