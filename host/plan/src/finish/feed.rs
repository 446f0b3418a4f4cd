//! Feed along finishing passes, constant at the contact.
//!
//! While the mill swings round an edge its tip covers another way than the contact. Between two points with the contact's way dC, the tip's way dT and the
//! way dP of the pivot (the corner's centre on the axis), all at the same time,
//!
//! ```text
//! F = min(F_c |dT| / |dC|,  k F_c |dT| / |dP|,  F_max)                                                             (1)
//! ```
//!
//! F_c is the feed per tooth at the contact times teeth and speed. The second term bounds the chip, which is at most the way of the cutting end per tooth: k
//! times the target. It decides at edges whose radius is small beside the mill's. F is rounded down.
//!
//! Source: ours; at a fixed axis the first term is the contour law of an outside arc (docs/laws.md).

use super::mill::FinishMill;
use super::passes::PassPoint;

/// Shortest way that counts, mm.
const LEAST_MM: f64 = 1e-9;
/// Digits of F: thousandths of a millimetre per minute.
const DIGITS: f64 = 1e3;

/// Feed that is kept at the contact, with the bounds of the resulting feed of the tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactFeed {
    /// Feed of the contact along the surface, F_c.
    pub target_mm_per_min: f64,
    /// Largest path of the cutting end per tooth, as a multiple k of the feed per tooth at the contact.
    pub max_raise_ratio: f64,
    /// Largest feed of the tip, F_max.
    pub max_mm_per_min: f64,
}

impl ContactFeed {
    /// Feed F of the mill's tip on the way from one point to the next, mm/min. (1)
    pub fn tip_mm_per_min(&self, mill: &FinishMill, from: &PassPoint, to: &PassPoint) -> f64 {
        let contact_mm = (to.contact.point - from.contact.point).norm();
        let tip_mm = (to.location.tip - from.location.tip).norm();
        let pivot_mm = (mill.pivot(&to.location) - mill.pivot(&from.location)).norm();
        let by_contact = self.target_mm_per_min * tip_mm / contact_mm.max(LEAST_MM);
        let by_pivot = self.max_raise_ratio * self.target_mm_per_min * tip_mm / pivot_mm.max(LEAST_MM);
        let feed = by_contact.min(by_pivot).min(self.max_mm_per_min);
        (libm::floor(feed * DIGITS) / DIGITS).max(1.0 / DIGITS)
    }
}
