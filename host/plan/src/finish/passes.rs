//! Passes along a blade's sides and round its edges, as contact points.
//!
//! ```text
//! next point: |C' - C| <= step,  angle(t', t) <= angle,  every pivot between both within the tolerance of their chord        (1)
//! ```
//!
//! The pivot is the point of the axis at the height of the corner's centre, of a ball its centre. (1) is examined on dense contacts, so that it holds where a
//! flat side passes into a round edge, too. At an edge on which both sides end with different normals the mill rolls: the contact stays, the normal turns.
//!
//! Source: Tournier 2006, table 3 (tolerance, sampling step and angle). The loop round both edges is ours.

use crate::geometry::blade::length_mm;
use crate::geometry::flaws::BladeSide;
use crate::vector::{Point, Vector};

use super::axis::{AxisProgram, along_arc};
use super::contact::Contact;
use super::mill::{CutterLocation, FinishMill};
use super::rows::PassRows;

/// Places along each side, among which the points are chosen.
const PLACES: usize = 300;
/// Turn of the normal between two places, above which the interval is halved, and how often at most.
const DENSE_RAD: f64 = 0.02;
const HALVINGS: u32 = 12;
/// Angle of one step of a roll about an edge.
const ROLL_RAD: f64 = 0.01;
/// Normals of both sides at an edge nearer than this are one.
const SAME_RAD: f64 = 0.02;
/// Depth by which the corner's sphere may reach into the surface beside a contact.
const HOLLOW_MM: f64 = 0.001;
/// Length of the sum of two unit vectors below which they count as opposite.
const MEAN_LEAST: f64 = 0.5;

/// Course of the passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// One path round both sides and both edges, from the tip to the hub.
    Spiral,
    /// Separate passes of one side, all in one direction.
    OneWay(BladeSide),
}

/// Distances between the points of a pass. (1)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Tolerance, mm.
    pub tolerance_mm: f64,
    /// Greatest step, mm.
    pub step_mm: f64,
    /// Greatest turn of the tool axis, rad.
    pub angle_rad: f64,
}

/// Point of a pass: contact and place of the mill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassPoint {
    /// Contact.
    pub contact: Contact,
    /// Place of the mill.
    pub location: CutterLocation,
}

/// Point and unit normal.
type Node = (Point, Vector);

/// Surface of a blade: point and unit normal, away from the material, of a side at (u, v). A displaced blade is another such function.
pub type SideSurface<'s> = dyn Fn(BladeSide, f64, f64) -> (Point, Vector) + 's;

/// Passes over a surface.
pub struct Layout<'s> {
    /// Surface.
    pub surface: &'s SideSurface<'s>,
    /// PassRows of both sides: pressure, suction.
    pub rows: [PassRows; 2],
    /// Course.
    pub course: Course,
    /// Passes run from the leading to the trailing edge on the pressure side, or on the side of the course.
    pub is_forward: bool,
}

impl Layout<'_> {
    /// Number of passes, or of turns of the spiral.
    pub fn count(&self) -> usize {
        let steps = match self.course {
            Course::Spiral => self.rows[0].steps.max(self.rows[1].steps),
            Course::OneWay(BladeSide::Pressure) => self.rows[0].steps,
            Course::OneWay(BladeSide::Suction) => self.rows[1].steps,
        };
        // Of rounding a measure may end just above a whole number.
        libm::ceil(steps - 1e-9).max(1.0) as usize + 1
    }

    /// Contacts of pass `number`, dense; passes count from the tip. `corner_mm` is the radius about which the mill rolls at an edge.
    pub fn contacts(&self, number: usize, corner_mm: f64) -> Vec<Contact> {
        let steps = (self.count() - 1) as f64;
        let share = |part: f64| match self.course {
            // The first and the last turn of a spiral keep to their rows.
            Course::Spiral => 1.0 - ((number as f64 - 1.0 + part) / steps).clamp(0.0, 1.0),
            Course::OneWay(_) => 1.0 - number as f64 / steps,
        };
        let mut nodes = self.nodes(share);
        if !self.is_forward {
            nodes = self.nodes(|part| share(1.0 - part));
            nodes.reverse();
        }
        with_feed(&nodes, corner_mm)
    }

    /// Number of passes including the spiral's first turn.
    pub fn passes(&self) -> core::ops::Range<usize> {
        match self.course {
            Course::Spiral => 0..self.count() + 1,
            Course::OneWay(_) => 0..self.count(),
        }
    }

    /// Points and normals along a pass, with rolls at edges; `share` is the place up the span at a part of the pass.
    fn nodes(&self, share: impl Fn(f64) -> f64) -> Vec<Node> {
        let at = |side: BladeSide, u: f64, part: f64| {
            let rows = &self.rows[usize::from(side == BladeSide::Suction)];
            (self.surface)(side, u, rows.v(u, share(part)))
        };
        match self.course {
            Course::OneWay(side) => dense(&|u| at(side, u, u)),
            Course::Spiral => {
                let mut nodes = dense(&|u| at(BladeSide::Pressure, u, u / 2.0));
                let back = dense(&|way| at(BladeSide::Suction, 1.0 - way, 0.5 + way / 2.0));
                roll(&mut nodes, &back[0]);
                nodes.extend(&back);
                let first = at(BladeSide::Pressure, 0.0, 1.0);
                roll(&mut nodes, &first);
                nodes.push(first);
                nodes
            }
        }
    }
}

