//! Engaged arcs of a cutting circle (intervals of directions with material), measured in the stock for laws that use them.

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
    /// Distance in front of the edges within which material counts.
    pub ahead_mm: f64,
}

impl EdgeCircle {
    /// Engaged arc: from the first to the last direction in `within_rad` in which there is material of the layer in front of the edges,
    /// higher than `above_ratio` of the layer's height; exact to a quarter of the rays' distance. The arc includes `known_rad`, that of
    /// other layers, inside of which nothing is looked up. `None` without material and without a known arc. Angles are
    /// counter-clockwise from the layer's first axis.
    pub fn engaged_rad(
        &self,
        layer: &Layer,
        above_ratio: f64,
        within_rad: [f64; 2],
        known_rad: Option<[f64; 2]>,
    ) -> Option<[f64; 2]> {
        let [from_rad, to_rad] = within_rad;
        let known = |end: usize| known_rad.map(|ends| ends[end]);
        let first = self.first_rad(layer, above_ratio, [from_rad, known(0).unwrap_or(to_rad)]).or(known(0))?;
        let last = self.first_rad(layer, above_ratio, [to_rad, known(1).unwrap_or(first)]).or(known(1));
        Some([first, last.unwrap_or(first)])
    }

    /// First direction with material on the way from one direction to another, in either sense.
    fn first_rad(&self, layer: &Layer, above_ratio: f64, [from_rad, to_rad]: [f64; 2]) -> Option<f64> {
        let apart_rad = layer.step_mm() / DIRECTIONS_PER_STEP / self.radius_mm;
        let reach_mm = self.radius_mm + f64::from(self.side.advance()) * self.ahead_mm;
        let (way_rad, extent_mm) = (to_rad - from_rad, layer.extent_mm());
        let mut passed_rad = 0.0;
        while passed_rad < libm::fabs(way_rad) {
            let (sin, cos) = libm::sincos(from_rad + libm::copysign(passed_rad + apart_rad / 2.0, way_rad));
            let point_mm = self.center_mm + Vector2::new(cos, sin) * reach_mm;
            // No point on the circle is farther from this one than the arc between them is long.
            let beside_mm = distance_mm(&extent_mm, &point_mm) - layer.step_mm();
            if beside_mm > 0.0 {
                passed_rad += (beside_mm / reach_mm).max(apart_rad);
                continue;
            }
            let axis = usize::from(sin * sin > cos * cos);
            if layer.top_ratio(point_mm, axis).is_some_and(|top_ratio| top_ratio > above_ratio) {
                return Some(from_rad + libm::copysign(passed_rad, way_rad));
            }
            passed_rad += apart_rad;
        }
        None
    }
}

/// Distance of a point from a rectangle, given by its lowest and highest corner; 0 inside.
fn distance_mm([low_mm, high_mm]: &[[f64; 2]; 2], point_mm: &Vector2<f64>) -> f64 {
    let off_mm = |axis: usize| (low_mm[axis] - point_mm[axis]).max(point_mm[axis] - high_mm[axis]).max(0.0);
    libm::hypot(off_mm(0), off_mm(1))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    const ROUND: [f64; 2] = [-PI, PI];

    fn circle(side: Edge, ahead_mm: f64) -> EdgeCircle {
        EdgeCircle { center_mm: Vector2::zeros(), radius_mm: 5.0, side, ahead_mm }
    }

    #[track_caller]
    fn assert_near(found: Option<[f64; 2]>, should: [f64; 2]) {
        let found = found.expect("material");
        assert!(found.iter().zip(should).all(|(a, b)| (a - b).abs() < 0.1 / 5.0), "{found:?} {should:?}");
    }

    #[test]
    fn an_arc_ends_where_the_material_does() {
        // Material from x = 3 on.
        let layer = Layer::rectangle([3.0, -20.0], [20.0, 40.0], 0.1);
        let (circle, end) = (circle(Edge::Outer, 0.0), libm::acos(0.6));
        assert_near(circle.engaged_rad(&layer, 0.0, ROUND, None), [-end, end]);
        assert_near(circle.engaged_rad(&layer, 0.0, [0.0, PI], None), [0.0, end]);
        assert_near(circle.engaged_rad(&layer, 0.0, [2.0 * PI, 3.0 * PI], None), [2.0 * PI, 2.0 * PI + end]);
        assert_eq!(circle.engaged_rad(&layer, 0.0, [1.0, PI], None), None);
    }

    #[test]
    fn a_known_arc_is_widened_but_not_narrowed() {
        let layer = Layer::rectangle([3.0, -20.0], [20.0, 40.0], 0.1);
        let (circle, end) = (circle(Edge::Outer, 0.0), libm::acos(0.6));
        assert_near(circle.engaged_rad(&layer, 0.0, ROUND, Some([-0.2, 0.1])), [-end, end]);
        assert_eq!(circle.engaged_rad(&layer, 0.0, ROUND, Some([-2.0, 1.0])), Some([-2.0, 1.0]));
        assert_near(circle.engaged_rad(&layer, 0.0, ROUND, Some([-2.0, -1.5])), [-2.0, end]);
        assert_eq!(circle.engaged_rad(&layer, 0.0, [1.0, PI], Some([2.0, 2.5])), Some([2.0, 2.5]));
    }

    #[test]
    fn all_round_and_not_at_all() {
        let layer = Layer::rectangle([-20.0; 2], [40.0; 2], 0.5);
        let circle = circle(Edge::Inner, 0.1);
        assert_eq!(circle.engaged_rad(&layer, 0.0, ROUND, None), Some(ROUND));
        let mut low = layer.clone();
        low.lower_ring(Vector2::zeros(), [0.0, 6.0], 0.4);
        assert_eq!(circle.engaged_rad(&low, 0.3, ROUND, None), Some(ROUND));
        assert_eq!(circle.engaged_rad(&low, 0.4, ROUND, None), None);
        let mut gone = layer;
        gone.clear_ring(Vector2::zeros(), 0.0, 6.0);
        assert_eq!(circle.engaged_rad(&gone, 0.0, ROUND, None), None);
    }
}
