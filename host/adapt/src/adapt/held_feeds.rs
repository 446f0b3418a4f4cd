//! Feeds along a move that the override may reach although a board may lose the position or the host there.
//!
//! After such a loss a board holds its last override for a time t, lowers it at s per second, and ends at 100 %, which is the
//! sent feed F. The change takes effect a time w later. Let v(q) be the feed that the law permits after the path q, F behind the
//! end of the move. Then the feed u(p), reached after the path p, is nowhere above the law whenever the loss comes:
//!
//! ```text
//! d = v_max (t + w)                                                       (1)
//! u(p) <= v(q)                              for q from p to p + d         (2)
//! u(p)^2 <= v(q)^2 + 2 s F (q - p - d)      for q behind that             (3)
//! ```
//!
//! (3) is v^2 = 2 a d for a feed that falls evenly in time, by s F per second. A board whose control task has stopped holds its
//! override for a shorter time than t, then its watchdog sets 0 %.
//!
//! The move is divided at the knots of the law's table. In each part (2) and (3) are evaluated with the least v of the parts
//! there, and a knot gets the lower one of the values on both of its sides, so no line between two knots is above u.
//!
//! Source: own; docs/safety-case.md#plunges-with-an-override.

use arcfeed_firmware::envelope::RESPONSE_S;
use arcfeed_law::move_table::MoveTable;
use arcfeed_law::table::Table;
use arcfeed_model::job::{FeedPolicy, Job};
use arcfeed_model::knots::Knot;
use arcfeed_units::{LengthUnit, MmPerTooth, Nm, PERCENT, RevPerMin, S_PER_MIN};

use super::planned_block::{PlannedBlock, govern_descent};
use super::profile::Profile;

/// t: time for which a board holds its last override after a loss, with its settings at start-up, s.
const HOLD_S: f64 = 0.3;
/// Longest time between two ticks, which the board counts as such, s.
const TICK_S: f64 = 0.01;
/// Fraction of the slew rate that counts, because of the discrete ticks.
const SLEW_SHARE: f64 = 0.9;
/// Reduction of the values, which are stored as f32.
const F32_RATIO: f64 = 1.0 - 1e-6;

/// Feeds of a move as the control gets and the override changes them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SentMove {
    /// F: sent feed, mm/min.
    pub feed_mm_per_min: f64,
    /// Largest feed with the override, by the limits of machine, job and override, mm/min.
    pub feed_max_mm_per_min: f64,
    /// Number of teeth that pass in a minute.
    pub teeth_per_min: f64,
    /// Length of the move, mm.
    pub length_mm: f64,
    /// Fastest fall of the override, percentage points per second.
    pub slew_percent_per_s: f64,
}

/// Plan of a descending move under the plunge law with this table of the path per tooth, with the demand along the move and the feeds that the override
/// may reach. `has_sent_feeds` as in [`Known`](super::Known). `None` if no feed above 0 can be sent.
pub fn govern(
    block: &PlannedBlock,
    law: &Table,
    (job, has_sent_feeds): (&Job, bool),
    conditions: (RevPerMin, LengthUnit),
) -> Option<(PlannedBlock, Profile)> {
    let mut governed = block.clone();
    let profile = govern_descent(&mut governed, law, job, conditions)?;
    let sent = governed.sent.filter(|sent| *sent > Nm(0))?;
    let executed = if has_sent_feeds { governed.programmed() } else { Some(sent) };
    governed.along = executed.and_then(|feed| of_block(&governed, law, job, feed)).map(Box::new);
    Some((governed, profile))
}

/// Feeds that the override may reach along a descending move with this F; `None` in a mode whose override does not act.
fn of_block(block: &PlannedBlock, law: &Table, job: &Job, feed: Nm) -> Option<MoveTable> {
    if job.policy != FeedPolicy::SafeBase {
        return None;
    }
    let feed_mm_per_min = feed.to_mm();
    let highest = feed_mm_per_min * f64::from(job.limits.max_percent) / f64::from(PERCENT);
    let sent = SentMove {
        feed_mm_per_min,
        feed_max_mm_per_min: highest.min(block.limit_mm_per_min()),
        teeth_per_min: block.teeth_per_min?,
        length_mm: block.segment.length_mm(),
        slew_percent_per_s: f64::from(job.limits.slew_down_percent_per_s),
    };
    held(law, &sent).map(MoveTable::Feeds)
}

/// Table of the path per tooth that the override may reach, from that of the law, whose knots are in equal distances from the start to the end of
/// the move. `None` for another table.
pub fn held(law: &Table, sent: &SentMove) -> Option<Table> {
    let knots = law.knots();
    let parts = knots.len().checked_sub(1).filter(|parts| *parts > 0)?;
    let part_mm = sent.length_mm / parts as f64;
    let [feed, feed_max] = [sent.feed_mm_per_min, sent.feed_max_mm_per_min].map(|feed| feed / S_PER_MIN);
    let teeth_per_s = sent.teeth_per_min / S_PER_MIN;
    let permitted = |(_, path): &Knot| f64::from(path.0) * teeth_per_s;
    let mut least: Vec<f64> = knots.windows(2).map(|ends| permitted(&ends[0]).min(permitted(&ends[1]))).collect();
    let most = least.iter().copied().fold(feed, f64::max).min(feed_max.max(feed));
    let held_mm = most * (HOLD_S + f64::from(RESPONSE_S) + TICK_S); // (1)
    // Behind the end, as far as an override that was not held could still be raised.
    least.push(feed);
    let fall_mm2_per_s2 = 2.0 * SLEW_SHARE * sent.slew_percent_per_s / f64::from(PERCENT) * feed;
    let within = |part: usize| {
        let end_mm = (part + 1) as f64 * part_mm;
        let of_part = |(at, permitted): (usize, &f64)| {
            let fallen_mm = (at as f64 * part_mm - end_mm - held_mm).max(0.0);
            libm::sqrt(permitted * permitted + fall_mm2_per_s2 * fallen_mm) // (2), (3)
        };
        least.iter().enumerate().skip(part).map(of_part).fold(f64::INFINITY, f64::min)
    };
    let inside: Vec<f64> = (0..parts).map(within).collect();
    let knot = |(border, (travelled, _)): (usize, &Knot)| -> Knot {
        let around = &inside[border.saturating_sub(1)..(border + 1).min(parts)];
        let path_mm = around.iter().copied().fold(f64::INFINITY, f64::min) / teeth_per_s * F32_RATIO;
        (*travelled, MmPerTooth(path_mm as f32))
    };
    Table::new(&knots.iter().enumerate().map(knot).collect::<Vec<_>>()).ok()
}