/// Nodes of a side, dense where its normal turns.
fn dense(at: &dyn Fn(f64) -> Node) -> Vec<Node> {
    let place = |k: usize| k as f64 / PLACES as f64;
    let mut nodes = vec![at(0.0)];
    for k in 1..=PLACES {
        let from = (place(k - 1), nodes[nodes.len() - 1]);
        halve(at, from, (place(k), at(place(k))), HALVINGS, &mut nodes);
    }
    nodes
}

/// Adds the end of an interval, and before it the nodes between which the normal turns little.
fn halve(at: &dyn Fn(f64) -> Node, from: (f64, Node), to: (f64, Node), halvings: u32, nodes: &mut Vec<Node>) {
    if halvings > 0 && from.1.1.angle(&to.1.1) > DENSE_RAD {
        let place = (from.0 + to.0) / 2.0;
        let middle = (place, at(place));
        halve(at, from, middle, halvings - 1, nodes);
        halve(at, middle, to, halvings - 1, nodes);
    } else {
        nodes.push(to.1);
    }
}

/// Adds the roll from the last node to the next one, if their normals differ.
fn roll(nodes: &mut Vec<Node>, next: &Node) {
    let [.., before, (point, normal)] = nodes.as_slice() else { return };
    let (point, normal, along) = (*point, *normal, point - before.0);
    if normal.angle(&next.1) < SAME_RAD {
        return;
    }
    // Of opposite normals the mean is no direction: then the mill rolls over the end of the side.
    let Some(out) = (normal + next.1).try_normalize(MEAN_LEAST).or_else(|| along.try_normalize(0.0)) else { return };
    for (from, to, first) in [(normal, out, 0.0), (out, next.1, 0.5)] {
        let steps = libm::ceil(from.angle(&to) / ROLL_RAD).max(1.0);
        nodes.extend((0..steps as usize).map(|k| {
            let part = k as f64 / steps;
            (point + (next.0 - point) * (first + part / 2.0), along_arc(&from, &to, part))
        }));
    }
}

/// Contacts with the feed direction of the path of the corner's centre. Nodes that coincide with the one before are left out, and those in hollows that are
/// narrower than the corner: there the corner's sphere would reach into the surface beside them.
fn with_feed(nodes: &[Node], corner_mm: f64) -> Vec<Contact> {
    let centres: Vec<Point> = nodes.iter().map(|(point, normal)| point + normal * corner_mm).collect();
    let scale_mm = length_mm(&centres);
    let least = (corner_mm - HOLLOW_MM).max(0.0);
    let fits = |centre: &Point| nodes.iter().all(|(point, _)| (point - centre).norm_squared() >= least * least);
    let differs = |k: usize| k == 0 || (centres[k] - centres[k - 1]).norm() > 1e-9 * scale_mm;
    let kept: Vec<usize> = (0..nodes.len()).filter(|k| differs(*k) && fits(&centres[*k])).collect();
    let contact = |at: usize| {
        let (before, after) = (kept[at.saturating_sub(1)], kept[(at + 1).min(kept.len() - 1)]);
        let (point, normal) = nodes[kept[at]];
        Contact::new(point, &normal, &(centres[after] - centres[before]))
    };
    (0..kept.len()).filter_map(contact).collect()
}

/// Points of a pass: the fewest of its contacts that keep to the sampling. (1)
pub fn sampled(contacts: &[Contact], axes: &[Vector], mill: &FinishMill, sampling: &Sampling) -> Vec<PassPoint> {
    let location = |at: usize| mill.at(&contacts[at], axes[at]);
    let pivots: Vec<Point> = (0..contacts.len()).map(|at| mill.pivot(&location(at))).collect();
    let is_near = |from: usize, to: usize| {
        let is_short = (contacts[to].point - contacts[from].point).norm() <= sampling.step_mm;
        let chord = (pivots[from], pivots[to] - pivots[from]);
        let keeps = || pivots[from + 1..to].iter().all(|pivot| from_chord_mm(pivot, &chord) <= sampling.tolerance_mm);
        is_short && axes[to].angle(&axes[from]) <= sampling.angle_rad && keeps()
    };
    let mut chosen = vec![0];
    for at in 1..contacts.len() {
        let last = chosen[chosen.len() - 1];
        if at + 1 == contacts.len() || !is_near(last, at + 1) {
            chosen.push(at);
        }
    }
    chosen.into_iter().map(|at| PassPoint { contact: contacts[at], location: location(at) }).collect()
}

/// Distance of a point from a chord, given by its start and its vector.
fn from_chord_mm(point: &Point, (start, along): &(Point, Vector)) -> f64 {
    let off = point - start;
    let square = along.norm_squared();
    let part = if square > 0.0 { (off.dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    (off - along * part).norm()
}

/// Climb milling at a contact, of a spindle that turns clockwise seen from the holder: the material lies to the right of the motion.
pub fn is_climb(contact: &Contact, axis: &Vector, to_next_pass: &Vector) -> bool {
    contact.feed.cross(axis).dot(&(to_next_pass - contact.normal)) > 0.0
}

impl AxisProgram {
    /// Points of a pass with the axes of this program.
    pub fn points(&self, contacts: &[Contact], mill: &FinishMill, sampling: &Sampling) -> Vec<PassPoint> {
        sampled(contacts, &self.axes(contacts, mill.corner_radius_mm), mill, sampling)
    }
}
