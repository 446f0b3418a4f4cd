//! Line on a blade's side along which a ball end mill touches it, at one height.
//!
//! In the plane square to the span: points from the leading edge to the trailing edge, each with its outward normal and
//! its coordinate s from -1/2 to 1/2. Beyond the edges the line continues straight.

use nalgebra::Vector2;

use crate::blade::Blade;

/// Change of s for finding the line's direction.
const AHEAD_RATIO: f64 = 1e-5;

/// Number of points for measuring the line's length.
const POINTS: usize = 400;

/// Convex side of a blade in a section at one height along its span.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Side {
    blade: Blade,
    height_ratio: f64,
    length_mm: f64,
}

/// Point at which the tool touches the blade, with the normal there, both in the plane of the section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Position of the point.
    pub point_mm: Vector2<f64>,
    /// Normal out of the material, a unit vector.
    pub normal: Vector2<f64>,
}

impl Side {
    /// Side of a blade at this fraction of its span, from the root.
    pub fn new(blade: Blade, height_ratio: f64) -> Self {
        let mut side = Side { blade, height_ratio, length_mm: 0.0 };
        let points: Vec<Vector2<f64>> = (0..=POINTS).map(|n| side.surface_mm(n as f64 / POINTS as f64 - 0.5)).collect();
        side.length_mm = points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        side
    }

    /// Length of the side from the leading edge to the trailing edge, mm.
    pub fn length_mm(&self) -> f64 {
        self.length_mm
    }

    /// Height of the section along the span, mm.
    pub fn height_mm(&self) -> f64 {
        self.height_ratio * self.blade.span_mm
    }

    fn at_mm(&self, s: f64, n: f64) -> Vector2<f64> {
        let [x, y, _] = self.blade.point_mm([s, n, self.height_ratio]);
        Vector2::new(x, y)
    }

    fn surface_mm(&self, s: f64) -> Vector2<f64> {
        self.at_mm(s, 0.5)
    }

    /// Contact at this distance along the side from its middle; beyond the blade's edges the side continues straight.
    pub fn contact(&self, along_mm: f64) -> Contact {
        let s = along_mm / self.length_mm;
        let on = s.clamp(-0.5, 0.5);
        let tangent = (self.surface_mm(on + AHEAD_RATIO) - self.surface_mm(on - AHEAD_RATIO)).normalize();
        let point_mm = self.surface_mm(on) + tangent * ((s - on) * self.length_mm);
        Contact { point_mm, normal: Vector2::new(-tangent.y, tangent.x) }
    }

    /// Point of the blade, in the blade's coordinates, at which the cutting force acts on its modes.
    pub fn place_mm(&self, along_mm: f64) -> [f64; 3] {
        self.blade.point_mm([(along_mm / self.length_mm).clamp(-0.5, 0.5), 0.5, self.height_ratio])
    }

    /// Closed outline of the blade's section, with an allowance on this side only.
    pub fn outline_mm(&self, allowance_mm: f64) -> Vec<Vector2<f64>> {
        let part = |n: usize| n as f64 / POINTS as f64 - 0.5;
        let raised = |n: usize| {
            let Contact { point_mm, normal } = self.contact(part(n) * self.length_mm);
            point_mm + normal * allowance_mm
        };
        (0..=POINTS).map(raised).chain((0..=POINTS).rev().map(|n| self.at_mm(part(n), -0.5))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plate_has_a_straight_side_that_goes_on_beyond_its_edges() {
        let side = Side::new(Blade::plate(40.0, 30.0, 2.0), 0.5);
        assert!((side.length_mm() - 30.0).abs() < 1e-9);
        for along_mm in [-18.0, -15.0, 0.0, 7.0, 21.0] {
            let contact = side.contact(along_mm);
            assert!((contact.point_mm - Vector2::new(along_mm, 1.0)).norm() < 1e-9);
            assert!((contact.normal - Vector2::y()).norm() < 1e-9);
        }
        assert_eq!(side.place_mm(99.0), [15.0, 1.0, 20.0]);
    }
}
