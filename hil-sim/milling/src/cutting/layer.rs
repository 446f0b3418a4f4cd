//! Layer of the workpiece, square to the tool's axis, in which each tooth cuts with one elementary edge.
//!
//! Rays in two directions pass through the centres of the same square cells. The rake face of an edge removes the strip
//! that it sweeps in a step. The ends of the strip are computed, not sampled, so the remaining material carries every
//! mark, to the last digit on each ray. If a tool has descended to a height inside the layer, the ray has columns of
//! partial height ([`super::partial_heights`]).

use std::borrow::Cow;
use std::ops::{Range, RangeInclusive};

use nalgebra::Vector2;

use super::partial_heights::{DepthBand, PartialHeights};
use arcfeed_dexel::dexel::{Dexel, Interval};
use arcfeed_dexel::grid::Grid;
use arcfeed_dexel::lattice::{Lattice, LatticeError};
use arcfeed_dexel::solid::Solid;
use arcfeed_dexel::workpiece::Stock;

/// Margin above rounding errors.
const MARGIN_MM: f64 = 1e-6;

/// Layer of a workpiece: the material on rays along both axes of its plane, with its height where that is not the whole layer.
#[derive(Clone, Debug)]
pub struct Layer {
    lowest_mm: [f64; 2],
    step_mm: f64,
    /// Rays along the first axis, one for each cell of the second, and rays along the second.
    rays: [Vec<Dexel>; 2],
    /// Partial heights of each ray.
    heights: [Vec<PartialHeights>; 2],
}

impl Layer {
    /// Layer that is a full rectangle of square cells, at least `size_mm` large.
    pub fn rectangle(lowest_mm: [f64; 2], size_mm: [f64; 2], step_mm: f64) -> Self {
        let cells = size_mm.map(|size| (size / step_mm).ceil() as usize);
        let whole = |axis: usize| {
            let to_mm = lowest_mm[axis] + cells[axis] as f64 * step_mm;
            vec![Dexel::One(Interval::new(lowest_mm[axis], to_mm)); cells[1 - axis]]
        };
        Layer::new(lowest_mm, step_mm, [whole(0), whole(1)])
    }

    fn new(lowest_mm: [f64; 2], step_mm: f64, rays: [Vec<Dexel>; 2]) -> Self {
        let heights = rays.each_ref().map(|rays| vec![PartialHeights::default(); rays.len()]);
        Layer { lowest_mm, step_mm, rays, heights }
    }

    /// Layer that is the interior of a closed polygon, which must not cross itself.
    pub fn outline(corners_mm: &[Vector2<f64>], step_mm: f64) -> Self {
        let ends_mm = |axis: usize| {
            let along = corners_mm.iter().map(|corner| corner[axis]);
            along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
        };
        let lowest_mm = [0, 1].map(|axis| libm::floor(ends_mm(axis)[0] / step_mm - 1.0) * step_mm);
        let sizes_mm = [0, 1].map(|axis| ends_mm(axis)[1] - lowest_mm[axis] + step_mm);
        let mut layer = Layer::rectangle(lowest_mm, sizes_mm, step_mm);
        for axis in [0, 1] {
            let sides: Vec<Side> = (0..corners_mm.len()).map(|side| Side::new(corners_mm, side, axis)).collect();
            for ray in 0..layer.rays[axis].len() {
                let mut ends: Vec<f64> = crossings(&sides, layer.place_mm(axis, ray)).map(|(_, at_mm)| at_mm).collect();
                ends.sort_unstable_by(f64::total_cmp);
                let pieces = ends.chunks_exact(2).map(|pair| Interval::new(pair[0], pair[1]));
                layer.rays[axis][ray] = Dexel::new(pieces.collect());
            }
        }
        layer
    }

    /// Layer of a stock (tri-dexel model): its cells at a height along `axis` (0, 1, 2 for x, y, z); empty if the stock has none there.
    /// The first and second axis of the layer's plane are the two that follow `axis` in cyclic order.
    pub fn of(stock: &Stock, axis: usize, height_mm: f64) -> Self {
        let lattice = stock.lattice();
        let [first, second] = Lattice::across(axis);
        let lowest_mm = lattice.lowest_mm();
        let cell = (height_mm - lowest_mm[axis]) / lattice.step_mm();
        // Rays along the first axis are counted by the second in columns and by `axis` in rows; those along the second by
        // `axis` in columns and by the first in rows.
        let at = cell as usize;
        let ray = |grid: &Grid, column, row| grid.dexel(column, row).cloned().unwrap_or_default();
        let is_in = (0.0..lattice.cells()[axis] as f64).contains(&cell);
        let along = |axis: usize, count: usize, place: &dyn Fn(usize) -> (usize, usize)| -> Vec<Dexel> {
            let dexel = |n| ray(&stock.grids()[axis], place(n).0, place(n).1);
            (0..count).map(|n| if is_in { dexel(n) } else { Dexel::Empty }).collect()
        };
        let rays =
            [along(first, lattice.cells()[second], &|n| (n, at)), along(second, lattice.cells()[first], &|n| (at, n))];
        Layer::new([lowest_mm[first], lowest_mm[second]], lattice.step_mm(), rays)
    }

