//! `[plunge]`: the law for moves that descend along the tool's axis.

use arcfeed_model::job::{FeedPolicy, Job, ToolAxis};

use super::schema::{JobTable, PlungeTable};
use super::spindle::SpindleLimits;
use super::{Complaint, at, length_mm};

/// Name of the plunge law in `[law]`, for tools that no other law governs.
pub const LAW: &str = super::tool::PLUNGE_LAW;

/// Settings of the plunge law, which governs moves that descend into material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plunge {
    /// Target chip thickness, the largest path per tooth, mm.
    pub feed_per_tooth_mm: f64,
    /// The law also governs moves that descend at an angle (ramps).
    pub has_ramps: bool,
}

/// Plunge law from the `[plunge]` table of a job, `None` if it has none; `[law] kind = "plunge"` requires the table.
/// Fails at the first faulty value.
pub fn build(table: &JobTable, job: &Job, spindle: &SpindleLimits) -> Result<Option<Plunge>, Complaint> {
    let Some(entry) = &table.plunge else {
        let tools = table.tool.0.iter();
        let laws = tools.map(|tool| tool.law.as_ref()).chain([table.law.as_ref()]).flatten();
        return match laws.map(|law| &law.kind).find(|kind| kind.as_ref() == LAW) {
            None => Ok(None),
            Some(kind) => Err(at(kind, "this law needs a table [plunge] with map = \"FILE.toml\"")),
        };
    };
    let setup = job.tools.first();
    let is_bounded = job.ceiling.max_feed.is_some() || job.machine.linear.iter().all(Option::is_some);
    let missing = [
        (table.cutting.is_none(), "[plunge] needs [workpiece] and [cutting]: its feeds follow from the forces there"),
        (
            *spindle == SpindleLimits::default(),
            "[plunge] needs max_power or max_torque in [spindle]: they bound the feed of a plunge",
        ),
        (!is_bounded, "[plunge] needs a fastest feed: add a table [limits] with max_feed, per minute along the path"),
        (setup.axis != ToolAxis::Z, "[plunge] is for a tool along Z"),
        (
            job.policy == FeedPolicy::OverrideOnly,
            "[plunge] sends the least feed of each move as F: write mode = \"safe-base\" or \"rewrite-only\" in [override]",
        ),
    ];
    if let Some((_, message)) = missing.iter().find(|(is_missing, _)| *is_missing) {
        return Err(at(entry, message));
    }
    let PlungeTable { feed_per_tooth, ramps, .. } = entry.as_ref();
    let own = feed_per_tooth.as_ref().map(|feed| length_mm(feed, job.unit, "feed_per_tooth")).transpose()?;
    let feed_per_tooth_mm = own.unwrap_or(f64::from(setup.feed_per_tooth.0));
    Ok(Some(Plunge { feed_per_tooth_mm, has_ramps: ramps.unwrap_or(false) }))
}
