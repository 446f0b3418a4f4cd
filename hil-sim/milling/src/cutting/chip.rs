//! Chip thickness from two positions of the tool, one tooth apart.
//!
//! In the time of one tooth the centre moves by `delta`. In direction u the cutting circle is then
//!
//! ```text
//! chip(u) = k u.delta - k c^2 / (r0 + sqrt(r0^2 - c^2)),    c = u x delta     (1)
//! ```
//!
//! further into the material: exact for a circle moved by delta. The tool's own rotation changes it by
//! (s z / 2 pi r0) cos th, 0.2 % at 32 degrees on the published tool; neglected.
//!
//! Source: plane geometry; docs/laws.md#measured-chip.

use arcfeed_model::stock::StockLine;
use nalgebra::Vector2;

/// Cutting circle of a tool: its radius, and the radial direction in which its edges cut (+1 outward, -1 inward).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Radius, r0.
    pub radius_mm: f64,
    /// Direction factor k: 1 for edges on the outer circle, which cut outward; -1 for those on the inner circle of a ring.
    pub advance_ratio: f64,
}

impl Circle {
    /// Chip thickness, mm, in the direction `u` from the centre when the centre moves by `delta_mm` in the time of one tooth. (1)
    pub fn chip_mm(&self, u: &Vector2<f64>, delta_mm: &Vector2<f64>) -> f64 {
        let r0 = self.radius_mm;
        let across = u.perp(delta_mm);
        let sagitta = across * across / (r0 + libm::sqrt(r0 * r0 - across * across));
        self.advance_ratio * (u.dot(delta_mm) - sagitta)
    }

    /// Unit vectors from the centre to the two points where the circle crosses the stock line; `None` if it does not reach the line.
    pub fn crossings(&self, center_mm: &Vector2<f64>, stock: &StockLine) -> Option<[Vector2<f64>; 2]> {
        let normal = Vector2::from(stock.normal);
        let along_normal = stock.distance_mm([center_mm.x, center_mm.y]) / self.radius_mm;
        let square = 1.0 - along_normal * along_normal;
        if square < 0.0 {
            return None;
        }
        let along_line = Vector2::new(-normal.y, normal.x) * libm::sqrt(square);
        Some([1.0, -1.0].map(|side| normal * along_normal + along_line * side))
    }

    /// Chip thickness, mm, at the contact that the circumference law uses: the crossing with the stock line on the side
    /// to which the edge advances, at most 90 degrees from the direction to the rotation centre; the thicker chip if there are two.
    /// `None` without such a crossing.
    pub fn contact_chip_mm(
        &self,
        center_mm: &Vector2<f64>,
        rotation_center_mm: &Vector2<f64>,
        delta_mm: &Vector2<f64>,
        stock: &StockLine,
    ) -> Option<f64> {
        let towards = rotation_center_mm - center_mm;
        // The direction of motion at the start of the tooth: square to the radius, to the side of the step.
        let square_to_radius = Vector2::new(-towards.y, towards.x);
        let motion = if square_to_radius.dot(delta_mm) < 0.0 { -square_to_radius } else { square_to_radius };
        self.crossings(center_mm, stock)?
            .into_iter()
            .filter(|u| u.dot(&towards) >= 0.0 && self.advance_ratio * u.dot(&motion) > 0.0)
            .map(|u| self.chip_mm(&u, delta_mm))
            .max_by(f64::total_cmp)
    }

    /// Thickest chip, mm, of the circle in the stock's half plane: in the direction of motion if there is material, otherwise at the
    /// crossing with the stock line nearer to that direction. `None` if the circle does not cut.
    pub fn thickest_chip_mm(
        &self,
        center_mm: &Vector2<f64>,
        delta_mm: &Vector2<f64>,
        stock: &StockLine,
    ) -> Option<f64> {
        let forward = delta_mm.try_normalize(0.0)? * self.advance_ratio;
        let reach = center_mm + forward * self.radius_mm;
        if stock.distance_mm([reach.x, reach.y]) >= 0.0 {
            return Some(self.chip_mm(&forward, delta_mm));
        }
        let chips = self.crossings(center_mm, stock)?.map(|u| self.chip_mm(&u, delta_mm));
        chips.into_iter().max_by(f64::total_cmp).filter(|chip| *chip > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OUTER: Circle = Circle { radius_mm: 128.576, advance_ratio: 1.0 };
    const INNER: Circle = Circle { radius_mm: 112.701, advance_ratio: -1.0 };

    #[test]
    fn straight_ahead_the_chip_is_the_step() {
        let delta = Vector2::new(0.1, 0.0);
        assert!((OUTER.chip_mm(&Vector2::x(), &delta) - 0.1).abs() < 1e-15);
        assert!((INNER.chip_mm(&-Vector2::x(), &delta) - 0.1).abs() < 1e-15);
        assert!(OUTER.chip_mm(&Vector2::y(), &delta) < 0.0);
    }

    #[test]
    fn the_moved_circle_passes_through_the_end_of_the_chip() {
        let delta = Vector2::new(0.13, -0.07);
        for (circle, angle_deg) in [(OUTER, 20.0_f64), (OUTER, -50.0), (INNER, 130.0), (INNER, 200.0)] {
            let (sin, cos) = libm::sincos(angle_deg.to_radians());
            let u = Vector2::new(cos, sin);
            let chip_mm = circle.chip_mm(&u, &delta);
            let point = u * (circle.radius_mm + circle.advance_ratio * chip_mm);
            assert!(((point - delta).norm() - circle.radius_mm).abs() < 1e-12, "{angle_deg}");
        }
    }

    #[test]
    fn crossings_lie_on_the_stock_line() {
        let stock = StockLine::from_angle(54.187, 107.67);
        let center = Vector2::new(-80.0, 280.0);
        for u in OUTER.crossings(&center, &stock).unwrap() {
            assert!((u.norm() - 1.0).abs() < 1e-12);
            let point = center + u * OUTER.radius_mm;
            assert!(stock.distance_mm([point.x, point.y]).abs() < 1e-10);
        }
        assert_eq!(OUTER.crossings(&Vector2::new(0.0, 1e3), &stock), None);
    }

    #[test]
    fn the_thickest_chip_is_the_step_where_the_tool_faces_material() {
        let delta = Vector2::new(0.1, 0.0);
        let ahead = StockLine::from_angle(180.0, 0.0);
        let thickest = OUTER.thickest_chip_mm(&Vector2::zeros(), &delta, &ahead);
        assert!((thickest.unwrap() - 0.1).abs() < 1e-15);
        let behind = StockLine::from_angle(0.0, 0.0);
        let thickest = OUTER.thickest_chip_mm(&Vector2::new(1.0, 0.0), &delta, &behind);
        assert_eq!(thickest, None);
    }
}