    /// Section of a solid at a height along `axis`; the first and second axis of its plane are the two that follow `axis` cyclically.
    ///
    /// # Errors
    /// The section has no extent or `step_mm` is not positive, or there would be more than 65 536 cells along an axis.
    pub fn at(solid: &dyn Solid, axis: usize, height_mm: f64, step_mm: f64) -> Result<Self, LatticeError> {
        let lattice = lattice_at(solid.bounds_mm(), axis, height_mm, step_mm)?;
        let rays = Lattice::across(axis).map(|axis| solid.grid(&lattice, axis).dexels().to_vec());
        Ok(Layer::new(Lattice::across(axis).map(|axis| lattice.lowest_mm()[axis]), step_mm, rays))
    }

    /// Layer without material, with the rays of the section of a solid that has these bounds.
    ///
    /// # Errors
    /// As [`Layer::at`].
    pub fn empty_at(bounds_mm: [[f64; 3]; 2], axis: usize, height_mm: f64, step_mm: f64) -> Result<Self, LatticeError> {
        let lattice = lattice_at(bounds_mm, axis, height_mm, step_mm)?;
        let rays = Lattice::across(axis).map(|axis| vec![Dexel::Empty; lattice.size(axis).iter().product()]);
        Ok(Layer::new(Lattice::across(axis).map(|axis| lattice.lowest_mm()[axis]), step_mm, rays))
    }

    /// Lowest and highest corner of the layer's cells, in its plane.
    pub fn extent_mm(&self) -> [[f64; 2]; 2] {
        let highest_mm =
            [0, 1].map(|axis: usize| self.lowest_mm[axis] + self.rays[1 - axis].len() as f64 * self.step_mm);
        [self.lowest_mm, highest_mm]
    }

    /// Distance of neighbouring rays.
    pub fn step_mm(&self) -> f64 {
        self.step_mm
    }

    /// Material on the rays along the first (`axis` 0) or the second axis (1) of the plane.
    pub fn rays(&self, axis: usize) -> &[Dexel] {
        &self.rays[axis]
    }

    /// Coordinate, across its direction, of the ray with this index; `axis` is the direction of the rays.
    pub fn place_mm(&self, axis: usize, ray: usize) -> f64 {
        self.lowest_mm[1 - axis] + (ray as f64 + 0.5) * self.step_mm
    }

    /// Index, as a fraction, of the ray at a coordinate across the rays' direction `axis`: whole numbers are on rays.
    pub fn index(&self, axis: usize, place_mm: f64) -> f64 {
        (place_mm - self.lowest_mm[1 - axis]) / self.step_mm - 0.5
    }

    /// Area of all material, mm2, as measured by the rays along each of the two axes. Material lower than the layer counts with its
    /// fraction of the layer's height.
    pub fn areas_mm2(&self) -> [f64; 2] {
        [0, 1].map(|axis: usize| {
            let lengths_mm =
                self.rays[axis].iter().zip(&self.heights[axis]).map(|(ray, heights)| heights.length_mm(ray));
            lengths_mm.sum::<f64>() * self.step_mm
        })
    }

