//! The chip in front of an elementary edge, from the material as it is now.
//!
//! The rake face stands on a line from the tool's axis through the edge. In front of it, on the rays of the layer, lies the
//! surface that earlier edges left; behind it, what the edge itself has just cut. The edge keeps the last point of the old surface
//! that it took away, and the chip is told between that one and the next one ahead, both seen from the tool's axis:
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

use arcfeed_shared::tool::Edge;
use nalgebra::Vector2;

use super::layer::Layer;
use super::partial_heights::{PartialHeights, Share};
use crate::stock::dexel::{Dexel, Interval};

/// What is no further from the rake face was cut by it, and what is no thicker is no chip: rounding.
const AT_RAKE_MM: f64 = 1e-9;

/// Wider than rounding.
const MARGIN_MM: f64 = 1e-6;

/// A ray at 45 degrees or less to the rake face goes no further than 2 sqrt 2 of its depth from there to the circle of its root.
const FAR_RATIO: f64 = 3.0;

/// Cosine of the largest angle to the rays at which a rake face is distinguished from its continuation beyond the tool's axis.
const SAME_SIDE_MIN: f64 = 0.5;

/// So many rays beyond the last one an edge neither meets material nor sees any ahead.
const APART_RAYS: f64 = 3.0;

/// Where an elementary edge stands in its layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rake {
    /// The tool's axis.
    pub center_mm: Vector2<f64>,
    /// From the axis to the edge, a unit vector.
    pub towards: Vector2<f64>,
    /// From the axis to the edge.
    pub radius_mm: f64,
    /// Which way the edge cuts.
    pub side: Edge,
    /// 1 where the tool turns counter-clockwise in the plane, else -1.
    pub turn_ratio: f64,
    /// How far the rake face reaches behind the edge.
    pub depth_mm: f64,
    /// What of the layer's height it meets.
    pub share: Share,
}

/// What is in front of an elementary edge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Front {
    /// Across the edge's circle.
    pub thickness_mm: f64,
    /// How high it is, as a part of the layer.
    pub top_ratio: f64,
}

/// What an elementary edge remembers from step to step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wake {
    /// Where it was when it cut last.
    last: Option<Rake>,
    /// The last point of the old surface that it passed.
    behind: Option<Point>,
    /// Where it was asked to be since, and the last point that it passes on the way there: it mostly goes to where it was asked for last.
    asked: Option<(Rake, Option<Point>)>,
}

/// The rays ahead of an edge, in the order in which it meets them.
#[derive(Clone, Debug)]
struct RaysAhead {
    /// Along which they are.
    axis: usize,
    first: i64,
    /// From one to the next, 1 or -1.
    way: i64,
    count: i64,
    /// Where the rake face is, in rays.
    crossed: RangeInclusive<f64>,
    /// Which way along the rays the rake face's root is.
    to_root: f64,
    /// Whether the edge's end of a ray across the rake face is behind that.
    has_edge_behind: bool,
}

/// The chip on one ray.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    /// Where the material begins, inside of the edge; without material, where the edge passes.
    begins_mm: Vector2<f64>,
    /// Where it ends, if before the edge.
    ends_mm: Option<Vector2<f64>>,
    has_material: bool,
    /// How high that is.
    top_ratio: f64,
}

impl Rake {
    /// Where the edge is.
    pub fn edge_mm(&self) -> Vector2<f64> {
        self.center_mm + self.towards * self.radius_mm
    }

    /// The other end of the rake face.
    pub fn root_mm(&self) -> Vector2<f64> {
        self.edge_mm() - self.outward() * self.depth_mm
    }

    /// Whether all of the rake face is so far to one side of the layer's rays that nothing there matters.
    pub fn is_apart(&self, layer: &Layer) -> bool {
        [0, 1].into_iter().any(|axis: usize| {
            let at = [self.edge_mm(), self.root_mm()].map(|end| layer.index(axis, end[1 - axis]));
            let end = layer.rays(axis).len() as f64;
            at.iter().all(|at| *at < -APART_RAYS) || at.iter().all(|at| *at > end + APART_RAYS)
        })
    }

    /// Whether there is material on the rays around it, or would be if it were anywhere so far away.
    pub fn is_near(&self, layer: &Layer, margin_mm: f64) -> bool {
        let axis = self.axis();
        let ends_mm = [self.edge_mm(), self.root_mm()];
        let [from_mm, to_mm] = [ends_mm[0].inf(&ends_mm[1]), ends_mm[0].sup(&ends_mm[1])];
        let stretch = Interval::new(from_mm[axis] - margin_mm, to_mm[axis] + margin_mm);
        let [first, last] =
            [from_mm[1 - axis] - margin_mm, to_mm[1 - axis] + margin_mm].map(|mm| layer.index(axis, mm));
        let rays = (first - APART_RAYS).floor() as i64..=(last + APART_RAYS).ceil() as i64;
        layer.is_met(axis, rays, &stretch, self.share.border_ratio)
    }

