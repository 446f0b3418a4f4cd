//! Rays that a slab can cut while its axis is a lattice axis and its path rises or falls: bounds, seen along the slab's axis.
//!
//! The outside sweeps a disc along the path. The hole spares the points that stay inside it during the whole move:
//!
//! ```text
//! reached: distance to the way <= R, and distance to one of its ends >= r        (1)
//! ```
//!
//! The path is straight, so its farthest point is one of its ends. On a line in the plane, the swept points lie between
//! the first and the last point with the left part of (1), without the interval that the holes at both ends have in
//! common. The bounds are computed with a margin, to leave out rays that cannot lose material: most rays near a move of
//! three axes are already cut. Of the rays along the axis, only those between the outside and the common hole are
//! examined, between the ends of the slab. On a path that does not rise, (1) is exact: [`level`](super::level).
//!
//! Source: own derivation.

use super::dexel::{Dexel, Interval};
use super::section::Sweep;
use super::tool::Slab;

/// Straight sweep of a slab (part of a tool between two heights) whose axis is a lattice axis, projected along that axis.
#[derive(Clone, Copy, Debug)]
pub struct SlabSweep {
    axis: usize,
    /// Both ends of the way; all coordinates, that along the axis without meaning.
    ends_mm: [[f64; 3]; 2],
    outer_mm: f64,
    hole_mm: f64,
    /// Range of the slab along the axis over its whole way.
    heights: Interval,
    margin_mm: f64,
}

/// Part of a row of parallel rays that can lose material in a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Coordinates along the row, across the rays, between which rays can lose material, mm.
    pub across: Interval,
    /// Part of `across` in which no ray loses material, because it stays in the tool's hole; `None` without such a part.
    pub hollow: Option<Interval>,
    /// Coordinates along the rays between which they can lose material, the same for all rays of the row, mm.
    pub along: Interval,
}

impl SlabSweep {
    /// Prepares the sweep of a slab, widened by a margin; `None` if the slab's axis is not a lattice axis.
    pub fn new(slab: &Slab, sweep: &Sweep, margin_mm: f64) -> Option<Self> {
        let axis = (0..3).find(|axis| sweep.axis[*axis].abs() == 1.0)?;
        let hole_mm = slab.inner_mm.map_or(0.0, |inner| inner[0].min(inner[1]) - margin_mm).max(0.0);
        let outer_mm = slab.outer_mm[0].max(slab.outer_mm[1]) + margin_mm;
        let ends_mm = [sweep.from_mm, sweep.to_mm];
        let [at_first, at_last] = ends_mm.map(|end_mm| {
            let [one, other] = slab.heights_mm.map(|height_mm| end_mm[axis] + height_mm * sweep.axis[axis]);
            Interval::new(one.min(other), one.max(other))
        });
        let from_mm = at_first.from_mm.min(at_last.from_mm) - margin_mm;
        let heights = Interval::new(from_mm, at_first.to_mm.max(at_last.to_mm) + margin_mm);
        Some(SlabSweep { axis, ends_mm, outer_mm, hole_mm, heights, margin_mm })
    }

    /// Narrows a row of rays along `ray_axis`, at the coordinate `row_mm`, from the bounding box of the sweep to the part that the
    /// slab can cut. `None` if no ray can lose material. Rays across the slab's axis are not narrowed.
    pub fn narrowed(&self, row: Row, [ray_axis, column_axis]: [usize; 2], row_mm: f64) -> Option<Row> {
        if ray_axis != self.axis {
            return Some(row);
        }
        let mut point_mm = [0.0; 3];
        point_mm[3 - ray_axis - column_axis] = row_mm;
        // A ray on the hole's border is asked.
        let hollow = self.hollow(column_axis, &point_mm, (self.hole_mm - self.margin_mm).max(0.0));
        let across = self.along(column_axis, &point_mm, self.outer_mm)?;
        Some(Row { across, hollow, along: self.heights })
    }

