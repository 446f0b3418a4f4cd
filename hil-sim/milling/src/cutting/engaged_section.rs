//! Engaged section of a tool's end: the part of its edges, by direction, that has material below it.
//!
//! A radial edge in direction u is in material on parts of its length. With these parts [r1, r2]:
//!
//! ```text
//! width   = sum of (r2 - r1)                     mm      (1)
//! moment  = sum of (r2^2 - r1^2) / 2             mm2     (2)
//! area    = integral of moment over a turn       mm2     (3)
//! ```
//!
//! A force per width acts at its radius, so its torque is that force times (2). Edges at equal angles add up; the largest
//! sum over a turn is the peak that the spindle feels.
//!
//! Source: geometry.

use std::f64::consts::TAU;

use nalgebra::Vector2;

use super::layer::Layer;

/// Directions sampled for each ray that the rim passes.
const DIRECTIONS_PER_STEP: f64 = 4.0;
/// Points sampled along an edge for each ray.
const POINTS_PER_STEP: f64 = 2.0;

/// Engaged part of one radial edge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct EngagedEdge {
    width_mm: f64,
    moment_mm2: f64,
}

/// Engaged part of a tool's end: for evenly spaced directions, the width and the moment of a radial edge that has material below it.
#[derive(Clone, Debug, PartialEq)]
pub struct EngagedSection {
    by_direction: Vec<EngagedEdge>,
}

impl EngagedSection {
    /// Section from the engaged parts of a radial edge: `parts_mm` returns them, `[from, to]` in mm from the axis, for an angle in rad.
    /// `directions` is the number of angles, evenly spaced over a turn.
    pub fn new(directions: usize, parts_mm: impl Fn(f64) -> Vec<[f64; 2]>) -> Self {
        let edge = |direction: usize| {
            let parts_mm = parts_mm((direction as f64 + 0.5) * TAU / directions as f64);
            EngagedEdge {
                width_mm: parts_mm.iter().map(|[from, to]| to - from).sum(), // (1)
                moment_mm2: parts_mm.iter().map(|[from, to]| (to * to - from * from) / 2.0).sum(), // (2)
            }
        };
        EngagedSection { by_direction: (0..directions).map(edge).collect() }
    }

    /// Section of a ring, or of a disc with the inner radius 0, for this number of edges. `is_material` returns whether there is
    /// material below a point of the plane. Each engaged part is lengthened by half the rays' distance at both ends.
    pub fn of_ring(
        center_mm: Vector2<f64>,
        [inner_mm, outer_mm]: [f64; 2],
        edges: usize,
        (step_mm, is_material): (f64, impl Fn(Vector2<f64>) -> bool),
    ) -> Self {
        let per_edge = libm::ceil(TAU * outer_mm / step_mm * DIRECTIONS_PER_STEP / edges as f64);
        let count = libm::ceil((outer_mm - inner_mm) / step_mm * POINTS_PER_STEP).max(1.0);
        let length_mm = (outer_mm - inner_mm) / count;
        EngagedSection::new(edges * per_edge as usize, |angle_rad| {
            let (sin, cos) = libm::sincos(angle_rad);
            let mut parts_mm: Vec<[f64; 2]> = Vec::new();
            for point in 0..count as u64 {
                let from_mm = inner_mm + point as f64 * length_mm;
                let middle_mm = from_mm + length_mm / 2.0;
                if !is_material(center_mm + Vector2::new(cos, sin) * middle_mm) {
                    continue;
                }
                let low_mm = (from_mm - step_mm / 2.0).max(inner_mm);
                let high_mm = (from_mm + length_mm + step_mm / 2.0).min(outer_mm);
                match parts_mm.last_mut() {
                    Some(last) if low_mm <= last[1] => last[1] = high_mm,
                    _ => parts_mm.push([low_mm, high_mm]),
                }
            }
            parts_mm
        })
    }

