//! Chip in front of an elementary edge (a short piece of a cutting edge in one layer of the workpiece), from the present material.
//!
//! The rake face is on a line from the tool's axis through the edge. In front of it, on the rays of the layer, is the
//! surface that earlier edges left; behind it, the surface that the edge itself has just cut. The edge stores the last
//! point of the old surface that it removed. The chip thickness is interpolated between that point and the next one
//! ahead, both seen from the tool's axis:
//!
//! ```text
//! d(P) = k (|T - C| - |P - C|)          how deep inside of the edge T a point is; k = 1 outer, -1 inner edge         (1)
//! h = d_in - d_out                      between where the material begins and ends, at most the rake face deep        (2)
//! h(angle) linear between two rays      off by h''/8 (step/r)^2, which is h/8 (step/r)^2 for a smooth cut             (3)
//! ```
//!
//! In a vibrating cut with waves of length l on the surface (3) is A/2 (pi step/l)^2 for an amplitude A. Where the surface
//! begins or ends between two rays, the chip begins and ends half-way.

use std::ops::RangeInclusive;

use arcfeed_model::tool::Edge;
use nalgebra::Vector2;

use super::layer::Layer;
use super::partial_heights::{DepthBand, PartialHeights};
use arcfeed_dexel::dexel::{Dexel, Interval};

/// Points nearer to the rake face than this were cut by it, and thinner chips count as none: rounding.
const AT_RAKE_MM: f64 = 1e-9;

/// Margin above rounding errors.
const MARGIN_MM: f64 = 1e-6;

/// A ray at 45 degrees or less to the rake face covers at most 2 sqrt 2 of its depth from there to the circle of its
/// root.
const FAR_RATIO: f64 = 3.0;

/// Cosine of the largest angle to the rays at which a rake face is distinguished from its continuation beyond the tool's axis.
const SAME_SIDE_MIN: f64 = 0.5;

/// Rays beyond the last one at which an edge neither meets material nor has any ahead.
const APART_RAYS: f64 = 3.0;

/// Elementary edge (short piece of a cutting edge) at one position in its layer of the workpiece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeElement {
    /// Position of the tool's axis.
    pub center_mm: Vector2<f64>,
    /// Direction from the axis to the edge, a unit vector.
    pub towards: Vector2<f64>,
    /// Distance from the axis to the edge.
    pub radius_mm: f64,
    /// Whether the edge is on the outer or on the inner cutting circle.
    pub side: Edge,
    /// 1 if the tool turns counter-clockwise in the plane, else -1.
    pub turn_ratio: f64,
    /// Depth of the rake face behind the edge: only material that deep is removed in a step.
    pub depth_mm: f64,
    /// Part of the layer's height that the edge cuts.
    pub depth_band: DepthBand,
}

/// Chip in front of an elementary edge; all zero if the edge does not cut.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrontChip {
    /// Chip thickness in the plane of the layer, square to the circle on which the edge moves.
    pub thickness_mm: f64,
    /// Height of the top of the material in front of the edge, as a fraction of the layer's height.
    pub top_ratio: f64,
}

/// State of an elementary edge that is kept from step to step: where it cut last, and the surface that it passed there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EdgeHistory {
    /// Position of the last cut.
    last: Option<EdgeElement>,
    /// The last point of the old surface that it passed.
    behind: Option<Point>,
    /// Last requested position and the last point passed on the path there; mostly the edge moves to the position
    /// requested last.
    requested: Option<(EdgeElement, Option<Point>)>,
}

/// The rays ahead of an edge, in the order in which it meets them.
#[derive(Clone, Debug)]
struct RaysAhead {
    /// Axis of the rays.
    axis: usize,
    first: i64,
    /// Step from one ray to the next, 1 or -1.
    way: i64,
    count: i64,
    /// Extent of the rake face, in rays.
    crossed: RangeInclusive<f64>,
    /// Direction along the rays towards the rake face's root.
    to_root: f64,
    /// Whether the edge's end of a ray across the rake face is behind it.
    has_edge_behind: bool,
}

/// The chip on one ray.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    /// Beginning of the material, inside the edge; without material, the place where the edge passes.
    begins_mm: Vector2<f64>,
    /// End of the material, if before the edge.
    ends_mm: Option<Vector2<f64>>,
    has_material: bool,
    /// Height of the material.
    top_ratio: f64,
}

impl EdgeElement {
    /// Position of the edge.
    pub fn edge_mm(&self) -> Vector2<f64> {
        self.center_mm + self.towards * self.radius_mm
    }

