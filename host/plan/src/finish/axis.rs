//! Tool axes along a pass: fixed tilt and yaw, or key positions between which they are interpolated.
//!
//! ```text
//! s = length of the path of the corner's centre, C + r n, over that of the whole pass           (1)
//! angles:  tilt and yaw linear in s between two stations                                      (2)
//! axes:    t = arc between the axes of two stations, by the angle linear in s                    (3)
//! ```
//!
//! The paper's strategies 3 and 4 state the tilt at three positions and a variable yaw; its figure 11 shows i/j constant between them, which is (3).
//!
//! Source: Tournier 2006, section 4, table 3 and figure 7. (1) in place of the contact's length: around a sharp edge the contact stands still.

use crate::vector::{Point, Vector};

use super::contact::{Contact, Orientation};

/// Angle below which an arc is a point.
const SAME_RAD: f64 = 1e-9;

/// Station: key position of a pass with a value there, between which values are interpolated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station<T> {
    /// Position along the pass, as a fraction of its length, 0 to 1. (1)
    pub share: f64,
    /// Orientation or axis there.
    pub value: T,
}

/// Tool axes along a pass, given at stations in the order of the pass; before the first and after the last one the nearest counts.
#[derive(Clone, Debug, PartialEq)]
pub enum AxisProgram {
    /// Tilt and yaw between stations; one station: fixed angles. (2)
    Angles(Vec<Station<Orientation>>),
    /// Axes between the positions that tilt and yaw define at the stations. (3)
    Positions(Vec<Station<Orientation>>),
    /// Axes between given ones. (3)
    Axes(Vec<Station<Vector>>),
}

impl AxisProgram {
    /// Tool axis at each contact of a pass; `corner_mm` is the radius r of the mill's corner.
    pub fn axes(&self, contacts: &[Contact], corner_mm: f64) -> Vec<Vector> {
        let shares = shares(contacts, corner_mm);
        let along = |stations: &[Station<Vector>]| shares.iter().map(|share| axis_between(stations, *share)).collect();
        match self {
            AxisProgram::Angles(stations) => {
                let at = |share: &f64| orientation_between(stations, *share);
                shares.iter().zip(contacts).map(|(share, contact)| contact.axis(&at(share))).collect()
            }
            AxisProgram::Positions(stations) => {
                let key = |station: &Station<Orientation>| {
                    let nearest = nearest(&shares, station.share)?;
                    Some(Station { share: station.share, value: contacts.get(nearest)?.axis(&station.value) })
                };
                along(&stations.iter().filter_map(key).collect::<Vec<_>>())
            }
            AxisProgram::Axes(stations) => along(stations),
        }
    }
}

/// Position of each contact along its pass, as a fraction of the pass's length, 0 to 1. (1)
pub fn shares(contacts: &[Contact], corner_mm: f64) -> Vec<f64> {
    let centre = |contact: &Contact| -> Point { contact.point + contact.normal * corner_mm };
    let mut so_far_mm = vec![0.0; contacts.len()];
    for at in 1..contacts.len() {
        so_far_mm[at] = so_far_mm[at - 1] + (centre(&contacts[at]) - centre(&contacts[at - 1])).norm();
    }
    let whole_mm = so_far_mm.last().copied().unwrap_or(0.0);
    so_far_mm.into_iter().map(|mm| if whole_mm > 0.0 { mm / whole_mm } else { 0.0 }).collect()
}

/// Unit vector at the fraction `part` of the angle from one unit vector to another, on the arc between them. (3)
/// Opposite vectors have no such arc and give the first.
pub fn along_arc(from: &Vector, to: &Vector, part: f64) -> Vector {
    let across = from.cross(to);
    let (sin, angle_rad) = (across.norm(), libm::atan2(across.norm(), from.dot(to)));
    if sin < SAME_RAD {
        return *from;
    }
    let weight = |part: f64| libm::sin(part * angle_rad) / sin;
    (from * weight(1.0 - part) + to * weight(part)).normalize()
}

fn nearest(shares: &[f64], share: f64) -> Option<usize> {
    (0..shares.len()).min_by(|one, other| (shares[*one] - share).abs().total_cmp(&(shares[*other] - share).abs()))
}

/// Stations about a place, and the part of the way between them.
fn between<T: Copy>(stations: &[Station<T>], share: f64) -> Option<(T, T, f64)> {
    let next = stations.partition_point(|station| station.share <= share);
    let (from, to) = (stations.get(next.saturating_sub(1))?, stations.get(next.min(stations.len() - 1))?);
    let whole = to.share - from.share;
    let part = if whole > 0.0 { ((share - from.share) / whole).clamp(0.0, 1.0) } else { 0.0 };
    Some((from.value, to.value, part))
}

fn axis_between(stations: &[Station<Vector>], share: f64) -> Vector {
    between(stations, share).map_or_else(Vector::z, |(from, to, part)| along_arc(&from, &to, part))
}

fn orientation_between(stations: &[Station<Orientation>], share: f64) -> Orientation {
    let Some((from, to, part)) = between(stations, share) else { return Orientation::default() };
    let mixed = |from: f64, to: f64| from + (to - from) * part; // (2)
    Orientation { tilt_rad: mixed(from.tilt_rad, to.tilt_rad), yaw_rad: mixed(from.yaw_rad, to.yaw_rad) }
}