    /// Engaged area of the tool's end, mm2. (3)
    pub fn area_mm2(&self) -> f64 {
        let moments = self.by_direction.iter().map(|edge| edge.moment_mm2);
        moments.sum::<f64>() * TAU / self.by_direction.len() as f64
    }

    /// Largest engaged width of one radial edge over a turn, mm. (1)
    pub fn width_max_mm(&self) -> f64 {
        self.by_direction.iter().map(|edge| edge.width_mm).fold(0.0, f64::max)
    }

    /// Sum of the angles of all directions in which an edge has material below it, rad.
    pub fn engaged_rad(&self) -> f64 {
        let engaged = self.by_direction.iter().filter(|edge| edge.width_mm > 0.0).count();
        engaged as f64 / self.by_direction.len() as f64 * TAU
    }

    /// Engaged widths of `edges` evenly spaced radial edges, added up at the angle of rotation at which the sum is largest, mm. The engaged
    /// width of an edge is the length of it that has material below.
    pub fn width_sum_max_mm(&self, edges: usize) -> f64 {
        self.sum_max(edges, |edge| edge.width_mm)
    }

    /// Moments (2) of `edges` evenly spaced radial edges, added up at the angle of rotation at which the sum is largest, mm2; it gives the
    /// peak torque.
    pub fn moment_sum_max_mm2(&self, edges: usize) -> f64 {
        self.sum_max(edges, |edge| edge.moment_mm2)
    }

    /// Largest sum of a value; the number of directions is a multiple of `edges`.
    fn sum_max(&self, edges: usize, value: impl Fn(&EngagedEdge) -> f64) -> f64 {
        let pitch = self.by_direction.len() / edges;
        let sum = |first: usize| (0..edges).map(|edge| value(&self.by_direction[first + edge * pitch])).sum();
        (0..pitch).map(sum).fold(0.0, f64::max)
    }
}

/// Whether the material of a layer at a point is higher than `above_ratio` of the layer's height, on the ray whose direction is
/// nearer to that from `center_mm` to the point. Points beside the layer have no material.
pub fn is_above(layer: &Layer, point_mm: Vector2<f64>, center_mm: Vector2<f64>, above_ratio: f64) -> bool {
    let arm_mm = point_mm - center_mm;
    let axis = usize::from(libm::fabs(arm_mm.y) > libm::fabs(arm_mm.x));
    layer.top_ratio(point_mm, axis).is_some_and(|top_ratio| top_ratio > above_ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn section_of_a_full_ring_is_exact_and_of_a_half_disc_larger_by_half_a_ray() {
        let layer = Layer::rectangle([-20.0, -20.0], [40.0, 20.0], 0.1);
        let center_mm = Vector2::new(0.0, -10.0);
        let below = |point_mm: Vector2<f64>| is_above(&layer, point_mm, center_mm, 0.0);
        let ring = EngagedSection::of_ring(center_mm, [3.0, 5.0], 4, (0.1, below));
        assert!((ring.area_mm2() / (TAU / 2.0 * 16.0) - 1.0).abs() < 1e-9, "{}", ring.area_mm2());
        assert!((ring.moment_sum_max_mm2(4) / 32.0 - 1.0).abs() < 1e-9 && (ring.width_max_mm() - 2.0).abs() < 1e-9);
        let center_mm = Vector2::zeros();
        let below = |point_mm: Vector2<f64>| is_above(&layer, point_mm, center_mm, 0.0);
        let half = EngagedSection::of_ring(center_mm, [0.0, 5.0], 4, (0.1, below));
        assert!((0.0..0.05).contains(&(half.area_mm2() / (TAU / 4.0 * 25.0) - 1.0)), "{}", half.area_mm2());
        assert!((0.0..0.1).contains(&(half.engaged_rad() - TAU / 2.0)));
        // Of four edges two are in material, or three where one is at the border.
        assert!((25.0..37.6).contains(&half.moment_sum_max_mm2(4)), "{}", half.moment_sum_max_mm2(4));
    }
}
