//! The stock in the plane of a segment, as the engaged-arc law sees it: what lies inside, and where a circle crosses
//! its boundary.
//!
//! Source: docs/laws.md#engaged-arc.

use arcfeed_shared::fmath;
use arcfeed_shared::stock::{EDGES_MAX, Stock};
use heapless::Vec;

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
        }
    }

    /// Whether a point lies inside or on the boundary.
    pub fn contains(&self, point_mm: [f32; 2]) -> bool {
        match self {
            Region::Convex(planes) => planes.iter().all(|plane| plane.depth_mm(point_mm) >= 0.0),
            Region::Disc { center_mm: [cx, cy], radius_mm } => {
                let [x, y] = point_mm;
                fmath::length(x - cx, y - cy) <= *radius_mm
            }
        }
    }

    /// Hands the directions (unit vectors from the circle's centre) in which a circle crosses the boundary to `visit`.
    pub fn crossings(&self, center_mm: [f32; 2], circle_mm: f32, mut visit: impl FnMut([f32; 2])) {
        match self {
            Region::Convex(planes) => {
                for (index, plane) in planes.iter().enumerate() {
                    let on_edge = |u: [f32; 2]| {
                        let point = reach(center_mm, circle_mm, u);
                        let others = planes.iter().enumerate().filter(|(other, _)| *other != index);
                        others.map(|(_, other)| other.depth_mm(point)).all(|depth| depth >= -CORNER_RATIO * circle_mm)
                    };
                    let crossings = directions(plane.normal, plane.depth_mm(center_mm) / circle_mm);
                    crossings.into_iter().flatten().filter(|u| on_edge(*u)).for_each(&mut visit);
                }
            }
            Region::Disc { center_mm: disc_mm, radius_mm } => {
                let (dx, dy) = (disc_mm[0] - center_mm[0], disc_mm[1] - center_mm[1]);
                let distance = fmath::length(dx, dy);
                // Cosine rule in the triangle of both centres and a crossing.
                let cosine = (distance * distance + circle_mm * circle_mm - radius_mm * radius_mm)
                    / (2.0 * distance * circle_mm);
                let towards = [dx / distance, dy / distance];
                directions(towards, cosine).into_iter().flatten().for_each(visit);
            }
        }
    }
}

/// The point of a circle in direction `u`.
pub fn reach(center_mm: [f32; 2], circle_mm: f32, [ux, uy]: [f32; 2]) -> [f32; 2] {
    let [x, y] = center_mm;
    [x + circle_mm * ux, y + circle_mm * uy]
}

/// The two unit vectors whose component along `normal` is `cosine`; none beyond +-1 or for NaN.
fn directions([nx, ny]: [f32; 2], cosine: f32) -> Option<[[f32; 2]; 2]> {
    let square = (1.0 - cosine) * (1.0 + cosine);
    (square >= 0.0).then(|| {
        let sine = fmath::sqrt(square);
        [1.0, -1.0].map(|side| [cosine * nx - side * sine * ny, cosine * ny + side * sine * nx])
    })
}
