//! A ball on a straight sweep: what it removes from a ray, in closed form for rays of any direction.
//!
//! The ball of radius R sweeps a cylinder about its way, with half a ball at each end. That is convex, so a ray loses one interval. Let n be the
//! direction of the way, L its length, and w the vector from the ball's centre at the beginning to a point of the ray. The ray crosses the
//! endless cylinder at (1); an end of the interval is that place if 0 <= w.n <= L, and otherwise on the ball of the nearer end of the way, (2).
//! A ray that misses the endless cylinder loses nothing.
//!
//! ```text
//! |w|^2 - (w.n)^2 = R^2                                        (1)
//! distance from the ball's centre = R                          (2)
//! ```
//!
//! Source: own derivation.

use arcfeed_kinematics::vector::{Vector, length, scaled, sum};

use super::band::Band;
use super::dexel::{Interval, NOWHERE};
use super::flat::Row;
use super::lattice::Lattice;
use super::section::Sweep;

/// Ball on a straight sweep, prepared for rays of one direction.
#[derive(Clone, Copy, Debug)]
pub struct BallSweep {
    radius_mm: f64,
    /// Centre where the way begins and where it ends, as coordinates along the rays, along their columns, and along their rows.
    ends_mm: [Vector; 2],
    /// The same of the direction of the way; along the rays if the ball stands.
    direction: Vector,
    length_mm: f64,
    /// The way as seen along the rays.
    band: Band,
}

/// Cut of one row of rays.
#[derive(Clone, Debug)]
pub struct BallRow<'a> {
    ball: &'a BallSweep,
    row_mm: f64,
}

impl BallSweep {
    /// Prepares the ball at the tip of a tool on a sweep, for rays along `ray_axis`.
    pub fn new(radius_mm: f64, sweep: &Sweep, ray_axis: usize) -> Self {
        let [column_axis, row_axis] = Lattice::across(ray_axis);
        let seen = |vector: Vector| [ray_axis, column_axis, row_axis].map(|axis| vector[axis]);
        let to_center = scaled(sweep.axis, radius_mm);
        let ends_mm = [sweep.from_mm, sweep.to_mm].map(|tip_mm| seen(sum(tip_mm, to_center)));
        let (way_mm, length_mm) = (seen(sweep.motion_mm()), length(sweep.motion_mm()));
        let direction = if length_mm > 0.0 { scaled(way_mm, 1.0 / length_mm) } else { [1.0, 0.0, 0.0] };
        let band = Band::new(ends_mm.map(|[_, column_mm, row_mm]| [column_mm, row_mm]));
        BallSweep { radius_mm, ends_mm, direction, length_mm, band }
    }

    /// Lowest and highest corner of the box around the ball at the tip of a tool where a sweep begins, widened by a margin.
    pub fn corners_mm(radius_mm: f64, sweep: &Sweep, margin_mm: f64) -> [Vector; 2] {
        let center_mm = sum(sweep.from_mm, scaled(sweep.axis, radius_mm));
        [-1.0, 1.0].map(|side| center_mm.map(|at_mm| at_mm + side * (radius_mm + margin_mm)))
    }

    /// Part of `row`, the row of rays at the coordinate `row_mm`, with only the columns that the ball reaches, and a margin; `None` if it
    /// reaches none.
    pub fn narrowed(&self, row: Row, row_mm: f64, margin_mm: f64) -> Option<Row> {
        let across = self.band.chord(row_mm, self.radius_mm + margin_mm)?;
        Some(Row { across, ..row })
    }

    /// Cut of the row of rays at the coordinate `row_mm`.
    pub fn row(&self, row_mm: f64) -> BallRow<'_> {
        BallRow { ball: self, row_mm }
    }
}

