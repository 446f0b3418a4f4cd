//! Both sides of a blade as one surface that runs over one of its edges.
//!
//! ```text
//! course:  pressure side from the other edge, q = 0 .. 1;  edge, 1 .. 2;  suction side to the other edge, 2 .. 3     (1)
//! edge:    S = lerp(P, S),  n = arc from n_P over n_out to n_S                                                       (2)
//! v(q) = share of the length, at mid span, of the course at the gauge height: |d(S + h n)|                          (3)
//! ```
//!
//! On an edge where both sides end with one normal (2) is a point; on a sharp one it is the fan of directions in which the edge is the nearest point. By (3) places
//! at equal v lie evenly on the rounding of an edge, on which points of the surface itself crowd.
//!
//! Source: ours.

use thiserror::Error;

use super::face::{Face, Jet};
use super::surface::{Foot, SpanwiseFace, Surface, Unfolded};
use crate::vector::{Point, Vector};

/// h of (3): about the size of a weld.
const GAUGE_MM: f64 = 0.5;
/// Intervals of (3) on each side, quadratically denser towards the edge, and on the edge.
const SIDE_PARTS: usize = 400;
const EDGE_PARTS: usize = 32;
/// Places up the span at which the gap between the sides is examined.
const PROBES: usize = 33;
/// Largest gap between the sides at the edge.
const GAP_MAX_MM: f64 = 0.02;
/// Length of the sum of two unit normals above which their mean points out of the edge.
const MEAN_LEAST: f64 = 0.5;

/// Edge of a blade.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BladeEdge {
    /// Edge at which the flow arrives, u = 0.
    Leading,
    /// Edge at which the flow leaves, u = 1.
    Trailing,
}

/// The sides of a blade do not meet at an edge.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "the sides end {gap_mm:.3} mm apart at this edge, and {GAP_MAX_MM} mm at most is planned: give the part sections whose sides meet there"
)]
pub struct OpenEdge {
    /// Largest gap.
    pub gap_mm: f64,
}

/// Both sides of a blade as one surface: u from the root (0) to the tip (1), v from the other edge on the pressure side (0) over the edge to
/// the other edge on the suction side (1).
#[derive(Clone, Debug)]
pub struct EdgeStrip<'f> {
    /// Pressure and suction side.
    sides: [&'f Face; 2],
    edge: BladeEdge,
    /// v and q of (3), increasing.
    places: Vec<[f64; 2]>,
    /// Unit vector out of the edge at mid span.
    out: Vector,
    /// [`Surface::outward`]
    outward: f64,
}

/// Position on the course (1).
#[derive(Clone, Copy)]
enum Piece {
    /// Index of the side, and way from the edge, 0 to 1.
    Side(usize, f64),
    /// Share of the edge.
    Edge(f64),
}

/// The edge at one place of the span.
struct EdgePlace {
    jets: [Jet; 2],
    normals: [Vector; 2],
    /// n_out
    out: Vector,
    /// Unit vector along the pressure side out of it.
    ahead: Vector,
}

fn piece(course: f64) -> Piece {
    if course <= 1.0 {
        Piece::Side(0, 1.0 - course.max(0.0))
    } else if course < 2.0 {
        Piece::Edge(course - 1.0)
    } else {
        Piece::Side(1, course.min(3.0) - 2.0)
    }
}

