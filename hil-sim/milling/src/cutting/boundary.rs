//! Boundary of the stock that a cut rule describes, and the thickest chip of a cutting circle over its engaged directions.
//!
//! The chip in a direction is that of [`Circle::chip_mm`]. It grows towards the direction of motion, so the thickest chip
//! is the one straight ahead if there is material, and otherwise the one at an end of the engaged arc: at a crossing of
//! the circle with the boundary.
//!
//! The wall of a radial depth ae, for a tool of radius r on an arc of path radius q about A:
//!
//! ```text
//! inside a contour:   material outside the circle of radius q + r - ae about A       (1)
//! outside a contour:  material inside the circle of radius q - r + ae about A        (2)
//! ```
//!
//! The wall goes on along the tangent at the end of the arc. On a line the wall is parallel to the path.
//!
//! Source: plane geometry; docs/laws.md#measured-chip.

use core::f64::consts::TAU;

use arcfeed_model::engaged::EngagedTable;
use arcfeed_model::stock::StockLine;
use arcfeed_model::tool::Edge;
use nalgebra::Vector2;

use super::chip::Circle;

/// Distance by which a point on the boundary may be off by rounding, mm.
const ON_BOUNDARY_MM: f64 = 1e-9;

/// Angle by which a position at the start of a full circle may be before it by rounding.
const ON_START_RAD: f64 = 1e-6;

/// Path of the tool's centre on one move, in the plane of the move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanePath {
    /// Arc about a centre.
    Arc {
        /// Centre of the arc, A.
        center_mm: Vector2<f64>,
        /// Radius of the path, q.
        radius_mm: f64,
        /// Angle of the start from the plane's first axis.
        start_rad: f64,
        /// Angle from start to end, positive.
        sweep_rad: f64,
        /// Sense of rotation: 1 counter-clockwise, -1 clockwise.
        turn_sign: f64,
    },
    /// Straight line.
    Line {
        /// Position of the start.
        start_mm: Vector2<f64>,
        /// Unit vector from start to end.
        direction: Vector2<f64>,
    },
}

/// Stock that a move cuts: a region of the move's plane, described by its boundary.
#[derive(Clone, Debug, PartialEq)]
pub enum Boundary {
    /// Half planes of these stock lines, which the material has in common; without any line, the whole plane is material.
    Lines(Vec<StockLine>),
    /// Material inside or outside of a circle. If `along` is given, the boundary goes on beyond the end of that arc as the tangent there.
    Circle {
        /// Centre.
        center_mm: Vector2<f64>,
        /// Radius.
        radius_mm: f64,
        /// Whether the material lies outside the circle; otherwise it lies inside.
        is_hollow: bool,
        /// Arc at whose end the boundary changes from the circle to its tangent; `None` for the whole circle.
        along: Option<PlanePath>,
    },
    /// No region, but the engaged arcs as a function of the path travelled on the move.
    Table {
        /// Engaged arcs by path travelled.
        table: EngagedTable,
        /// Cutting circle of the tool (outer or inner) to which these engaged arcs belong.
        edge: Edge,
        /// Path of the tool's centre on the move.
        path: PlanePath,
    },
}

/// Tangent at the end of an arc: the unit vector from the rotation centre to that end, and the angle left to it.
#[derive(Clone, Copy, Debug)]
struct Tangent {
    outward: Vector2<f64>,
    turn_sign: f64,
    left_rad: f64,
}

impl PlanePath {
    /// Angle travelled on an arc up to this position.
    fn travelled_rad(&self, position_mm: &Vector2<f64>) -> f64 {
        let PlanePath::Arc { center_mm, start_rad, sweep_rad, turn_sign, .. } = self else { return 0.0 };
        let from_center = position_mm - center_mm;
        let travelled = turn_sign * (libm::atan2(from_center.y, from_center.x) - start_rad);
        let travelled = travelled - TAU * libm::floor(travelled / TAU);
        // Nearer to the start than to the end, the position is still before the start.
        let before_rad = ((sweep_rad + TAU) / 2.0).min(TAU - ON_START_RAD);
        if travelled > before_rad { travelled - TAU } else { travelled }
    }

    /// Path travelled up to this position, mm.
    fn travelled_mm(&self, position_mm: &Vector2<f64>) -> f64 {
        match self {
            PlanePath::Arc { radius_mm, .. } => radius_mm * self.travelled_rad(position_mm),
            PlanePath::Line { start_mm, direction } => (position_mm - start_mm).dot(direction),
        }
    }

    /// Unit vectors at this position: the direction of motion, and towards the rotation centre (on a line to the left).
    fn frame(&self, position_mm: &Vector2<f64>) -> Option<[Vector2<f64>; 2]> {
        match self {
            PlanePath::Arc { center_mm, turn_sign, .. } => {
                let towards = (center_mm - position_mm).try_normalize(0.0)?;
                Some([Vector2::new(towards.y, -towards.x) * *turn_sign, towards])
            }
            PlanePath::Line { direction, .. } => Some([*direction, Vector2::new(-direction.y, direction.x)]),
        }
    }