impl BallRow<'_> {
    /// Interval that the ray at a column's coordinate loses; it ends before it begins if the ray loses nothing.
    #[inline]
    pub fn loss(&self, column_mm: f64) -> Interval {
        let BallSweep { radius_mm, ends_mm: [first_mm, last_mm], direction: [along, column, row], length_mm, .. } =
            *self.ball;
        let square_off = |[_, end_column_mm, end_row_mm]: Vector| {
            let arm_mm = [column_mm - end_column_mm, self.row_mm - end_row_mm];
            arm_mm[0] * arm_mm[0] + arm_mm[1] * arm_mm[1]
        };
        // (1) as a u^2 + 2 b u + c = 0, u from the centre at the beginning.
        let passed_mm = (column_mm - first_mm[1]) * column + (self.row_mm - first_mm[2]) * row;
        let a = column * column + row * row;
        let b = -passed_mm * along;
        let c = square_off(first_mm) - passed_mm * passed_mm - radius_mm * radius_mm;
        // Infinite if the ray is parallel to the way, no number if it misses the cylinder.
        let half_mm = if a > 0.0 { libm::sqrt(b * b - a * c) / a } else { f64::INFINITY };
        let middle_mm = if a > 0.0 { -b / a } else { 0.0 };
        let end_mm = |side: f64| {
            let at_mm = middle_mm + side * half_mm;
            let passed_mm = passed_mm + at_mm * along;
            let on_ball = |center_mm: Vector| {
                center_mm[0] + side * libm::sqrt(radius_mm * radius_mm - square_off(center_mm)) // (2)
            };
            if passed_mm < 0.0 {
                on_ball(first_mm)
            } else if passed_mm > length_mm {
                on_ball(last_mm)
            } else {
                first_mm[0] + at_mm
            }
        };
        let [from_mm, to_mm] = [-1.0, 1.0].map(end_mm);
        if from_mm <= to_mm { Interval::new(from_mm, to_mm) } else { NOWHERE }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use arcfeed_kinematics::vector::{difference, dot, unit};

    use super::*;

    /// Numbers from -1 to 1.
    pub fn random(seed: &mut u32) -> f64 {
        *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(*seed >> 8) / f64::from(1 << 23) - 1.0
    }

    /// Distance of a point from a straight way.
    fn off_mm(point_mm: Vector, from_mm: Vector, to_mm: Vector) -> f64 {
        let (way, arm) = (difference(to_mm, from_mm), difference(point_mm, from_mm));
        let part = if dot(way, way) > 0.0 { (dot(arm, way) / dot(way, way)).clamp(0.0, 1.0) } else { 0.0 };
        length(difference(arm, scaled(way, part)))
    }

    #[test]
    fn the_ends_of_a_loss_are_at_the_radius_from_the_way_and_all_between_is_within() {
        const RADIUS_MM: f64 = 3.0;
        let mut seed = 5;
        let (mut met, mut missed) = (0, 0);
        for case in 0..20_000 {
            let mut vector = |scale: f64| [0; 3].map(|_: i32| scale * random(&mut seed));
            let (from_mm, axis, ray_axis) = (vector(3.0), unit(vector(1.0)).unwrap(), case % 3);
            // Standing, along the ray, nearly so, or in any direction.
            let mut motion_mm = vector(4.0);
            let across = Lattice::across(ray_axis);
            across.iter().for_each(|axis| motion_mm[*axis] *= [1.0, 1e-9, 0.0, 1e-6][case % 4]);
            motion_mm = scaled(motion_mm, if case % 20 == 0 { 0.0 } else { 1.0 });
            let sweep = Sweep { from_mm, to_mm: sum(from_mm, motion_mm), axis };
            let [first_mm, last_mm] = [sweep.from_mm, sweep.to_mm].map(|tip_mm| sum(tip_mm, scaled(axis, RADIUS_MM)));
            let mut point_mm = vector(7.0);
            let ball = BallSweep::new(RADIUS_MM, &sweep, ray_axis);
            let [column_mm, row_mm] = across.map(|axis| point_mm[axis]);
            let loss = ball.row(row_mm).loss(column_mm);
            let mut off = |at_mm: f64| {
                point_mm[ray_axis] = at_mm;
                off_mm(point_mm, first_mm, last_mm)
            };
            if loss.from_mm > loss.to_mm {
                missed += 1;
                let nearest = (-2000..2000).map(|at| off(0.01 * f64::from(at))).fold(f64::INFINITY, f64::min);
                assert!(nearest > RADIUS_MM - 1e-4, "{sweep:?} {nearest}");
                continue;
            }
            met += 1;
            let Interval { from_mm, to_mm } = loss;
            for end_mm in [from_mm, to_mm] {
                assert!((off(end_mm) - RADIUS_MM).abs() < 1e-6, "{sweep:?} {end_mm} {}", off(end_mm));
            }
            assert!(off((from_mm + to_mm) / 2.0) <= RADIUS_MM);
            assert!(off(from_mm - 1e-3) > RADIUS_MM && off(to_mm + 1e-3) > RADIUS_MM, "{sweep:?}");
            let row = Row { across: NOWHERE, hollow: None, along: NOWHERE };
            let Row { across, .. } = ball.narrowed(row, row_mm, 0.0).unwrap();
            assert!((across.from_mm - 1e-9..=across.to_mm + 1e-9).contains(&column_mm), "{sweep:?} {across:?}");
        }
        assert!(met > 2_000 && missed > 2_000, "{met} {missed}");
    }
}