    /// From the rake face to the material.
    fn outward(&self) -> Vector2<f64> {
        self.towards * f64::from(self.side.advance())
    }

    /// (1)
    fn inside_mm(&self, point_mm: &Vector2<f64>) -> f64 {
        f64::from(self.side.advance()) * (self.radius_mm - (point_mm - self.center_mm).norm())
    }

    /// How far a point is ahead of the rake face, along the tangent at the edge; infinite beyond a quarter of a turn.
    fn ahead_mm(&self, point_mm: &Vector2<f64>) -> f64 {
        let arm = point_mm - self.center_mm;
        let (off, along) = (self.turn_ratio * self.towards.perp(&arm), self.towards.dot(&arm));
        if along > 0.0 { off / along * self.radius_mm } else { f64::INFINITY.copysign(off) }
    }

    /// The axis whose rays meet the surface more squarely.
    fn axis(&self) -> usize {
        usize::from(libm::fabs(self.towards.y) > libm::fabs(self.towards.x))
    }

    /// The rays of which the edge, turning, meets the old surface next.
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

    /// From where to where the rake face is, in rays along an axis.
    fn crossed(&self, layer: &Layer, axis: usize) -> RangeInclusive<f64> {
        let [edge, root] = [self.edge_mm(), self.root_mm()].map(|end| layer.index(axis, end[1 - axis]));
        edge.min(root)..=edge.max(root)
    }

    /// What the edge, turning, meets on a ray ahead of it.
    fn ahead_on(&self, layer: &Layer, rays: &RaysAhead, nth: i64) -> Option<Point> {
        let ray = rays.first + nth * rays.way;
        // Of rays across the rake face most have lost all that is ahead of it.
        if rays.has_edge_behind
            && rays.crossed.contains(&(ray as f64))
            && self.is_passed(layer, rays.axis, ray, rays.to_root)
        {
            return None;
        }
        self.on_ray(layer, rays.axis, ray).filter(|point| self.ahead_mm(&point.begins_mm) > AT_RAKE_MM)
    }

    /// How many of the rays ahead of an earlier place of this edge lie as a whole behind where it is now.
    fn count_behind(&self, layer: &Layer, from: &Rake, rays: &RaysAhead) -> i64 {
        let axis = rays.axis;
        // Beyond this, rays may cross the rake face's line on the other side of the tool's axis.
        if self.towards[axis] * libm::copysign(1.0, from.towards[axis]) < SAME_SIDE_MIN {
            return 0;
        }
        // Points on the rays are as deep in the circle of the earlier place, not in that of this one.
        let margin = ((self.center_mm - from.center_mm).norm() + MARGIN_MM) / layer.step_mm();
        let crossed = self.crossed(layer, axis);
        let behind = match rays.way > 0 {
            true => (crossed.start() - margin).ceil() as i64 - rays.first,
            false => rays.first - (crossed.end() + margin).floor() as i64,
        };
        behind.clamp(0, rays.count.max(0))
    }

    /// Whether a ray that crosses the rake face has no material between that and the circle of its root.
    fn is_passed(&self, layer: &Layer, axis: usize, ray: i64, to_root: f64) -> bool {
        let off_mm = layer.place_mm(axis, 0) + ray as f64 * layer.step_mm() - self.center_mm[1 - axis];
        let at_mm = self.center_mm[axis] + off_mm * self.towards[axis] / self.towards[1 - axis];
        let [one_mm, other_mm] = [at_mm - to_root * MARGIN_MM, at_mm + to_root * FAR_RATIO * self.depth_mm];
        let stretch = Interval::new(one_mm.min(other_mm), one_mm.max(other_mm));
        let is_left = |(material, heights): (&Dexel, &PartialHeights)| {
            material.meets(&stretch) && !heights.is_below(&stretch, self.share.border_ratio)
        };
        !layer.ray(axis, ray).is_some_and(is_left)
    }

    /// The chip on a ray, as the edge will meet it; `None` if it will not come so far.
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
        let (stretch, is_first) = (Interval::new(low, high), edge_mm > root_mm);
        let chip = layer
            .ray(axis, ray)
            .and_then(|(material, heights)| heights.end_piece(material, &stretch, self.share.border_ratio, is_first));
        Some(match chip {
            None => Point { begins_mm: at(edge_mm), ends_mm: None, has_material: false, top_ratio: 1.0 },
            Some(Interval { from_mm, to_mm }) => {
                let (begins, ends) = if edge_mm > root_mm { (from_mm, to_mm) } else { (to_mm, from_mm) };
                // What ends behind the rake face was cut by it: ahead of it, that chip goes on to the edge.
                let ends_mm = Some(at(ends)).filter(|end| ends != edge_mm && self.ahead_mm(end) > AT_RAKE_MM);
                let top_ratio = layer.mean_ratio(axis, ray, &Interval::new(from_mm, to_mm));
                Point { begins_mm: at(begins), ends_mm, has_material: true, top_ratio }
            }
        })
    }

    /// (2)
    fn front(&self, point: &Point) -> Front {
        let ends = point.ends_mm.map_or(0.0, |ends| self.inside_mm(&ends).max(0.0));
        let thickness_mm = (self.inside_mm(&point.begins_mm) - ends).clamp(0.0, self.depth_mm);
        Front { thickness_mm: if thickness_mm > AT_RAKE_MM { thickness_mm } else { 0.0 }, top_ratio: point.top_ratio }
    }
}