    fn tangent_at_end(&self, position_mm: &Vector2<f64>) -> Option<Tangent> {
        let PlanePath::Arc { start_rad, sweep_rad, turn_sign, .. } = self else { return None };
        let (sin, cos) = libm::sincos(start_rad + turn_sign * sweep_rad);
        let left_rad = sweep_rad - self.travelled_rad(position_mm);
        Some(Tangent { outward: Vector2::new(cos, sin), turn_sign: *turn_sign, left_rad })
    }
}

impl Boundary {
    /// Thickest chip, mm, of a cutting circle whose centre moves from `center_mm` by `delta_mm` in the time of one tooth; `None` if it
    /// does not cut.
    pub fn thickest_chip_mm(&self, circle: &Circle, center_mm: &Vector2<f64>, delta_mm: &Vector2<f64>) -> Option<f64> {
        let forward = delta_mm.try_normalize(0.0)? * circle.advance_ratio;
        let (is_ahead, ends) = self.engaged(circle, center_mm, &forward)?;
        if is_ahead {
            return Some(circle.chip_mm(&forward, delta_mm));
        }
        let chips = ends.iter().map(|u| circle.chip_mm(u, delta_mm));
        chips.max_by(f64::total_cmp).filter(|chip| *chip > 0.0)
    }

    /// Whether there is material straight ahead, and the directions to the ends of the engaged arcs.
    fn engaged(
        &self,
        circle: &Circle,
        center_mm: &Vector2<f64>,
        forward: &Vector2<f64>,
    ) -> Option<(bool, Vec<Vector2<f64>>)> {
        let ahead_mm = center_mm + forward * circle.radius_mm;
        match self {
            Boundary::Lines(lines) => {
                let within = |point: &Vector2<f64>, but: Option<usize>| {
                    let mut others = lines.iter().enumerate().filter(|(index, _)| Some(*index) != but);
                    others.all(|(_, line)| line.distance_mm([point.x, point.y]) >= -ON_BOUNDARY_MM)
                };
                let crossings = lines.iter().enumerate().flat_map(|(index, line)| {
                    let found = circle.crossings(center_mm, line).into_iter().flatten();
                    found.filter(move |u| within(&(center_mm + u * circle.radius_mm), Some(index)))
                });
                Some((within(&ahead_mm, None), crossings.collect()))
            }
            Boundary::Circle { center_mm: wall_mm, radius_mm, is_hollow, along } => {
                let tangent = along.and_then(|path| path.tangent_at_end(center_mm));
                let is_beyond = |point: &Vector2<f64>| {
                    tangent.is_some_and(|tangent| tangent.is_beyond(&(center_mm - wall_mm), &(point - wall_mm)))
                };
                let reach_mm = |point: &Vector2<f64>| match &tangent {
                    Some(tangent) if is_beyond(point) => tangent.outward.dot(&(point - wall_mm)),
                    _ => (point - wall_mm).norm(),
                };
                let on_circle = crossings_of_circles(circle, center_mm, wall_mm, *radius_mm).into_iter().flatten();
                let on_circle = on_circle.filter(|u| !is_beyond(&(center_mm + u * circle.radius_mm)));
                let line = tangent.map(|Tangent { outward, .. }| StockLine {
                    normal: outward.into(),
                    offset_mm: outward.dot(wall_mm) + radius_mm,
                    rise_ratio: 0.0,
                });
                let on_line = line.and_then(|line| circle.crossings(center_mm, &line)).into_iter().flatten();
                let on_line = on_line.filter(|u| is_beyond(&(center_mm + u * circle.radius_mm)));
                Some(((reach_mm(&ahead_mm) >= *radius_mm) == *is_hollow, on_circle.chain(on_line).collect()))
            }
            Boundary::Table { table, edge, path } => {
                let [motion, towards] = path.frame(center_mm)?;
                let span = table.arc_at(path.travelled_mm(center_mm) as f32, *edge)?;
                let advance = motion * circle.advance_ratio;
                let end = |[along, across]: [f32; 2]| advance * f64::from(along) + towards * f64::from(across);
                Some((span.is_engaged_ahead(), span.ends().map(end).into()))
            }
        }
    }
}

impl Tangent {
    /// Whether a point lies beyond the arc's end, seen from the rotation centre; both vectors begin there.
    fn is_beyond(&self, position: &Vector2<f64>, point: &Vector2<f64>) -> bool {
        self.turn_sign * libm::atan2(position.perp(point), position.dot(point)) > self.left_rad
    }
}