    /// Inner end of the rake face, `depth_mm` behind the edge.
    pub fn root_mm(&self) -> Vector2<f64> {
        self.edge_mm() - self.outward() * self.depth_mm
    }

    /// Whether the whole rake face lies so far beside the layer's rays that it cannot meet material.
    pub fn is_apart(&self, layer: &Layer) -> bool {
        [0, 1].into_iter().any(|axis: usize| {
            let at = [self.edge_mm(), self.root_mm()].map(|end| layer.index(axis, end[1 - axis]));
            let end = layer.rays(axis).len() as f64;
            at.iter().all(|at| *at < -APART_RAYS) || at.iter().all(|at| *at > end + APART_RAYS)
        })
    }

    /// Whether there is material of the layer, as high as this edge cuts, on the rays around the edge or within `margin_mm` of it.
    pub fn is_near(&self, layer: &Layer, margin_mm: f64) -> bool {
        let axis = self.axis();
        let ends_mm = [self.edge_mm(), self.root_mm()];
        let [from_mm, to_mm] = [ends_mm[0].inf(&ends_mm[1]), ends_mm[0].sup(&ends_mm[1])];
        let span = Interval::new(from_mm[axis] - margin_mm, to_mm[axis] + margin_mm);
        let [first, last] =
            [from_mm[1 - axis] - margin_mm, to_mm[1 - axis] + margin_mm].map(|mm| layer.index(axis, mm));
        let rays = (first - APART_RAYS).floor() as i64..=(last + APART_RAYS).ceil() as i64;
        layer.is_met(axis, rays, &span, self.depth_band.border_ratio)
    }

    /// Direction from the rake face to the material.
    fn outward(&self) -> Vector2<f64> {
        self.towards * f64::from(self.side.advance())
    }

    /// Depth of a point inside the edge's circle (1).
    fn inside_mm(&self, point_mm: &Vector2<f64>) -> f64 {
        f64::from(self.side.advance()) * (self.radius_mm - (point_mm - self.center_mm).norm())
    }

    /// Distance of a point ahead of the rake face, along the tangent at the edge; infinite beyond a quarter of a turn.
    fn ahead_mm(&self, point_mm: &Vector2<f64>) -> f64 {
        let arm = point_mm - self.center_mm;
        let (off, along) = (self.turn_ratio * self.towards.perp(&arm), self.towards.dot(&arm));
        if along > 0.0 { off / along * self.radius_mm } else { f64::INFINITY.copysign(off) }
    }

    /// Axis whose rays cross the surface at the larger angle.
    fn axis(&self) -> usize {
        usize::from(libm::fabs(self.towards.y) > libm::fabs(self.towards.x))
    }

    /// Rays on which the turning edge meets the old surface next.
    fn rays_ahead(&self, layer: &Layer) -> RaysAhead {
        let axis = self.axis();
        let crossed = self.crossed(layer, axis);
        let tangent = self.turn_ratio * Vector2::new(-self.towards.y, self.towards.x);
        let (first, end, way) = match tangent[1 - axis] > 0.0 {
            true => (crossed.start().ceil() as i64, layer.rays(axis).len() as i64, 1),
            false => (crossed.end().floor() as i64, -1, -1),
        };
        let to_root = -libm::copysign(f64::from(self.side.advance()), self.towards[axis]);
        // One ray beyond the grid, empty, ends the cut there.
        let count = (end - first) * way + 1;
        RaysAhead { axis, first, way, count, crossed, to_root, has_edge_behind: tangent[axis] * to_root > 0.0 }
    }

    /// Extent of the rake face, in rays along an axis.
    fn crossed(&self, layer: &Layer, axis: usize) -> RangeInclusive<f64> {
        let [edge, root] = [self.edge_mm(), self.root_mm()].map(|end| layer.index(axis, end[1 - axis]));
        edge.min(root)..=edge.max(root)
    }

    /// Point that the turning edge meets on a ray ahead of it.
    fn ahead_on(&self, layer: &Layer, rays: &RaysAhead, nth: i64) -> Option<Point> {
        let ray = rays.first + nth * rays.way;
        // Most rays across the rake face have no material left ahead of it.
        if rays.has_edge_behind
            && rays.crossed.contains(&(ray as f64))
            && self.is_passed(layer, rays.axis, ray, rays.to_root)
        {
            return None;
        }
        self.on_ray(layer, rays.axis, ray).filter(|point| self.ahead_mm(&point.begins_mm) > AT_RAKE_MM)
    }