impl Wake {
    /// The chip in front of the edge, which has come here from its last cut.
    pub fn front(&mut self, rake: &Rake, layer: &Layer) -> Front {
        if rake.is_apart(layer) {
            return Front::default();
        }
        // On the circle, neighbouring rays are this far apart.
        let apart_mm = layer.step_mm() / libm::fabs(rake.towards[rake.axis()]);
        let (behind, next) = self.around(rake, layer);
        self.asked = Some((*rake, behind));
        // A surface met long ago says nothing of what is here now.
        let behind = behind.map(|point| (rake.ahead_mm(&point.begins_mm), point));
        let behind = behind.filter(|(ahead_mm, point)| point.has_material && -ahead_mm < 2.0 * apart_mm);
        let next = next.map(|point| (rake.ahead_mm(&point.begins_mm), point));
        let next = next.filter(|(ahead_mm, point)| point.has_material && *ahead_mm < 2.0 * apart_mm);
        match (behind, next) {
            (Some((from_mm, behind)), Some((to_mm, next))) => {
                let (from, to) = (rake.front(&behind), rake.front(&next));
                let at = |from: f64, to: f64| from - (to - from) * from_mm / (to_mm - from_mm);
                Front {
                    thickness_mm: at(from.thickness_mm, to.thickness_mm),
                    top_ratio: at(from.top_ratio, to.top_ratio),
                }
            }
            (Some((at_mm, only)), None) | (None, Some((at_mm, only))) if libm::fabs(at_mm) <= apart_mm / 2.0 => {
                rake.front(&only)
            }
            _ => Front::default(),
        }
    }

    /// The same edge in another layer: it comes from where it was, but has passed nothing there.
    pub fn in_other_layer(&self) -> Self {
        Wake { behind: None, asked: None, ..*self }
    }

    /// Whether the edge has just passed material, from which a chip may still be known.
    pub fn has_left(&self, rake: &Rake, layer: &Layer) -> bool {
        let far_mm = APART_RAYS * layer.step_mm() / libm::fabs(rake.towards[rake.axis()]);
        self.behind.is_some_and(|point| point.has_material && -rake.ahead_mm(&point.begins_mm) < far_mm)
    }

    /// How far the rake face has come since the last cut.
    pub fn way_mm(&self, rake: &Rake) -> f64 {
        let from = self.last.as_ref().unwrap_or(rake);
        (rake.edge_mm() - from.edge_mm()).norm().max((rake.root_mm() - from.root_mm()).norm())
    }

    /// The edge goes to its next place where it meets nothing.
    pub fn pass(&mut self, rake: &Rake) {
        *self = Wake { last: Some(*rake), behind: None, asked: None };
    }

    /// The edge goes to its next place, less than a quarter of a turn on, and takes what it sweeps; answers the area as the rays
    /// along each axis have it, mm2.
    pub fn cut(&mut self, rake: &Rake, layer: &mut Layer) -> [f64; 2] {
        if rake.is_apart(layer) && self.last.is_none_or(|last| last.is_apart(layer)) {
            self.pass(rake);
            return [0.0; 2];
        }
        self.behind = match self.asked.take() {
            Some((asked, behind)) if asked == *rake => behind,
            _ => self.around(rake, layer).0,
        };
        let Some(from) = self.last.replace(*rake) else { return [0.0; 2] };
        let ends_mm = |rake: &Rake| [rake.root_mm(), rake.edge_mm()];
        layer.clear_strip([ends_mm(&from), ends_mm(rake)], f64::from(rake.side.advance()) * rake.radius_mm, &rake.share)
    }

    /// The points of the old surface on both sides of a rake face that has come here from the last cut.
    fn around(&self, rake: &Rake, layer: &Layer) -> (Option<Point>, Option<Point>) {
        let from = Rake { share: rake.share, ..self.last.unwrap_or(*rake) };
        let rays = from.rays_ahead(layer);
        let passed = rake.count_behind(layer, &from, &rays);
        let (mut behind, mut ahead) = (None, None);
        for point in (passed..rays.count).filter_map(|nth| from.ahead_on(layer, &rays, nth)) {
            if rake.ahead_mm(&point.begins_mm) > 0.0 {
                ahead = Some(point);
                break;
            }
            behind = Some(point);
        }
        // Of the rays that were passed on the way only the last one counts.
        let on_way = || (0..passed).rev().find_map(|nth| from.ahead_on(layer, &rays, nth));
        (behind.or_else(on_way).or(self.behind), ahead)
    }
}
