//! Geometry of a programmed move in the plane of cutter compensation.

use arcfeed_nc::motion::Plane;
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::Nm;

use crate::vector::{Point, Vector, between, in_plane, length, scaled, to_left, unit};

/// A programmed move, projected onto the plane of cutter compensation.
#[derive(Clone, Copy, Debug)]
pub struct Element {
    pub from: Point,
    pub to: Point,
    /// Circle and sense of the arc; `None` for a line.
    pub arc: Option<ArcElement>,
}

/// Arc of an [`Element`].
#[derive(Clone, Copy, Debug)]
pub struct ArcElement {
    pub center: Point,
    /// +1 counter-clockwise, -1 clockwise.
    pub sign: i8,
    /// Angle from start to end in the sense of the arc, in (0, 2 pi].
    pub sweep_rad: f64,
}

/// The path at a corner: its direction of motion there and, for an arc, its offset circle.
#[derive(Clone, Copy, Debug)]
pub struct Branch {
    /// Direction of motion, length 1.
    pub tangent: Vector,
    /// For an arc, the circle on which the tool centre runs; `None` for a line.
    pub circle: Option<Circle>,
}

/// A circle; its centre is relative to the programmed corner, mm.
#[derive(Clone, Copy, Debug)]
pub struct Circle {
    pub center: Vector,
    pub radius_mm: f64,
}

impl Element {
    /// The move projected onto the plane; `None` if it does not move there.
    pub fn of(segment: &Segment, plane: Plane) -> Option<Self> {
        let (from, to) = (in_plane(&segment.start, plane), in_plane(&segment.end, plane));
        let arc = match &segment.path {
            Path::Arc(arc) if arc.plane == plane => {
                Some(ArcElement { center: arc.center, sign: arc.turn.sign(), sweep_rad: arc.sweep_rad() })
            }
            Path::Arc(_) | Path::Rapid | Path::Line => None,
        };
        (arc.is_some() || from != to).then_some(Element { from, to, arc })
    }

    /// The path at the start of the move; `offset_mm`, of the tool centre, is positive to the left.
    pub fn start(&self, offset_mm: f64) -> Branch {
        self.branch(self.from, offset_mm)
    }

    /// The path at the end of the move; `offset_mm`, of the tool centre, is positive to the left.
    pub fn end(&self, offset_mm: f64) -> Branch {
        self.branch(self.to, offset_mm)
    }

    fn branch(&self, point: Point, offset_mm: f64) -> Branch {
        let Some(arc) = &self.arc else {
            return Branch { tangent: unit(between(self.from, self.to)), circle: None };
        };
        let center = between(point, arc.center);
        let tangent = scaled(to_left(unit(center)), -f64::from(arc.sign));
        Branch { tangent, circle: Some(Circle { center, radius_mm: length(center) - f64::from(arc.sign) * offset_mm }) }
    }

    /// For an arc, the smaller of the radii at start and end, and the radius on which the tool centre runs there,
    /// mm. Both radii differ if the arc is a spiral. `None` for a line.
    pub fn radii_mm(&self, offset_mm: f64) -> Option<(f64, f64)> {
        let arc = self.arc.as_ref()?;
        let [start, end] = [self.from, self.to].map(|point| length(between(point, arc.center)));
        let radius = start.min(end);
        Some((radius, radius - f64::from(arc.sign) * offset_mm))
    }

    /// Vector from the start of the programmed path to the tool centre, at a right angle to the path.
    pub fn normal_at_start(&self, offset: Nm) -> Vector {
        scaled(to_left(self.start(0.0).tangent), offset.to_mm())
    }

    /// Vector from the end of the programmed path to the tool centre, at a right angle to the path.
    pub fn normal_at_end(&self, offset: Nm) -> Vector {
        scaled(to_left(self.end(0.0).tangent), offset.to_mm())
    }
}