impl<'f> EdgeStrip<'f> {
    /// Strip over an edge of a blade with these sides: pressure, suction.
    ///
    /// # Errors
    /// The sides do not meet there.
    pub fn new(sides: [&'f Face; 2], edge: BladeEdge) -> Result<Self, OpenEdge> {
        let mut strip = EdgeStrip { sides, edge, places: Vec::new(), out: Vector::zeros(), outward: 1.0 };
        let gap = |k: usize| {
            let [pressure, suction] = strip.edge_at(k as f64 / (PROBES - 1) as f64).jets;
            (pressure.point - suction.point).norm()
        };
        let gap_mm = (0..PROBES).map(gap).fold(0.0, f64::max);
        if gap_mm > GAP_MAX_MM {
            return Err(OpenEdge { gap_mm });
        }
        strip.out = strip.edge_at(0.5).out;
        strip.places = strip.measured();
        let middle = [0.5, strip.v(0.5)];
        let jet = strip.jet(middle);
        strip.outward = libm::copysign(1.0, jet.u.cross(&jet.v).dot(&strip.point_and_normal(middle).1));
        Ok(strip)
    }

    /// (3)
    fn measured(&self) -> Vec<[f64; 2]> {
        let near = |k: usize| (k as f64 / SIDE_PARTS as f64).powi(2);
        let before = (0..SIDE_PARTS).map(|k| 1.0 - near(SIDE_PARTS - k));
        let on = (0..EDGE_PARTS).map(|k| 1.0 + k as f64 / EDGE_PARTS as f64);
        let courses: Vec<f64> = before.chain(on).chain((0..=SIDE_PARTS).map(|k| 2.0 + near(k))).collect();
        let raised = |course: f64| {
            let (point, normal) = self.node(0.5, piece(course));
            point + normal * GAUGE_MM
        };
        let mut so_far_mm = 0.0;
        let mut places = vec![[0.0, courses[0]]];
        for pair in courses.windows(2) {
            // A gap or a fan of no size keeps v increasing.
            so_far_mm += (raised(pair[1]) - raised(pair[0])).norm().max(1e-6);
            places.push([so_far_mm, pair[1]]);
        }
        places.iter_mut().for_each(|place| place[0] /= so_far_mm);
        places
    }

    /// Position on the course at v, and its derivative.
    fn course(&self, v: f64) -> (f64, f64) {
        let next = self.places.partition_point(|place| place[0] <= v).clamp(1, self.places.len() - 1);
        let ([from_v, from], [to_v, to]) = (self.places[next - 1], self.places[next]);
        let rate = (to - from) / (to_v - from_v);
        ((from + (v - from_v) * rate).clamp(from, to), rate)
    }

    /// Parameter v at a position on the course.
    fn v(&self, course: f64) -> f64 {
        let next = self.places.partition_point(|place| place[1] <= course).clamp(1, self.places.len() - 1);
        let ([from_v, from], [to_v, to]) = (self.places[next - 1], self.places[next]);
        from_v + (course - from) * (to_v - from_v) / (to - from)
    }

    /// Parameter v of a place on a side, index 0 or 1, with the side's own u; on the edge, beyond the side's range by a part of one: the share of the
    /// half of the edge that belongs to the side.
    pub fn v_on_side(&self, side: usize, face_u: f64) -> f64 {
        let way = self.way(face_u);
        let beyond = (-way).clamp(0.0, 1.0) / 2.0;
        let course = match (side, way < 0.0) {
            (0, false) => 1.0 - way,
            (0, true) => 1.0 + beyond,
            (_, false) => 2.0 + way,
            (_, true) => 2.0 - beyond,
        };
        self.v(course)
    }

    /// Way from the edge along a side.
    fn way(&self, face_u: f64) -> f64 {
        match self.edge {
            BladeEdge::Leading => face_u,
            BladeEdge::Trailing => 1.0 - face_u,
        }
    }

    /// Parameter of a side at a way from the edge: the inverse of [`Self::way`].
    fn face_u(&self, way: f64) -> f64 {
        self.way(way)
    }

    fn edge_at(&self, span: f64) -> EdgePlace {
        let u = self.face_u(0.0);
        let jets = self.sides.map(|face| face.jet(u, span));
        let normals = self.sides.map(|face| face.normal(u, span));
        let sign = if self.edge == BladeEdge::Leading { -1.0 } else { 1.0 };
        let [ahead, other] = [0, 1].map(|k: usize| {
            let along = jets[k].v.normalize();
            let tangent = jets[k].u * sign;
            (tangent - along * along.dot(&tangent)).normalize()
        });
        let mean = normals[0] + normals[1];
        let out = if mean.norm() > MEAN_LEAST { mean } else { ahead + other };
        EdgePlace { jets, normals, out: out.normalize(), ahead }
    }

    /// Point and normal.
    fn node(&self, span: f64, piece: Piece) -> (Point, Vector) {
        match piece {
            Piece::Side(side, way) => {
                let u = self.face_u(way);
                (self.sides[side].point(u, span), self.sides[side].normal(u, span))
            }
            Piece::Edge(share) => {
                let place = self.edge_at(span);
                let [from, to] = place.jets.map(|jet| jet.point);
                (from + (to - from) * share, place.normal(share))
            }
        }
    }

    /// Edge over which the strip runs.
    pub fn edge(&self) -> BladeEdge {
        self.edge
    }

    /// Largest angle, rad, by which the normal turns on the edge itself.
    pub fn edge_angle_rad(&self) -> f64 {
        let angle = |k: usize| {
            let EdgePlace { normals, out, .. } = self.edge_at(k as f64 / (PROBES - 1) as f64);
            normals[0].angle(&out) + out.angle(&normals[1])
        };
        (0..PROBES).map(angle).fold(0.0, f64::max)
    }
}

impl EdgePlace {
    /// n of (2).
    fn normal(&self, share: f64) -> Vector {
        let [first, last] = self.normals;
        let arc = |from: Vector, to: Vector, part: f64| {
            let [from, to] = [from, to].map(nalgebra::Unit::new_normalize);
            from.try_slerp(&to, part, 1e-12).unwrap_or(from).into_inner()
        };
        if share < 0.5 { arc(first, self.out, 2.0 * share) } else { arc(self.out, last, 2.0 * share - 1.0) }
    }