    /// Number of rays ahead of an earlier position of this edge that are completely behind its present position.
    fn count_behind(&self, layer: &Layer, from: &EdgeElement, rays: &RaysAhead) -> i64 {
        let axis = rays.axis;
        // Beyond this, rays may cross the rake face's line on the other side of the tool's axis.
        if self.towards[axis] * libm::copysign(1.0, from.towards[axis]) < SAME_SIDE_MIN {
            return 0;
        }
        // Points on the rays are in the circle of the earlier position, not in that of this one.
        let margin = ((self.center_mm - from.center_mm).norm() + MARGIN_MM) / layer.step_mm();
        let crossed = self.crossed(layer, axis);
        let behind = match rays.way > 0 {
            true => (crossed.start() - margin).ceil() as i64 - rays.first,
            false => rays.first - (crossed.end() + margin).floor() as i64,
        };
        behind.clamp(0, rays.count.max(0))
    }

    /// Whether a ray that crosses the rake face has no material between the face and the circle of its root.
    fn is_passed(&self, layer: &Layer, axis: usize, ray: i64, to_root: f64) -> bool {
        let off_mm = layer.place_mm(axis, 0) + ray as f64 * layer.step_mm() - self.center_mm[1 - axis];
        let at_mm = self.center_mm[axis] + off_mm * self.towards[axis] / self.towards[1 - axis];
        let [one_mm, other_mm] = [at_mm - to_root * MARGIN_MM, at_mm + to_root * FAR_RATIO * self.depth_mm];
        let span = Interval::new(one_mm.min(other_mm), one_mm.max(other_mm));
        let is_left = |(material, heights): (&Dexel, &PartialHeights)| {
            material.meets(&span) && !heights.is_below(&span, self.depth_band.border_ratio)
        };
        !layer.ray(axis, ray).is_some_and(is_left)
    }

    /// Chip on a ray when the edge reaches it; `None` if it does not reach the ray.
    fn on_ray(&self, layer: &Layer, axis: usize, ray: i64) -> Option<Point> {
        let place_mm = layer.place_mm(axis, 0) + ray as f64 * layer.step_mm();
        let off_mm = place_mm - self.center_mm[1 - axis];
        let sign = self.towards[axis].signum();
        let along = |radius_mm: f64| {
            let square = radius_mm * radius_mm - off_mm * off_mm;
            (square >= 0.0).then(|| self.center_mm[axis] + sign * libm::sqrt(square))
        };
        let at = |along_mm: f64| {
            let mut point = Vector2::zeros();
            (point[axis], point[1 - axis]) = (along_mm, place_mm);
            point
        };
        let edge_mm = along(self.radius_mm)?;
        let root_mm =
            along(self.radius_mm - f64::from(self.side.advance()) * self.depth_mm).unwrap_or(self.center_mm[axis]);
        let (low, high) = (edge_mm.min(root_mm), edge_mm.max(root_mm));
        let (span, is_first) = (Interval::new(low, high), edge_mm > root_mm);
        let chip = layer
            .ray(axis, ray)
            .and_then(|(material, heights)| heights.end_piece(material, &span, self.depth_band.border_ratio, is_first));
        Some(match chip {
            None => Point { begins_mm: at(edge_mm), ends_mm: None, has_material: false, top_ratio: 1.0 },
            Some(Interval { from_mm, to_mm }) => {
                let (begins, ends) = if edge_mm > root_mm { (from_mm, to_mm) } else { (to_mm, from_mm) };
                // Material that ends behind the rake face was cut by it; ahead of the face that chip reaches the edge.
                let ends_mm = Some(at(ends)).filter(|end| ends != edge_mm && self.ahead_mm(end) > AT_RAKE_MM);
                let top_ratio = layer.mean_ratio(axis, ray, &Interval::new(from_mm, to_mm));
                Point { begins_mm: at(begins), ends_mm, has_material: true, top_ratio }
            }
        })
    }

    /// Chip at a point (2).
    fn front(&self, point: &Point) -> FrontChip {
        let ends = point.ends_mm.map_or(0.0, |ends| self.inside_mm(&ends).max(0.0));
        let thickness_mm = (self.inside_mm(&point.begins_mm) - ends).clamp(0.0, self.depth_mm);
        FrontChip {
            thickness_mm: if thickness_mm > AT_RAKE_MM { thickness_mm } else { 0.0 },
            top_ratio: point.top_ratio,
        }
    }
}

