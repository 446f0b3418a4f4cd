//! Largest feed on a move at which no axis exceeds its maximum speed.
//!
//! With dq_i the travel of axis i, V_i its maximum speed and s the length along which the feed is measured,
//!
//! ```text
//! F = min over the axes of V_i s / |dq_i|                          (1)
//! ```
//!
//! Around a leading edge of radius r the tool axis turns by s/r: F = V r, V in radians. Tournier's 65 450 deg/min at 2
//! m/min corresponds to r = 1.751 mm.
//!
//! Source: Tournier, 3.

use super::forward::Axes;
use super::machine::{AxisName, Machine};

/// Largest feed on a move, and the axis whose maximum speed limits it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisFeed {
    /// Feed along the path, mm/min.
    pub feed_mm_per_min: f64,
    /// The limiting axis.
    pub axis: AxisName,
}

impl Machine {
    /// Largest feed on a move whose length along the path is `way_mm`; `None` if no axis that moves has a known
    /// maximum speed. (1)
    pub fn axis_feed(&self, from: &Axes, to: &Axes, way_mm: f64) -> Option<AxisFeed> {
        let linear = self.linear().iter().zip(from.linear_mm.iter().zip(to.linear_mm)).enumerate();
        let linear =
            linear.map(|(index, (axis, (from, to)))| (AxisName::Linear(index), axis.speed_mm_per_min, to - from));
        let rotary = self.rotary().iter().zip(from.rotary_deg.iter().zip(to.rotary_deg));
        let rotary =
            rotary.map(|(axis, (from, to))| (AxisName::Rotary(axis.letter), axis.speed_deg_per_min, to - from));
        let feeds = linear.chain(rotary).filter_map(|(axis, speed, covered)| {
            let feed_mm_per_min = speed? * way_mm / libm::fabs(covered);
            feed_mm_per_min.is_finite().then_some(AxisFeed { feed_mm_per_min, axis })
        });
        feeds.min_by(|one, other| one.feed_mm_per_min.total_cmp(&other.feed_mm_per_min))
    }
}