    /// Share of the edge whose normal points towards a point in space.
    fn share(&self, point: &Point) -> f64 {
        let middle = nalgebra::center(&self.jets[0].point, &self.jets[1].point);
        let away = point - middle;
        let turn = |direction: &Vector| libm::atan2(direction.dot(&self.ahead), direction.dot(&self.normals[0]));
        let (angle, half, whole) = (turn(&away), turn(&self.out), turn(&self.out) + self.out.angle(&self.normals[1]));
        // Directions into the blade behind its pressure side are below 0 or near a whole turn.
        let share = if angle < half { angle / half / 2.0 } else { 0.5 + (angle - half) / (whole - half) / 2.0 };
        if share.is_nan() { 0.5 } else { share.clamp(0.0, 1.0) }
    }
}

impl Surface for EdgeStrip<'_> {
    fn jet(&self, [span, v]: [f64; 2]) -> Jet {
        let (course, rate) = self.course(v);
        match piece(course) {
            Piece::Side(side, way) => {
                let jet = self.sides[side].jet(self.face_u(way), span);
                let outwards = if side == 0 { -rate } else { rate };
                let rate = if self.edge == BladeEdge::Leading { outwards } else { -outwards };
                Jet {
                    point: jet.point,
                    u: jet.v,
                    v: jet.u * rate,
                    uu: jet.vv,
                    uv: jet.uv * rate,
                    vv: jet.uu * rate * rate,
                }
            }
            Piece::Edge(share) => {
                let [from, to] = self.edge_at(span).jets;
                let mixed = |from: Vector, to: Vector| from + (to - from) * share;
                Jet {
                    point: from.point + (to.point - from.point) * share,
                    u: mixed(from.v, to.v),
                    v: (to.point - from.point) * rate,
                    uu: mixed(from.vv, to.vv),
                    uv: (to.v - from.v) * rate,
                    vv: Vector::zeros(),
                }
            }
        }
    }

    fn ranges(&self) -> [[f64; 2]; 2] {
        [[0.0, 1.0]; 2]
    }

    fn outward(&self) -> f64 {
        self.outward
    }

    fn point_and_normal(&self, [span, v]: [f64; 2]) -> (Point, Vector) {
        self.node(span, piece(self.course(v).0))
    }

    fn foot(&self, point: &Point, [span, v]: [f64; 2]) -> Foot {
        let way = match piece(self.course(v).0) {
            Piece::Side(_, way) => way,
            Piece::Edge(_) => 0.0,
        };
        let on = |side: usize| SpanwiseFace(self.sides[side]).foot(point, [span, self.face_u(way)]);
        let (pressure, suction) = (on(0), on(1));
        let (side, foot) = if suction.distance_mm < pressure.distance_mm { (1, suction) } else { (0, pressure) };
        let [span, face_u] = foot.at;
        let way = self.way(face_u);
        let course = if way > 0.0 {
            if side == 0 { 1.0 - way } else { 2.0 + way }
        } else {
            1.0 + self.edge_at(span).share(point)
        };
        let is_on_border = span <= 0.0 || span >= 1.0 || way >= 1.0;
        Foot { at: [span, self.v(course)], is_on_border, ..foot }
    }

    fn gauge_mm(&self) -> f64 {
        GAUGE_MM
    }

    fn speed_mm(&self, at: [f64; 2], height_mm: f64) -> f64 {
        let (course, rate) = self.course(at[1]);
        let Piece::Edge(share) = piece(course) else { return self.jet(at).speed_mm(height_mm * self.outward) };
        let EdgePlace { jets, normals, out, .. } = self.edge_at(at[0]);
        let angle_rad = 2.0 * out.angle(&normals[usize::from(share >= 0.5)]);
        (height_mm * angle_rad + (jets[1].point - jets[0].point).norm()) * rate
    }

    /// The suction side is turned over about the edge, so that it continues the pressure side.
    fn unfolded(&self, [span, v]: [f64; 2], point: &Point) -> Unfolded {
        let Piece::Side(side, _) = piece(self.course(v).0) else { return Unfolded { point: *point, beyond_mm: 0.0 } };
        let edge = self.sides[side].point(self.face_u(0.0), span);
        let way_mm = self.out.dot(&(edge - point));
        if side == 0 {
            Unfolded { point: *point, beyond_mm: -way_mm }
        } else {
            Unfolded { point: point + self.out * (2.0 * way_mm), beyond_mm: way_mm }
        }
    }
}