/// Directions from a circle's centre to its crossings with another circle; `None` if they do not meet.
fn crossings_of_circles(
    circle: &Circle,
    center_mm: &Vector2<f64>,
    other_mm: &Vector2<f64>,
    other_radius_mm: f64,
) -> Option<[Vector2<f64>; 2]> {
    let between = other_mm - center_mm;
    let distance_mm = between.norm();
    let (r, square) = (circle.radius_mm, distance_mm * distance_mm);
    let cosine = (square + r * r - other_radius_mm * other_radius_mm) / (2.0 * distance_mm * r);
    if !(-1.0..=1.0).contains(&cosine) {
        return None;
    }
    let along = between / distance_mm;
    let across = Vector2::new(-along.y, along.x) * libm::sqrt(1.0 - cosine * cosine);
    Some([along * cosine + across, along * cosine - across])
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::FRAC_PI_2;

    const MILL: Circle = Circle { radius_mm: 5.0, advance_ratio: 1.0 };

    fn corner(sweep_rad: f64) -> PlanePath {
        let (center_mm, start_rad) = (Vector2::zeros(), -FRAC_PI_2);
        PlanePath::Arc { center_mm, radius_mm: 3.0, start_rad, sweep_rad, turn_sign: 1.0 }
    }

    /// Thickest chip per step at an angle of the path of radius 3, for a step so short that its square does not count.
    fn chip_ratio(boundary: &Boundary, at_rad: f64) -> f64 {
        let (sin, cos) = libm::sincos(at_rad - FRAC_PI_2);
        let step_mm = 1e-6;
        let delta = Vector2::new(-sin, cos) * step_mm;
        boundary.thickest_chip_mm(&MILL, &(Vector2::new(cos, sin) * 3.0), &delta).unwrap() / step_mm
    }

    fn wall(is_hollow: bool, radius_mm: f64, sweep_rad: f64) -> Boundary {
        Boundary::Circle { center_mm: Vector2::zeros(), radius_mm, is_hollow, along: Some(corner(sweep_rad)) }
    }

    #[test]
    fn in_an_inside_arc_the_engagement_is_that_of_three_sides_of_a_triangle() {
        // Path 3, tool 5, depth 1: the previous wall has radius 7, and cos(phi) = 1 - 1 * 15 / (2 * 3 * 5) = 1/2.
        let ratio = chip_ratio(&wall(true, 7.0, FRAC_PI_2), 0.0);
        assert!((ratio - libm::sin(TAU / 6.0)).abs() < 1e-6, "{ratio}");
    }

    #[test]
    fn at_the_end_of_an_arc_the_wall_ahead_is_straight() {
        let ratio = chip_ratio(&wall(true, 7.0, FRAC_PI_2), FRAC_PI_2);
        assert!((ratio - 0.6).abs() < 1e-6, "{ratio}");
    }

    #[test]
    fn around_a_contour_the_engagement_is_smaller_than_on_a_line() {
        // Path 15, tool 5, depth 1: the wall has radius 11, and cos(phi) = (15^2 + 5^2 - 11^2) / (2 * 15 * 5) = 0.86.
        let path = PlanePath::Arc {
            center_mm: Vector2::zeros(),
            radius_mm: 15.0,
            start_rad: 0.0,
            sweep_rad: TAU,
            turn_sign: -1.0,
        };
        let wall =
            Boundary::Circle { center_mm: Vector2::zeros(), radius_mm: 11.0, is_hollow: false, along: Some(path) };
        let delta = Vector2::new(0.0, -1e-6);
        let ratio = wall.thickest_chip_mm(&MILL, &Vector2::new(15.0, 0.0), &delta).unwrap() / 1e-6;
        assert!((ratio - libm::sqrt(1.0 - 0.86 * 0.86)).abs() < 1e-6, "{ratio}");
    }

    #[test]
    fn a_full_circle_begins_as_it_goes_on() {
        let full = wall(true, 7.0, TAU);
        let ratios = [0.0, 1.0, 3.0].map(|at_rad| chip_ratio(&full, at_rad));
        assert!(ratios.iter().all(|ratio| (ratio - libm::sin(TAU / 6.0)).abs() < 1e-6), "{ratios:?}");
    }

    #[test]
    fn full_material_gives_a_chip_of_the_whole_step() {
        let ratio = chip_ratio(&Boundary::Lines(Vec::new()), 0.3);
        assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
    }

    #[test]
    fn a_disc_that_the_circle_enters_from_the_side_gives_the_chip_at_its_edge() {
        // Tool at the origin, moving along x; a disc of radius 4 about (3, -4): its rim crosses the tool's circle where
        // both radii meet, at cos = (25 + 25 - 16) / 50 about the direction of the disc's centre.
        let disc =
            Boundary::Circle { center_mm: Vector2::new(3.0, -4.0), radius_mm: 4.0, is_hollow: false, along: None };
        let step_mm = 1e-6;
        let chip_mm = disc.thickest_chip_mm(&MILL, &Vector2::zeros(), &Vector2::new(step_mm, 0.0)).unwrap();
        let angle = libm::atan2(-4.0, 3.0) + libm::acos(34.0 / 50.0);
        assert!((chip_mm / step_mm - libm::cos(angle)).abs() < 1e-6, "{}", chip_mm / step_mm);
    }

    #[test]
    fn nothing_ahead_and_no_crossing_is_no_chip() {
        let far =
            Boundary::Circle { center_mm: Vector2::new(99.0, 0.0), radius_mm: 4.0, is_hollow: false, along: None };
        assert_eq!(far.thickest_chip_mm(&MILL, &Vector2::zeros(), &Vector2::new(0.1, 0.0)), None);
    }
}
