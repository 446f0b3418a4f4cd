//! Quadratic functions of one variable, as the sections of cones and slabs need them.
//!
//! ```text
//! f(x) = a x^2 + 2 b x + c
//! roots:  q = -(b + sign(b) sqrt(b^2 - a c)),  x = q / a and c / q         (1)
//! ```
//!
//! Source: (1) the usual solution without cancellation; it also gives the one root of a straight line.

/// Quadratic function a x^2 + 2 b x + c, as its coefficients a, b and c (b without the factor 2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadratic(pub [f64; 3]);

impl Quadratic {
    /// Value of the function at x.
    #[inline]
    pub fn at(&self, x_ratio: f64) -> f64 {
        let Quadratic([a, b, c]) = self;
        (a * x_ratio + 2.0 * b) * x_ratio + c
    }

    /// Roots in ascending order; missing roots are NaN or infinite. (1)
    #[inline]
    pub fn roots(&self) -> [f64; 2] {
        let Quadratic([a, b, c]) = self;
        let q = -(b + libm::copysign(libm::sqrt(b * b - a * c), *b));
        let (x, y) = (q / a, c / q);
        if x < y { [x, y] } else { [y, x] }
    }

    /// Part of the range from `low` to `high` in which the function is not positive; `None` if there is none. If there are two
    /// such parts, the lower one.
    pub fn not_positive_within(&self, [low, high]: [f64; 2]) -> Option<[f64; 2]> {
        let Quadratic([a, b, c]) = self;
        let has_roots = b * b - a * c > 0.0;
        let part = match (has_roots, self.roots()) {
            (false, _) => return (self.at((low + high) / 2.0) <= 0.0).then_some([low, high]),
            (true, roots) if *a > 0.0 => roots,
            // Negative outside of its roots: one piece has room on one side of them only.
            (true, [first, _]) if *a < 0.0 && low < first => [low, first],
            (true, [_, second]) if *a < 0.0 => [second, high],
            (true, _) if *b > 0.0 => [low, -c / (2.0 * b)],
            (true, _) => [-c / (2.0 * b), high],
        };
        let part = [part[0].max(low), part[1].min(high)];
        (part[0] <= part[1]).then_some(part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_keep_their_digits() {
        assert_eq!(Quadratic([1.0, -2.0, 3.0]).roots(), [1.0, 3.0]);
        let [small, large] = Quadratic([1.0, -5e7, 1.0]).roots();
        assert!((small - 1e-8).abs() < 1e-23 && (large - 1e8).abs() < 1e-7);
        assert!(Quadratic([0.0, 1.0, -4.0]).roots().contains(&2.0));
        assert!(Quadratic([1.0, 0.0, 1.0]).roots().iter().all(|root| root.is_nan()));
    }

    #[test]
    fn the_piece_below_zero_is_found_whatever_the_sign() {
        let range = [0.0, 10.0];
        for (abc, part) in [
            ([1.0, -2.0, 3.0], Some([1.0, 3.0])),
            ([1.0, 2.0, 3.0], None),
            ([1.0, 0.0, 1.0], None),
            ([-1.0, 0.0, -1.0], Some(range)),
            ([-1.0, 2.0, 5.0], Some([5.0, 10.0])),
            ([-1.0, 15.0, -200.0], Some(range)),
            ([0.0, 1.0, -4.0], Some([0.0, 2.0])),
            ([0.0, -1.0, 4.0], Some([2.0, 10.0])),
            ([0.0, 0.0, 1.0], None),
            ([0.0, 0.0, 0.0], Some(range)),
        ] {
            if abc == [-1.0, 15.0, -200.0] {
                // Roots at 10 and 20: all of the range lies before the first.
                assert_eq!(Quadratic(abc).not_positive_within(range), Some([0.0, 10.0]));
            } else {
                assert_eq!(Quadratic(abc).not_positive_within(range), part, "{abc:?}");
            }
        }
    }
}