impl EdgeHistory {
    /// Chip that the edge would cut at this position, for its motion since its last cut; nothing is removed.
    pub fn front(&mut self, element: &EdgeElement, layer: &Layer) -> FrontChip {
        if element.is_apart(layer) {
            return FrontChip::default();
        }
        // Distance of neighbouring rays along the circle.
        let apart_mm = layer.step_mm() / libm::fabs(element.towards[element.axis()]);
        let (behind, next) = self.around(element, layer);
        self.requested = Some((*element, behind));
        // A surface passed long ago gives no information about this position.
        let behind = behind.map(|point| (element.ahead_mm(&point.begins_mm), point));
        let behind = behind.filter(|(ahead_mm, point)| point.has_material && -ahead_mm < 2.0 * apart_mm);
        let next = next.map(|point| (element.ahead_mm(&point.begins_mm), point));
        let next = next.filter(|(ahead_mm, point)| point.has_material && *ahead_mm < 2.0 * apart_mm);
        match (behind, next) {
            (Some((from_mm, behind)), Some((to_mm, next))) => {
                let (from, to) = (element.front(&behind), element.front(&next));
                let at = |from: f64, to: f64| from - (to - from) * from_mm / (to_mm - from_mm);
                FrontChip {
                    thickness_mm: at(from.thickness_mm, to.thickness_mm),
                    top_ratio: at(from.top_ratio, to.top_ratio),
                }
            }
            (Some((at_mm, only)), None) | (None, Some((at_mm, only))) if libm::fabs(at_mm) <= apart_mm / 2.0 => {
                element.front(&only)
            }
            _ => FrontChip::default(),
        }
    }

    /// State of the same edge in another layer: it keeps its position, but has passed no surface there.
    pub fn in_other_layer(&self) -> Self {
        EdgeHistory { behind: None, requested: None, ..*self }
    }

    /// Whether the edge has just passed material, which may still give a chip.
    pub fn has_left(&self, element: &EdgeElement, layer: &Layer) -> bool {
        let far_mm = APART_RAYS * layer.step_mm() / libm::fabs(element.towards[element.axis()]);
        self.behind.is_some_and(|point| point.has_material && -element.ahead_mm(&point.begins_mm) < far_mm)
    }

    /// Path of the rake face since the last cut.
    pub fn way_mm(&self, element: &EdgeElement) -> f64 {
        let from = self.last.as_ref().unwrap_or(element);
        (element.edge_mm() - from.edge_mm()).norm().max((element.root_mm() - from.root_mm()).norm())
    }

    /// Moves the edge to its next position without cutting.
    pub fn move_without_cut(&mut self, element: &EdgeElement) {
        *self = EdgeHistory { last: Some(*element), behind: None, requested: None };
    }

    /// Moves the edge to its next position, less than a quarter of a turn on, and removes the swept material; returns
    /// the area as the rays along each axis measure it, mm2.
    pub fn cut(&mut self, element: &EdgeElement, layer: &mut Layer) -> [f64; 2] {
        if element.is_apart(layer) && self.last.is_none_or(|last| last.is_apart(layer)) {
            self.move_without_cut(element);
            return [0.0; 2];
        }
        self.behind = match self.requested.take() {
            Some((requested, behind)) if requested == *element => behind,
            _ => self.around(element, layer).0,
        };
        let Some(from) = self.last.replace(*element) else { return [0.0; 2] };
        let ends_mm = |element: &EdgeElement| [element.root_mm(), element.edge_mm()];
        layer.clear_strip(
            [ends_mm(&from), ends_mm(element)],
            f64::from(element.side.advance()) * element.radius_mm,
            &element.depth_band,
        )
    }

    /// Points of the old surface on both sides of a rake face that has moved here from the last cut.
    fn around(&self, element: &EdgeElement, layer: &Layer) -> (Option<Point>, Option<Point>) {
        let from = EdgeElement { depth_band: element.depth_band, ..self.last.unwrap_or(*element) };
        let rays = from.rays_ahead(layer);
        let passed = element.count_behind(layer, &from, &rays);
        let (mut behind, mut ahead) = (None, None);
        for point in (passed..rays.count).filter_map(|nth| from.ahead_on(layer, &rays, nth)) {
            if element.ahead_mm(&point.begins_mm) > 0.0 {
                ahead = Some(point);
                break;
            }
            behind = Some(point);
        }
        // Of the rays passed on the path only the last one counts.
        let on_way = || (0..passed).rev().find_map(|nth| from.ahead_on(layer, &rays, nth));
        (behind.or_else(on_way).or(self.behind), ahead)
    }
}
