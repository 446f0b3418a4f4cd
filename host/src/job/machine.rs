//! `[machine]`, and what `[control]` says of feeds: what the machine can follow.

use arcfeed_shared::machine::{ArcClamp, MachineLimits};
use arcfeed_shared::units::{DegPerMin, LengthUnit, Mm, MmPerMin};
use toml::Spanned;

use super::schema::{ArcClampTable, JobTable, MaxFeedTable, Quantity};
use super::{Complaint, length_mm, positive};

/// What the machine can follow; feeds are per minute, those of rotary axes in degrees.
pub fn build(table: &JobTable, unit: LengthUnit) -> Result<MachineLimits, Complaint> {
    let feed = |given: &Spanned<Quantity>, name: &str| {
        length_mm(given, unit, name).map(|mm_per_min| MmPerMin(mm_per_min as f32))
    };
    let MaxFeedTable { x, y, z, a, b, c } = &table.machine.max_feed;
    let linear = |given: &Option<Spanned<Quantity>>| given.as_ref().map(|given| feed(given, "max_feed")).transpose();
    let rotary = |given: &Option<Spanned<f64>>| {
        let checked = given.as_ref().map(|given| positive(given, "max_feed of a rotary axis, degrees per minute,"));
        checked.transpose().map(|degrees| degrees.map(|degrees| DegPerMin(degrees as f32)))
    };
    let clamp = |clamp: &ArcClampTable| {
        let floor = clamp.floor.as_ref().map_or(Ok(MmPerMin(0.0)), |floor| feed(floor, "floor"))?;
        let radius = Mm(length_mm(&clamp.radius, unit, "radius")? as f32);
        Ok(ArcClamp { feed: feed(&clamp.feed, "feed")?, radius, floor })
    };
    Ok(MachineLimits {
        linear: [linear(x)?, linear(y)?, linear(z)?],
        rotary: [rotary(a)?, rotary(b)?, rotary(c)?],
        arc_clamp: table.control.arc_clamp.as_ref().map(clamp).transpose()?,
    })
}
