//! Stock in the plane of a segment, for the engaged-arc law: whether a cutting circle is engaged straight ahead, and
//! the ends of its engaged arc.
//!
//! Source: docs/laws.md#engaged-arc.

use arcfeed_model::engaged::EngagedTable;
use arcfeed_model::stock::{EDGES_MAX, Stock};
use arcfeed_model::tool::Edge;
use arcfeed_units::fmath;
use heapless::Vec;
use nalgebra::Vector2;

use super::Place;

/// Tolerance of a crossing at a corner, relative to the circle's radius, for f32 rounding.
const CORNER_RATIO: f32 = 1e-5;

/// Stock in the plane of a segment; positions are relative to the segment's origin (rotation centre, or start of a
/// line), mm.
#[derive(Clone, Debug, PartialEq)]
pub enum Region {
    /// The area on the material side of all of these lines.
    Convex(Vec<HalfPlane, EDGES_MAX>),
    /// A round blank.
    Disc {
        /// Centre.
        center_mm: Vector2<f32>,
        /// Radius.
        radius_mm: f32,
    },
    /// Not a shape, but the directions in which the cutting circles are in material, along the segment.
    Engaged(EngagedTable),
}

/// A cutting circle of the tool at a place of its path.
#[derive(Clone, Copy, Debug)]
pub struct CircleAt<'p> {
    /// Outer or inner cutting circle.
    pub edge: Edge,
    /// r0: radius of the circle, mm.
    pub radius_mm: f32,
    /// Place of the tool.
    pub place: &'p Place,
}

/// Half plane of material: the points p with `normal . p <= offset_mm`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfPlane {
    /// Unit normal, pointing out of the material.
    pub normal: Vector2<f32>,
    /// Distance of the border from the segment's origin along the normal, mm.
    pub offset_mm: f32,
}

impl HalfPlane {
    /// Depth of a point inside the half plane, mm.
    fn depth_mm(&self, point_mm: Vector2<f32>) -> f32 {
        self.offset_mm - self.normal.dot(&point_mm)
    }
}

impl Region {
    /// Stock of a job, moved to a segment's origin (mm) and cut at the segment's height (mm); `None` if the engaged
    /// arcs come with each segment.
    pub fn new(stock: &Stock, origin_mm: [f64; 2], height_mm: f64) -> Option<Self> {
        Some(match stock {
            Stock::Convex(lines) => {
                let mut planes = Vec::new();
                for line in lines {
                    // As many planes as lines, so they fit; `collect` would add a panic path.
                    let _room = planes.push(HalfPlane {
                        normal: Vector2::from(line.normal).cast(),
                        offset_mm: line.at_height(height_mm).distance_mm(origin_mm) as f32,
                    });
                }
                Region::Convex(planes)
            }
            Stock::Disc { center_mm, radius_mm } => Region::Disc {
                center_mm: (Vector2::from(*center_mm) - Vector2::from(origin_mm)).cast(),
                radius_mm: *radius_mm as f32,
            },
            Stock::Engaged(table) => Region::Engaged(table.clone()),
            Stock::PerMove => return None,
        })
    }

    /// Whether all numbers are finite, so that comparisons with them are valid.
    pub fn is_sound(&self) -> bool {
        let is_sound = |place: &Vector2<f32>, length: f32| length.is_finite() && place.iter().all(|x| x.is_finite());
        match self {
            Region::Convex(planes) => planes.iter().all(|plane| is_sound(&plane.normal, plane.offset_mm)),
            Region::Disc { center_mm, radius_mm } => is_sound(center_mm, *radius_mm),
            // Checked when the table was created.
            Region::Engaged(_) => true,
        }
    }

    /// Whether the circle is in material straight ahead, that is in the direction in which its edges advance.
    pub fn is_engaged_ahead(&self, circle: &CircleAt<'_>) -> bool {
        let ahead = || circle.point(Vector2::from(circle.place.motion) * circle.advance_ratio());
        match self {
            Region::Convex(planes) => {
                let point_mm = ahead();
                planes.iter().all(|plane| plane.depth_mm(point_mm) >= 0.0)
            }
            Region::Disc { center_mm, radius_mm } => length(ahead() - center_mm) <= *radius_mm,
            Region::Engaged(table) => {
                let span = table.arc_at(circle.place.travelled_mm, circle.edge);
                span.is_some_and(|span| span.is_engaged_ahead())
            }
        }
    }

    /// Calls `visit` with the directions in which the engaged arc may begin or end, as unit vectors. Components: in
    /// the direction in which the edges advance (k v), and towards the rotation centre.
    pub fn ends(&self, circle: &CircleAt<'_>, mut visit: impl FnMut([f32; 2])) {
        let mut crossing = |u: Vector2<f32>| visit(circle.in_moving_frame(u));
        let (center_mm, circle_mm) = (Vector2::from(circle.place.center_mm), circle.radius_mm);
        match self {
            Region::Convex(planes) => {
                for (index, plane) in planes.iter().enumerate() {
                    let on_edge = |u: Vector2<f32>| {
                        let point = circle.point(u);
                        let others = planes.iter().enumerate().filter(|(other, _)| *other != index);
                        others.map(|(_, other)| other.depth_mm(point)).all(|depth| depth >= -CORNER_RATIO * circle_mm)
                    };
                    let crossings = directions(plane.normal, plane.depth_mm(center_mm) / circle_mm);
                    crossings.into_iter().flatten().filter(|u| on_edge(*u)).for_each(&mut crossing);
                }
            }
            Region::Disc { center_mm: disc_mm, radius_mm } => {
                let to_disc = disc_mm - center_mm;
                let distance = length(to_disc);
                // Law of cosines in the triangle of both centres and a crossing.
                let cosine = (distance * distance + circle_mm * circle_mm - radius_mm * radius_mm)
                    / (2.0 * distance * circle_mm);
                directions(to_disc / distance, cosine).into_iter().flatten().for_each(crossing);
            }
            Region::Engaged(table) => {
                let span = table.arc_at(circle.place.travelled_mm, circle.edge);
                span.iter().flat_map(|span| span.ends()).for_each(visit);
            }
        }
    }
}

impl CircleAt<'_> {
    /// k: sign of the edge's advance.
    fn advance_ratio(&self) -> f32 {
        f32::from(self.edge.advance())
    }

    /// Point of the circle in direction `u`.
    fn point(&self, u: Vector2<f32>) -> Vector2<f32> {
        Vector2::from(self.place.center_mm) + u * self.radius_mm
    }

    /// Components of `u` along k v and towards the rotation centre.
    fn in_moving_frame(&self, u: Vector2<f32>) -> [f32; 2] {
        let [motion, towards] = [self.place.motion, self.place.towards].map(Vector2::from);
        [self.advance_ratio() * u.dot(&motion), u.dot(&towards)]
    }
}

/// The two unit vectors whose component along `normal` is `cosine`; `None` beyond +-1 and for NaN.
fn directions(normal: Vector2<f32>, cosine: f32) -> Option<[Vector2<f32>; 2]> {
    let square = (1.0 - cosine) * (1.0 + cosine);
    (square >= 0.0).then(|| {
        let sine = fmath::sqrt(square);
        let across = Vector2::new(-normal.y, normal.x);
        [sine, -sine].map(|sine| normal * cosine + across * sine)
    })
}

/// Length of a vector by `fmath`, as all code for the chip.
fn length(vector: Vector2<f32>) -> f32 {
    fmath::length(vector.x, vector.y)
}
