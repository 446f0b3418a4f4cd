//! Stock in the plane of a segment: half planes, convex pieces, round blanks, or a table of engaged arcs. Coordinates
//! are those of the plane's first and second axis: X and Y in G17, Z and X in G18, Y and Z in G19.

use heapless::Vec;

use crate::engaged::EngagedTable;

/// Largest number of lines that bound a convex piece of stock.
pub const EDGES_MAX: usize = 8;

/// Stock in the plane of the segments that cut it. Coordinates are those of the program, mm, along the plane's first
/// and second axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Stock {
    /// Area on the material side of every one of up to eight lines. No line: the whole plane is material; one line: a
    /// half plane; three or more: in general a convex polygon.
    Convex(Vec<StockLine, EDGES_MAX>),
    /// A round blank.
    Disc {
        /// Centre.
        center_mm: [f64; 2],
        /// Radius.
        radius_mm: f64,
    },
    /// Not a shape, but the directions from the tool's centre in which the cup mill's edges are in material, along the
    /// segment.
    Engaged(EngagedTable),
    /// As [`Self::Engaged`], but the directions arrive separately with each segment. The engagement of a segment for
    /// which none arrive is unknown.
    PerMove,
}

/// Straight limit of the stock, the line `normal . p = offset + rise h`. The normal points out of the material, and h
/// is the height of the segment's plane. One line with a rise describes an inclined flat face at all heights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StockLine {
    /// Unit normal in the plane of the segment.
    pub normal: [f64; 2],
    /// Distance of the line from the program's origin along the normal at height 0, mm.
    pub offset_mm: f64,
    /// Growth of the offset per millimetre of height: Z in G17, Y in G18, X in G19.
    pub rise_ratio: f64,
}

impl StockLine {
    /// A line by the direction of its normal, degrees from the plane's first axis, and its offset, mm.
    pub fn from_angle(normal_deg: f64, offset_mm: f64) -> Self {
        let (sin, cos) = libm::sincos(normal_deg.to_radians());
        StockLine { normal: [cos, sin], offset_mm, rise_ratio: 0.0 }
    }

    /// The line at this height, mm: the rise is included in the offset, and the result has no rise.
    #[must_use]
    pub fn at_height(&self, height_mm: f64) -> Self {
        StockLine { offset_mm: self.offset_mm + self.rise_ratio * height_mm, rise_ratio: 0.0, ..*self }
    }

    /// Distance from `point` (mm) to the line at height 0; positive if the point is inside the material.
    pub fn distance_mm(&self, point: [f64; 2]) -> f64 {
        let ([nx, ny], [x, y]) = (self.normal, point);
        self.offset_mm - (nx * x + ny * y)
    }
}

impl Stock {
    /// Stock on the material side of a line.
    pub fn half_plane(line: StockLine) -> Self {
        let mut lines = Vec::new();
        // One line always fits; `from_iter` would add a panic path.
        let _room = lines.push(line);
        Stock::Convex(lines)
    }

    /// Stock without limits: material everywhere.
    pub fn everywhere() -> Self {
        Stock::Convex(Vec::new())
    }

    /// The only line of a half plane; `None` for any other stock.
    pub fn line(&self) -> Option<&StockLine> {
        match self {
            Stock::Convex(lines) => match lines.as_slice() {
                [line] => Some(line),
                _ => None,
            },
            Stock::Disc { .. } | Stock::Engaged(_) | Stock::PerMove => None,
        }
    }

    /// The convex polygon with these corners (mm), in either sense; `None` for fewer than three or more than
    /// [`EDGES_MAX`] corners, and for polygons that are not strictly convex.
    pub fn polygon(corners_mm: &[[f64; 2]]) -> Option<Self> {
        if corners_mm.len() < 3 {
            return None;
        }
        let twice_area: f64 = edges(corners_mm).map(|([x, y], [to_x, to_y])| x * to_y - y * to_x).sum();
        let outward = if twice_area > 0.0 { 1.0 } else { -1.0 };
        let mut lines = Vec::new();
        for ([x, y], [to_x, to_y]) in edges(corners_mm) {
            let length_mm = libm::hypot(to_x - x, to_y - y);
            let normal = [outward * (to_y - y) / length_mm, -outward * (to_x - x) / length_mm];
            let [nx, ny] = normal;
            let line = StockLine { normal, offset_mm: nx * x + ny * y, rise_ratio: 0.0 };
            let is_corner = |corner: [f64; 2]| corner == [x, y] || corner == [to_x, to_y];
            if !corners_mm.iter().filter(|corner| !is_corner(**corner)).all(|corner| line.distance_mm(*corner) > 0.0) {
                return None;
            }
            lines.push(line).ok()?;
        }
        Some(Stock::Convex(lines))
    }
}

/// The edges of a closed polygon.
fn edges(corners: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stock_line_measures_into_the_material() {
        let line = StockLine::from_angle(90.0, 10.0);
        assert!((line.distance_mm([123.0, 4.0]) - 6.0).abs() < 1e-12);
    }

    #[test]
    fn a_line_that_rises_is_further_out_by_its_rise_times_the_height() {
        let line = StockLine { rise_ratio: 0.25, ..StockLine::from_angle(0.0, 10.0) };
        let above = line.at_height(8.0);
        assert!((above.distance_mm([3.0, 123.0]) - 9.0).abs() < 1e-12);
        assert_eq!(above.at_height(-100.0), above);
    }

    #[test]
    fn a_polygon_is_the_same_whichever_way_round_its_corners_go() {
        let square = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
        let mut reversed = square;
        reversed.reverse();
        for corners in [square, reversed] {
            let Some(Stock::Convex(lines)) = Stock::polygon(&corners) else { panic!("a square is convex") };
            assert!(lines.iter().all(|line| (line.distance_mm([5.0, 5.0]) - 5.0).abs() < 1e-12));
        }
    }

    #[test]
    fn what_is_not_convex_is_no_polygon() {
        assert_eq!(Stock::polygon(&[[0.0, 0.0], [1.0, 0.0]]), None);
        assert_eq!(Stock::polygon(&[[0.0, 0.0], [10.0, 0.0], [2.0, 2.0], [0.0, 10.0]]), None);
        assert_eq!(Stock::polygon(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]), None);
        let nine: std::vec::Vec<[f64; 2]> = (0..9)
            .map(|i| {
                let (s, c) = libm::sincos(f64::from(i) * 0.69);
                [c, s]
            })
            .collect();
        assert_eq!(Stock::polygon(&nine), None);
    }
}
