//! A cut with everything worked out that does not change from tick to tick.
//!
//! Equations (1) to (6) are those of [`super::circumference`], with the terms that hold for the whole segment drawn
//! together, so that a tick divides once and takes one square root:
//!
//! ```text
//! h = (L/r0) (k r0 ux)                                       (2)
//! p = (k + w/(4 rho^2)) - (k L/(r0 rho)) (r0 uy)             (3)
//! ```
//!
//! What cannot be cut with - NaN, a radius or feed per tooth that is not positive, an inner edge smaller than its chip -
//! becomes NaN here once and is refused at the end of every step, without a check of its own on the tick.

use arcfeed_shared::fmath;
use arcfeed_shared::units::Mm;

use super::NoWish;
use super::circumference::Cut;

/// Below this tau^2 / 12 rho^2 the arc tangent's series of two terms is exact to f32.
const BEND_LIMIT: f32 = 3e-5;

/// A [`Cut`] for the tick; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreparedCut {
    /// L/r0.
    reach_ratio: f32,
    /// w, mm^2.
    excess_mm2: f32,
    /// k + w/(4 rho^2).
    curvature_ratio: f32,
    /// k L/(r0 rho), 1/mm.
    closing_per_mm: f32,
    /// The least r0 u.(A - O)/rho, mm, at which a larger advance still means a thicker chip.
    flattest_mm: f32,
    /// 2 rho, mm.
    path_diameter_mm: f32,
    /// 1/(12 rho^2), 1/mm^2.
    per_bend_mm2: f32,
}

impl PreparedCut {
    /// Works the cut out.
    pub fn new(cut: &Cut) -> Self {
        let (rho, r0, a) = (cut.path_radius.0, cut.edge_radius.0, cut.feed_per_tooth.0);
        let k = f32::from(cut.edge.advance());
        let reach = r0 + k * a; // (1)
        let excess_mm2 = a * (2.0 * r0 + k * a); // (1)
        let possible = rho > 0.0 && r0 > 0.0 && a > 0.0 && reach > 0.0;
        PreparedCut {
            reach_ratio: if possible { reach / r0 } else { f32::NAN },
            excess_mm2,
            curvature_ratio: k + excess_mm2 / (4.0 * rho * rho),
            closing_per_mm: k * (reach / (r0 * rho)),
            flattest_mm: fmath::max(k * excess_mm2 * r0 / (2.0 * rho * reach), 0.0),
            path_diameter_mm: 2.0 * rho,
            per_bend_mm2: 1.0 / (12.0 * rho * rho),
        }
    }

    /// h + sqrt D, mm, for a contact at r0 u: `advance_mm` = k r0 u.v, `towards_mm` = r0 u.(A - O)/rho. The larger it is, the thicker the chip that a given feed takes there. NaN where the input is none.
    ///
    /// # Errors
    /// [`NoWish::OutsideValidity`] where the edge does not advance, [`NoWish::ChipUnreachable`] where no step gives the
    /// wanted chip.
    #[inline(always)]
    pub fn bite_mm(&self, advance_mm: f32, towards_mm: f32) -> Result<f32, NoWish> {
        if self.reach_ratio * advance_mm <= 0.0 {
            return Err(NoWish::OutsideValidity);
        }
        self.advancing_bite_mm([advance_mm, towards_mm])
    }

    /// [`PreparedCut::bite_mm`] where [`PreparedCut::is_thickest_before`] holds: the edge is known to advance.
    #[inline(always)]
    pub fn advancing_bite_mm(&self, [advance_mm, towards_mm]: [f32; 2]) -> Result<f32, NoWish> {
        let h = self.reach_ratio * advance_mm; // (2)
        let p = self.curvature_ratio - self.closing_per_mm * towards_mm; // (3)
        let d = h * h - p * self.excess_mm2; // (4)
        if d < 0.0 { Err(NoWish::ChipUnreachable) } else { Ok(h + fmath::sqrt(d)) }
    }

    /// Whether a contact in this direction takes the thickest chip of all that advance less. The angle of the contact
    /// grows with the advance; h grows with it, and D as long as
    ///
    /// ```text
    /// dD/d(angle) = h (2 L uy - k w/rho) >= 0
    /// ```
    #[inline(always)]
    pub fn is_thickest_before(&self, [advance_mm, towards_mm]: [f32; 2]) -> bool {
        advance_mm > 0.0 && towards_mm >= self.flattest_mm
    }

    /// Path of the centre per tooth, along its arc, for an answer of [`PreparedCut::bite_mm`].
    ///
    /// # Errors
    /// [`NoWish::BadInput`] for NaN, and for a step too large or too small for f32.
    #[inline(always)]
    pub fn path_per_tooth(&self, bite_mm: f32) -> Result<Mm, NoWish> {
        let path = self.along_arc(self.excess_mm2 / bite_mm); // (5) (6)
        // NaN fails this, and is what an overflow becomes.
        if path > 0.0 { Ok(Mm(path)) } else { Err(NoWish::BadInput) }
    }

    /// 2 rho atan(tau / 2 rho) = tau (1 - tau^2 / 12 rho^2 + ...). (6)
    #[inline(always)]
    fn along_arc(&self, tau: f32) -> f32 {
        let bend = tau * tau * self.per_bend_mm2;
        if bend < BEND_LIMIT { tau - tau * bend } else { self.along_wide_arc(tau) }
    }

    #[cold]
    #[inline(never)]
    fn along_wide_arc(&self, tau: f32) -> f32 {
        let path = self.path_diameter_mm * fmath::atan2(tau, self.path_diameter_mm);
        if path.is_finite() { path } else { f32::NAN }
    }
}