    /// Intervals of a ray with material higher than `above_ratio` of the layer's height that overlap `span`, which may reach beyond it;
    /// empty for an index of no ray.
    pub fn section(&self, axis: usize, ray: i64, span: &Interval, above_ratio: f64) -> Cow<'_, [Interval]> {
        let ray = usize::try_from(ray).ok().filter(|ray| *ray < self.rays[axis].len());
        let section = |ray: usize| self.heights[axis][ray].section(&self.rays[axis][ray], span, above_ratio);
        ray.map_or(Cow::Borrowed(&[]), section)
    }

    /// Material of a ray, and the intervals of it that are lower than the layer; `None` for an index of no ray.
    pub fn ray(&self, axis: usize, ray: i64) -> Option<(&Dexel, &PartialHeights)> {
        let ray = usize::try_from(ray).ok()?;
        self.rays[axis].get(ray).zip(self.heights[axis].get(ray))
    }

    /// Whether any of these rays has, in `span`, material higher than `above_ratio` of the layer's height.
    pub fn is_met(&self, axis: usize, rays: RangeInclusive<i64>, span: &Interval, above_ratio: f64) -> bool {
        let rays = (*rays.start()).max(0)..=(*rays.end()).min(self.rays[axis].len() as i64 - 1);
        rays.into_iter().filter_map(|ray| self.ray(axis, ray)).any(|(material, heights)| {
            material.meets(span) && heights.end_piece(material, span, above_ratio, true).is_some()
        })
    }

    /// Mean height of the material in a span of a ray, as a fraction of the layer's height.
    pub fn mean_ratio(&self, axis: usize, ray: i64, span: &Interval) -> f64 {
        let ray = usize::try_from(ray).ok().filter(|ray| *ray < self.rays[axis].len());
        ray.map_or(1.0, |ray| self.heights[axis][ray].mean_ratio(&self.rays[axis][ray], span))
    }

    /// Height of the material at a point, as a fraction of the layer's height, on the nearest ray along `axis`; `None` without material.
    pub fn top_ratio(&self, point_mm: Vector2<f64>, axis: usize) -> Option<f64> {
        let place = self.index(axis, point_mm[1 - axis]) + 0.5;
        let is_there = (0.0..self.rays[axis].len() as f64).contains(&place);
        let ray = is_there.then_some(place as usize)?;
        self.heights[axis][ray].top_ratio(&self.rays[axis][ray], point_mm[axis])
    }

    /// Removes the material inside a convex quadrilateral; returns its area, mm2, as measured by the rays along each of the two axes.
    pub fn clear(&mut self, corners_mm: &[Vector2<f64>; 4]) -> [f64; 2] {
        self.clear_band(corners_mm, &DepthBand::ALL)
    }

    /// Removes the material inside a convex quadrilateral, but only in a depth band (part of the layer's height); returns areas as
    /// [`Layer::clear`], each multiplied by the removed fraction of the layer's height.
    pub fn clear_band(&mut self, corners_mm: &[Vector2<f64>; 4], depth_band: &DepthBand) -> [f64; 2] {
        self.clear_within(corners_mm, 0.0, depth_band, |_, crossing_mm, _, _| crossing_mm)
    }

    /// Removes, in a depth band, the material that a rake face sweeps. Both arrays have the face's root and edge, before and after the
    /// motion. The edge moves on a circle of this radius, which is negative if it cuts towards the centre. Returns areas as
    /// [`Layer::clear_band`].
    pub fn clear_strip(
        &mut self,
        [before_mm, after_mm]: [[Vector2<f64>; 2]; 2],
        radius_mm: f64,
        depth_band: &DepthBand,
    ) -> [f64; 2] {
        let ([root, from], [last_root, to]) = (before_mm, after_mm);
        let (chord, middle) = (to - from, (from + to) / 2.0);
        let half_square = chord.norm_squared() / 4.0;
        let to_center = Vector2::new(-chord.y, chord.x).normalize();
        let to_center = to_center * to_center.dot(&(root - from)).signum() * radius_mm.signum();
        let height_mm = libm::sqrt((radius_mm * radius_mm - half_square).max(0.0));
        let (center, bulge_mm) = (middle + to_center * height_mm, libm::fabs(radius_mm) - height_mm);
        self.clear_within(&[root, from, to, last_root], bulge_mm, depth_band, |side, crossing_mm, axis, at_mm| {
            let off_mm = at_mm - center[1 - axis];
            let square = radius_mm * radius_mm - off_mm * off_mm;
            // The second side is the path of the edge. The rest of a chord within the circle is on the same side of its
            // centre.
            if side != 1 || square < 0.0 {
                return crossing_mm;
            }
            center[axis] + libm::copysign(libm::sqrt(square), crossing_mm - center[axis])
        })
    }

    /// Removes a depth band of a quadrilateral; `put_mm` may move the crossing of a side with a ray, given the side,
    /// the crossing, and the ray's axis and coordinate.
    fn clear_within(
        &mut self,
        corners_mm: &[Vector2<f64>; 4],
        bulge_mm: f64,
        depth_band: &DepthBand,
        put_mm: impl Fn(usize, f64, usize, f64) -> f64,
    ) -> [f64; 2] {
        if is_beside(corners_mm, &self.extent_mm()) {
            return [0.0; 2];
        }
        let (bounds_mm, margin_mm) = (bounds(corners_mm), bulge_mm + MARGIN_MM);
        [0, 1].map(|axis: usize| {
            let [low_mm, high_mm] = bounds_mm.map(|corner| corner[axis]);
            let around = Interval::new(low_mm - margin_mm, high_mm + margin_mm);
            let [lowest, highest] = bounds_mm.map(|corner| corner[1 - axis]);
            let sides: [Side; 4] = std::array::from_fn(|side| Side::new(corners_mm, side, axis));
            let mut removed_mm = 0.0;
            for ray in self.between(axis, lowest, highest) {
                if self.heights[axis][ray].is_already_lowered(&self.rays[axis][ray], &around, depth_band) {
                    continue;
                }
                let place_mm = self.place_mm(axis, ray);
                let crossings = crossings(&sides, place_mm);
                let ends = crossings.map(|(side, crossing_mm)| put_mm(side, crossing_mm, axis, place_mm));
                if let Some(span) = extent(ends) {
                    removed_mm += self.heights[axis][ray].remove(&mut self.rays[axis][ray], span, depth_band);
                }
            }
            removed_mm * self.step_mm
        })
    }

    /// Removes all material between two circles about a centre; inside of a disc if the inner radius is 0.
    pub fn clear_ring(&mut self, center_mm: Vector2<f64>, inner_mm: f64, outer_mm: f64) {
        self.lower_ring(center_mm, [inner_mm, outer_mm], 0.0);
    }

    /// Lowers the material between two circles to `foot_ratio` of the layer's height.
    pub fn lower_ring(&mut self, center_mm: Vector2<f64>, [inner_mm, outer_mm]: [f64; 2], foot_ratio: f64) {
        let depth_band = DepthBand { foot_ratio, ..DepthBand::ALL };
        for axis in [0, 1] {
            let middle_mm = center_mm[1 - axis];
            for ray in self.between(axis, middle_mm - outer_mm, middle_mm + outer_mm) {
                let off_mm = self.place_mm(axis, ray) - middle_mm;
                let half = |radius_mm: f64| libm::sqrt((radius_mm * radius_mm - off_mm * off_mm).max(0.0));
                let (inner, outer) = (half(inner_mm), half(outer_mm));
                for (from, to) in [(-outer, -inner), (inner, outer)] {
                    let span = Interval::new(center_mm[axis] + from, center_mm[axis] + to);
                    self.heights[axis][ray].remove(&mut self.rays[axis][ray], span, &depth_band);
                }
            }
        }
    }

    /// Rays along an axis between two coordinates.
    fn between(&self, axis: usize, from_mm: f64, to_mm: f64) -> Range<usize> {
        // A cast from float to whole number saturates.
        let first = self.index(axis, from_mm).ceil() as usize;
        let end = (self.index(axis, to_mm).floor() + 1.0) as usize;
        first..end.min(self.rays[axis].len())
    }
}

