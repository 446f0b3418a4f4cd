//! Engaged arcs of a cutting circle (intervals of directions with material), measured in the stock for laws that use them.

use std::f64::consts::TAU;

use arcfeed_model::tool::Edge;
use nalgebra::Vector2;

use super::layer::Layer;

/// Directions sampled for each ray that the circle passes.
const DIRECTIONS_PER_STEP: f64 = 4.0;

/// Cutting circle of a tool at one position, in the plane of the layers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeCircle {
    /// Position of the tool's axis.
    pub center_mm: Vector2<f64>,
    /// Radius of the circle on which the edges move.
    pub radius_mm: f64,
    /// Whether the edges are on the outer or on the inner cutting circle.
    pub side: Edge,
}

impl EdgeCircle {
    /// Engaged arcs: intervals of directions, rad, in which there is material of the layer `ahead_mm` in front of the edges, higher than
    /// `above_ratio` of the layer's height. They are exact to a quarter of the rays' distance. Angles are counter-clockwise
    /// from the layer's first axis; each arc begins below a full turn and appears once.
    pub fn engaged_rad(&self, layer: &Layer, ahead_mm: f64, above_ratio: f64) -> Vec<[f64; 2]> {
        let directions = (TAU * self.radius_mm / layer.step_mm() * DIRECTIONS_PER_STEP).ceil() as usize;
        let apart_rad = TAU / directions as f64;
        let reach_mm = self.radius_mm + f64::from(self.side.advance()) * ahead_mm;
        let mut is_in = vec![false; directions];
        let mut direction = 0;
        while direction < directions {
            let (sin, cos) = libm::sincos((direction as f64 + 0.5) * apart_rad);
            let point_mm = self.center_mm + Vector2::new(cos, sin) * reach_mm;
            // No point on the circle is farther from this one than the arc between them is long.
            let beside_mm = distance_mm(&layer.extent_mm(), &point_mm) - layer.step_mm();
            if beside_mm > 0.0 {
                direction += ((beside_mm / (reach_mm * apart_rad)) as usize).max(1);
                continue;
            }
            let axis = usize::from(sin * sin > cos * cos);
            is_in[direction] = layer.top_ratio(point_mm, axis).is_some_and(|top_ratio| top_ratio > above_ratio);
            direction += 1;
        }
        let is_in = |direction: usize| is_in[direction % directions];
        let begins = (0..directions).filter(|direction| is_in(*direction) && !is_in(direction + directions - 1));
        let arcs: Vec<[f64; 2]> = begins
            .map(|begin| {
                let end =
                    (begin..begin + directions).find(|direction| !is_in(*direction)).unwrap_or(begin + directions);
                [begin as f64 * apart_rad, end as f64 * apart_rad]
            })
            .collect();
        if arcs.is_empty() && is_in(0) { vec![[0.0, TAU]] } else { arcs }
    }
}

/// Distance of a point from a rectangle, given by its lowest and highest corner; 0 inside.
fn distance_mm([low_mm, high_mm]: &[[f64; 2]; 2], point_mm: &Vector2<f64>) -> f64 {
    let off_mm = |axis: usize| (low_mm[axis] - point_mm[axis]).max(point_mm[axis] - high_mm[axis]).max(0.0);
    libm::hypot(off_mm(0), off_mm(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arc_ends_where_the_material_does() {
        // Material from x = 3 on.
        let layer = Layer::rectangle([3.0, -20.0], [20.0, 40.0], 0.1);
        let circle = EdgeCircle { center_mm: Vector2::zeros(), radius_mm: 5.0, side: Edge::Outer };
        let arcs = circle.engaged_rad(&layer, 0.0, 0.0);
        let end = libm::acos(0.6);
        assert_eq!(arcs.len(), 1);
        for (found, should) in arcs[0].into_iter().zip([TAU - end, TAU + end]) {
            assert!((found - should).abs() < 0.1 / 5.0, "{arcs:?}");
        }
    }

    #[test]
    fn all_round_and_not_at_all() {
        let layer = Layer::rectangle([-20.0; 2], [40.0; 2], 0.5);
        let circle = EdgeCircle { center_mm: Vector2::zeros(), radius_mm: 5.0, side: Edge::Inner };
        assert_eq!(circle.engaged_rad(&layer, 0.1, 0.0), [[0.0, TAU]]);
        let mut low = layer.clone();
        low.lower_ring(Vector2::zeros(), [0.0, 6.0], 0.4);
        assert_eq!(circle.engaged_rad(&low, 0.1, 0.3), [[0.0, TAU]]);
        assert!(circle.engaged_rad(&low, 0.1, 0.4).is_empty());
        let mut gone = layer;
        gone.clear_ring(Vector2::zeros(), 0.0, 6.0);
        assert!(circle.engaged_rad(&gone, 0.1, 0.0).is_empty());
    }
}
