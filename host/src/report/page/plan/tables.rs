//! Tables of a plan's page.

use std::fmt::Write;

use arcfeed_model::tool::Edge;
use arcfeed_plan::output::limits::BlankFace;
use arcfeed_plan::path::Purpose;
use arcfeed_units::{LengthUnit, S_PER_MIN};

use super::{BaselineResult, Lengths, PlanReport, PlanVerdict, Removed};
use crate::report::page::escaped;

/// Table with its heads, and rows of text cells.
fn table(heads: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let row = |tag: &str, cells: &mut dyn Iterator<Item = &str>| {
        let cells: String = cells.map(|cell| format!("<{tag}>{}</{tag}>", escaped(cell))).collect();
        format!("<tr>{cells}</tr>\n")
    };
    let mut body = format!("<table>\n{}", row("th", &mut heads.iter().copied()));
    for cells in rows {
        body += &row("td", &mut cells.iter().map(String::as_str));
    }
    body + "</table>\n"
}

/// Paragraph with the verdict on the plan, as HTML.
pub fn verdict(verdict: &PlanVerdict) -> String {
    let class = if verdict.is_safe { "" } else { " class=\"warning\"" };
    verdict.sentences.iter().map(|sentence| format!("<p{class}>{}</p>\n", escaped(sentence))).collect()
}

/// Table of the set-up, as HTML.
pub fn setup(report: &PlanReport) -> String {
    let PlanReport { mill, axis, path, unit, .. } = report;
    let lengths = Lengths(*unit);
    let place = |x: f64, y: f64| format!("X{} Y{}", lengths.of(x), lengths.of(y));
    let [x, y, z] = axis.direction;
    let pitch_deg = 360.0 / f64::from(axis.slots.max(1));
    let rows = [
        (
            "outer and inner radius",
            format!("{}, {}", lengths.of(mill.outer_radius_mm), lengths.of(mill.inner_radius_mm)),
        ),
        ("radius of the inserts", lengths.of(mill.insert_radius_mm)),
        ("tool axis in the part", format!("{x:.6}, {y:.6}, {z:.6}")),
        ("A", format!("{:.3} deg", axis.tilt_deg)),
        ("B of the first slot", format!("{:.3} deg", axis.first_deg)),
        ("slots", format!("{}, {pitch_deg:.3} deg apart", axis.slots)),
        ("A, turned about on the outer circle", place(path.exterior.x, path.exterior.y)),
        ("B1, turned about on the inner circle", place(path.interior.x, path.interior.y)),
        ("C, base position", place(path.base.x, path.base.y)),
        ("clear of all material at", format!("Z{}", lengths.of(path.clear_mm))),
    ];
    let heading = format!("lengths in {}", lengths.label());
    table(&[&heading, ""], rows.map(|(name, value)| vec![name.into(), value]))
}

/// Table of the levels, as HTML.
pub fn levels(report: &PlanReport) -> String {
    let lengths = Lengths(report.unit);
    let angle = |from: arcfeed_plan::vector::Flat, about: arcfeed_plan::vector::Flat| {
        let (start, end) = (report.path.base - about, from - about);
        libm::atan2(start.x * end.y - start.y * end.x, start.dot(&end)).to_degrees().abs()
    };
    let rows = report.path.levels.iter().enumerate().map(|(index, level)| {
        let stops = report.stops.get(index).cloned().unwrap_or_default();
        let point = |at: arcfeed_plan::vector::Flat| format!("X{} Y{}", lengths.of(at.x), lengths.of(at.y));
        vec![
            format!("{}", index + 1),
            lengths.of(level.height_mm),
            point(level.exterior_end),
            format!("{:.2}", angle(level.exterior_end, report.path.exterior)),
            stops.exterior,
            point(level.interior_end),
            format!("{:.2}", angle(level.interior_end, report.path.interior)),
            stops.interior,
        ]
    });
    let z = format!("Z, {}", lengths.label());
    table(&["level", &z, "D", "about A, deg", "ended by", "E", "about B1, deg", "ended by"], rows)
}

/// Table of the stock limits, as HTML.
pub fn limits(report: &PlanReport) -> String {
    let lengths = Lengths(report.unit);
    let rows = report.limits.iter().map(|limit| {
        let edge = if limit.edge == Edge::Outer { "outer" } else { "inner" };
        let face = if limit.face == BlankFace::Upper { "upper" } else { "lower" };
        let [least, most] = limit.contact_deg;
        vec![
            format!("movement {}", limit.movement),
            edge.into(),
            face.into(),
            format!("{:.0}", limit.normal_deg),
            lengths.of(limit.offset_mm),
            format!("{:.5}", limit.rise_ratio),
            format!("{least:.1} to {most:.1}"),
            format!("{:.3}", limit.elsewhere_ratio),
        ]
    });
    let offset = format!("offset, {}", lengths.label());
    let heads = ["", "cuts with", "face", "normal, deg", &offset, "rise", "contact, deg", "chip elsewhere"];
    table(&heads, rows)
        + "<p>Stock limits are the faces of the blank. The last column is the thickest chip that the other circle could take \
           at the other face, relative to the one that is kept.</p>\n"
}