    /// Whether a ray along `ray_axis` through a point can lose material; `dexel` is the material that the ray still has.
    pub fn may_cut(&self, ray_axis: usize, point_mm: &[f64; 3], dexel: &Dexel) -> bool {
        if ray_axis == self.axis {
            return self.reaches(point_mm, self.outer_mm, self.hole_mm);
        }
        let Some(outside) = self.along(ray_axis, point_mm, self.outer_mm) else { return false };
        match self.hollow(ray_axis, point_mm, self.hole_mm) {
            None => dexel.meets(&outside),
            Some(hollow) => {
                dexel.meets(&Interval { to_mm: hollow.from_mm, ..outside })
                    || dexel.meets(&Interval { from_mm: hollow.to_mm, ..outside })
            }
        }
    }

    /// (1)
    fn reaches(&self, point_mm: &[f64; 3], outer_mm: f64, hole_mm: f64) -> bool {
        let [from, to] = self.ends_mm.map(|end| self.across(&end, point_mm));
        let way = [to[0] - from[0], to[1] - from[1]];
        let square = |v: [f64; 2]| v[0] * v[0] + v[1] * v[1];
        let length_square = square(way);
        let along = -(from[0] * way[0] + from[1] * way[1]);
        let part = if length_square > 0.0 { (along / length_square).clamp(0.0, 1.0) } else { 0.0 };
        let nearest = square([from[0] + part * way[0], from[1] + part * way[1]]);
        nearest <= outer_mm * outer_mm && square(from).max(square(to)) >= hole_mm * hole_mm
    }

    /// From the first to the last place of a line that the outside reaches.
    fn along(&self, ray_axis: usize, point_mm: &[f64; 3], outer_mm: f64) -> Option<Interval> {
        let off_axis = 3 - ray_axis - self.axis;
        let [from, to] = self.ends_mm.map(|end| [end[ray_axis], point_mm[off_axis] - end[off_axis]]);
        let mut reached: Option<Interval> = None;
        let mut take = |at_mm: f64| {
            let other = reached.unwrap_or(Interval::new(at_mm, at_mm));
            reached = Some(Interval::new(other.from_mm.min(at_mm), other.to_mm.max(at_mm)));
        };
        for [center_mm, off_mm] in [from, to] {
            if let Some(half_mm) = half_chord_mm(outer_mm, off_mm) {
                take(center_mm - half_mm);
                take(center_mm + half_mm);
            }
        }
        // The two lines that touch the discs at both ends: off the way by the radius, square to it.
        let way = [to[0] - from[0], from[1] - to[1]];
        let length_mm = libm::sqrt(way[0] * way[0] + way[1] * way[1]);
        if length_mm > 0.0 && way[1] != 0.0 {
            for side in [-1.0, 1.0] {
                let normal = [-side * way[1] / length_mm * outer_mm, side * way[0] / length_mm * outer_mm];
                let part = (from[1] - normal[1]) / way[1];
                if (0.0..=1.0).contains(&part) {
                    take(from[0] + part * way[0] + normal[0]);
                }
            }
        }
        reached
    }

    /// Part of a line that is in the hole over the whole way.
    fn hollow(&self, ray_axis: usize, point_mm: &[f64; 3], hole_mm: f64) -> Option<Interval> {
        let off_axis = 3 - ray_axis - self.axis;
        let [from, to] = self.ends_mm.map(|end| {
            let half_mm = half_chord_mm(hole_mm, point_mm[off_axis] - end[off_axis])?;
            Some(Interval::new(end[ray_axis] - half_mm, end[ray_axis] + half_mm))
        });
        from.zip(to).map(|(from, to)| from.common(&to)).filter(|common| common.length_mm() > 0.0)
    }

    /// From a point to an end, in the plane.
    fn across(&self, end_mm: &[f64; 3], point_mm: &[f64; 3]) -> [f64; 2] {
        let [first, second] = [(self.axis + 1) % 3, (self.axis + 2) % 3];
        [end_mm[first] - point_mm[first], end_mm[second] - point_mm[second]]
    }
}

