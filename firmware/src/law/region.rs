//! The stock in the plane of a segment, as the engaged-arc law sees it: whether a cutting circle is engaged straight ahead,
//! and where its engaged arc ends.
//!
//! Source: docs/laws.md#engaged-arc.

use arcfeed_shared::engaged::EngagedTable;
use arcfeed_shared::fmath;
use arcfeed_shared::stock::{EDGES_MAX, Stock};
use arcfeed_shared::tool::Edge;
use heapless::Vec;

use super::Place;

/// How far outside an edge a crossing still counts as on it, in parts of the circle's radius: f32 rounding at a corner.
const CORNER_RATIO: f32 = 1e-5;

/// Stock relative to the segment's origin; lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub enum Region {
    /// The intersection of half planes `normal . p <= offset`.
    Convex(Vec<HalfPlane, EDGES_MAX>),
    /// A round blank.
    Disc {
        /// Its centre.
        center_mm: [f32; 2],
        /// Its radius.
        radius_mm: f32,
    },
    /// No shape, but the engaged arcs along the segment.
    Engaged(EngagedTable),
}

/// A cutting circle at its place.
#[derive(Clone, Copy, Debug)]
pub struct CircleAt<'p> {
    /// Which one.
    pub edge: Edge,
    /// r0, mm.
    pub radius_mm: f32,
    /// Where the tool is.
    pub place: &'p Place,
}

/// `normal . p <= offset_mm` is inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfPlane {
    /// Unit normal, out of the material.
    pub normal: [f32; 2],
    /// Distance from the segment's origin along the normal.
    pub offset_mm: f32,
}

impl HalfPlane {
    /// How deep inside a point lies, mm.
    fn depth_mm(&self, [x, y]: [f32; 2]) -> f32 {
        let [nx, ny] = self.normal;
        self.offset_mm - (nx * x + ny * y)
    }
}

impl Region {
    /// The stock of a program seen from a segment's origin (mm).
    pub fn new(stock: &Stock, origin_mm: [f64; 2]) -> Self {
        match stock {
            Stock::Convex(lines) => {
                let mut planes = Vec::new();
                for line in lines {
                    // As many as there are lines: there is room; `collect` would bring a panic along.
                    let _room = planes.push(HalfPlane {
                        normal: line.normal.map(|component| component as f32),
                        offset_mm: line.distance_mm(origin_mm) as f32,
                    });
                }
                Region::Convex(planes)
            }
            Stock::Disc { center_mm: [x, y], radius_mm } => Region::Disc {
                center_mm: [(x - origin_mm[0]) as f32, (y - origin_mm[1]) as f32],
                radius_mm: *radius_mm as f32,
            },
            Stock::Engaged(table) => Region::Engaged(table.clone()),
        }
    }

    /// Whether all its numbers are.
    pub fn is_sound(&self) -> bool {
        let are_numbers = |numbers: [f32; 3]| numbers.iter().all(|number| number.is_finite());
        match self {
            Region::Convex(planes) => planes.iter().all(|plane| {
                let [nx, ny] = plane.normal;
                are_numbers([nx, ny, plane.offset_mm])
            }),
            Region::Disc { center_mm: [x, y], radius_mm } => are_numbers([*x, *y, *radius_mm]),
            // Checked when it was made.
            Region::Engaged(_) => true,
        }
    }

    /// Whether the direction of the circle's advance, k v, is engaged.
    pub fn holds_ahead(&self, circle: &CircleAt<'_>) -> bool {
        let ahead = || circle.point(circle.place.motion.map(|component| circle.advance_ratio() * component));
        match self {
            Region::Convex(planes) => {
                let point_mm = ahead();
                planes.iter().all(|plane| plane.depth_mm(point_mm) >= 0.0)
            }
            Region::Disc { center_mm: [cx, cy], radius_mm } => {
                let [x, y] = ahead();
                fmath::length(x - cx, y - cy) <= *radius_mm
            }
            Region::Engaged(table) => {
                let span = table.arc_at(circle.place.travelled_mm, circle.edge);
                span.is_some_and(|span| span.holds_ahead())
            }
        }
    }

    /// Hands the directions in which the engaged arc may end to `visit`: their components along k v and towards the
    /// rotation centre.
    pub fn ends(&self, circle: &CircleAt<'_>, mut visit: impl FnMut([f32; 2])) {
        let mut crossing = |u: [f32; 2]| visit(circle.in_moving_frame(u));
        let (center_mm, circle_mm) = (circle.place.center_mm, circle.radius_mm);
        match self {
            Region::Convex(planes) => {
                for (index, plane) in planes.iter().enumerate() {
                    let on_edge = |u: [f32; 2]| {
                        let point = circle.point(u);
                        let others = planes.iter().enumerate().filter(|(other, _)| *other != index);
                        others.map(|(_, other)| other.depth_mm(point)).all(|depth| depth >= -CORNER_RATIO * circle_mm)
                    };
                    let crossings = directions(plane.normal, plane.depth_mm(center_mm) / circle_mm);
                    crossings.into_iter().flatten().filter(|u| on_edge(*u)).for_each(&mut crossing);
                }
            }
            Region::Disc { center_mm: disc_mm, radius_mm } => {
                let (dx, dy) = (disc_mm[0] - center_mm[0], disc_mm[1] - center_mm[1]);
                let distance = fmath::length(dx, dy);
                // Cosine rule in the triangle of both centres and a crossing.
                let cosine = (distance * distance + circle_mm * circle_mm - radius_mm * radius_mm)
                    / (2.0 * distance * circle_mm);
                let towards = [dx / distance, dy / distance];
                directions(towards, cosine).into_iter().flatten().for_each(crossing);
            }
            Region::Engaged(table) => {
                let span = table.arc_at(circle.place.travelled_mm, circle.edge);
                span.iter().flat_map(|span| span.ends()).for_each(visit);
            }
        }
    }
}

impl CircleAt<'_> {
    /// k.
    fn advance_ratio(&self) -> f32 {
        f32::from(self.edge.advance())
    }

    /// The point in direction `u`.
    fn point(&self, [ux, uy]: [f32; 2]) -> [f32; 2] {
        let [x, y] = self.place.center_mm;
        [x + self.radius_mm * ux, y + self.radius_mm * uy]
    }

    /// The components of `u` along k v and towards the rotation centre.
    fn in_moving_frame(&self, [ux, uy]: [f32; 2]) -> [f32; 2] {
        let ([vx, vy], [yx, yy]) = (self.place.motion, self.place.towards);
        [self.advance_ratio() * (ux * vx + uy * vy), ux * yx + uy * yy]
    }
}

/// The two unit vectors whose component along `normal` is `cosine`; none beyond +-1 or for NaN.
fn directions([nx, ny]: [f32; 2], cosine: f32) -> Option<[[f32; 2]; 2]> {
    let square = (1.0 - cosine) * (1.0 + cosine);
    (square >= 0.0).then(|| {
        let sine = fmath::sqrt(square);
        [1.0, -1.0].map(|side| [cosine * nx - side * sine * ny, cosine * ny + side * sine * nx])
    })
}