/// Table of the times, as HTML.
pub fn times(report: &PlanReport) -> String {
    let lengths = Lengths(report.unit);
    let planned = &report.times.planned;
    let heads = ["", &format!("length, {}", lengths.label()), &format!("feed, {}/min", lengths.label()), "time, s"];
    let parts = planned.parts.iter().map(|part| {
        let name = match part.purpose {
            Purpose::Approach => "down to the blank".into(),
            Purpose::Entry => "into the blank".into(),
            Purpose::Link => "from level to level".into(),
            Purpose::Retract => "up".into(),
            movement => format!("movement {}", movement.movement().unwrap_or_default()),
        };
        let seconds = format!("{:.1}", part.time_min * S_PER_MIN);
        vec![name, lengths.of(part.length_mm), lengths.feed(part.feed_mm_per_min), seconds]
    });
    let mut body = table(&heads, parts);
    let slots = f64::from(report.axis.slots);
    let row = |name: &str, time: &arcfeed_plan::output::baseline::SlotTime| {
        vec![
            name.to_owned(),
            format!("{:.2}", time.cutting_min),
            format!("{:.1}", time.cutting_min * slots),
            lengths.volume(time.rate_mm3_per_min),
        ]
    };
    let mut rows = vec![row("planned, at the program's feeds", &planned.slot)];
    if let Ok(baseline) = &report.times.baseline {
        rows.push(row("flank milling", &baseline.time));
    }
    let rate = format!("{}/min", lengths.volume_label());
    body += &table(&["", "one slot, min", "part, min", &rate], rows);
    body + &match &report.times.baseline {
        Ok(baseline) => assumed(baseline, planned.slot.cutting_min, lengths),
        Err(why) => format!("<p>No baseline: {}</p>\n", escaped(why)),
    }
}

fn assumed(baseline: &BaselineResult, planned_min: f64, lengths: Lengths) -> String {
    let BaselineResult { mill, passes, time } = baseline;
    format!(
        "<p>{:.1} times as fast. The baseline is computed, not measured: a ball-end mill of {} {unit} at {} {unit}/min, {} levels of at most \
         {} {unit}, {} passes along the slot, side by side at most {} {unit} apart where the slot is wider than the ball. Assumed for it: \
         walls are done where the ball leaves them; the ways back are at rapid and take no time. Indexing and tool changes are in neither \
         time.</p>\n",
        time.cutting_min / planned_min,
        lengths.of(mill.diameter_mm),
        lengths.feed(mill.feed_mm_per_min),
        passes.levels,
        lengths.of(mill.axial_depth_mm),
        passes.passes,
        lengths.of(mill.stepover_mm),
        unit = lengths.label(),
    )
}

/// Table of the clearances, as HTML.
pub fn clearances(report: &PlanReport) -> String {
    let lengths = Lengths(report.unit);
    let rows = report.clearances.iter().map(|row| {
        let found = [row.certified_mm, row.found_mm].map(|mm| lengths.of(mm));
        let [certified, found] = found;
        vec![format!("{} from {}", row.part, row.obstacle), certified, found, row.place.clone()]
    });
    let heads = [format!("in {}", lengths.label()), "at least".into(), "found".into(), "where".into()];
    table(&heads.each_ref().map(String::as_str), rows)
        + "<p>Over the whole continuous way. \"At least\" is proven, \"found\" is the nearest place that was looked at.</p>\n"
}

/// Table of the removed volumes, as HTML.
pub fn removed(removed: &Removed, unit: LengthUnit) -> String {
    let lengths = Lengths(unit);
    let label = lengths.volume_label();
    let share = removed.removed_mm3 / removed.available_mm3 * 100.0;
    let mut body = format!(
        "<p>{share:.1} % of the slot: {} of {} {label} between the allowances.</p>\n",
        lengths.volume(removed.removed_mm3),
        lengths.volume(removed.available_mm3)
    );
    let rows = removed.levels_mm3.iter().enumerate().map(|(index, volume_mm3)| {
        let share = volume_mm3 / removed.available_mm3 * 100.0;
        vec![format!("{}", index + 1), lengths.volume(*volume_mm3), format!("{share:.1}")]
    });
    let _ = write!(body, "{}", table(&["level", label, "% of the slot"], rows));
    body
}