/// Whether a quadrilateral is outside a rectangle, even if its second side is an arc shorter than half a circle.
pub(super) fn is_beside(corners_mm: &[Vector2<f64>; 4], [lowest_mm, highest_mm]: &[[f64; 2]; 2]) -> bool {
    let ([low_mm, high_mm], margin_mm) = (bounds(corners_mm), bulge_max_mm(corners_mm));
    (0..2).any(|axis| high_mm[axis] + margin_mm < lowest_mm[axis] || low_mm[axis] - margin_mm > highest_mm[axis])
}

/// Lattice of the section of a solid with these bounds at a height along `axis`.
fn lattice_at(
    [mut lowest_mm, mut highest_mm]: [[f64; 3]; 2],
    axis: usize,
    height_mm: f64,
    step_mm: f64,
) -> Result<Lattice, LatticeError> {
    // One cell along the axis, so that a grid across it has one line of rays.
    (lowest_mm[axis], highest_mm[axis]) = (height_mm - step_mm / 2.0, height_mm + step_mm / 2.0);
    Lattice::new(lowest_mm, highest_mm, step_mm)
}

/// Largest distance of an arc shorter than half a circle from the second side: half of its chord.
fn bulge_max_mm([_, from, to, _]: &[Vector2<f64>; 4]) -> f64 {
    (to - from).norm() / 2.0
}

/// Lowest and highest corner of a rectangle around some points.
fn bounds(points_mm: &[Vector2<f64>]) -> [[f64; 2]; 2] {
    let nowhere = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    points_mm.iter().fold(nowhere, |[low, high], point| {
        [[0, 1].map(|axis: usize| low[axis].min(point[axis])), [0, 1].map(|axis: usize| high[axis].max(point[axis]))]
    })
}

