//! Tool as pieces with an exact signed distance everywhere, and its gradient.
//!
//! In the half plane through the axis a piece is a box with middle m and half sides b, grown by a rounding:
//!
//! ```text
//! d = |max(|p - m| - b, 0)| + min(max(|p - m| - b), 0) - rounding             (1)
//! ```
//!
//! A disc's box extends equally to the other side of the axis. Outside of the tool the least distance over a part's
//! pieces is
//! [`CupMill::distance_of_mm`].

use crate::cutter::{CupMill, ToolPart};

/// Piece of the tool in the half plane through its axis: a box with rounded corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    low: [f64; 2],
    high: [f64; 2],
    rounding_mm: f64,
}

impl Section {
    /// All pieces of a part of the tool.
    pub fn of(tool: &CupMill, part: ToolPart) -> Vec<Section> {
        match part {
            ToolPart::Ring => {
                let rounding_mm = tool.insert_radius_mm;
                let low = [tool.inner_radius_mm + rounding_mm, rounding_mm];
                let high = [tool.outer_radius_mm - rounding_mm, tool.height_mm - rounding_mm];
                vec![Section { low, high, rounding_mm }]
            }
            ToolPart::Body => vec![Section::disc(tool.outer_radius_mm, [tool.cavity_depth_mm, tool.height_mm])],
            ToolPart::Holder => {
                let discs = tool.holder_mm.iter().scan(tool.height_mm, |from_mm, [radius_mm, length_mm]| {
                    let heights_mm = [*from_mm, *from_mm + length_mm];
                    *from_mm = heights_mm[1];
                    Some(Section::disc(*radius_mm, heights_mm))
                });
                discs.collect()
            }
        }
    }

    fn disc(radius_mm: f64, heights_mm: [f64; 2]) -> Section {
        Section::rounded_disc(radius_mm, heights_mm, 0.0)
    }

    /// Cylinder about the axis between two heights, with rounded edges.
    pub fn rounded_disc(radius_mm: f64, heights_mm: [f64; 2], rounding_mm: f64) -> Section {
        let half_mm = radius_mm - rounding_mm;
        let [low_mm, high_mm] = [heights_mm[0] + rounding_mm, heights_mm[1] - rounding_mm];
        Section { low: [-half_mm, low_mm], high: [half_mm, high_mm], rounding_mm }
    }

    /// Signed distance of a point, mm, by its distance from the axis and its height above the tool's bottom; negative
    /// inside, where its amount is the distance to the nearest surface.
    pub fn distance_mm(&self, radius_mm: f64, height_mm: f64) -> f64 {
        let [(across, _), (up, _)] = self.beyond(radius_mm, height_mm);
        libm::hypot(across.max(0.0), up.max(0.0)) + across.max(up).min(0.0) - self.rounding_mm // (1)
    }

    /// Gradient of the distance with respect to radius and height: a unit vector; if there are several, one of them.
    pub fn slope(&self, radius_mm: f64, height_mm: f64) -> [f64; 2] {
        let [(across, outward), (up, upward)] = self.beyond(radius_mm, height_mm);
        let length = libm::hypot(across.max(0.0), up.max(0.0));
        if length > 0.0 {
            [outward * across.max(0.0) / length, upward * up.max(0.0) / length]
        } else if across > up {
            [outward, 0.0]
        } else {
            [0.0, upward]
        }
    }

    /// Distance past the nearer side of the box, and the sign of that side, for each direction.
    fn beyond(&self, radius_mm: f64, height_mm: f64) -> [(f64, f64); 2] {
        let place = [radius_mm, height_mm];
        [0, 1].map(|axis| {
            let (below, above) = (self.low[axis] - place[axis], place[axis] - self.high[axis]);
            if below > above { (below, -1.0) } else { (above, 1.0) }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tool() -> CupMill {
        CupMill {
            outer_radius_mm: 30.0,
            inner_radius_mm: 20.0,
            insert_radius_mm: 3.0,
            cavity_depth_mm: 25.0,
            height_mm: 40.0,
            holder_mm: vec![[15.0, 30.0], [25.0, 10.0]],
            active_teeth: 5,
        }
    }

    #[test]
    fn section_distance_agrees_with_the_tool_and_its_slope_with_the_gradient() {
        for part in [ToolPart::Ring, ToolPart::Body, ToolPart::Holder] {
            let sections = Section::of(&tool(), part);
            for place in (0..3600).map(|k| [f64::from(k % 60), f64::from(k / 60) * 1.7 - 10.0]) {
                let near = sections.iter().map(|section| section.distance_mm(place[0], place[1]));
                let distance_mm = near.fold(f64::INFINITY, f64::min);
                let computed_mm = tool().distance_of_mm(part, place[0], place[1]);
                assert!(
                    (distance_mm - computed_mm).abs() < 1e-12 || (distance_mm < 0.0 && computed_mm <= 0.0),
                    "{place:?}"
                );
            }
        }
        let ring = Section::of(&tool(), ToolPart::Ring)[0];
        for [radius_mm, height_mm] in [[35.3, 10.0], [31.0, 1.0], [19.5, 0.5], [25.0, -7.0], [10.0, 20.0], [29.0, 10.0]]
        {
            let at = |dr: f64, dh: f64| ring.distance_mm(radius_mm + dr, height_mm + dh);
            let slope = ring.slope(radius_mm, height_mm);
            assert!((slope[0] - (at(1e-6, 0.0) - at(-1e-6, 0.0)) / 2e-6).abs() < 1e-6, "{radius_mm} {height_mm}");
            assert!((slope[1] - (at(0.0, 1e-6) - at(0.0, -1e-6)) / 2e-6).abs() < 1e-6, "{radius_mm} {height_mm}");
        }
        assert_eq!(ring.distance_mm(28.0, 20.0), -2.0);
    }
}
