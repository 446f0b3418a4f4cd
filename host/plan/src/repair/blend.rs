//! Allowance that finishing leaves on the nominal surface, from the old blade's own deviation to the least allowance of the repair.
//!
//! ```text
//! K = D_max - D_min
//! D(u, 0) = D_max - K (u - u1)/(u2 - u1)            u1 <= u <= u2                                             (1)
//! D(u, 1) = D_max - K (u - u1)/(u3 - u1)            u1 <= u <= u3                                             (2)
//! D = D(u, 0) + (D(u, 1) - D(u, 0)) v               u1 <= u <= u2                                             (3)
//! D = D_min + (D(u, 1) - D_min)(v - f)/(1 - f)      u2 < u < u3, v > f(u)                                     (4)
//! D = D_min                                         v <= f(u), and u >= u3                                    (5)
//! D = D_min + K q((D - D_min)/K)                    q = t, 3t2 - 2t3, 10t3 - 15t4 + 6t5                       (6)
//! D = D_min + K q(delta/w)                          patches of any shape, delta: distance from c_b            (7)
//! ```
//!
//! Source: Feng et al., eqs 8 to 13, corrected: as printed, (1), (2) and their successors have u in place of u - u1 and the last has v in place of
//! v - f, so that neither D(u1, 0) = D_max nor D(u, 1) of their own conditions holds, and a step stands along c_b. (1) to (5) are continuous with kinks
//! along c1 and c_b; (6) with q' = 0 at both ends, and (7), are ours.

/// Way in which the allowance changes across the transition, the strip between old surface and repair.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BlendShape {
    /// Linearly, as published; with kinks at both ends.
    Linear,
    /// By a cubic, without kinks.
    #[default]
    Cubic,
    /// By a polynomial of degree 5, with continuous curvature.
    Quintic,
}

/// Allowance that finishing leaves, for a repair whose border c_b reaches from the leading edge at u2 to the trailing edge at u3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FinishAllowance {
    /// Parameter u1 (from root to tip) at which the transition begins.
    pub from_u: f64,
    /// Least u of the border, u2, at the leading edge (v = 0).
    pub leading_u: f64,
    /// Greatest u of the border, u3, at the trailing edge (v = 1).
    pub trailing_u: f64,
    /// Allowance D_max where the transition begins: deviation of the old blade from the nominal surface.
    pub old_mm: f64,
    /// Allowance D_min that stays in the repaired region.
    pub least_mm: f64,
    /// Way in which the allowance changes across the transition.
    pub shape: BlendShape,
}

impl BlendShape {
    /// q of (6), from 0 to 1 for `t` from 0 to 1.
    pub fn value(self, t: f64) -> f64 {
        let t = t.clamp(0.0, 1.0);
        match self {
            BlendShape::Linear => t,
            BlendShape::Cubic => t * t * (3.0 - 2.0 * t),
            BlendShape::Quintic => t * t * t * (10.0 + t * (6.0 * t - 15.0)),
        }
    }

    /// Greatest derivative of q.
    pub fn steepest_ratio(self) -> f64 {
        match self {
            BlendShape::Linear => 1.0,
            BlendShape::Cubic => 1.5,
            BlendShape::Quintic => 1.875,
        }
    }
}

impl FinishAllowance {
    /// Allowance, mm, that finishing leaves at a point; `border_v` is f(u), used between u2 and u3 only.
    pub fn left_mm(&self, [u, v]: [f64; 2], border_v: f64) -> f64 {
        let share = (self.linear_mm([u, v], border_v) - self.least_mm) / (self.old_mm - self.least_mm);
        // Equal allowances leave nothing to blend.
        if share.is_finite() { self.blended_mm(share) } else { self.least_mm }
    }

    /// Allowance left at a distance from c_b outside of the repaired region, (7); `width_mm` is that of the transition.
    pub fn left_at_distance_mm(&self, distance_mm: f64, width_mm: f64) -> f64 {
        self.blended_mm(distance_mm / width_mm)
    }

    fn blended_mm(&self, share: f64) -> f64 {
        self.least_mm + (self.old_mm - self.least_mm) * self.shape.value(share) // (6)
    }

    fn linear_mm(&self, [u, v]: [f64; 2], border_v: f64) -> f64 {
        let fall_mm = self.old_mm - self.least_mm;
        let along = |to_u: f64| self.old_mm - fall_mm * (u - self.from_u) / (to_u - self.from_u); // (1), (2)
        if u <= self.from_u {
            self.old_mm
        } else if u <= self.leading_u {
            let (leading_mm, trailing_mm) = (along(self.leading_u), along(self.trailing_u));
            leading_mm + (trailing_mm - leading_mm) * v // (3)
        } else if u < self.trailing_u && v > border_v {
            self.least_mm + (along(self.trailing_u) - self.least_mm) * (v - border_v) / (1.0 - border_v) // (4)
        } else {
            self.least_mm // (5)
        }
    }
}