/// Side of a polygon, from the lower to the higher coordinate across the rays of an axis.
#[derive(Clone, Copy, Debug)]
struct Side {
    across_mm: [f64; 2],
    from_mm: f64,
    /// Difference along the rays from the lower to the higher end.
    delta_mm: f64,
}

impl Side {
    /// Side of a polygon for rays along an axis.
    fn new(corners_mm: &[Vector2<f64>], side: usize, axis: usize) -> Self {
        let next = if side + 1 < corners_mm.len() { side + 1 } else { 0 };
        let (from, to) = (&corners_mm[side], &corners_mm[next]);
        // Always from the same end, whichever polygon the side belongs to, so that neighbours leave no gap.
        let (from, to) = if from[1 - axis] < to[1 - axis] { (from, to) } else { (to, from) };
        Side { across_mm: [from[1 - axis], to[1 - axis]], from_mm: from[axis], delta_mm: to[axis] - from[axis] }
    }
}

/// Crossings of a ray with the sides of a polygon, each with its side.
fn crossings(sides: &[Side], at_mm: f64) -> impl Iterator<Item = (usize, f64)> {
    sides.iter().enumerate().filter_map(move |(number, side)| {
        let [a, b] = side.across_mm.map(|across_mm| across_mm - at_mm);
        let is_crossed = (a <= 0.0) != (b <= 0.0);
        is_crossed.then(|| (number, side.from_mm + side.delta_mm * (a / (a - b))))
    })
}

/// Interval from the lowest to the highest coordinate.
fn extent(ends_mm: impl Iterator<Item = f64>) -> Option<Interval> {
    let ends = ends_mm.fold(None, |ends: Option<Interval>, at_mm| {
        let ends = ends.unwrap_or(Interval::new(at_mm, at_mm));
        Some(Interval::new(ends.from_mm.min(at_mm), ends.to_mm.max(at_mm)))
    });
    ends.filter(|ends| ends.length_mm() > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_dexel::solid::Block;

    #[test]
    fn a_polygon_takes_its_area() {
        let mut layer = Layer::rectangle([0.0, 0.0], [10.0, 8.0], 0.01);
        let corners = [(1.0, 1.0), (6.0, 2.0), (5.0, 7.0), (2.0, 5.0)].map(|(x, y)| Vector2::new(x, y));
        let removed = layer.clear(&corners);
        // Shoelace: (2 - 6 + 42 - 10 + 25 - 14 + 2 - 5) / 2.
        for area in removed {
            assert!((area - 18.0).abs() < 1e-3, "{area}");
        }
        assert_eq!(layer.clear(&corners), [0.0; 2]);
        for (left, removed) in layer.areas_mm2().into_iter().zip(removed) {
            assert!((left + removed - 80.0).abs() < 1e-9);
        }
    }

    #[test]
    fn an_outline_has_its_area() {
        // An arrow head, hollow behind: 12 - 4.
        let corners = [(-1.0, 0.5), (5.0, 2.5), (-1.0, 4.5), (3.0, 2.5)].map(|(x, y)| Vector2::new(x, y));
        for area in Layer::outline(&corners, 0.01).areas_mm2() {
            assert!((area - 4.0).abs() < 1e-3, "{area}");
        }
    }

    #[test]
    fn a_ring_takes_its_area() {
        let mut layer = Layer::rectangle([-10.0, -10.0], [20.0, 20.0], 0.01);
        layer.clear_ring(Vector2::new(1.0, -0.5), 3.0, 8.0);
        for area in layer.areas_mm2() {
            assert!((400.0 - area - 55.0 * std::f64::consts::PI).abs() < 1e-2, "{area}");
        }
    }

    #[test]
    fn a_layer_of_a_stock_has_its_rays() {
        let block = Block { lowest_mm: [0.0, 1.0, 2.0], highest_mm: [4.0, 6.0, 8.0] };
        let stock = Stock::new(&block, 0.5, 1 << 20).unwrap();
        for (axis, sizes) in [(0, [5.0, 6.0]), (1, [6.0, 4.0]), (2, [4.0, 5.0])] {
            let layer = Layer::of(&stock, axis, 3.1);
            assert_eq!(layer.areas_mm2(), [sizes[0] * sizes[1]; 2], "{axis}");
            assert_eq!(layer.rays(0).len() as f64 * 0.5, sizes[1]);
            assert_eq!(Layer::at(&block, axis, 3.1, 0.5).unwrap().areas_mm2(), layer.areas_mm2());
            assert_eq!(Layer::at(&block, axis, 9.0, 0.5).unwrap().areas_mm2(), [0.0; 2]);
            assert_eq!(Layer::of(&stock, axis, 9.0).areas_mm2(), [0.0; 2]);
        }
    }
}
