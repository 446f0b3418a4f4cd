//! Speed of a block: programmed feed, override, dry run, the control's own clamp on arcs.
//!
//! ```text
//! v <= sqrt(r / R) V,  but no less than the floor         (1)
//! ```
//! with r the arc's radius, R the reference radius (parameter 1731), V the feed there (1730), floor 1732. Order: F
//! times override, then (1), then the axes' own limit. Override and dry run do not affect rapids here.
//!
//! Source: (1) A-78962EN p. 10, A-63512EN p. 9.

use arcfeed_model::machine::ArcClamp;
use arcfeed_nc::segment::Path;
use arcfeed_units::{MmPerMin, PERCENT, S_PER_MIN};

use super::action::MoveContext;
use super::path::Travel;

/// Inputs of the control that affect the speed of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedConditions {
    /// Feed override in effect, %.
    pub override_percent: u8,
    /// Dry run feed, which replaces the programmed one; `None` without dry run.
    pub dry_run: Option<MmPerMin>,
    /// Whether feed hold, a reset, an alarm or waiting for the spindle brings the axes to rest.
    pub holds: bool,
    /// Whether nothing but feed hold can be the reason for `holds`; tapping moves then continue.
    pub holds_but_taps: bool,
    /// Whether the axes come to rest at the end of each block.
    pub stops_at_block_end: bool,
}

impl FeedConditions {
    /// Conditions without any effect: 100 %, no dry run, no hold.
    pub const PROGRAMMED: FeedConditions = FeedConditions {
        override_percent: PERCENT as u8,
        dry_run: None,
        holds: false,
        holds_but_taps: false,
        stops_at_block_end: false,
    };

    /// Conditions that apply to a move with this context.
    #[must_use]
    pub fn for_context(&self, context: &MoveContext) -> FeedConditions {
        if !context.is_tapping {
            return *self;
        }
        FeedConditions { override_percent: PERCENT as u8, holds: self.holds && !self.holds_but_taps, ..*self }
    }

    /// Speed, mm/s, that these conditions give for a programmed speed: the dry run feed, or the programmed speed times the override.
    pub fn speed_mm_per_s(&self, programmed_mm_per_s: f64) -> f64 {
        match self.dry_run {
            Some(feed) => f64::from(feed.0) / S_PER_MIN,
            None => programmed_mm_per_s * f64::from(self.override_percent) / f64::from(PERCENT),
        }
    }
}

/// Largest speed of a move, mm/s along the path, whatever its feed and its axes.
pub fn speed_max_mm_per_s(travel: &Travel, clamp: Option<&ArcClamp>, rapid_mm_per_s: f64) -> f64 {
    let limit = match (&travel.segment.path, clamp) {
        (Path::Arc(arc), Some(clamp)) if travel.programmed_mm_per_s.is_some() => {
            limit_mm_per_min(clamp, arc.radius_mm()) / S_PER_MIN * travel.speed_ratio
        }
        _ => f64::INFINITY,
    };
    limit.min(rapid_mm_per_s)
}

/// Largest feed of an arc, mm/min in its plane. The controller's model of it is separate code.
fn limit_mm_per_min(clamp: &ArcClamp, radius_mm: f64) -> f64 {
    let ratio = libm::sqrt(radius_mm / f64::from(clamp.radius.0)); // (1)
    (ratio * f64::from(clamp.feed.0)).max(f64::from(clamp.floor.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_units::Mm;

    #[test]
    fn the_clamp_goes_with_the_root_of_the_radius_down_to_its_floor() {
        let clamp = ArcClamp { feed: MmPerMin(3_000.0), radius: Mm(5.0), floor: MmPerMin(100.0) };
        // A quarter of R: half of V. Four times R: twice V. A ten-thousandth: 30, below the floor.
        for (radius_mm, limit) in [(5.0, 3_000.0), (1.25, 1_500.0), (20.0, 6_000.0), (0.0005, 100.0)] {
            assert!((limit_mm_per_min(&clamp, radius_mm) - limit).abs() < 1e-4, "{radius_mm}");
        }
    }
}
