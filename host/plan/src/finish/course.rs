//! Course of the tool axis round a blade: the smoothest one that is admissible at stations along several passes.
//!
//! All passes share one course, so that neighbouring passes leave the same marks. An axis is a candidate at a station if it is admissible there on every sampled
//! pass, the machine's rotary axes reach it within their ranges, and its angle from each normal lies within the given range: along the normal a ball does
//! not cut at its tip, and across it the flutes cut.
//!
//! Source: ours.

use arcfeed_kinematics::machine::Machine;

use crate::parallel;
use crate::vector::Vector;

use super::axis::{AxisProgram, Station, shares};
use super::contact::Contact;
use super::reach::{AxisReach, smoothest};
use super::rotary::{RangeExcess, range_excess};

/// Stations of a closed course, and of an open one less one.
const STATIONS: usize = 24;
/// Distance of neighbouring candidates.
const GRID_DEG: f64 = 7.5;
/// Largest angle of candidates from the direction out of the rotor.
const CONE_DEG: f64 = 67.5;

/// Tool axis with its excess over the ranges of the rotary axes.
type Candidate = (Vector, Option<RangeExcess>);

/// Search for the smoothest sequence of tool axes (course) round a blade that is admissible on several passes.
pub struct CourseSearch<'a> {
    /// Test whether a tool axis is admissible at a contact.
    pub reach: &'a AxisReach<'a>,
    /// Machine whose rotary axes must reach the tool axes.
    pub machine: &'a Machine,
    /// Dense contacts of the sampled passes.
    pub passes: &'a [Vec<Contact>],
    /// Unit vector away from the rotor at the blade.
    pub outward: Vector,
    /// Smallest and largest angle between the tool axis and the normals of the contacts.
    pub tilt_rad: [f64; 2],
    /// Whether the course returns to its first axis.
    pub is_closed: bool,
}

/// Position along the passes at which no tool axis is admissible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CourseGap {
    /// That position, as a fraction of the pass.
    pub share: f64,
    /// Least excess over the ranges of the rotary axes, if tool axes would be admissible there without these ranges.
    pub excess: Option<RangeExcess>,
}

impl CourseSearch<'_> {
    /// The smoothest course.
    ///
    /// # Errors
    /// Position at which no tool axis is admissible.
    pub fn course(&self) -> Result<AxisProgram, CourseGap> {
        let places: Vec<f64> = (0..=STATIONS).map(|k| k as f64 / STATIONS as f64).collect();
        let open = if self.is_closed { &places[..STATIONS] } else { &places[..] };
        let in_reach = |axis| Some((axis, range_excess(self.machine, &axis).ok()?));
        let candidates: Vec<_> = candidates(&self.outward).into_iter().filter_map(in_reach).collect();
        let corner_mm = self.reach.mill.corner_radius_mm;
        let along: Vec<Vec<f64>> = self.passes.iter().map(|pass| shares(pass, corner_mm)).collect();
        let mut layers = Vec::new();
        for share in open {
            let contacts: Vec<&Contact> =
                self.passes.iter().zip(&along).filter_map(|(pass, at)| nearest(pass, at, *share)).collect();
            let fits = |(axis, _): &&Candidate| contacts.iter().all(|contact| self.is_within(contact, axis));
            let (mut beyond, near): (Vec<_>, Vec<_>) =
                candidates.iter().filter(fits).partition(|(_, excess)| excess.is_some());
            let is_admissible = |axis: &Vector| contacts.iter().all(|contact| self.reach.is_admissible(contact, *axis));
            let layer = parallel::filter_map(&near, &|(axis, _)| is_admissible(axis).then_some(*axis));
            if layer.is_empty() {
                beyond.sort_by(|one, other| excess_deg(one).total_cmp(&excess_deg(other)));
                let excess = beyond.iter().find(|(axis, _)| is_admissible(axis)).and_then(|(_, excess)| *excess);
                return Err(CourseGap { share: *share, excess });
            }
            layers.push(layer);
        }
        let mut axes = smoothest(&layers, self.is_closed).ok_or(CourseGap { share: 0.0, excess: None })?;
        if self.is_closed {
            axes.push(axes[0]);
        }
        Ok(AxisProgram::Axes(places.iter().zip(axes).map(|(share, value)| Station { share: *share, value }).collect()))
    }

    fn is_within(&self, contact: &Contact, axis: &Vector) -> bool {
        let angle_rad = contact.normal.angle(axis);
        (self.tilt_rad[0]..=self.tilt_rad[1]).contains(&angle_rad)
    }
}

fn excess_deg((_, excess): &Candidate) -> f64 {
    excess.map_or(0.0, |excess| excess.excess_deg)
}

fn nearest<'c>(pass: &'c [Contact], at: &[f64], share: f64) -> Option<&'c Contact> {
    let next = at.partition_point(|place| *place < share).min(pass.len().checked_sub(1)?);
    pass.get(next)
}

/// Directions about one direction, evenly in rings.
fn candidates(about: &Vector) -> Vec<Vector> {
    let first = about.cross(&if about.z.abs() < 0.9 { Vector::z() } else { Vector::x() }).normalize();
    let second = about.cross(&first);
    let rings = (CONE_DEG / GRID_DEG) as usize;
    let ring = |k: usize| {
        let (sin, cos) = libm::sincos((GRID_DEG * k as f64).to_radians());
        let count = libm::ceil(360.0 * sin / GRID_DEG).max(1.0) as usize;
        (0..count).map(move |i| {
            let (s, c) = libm::sincos(core::f64::consts::TAU * i as f64 / count as f64);
            about * cos + (first * c + second * s) * sin
        })
    };
    (0..=rings).flat_map(ring).collect()
}