fn half_chord_mm(radius_mm: f64, off_mm: f64) -> Option<f64> {
    let square = radius_mm * radius_mm - off_mm * off_mm;
    (square >= 0.0).then(|| libm::sqrt(square))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(inner_mm: Option<[f64; 2]>) -> SlabSweep {
        let slab = Slab { heights_mm: [0.0, 1.0], outer_mm: [5.0, 5.0], inner_mm };
        let sweep = Sweep { from_mm: [0.0, 0.0, 3.0], to_mm: [6.0, 8.0, 3.0], axis: [0.0, 0.0, 1.0] };
        SlabSweep::new(&slab, &sweep, 0.0).unwrap()
    }

    #[test]
    fn swept_area_is_the_disc_along_the_path_minus_the_common_hole() {
        let (mill, ring) = (flat(None), flat(Some([4.9, 4.9])));
        let points = [[3.0, 4.0], [0.0, 6.2], [0.0, 6.3], [-5.1, 0.0], [-4.9, 0.0], [9.9, 11.0], [9.1, 12.0]];
        for [x, y] in points {
            // By brute force along the way.
            let off = |n: u32| libm::hypot(x - 6e-4 * f64::from(n), y - 8e-4 * f64::from(n));
            let (near, far) = (0..=10_000).map(off).fold((9e9_f64, 0.0_f64), |(a, b), off| (a.min(off), b.max(off)));
            assert_eq!(mill.reaches(&[x, y, 0.0], 5.0, 0.0), near <= 5.0, "{x} {y}");
            assert_eq!(ring.reaches(&[x, y, 0.0], 5.0, 4.9), near <= 5.0 && far >= 4.9, "{x} {y}");
        }
    }

    #[test]
    fn along_a_line_the_outside_begins_and_ends_where_brute_force_does() {
        for (ray_axis, off) in (0..2).flat_map(|axis| (-6..=14).map(move |n| (axis, f64::from(n) * 0.97))) {
            let mut point = [0.0; 3];
            point[1 - ray_axis] = off;
            let places = (0..=20_000).filter_map(|n: u32| {
                let end = [3e-4 * f64::from(n), 4e-4 * f64::from(n)];
                let half = half_chord_mm(5.0, off - end[1 - ray_axis])?;
                Some([end[ray_axis] - half, end[ray_axis] + half])
            });
            let brute = places.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
            match (flat(None).along(ray_axis, &point, 5.0), brute) {
                (Some(Interval { from_mm, to_mm }), Some([from, to])) => {
                    assert!(
                        (from_mm - from).abs() < 1e-4 && (to_mm - to).abs() < 1e-4,
                        "{ray_axis} {off} {from_mm} {from} {to_mm} {to}"
                    );
                }
                (found, brute) => assert!(found.is_none() && brute.is_none(), "{ray_axis} {off} {found:?} {brute:?}"),
            }
        }
    }

    #[test]
    fn material_in_the_hole_is_safe() {
        let ring = flat(None);
        let (point, inside) = ([0.0, 4.0, 0.0], Dexel::One(Interval::new(2.0, 4.0)));
        assert!(ring.may_cut(0, &point, &inside));
        let slab = Slab { heights_mm: [0.0, 1.0], outer_mm: [50.0, 50.0], inner_mm: Some([40.0, 40.0]) };
        let sweep = Sweep { from_mm: [0.0, 0.0, 3.0], to_mm: [6.0, 8.0, 3.0], axis: [0.0, 0.0, 1.0] };
        let ring = SlabSweep::new(&slab, &sweep, 0.0).unwrap();
        assert!(!ring.may_cut(0, &point, &inside) && !ring.may_cut(2, &point, &inside));
        assert!(ring.may_cut(0, &point, &Dexel::One(Interval::new(2.0, 45.0))));
        let tilted = Sweep { axis: [0.0, 0.6, 0.8], ..sweep };
        assert!(SlabSweep::new(&slab, &tilted, 0.0).is_none());
    }
}
